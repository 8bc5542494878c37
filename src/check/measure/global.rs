//! Checks the balance of the whole structure, and the forces that an increment reports.
//!
//! All elements and nodes together are in equilibrium under the forces from outside: supports, loads, contacts, and springs
//! and solids of small strains, which do not follow rotation and may exert couples.
//!
//! ```text
//! Σ F = 0,   Σ (x - c) × F = 0,   x: deformed position of the node,  c: centre of the box around the undeformed nodes
//! ```

use crate::check::measure::beams::BeamResponse;
use crate::check::measure::elements::MeasuredResponse;
use crate::check::measure::errors::{Errors, worse};
use crate::check::measure::numbers::{MeasuredVector, largest, padded};
use crate::check::measure::posted::Posted;
use crate::check::measure::solids::SolidResponse;
use crate::result::increment::{BeamEndForces, ElementState, Increment};
use nalgebra::Matrix3 as MeasuredTensor;

/// Error of a sum of products of rounded numbers, in units of the machine epsilon.
const ROUNDINGS: f64 = 64.0;

/// The forces from outside, summed.
#[derive(Debug, Clone, Default)]
pub(super) struct Balance {
    force: MeasuredVector,
    moment: MeasuredVector,
    /// Sum of the sizes of the forces, those between the nodes included.
    sizes: f64,
    /// Largest distance by which a node with a force has moved.
    moved: f64,
}

impl Balance {
    /// Adds a force from outside on a node.
    pub fn add(&mut self, posted: &Posted, node: usize, displacement: &MeasuredVector, force: &MeasuredVector) {
        self.force += force;
        self.moment += (posted.nodes[node].place - posted.centre + displacement).cross(force);
        self.sizes += largest(force);
        self.moved = self.moved.max(largest(displacement));
    }

    /// Adds a moment from outside.
    pub fn add_moment(&mut self, moment: MeasuredVector) {
        self.moment += moment;
    }

    /// Includes the size of a force between two nodes.
    pub fn between(&mut self, force: &MeasuredVector) {
        self.sizes += largest(force);
    }

    /// The unbalanced force and moment, dimensionless; `rounding`: of the nodes' balances, summed.
    pub fn error(&self, posted: &Posted, length: f64, force: f64, rounding: f64) -> f64 {
        let extent = (posted.extent + self.moved).max(length);
        let of_forces = rounding + ROUNDINGS * f64::EPSILON * self.sizes;
        let of_moments = of_forces * extent + ROUNDINGS * f64::EPSILON * posted.reach * self.sizes;
        let beyond = |sum: &MeasuredVector, allowed: f64| {
            let size = sum.iter().copied().fold(0.0, |size, value| worse(size, value.abs()));
            size - size.min(allowed)
        };
        if posted.is_revolved {
            return beyond(&MeasuredVector::new(0.0, self.force.y, 0.0), of_forces) / force;
        }
        worse(beyond(&self.force, of_forces) / force, beyond(&self.moment, of_moments) / (force * extent))
    }
}

/// The forces and moments of an increment's supports, in the order of the posted supports; `None` where they do not fit the model.
pub(super) fn reactions<'a>(
    posted: &'a Posted,
    increment: &'a Increment,
) -> Option<impl Iterator<Item = (usize, MeasuredVector, MeasuredVector)> + 'a> {
    let fits = increment.supports.len() == posted.supports.len()
        && posted.supports.iter().zip(increment.supports.iter()).all(|(node, (name, values))| {
            let node = &posted.nodes[*node];
            **name == *node.name && values.len() == posted.components_of(node)
        });
    let reaction = |values: &[f64]| (padded(&values[..posted.dimension]), posted.rotation(values));
    fits.then(move || {
        let reactions = increment.supports.values().map(reaction);
        posted.supports.iter().copied().zip(reactions).map(|(node, (force, moment))| (node, force, moment))
    })
}

