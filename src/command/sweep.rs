//! `arcslip sweep`: traces a model with varied parameters, on all cores.

use crate::check::judged::JudgedIncrement;
use crate::command::options::{bounds, input};
use crate::command::output::findings;
use crate::command::output::outcome::{Failure, Outcome, tell};
use crate::model::{Sweep, decode};
use crate::output::json_line;
use crate::studies::sweeps::{self, Found, Row};
use std::collections::HashMap;
use std::fs::File;
use std::io::{BufWriter, Write};
use std::num::NonZeroUsize;
use std::ops::ControlFlow;
use std::path::{Path, PathBuf};
use std::process::ExitCode;
use std::sync::{Mutex, PoisonError};

/// Trace a model with varied parameters and find the first limit load of each path, or other values of it.
///
/// FILE is a job request with `"sweep": {"replace": {POINTER: [VALUES]}}`, or one without where --replace is given.
#[derive(Debug, clap::Args)]
pub struct Arguments {
    #[command(flatten)]
    model: input::Model,
    /// Replace the value at a JSON pointer by each of these, instead of those in the file, such as
    /// `/model/contacts/0/friction=0.1,0.2`; repeat the option for further parameters.
    #[arg(long, value_name = "POINTER=VALUES", value_parser = replacement)]
    replace: Vec<(String, Vec<serde_json::Value>)>,
    /// How the values of several parameters are combined.
    #[arg(long, value_enum)]
    combine: Option<CombineName>,
    /// Tell a value at a place of each path, such as `tip at limit=tip.x@first_limit` or `load at 2=load_factor@tip.x=2`,
    /// instead of those in the file; the first one is drawn. Repeat the option for further ones.
    #[arg(long, value_name = "NAME=COLUMN@PLACE[@STAGE]", value_parser = response)]
    response: Vec<(String, serde_json::Value)>,
    /// Trace up to N further runs, each in the middle of two values of the only parameter between which the first response,
    /// or the first limit load, changes most.
    #[arg(long, value_name = "N")]
    refine: Option<u64>,
    /// Paths traced at a time. Default: one per processor.
    #[arg(long, value_name = "N")]
    threads: Option<NonZeroUsize>,
    #[command(flatten)]
    written: findings::Written,
    /// Write each path into this folder, as RUN.ndjson.
    #[arg(long, value_name = "FOLDER")]
    paths: Option<PathBuf>,
    #[command(flatten)]
    pub(super) bounds: bounds::Arguments,
}

#[derive(Debug, Clone, Copy, PartialEq, Eq, clap::ValueEnum)]
enum CombineName {
    /// All combinations.
    Grid,
    /// The first values of all parameters, then the second ones, and so on.
    List,
}

/// Values separated by commas. If the list as a whole is not JSON, each value that is JSON is read as such and the others are
/// texts.
fn replacement(argument: &str) -> Result<(String, Vec<serde_json::Value>), String> {
    let (pointer, values) = argument.split_once('=').ok_or("POINTER=VALUE,VALUE,... is expected")?;
    let values = serde_json::from_str(&format!("[{values}]")).unwrap_or_else(|_| {
        let read = |text: &str| serde_json::from_str(text).unwrap_or_else(|_| serde_json::Value::from(text));
        values.split(',').map(read).collect()
    });
    Ok((pointer.to_owned(), values))
}

/// A response as a file has it. Its name ends at the first `=`, and the place is a name, or a column and a number.
fn response(argument: &str) -> Result<(String, serde_json::Value), String> {
    let expected = "NAME=COLUMN@PLACE or NAME=COLUMN@PLACE@STAGE is expected";
    let (name, rest) = argument.split_once('=').filter(|(name, _)| !name.is_empty()).ok_or(expected)?;
    let (value, at) = rest.split_once('@').ok_or(expected)?;
    let (at, stage) = at.split_once('@').map_or((at, None), |(at, stage)| (at, Some(stage)));
    let at = match at.rsplit_once('=') {
        Some((column, number)) => {
            let number: f64 = number.parse().map_err(|_| format!("`{number}` is not a number"))?;
            serde_json::json!({"value": column, "reaches": number})
        }
        None => at.into(),
    };
    let mut response = serde_json::json!({"value": value, "at": at});
    if let Some(stage) = stage {
        response["stage"] = stage.into();
    }
    Ok((name.to_owned(), response))
}

