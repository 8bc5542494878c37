//! Arguments of `serve` for access control.

use crate::command::output::outcome::Failure;
use crate::service::http::access::origins::Origins;
use crate::service::http::access::rates::Rates;
use crate::service::http::access::tokens::Tokens;
use crate::service::http::access::{Access, AccessPolicy};
use crate::service::http::listen::Connections;
use rustix::process::{Resource, Rlimit, getrlimit, setrlimit};
use std::net::SocketAddr;
use std::num::NonZeroU32;
use std::path::PathBuf;

/// Open files besides connections: the database, the log, and temporary files of backups and sorts.
const OTHER_FILES: u64 = 64;
/// Default rate limit of an address and of a token, if other machines reach the service.
const RATE: u32 = 100;

#[derive(Debug, Clone, clap::Args)]
#[command(next_help_heading = "Access")]
#[group(skip)]
pub struct Arguments {
    /// File of the valid tokens: a line for each, as printed by `arcslip token`; read again at SIGHUP.
    #[arg(long, value_name = "FILE", env = "ARCSLIP_TOKENS_FILE")]
    pub tokens_file: Option<PathBuf>,
    /// Admit everyone without a token, from other machines, too.
    #[arg(long, env = "ARCSLIP_OPEN")]
    open: bool,
    /// Requests per second from an address, 0 for no limit. Default: 100, or 0 if only this machine reaches the service.
    #[arg(long, value_name = "N", env = "ARCSLIP_ADDRESS_RATE")]
    address_rate: Option<u32>,
    /// Requests per second with a token, 0 for no limit. Default: as for an address.
    #[arg(long, value_name = "N", env = "ARCSLIP_TOKEN_RATE")]
    token_rate: Option<u32>,
    /// Origins of other pages that may call, such as `https://plots.example.org`; several separated by commas. Default: none.
    #[arg(long, value_name = "ORIGIN", env = "ARCSLIP_ALLOW_ORIGIN", value_delimiter = ',')]
    allow_origin: Vec<String>,
    /// Connections served at a time; further ones wait. Each takes a file descriptor (`ulimit -n`).
    #[arg(long, value_name = "N", default_value_t = 800, env = "ARCSLIP_MAX_CONNECTIONS",
        value_parser = clap::value_parser!(u32).range(1..=1_000_000))]
    max_connections: u32,
    /// Connections from an address, 0 for no limit; further ones are closed. Loopback addresses, as of a proxy, have no
    /// limit.
    #[arg(long, value_name = "N", default_value_t = 100, env = "ARCSLIP_ADDRESS_CONNECTIONS")]
    address_connections: u32,
}

impl Arguments {
    /// # Errors
    /// The address is reachable from other machines but neither tokens nor `--open` are given, or the file of tokens is invalid.
    pub fn access(&self, listen: SocketAddr) -> Result<Access, Failure> {
        let loopback = listen.ip().is_loopback();
        let policy = match (&self.tokens_file, self.open) {
            (Some(_), true) => {
                return Err(bad("--tokens-file requires tokens and --open does not: give one of them".to_owned()));
            }
            (Some(_), false) => AccessPolicy::with(self.tokens()?),
            (None, true) => AccessPolicy::Open,
            (None, false) if loopback => AccessPolicy::Loopback,
            (None, false) => {
                return Err(bad(format!(
                    "--listen {listen}: other machines reach this address; state who may call: --tokens-file FILE \
                     (ARCSLIP_TOKENS_FILE), or --open for everyone"
                )));
            }
        };
        let usual = if loopback { 0 } else { RATE };
        let rate = |given: Option<u32>| NonZeroU32::new(given.unwrap_or(usual));
        let told = |given: Option<u32>| rate(given).map_or(0, NonZeroU32::get);
        tracing::info!(
            of_an_address = told(self.address_rate),
            of_a_token = told(self.token_rate),
            "requests a second"
        );
        let origins = Origins::read(self.allow_origin.iter().map(String::as_str))
            .map_err(|detail| bad(format!("--allow-origin: {detail}")))?;
        Ok(Access::new(policy, Rates::new(rate(self.address_rate), rate(self.token_rate)), origins))
    }

    /// The requested number of connections, or fewer if the process may not open as many files.
    pub fn connections(&self) -> Connections {
        let files = open_files();
        let room = files.saturating_sub(OTHER_FILES).max(1);
        let asked = u64::from(self.max_connections);
        if asked > room {
            tracing::warn!(asked, served = room, files, "fewer connections are served: each takes a file (ulimit -n)");
        }
        let all = usize::try_from(asked.min(room)).unwrap_or(usize::MAX);
        // The backlog does not depend on the number of files.
        let waiting = usize::try_from(asked).unwrap_or(usize::MAX);
        Connections { all, waiting, an_address: NonZeroU32::new(self.address_connections) }
    }

    /// Reads the file of tokens again.
    ///
    /// # Errors
    /// No file is given, or the file is invalid.
    pub fn tokens(&self) -> Result<Tokens, Failure> {
        let file = self.tokens_file.as_deref().ok_or_else(|| bad("no file of tokens is given".to_owned()))?;
        Tokens::of_file(file).map_err(|error| bad(format!("--tokens-file: {error}")))
    }
}

/// Raises the limit on open files to its maximum and answers it.
fn open_files() -> u64 {
    let limit = getrlimit(Resource::Nofile);
    let raised = Rlimit { current: limit.maximum, maximum: limit.maximum };
    let current = if setrlimit(Resource::Nofile, raised).is_ok() { limit.maximum } else { limit.current };
    current.unwrap_or(u64::MAX)
}

fn bad(text: String) -> Failure {
    Failure::Input(vec![text])
}
