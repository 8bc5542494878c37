//! Reads the model of a command.

use crate::check::scenes;
use crate::command::options::embedded_mesh;
use crate::command::output::outcome::Failure;
use crate::model::input::names::nearest;
use crate::model::{InputErrors, JobRequest, decode};
use clap::ArgMatches;
use serde_json::json;
use std::io::{ErrorKind, Read};
use std::path::Path;

/// The argument that names a model.
#[derive(Debug, clap::Args)]
pub struct Model {
    /// A file, `-` for standard input, or the name of a built-in scene.
    #[arg(value_name = "FILE")]
    file: String,
    /// How mistakes in the model are written to standard error.
    #[arg(long, value_enum, default_value = "text", value_name = "FORMAT")]
    mistakes: MistakeFormat,
}

impl Model {
    pub fn read(&self) -> Result<JobRequest, Failure> {
        decode::decode(&self.text()?).map_err(refused)
    }

    pub fn is_standard_input(&self) -> bool {
        self.file == "-"
    }

    pub fn text(&self) -> Result<Vec<u8>, Failure> {
        let unreadable = |error: std::io::Error| Failure::Input(vec![format!("{}: {error}", self.file)]);
        if self.is_standard_input() {
            let mut text = Vec::new();
            std::io::stdin().read_to_end(&mut text).map_err(unreadable)?;
            return with_mesh(text, Path::new(""));
        }
        match std::fs::read(&self.file) {
            Ok(text) => with_mesh(text, Path::new(&self.file)),
            Err(error) if error.kind() == ErrorKind::NotFound => match scenes::find(&self.file) {
                Some(scene) => Ok(scene.request.as_bytes().to_vec()),
                None => {
                    let nearest = nearest(&self.file, scenes::ALL.iter().map(|scene| scene.name));
                    let meant = nearest.map_or_else(String::new, |name| format!("; did you mean `{name}`?"));
                    Err(Failure::Input(vec![format!(
                        "{}: neither a file nor a built-in scene (`arcslip scenes` lists those){meant}",
                        self.file
                    )]))
                }
            },
            Err(error) => Err(unreadable(error)),
        }
    }
}

fn with_mesh(text: Vec<u8>, request: &Path) -> Result<Vec<u8>, Failure> {
    embedded_mesh::embed(text, request).map_err(|detail| Failure::Input(vec![detail]))
}

/// The failure of a document with mistakes.
pub fn refused(errors: InputErrors) -> Failure {
    Failure::Document(errors)
}

/// How the mistakes of a document are written to standard error.
#[derive(Debug, Clone, Copy, PartialEq, Eq, clap::ValueEnum)]
pub enum MistakeFormat {
    /// One line for each: its place, and what is wrong there.
    Text,
    /// One JSON object, `{"errors": [{"pointer": "/model/nodes", "detail": "..."}]}`, as in the answers of the service.
    Json,
}

impl MistakeFormat {
    /// The format asked for on the command line; text for commands that read no model.
    pub fn asked(matches: &ArgMatches) -> Self {
        let command = matches.subcommand().map(|(_, command)| command);
        let asked = command.and_then(|command| command.try_get_one::<Self>("mistakes").ok().flatten());
        asked.copied().unwrap_or(Self::Text)
    }

    pub fn write(self, errors: &InputErrors) -> String {
        match self {
            Self::Text => errors.to_string(),
            Self::Json => json!({ "errors": errors }).to_string(),
        }
    }
}
