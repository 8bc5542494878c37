//! `arcslip work`: workers without HTTP, for a database that other processes serve.

use crate::command::options::service;
use crate::command::options::settings::Setting;
use crate::command::output::outcome::{Outcome, say};
use crate::service::jobs::workers::worker_pool::finish_shutdown;
use crate::service::jobs::{Jobs, PathSolver, WorkerPool};
use std::process::ExitCode;
use std::sync::Arc;
use tokio_util::sync::CancellationToken;

/// Solve queued jobs without listening on a port: any number of such processes, on any number of machines, share a PostgreSQL
/// database.
///
/// Settings are taken from the command line, else from the environment, else from the file; otherwise the defaults apply.
#[derive(Debug, clap::Args)]
pub struct Arguments {
    /// Number of workers, 1 to 1024. Default: one per processor.
    #[arg(long, value_name = "N", env = "ARCSLIP_WORKERS", value_parser = clap::value_parser!(u16).range(1..=1024))]
    workers: Option<u16>,
    #[command(flatten)]
    service: service::Arguments,
}

pub fn run(arguments: &Arguments, settings: &[Setting]) -> Outcome {
    arguments.service.start_log(settings);
    service::run(work(arguments))
}

async fn work(arguments: &Arguments) -> Outcome {
    let service = &arguments.service;
    let mut ends = service::Ends::heard()?;
    let store = service.open().await?;
    let jobs = Jobs::new(store, Arc::new(PathSolver), service.settings(arguments.workers));
    let shutdown = CancellationToken::new();
    let pool = WorkerPool::start(&jobs, &shutdown);
    let workers = pool.worker_count().expected();
    // The log has the same message, in case standard output is closed.
    let _ = say(format_args!("arcslip works on {}\n", service.database));
    tracing::info!(database = %service.database, workers, "working");
    ends.asked().await;
    shutdown.cancel();
    if !finish_shutdown(pool.stopped(), jobs.store()).await {
        tracing::warn!("shut down before everything had ended");
    }
    Ok(ExitCode::SUCCESS)
}
