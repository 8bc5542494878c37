//! The command line; see `command`.

use std::process::ExitCode;

/// Many small vectors come and go in every increment of a small scene, and large ones in that of a large one, whose pages
/// the system's allocator gives back each time.
#[global_allocator]
static ALLOCATOR: mimalloc::MiMalloc = mimalloc::MiMalloc;

fn main() -> ExitCode {
    arcslip::command::run()
}
