//! `arcslip continue`: follows a limit point, bifurcation point or contact change in a parameter of the model.

use crate::command::options::{bounds, input};
use crate::command::output::findings;
use crate::command::output::outcome::{FAILED, Failure, Outcome};
use crate::model::{ParameterCurve, decode};
use crate::resources::cancel::CancelFlag;
use crate::studies::critical_curves::{self, CurveFound};
use std::ops::ControlFlow;
use std::process::ExitCode;

/// Follow a limit point, bifurcation point or contact change in a parameter of the model: a limit load over friction.
///
/// FILE is a job request with `"curve": {"parameter": POINTER, "range": [FROM, TO]}`, or one without where --parameter and
/// --range are given.
#[derive(Debug, clap::Args)]
pub struct Arguments {
    #[command(flatten)]
    model: input::Model,
    /// The number that varies, as a JSON pointer such as `/model/contacts/0/friction`, instead of that in the file.
    #[arg(long, value_name = "POINTER")]
    parameter: Option<String>,
    /// The values between which it varies; the model's own is one of them.
    #[arg(long, value_name = "FROM,TO", value_parser = range, allow_hyphen_values = true)]
    range: Option<[f64; 2]>,
    /// Longest step between two values. Default: the range over 40.
    #[arg(long, value_name = "STEP", value_parser = step)]
    step: Option<f64>,
    /// Follow the limit point of this number on the path, from 1.
    #[arg(long, value_name = "N", conflicts_with = "increment")]
    limit_point: Option<u64>,
    /// Follow the limit point, smooth bifurcation point or contact change at the increment of this index.
    #[arg(long, value_name = "INDEX")]
    increment: Option<u64>,
    #[command(flatten)]
    written: findings::Written,
    #[command(flatten)]
    pub(super) bounds: bounds::Arguments,
}

fn range(argument: &str) -> Result<[f64; 2], String> {
    let numbers: Result<Vec<f64>, _> = argument.split(',').map(str::parse).collect();
    match numbers.map_err(|error| format!("`{argument}`: {error}"))?[..] {
        [from, to] if from.is_finite() && to.is_finite() => Ok([from, to]),
        [from, to] => Err(format!("found {from} and {to}; two finite numbers are expected")),
        _ => Err("FROM,TO is expected".to_owned()),
    }
}

fn step(argument: &str) -> Result<f64, String> {
    let step: f64 = argument.parse().map_err(|error| format!("{error}"))?;
    if step.is_finite() && step > 0.0 { Ok(step) } else { Err("a positive finite number is expected".to_owned()) }
}

pub fn run(arguments: &Arguments) -> Outcome {
    arguments.written.check()?;
    let curve = ParameterCurve::read(&arguments.text()?).map_err(input::refused)?;
    let progress = findings::counter("points");
    let mut rows = Vec::new();
    let accept = &mut |row| {
        rows.push(row);
        progress.inc(1);
        ControlFlow::Continue(())
    };
    let summary = critical_curves::run(&curve, &CancelFlag::default(), accept).map_err(input::refused)?;
    progress.finish_and_clear();
    let is_complete = summary.complete;
    let found = CurveFound::begun(curve.name, curve.settings, curve.dimension).with(rows, Some(summary));
    arguments.written.write(&found)?;
    Ok(if is_complete { ExitCode::SUCCESS } else { ExitCode::from(FAILED) })
}

impl Arguments {
    /// The document, with the values of the command line instead of its own.
    fn text(&self) -> Result<Vec<u8>, Failure> {
        let text = self.model.text()?;
        let mut given = serde_json::Map::new();
        let mut give = |name: &str, value: Option<serde_json::Value>| {
            if let Some(value) = value {
                given.insert(name.to_owned(), value);
            }
        };
        give("parameter", self.parameter.clone().map(Into::into));
        give("range", self.range.map(|range| serde_json::json!(range)));
        give("step", self.step.map(Into::into));
        give("limit_point", self.limit_point.map(Into::into));
        give("increment", self.increment.map(Into::into));
        if given.is_empty() {
            return Ok(text);
        }
        let mut document = decode::object(&text).map_err(input::refused)?;
        let curve = document.entry("curve").or_insert_with(|| serde_json::json!({}));
        // A value other than an object is reported when the curve is read.
        let Some(curve) = curve.as_object_mut() else { return Ok(text) };
        if given.contains_key("increment") || given.contains_key("limit_point") {
            curve.retain(|name, _| name != "increment" && name != "limit_point");
        }
        curve.extend(given);
        serde_json::to_vec(&document).map_err(Failure::other)
    }
}
