//! Obstacles: how far a node is from them, and which way.

use crate::mechanics::contact::vector::{Vector, add, dot, size, unit};

/// A rigid obstacle as one contact sees it.
#[derive(Debug, Clone)]
pub enum RigidSurface {
    /// A half-space with unit `normal` into the free side.
    Plane { normal: Vector },
    /// A circle or sphere.
    Ball {
        /// The undeformed node's place, measured from the centre.
        offset: Vector,
        /// 1 where nodes are free outside, -1 where they are free inside.
        side: f64,
    },
}

impl RigidSurface {
    /// Change of the distance from the undeformed place, unit normal into the free side, and curvature `κ`: the normal
    /// turns by `dn = κ (dx - n (n·dx))`.
    ///
    /// `relative` is the node's displacement less the obstacle's.
    #[inline(always)]
    pub(super) fn distance(&self, relative: &Vector) -> (f64, Vector, f64) {
        match self {
            Self::Plane { normal } => (dot(normal, relative), *normal, 0.0),
            Self::Ball { offset, side } => {
                let place = add(offset, 1.0, relative);
                let (radius, before) = (size(&place), size(offset));
                // The difference of the radii without the cancellation.
                let change = (2.0 * dot(offset, relative) + dot(relative, relative)) / (radius + before);
                let outward = unit(&place);
                let normal = [side * outward[0], side * outward[1], side * outward[2]];
                (side * change, normal, side / radius)
            }
        }
    }

    pub fn is_curved(&self) -> bool {
        match self {
            Self::Plane { .. } => false,
            Self::Ball { .. } => true,
        }
    }
}
