//! Bounds on a solve, as arguments of all commands that solve or check.

use crate::command::options::size::bytes;
use crate::command::output::outcome::{Failure, Outcome};
use crate::resources::budget::{Bounds, Budget};
use crate::resources::cancel::CancelFlag;

#[derive(Debug, Clone, Copy, clap::Args)]
#[command(next_help_heading = "Limits")]
#[group(skip)]
pub struct Arguments {
    /// Memory of a solve or check, such as `2GiB`: the total size of its matrices and lists; a path that exceeds it ends with
    /// `memory_limit`.
    #[arg(long, value_name = "BYTES", default_value = "4GiB", env = "ARCSLIP_MAX_MEMORY", value_parser = bytes)]
    max_memory: u64,
    /// Entries of the sparse triangular factor of the stiffness matrix; a structure that exceeds them is refused.
    #[arg(long, value_name = "N", default_value_t = Bounds::default().factor_entries,
        env = "ARCSLIP_MAX_FACTOR_ENTRIES", value_parser = clap::value_parser!(u64).range(1..))]
    max_factor_entries: u64,
    /// Multiplications of a factorisation of the stiffness matrix; a structure that exceeds them is refused.
    #[arg(long, value_name = "N", default_value_t = Bounds::default().factor_work,
        env = "ARCSLIP_MAX_FACTOR_WORK", value_parser = clap::value_parser!(u64).range(1..))]
    max_factor_work: u64,
}

impl Arguments {
    pub fn bounds(&self) -> Bounds {
        Bounds { memory: self.max_memory, factor_entries: self.max_factor_entries, factor_work: self.max_factor_work }
    }

    /// Runs a command within these bounds.
    pub fn within(&self, command: impl FnOnce() -> Outcome) -> Outcome {
        let budget = Budget::new(CancelFlag::default(), self.bounds());
        budget.during(command).unwrap_or_else(|breach| Err(Failure::other(breach)))
    }
}
