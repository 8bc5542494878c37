//! `arcslip serve`: the HTTP service and its workers.

use crate::command::options::settings::Setting;
use crate::command::options::{access, service};
use crate::command::output::outcome::{Failure, Outcome, say};
use crate::service::http::access::Access;
use crate::service::http::server::{ListenOptions, Server};
use crate::service::jobs::queue::demonstration;
use crate::service::jobs::{PathSolver, Settings};
use std::net::SocketAddr;
use std::process::ExitCode;
use std::sync::Arc;
use tokio::signal::unix::{SignalKind, signal};

/// Accept jobs over HTTP, solve and store them.
///
/// Settings are taken from the command line, else from the environment, else from the file; otherwise the defaults apply.
#[derive(Debug, clap::Args)]
pub struct Arguments {
    /// Address and port to listen on. Addresses that other machines reach need --tokens-file or --open.
    #[arg(long, value_name = "ADDR", default_value = "127.0.0.1:8080", env = "ARCSLIP_LISTEN")]
    listen: SocketAddr,
    /// Number of workers, 0 to 1024; with 0 other processes solve: see `arcslip work`. Default: one per processor.
    #[arg(long, value_name = "N", env = "ARCSLIP_WORKERS", value_parser = clap::value_parser!(u16).range(0..=1024))]
    workers: Option<u16>,
    /// A job that has lost this many workers in a row without storing anything in between fails.
    #[arg(long, value_name = "N", default_value_t = 3, env = "ARCSLIP_MAX_ATTEMPTS",
        value_parser = clap::value_parser!(u32).range(1..))]
    max_attempts: u32,
    /// Queue every built-in scene once.
    #[arg(long, env = "ARCSLIP_DEMO")]
    demo: bool,
    #[command(flatten)]
    access: access::Arguments,
    #[command(flatten)]
    service: service::Arguments,
}

pub fn run(arguments: &Arguments, settings: &[Setting]) -> Outcome {
    arguments.service.start_log(settings);
    let access = arguments.access.access(arguments.listen)?;
    service::run(serve(arguments, access))
}

async fn serve(arguments: &Arguments, access: Access) -> Outcome {
    let service = &arguments.service;
    let mut ends = service::Ends::heard()?;
    let mut hang_up = signal(SignalKind::hangup()).map_err(Failure::other)?;
    let store = service.open().await?;
    let connections = arguments.access.connections();
    let front = ListenOptions { listen: arguments.listen, connections, access: access.clone() };
    let settings = Settings { max_attempts: arguments.max_attempts, ..service.settings(arguments.workers) };
    let workers = settings.workers;
    let server = Server::start(front, store, Arc::new(PathSolver), settings).await.map_err(Failure::other)?;
    if arguments.demo {
        demonstration::queue_scenes(server.jobs()).await.map_err(Failure::other)?;
    }
    // The log has the same message, in case standard output is closed; the address is the last that a reader sees.
    tracing::info!(address = %server.address(), database = %service.database, workers, "listening");
    let _ = say(format_args!("arcslip listens on http://{}\n", server.address()));
    loop {
        tokio::select! {
            () = ends.asked() => break,
            _ = hang_up.recv() => read_again(&arguments.access, &access),
        }
    }
    if !server.stop().await {
        tracing::warn!("shut down before everything had ended");
    }
    Ok(ExitCode::SUCCESS)
}

/// Replaces the tokens; if the file cannot be read, the old ones remain valid.
fn read_again(arguments: &access::Arguments, access: &Access) {
    if arguments.tokens_file.is_none() {
        return tracing::info!("SIGHUP: no file of tokens is given");
    }
    match arguments.tokens() {
        Ok(tokens) => {
            access.exchange(tokens);
            tracing::info!("the file of tokens has been read again");
        }
        Err(Failure::Input(lines)) => tracing::error!(?lines, "the tokens stay as they were"),
        Err(Failure::Document(errors)) => tracing::error!(%errors, "the tokens stay as they were"),
        Err(Failure::Other(error)) => tracing::error!(error, "the tokens stay as they were"),
    }
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
    fn a_service_has_a_bounded_number_of_workers() {
        let workers = |count: &str| {
            Line::try_parse_from(["serve".to_owned(), format!("--workers={count}")])
                .map(|line| line.arguments.workers)
                .map_err(|refusal| refusal.to_string())
        };
        assert_eq!(workers("0"), Ok(Some(0)));
        assert_eq!(workers("1024"), Ok(Some(1024)));
        for refused in ["1025", "-1", "many"] {
            assert!(workers(refused).unwrap_err().contains("--workers"), "{refused}");
        }
    }
}
