//! The position of a node relative to an obstacle at the start.

use crate::model::check::obstacles::SoundObstacle;
use crate::model::check::scope::Scope;
use crate::model::check::scope::numbers::{difference, dot, largest, norm, scaled};
use crate::model::request::{PostedShape, Side};

/// The position of a node relative to an obstacle at the start.
#[derive(Debug)]
pub(in crate::model::check) struct Facing {
    /// Distance into the free side (length).
    pub gap: f64,
    /// Unit normal into the free side; `None` at the centre of a ball and on the axis of a cylinder, where there is
    /// none.
    pub normal: Option<Vec<f64>>,
    /// Rounding error of the gap due to the coordinates and the radius (length).
    pub tolerance: f64,
}

impl SoundObstacle<'_> {
    /// `None` if the node is malformed, which is reported elsewhere.
    pub(in crate::model::check) fn facing(&self, scope: &Scope, node: usize) -> Option<Facing> {
        let position = scope.position(node)?;
        let reach = |far: f64| scope.penetration_tolerance(largest(position).max(far));
        match &self.shape {
            PostedShape::Plane { point, normal } => {
                let unit = scaled(normal, norm(normal));
                let gap = dot(&difference(position, point), &unit);
                Some(Facing { gap, normal: Some(unit), tolerance: reach(largest(point)) })
            }
            PostedShape::Ball { center, radius, side } => {
                let tolerance = reach(largest(center).max(*radius));
                Some(facing_round(&difference(position, center), *radius, *side, tolerance))
            }
            PostedShape::Cylinder { point, axis, radius, side } => {
                let axis = scaled(axis, norm(axis));
                let mut outward = difference(position, point);
                let along = dot(&outward, &axis);
                outward.iter_mut().zip(&axis).for_each(|(component, axis)| *component -= along * axis);
                let tolerance = reach(largest(point).max(*radius));
                Some(facing_round(&outward, *radius, *side, tolerance))
            }
            PostedShape::Curve(polyline) => {
                let (origin, side, axes) = (polyline.origin(), polyline.free_side(), polyline.axes());
                let [x, y] = polyline.coordinates(position);
                let closest = self.curve.as_ref()?.closest([x - origin[0], y - origin[1]]);
                let component = |k: usize| side * (closest.normal[0] * axes[0][k] + closest.normal[1] * axes[1][k]);
                let normal = Some((0..scope.model.dimension).map(component).collect());
                Some(Facing { gap: side * closest.distance, normal, tolerance: reach(polyline.reach()) })
            }
            PostedShape::Polyhedron(mesh) => {
                let (origin, side) = (mesh.origin(), mesh.side.sign());
                let foot = self.surface.as_ref()?.closest(std::array::from_fn(|k| position[k] - origin[k]));
                let normal = Some(foot.normal.iter().map(|part| side * part).collect());
                Some(Facing { gap: side * foot.distance, normal, tolerance: reach(mesh.reach()) })
            }
        }
    }
}

/// The position at a vector from the centre, or from the axis and perpendicular to it.
fn facing_round(outward: &[f64], radius: f64, side: Side, tolerance: f64) -> Facing {
    let distance = norm(outward);
    let (gap, length) = match side {
        Side::Outside => (distance - radius, distance),
        Side::Inside => (radius - distance, -distance),
    };
    let normal = (distance > tolerance).then(|| scaled(outward, length));
    Facing { gap, normal, tolerance }
}
