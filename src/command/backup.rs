//! `arcslip backup`: copies the database, while the service runs or not.

use crate::command::output::outcome::{Failure, Outcome, say};
use crate::service::store::{self, Location};
use std::path::PathBuf;
use std::process::ExitCode;

/// Copy the database as a consistent snapshot, while the service runs; the copy is checked and can be served.
#[derive(Debug, clap::Args)]
pub struct Arguments {
    /// The database to copy.
    #[arg(long, value_name = "FILE", default_value = "arcslip.db", env = "ARCSLIP_DATABASE", hide_env_values = true)]
    database: Location,
    /// The file of the copy, which must not exist yet.
    #[arg(value_name = "COPY")]
    copy: PathBuf,
}

pub fn run(arguments: &Arguments) -> Outcome {
    let Arguments { database, copy } = arguments;
    let Location::File(database) = database else {
        return Err(Failure::Input(vec![format!(
            "--database {database}: a PostgreSQL database is copied by PostgreSQL's own means, such as pg_dump; a file would do"
        )]));
    };
    if copy.exists() {
        return Err(Failure::Input(vec![format!("{}: exists already; a new name is expected", copy.display())]));
    }
    if !database.exists() {
        return Err(Failure::Input(vec![format!("{}: there is no such database", database.display())]));
    }
    let runtime = tokio::runtime::Builder::new_current_thread().enable_all().build().map_err(Failure::other)?;
    runtime.block_on(store::back_up(database, copy)).map_err(|error| match std::error::Error::source(&error) {
        Some(source) => Failure::Other(format!("{error}: {source}")),
        None => Failure::other(error),
    })?;
    let bytes = std::fs::metadata(copy).map_err(Failure::other)?.len();
    say(format_args!("{}: {bytes} bytes\n", copy.display()))?;
    Ok(ExitCode::SUCCESS)
}
