//! Limits of a service, as arguments of `serve` and `work`.

use crate::command::options::size::bytes;
use crate::command::options::{bounds, duration};
use crate::model::input::limits::{MAX_CONTACTS, MAX_ELEMENTS, MAX_INCREMENTS, MAX_NODES, MAX_TEXT_BYTES};
use crate::service::jobs::Limits;
use crate::service::store::Keep;
use std::time::Duration;

#[derive(Debug, Clone, Copy, clap::Args)]
#[command(next_help_heading = "Limits")]
#[group(skip)]
pub struct Arguments {
    #[command(flatten)]
    bounds: bounds::Arguments,
    /// Waiting jobs and studies; further ones are refused with 429.
    #[arg(long, value_name = "N", default_value_t = Limits::default().queued, env = "ARCSLIP_MAX_QUEUED",
        value_parser = clap::value_parser!(u64).range(1..))]
    max_queued: u64,
    /// Size of a request, such as `64MiB`; at most 256 MiB.
    #[arg(long, value_name = "BYTES", default_value = "16MiB", env = "ARCSLIP_MAX_BODY", value_parser = body)]
    max_body: usize,
    /// Nodes of a model, at most 1,000,000.
    #[arg(long, value_name = "N", default_value_t = Limits::default().nodes, env = "ARCSLIP_MAX_NODES",
        value_parser = |text: &str| count(text, MAX_NODES))]
    max_nodes: usize,
    /// Elements of a model, at most 2,500,000.
    #[arg(long, value_name = "N", default_value_t = Limits::default().elements, env = "ARCSLIP_MAX_ELEMENTS",
        value_parser = |text: &str| count(text, MAX_ELEMENTS))]
    max_elements: usize,
    /// Contacts of a model, at most 20,000; 0 allows none.
    #[arg(long, value_name = "N", default_value_t = Limits::default().contacts, env = "ARCSLIP_MAX_CONTACTS",
        value_parser = |text: &str| most(text, MAX_CONTACTS))]
    max_contacts: usize,
    /// `max_increments` of a job, at most 10,000,000.
    #[arg(long, value_name = "N", default_value_t = Limits::default().increments, env = "ARCSLIP_MAX_INCREMENTS",
        value_parser = clap::value_parser!(u64).range(1..=MAX_INCREMENTS))]
    max_increments: u64,
    /// Time for the check of a request, such as `30s`; a longer check is refused with 422.
    #[arg(long, value_name = "DURATION", default_value = "2m", env = "ARCSLIP_MAX_CHECK_TIME",
        value_parser = duration::positive)]
    max_check_time: Duration,
    /// Total running time of a job, such as `30m` or `7d`.
    #[arg(long, value_name = "DURATION", default_value = "24h", env = "ARCSLIP_MAX_WALL_TIME",
        value_parser = duration::positive)]
    max_wall_time: Duration,
    /// Stored size of a job, such as `512MiB`.
    #[arg(long, value_name = "BYTES", default_value = "8GiB", env = "ARCSLIP_MAX_STORED", value_parser = bytes)]
    max_stored: u64,
    /// Ended jobs to keep: a number, or a time since their end (`1000`, `30d`). Default: all.
    #[arg(long, value_name = "COUNT|DURATION", env = "ARCSLIP_KEEP", value_parser = keep)]
    pub keep: Option<Keep>,
}

impl Arguments {
    pub fn limits(&self) -> Limits {
        Limits {
            queued: self.max_queued,
            body_bytes: self.max_body,
            nodes: self.max_nodes,
            elements: self.max_elements,
            contacts: self.max_contacts,
            increments: self.max_increments,
            check_time: self.max_check_time,
            wall_time: self.max_wall_time,
            stored_bytes: self.max_stored,
            bounds: self.bounds.bounds(),
        }
    }
}

fn most(text: &str, largest: usize) -> Result<usize, String> {
    text.parse()
        .ok()
        .filter(|number| *number <= largest)
        .ok_or_else(|| format!("a whole number up to {largest} is expected"))
}

fn count(text: &str, largest: usize) -> Result<usize, String> {
    most(text, largest)
        .ok()
        .filter(|number| *number > 0)
        .ok_or_else(|| format!("a whole number from 1 to {largest} is expected"))
}

fn body(text: &str) -> Result<usize, String> {
    let found = bytes(text)?;
    usize::try_from(found)
        .ok()
        .filter(|found| *found <= MAX_TEXT_BYTES)
        .ok_or_else(|| "at most 256MiB is expected".to_owned())
}

fn keep(text: &str) -> Result<Keep, String> {
    match text.parse() {
        Ok(count) => Ok(Keep::Newest(count)),
        Err(_) => duration::positive(text).map(Keep::For),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn bodies_and_what_is_kept_are_read() {
        assert!(body("256MiB").is_ok() && body("257MiB").is_err());
        assert_eq!(keep("0"), Ok(Keep::Newest(0)));
        assert_eq!(keep("1d"), Ok(Keep::For(Duration::from_secs(86_400))));
        assert!(keep("soon").is_err() && keep("-1").is_err());
    }
}
