//! Follows a curve of limit points or others and judges its points.

use crate::check::measure::Judge;
use crate::continuation::critical_curve::critical_point::in_words;
use crate::continuation::critical_curve::{
    CriticalCurve, CurveEnd, CurveFailure, CurvePoint, CurveRange, CurveReport, CurveStart, DirectionEnd,
};
use crate::continuation::scene::Scene;
use crate::model::{InputError, InputErrors, ParameterCurve};
use crate::resources::cancel::CancelFlag;
use crate::result::increment::Increment;
use crate::studies::critical_curves::row::{CurveRow, CurveSummary};
use std::ops::ControlFlow;

/// Largest error of a state, of equilibrium and of contact, with which a point belongs to a curve.
const MEASURE_BAR: f64 = 1e-9;

/// Receives the points as they are found; breaks to end the curve.
pub type AcceptRow<'a> = &'a mut dyn FnMut(CurveRow) -> ControlFlow<()>;

/// Follows a curve; every point is passed to `accept`, and none is kept. The findings are reproducible, bit for bit.
///
/// # Errors
/// Mistakes of the model at its own value; a path without this limit point, or one that cannot be followed; a point that the
/// measure refuses, after those that it does not.
pub fn run(curve: &ParameterCurve, cancel: &CancelFlag, accept: AcceptRow<'_>) -> Result<CurveSummary, InputErrors> {
    let request_at = |value: f64| {
        let mut request = curve.request(value)?;
        // A point says the displacements and contacts of the whole model, whatever increments are to record.
        request.analysis.record = None;
        Ok::<_, InputErrors>(request)
    };
    let family = |value: f64| Scene::new(&request_at(value)?);
    let [from, to] = curve.settings.range;
    let range = CurveRange { from, to, start: curve.start, step: curve.step };
    let start = match (curve.settings.increment, curve.settings.limit_point) {
        (Some(index), _) => CurveStart::Increment(index),
        (None, asked) => CurveStart::LimitPoint(asked.unwrap_or(1)),
    };
    let mut off = None;
    let mut take = |point: CurvePoint| {
        // The point was found with this model.
        let Ok(request) = request_at(point.value) else { return ControlFlow::Break(()) };
        let mut judge = Judge::new(&request, point.displacement_scale, &point.load_scales);
        let measure = judge.judge_state(&point.increment, &point.stage_ends);
        let largest = measure.largest_of_state();
        if largest > MEASURE_BAR || largest.is_nan() {
            off = Some((point.value, largest));
            return ControlFlow::Break(());
        }
        let Increment { index, stage, load_factor, displacements, contacts, point: kind, .. } = point.increment;
        accept(CurveRow {
            index,
            place: point.place,
            value: point.value,
            kind: kind.kind,
            stage,
            load_factor,
            displacements,
            contacts,
            event: kind.event,
            codimension_two: point.codimension_two,
            from_path: point.from_path,
            measure,
        })
    };
    let report = CriticalCurve::new(&family, range, cancel.clone()).follow(start, &mut take);
    if let Some((value, largest)) = off {
        let detail = format!(
            "the point of the curve at {} is off the measure by {largest:.1e}, more than {MEASURE_BAR:.0e}: the history of \
             the point does not hold for this parameter; sweep it instead",
            in_words(value)
        );
        return Err(InputErrors(vec![InputError::new("/curve/parameter", detail)]));
    }
    let CurveReport { end, paths, newton_iterations, .. } = report.map_err(refused)?;
    let (ends_below, ends_above, complete) = match end {
        CurveEnd::Complete { below, above } => (Some(told(&below)), Some(told(&above)), true),
        CurveEnd::Cancelled => (None, None, false),
    };
    Ok(CurveSummary { ends_below, ends_above, paths, newton_iterations, complete })
}

fn refused(failure: CurveFailure) -> InputErrors {
    match failure {
        CurveFailure::Model(errors) => errors,
        CurveFailure::Refused(refusal) => InputErrors(vec![InputError::new("/curve", refusal.to_string())]),
    }
}

/// The end of a curve in words.
fn told(end: &DirectionEnd) -> String {
    match end {
        DirectionEnd::Range => "the end of the range is reached".to_owned(),
        DirectionEnd::Lost { value, why } => {
            format!("the curve does not go on past {}: {why}", in_words(*value))
        }
        DirectionEnd::OffPath { value, last, end } => {
            let since = last.map_or_else(
                || "before it".to_owned(),
                |last| format!("between {} and {}", in_words(last), in_words(*value)),
            );
            format!(
                "{}; a path of its own at {} has no such point: {since} the path changes in a way that the equations of \
                 the curve do not see, and the points of the curve past that are on no path; start it anew from there",
                told(end),
                in_words(*value)
            )
        }
        DirectionEnd::Closed => "the curve comes back to its start".to_owned(),
        DirectionEnd::Long { value } => {
            format!("the curve has as many points as one may have, the last at {}", in_words(*value))
        }
        DirectionEnd::Model { value, errors } => {
            // One line, however many mistakes there are.
            let mistakes = errors.to_string().replace('\n', "; ");
            format!("the model is refused at {}: {mistakes}", in_words(*value))
        }
    }
}
