//! `arcslip study`: traces a scene with several settings and methods and measures error against run time.

use crate::command::options::{bounds, input};
use crate::command::output::findings;
use crate::command::output::outcome::{Failure, Outcome};
use crate::model::request::Method;
use crate::model::{StudyRequest, decode};
use crate::resources::cancel::CancelFlag;
use crate::studies::error_against_time::{self, StudyRun};
use std::ops::ControlFlow;
use std::process::ExitCode;

/// Trace a scene with several settings and methods: error against run time.
///
/// FILE is a study, or a job request, which is studied with the defaults.
#[derive(Debug, clap::Args)]
pub struct Arguments {
    #[command(flatten)]
    model: input::Model,
    /// Arc lengths instead of those in the file, decreasing, separated by commas.
    #[arg(long, value_name = "NUMBERS", value_delimiter = ',', conflicts_with_all = ["tolerances", "penalties"])]
    arc_lengths: Option<Vec<f64>>,
    /// Tolerances of the regularised method instead of those in the file, decreasing.
    #[arg(long, value_name = "NUMBERS", value_delimiter = ',', conflicts_with = "penalties")]
    tolerances: Option<Vec<f64>>,
    /// Penalties of the regularised method instead of those in the file, increasing.
    #[arg(long, value_name = "NUMBERS", value_delimiter = ',')]
    penalties: Option<Vec<f64>>,
    /// Methods instead of those in the file, separated by commas.
    #[arg(long, value_name = "NAMES", value_enum, value_delimiter = ',')]
    methods: Option<Vec<MethodName>>,
    /// Number of timed runs of each path, instead of that in the file.
    #[arg(long, value_name = "N")]
    repeats: Option<u64>,
    #[command(flatten)]
    written: findings::Written,
    #[command(flatten)]
    pub(super) bounds: bounds::Arguments,
}

#[derive(Debug, Clone, Copy, PartialEq, Eq, clap::ValueEnum)]
enum MethodName {
    Auto,
    Mpec,
    Regularised,
}

impl From<MethodName> for Method {
    fn from(name: MethodName) -> Self {
        match name {
            MethodName::Auto => Self::Auto,
            MethodName::Mpec => Self::Mpec,
            MethodName::Regularised => Self::Regularised,
        }
    }
}

pub fn run(arguments: &Arguments) -> Outcome {
    arguments.written.check()?;
    let request = arguments.request()?;
    let plan = error_against_time::plan(&request).map_err(input::refused)?;
    let progress = findings::progress_bar(plan.runs);
    progress.tick();
    let accept = &mut |run: &StudyRun| {
        progress.set_position(run.index + 1);
        ControlFlow::Continue(())
    };
    let report =
        error_against_time::run(&request, Vec::new(), &CancelFlag::default(), accept).map_err(input::refused)?;
    progress.finish_and_clear();
    let Some(report) = report else {
        return Err(Failure::Other("the reference's path ended without a report".to_owned()));
    };
    arguments.written.write(&report)?;
    Ok(ExitCode::SUCCESS)
}

impl Arguments {
    fn request(&self) -> Result<StudyRequest, Failure> {
        let mut request = decode::study(&self.model.text()?).map_err(input::refused)?;
        let study = &mut request.study;
        if self.arc_lengths.is_some() || self.tolerances.is_some() || self.penalties.is_some() {
            study.arc_lengths.clone_from(&self.arc_lengths);
            study.tolerances.clone_from(&self.tolerances);
            study.penalties.clone_from(&self.penalties);
        }
        if let Some(methods) = &self.methods {
            study.methods = Some(methods.iter().copied().map(Method::from).collect());
        }
        study.repeats = self.repeats.unwrap_or(study.repeats);
        Ok(request)
    }
}
