//! Settings of `serve` and `work`: from the command line, else from the environment, else from a file (`--config`), else defaults.
//!
//! The file is TOML; its keys are the names of the flags. Its values replace the defaults of the flags, so that every value is
//! parsed in the same way. One file serves both commands: each reads its own settings.

use crate::command::output::outcome::Failure;
use crate::model::input::names::{quoted, suggestion_of_all};
use crate::service::store::Location;
use clap::parser::ValueSource;
use clap::{ArgAction, ArgMatches, Command};
use std::path::{Path, PathBuf};

/// The subcommands with these settings; the flags of the file, and of the database, whose password is not logged.
const SERVICES: [&str; 2] = ["serve", "work"];
const CONFIG: &str = "config";
const DATABASE: &str = "database";

/// A setting in force.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Setting {
    pub name: String,
    pub value: String,
    pub from: &'static str,
}

/// A value of the file as text for the command line; several for a list.
type Value = (String, Vec<String>);

/// Reads the command line, and the file of settings if one is given.
///
/// # Errors
/// The file cannot be read, or has an unknown setting. A mistake on the command line ends the process with the usual
/// message.
pub fn parse(command: fn() -> Command) -> Result<ArgMatches, Failure> {
    let matches = command().get_matches();
    let service = matches.subcommand().filter(|(name, _)| SERVICES.contains(name));
    let file = service.and_then(|(name, service)| Some((name, service.get_one::<PathBuf>(CONFIG)?)));
    let Some((service, file)) = file else { return Ok(matches) };
    let bad = |detail: String| Failure::Input(vec![format!("{}: {detail}", file.display())]);
    let values = read(file, &command()).map_err(bad)?;
    with_defaults(command(), service, values).try_get_matches().map_err(|error| bad(error.to_string()))
}

/// Every setting of the selected subcommand, by name.
pub fn in_force(mut command: Command, matches: &ArgMatches) -> Vec<Setting> {
    let Some((name, service)) = matches.subcommand().filter(|(name, _)| SERVICES.contains(name)) else {
        return Vec::new();
    };
    // Flags without a value only have their default then.
    command.build();
    let usual = flags(&command, name);
    let mut settings: Vec<Setting> = usual
        .iter()
        .filter_map(|argument| {
            let id = argument.get_id().as_str();
            let name = argument.get_long()?.to_owned();
            let Some(values) = service.get_raw(id) else {
                return Some(Setting { name, value: "not set".to_owned(), from: "default" });
            };
            let value = values.map(|value| value.to_string_lossy()).collect::<Vec<_>>().join(",");
            let from = match service.value_source(id)? {
                ValueSource::CommandLine => "the command line",
                ValueSource::EnvVariable => "the environment",
                _ if argument.get_default_values().iter().map(|known| known.to_string_lossy()).eq([value.as_str()]) => {
                    "default"
                }
                _ => "the file",
            };
            let value = if id == DATABASE { Location::from(value.as_str()).to_string() } else { value };
            Some(Setting { name, value, from })
        })
        .collect();
    settings.sort_by(|one, other| one.name.cmp(&other.name));
    settings
}

fn flags(command: &Command, service: &str) -> Vec<clap::Arg> {
    let service = command.find_subcommand(service);
    let named = |argument: &&clap::Arg| {
        argument.get_long().is_some() && !matches!(argument.get_id().as_str(), "help" | "version")
    };
    service.into_iter().flat_map(Command::get_arguments).filter(named).cloned().collect()
}

fn read(file: &Path, command: &Command) -> Result<Vec<Value>, String> {
    let text = std::fs::read_to_string(file).map_err(|error| error.to_string())?;
    let table: toml::Table = text.parse().map_err(|error: toml::de::Error| error.to_string())?;
    // For each setting, whether it takes several values.
    let known: Vec<(String, bool)> = SERVICES
        .iter()
        .flat_map(|service| flags(command, service))
        .filter_map(|flag| Some((flag.get_long()?.to_owned(), matches!(flag.get_action(), ArgAction::Append))))
        .filter(|(name, _)| name != CONFIG)
        .collect();
    table
        .into_iter()
        .map(|(name, value)| {
            let Some((_, takes_several)) = known.iter().find(|(known, _)| *known == name) else {
                let nearest = suggestion_of_all(&name, known.iter().map(|(name, _)| name.as_str()));
                return Err(format!("there is no setting {}{nearest}", quoted(&name)));
            };
            let values = match value {
                toml::Value::Array(_) if !takes_several => Err(format!("{name}: found a list; one value is expected")),
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

fn with_defaults(command: Command, service: &str, values: Vec<Value>) -> Command {
    let own: Vec<String> =
        flags(&command, service).iter().filter_map(|flag| flag.get_long().map(str::to_owned)).collect();
    command.mut_subcommand(service, |mut service| {
        for (name, values) in values.into_iter().filter(|(name, _)| own.contains(name)) {
            // Identifiers are the names of the flags, with `_` for `-`.
            service = service.mut_arg(name.replace('-', "_"), |argument| argument.default_values(values));
        }
        service
    })
}
