//! Where obstacles that move and turn are, as posted.
//!
//! A point `X` of an obstacle is at `c + d + R(X - c)`, with the pivot `c`, the translation `d` and the rotation `R` by the
//! angle about the axis through the pivot. In the axes of the obstacle, which turn with it, a node at `x` is at
//! `c + Rᵀ(x - c - d)`.

use crate::check::measure::numbers::{MeasuredVector, largest, padded};
use crate::model::request::{Model, Obstacle, ObstacleRotation};
use nalgebra::{Rotation3, Unit};

/// The point and the axis about which an obstacle turns.
#[derive(Debug, Clone)]
pub(super) struct MeasuredPivot {
    place: MeasuredVector,
    axis: Unit<MeasuredVector>,
}

/// Where an obstacle is.
#[derive(Debug, Clone, Copy)]
pub(super) struct ObstaclePlacement<'a> {
    /// `d`
    pub shift: MeasuredVector,
    /// The pivot with the angle, if the obstacle turns in some stage.
    pub turned: Option<(&'a MeasuredPivot, f64)>,
}

impl MeasuredPivot {
    /// The pivot of an obstacle that some stage turns.
    pub fn of(model: &Model, name: &str) -> Option<Self> {
        let rotation = model.stages.iter().find_map(|stage| stage.obstacle_rotation.get(name))?;
        let ObstacleRotation { about, axis, .. } = rotation;
        let (own, own_axis) = match model.obstacles.get(name)? {
            Obstacle::Plane { point, .. } => (Some(point), None),
            Obstacle::Cylinder { point, axis, .. } => (Some(point), Some(axis)),
            Obstacle::Ball { center, .. } => (Some(center), None),
            Obstacle::Box(own) => (Some(&own.center), None),
            Obstacle::Polyline(_) | Obstacle::TriangleMesh(_) => (None, None),
        };
        let axis = match axis.as_ref().or(own_axis) {
            Some(axis) if model.dimension == 3 => padded(axis),
            _ => MeasuredVector::z(),
        };
        Some(Self { place: padded(about.as_ref().or(own)?), axis: Unit::new_normalize(axis) })
    }
}

impl ObstaclePlacement<'_> {
    /// The motion of a node at `place` in the axes of the obstacle, and the largest component of what it follows from.
    pub fn relative(&self, place: &MeasuredVector, displacement: &MeasuredVector) -> (MeasuredVector, f64) {
        let moved = displacement - self.shift;
        let reach = largest(displacement).max(largest(&self.shift));
        let Some((pivot, angle)) = self.turned else { return (moved, reach) };
        let arm = place - pivot.place;
        let present = arm + moved;
        (self.rotation(pivot, angle).inverse() * present - arm, reach.max(largest(&present)).max(largest(&arm)))
    }

    /// A vector of the obstacle's axes in those of space.
    pub fn in_space(&self, vector: MeasuredVector) -> MeasuredVector {
        self.turned.map_or(vector, |(pivot, angle)| self.rotation(pivot, angle) * vector)
    }

    fn rotation(&self, pivot: &MeasuredPivot, angle: f64) -> Rotation3<f64> {
        Rotation3::from_axis_angle(&pivot.axis, angle)
    }
}
