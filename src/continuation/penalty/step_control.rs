//! Step-length control: the predictor's direction, steps that are cut, and the increment that ends a stage.

use crate::continuation::penalty::increment;
use crate::continuation::penalty::increment::{
    Converged, IncrementConstraint, Limits, PenaltyFailure, PenaltyIncrement,
};
use crate::continuation::penalty::iterator::RegularisedPath;
use crate::continuation::penalty::penalty_equations::PenaltyPoint;
use crate::continuation::penalty::tolerances::LARGEST_STEP_GROWTH;
use crate::mechanics::equations::stage_end_criteria::End;
use crate::mechanics::structure::elements::COLLAPSED;
use crate::model::request::LoadSign;
use crate::result::stop_reason::StopReason;
use crate::step::tolerances::BOUND_TOLERANCE;

/// Largest number of iterations, relative to the desired number.
const PATIENCE: u64 = 4;

pub(super) struct AcceptedPenaltyStep {
    pub converged: Converged,
    /// The point lies exactly at a load or displacement at which the stage ends.
    pub stage_ends: bool,
}

/// The direction `K⁻¹f` and the sign of the load along the path.
pub(super) fn direction(path: &RegularisedPath<'_>) -> Option<(nalgebra::DVector<f64>, f64)> {
    let tangent = path.tangent.as_ref()?;
    let mut by_load = path.system().load_vector(&path.here.state, &path.here.contacts);
    if !tangent.solve(&mut by_load) {
        return None;
    }
    let sign = match (&path.previous, path.settings.load_sign) {
        (None, _) => 1.0,
        (Some(_), LoadSign::Determinant) => tangent.determinant_sign(),
        (Some(previous), LoadSign::PreviousIncrement) => 1.0_f64.copysign(previous.displacement.dot(&by_load) + 0.0),
    };
    Some((by_load, sign))
}

/// Attempts shorter and shorter increments until one converges.
pub(super) fn step(path: &mut RegularisedPath<'_>) -> Result<AcceptedPenaltyStep, StopReason> {
    let bounds = &path.scene.analysis.arc_length;
    let (least, most) = (bounds.min, bounds.max);
    let Some((by_load, sign)) = direction(path) else { return Err(reason_of_failure(path)) };
    let load_weight = path.settings.load_weight;
    let tangent = PenaltyIncrement { displacement: by_load * sign, load: sign };
    let length = tangent.size(load_weight);
    let mut size = path.step.min(most);
    loop {
        let predictor = tangent.scaled(size / length);
        let found = correct(path, predictor, IncrementConstraint::ArcLength { size, load_weight });
        match found.and_then(|converged| end_stage_if_passed(path, converged, size)) {
            Ok(accepted) => {
                let needed = accepted.converged.iterations.max(1) as f64;
                let factor = (path.settings.desired_iterations as f64 / needed).sqrt().min(LARGEST_STEP_GROWTH);
                path.step = (size * factor).clamp(least, most);
                return Ok(accepted);
            }
            Err(PenaltyFailure::Cancelled) => return Err(StopReason::Cancelled),
            Err(PenaltyFailure::Singular | PenaltyFailure::NoRoot | PenaltyFailure::NotConverged) => {
                size *= 0.5;
                if size < least {
                    return Err(reason_of_failure(path));
                }
            }
        }
    }
}

fn correct(
    path: &mut RegularisedPath<'_>,
    predictor: PenaltyIncrement,
    control: IncrementConstraint,
) -> Result<Converged, PenaltyFailure> {
    let mut work = path.totals.work;
    let limits = Limits {
        tolerance: path.settings.tolerance,
        most_iterations: PATIENCE * path.settings.desired_iterations,
        force_scale: path.totals.force_scale,
        cancel: &path.cancel,
    };
    let converged = increment::correct(&path.system(), &path.here, predictor, control, &limits, &mut work);
    path.totals.work = work;
    converged
}

/// If the increment passed a load or displacement at which the stage ends, solves once more under control of this
/// quantity.
fn end_stage_if_passed(
    path: &mut RegularisedPath<'_>,
    converged: Converged,
    size: f64,
) -> Result<AcceptedPenaltyStep, PenaltyFailure> {
    let fraction = |end: &End| {
        let left = left_to(end, &converged.point)?;
        if left > BOUND_TOLERANCE {
            return None;
        }
        let before = left_to(end, &path.here)?;
        Some(if before > left { (before / (before - left)).clamp(0.0, 1.0) } else { 1.0 })
    };
    let passed = path.scene.stages[path.stage].ends.iter().filter_map(|end| Some((*end, fraction(end)?)));
    let Some((end, fraction)) = passed.min_by(|a, b| a.1.total_cmp(&b.1)) else {
        return Ok(AcceptedPenaltyStep { converged, stage_ends: false });
    };
    let control = match end {
        End::Load { bound, .. } => IncrementConstraint::Load(bound),
        End::Displacement { freedom, bound, .. } => IncrementConstraint::Displacement { freedom, value: bound },
        End::LimitPoints(_) | End::ContactChanges(_) | End::Increments(_) => {
            return Ok(AcceptedPenaltyStep { converged, stage_ends: false });
        }
    };
    let last = correct(path, converged.change.scaled(fraction), control)?;
    // A more distant branch may have the same load.
    if last.change.size(path.settings.load_weight) > size * (1.0 + BOUND_TOLERANCE) {
        return Err(PenaltyFailure::NotConverged);
    }
    Ok(AcceptedPenaltyStep { converged: last, stage_ends: true })
}

/// The reason why steps became too short.
fn reason_of_failure(path: &RegularisedPath<'_>) -> StopReason {
    let stretch = path.structure.smallest_stretch(&path.here.state.displacement);
    if path.system().is_mechanism(&path.here) {
        StopReason::Mechanism
    } else if stretch < COLLAPSED {
        StopReason::CollapsedBar
    } else {
        StopReason::StepUnderflow
    }
}

/// Distance of a point from a load or displacement bound; negative beyond the bound.
pub(super) fn left_to(end: &End, point: &PenaltyPoint) -> Option<f64> {
    match *end {
        End::Load { bound, sign } => Some(sign * (bound - point.state.load)),
        End::Displacement { freedom, bound, sign } => Some(sign * (bound - point.state.displacement[freedom])),
        End::LimitPoints(_) | End::ContactChanges(_) | End::Increments(_) => None,
    }
}
