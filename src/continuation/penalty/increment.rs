//! One increment: predictor, and corrector on the arc-length sphere or cylinder, or under control of a load or a
//! displacement.

use crate::algebra::Factorisation;
use crate::continuation::penalty::penalty_equations::{PenaltyPoint, PenaltySystem};
use crate::continuation::penalty::tolerances::ROOT_TIE_TOLERANCE;
use crate::mechanics::problem::state::State;
use crate::resources::cancel::CancelFlag;
use crate::step::corrector::cost_counters::Work;
use nalgebra::DVector;

/// The equation that closes the system.
#[derive(Debug, Clone, Copy)]
pub enum IncrementConstraint {
    /// `|Δu|² + ψ² Δs² = size²`
    ArcLength { size: f64, load_weight: f64 },
    /// `s = value`
    Load(f64),
    /// `u = value` at a degree of freedom.
    Displacement { freedom: usize, value: f64 },
}

/// `(Δu, Δs)`, with one displacement for each unknown.
#[derive(Debug, Clone)]
pub struct PenaltyIncrement {
    pub displacement: DVector<f64>,
    pub load: f64,
}

/// Settings of the corrector.
pub struct Limits<'a> {
    pub tolerance: f64,
    pub most_iterations: u64,
    /// Largest force so far.
    pub force_scale: f64,
    pub cancel: &'a CancelFlag,
}

/// A converged point.
pub struct Converged {
    pub point: PenaltyPoint,
    pub change: PenaltyIncrement,
    /// The consistent tangent at the point; `None` where it is singular.
    pub tangent: Option<Factorisation>,
    pub iterations: u64,
    pub residual: f64,
    pub force_scale: f64,
}

/// The reason why no point was found.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum PenaltyFailure {
    Singular,
    /// The corrected displacement does not meet the sphere: the quadratic has no real root.
    NoRoot,
    NotConverged,
    Cancelled,
}

impl PenaltyIncrement {
    /// `|Δu|² + ψ² Δs²`
    fn squared(&self, load_weight: f64) -> f64 {
        self.displacement.norm_squared() + (load_weight * self.load).powi(2)
    }

    pub fn size(&self, load_weight: f64) -> f64 {
        self.squared(load_weight).sqrt()
    }

    pub fn scaled(&self, factor: f64) -> Self {
        Self { displacement: &self.displacement * factor, load: self.load * factor }
    }
}

fn moved(system: &PenaltySystem<'_>, from: &PenaltyPoint, change: &PenaltyIncrement) -> State {
    let mut state = from.state.clone();
    for (unknown, freedom) in system.loading.structure.freedom_of.iter().enumerate() {
        state.displacement[*freedom] += change.displacement[unknown];
    }
    state.load += change.load;
    system.loading.place_supports(&mut state);
    state
}

/// Newton iterations from a predictor.
pub fn correct(
    system: &PenaltySystem<'_>,
    from: &PenaltyPoint,
    predictor: PenaltyIncrement,
    control: IncrementConstraint,
    limits: &Limits<'_>,
    work: &mut Work,
) -> Result<Converged, PenaltyFailure> {
    let mut change = predictor;
    for iterations in 0..=limits.most_iterations {
        if limits.cancel.is_cancelled() {
            return Err(PenaltyFailure::Cancelled);
        }
        let mut state = moved(system, from, &change);
        let evaluation = system.evaluate(from, &state);
        let residual = system.relative_residual(&evaluation, limits.force_scale);
        if !residual.is_finite() {
            return Err(PenaltyFailure::NotConverged);
        }
        work.factorisations += 1;
        let mut by_residual = system.right_hand_side(&evaluation);
        let tangent = Factorisation::new(evaluation.tangent);
        if residual <= limits.tolerance && meets(control, &state) {
            let force_scale = evaluation.force_scale;
            match control {
                IncrementConstraint::ArcLength { .. } => {}
                IncrementConstraint::Load(value) => state.load = value,
                IncrementConstraint::Displacement { freedom, value } => state.displacement[freedom] = value,
            }
            let point = system.point(state, evaluation.contacts);
            return Ok(Converged { point, change, tangent, iterations, residual, force_scale });
        }
        if iterations == limits.most_iterations {
            break;
        }
        let factorisation = tangent.ok_or(PenaltyFailure::Singular)?;
        let mut by_load = system.load_vector(&state, &evaluation.contacts);
        if !factorisation.solve(&mut by_residual) || !factorisation.solve(&mut by_load) {
            return Err(PenaltyFailure::Singular);
        }
        let load_step = match control {
            IncrementConstraint::ArcLength { size, load_weight } => {
                root(&change, &by_residual, &by_load, size, load_weight).ok_or(PenaltyFailure::NoRoot)?
            }
            IncrementConstraint::Load(value) => value - state.load,
            IncrementConstraint::Displacement { freedom, value } => {
                let left = value - state.displacement[freedom];
                match system.loading.structure.unknown_of[freedom] {
                    Some(unknown) => (left - by_residual[unknown]) / by_load[unknown],
                    None => left / system.loading.support_rate(freedom),
                }
            }
        };
        if !load_step.is_finite() {
            return Err(PenaltyFailure::Singular);
        }
        change.displacement += by_residual + by_load * load_step;
        change.load += load_step;
        work.newton_iterations += 1;
    }
    Err(PenaltyFailure::NotConverged)
}

