//! `arcslip solve`: traces the path of a model and writes one line per increment as it converges.

use crate::command::options::{bounds, input};
use crate::command::output::outcome::{Failure, Outcome, tell};
use crate::command::output::path_file::{Format, PathFile};
use crate::command::output::path_picture::PathPicture;
use crate::command::output::picture_file::PictureFile;
use crate::command::output::written::{folders_exist, is_standard_output, one_on_standard_output};
use crate::continuation::scene::Scene;
use crate::result::stop_reason;
use crate::service::jobs::solve_scene;
use indicatif::{ProgressBar, ProgressStyle};
use std::io::IsTerminal;
use std::ops::ControlFlow;
use std::path::PathBuf;
use std::process::ExitCode;

/// Trace the path of a model.
#[derive(Debug, clap::Args)]
pub struct Arguments {
    #[command(flatten)]
    model: input::Model,
    /// Write increments here; `-` is standard output.
    #[arg(long, value_name = "FILE", default_value = "-")]
    out: PathBuf,
    /// Default: what the extension of `--out` says, `ndjson` where it has none.
    #[arg(long, value_enum)]
    format: Option<Format>,
    /// Draw load factor against a displacement here, as SVG or PNG by the extension; `-` is standard output.
    #[arg(long, value_name = "FILE")]
    plot: Option<PathBuf>,
    /// What to draw, such as `tip.x` or `elements/0.axial_force`. Default: the largest displacement.
    #[arg(long, value_name = "NODE.COMPONENT|COLUMN", requires = "plot")]
    against: Option<String>,
    #[command(flatten)]
    pub(in crate::command) bounds: bounds::Arguments,
}

pub fn run(arguments: &Arguments) -> Outcome {
    let results = [("--out", Some(arguments.out.as_path())), ("--plot", arguments.plot.as_deref())];
    one_on_standard_output(&results)?;
    folders_exist(&results)?;
    let picture_file = PictureFile::of("--plot", arguments.plot.as_deref())?;
    let format = Format::of(arguments.format, &arguments.out)?;
    let request = arguments.model.read()?;
    // Checked before the file is opened, so that a mistake does not overwrite an earlier result.
    let scene = Scene::new(&request).map_err(input::refused)?;
    tell(&scene.plan().warnings);
    if request.analysis.explore.is_some() {
        eprintln!("explore: the directions not taken are followed by `arcslip serve` only; this traces one path");
    }
    let mut picture = PathPicture::planned(picture_file, arguments.against.as_deref(), &request)?;
    let mut writer = PathFile::open(&arguments.out, format, &request)?;
    let progress = progress_bar(request.analysis.max_increments, !is_standard_output(&arguments.out));
    let mut unwritten = None;
    let report = solve_scene(&request, &scene, &mut |step, _| {
        progress.set_position(step.index + 1);
        let Some(judged) = step.given else { return ControlFlow::Continue(()) };
        match writer.write(&judged) {
            Ok(()) => {
                if let Some(picture) = &mut picture {
                    picture.push(judged.increment);
                }
                ControlFlow::Continue(())
            }
            Err(error) => {
                unwritten = Some(error);
                ControlFlow::Break(())
            }
        }
    });
    progress.finish_and_clear();
    let unwritten = unwritten.or_else(|| writer.finish().err());
    if let Some(error) = unwritten {
        return Err(Failure::Other(format!("the path could not be written: {error}")));
    }
    if let Some(picture) = picture {
        picture.write(&request.model)?;
    }
    let Some(report) = report else { return Err(Failure::Other("the solver ended without a report".to_owned())) };
    let measure = &report.measure;
    if let (Some(bar), 1..) = (measure.bar, measure.off_measure) {
        eprintln!(
            "warning: {} increments are off the measure's bar of {bar:e}, a defect of the solver",
            measure.off_measure
        );
    }
    eprintln!("{} {}", report.report.sentence, serde_json::to_string(&report).map_err(Failure::other)?);
    Ok(match report.report.stop_reason.outcome() {
        stop_reason::Outcome::Completed => ExitCode::SUCCESS,
        stop_reason::Outcome::Stopped | stop_reason::Outcome::Cancelled => {
            ExitCode::from(crate::command::output::outcome::FAILED)
        }
    })
}

/// The progress bar; hidden unless standard error is a terminal and the increments do not go to it.
fn progress_bar(max_increments: u64, to_file: bool) -> ProgressBar {
    let elsewhere = to_file || !std::io::stdout().is_terminal();
    if !(std::io::stderr().is_terminal() && elsewhere) {
        return ProgressBar::hidden();
    }
    let style = ProgressStyle::with_template("{bar:40} {pos} of at most {len} increments, {elapsed}")
        .unwrap_or_else(|_| ProgressStyle::default_bar());
    ProgressBar::new(max_increments).with_style(style)
}
