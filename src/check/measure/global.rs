//! Checks the balance of the whole structure, and the forces that an increment reports.
//!
//! All bars and nodes together are in equilibrium under the forces from outside: supports, loads, contacts, and springs,
//! which do not follow rotation and may exert couples.
//!
//! ```text
//! Σ F = 0,   Σ (x - c) × F = 0,   x: deformed position of the node,  c: centre of the box around the undeformed nodes
//! ```

use crate::check::measure::elements::ElementResponse;
use crate::check::measure::errors::{Errors, worse};
use crate::check::measure::posted::{Posted, PostedLoading};
use crate::check::measure::vector::{MeasuredVector, largest, padded};
use crate::result::increment::{ElementState, Increment};

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
        worse(beyond(&self.force, of_forces) / force, beyond(&self.moment, of_moments) / (force * extent))
    }
}

/// The forces of an increment's supports, in the order of the posted supports; `None` where they do not fit the model.
pub(super) fn reactions<'a>(
    posted: &'a Posted,
    increment: &'a Increment,
) -> Option<impl Iterator<Item = (usize, MeasuredVector)> + 'a> {
    let fits = increment.supports.len() == posted.supports.len()
        && posted
            .supports
            .iter()
            .zip(increment.supports.iter())
            .all(|(node, (name, values))| **name == *posted.nodes[*node].name && values.len() == posted.dimension);
    fits.then(|| posted.supports.iter().copied().zip(increment.supports.values().map(padded)))
}

/// Adds to `errors` what is reported of an element's force; `force_scale` makes forces dimensionless.
pub(super) fn judge_element(
    state: &ElementState,
    response: &ElementResponse,
    dimension: usize,
    force_scale: f64,
    errors: &mut Errors,
) {
    let off = match (state.axial_force, &state.force, response.axial) {
        (Some(reported), None, Some(axial)) => (reported - axial).abs(),
        (None, Some(reported), None) if reported.len() == dimension => {
            largest_or_nan(&(padded(reported) - response.force))
        }
        _ => f64::INFINITY,
    };
    errors.reported = worse(errors.reported, (off - response.rounding.min(off)) / force_scale);
}

/// Adds to `errors` what is reported of the sum of the loads.
pub(super) fn judge_loads(
    increment: &Increment,
    loading: &PostedLoading,
    dimension: usize,
    force: f64,
    errors: &mut Errors,
) {
    if increment.applied_forces.is_empty() {
        return;
    }
    let sum: MeasuredVector = loading.forces.iter().sum();
    let sizes: f64 = loading.forces.iter().map(largest).sum();
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