pub fn run(arguments: &Arguments) -> Outcome {
    arguments.written.check()?;
    let mut sweep = Sweep::read(&arguments.text()?).map_err(input::refused)?;
    let threads = arguments.threads.or_else(|| std::thread::available_parallelism().ok()).unwrap_or(NonZeroUsize::MIN);
    let refine = sweep.variation.refine;
    sweep.variation.warnings = sweeps::check(&sweep, 0..sweep.runs(), threads).map_err(input::refused)?;
    tell(&sweep.variation.warnings);
    let progress = findings::progress_bar(sweep.runs() + refine);
    let written = arguments.paths.as_deref().map(Paths::in_folder).transpose()?;
    let accept = |run: u64, judged: &JudgedIncrement| match &written {
        Some(paths) => paths.write(run, judged),
        None => ControlFlow::Continue(()),
    };
    let done = |row: &Row| {
        progress.inc(1);
        if let Some(paths) = &written {
            paths.close(row.run);
        }
    };
    let mut rows = sweeps::run(&sweep, 0..sweep.runs(), threads, &accept, &done).map_err(input::refused)?;
    let all = sweep.runs() + refine;
    while sweep.runs() < all {
        let most = usize::try_from(all - sweep.runs()).unwrap_or(usize::MAX);
        let values = sweeps::further_values(&sweep.variation, &rows, most);
        if values.is_empty() {
            break;
        }
        let traced = sweep.add_values(values).and_then(|runs| {
            sweeps::check(&sweep, runs.clone(), threads)?;
            sweeps::run(&sweep, runs, threads, &accept, &done)
        });
        match traced {
            Ok(further) => rows.extend(further),
            Err(errors) => {
                // What has been found stays: a value between two may be one that the model cannot have.
                progress.suspend(|| eprintln!("--refine ends after {} runs: {errors}", rows.len()));
                sweep.drop_values_after(rows.len());
                break;
            }
        }
    }
    progress.finish_and_clear();
    if let Some(failure) = written.and_then(Paths::failure) {
        return Err(failure);
    }
    let any_failed = rows.iter().any(|row| row.error.is_some());
    let found = Found { name: sweep.name, variation: sweep.variation, rows };
    arguments.written.write(&found)?;
    Ok(if any_failed { ExitCode::from(crate::command::output::outcome::FAILED) } else { ExitCode::SUCCESS })
}

impl Arguments {
    /// The document, with the values of the command line instead of its own.
    fn text(&self) -> Result<Vec<u8>, Failure> {
        let text = self.model.text()?;
        if self.replace.is_empty() && self.combine.is_none() && self.response.is_empty() && self.refine.is_none() {
            return Ok(text);
        }
        let mut replace = serde_json::Map::new();
        for (pointer, values) in &self.replace {
            if replace.insert(pointer.clone(), values.clone().into()).is_some() {
                let mistake = format!("--replace: `{pointer}` is given twice; all of its values belong together");
                return Err(Failure::Input(vec![mistake]));
            }
        }
        let mut document = decode::object(&text).map_err(input::refused)?;
        let sweep = document.entry("sweep").or_insert_with(|| serde_json::json!({}));
        // A value other than an object is reported when the sweep is read.
        let Some(sweep) = sweep.as_object_mut() else { return Ok(text) };
        if !replace.is_empty() {
            sweep.insert("replace".to_owned(), replace.into());
        }
        if !self.response.is_empty() {
            let mut responses = serde_json::Map::new();
            for (name, response) in &self.response {
                if responses.insert(name.clone(), response.clone()).is_some() {
                    return Err(Failure::Input(vec![format!("--response: two of them have the name `{name}`")]));
                }
            }
            sweep.insert("responses".to_owned(), responses.into());
        }
        if let Some(refine) = self.refine {
            sweep.insert("refine".to_owned(), refine.into());
        }
        if let Some(combine) = self.combine {
            let name = match combine {
                CombineName::Grid => "grid",
                CombineName::List => "list",
            };
            sweep.insert("combine".to_owned(), name.into());
        }
        serde_json::to_vec(&document).map_err(Failure::other)
    }
}

/// The files of the paths, which several threads write.
struct Paths {
    folder: PathBuf,
    files: Mutex<HashMap<u64, BufWriter<File>>>,
    failed: Mutex<Option<String>>,
}

impl Paths {
    fn in_folder(folder: &Path) -> Result<Self, Failure> {
        std::fs::create_dir_all(folder).map_err(|error| Failure::Other(format!("{}: {error}", folder.display())))?;
        Ok(Self { folder: folder.to_owned(), files: Mutex::default(), failed: Mutex::default() })
    }

    fn write(&self, run: u64, judged: &JudgedIncrement) -> ControlFlow<()> {
        let file = self.folder.join(format!("{run}.ndjson"));
        let written = || -> std::io::Result<()> {
            let mut files = self.files.lock().unwrap_or_else(PoisonError::into_inner);
            if judged.increment.index == 0 {
                files.insert(run, BufWriter::new(File::create(&file)?));
            }
            match files.get_mut(&run) {
                Some(to) => writeln!(to, "{}", json_line(judged)?),
                None => Ok(()),
            }
        };
        match written() {
            Ok(()) => ControlFlow::Continue(()),
            Err(error) => self.fail(format!("{}: {error}", file.display())),
        }
    }

    fn close(&self, run: u64) {
        let file = self.files.lock().unwrap_or_else(PoisonError::into_inner).remove(&run);
        if let Some(Err(error)) = file.map(|mut file| file.flush()) {
            let _ = self.fail(format!("{}: {error}", self.folder.join(format!("{run}.ndjson")).display()));
        }
    }

    fn fail(&self, error: String) -> ControlFlow<()> {
        self.failed.lock().unwrap_or_else(PoisonError::into_inner).get_or_insert(error);
        ControlFlow::Break(())
    }

    fn failure(self) -> Option<Failure> {
        self.failed.into_inner().unwrap_or_else(PoisonError::into_inner).map(Failure::Other)
    }
}
