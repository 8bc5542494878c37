//! Reads the model of a command.

use crate::check::scenes;
use crate::command::output::outcome::Failure;
use crate::model::{InputErrors, JobRequest, decode};
use std::io::{ErrorKind, Read};

/// The argument that names a model.
#[derive(Debug, clap::Args)]
pub struct Model {
    /// A file, `-` for standard input, or the name of a built-in scene.
    #[arg(value_name = "FILE")]
    file: String,
}

impl Model {
    pub fn read(&self) -> Result<JobRequest, Failure> {
        decode::decode(&self.text()?).map_err(refused)
    }

    pub fn text(&self) -> Result<Vec<u8>, Failure> {
        let unreadable = |error: std::io::Error| Failure::Input(vec![format!("{}: {error}", self.file)]);
        if self.file == "-" {
            let mut text = Vec::new();
            std::io::stdin().read_to_end(&mut text).map_err(unreadable)?;
            return Ok(text);
        }
        match std::fs::read(&self.file) {
            Ok(text) => Ok(text),
            Err(error) if error.kind() == ErrorKind::NotFound => match scenes::find(&self.file) {
                Some(scene) => Ok(scene.request.as_bytes().to_vec()),
                None => Err(Failure::Input(vec![format!(
                    "{}: neither a file nor a built-in scene (`arcslip scenes` lists those)",
                    self.file
                )])),
            },
            Err(error) => Err(unreadable(error)),
        }
    }
}

/// One line per mistake: `place: detail`.
pub fn refused(errors: InputErrors) -> Failure {
    Failure::Input(errors.0.iter().map(ToString::to_string).collect())
}
