//! The command line; see `command`.

use std::process::ExitCode;

fn main() -> ExitCode {
    arcslip::command::run()
}
