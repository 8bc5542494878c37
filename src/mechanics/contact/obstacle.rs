//! Obstacles: the distance of a node from an obstacle, and its direction.

use crate::algebra::plane_curve::PlaneCurve;
use crate::mechanics::contact::vector::{Vector, add, dot, size, unit};
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
    /// A curve in the plane.
    Curve {
        curve: Arc<PlaneCurve>,
        /// The position of the undeformed node, relative to the origin of the curve.
        offset: Vector,
        /// 1 where nodes are free to the left of the curve, -1 where they are free to the right.
        side: f64,
        /// Distance of the undeformed node into the free side.
        before: f64,
    },
}

impl RigidSurface {
    /// The change of the distance since the undeformed position, the unit normal into the free side, and the curvature
    /// `κ`: the normal turns by `dn = κ (dx - n (n·dx))`.
    ///
    /// `relative` is the node's displacement less the obstacle's.
    #[inline(always)]
    pub(super) fn distance(&self, relative: &Vector) -> (f64, Vector, f64) {
        match self {
            Self::Plane { normal } => (dot(normal, relative), *normal, 0.0),
            Self::Ball { offset, side } => {
                let place = add(offset, 1.0, relative);
                let (radius, before) = (size(&place), size(offset));
                // The difference of the radii, without cancellation.
                let change = (2.0 * dot(offset, relative) + dot(relative, relative)) / (radius + before);
                let outward = unit(&place);
                let normal = [side * outward[0], side * outward[1], side * outward[2]];
                (side * change, normal, side / radius)
            }
            Self::Curve { curve, offset, side, before } => {
                let place = add(offset, 1.0, relative);
                let closest = curve.closest([place[0], place[1]]);
                let normal = [side * closest.normal[0], side * closest.normal[1], 0.0];
                (side * closest.distance - before, normal, -side * closest.curvature_at_place())
            }
        }
    }

    pub fn is_curved(&self) -> bool {
        match self {
            Self::Plane { .. } => false,
            Self::Ball { .. } | Self::Curve { .. } => true,
        }
    }
}
