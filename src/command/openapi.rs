//! `arcslip openapi`: prints the OpenAPI description that is committed under `openapi/`.

use crate::command::output::outcome::{Failure, Outcome, say};
use std::process::ExitCode;

/// Print the OpenAPI document.
#[derive(Debug, clap::Args)]
pub struct Arguments {}

pub fn run(_arguments: &Arguments) -> Outcome {
    say(crate::service::http::router::openapi_json().map_err(Failure::other)?)?;
    Ok(ExitCode::SUCCESS)
}
