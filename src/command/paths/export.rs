//! `arcslip export`: writes the increments of a solved path in another format.

use crate::check::judged::JudgedIncrement;
use crate::command::options::input;
use crate::command::output::outcome::{Failure, Outcome};
use crate::command::output::path_file::{Format, PathFile};
use crate::command::output::path_picture::PathPicture;
use crate::command::output::picture_file::PictureFile;
use crate::command::output::written::{folders_exist, is_standard_output, one_on_standard_output};
use crate::model::input::names::quoted;
use crate::model::{JobRequest, Model};
use crate::result::increment::Increment;
use std::collections::HashSet;
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
    /// What tells the path from those that leave it, for ParaView's field data.
    #[arg(long, value_name = "TEXT", default_value = "", requires = "out")]
    branch: String,
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
    let known = Known::of(&request);
    let checked = |judged: Result<JudgedIncrement, Failure>| {
        let judged = judged?;
        known.check(&judged.increment)?;
        Ok(judged)
    };
    let mut lines = lines(&arguments.path)?.map(checked).peekable();
    // A path that cannot be read does not overwrite an earlier result.
    if let Some(Err(failure)) = lines.next_if(Result::is_err) {
        return Err(failure);
    }
    let mut picture = PathPicture::planned(picture_file, arguments.against.as_deref(), &request)?;
    let mut writer =
        file.map(|(out, format)| PathFile::open_branch(out, format, &request, &arguments.branch)).transpose()?;
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

/// What increments of a model name.
struct Known<'a> {
    stages: HashSet<&'a str>,
    model: &'a Model,
}

impl<'a> Known<'a> {
    fn of(request: &'a JobRequest) -> Self {
        Self { stages: request.model.stages.iter().map(|stage| stage.name.as_str()).collect(), model: &request.model }
    }

    /// # Errors
    /// The increment names what the model does not have: the path is that of another one.
    fn check(&self, increment: &Increment) -> Result<(), Failure> {
        let Increment { stage, displacements, contacts, elements, .. } = increment;
        let is_node = |name: &str| self.model.nodes.contains_key(name);
        let unknown = if !self.stages.contains(&**stage) {
            Some(format!("stage {}", quoted(stage)))
        } else if let Some((node, _)) = displacements.iter().find(|(node, _)| !is_node(node)) {
            Some(format!("node {}", quoted(node)))
        } else if let Some(contact) = contacts.iter().find(|contact| !is_node(&contact.node)) {
            Some(format!("contact of node {}", quoted(&contact.node)))
        } else {
            let count = self.model.elements.len() as u64;
            elements.iter().find(|state| state.element >= count).map(|state| format!("element {}", state.element))
        };
        let Some(unknown) = unknown else { return Ok(()) };
        let what =
            format!("increment {}: the model has no {unknown}: is this the path of another model?", increment.index);
        Err(Failure::Input(vec![what]))
    }
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