/// Whether the controlled quantity has its prescribed value; for the arc length this holds by construction.
fn meets(control: IncrementConstraint, state: &State) -> bool {
    let near = |found: f64, sought: f64| (found - sought).abs() <= 1e-12 * sought.abs().max(1.0);
    match control {
        IncrementConstraint::ArcLength { .. } => true,
        IncrementConstraint::Load(value) => near(state.load, value),
        IncrementConstraint::Displacement { freedom, value } => near(state.displacement[freedom], value),
    }
}

/// The load step that brings `Δu + δ_r + δs δ_t` back to the sphere: of two roots the one whose displacements make the
/// smaller angle with those before the correction.
fn root(
    change: &PenaltyIncrement,
    by_residual: &DVector<f64>,
    by_load: &DVector<f64>,
    size: f64,
    load_weight: f64,
) -> Option<f64> {
    let corrected = &change.displacement + by_residual;
    let weight = load_weight * load_weight;
    let a = by_load.norm_squared() + weight;
    let b = 2.0 * (by_load.dot(&corrected) + weight * change.load);
    let c = PenaltyIncrement { displacement: corrected.clone(), load: change.load }.squared(load_weight) - size * size;
    let discriminant = b * b - 4.0 * a * c;
    if !(discriminant >= 0.0 && a > 0.0) {
        return None;
    }
    // To avoid cancellation: the root of larger size first, the other from the product of both.
    let far = -0.5 * (b + discriminant.sqrt().copysign(b));
    let roots = if far == 0.0 { [0.0, 0.0] } else { [far / a, c / far] };
    // Where the load changes and the displacements do not, the loads distinguish the roots.
    let turning = change.displacement.dot(by_load) * (roots[0] - roots[1]);
    let still = turning.abs() <= ROOT_TIE_TOLERANCE * size * size;
    let ahead = if still { change.load * (roots[0] - roots[1]) } else { turning };
    Some(if ahead >= 0.0 { roots[0] } else { roots[1] })
}

#[cfg(test)]
mod tests {
    use super::{PenaltyIncrement, root};
    use nalgebra::DVector;

    #[test]
    fn the_root_lies_on_the_sphere_and_goes_forward() {
        let change = PenaltyIncrement { displacement: DVector::from_vec(vec![0.3, 0.1]), load: 0.05 };
        let by_residual = DVector::from_vec(vec![-0.02, 0.01]);
        let by_load = DVector::from_vec(vec![1.5, -0.4]);
        let size = change.size(0.7);
        let step = root(&change, &by_residual, &by_load, size, 0.7).expect("a root");
        let next = PenaltyIncrement {
            displacement: &change.displacement + by_residual + &by_load * step,
            load: change.load + step,
        };
        assert!((next.size(0.7) - size).abs() < 1e-15);
        assert!(next.displacement.dot(&change.displacement) > 0.0);
    }

    #[test]
    fn a_sphere_out_of_reach_has_no_root() {
        let change = PenaltyIncrement { displacement: DVector::from_vec(vec![1e-3, 0.0]), load: 0.0 };
        let by_residual = DVector::from_vec(vec![0.0, 1.0]);
        let by_load = DVector::from_vec(vec![1.0, 0.0]);
        assert_eq!(root(&change, &by_residual, &by_load, 1e-3, 0.0), None);
    }
}
