//! Writes results to files or standard output.

use crate::command::output::outcome::{Failure, say};
use std::path::Path;

/// Whether a path is `-`, which stands for standard output, or standard input where something is read.
pub fn is_standard_output(place: &Path) -> bool {
    place.as_os_str() == "-"
}

/// Writes a text to a file or to standard output.
pub fn write(place: &Path, text: &str) -> Result<(), Failure> {
    if is_standard_output(place) {
        return say(text);
    }
    write_file(place, text.as_bytes())
}

/// Writes bytes to a file.
pub fn write_file(place: &Path, content: &[u8]) -> Result<(), Failure> {
    std::fs::write(place, content).map_err(|error| Failure::Other(format!("{}: {error}", place.display())))
}

/// Refuses a file in a folder that does not exist, before anything is traced. Each place is the name of an option and its
/// value.
pub fn folders_exist(results: &[(&str, Option<&Path>)]) -> Result<(), Failure> {
    for (option, place) in results {
        let folder = place.and_then(Path::parent).filter(|folder| !folder.as_os_str().is_empty());
        if let Some(folder) = folder.filter(|folder| !folder.is_dir()) {
            return Err(Failure::Input(vec![format!("{option}: there is no folder {}", folder.display())]));
        }
    }
    Ok(())
}

/// The extension of a file's name in lower case, if it has one.
pub fn extension(place: &Path) -> Option<String> {
    place.extension().map(|extension| extension.to_string_lossy().to_lowercase())
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
