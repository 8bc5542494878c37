//! Writes results to files or standard output.

use crate::command::output::outcome::{Failure, say};
use std::path::Path;

/// Whether a path is `-`, which stands for standard output.
pub fn is_standard_output(place: &Path) -> bool {
    place.as_os_str() == "-"
}

/// Writes a text to a file or to standard output.
pub fn write(place: &Path, text: &str) -> Result<(), Failure> {
    if is_standard_output(place) {
        return say(text);
    }
    std::fs::write(place, text).map_err(|error| Failure::Other(format!("{}: {error}", place.display())))
}

/// Refuses two results on standard output, which would be mixed. Each place is the name of an option and its value.
pub fn one_on_standard_output(results: &[(&str, Option<&Path>)]) -> Result<(), Failure> {
    let there: Vec<&str> =
        results.iter().filter(|(_, place)| place.is_some_and(is_standard_output)).map(|(option, _)| *option).collect();
    match there.as_slice() {
        [first, second, ..] => Err(Failure::Input(vec![format!(
            "{first} and {second} both go to standard output; give one of them a file"
        )])),
        _ => Ok(()),
    }
}