/// Adds to `errors` what is reported of an element; `force_scale` and `length` make forces and moments dimensionless.
pub(super) fn judge_element(
    state: &ElementState,
    response: &MeasuredResponse,
    dimension: usize,
    (force_scale, length): (f64, f64),
    errors: &mut Errors,
) {
    let response = match response {
        MeasuredResponse::Forces(response) => response,
        MeasuredResponse::Beam(response) => {
            let off = state.ends.map_or(f64::INFINITY, |ends| off_ends(&ends, response, length));
            errors.reported = worse(errors.reported, off / force_scale);
            return;
        }
        MeasuredResponse::Solid(response) => {
            let off = off_stress(state, response, dimension).unwrap_or(f64::INFINITY) * response.area;
            errors.reported = worse(errors.reported, (off - response.rounding.min(off)) / force_scale);
            return;
        }
        MeasuredResponse::Moment { moment, rounding, .. } => {
            let off = state.moment.map_or(f64::INFINITY, |reported| (reported - moment.z).abs());
            errors.reported = worse(errors.reported, (off - rounding.min(off)) / (force_scale * length));
            return;
        }
    };
    let off = match (state.axial_force, &state.force, response.axial) {
        (Some(reported), None, Some(axial)) => (reported - axial).abs(),
        (None, Some(reported), None) if reported.len() == dimension => {
            largest_or_nan(&(padded(reported) - response.force))
        }
        _ => f64::INFINITY,
    };
    errors.reported = worse(errors.reported, (off - response.rounding.min(off)) / force_scale);
}

/// The largest error of what is reported of a solid's stress; `None` where it has not as many components.
fn off_stress(state: &ElementState, response: &SolidResponse, dimension: usize) -> Option<f64> {
    let stress = &response.stress;
    let all = [(0, 0), (1, 1), (2, 2), (0, 1), (1, 2), (0, 2)];
    let expected = &all[..if dimension == 2 { 4 } else { 6 }];
    let reported = state.stress.as_ref().filter(|reported| reported.len() == expected.len())?;
    let off = reported.iter().zip(expected).map(|(value, place)| (value - stress[*place]).abs());
    let deviator = stress - MeasuredTensor::identity() * (stress.trace() / 3.0);
    let equivalent = (1.5 * deviator.dot(&deviator)).sqrt();
    Some(off.fold((state.von_mises? - equivalent).abs(), worse))
}

/// The largest error of what is reported of a beam's ends beyond rounding, as a force.
fn off_ends(ends: &[BeamEndForces; 2], response: &BeamResponse, length: f64) -> f64 {
    let (mut of_forces, mut of_moments) = (0.0_f64, 0.0_f64);
    for share in response.nodes.iter().flatten() {
        of_forces = of_forces.max(share.force_rounding);
        of_moments = of_moments.max(share.moment_rounding);
    }
    let beyond = |off: f64, allowed: f64| off.abs() - allowed.min(off.abs());
    let mut worst = 0.0;
    for (end, expected) in ends.iter().zip(response.ends.iter().map(|end| &end[..response.of_end])) {
        let reported: Vec<f64> = end.values().collect();
        if reported.len() != expected.len() {
            return f64::INFINITY;
        }
        // Forces come first, and as many moments as forces in space, one in the plane.
        let forces = if expected.len() == 3 { 2 } else { 3 };
        for (place, (reported, expected)) in reported.iter().zip(expected).enumerate() {
            let off = reported - expected;
            worst =
                worse(worst, if place < forces { beyond(off, of_forces) } else { beyond(off, of_moments) / length });
        }
    }
    worst
}

/// Adds to `errors` what is reported of the sum of the loads.
pub(super) fn judge_loads<'a>(
    increment: &Increment,
    loads: impl Iterator<Item = &'a MeasuredVector> + Clone,
    dimension: usize,
    force: f64,
    errors: &mut Errors,
) {
    if increment.applied_forces.is_empty() {
        return;
    }
    let sum: MeasuredVector = loads.clone().sum();
    let sizes: f64 = loads.map(largest).sum();
    if increment.applied_forces.len() != dimension {
        errors.reported = f64::MAX;
        return;
    }
    let off = largest_or_nan(&(padded(&increment.applied_forces) - sum));
    let rounding = ROUNDINGS * f64::EPSILON * sizes;
    errors.reported = worse(errors.reported, (off - rounding.min(off)) / force);
}

/// The largest absolute value of a component; NaN if one of them is.
pub(super) fn largest_or_nan(vector: &MeasuredVector) -> f64 {
    vector
        .iter()
        .fold(0.0, |most, value| if value.is_nan() || most.is_nan() { f64::NAN } else { value.abs().max(most) })
}
