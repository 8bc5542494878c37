//! Obstacles: the distance of a node from an obstacle, and its direction.

use crate::algebra::plane_curve::PlaneCurve;
use crate::algebra::rounded_polyhedron::RoundedPolyhedron;
use crate::mechanics::contact::frame::Curvature;
use crate::mechanics::contact::vector::{Vector, add, dot, scaled, size, unit};
use std::sync::Arc;

/// The surface of a rigid obstacle, relative to one contact.
#[derive(Debug, Clone)]
pub enum RigidSurface {
    /// A half-space with unit `normal` into the free side.
    Plane { normal: Vector },
    /// A circle or sphere.
    Ball {
        /// The position of the undeformed node, relative to the centre.
        offset: Vector,
        /// 1 where nodes are free outside, -1 where they are free inside.
        side: f64,
    },
    /// A circular cylinder without ends, in space.
    Cylinder {
        /// Unit vector along the axis.
        axis: Vector,
        /// The position of the undeformed node, relative to the axis and perpendicular to it.
        offset: Vector,
        /// 1 where nodes are free outside, -1 where they are free inside.
        side: f64,
    },
    /// A curve in a plane, straight across it.
    Curve {
        curve: Arc<PlaneCurve>,
        /// Unit vectors along the coordinates of the curve, and across its plane.
        section: [Vector; 3],
        /// The position of the undeformed node, relative to the origin of the curve, in its coordinates.
        offset: Vector,
        /// 1 where nodes are free to the left of the curve, -1 where they are free to the right.
        side: f64,
        /// Distance of the undeformed node into the free side.
        before: f64,
    },
    /// A polyhedron with rounded edges, in space.
    Polyhedron {
        surface: RoundedPolyhedron,
        /// The position of the undeformed node, relative to the origin of the polyhedron.
        offset: Vector,
        /// 1 where nodes are free outside, -1 where they are free inside.
        side: f64,
        /// Distance of the undeformed node into the free side.
        before: f64,
    },
}

impl RigidSurface {
    /// The change of the distance since the undeformed position, the unit normal into the free side, and its
    /// curvature.
    ///
    /// `relative` is the node's displacement less the obstacle's.
    #[inline(always)]
    pub(super) fn distance(&self, relative: &Vector) -> (f64, Vector, Curvature) {
        match self {
            Self::Plane { normal } => (dot(normal, relative), *normal, Curvature::default()),
            Self::Ball { offset, side } => {
                let (change, normal, curvature) = around_center(offset, relative, *side);
                (change, normal, Curvature::uniform(curvature))
            }
            Self::Cylinder { axis, offset, side } => {
                let across = add(relative, -dot(relative, axis), axis);
                let (change, normal, value) = around_center(offset, &across, *side);
                (change, normal, Curvature::around(value, *axis))
            }
            Self::Curve { curve, section: [x, y, straight], offset, side, before } => {
                let closest = curve.closest([offset[0] + dot(relative, x), offset[1] + dot(relative, y)]);
                let normal = add(&scaled(x, side * closest.normal[0]), side * closest.normal[1], y);
                let curvature = Curvature::around(-side * closest.curvature_at_place(), *straight);
                (side * closest.distance - before, normal, curvature)
            }
            Self::Polyhedron { surface, offset, side, before } => {
                let foot = surface.closest(add(offset, 1.0, relative));
                let [(value, _), (other, along)] = foot.curvatures;
                let curvature = Curvature { value: side * value, less: side * (value - other), along: along.into() };
                (side * foot.distance - before, scaled(&foot.normal.into(), *side), curvature)
            }
        }
    }

    /// Round-off of the distance: that of coordinates where it is measured from them, none where its change follows from the
    /// displacement.
    pub fn rounding(&self) -> f64 {
        match self {
            Self::Plane { .. } | Self::Ball { .. } | Self::Cylinder { .. } => 0.0,
            Self::Curve { offset, before, .. } | Self::Polyhedron { offset, before, .. } => {
                4.0 * f64::EPSILON * size(offset).max(before.abs())
            }
        }
    }

    pub fn is_curved(&self) -> bool {
        match self {
            Self::Plane { .. } => false,
            Self::Ball { .. } | Self::Cylinder { .. } | Self::Curve { .. } | Self::Polyhedron { .. } => true,
        }
    }

    /// Whether two contacts of one node have the same surface: their lengths and directions differ by no more than a
    /// tolerance.
    pub fn coincides(&self, other: &Self, tolerance: f64) -> bool {
        let near = |a: &Vector, b: &Vector| a.iter().zip(b).all(|(a, b)| (a - b).abs() <= tolerance);
        match (self, other) {
            (Self::Plane { normal: a }, Self::Plane { normal: b }) => near(a, b),
            (Self::Ball { offset: a, side: x }, Self::Ball { offset: b, side: y }) => near(a, b) && x == y,
            (Self::Cylinder { axis: a, offset: x, side: u }, Self::Cylinder { axis: b, offset: y, side: v }) => {
                (near(a, b) || near(a, &scaled(b, -1.0))) && near(x, y) && u == v
            }
            (
                Self::Curve { curve: a, section: first, offset: x, side: u, .. },
                Self::Curve { curve: b, section: second, offset: y, side: v, .. },
            ) => {
                let same_plane = first.iter().zip(second).all(|(first, second)| near(first, second));
                (Arc::ptr_eq(a, b) || a == b) && same_plane && near(x, y) && u == v
            }
            (
                Self::Polyhedron { surface: a, offset: x, side: u, .. },
                Self::Polyhedron { surface: b, offset: y, side: v, .. },
            ) => a == b && near(x, y) && u == v,
            (
                Self::Plane { .. }
                | Self::Ball { .. }
                | Self::Cylinder { .. }
                | Self::Curve { .. }
                | Self::Polyhedron { .. },
                _,
            ) => false,
        }
    }
}

/// The change of the distance from a centre, the normal and the curvature at a place that has moved by `relative`.
#[inline(always)]
fn around_center(offset: &Vector, relative: &Vector, side: f64) -> (f64, Vector, f64) {
    let place = add(offset, 1.0, relative);
    let (radius, before) = (size(&place), size(offset));
    // The difference of the radii, without cancellation.
    let change = (2.0 * dot(offset, relative) + dot(relative, relative)) / (radius + before);
    (side * change, scaled(&unit(&place), side), side / radius)
}
