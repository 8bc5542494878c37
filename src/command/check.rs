//! `arcslip check`: is this model all right, and what would be done?

use super::{Failure, Outcome, input};
use crate::path::Scene;
use std::process::ExitCode;

/// Check a model and print its plan.
#[derive(Debug, clap::Args)]
pub struct Arguments {
    #[command(flatten)]
    model: input::Model,
}

pub fn run(arguments: &Arguments) -> Outcome {
    let scene = Scene::new(&arguments.model.read()?).map_err(input::refused)?;
    println!("{}", serde_json::to_string_pretty(scene.plan()).map_err(Failure::other)?);
    Ok(ExitCode::SUCCESS)
}
