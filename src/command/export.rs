//! `arcslip export`: writes the increments of a solved path in another format.

use crate::check::judged::JudgedIncrement;
use crate::command::options::input;
use crate::command::output::outcome::{Failure, Outcome};
use crate::command::output::path_file::{Format, PathFile};
use crate::command::output::path_picture::PathPicture;
use crate::command::output::picture_file::PictureFile;
use crate::command::output::written::{folders_exist, is_standard_output, one_on_standard_output};
use std::fs::File;
use std::io::{self, BufRead, BufReader};
use std::path::{Path, PathBuf};
use std::process::ExitCode;

/// Write a path that is solved already in another format, or draw it: what `solve --out path.ndjson` or a service gave.
#[derive(Debug, clap::Args)]
pub struct Arguments {
    #[command(flatten)]
    model: input::Model,
    /// The increments of the model's path, one JSON object a line; `-` is standard input.
    #[arg(value_name = "PATH")]
    path: PathBuf,
    /// Write increments here; `-` is standard output.
    #[arg(long, value_name = "FILE", required_unless_present = "plot")]
    out: Option<PathBuf>,
    /// Default: what the extension of `--out` says, `ndjson` where it has none.
    #[arg(long, value_enum, requires = "out")]
    format: Option<Format>,
    /// Draw load factor against a displacement here, as SVG or PNG by the extension; `-` is standard output.
    #[arg(long, value_name = "FILE")]
    plot: Option<PathBuf>,
    /// What to draw, such as `tip.x` or `elements/0.axial_force`. Default: the largest displacement.
    #[arg(long, value_name = "NODE.COMPONENT|COLUMN", requires = "plot")]
    against: Option<String>,
}

pub fn run(arguments: &Arguments) -> Outcome {
    let results = [("--out", arguments.out.as_deref()), ("--plot", arguments.plot.as_deref())];
    one_on_standard_output(&results)?;
    folders_exist(&results)?;
    let picture_file = PictureFile::of("--plot", arguments.plot.as_deref())?;
    let file = arguments.out.as_deref().map(|out| Ok((out, Format::of(arguments.format, out)?))).transpose()?;
    if arguments.model.is_standard_input() && is_standard_output(&arguments.path) {
        return Err(Failure::Input(vec!["the model and the path cannot both be standard input".to_owned()]));
    }
    let request = arguments.model.read()?;
    let mut lines = lines(&arguments.path)?.peekable();
    // A path that cannot be read does not overwrite an earlier result.
    if let Some(Err(_)) = lines.peek() {
        return Err(lines.next().and_then(Result::err).unwrap_or_else(|| Failure::other("no path")));
    }
    let mut picture = PathPicture::planned(picture_file, arguments.against.as_deref(), &request)?;
    let mut writer = file.map(|(out, format)| PathFile::open(out, format, &request)).transpose()?;
    let unwritten = |error: io::Error| Failure::Other(format!("the path could not be written: {error}"));
    for judged in lines {
        let judged = judged?;
        if let Some(writer) = &mut writer {
            writer.write(&judged).map_err(unwritten)?;
        }
        if let Some(picture) = &mut picture {
            picture.push(judged.increment);
        }
    }
    writer.map_or(Ok(()), PathFile::finish).map_err(unwritten)?;
    if let Some(picture) = picture {
        picture.write(&request.model)?;
    }
    Ok(ExitCode::SUCCESS)
}

/// The increments of a file, one a line; empty lines are passed over.
fn lines(path: &Path) -> Result<impl Iterator<Item = Result<JudgedIncrement, Failure>>, Failure> {
    let name = path.display().to_string();
    let reader: Box<dyn BufRead> = if is_standard_output(path) {
        Box::new(io::stdin().lock())
    } else {
        let file = File::open(path).map_err(|error| Failure::Input(vec![format!("{name}: {error}")]))?;
        Box::new(BufReader::new(file))
    };
    let read = move |(index, line): (usize, io::Result<String>)| {
        let at_fault =
            |error: &dyn std::fmt::Display| Failure::Input(vec![format!("{name}, line {}: {error}", index + 1)]);
        let line = line.map_err(|error| at_fault(&error))?;
        if line.trim().is_empty() {
            return Ok(None);
        }
        serde_json::from_str(&line).map(Some).map_err(|error| at_fault(&format!("no increment of a path: {error}")))
    };
    Ok(reader.lines().enumerate().filter_map(move |numbered| read(numbered).transpose()))
}
