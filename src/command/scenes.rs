//! `arcslip scenes`: the built-in scenes.

use crate::check::scenes;
use crate::command::output::outcome::{Failure, Outcome, say};
use crate::model::input::names::suggestion_of_all;
use std::process::ExitCode;

/// List the built-in scenes, or print the job request of one.
#[derive(Debug, clap::Args)]
pub struct Arguments {
    /// Print this scene's job request instead.
    name: Option<String>,
}

pub fn run(arguments: &Arguments) -> Outcome {
    match &arguments.name {
        Some(name) => match scenes::find(name) {
            Some(scene) => say(scene.request)?,
            None => {
                let nearest = suggestion_of_all(name, scenes::ALL.iter().map(|scene| scene.name));
                return Err(Failure::Input(vec![format!("{name}: no built-in scene has this name{nearest}")]));
            }
        },
        None => {
            let width = scenes::ALL.iter().map(|scene| scene.name.len()).max().unwrap_or_default();
            for scene in scenes::ALL {
                say(format_args!("{:width$}  {}\n", scene.name, scene.shows))?;
            }
        }
    }
    Ok(ExitCode::SUCCESS)
}
