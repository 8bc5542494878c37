//! `arcslip verify`: solves every scene with a known solution and judges the result.

mod picture;

use crate::check::cases::cases;
use crate::check::verify::case::{Case, CaseRow};
use crate::command::output::outcome::{Failure, Outcome, say};
use crate::command::output::picture_file::PictureFile;
use crate::command::output::written::{is_standard_output, one_on_standard_output, write};
use crate::model::input::names::suggestion_of_all;
use std::path::PathBuf;
use std::process::ExitCode;

/// Solve every scene with a known solution, including stiff and extreme ones, and judge the result.
///
/// The exit status is 1 if a case fails.
#[derive(Debug, clap::Args)]
pub struct Arguments {
    /// Only run this scene, or this family of extreme cases.
    #[arg(long, value_name = "NAME")]
    scene: Option<String>,
    /// Write the rows to this file as JSON; `-` is standard output, in which case the table goes to standard error.
    #[arg(long, value_name = "FILE")]
    json: Option<PathBuf>,
    /// Draw errors against their tolerances to this file, as SVG or PNG by its extension; `-` is standard output, in which case
    /// the table goes to standard error.
    #[arg(long, value_name = "FILE")]
    plot: Option<PathBuf>,
}

pub fn run(arguments: &Arguments) -> Outcome {
    let results = [("--json", arguments.json.as_deref()), ("--plot", arguments.plot.as_deref())];
    one_on_standard_output(&results)?;
    let picture_file = PictureFile::of("--plot", arguments.plot.as_deref())?;
    let taken = results.iter().any(|(_, place)| place.is_some_and(is_standard_output));
    let tell = |text: String| {
        if taken {
            eprint!("{text}");
            return Ok(());
        }
        say(text)
    };
    let cases = chosen(arguments.scene.as_deref())?;
    let columns = Columns::of(&cases);
    tell(columns.header())?;
    let mut rows = Vec::new();
    for case in &cases {
        for &method in case.methods {
            let row = case.solve(method);
            tell(columns.line(&row))?;
            rows.push(row);
        }
    }
    let failed = rows.iter().filter(|row| !row.pass).count();
    tell(format!("{} of {} pass\n", rows.len() - failed, rows.len()))?;
    if let Some(file) = &arguments.json {
        write(file, &(serde_json::to_string_pretty(&rows).map_err(Failure::other)? + "\n"))?;
    }
    if let Some(file) = picture_file {
        file.write(&picture::svg(&rows).map_err(Failure::other)?)?;
    }
    Ok(if failed == 0 { ExitCode::SUCCESS } else { ExitCode::from(crate::command::output::outcome::FAILED) })
}

/// The selected cases.
fn chosen(scene: Option<&str>) -> Result<Vec<Case>, Failure> {
    let all = cases();
    let Some(scene) = scene else { return Ok(all) };
    let mut families: Vec<&str> = all.iter().map(|case| case.family).collect();
    families.dedup();
    if !families.contains(&scene) {
        let nearest = suggestion_of_all(scene, families.iter().copied());
        return Err(Failure::Input(vec![format!("--scene {scene}: no such scene{nearest}")]));
    }
    Ok(all.into_iter().filter(|case| case.family == scene).collect())
}

/// Widths of the columns that hold names.
struct Columns {
    family: usize,
    case: usize,
}

impl Columns {
    fn of(cases: &[Case]) -> Self {
        let widest = |name: &dyn Fn(&Case) -> usize| cases.iter().map(name).max().unwrap_or_default();
        Self { family: widest(&|case| case.family.chars().count()), case: widest(&|case| case.name.chars().count()) }
    }

    fn header(&self) -> String {
        let Self { family, case } = *self;
        format!(
            "{:family$}  {:case$}  method     error      bar    state   energy  increments    time  pass  ends\n",
            "scene", "case"
        )
    }

    fn line(&self, row: &CaseRow) -> String {
        let Self { family, case } = *self;
        let figure = |value: Option<f64>| value.map_or_else(|| "-".to_owned(), |value| format!("{value:.1e}"));
        format!(
            "{:family$}  {:case$}  {:6}  {:>8}  {:>7}  {:>7}  {:>7}  {:>10}  {:>5.2}s  {:4}  {}\n",
            row.family,
            row.case,
            row.method_name(),
            figure(row.error),
            format!("{:.0e}", row.bar),
            figure(row.state_error),
            figure(row.energy_error),
            row.increments,
            row.time_s,
            if row.pass { "yes" } else { "NO" },
            row.stop_reason,
        )
    }
}
