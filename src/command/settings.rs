//! Settings of `serve`: from the command line, else from the environment, else from a file (`--config`), else the default.
//!
//! The file is TOML; its keys are the names of the flags. What it holds takes the place of the defaults, so that there is
//! one reader for every value wherever it comes from.

use super::Failure;
use crate::model::names::{quoted, suggestion_of_all};
use clap::parser::ValueSource;
use clap::{ArgMatches, Command};
use std::path::{Path, PathBuf};

/// The subcommand whose settings these are, and its flag that names the file.
const SERVE: &str = "serve";
const CONFIG: &str = "config";

/// A setting in force.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Setting {
    pub name: String,
    pub value: String,
    pub from: &'static str,
}

/// A value of the file as it would stand on the command line; several for a list.
type Value = (String, Vec<String>);

/// Reads the command line, with the settings' file where one is named.
///
/// # Errors
/// A file that cannot be read, or holds what is no setting. What is wrong on the command line itself ends the process, with
/// the usual text.
pub fn parse(command: fn() -> Command) -> Result<ArgMatches, Failure> {
    let matches = command().get_matches();
    let file = matches.subcommand_matches(SERVE).and_then(|serve| serve.get_one::<PathBuf>(CONFIG));
    let Some(file) = file else { return Ok(matches) };
    let bad = |detail: String| Failure::Input(vec![format!("{}: {detail}", file.display())]);
    let values = read(file, &command()).map_err(bad)?;
    with_defaults(command(), values).try_get_matches().map_err(|error| bad(error.to_string()))
}

/// Every setting of `serve`, by name.
pub fn in_force(mut command: Command, matches: &ArgMatches) -> Vec<Setting> {
    let Some(serve) = matches.subcommand_matches(SERVE) else { return Vec::new() };
    // Only then flags without a value have their default.
    command.build();
    let usual = flags(&command);
    let mut settings: Vec<Setting> = usual
        .iter()
        .filter_map(|argument| {
            let id = argument.get_id().as_str();
            let name = argument.get_long()?.to_owned();
            let Some(values) = serve.get_raw(id) else {
                return Some(Setting { name, value: "not set".to_owned(), from: "default" });
            };
            let value = values.map(|value| value.to_string_lossy()).collect::<Vec<_>>().join(",");
            let from = match serve.value_source(id)? {
                ValueSource::CommandLine => "the command line",
                ValueSource::EnvVariable => "the environment",
                _ if argument.get_default_values().iter().map(|known| known.to_string_lossy()).eq([value.as_str()]) => {
                    "default"
                }
                _ => "the file",
            };
            Some(Setting { name, value, from })
        })
        .collect();
    settings.sort_by(|one, other| one.name.cmp(&other.name));
    settings
}

fn flags(command: &Command) -> Vec<clap::Arg> {
    let serve = command.find_subcommand(SERVE);
    let named = |argument: &&clap::Arg| {
        argument.get_long().is_some() && !matches!(argument.get_id().as_str(), "help" | "version")
    };
    serve.into_iter().flat_map(Command::get_arguments).filter(named).cloned().collect()
}

fn read(file: &Path, command: &Command) -> Result<Vec<Value>, String> {
    let text = std::fs::read_to_string(file).map_err(|error| error.to_string())?;
    let table: toml::Table = text.parse().map_err(|error: toml::de::Error| error.to_string())?;
    let known: Vec<String> = flags(command)
        .iter()
        .filter_map(|argument| argument.get_long().map(str::to_owned))
        .filter(|name| name != CONFIG)
        .collect();
    table
        .into_iter()
        .map(|(name, value)| {
            if !known.contains(&name) {
                let nearest = suggestion_of_all(&name, known.iter().map(String::as_str));
                return Err(format!("there is no setting {}{nearest}", quoted(&name)));
            }
            let values = match value {
                toml::Value::Array(values) => values.into_iter().map(|value| plain(&name, value)).collect(),
                value => plain(&name, value).map(|value| vec![value]),
            };
            Ok((name, values?))
        })
        .collect()
}

fn plain(name: &str, value: toml::Value) -> Result<String, String> {
    match value {
        toml::Value::String(text) => Ok(text),
        toml::Value::Integer(number) => Ok(number.to_string()),
        toml::Value::Boolean(flag) => Ok(flag.to_string()),
        other => Err(format!("{name}: found a {}; a text, a whole number or true or false would do", other.type_str())),
    }
}

fn with_defaults(command: Command, values: Vec<Value>) -> Command {
    command.mut_subcommand(SERVE, |mut serve| {
        for (name, values) in values {
            // Identifiers are the flags' names, with `_` for `-`.
            serve = serve.mut_arg(name.replace('-', "_"), |argument| argument.default_values(values));
        }
        serve
    })
}
