//! `arcslip work`: workers alone, for a database that others serve.

use crate::command::options::service;
use crate::command::options::settings::Setting;
use crate::command::output::outcome::{Outcome, say};
use crate::service::jobs::workers::worker_pool::finish_shutdown;
use crate::service::jobs::{Jobs, PathSolver, WorkerPool};
use std::process::ExitCode;
use std::sync::Arc;
use tokio_util::sync::CancellationToken;

/// Solve jobs that are taken elsewhere, and listen on no port: any number of these, on any number of machines, share one
/// PostgreSQL database.
///
/// Settings are taken from the command line, else from the environment, else from the file, else they are the defaults.
#[derive(Debug, clap::Args)]
pub struct Arguments {
    /// Solves at a time, 1 to 1024. Default: one a processor.
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
    // Where standard output is closed, the log says the same.
    let _ = say(format_args!("arcslip works on {}\n", service.database));
    tracing::info!(database = %service.database, workers, "working");
    ends.asked().await;
    shutdown.cancel();
    if !finish_shutdown(pool.stopped(), jobs.store()).await {
        tracing::warn!("went down before everything had ended");
    }
    Ok(ExitCode::SUCCESS)
}
