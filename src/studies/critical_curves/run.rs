//! Follows a curve of limit points or others and judges its points.

use crate::check::measure::Judge;
use crate::continuation::critical_curve::critical_point::in_words;
use crate::continuation::critical_curve::{
    CriticalCurve, CurveBreak, CurveEnd, CurveFailure, CurvePoint, CurveRange, CurveReport, CurveStart, DirectionEnd,
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
/// Mistakes of the model at its own value; a path without this limit point, or one that cannot be followed.
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
    let mut take = |point: CurvePoint| {
        // The point was found with this model.
        let Ok(request) = request_at(point.value) else { return ControlFlow::Break(CurveBreak::Curve) };
        let mut judge = Judge::new(&request, point.displacement_scale, &point.load_scales);
        let measure = judge.judge_state(&point.increment, &point.stage_ends);
        let largest = measure.largest_of_state();
        if largest > MEASURE_BAR || largest.is_nan() {
            let why = format!(
                "the point at {} is off the measure by {largest:.1e}, more than {MEASURE_BAR:.0e}: the history of the \
                 points before does not hold there",
                in_words(point.value)
            );
            return ControlFlow::Break(CurveBreak::Direction(why));
        }
        let Increment { index, stage, load_factor, displacements, contacts, point: kind, .. } = point.increment;
        let accepted = accept(CurveRow {
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
        });
        accepted.map_break(|()| CurveBreak::Curve)
    };
    let report = CriticalCurve::new(&family, range, cancel.clone()).follow(start, &mut take);
    let CurveReport { end, points, paths, newton_iterations } = report.map_err(refused)?;
    let of_work = CurveSummary { paths, newton_iterations, ..CurveSummary::default() };
    match end {
        CurveEnd::Complete { above: DirectionEnd::Lost { why, .. }, .. } if points == 0 => {
            Err(InputErrors(vec![InputError::new("/curve/parameter", why)]))
        }
        CurveEnd::Complete { below, above } => Ok(CurveSummary {
            ends_below: Some(told(&below)),
            ends_above: Some(told(&above)),
            off_path_from: off_path(&above),
            off_path_to: off_path(&below),
            complete: true,
            ..of_work
        }),
        CurveEnd::Cancelled => Ok(of_work),
    }
}

/// The first place along the curve, in a direction, that is not known to be on a path.
fn off_path(end: &DirectionEnd) -> Option<i64> {
    match end {
        DirectionEnd::OffPath { place, .. } => Some(*place),
        _ => None,
    }
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
        DirectionEnd::OffPath { value, last, end, .. } => {
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
