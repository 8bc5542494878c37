//! How far a step goes: the predictor's direction, steps that are cut, and the increment that ends a stage.

use crate::continuation::penalty::increment::{
    Converged, IncrementConstraint, Limits, PenaltyFailure, PenaltyIncrement,
};
use crate::continuation::penalty::iterator::RegularisedPath;
use crate::continuation::penalty::system::PenaltyPoint;
use crate::mechanics::equations::stage_criteria::End;
use crate::mechanics::structure::elements::bar::COLLAPSED;
use crate::model::request::LoadSign;
use crate::result::stop_reason::StopReason;
use crate::step::segment::AT_END;

/// A step may grow by this factor from one increment to the next.
const MOST_GROWTH: f64 = 2.0;
/// Iterations tried, over those desired.
const PATIENCE: u64 = 4;

pub(super) struct AcceptedPenaltyStep {
    pub converged: Converged,
    /// It lies exactly at a load or displacement at which the stage ends.
    pub stage_ends: bool,
}

impl RegularisedPath<'_> {
    /// The direction `K⁻¹f` and the sign of the load along the path.
    pub(super) fn direction(&self) -> Option<(nalgebra::DVector<f64>, f64)> {
        let tangent = self.tangent.as_ref()?;
        let mut by_load = self.system().load_vector(&self.here.state, &self.here.contacts);
        if !tangent.solve(&mut by_load) {
            return None;
        }
        let sign = match (&self.previous, self.settings.load_sign) {
            (None, _) => 1.0,
            (Some(_), LoadSign::Determinant) => tangent.determinant_sign(),
            (Some(previous), LoadSign::PreviousIncrement) => {
                1.0_f64.copysign(previous.displacement.dot(&by_load) + 0.0)
            }
        };
        Some((by_load, sign))
    }

    /// Increments are tried, shorter and shorter, until one converges.
    pub(super) fn step(&mut self) -> Result<AcceptedPenaltyStep, StopReason> {
        let bounds = &self.scene.analysis.arc_length;
        let (least, most) = (bounds.min, bounds.max);
        let Some((by_load, sign)) = self.direction() else { return Err(self.reason_of_failure()) };
        let load_weight = self.settings.load_weight;
        let tangent = PenaltyIncrement { displacement: by_load * sign, load: sign };
        let length = tangent.size(load_weight);
        let mut size = self.step.min(most);
        loop {
            let predictor = tangent.scaled(size / length);
            let found = self.correct(predictor, IncrementConstraint::ArcLength { size, load_weight });
            match found.and_then(|converged| self.end_stage_if_passed(converged, size)) {
                Ok(accepted) => {
                    let needed = accepted.converged.iterations.max(1) as f64;
                    let factor = (self.settings.desired_iterations as f64 / needed).sqrt().min(MOST_GROWTH);
                    self.step = (size * factor).clamp(least, most);
                    return Ok(accepted);
                }
                Err(PenaltyFailure::Cancelled) => return Err(StopReason::Cancelled),
                Err(PenaltyFailure::Singular | PenaltyFailure::NoRoot | PenaltyFailure::NotConverged) => {
                    size *= 0.5;
                    if size < least {
                        return Err(self.reason_of_failure());
                    }
                }
            }
        }
    }

    fn correct(
        &mut self,
        predictor: PenaltyIncrement,
        control: IncrementConstraint,
    ) -> Result<Converged, PenaltyFailure> {
        let mut work = self.totals.work;
        let limits = Limits {
            tolerance: self.settings.tolerance,
            most_iterations: PATIENCE * self.settings.desired_iterations,
            force_scale: self.totals.force_scale,
            cancel: &self.cancel,
        };
        let converged = self.system().correct(&self.here, predictor, control, &limits, &mut work);
        self.totals.work = work;
        converged
    }

    /// Solves once more under control of the load or displacement at which the stage ends, if the increment passed it.
    fn end_stage_if_passed(&mut self, converged: Converged, size: f64) -> Result<AcceptedPenaltyStep, PenaltyFailure> {
        let fraction = |end: &End| {
            let left = end.left(&converged.point)?;
            if left > AT_END {
                return None;
            }
            let before = end.left(&self.here)?;
            Some(if before > left { (before / (before - left)).clamp(0.0, 1.0) } else { 1.0 })
        };
        let passed = self.scene.stages[self.stage].ends.iter().filter_map(|end| Some((*end, fraction(end)?)));
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
        let last = self.correct(converged.change.scaled(fraction), control)?;
        // Another branch may have that load, too, further away.
        if last.change.size(self.settings.load_weight) > size * (1.0 + AT_END) {
            return Err(PenaltyFailure::NotConverged);
        }
        Ok(AcceptedPenaltyStep { converged: last, stage_ends: true })
    }

    /// Why steps became too short.
    fn reason_of_failure(&self) -> StopReason {
        let stretch = self.scene.structure.smallest_stretch(&self.here.state.displacement);
        if self.system().is_mechanism(&self.here) {
            StopReason::Mechanism
        } else if stretch < COLLAPSED {
            StopReason::CollapsedBar
        } else {
            StopReason::StepUnderflow
        }
    }
}

impl End {
    /// How far a point is from a load or displacement bound; negative beyond it.
    pub(super) fn left(&self, point: &PenaltyPoint) -> Option<f64> {
        match *self {
            Self::Load { bound, sign } => Some(sign * (bound - point.state.load)),
            Self::Displacement { freedom, bound, sign } => Some(sign * (bound - point.state.displacement[freedom])),
            Self::LimitPoints(_) | Self::ContactChanges(_) | Self::Increments(_) => None,
        }
    }
}
