//! `arcslip check`: checks a model and prints its plan.

use crate::command::options::{bounds, input};
use crate::command::output::outcome::{Failure, Outcome, say};
use crate::continuation::scene::Scene;
use std::process::ExitCode;

/// Check a model and print its plan.
#[derive(Debug, clap::Args)]
pub struct Arguments {
    #[command(flatten)]
    model: input::Model,
    #[command(flatten)]
    pub(super) bounds: bounds::Arguments,
}

pub fn run(arguments: &Arguments) -> Outcome {
    let scene = Scene::new(&arguments.model.read()?).map_err(input::refused)?;
    say(serde_json::to_string_pretty(scene.plan()).map_err(Failure::other)? + "\n")?;
    Ok(ExitCode::SUCCESS)
}
