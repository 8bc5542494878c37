//! `arcslip serve`: the HTTP service and its workers.

use super::settings::Setting;
use super::{Failure, Outcome, access, duration, limits, say};
use crate::http::access::Access;
use crate::http::server::{Front, Server};
use crate::jobs::{PathSolver, Settings, demonstration};
use crate::store;
use std::io::IsTerminal;
use std::net::SocketAddr;
use std::num::NonZero;
use std::path::PathBuf;
use std::process::ExitCode;
use std::sync::Arc;
use std::time::Duration;
use tokio::signal::unix::{SignalKind, signal};
use tracing_subscriber::EnvFilter;

/// Take jobs over HTTP, solve them, keep them.
///
/// Settings are taken from the command line, else from the environment, else from the file, else they are the defaults.
#[derive(Debug, clap::Args)]
pub struct Arguments {
    /// A TOML file of settings: the names of these flags, without the dashes before them.
    #[arg(long, value_name = "FILE", env = "ARCSLIP_CONFIG")]
    config: Option<PathBuf>,
    /// Address and port to listen on. Addresses that other machines reach need --tokens-file or --open.
    #[arg(long, value_name = "ADDR", default_value = "127.0.0.1:8080", env = "ARCSLIP_LISTEN")]
    listen: SocketAddr,
    /// Where jobs are kept; created if it is not there.
    #[arg(long, value_name = "FILE", default_value = "arcslip.db", env = "ARCSLIP_DATABASE")]
    database: PathBuf,
    /// Solves at a time, 1 to 1024. Default: one a processor.
    #[arg(long, value_name = "N", env = "ARCSLIP_WORKERS", value_parser = clap::value_parser!(u16).range(1..=1024))]
    workers: Option<u16>,
    /// A worker that has not been heard of for so long has lost its job, which is then taken up by another; such as `10s`.
    #[arg(long, value_name = "DURATION", default_value = "10s", env = "ARCSLIP_LEASE", value_parser = duration::lease)]
    lease: Duration,
    /// A job fails that has lost so many workers in a row with nothing stored between.
    #[arg(long, value_name = "N", default_value_t = 3, env = "ARCSLIP_MAX_ATTEMPTS",
        value_parser = clap::value_parser!(u32).range(1..))]
    max_attempts: u32,
    /// Queue every built-in scene once.
    #[arg(long, env = "ARCSLIP_DEMO")]
    demo: bool,
    /// How the log is written; `RUST_LOG` says how much.
    #[arg(long, value_enum, default_value_t = LogFormat::Text, env = "ARCSLIP_LOG")]
    log: LogFormat,
    #[command(flatten)]
    access: access::Arguments,
    #[command(flatten)]
    limits: limits::Arguments,
}

#[derive(Debug, Clone, Copy, clap::ValueEnum)]
enum LogFormat {
    Text,
    Json,
}

pub fn run(arguments: &Arguments, settings: &[Setting]) -> Outcome {
    start_log(arguments.log);
    for Setting { name, value, from } in settings {
        tracing::info!(name, value, from, "setting");
    }
    let access = arguments.access.access(arguments.listen)?;
    tokio::runtime::Builder::new_multi_thread()
        .enable_all()
        .build()
        .map_err(Failure::other)?
        .block_on(serve(arguments, access))
}

async fn serve(arguments: &Arguments, access: Access) -> Outcome {
    // Heard from the start, so that a signal during start-up is not lost.
    let mut interrupt = signal(SignalKind::interrupt()).map_err(Failure::other)?;
    let mut terminate = signal(SignalKind::terminate()).map_err(Failure::other)?;
    let mut hang_up = signal(SignalKind::hangup()).map_err(Failure::other)?;
    let store = store::open(&arguments.database)
        .await
        .map_err(|error| Failure::Other(format!("--database {}: {error}", arguments.database.display())))?;
    let workers =
        arguments.workers.map_or_else(|| std::thread::available_parallelism().map_or(1, NonZero::get), usize::from);
    let Arguments { lease, max_attempts, limits, .. } = *arguments;
    let connections = arguments.access.connections();
    let front = Front { listen: arguments.listen, connections, access: access.clone() };
    let keep = limits.keep;
    let settings = Settings { workers, lease, max_attempts, limits: limits.limits(), keep, ..Settings::default() };
    let server = Server::start(front, store, Arc::new(PathSolver), settings).await.map_err(Failure::other)?;
    if arguments.demo {
        demonstration::queue_scenes(server.jobs()).await.map_err(Failure::other)?;
    }
    // Where standard output is closed, the log says the same.
    let _ = say(format_args!("arcslip listens on http://{}\n", server.address()));
    tracing::info!(address = %server.address(), database = %arguments.database.display(), workers, "listening");
    loop {
        tokio::select! {
            _ = interrupt.recv() => break,
            _ = terminate.recv() => break,
            _ = hang_up.recv() => read_again(&arguments.access, &access),
        }
    }
    tracing::info!("going down");
    if !server.stop().await {
        tracing::warn!("went down before everything had ended");
    }
    Ok(ExitCode::SUCCESS)
}

/// Exchanges the tokens; where the file is none, those before hold.
fn read_again(arguments: &access::Arguments, access: &Access) {
    if arguments.tokens_file.is_none() {
        return tracing::info!("SIGHUP: there is no file of tokens to be read again");
    }
    match arguments.tokens() {
        Ok(tokens) => {
            access.exchange(tokens);
            tracing::info!("the file of tokens has been read again");
        }
        Err(Failure::Input(lines)) => tracing::error!(?lines, "the tokens stay as they were"),
        Err(Failure::Other(error)) => tracing::error!(error, "the tokens stay as they were"),
    }
}

fn start_log(format: LogFormat) {
    let filter = EnvFilter::try_from_default_env().unwrap_or_else(|_| EnvFilter::new("info"));
    let log = tracing_subscriber::fmt()
        .with_env_filter(filter)
        .with_ansi(std::io::stderr().is_terminal())
        .with_writer(std::io::stderr);
    match format {
        LogFormat::Text => log.init(),
        LogFormat::Json => log.json().init(),
    }
    // A panic in a solve belongs to its job: in the log it stands under that job's span.
    std::panic::set_hook(Box::new(|panic| tracing::error!(%panic, "a panic")));
}

#[cfg(test)]
mod tests {
    use super::*;
    use clap::Parser;

    #[derive(Debug, clap::Parser)]
    struct Line {
        #[command(flatten)]
        arguments: Arguments,
    }

    #[test]
    fn a_service_has_a_bounded_number_of_workers_and_not_none() {
        let workers = |count: &str| {
            Line::try_parse_from(["serve".to_owned(), format!("--workers={count}")])
                .map(|line| line.arguments.workers)
                .map_err(|refusal| refusal.to_string())
        };
        assert_eq!(workers("1"), Ok(Some(1)));
        assert_eq!(workers("1024"), Ok(Some(1024)));
        for refused in ["0", "1025", "-1", "many"] {
            assert!(workers(refused).unwrap_err().contains("--workers"), "{refused}");
        }
    }
}
