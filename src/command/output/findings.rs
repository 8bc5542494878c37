//! Writes the findings of `study`, `sweep` and `continue` in the selected format, and shows their progress.

use crate::command::output::outcome::Failure;
use crate::command::output::picture_file::PictureFile;
use crate::command::output::written::{folders_exist, one_on_standard_output, write};
use crate::studies::picture::findings::Findings;
use indicatif::{ProgressBar, ProgressStyle};
use std::io::IsTerminal;
use std::path::PathBuf;

/// The arguments for the output of findings.
#[derive(Debug, clap::Args)]
pub struct Written {
    /// Write the table to this file; `-` is standard output.
    #[arg(long, value_name = "FILE", default_value = "-")]
    out: PathBuf,
    #[arg(long, value_enum, default_value_t = Format::Text)]
    format: Format,
    /// Draw the picture to this file, as SVG or PNG by its extension; `-` is standard output.
    #[arg(long, value_name = "FILE")]
    plot: Option<PathBuf>,
}

#[derive(Debug, Clone, Copy, PartialEq, Eq, clap::ValueEnum)]
enum Format {
    /// Aligned columns of text.
    Text,
    /// A table with named columns.
    Csv,
    /// Everything as one JSON object.
    Json,
}

impl Written {
    /// Checks the output files before anything is traced.
    ///
    /// # Errors
    /// Two outputs have the same file, the folder of a file does not exist, or the extension of a picture is unknown.
    pub fn check(&self) -> Result<(), Failure> {
        let places = [("--out", Some(self.out.as_path())), ("--plot", self.plot.as_deref())];
        folders_exist(&places)?;
        self.picture()?;
        one_on_standard_output(&places)
    }

    /// # Errors
    /// A file cannot be written, or there is nothing to draw.
    pub fn write(&self, findings: &impl Findings) -> Result<(), Failure> {
        let text = match self.format {
            Format::Text => findings.text(),
            Format::Csv => findings.csv(),
            Format::Json => serde_json::to_string_pretty(findings).map(|text| text + "\n"),
        };
        write(&self.out, &text.map_err(Failure::other)?)?;
        match self.picture()? {
            Some(file) => file.write(&findings.svg().map_err(Failure::other)?),
            None => Ok(()),
        }
    }

    fn picture(&self) -> Result<Option<PictureFile<'_>>, Failure> {
        PictureFile::of("--plot", self.plot.as_deref())
    }
}

/// A count that grows, on a terminal.
pub fn counter(what: &'static str) -> ProgressBar {
    if !std::io::stderr().is_terminal() {
        return ProgressBar::hidden();
    }
    let style = ProgressStyle::with_template("{spinner} {pos} {msg}, {elapsed}")
        .unwrap_or_else(|_| ProgressStyle::default_spinner());
    ProgressBar::no_length().with_style(style).with_message(what)
}

/// The progress bar, on a terminal; the table is only written at the end.
pub fn progress_bar(paths: u64) -> ProgressBar {
    if !std::io::stderr().is_terminal() {
        return ProgressBar::hidden();
    }
    let style = ProgressStyle::with_template("{bar:40} {pos} of {len} paths, {elapsed}")
        .unwrap_or_else(|_| ProgressStyle::default_bar());
    ProgressBar::new(paths).with_style(style)
}
