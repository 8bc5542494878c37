//! What `serve` and `work` share: the database, the settings of workers, the log, and the signals that end a service.

use crate::command::options::settings::Setting;
use crate::command::options::{duration, limits};
use crate::command::output::outcome::Failure;
use crate::service::jobs::Settings;
use crate::service::store::contract::interface::Store;
use crate::service::store::{self, Location};
use std::io::IsTerminal;
use std::num::NonZero;
use std::path::PathBuf;
use std::sync::Arc;
use std::time::Duration;
use tokio::signal::unix::{Signal, SignalKind, signal};
use tracing_subscriber::filter::Targets;
use tracing_subscriber::prelude::*;

#[derive(Debug, Clone, clap::Args)]
#[group(skip)]
pub struct Arguments {
    /// A TOML file of settings; its keys are the names of these flags without the leading dashes.
    #[arg(long, value_name = "FILE", env = "ARCSLIP_CONFIG")]
    config: Option<PathBuf>,
    /// The database: a file, created if it does not exist, or `postgres://USER@HOST:PORT/DATABASE`, which processes on many
    /// machines share.
    #[arg(
        long,
        value_name = "FILE|URL",
        default_value = "arcslip.db",
        env = "ARCSLIP_DATABASE",
        hide_env_values = true
    )]
    pub database: Location,
    /// A worker that has not renewed its lease for this time, such as `10s`, has lost its job, which another one then resumes.
    #[arg(long, value_name = "DURATION", default_value = "10s", env = "ARCSLIP_LEASE", value_parser = duration::lease)]
    lease: Duration,
    /// The format of the log; `RUST_LOG` sets its level.
    #[arg(long, value_enum, default_value_t = LogFormat::Text, env = "ARCSLIP_LOG")]
    log: LogFormat,
    #[command(flatten)]
    limits: limits::Arguments,
}

#[derive(Debug, Clone, Copy, clap::ValueEnum)]
enum LogFormat {
    Text,
    Json,
}

impl Arguments {
    /// The settings, with the given number of workers or one per processor.
    pub fn settings(&self, workers: Option<u16>) -> Settings {
        let processors = || std::thread::available_parallelism().map_or(1, NonZero::get);
        Settings {
            workers: workers.map_or_else(processors, usize::from),
            lease: self.lease,
            limits: self.limits.limits(),
            keep: self.limits.keep,
            ..Settings::default()
        }
    }

    pub async fn open(&self) -> Result<Arc<dyn Store>, Failure> {
        let database = &self.database;
        store::open(database.clone()).await.map_err(|error| Failure::Other(format!("--database {database}: {error}")))
    }

    /// Starts the log, with every setting in force.
    pub fn start_log(&self, settings: &[Setting]) {
        let chosen = std::env::var("RUST_LOG").ok().and_then(|targets| targets.parse::<Targets>().ok());
        let targets = chosen.unwrap_or_else(|| Targets::new().with_default(tracing::Level::INFO));
        let log =
            tracing_subscriber::fmt::layer().with_ansi(std::io::stderr().is_terminal()).with_writer(std::io::stderr);
        let layers = tracing_subscriber::registry().with(targets);
        match self.log {
            LogFormat::Text => layers.with(log).init(),
            LogFormat::Json => layers.with(log.json()).init(),
        }
        // A panic is logged within the span of the job whose solve panicked.
        std::panic::set_hook(Box::new(|panic| tracing::error!(%panic, "a panic")));
        for Setting { name, value, from } in settings {
            tracing::info!(name, value, from, "setting");
        }
    }
}

/// Runs a service until it has ended.
pub fn run<T>(service: impl Future<Output = Result<T, Failure>>) -> Result<T, Failure> {
    let runtime = tokio::runtime::Builder::new_multi_thread().enable_all().build().map_err(Failure::other)?;
    let outcome = runtime.block_on(service);
    // Checks for clients that have disconnected are not waited for.
    runtime.shutdown_background();
    outcome
}

/// The signals that ask a service to end.
pub struct Ends {
    interrupt: Signal,
    terminate: Signal,
}

impl Ends {
    /// Listens from now on, so that a signal during start-up is not lost.
    pub fn heard() -> Result<Self, Failure> {
        let hear = |kind| signal(kind).map_err(Failure::other);
        Ok(Self { interrupt: hear(SignalKind::interrupt())?, terminate: hear(SignalKind::terminate())? })
    }

    pub async fn asked(&mut self) {
        tokio::select! {
            _ = self.interrupt.recv() => {}
            _ = self.terminate.recv() => {}
        }
        tracing::info!("shutting down");
    }
}
