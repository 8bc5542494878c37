//! What `study` and `sweep` have found, written down as asked, and how far they have come.

use crate::command::output::outcome::Failure;
use crate::command::output::written::{one_on_standard_output, write};
use crate::studies::picture::findings::Findings;
use indicatif::{ProgressBar, ProgressStyle};
use std::io::IsTerminal;
use std::path::{Path, PathBuf};

/// Where findings go.
#[derive(Debug, clap::Args)]
pub struct Written {
    /// Write the table here; `-` is standard output.
    #[arg(long, value_name = "FILE", default_value = "-")]
    out: PathBuf,
    #[arg(long, value_enum, default_value_t = Format::Text)]
    format: Format,
    /// Draw the picture here, as an SVG; `-` is standard output.
    #[arg(long, value_name = "FILE")]
    plot: Option<PathBuf>,
}

#[derive(Debug, Clone, Copy, PartialEq, Eq, clap::ValueEnum)]
enum Format {
    /// Columns for a reader.
    Text,
    /// A table with named columns.
    Csv,
    /// All of it as one JSON object.
    Json,
}

impl Written {
    /// Before anything is traced.
    ///
    /// # Errors
    /// Two things that go to the same place, or a place in a folder that is not there.
    pub fn check(&self) -> Result<(), Failure> {
        let places = [("--out", Some(self.out.as_path())), ("--plot", self.plot.as_deref())];
        for (option, place) in places {
            let folder = place.and_then(Path::parent).filter(|folder| !folder.as_os_str().is_empty());
            if let Some(folder) = folder.filter(|folder| !folder.is_dir()) {
                return Err(Failure::Input(vec![format!("{option}: there is no folder {}", folder.display())]));
            }
        }
        one_on_standard_output(&places)
    }

    /// # Errors
    /// A file that cannot be written, or nothing that could be drawn.
    pub fn write(&self, findings: &impl Findings) -> Result<(), Failure> {
        let text = match self.format {
            Format::Text => findings.text(),
            Format::Csv => findings.csv(),
            Format::Json => serde_json::to_string_pretty(findings).map(|text| text + "\n"),
        };
        write(&self.out, &text.map_err(Failure::other)?)?;
        match &self.plot {
            Some(file) => write(file, &findings.svg().map_err(Failure::other)?),
            None => Ok(()),
        }
    }
}

/// On a terminal, where it does not disturb the table: that comes when all is done.
pub fn progress_bar(paths: u64) -> ProgressBar {
    if !std::io::stderr().is_terminal() {
        return ProgressBar::hidden();
    }
    let style = ProgressStyle::with_template("{bar:40} {pos} of {len} paths, {elapsed}")
        .unwrap_or_else(|_| ProgressStyle::default_bar());
    ProgressBar::new(paths).with_style(style)
}
