//! Obstacles as posted: their position under a load factor, and their frame at a node, for the measure only.
//!
//! A frame is the gap, the unit normal into the free side, and the tangents: in 2D `(n_y, -n_x)`; in 3D
//! `t1 = (e_k - n_k n)/|.|` with `k` the first index whose `|n_k|` is the smallest within 1e-9, and `t2 = n x t1`.

use crate::check::measure::numbers::{MeasuredVector, largest, padded};
use crate::check::measure::polyhedra::MeasuredPolyhedron;
use crate::check::measure::polylines::MeasuredCurve;
use crate::model::request::{Obstacle as Posted, PostedShape, Side};

/// Components of a unit normal that differ by no more than this count as equal.
const EQUALLY_ALIGNED: f64 = 1e-9;

/// An obstacle at rest.
#[derive(Debug, Clone)]
pub(super) struct MeasuredObstacle {
    /// A point of a plane, the centre of a ball, a point on the axis of a cylinder, the first point of a polyline or polyhedron.
    place: MeasuredVector,
    shape: ObstacleShape,
}

#[derive(Debug, Clone)]
enum ObstacleShape {
    /// Unit normal into the free side.
    Plane(MeasuredVector),
    /// `sign` is 1 if the free side is outside, otherwise -1.
    Ball {
        radius: f64,
        sign: f64,
    },
    Cylinder {
        axis: MeasuredVector,
        radius: f64,
        sign: f64,
    },
    /// With the directions of its coordinates.
    Polyline(MeasuredCurve, [MeasuredVector; 2]),
    Polyhedron(MeasuredPolyhedron),
}

/// The gap and the frame of an obstacle at a node.
#[derive(Debug, Clone, Copy)]
pub(super) struct MeasuredFrame {
    pub gap: f64,
    /// Rounding error of the gap due to the coordinates.
    pub rounding: f64,
    pub normal: MeasuredVector,
    /// `dimension - 1` tangents; in 2D the second tangent is zero.
    pub tangents: [MeasuredVector; 2],
}

impl MeasuredObstacle {
    pub fn new(posted: &Posted, dimension: usize) -> Self {
        match posted.shape(dimension) {
            PostedShape::Plane { point, normal } => {
                let normal = padded(normal);
                Self { place: padded(point), shape: ObstacleShape::Plane(normal * (1.0 / normal.norm())) }
            }
            PostedShape::Ball { center, radius, side } => {
                Self { place: padded(center), shape: ObstacleShape::Ball { radius, sign: sign_of(side) } }
            }
            PostedShape::Cylinder { point, axis, radius, side } => {
                let axis = padded(axis).normalize();
                let shape = ObstacleShape::Cylinder { axis, radius, sign: sign_of(side) };
                Self { place: padded(point), shape }
            }
            PostedShape::Curve(polyline) => {
                let first = polyline.points.first().map_or_else(MeasuredVector::zeros, |point| padded(point));
                let (origin, axes) = match &polyline.section {
                    None => (first, [MeasuredVector::x(), MeasuredVector::y()]),
                    Some(section) => {
                        let x = padded(&section.x).normalize();
                        let across = x.cross(&padded(&section.y).normalize()).normalize();
                        let y = across.cross(&x);
                        (padded(&section.origin) + x * first.x + y * first.y, [x, y])
                    }
                };
                Self { place: origin, shape: ObstacleShape::Polyline(MeasuredCurve::new(&polyline), axes) }
            }
            PostedShape::Polyhedron(mesh) => {
                let place = mesh.points.first().map_or_else(MeasuredVector::zeros, |point| padded(point));
                Self { place, shape: ObstacleShape::Polyhedron(MeasuredPolyhedron::new(&mesh)) }
            }
        }
    }

    /// The frame of this obstacle, in its axes, at a node at `place` that has moved by `relative` in these axes; `reach` is
    /// the largest component of the motions of both.
    pub fn frame(
        &self,
        dimension: usize,
        place: &MeasuredVector,
        relative: &MeasuredVector,
        reach: f64,
    ) -> MeasuredFrame {
        let from = (place - self.place) + relative;
        let (gap, normal, size) = match &self.shape {
            ObstacleShape::Plane(normal) => (from.dot(normal), *normal, 0.0),
            ObstacleShape::Ball { radius, sign } => around_center(from, *radius, *sign),
            ObstacleShape::Cylinder { axis, radius, sign } => {
                around_center(from - axis * from.dot(axis), *radius, *sign)
            }
            ObstacleShape::Polyline(curve, axes) => {
                let (gap, [x, y]) = curve.gap(axes.map(|axis| axis.dot(&from)));
                (gap, axes[0] * x + axes[1] * y, curve.size)
            }
            ObstacleShape::Polyhedron(polyhedron) => {
                let (gap, normal) = polyhedron.gap(&from);
                (gap, normal, polyhedron.size)
            }
        };
        let reach = [place, &self.place].into_iter().map(largest).fold(size.max(reach), f64::max);
        MeasuredFrame { gap, rounding: 16.0 * f64::EPSILON * reach, normal, tangents: tangents(dimension, &normal) }
    }
}

/// 1 where the free side is outside, otherwise -1.
fn sign_of(side: Side) -> f64 {
    if side == Side::Outside { 1.0 } else { -1.0 }
}

/// The gap, the normal and the radius at a place relative to the centre.
fn around_center(from: MeasuredVector, radius: f64, sign: f64) -> (f64, MeasuredVector, f64) {
    let distance = from.norm();
    let normal = if distance > 0.0 { from * (sign / distance) } else { MeasuredVector::x() };
    (sign * (distance - radius), normal, radius)
}

impl MeasuredFrame {
    /// The vector with these components along the tangents.
    pub fn in_space(&self, components: [f64; 2]) -> MeasuredVector {
        self.tangents[0] * components[0] + self.tangents[1] * components[1]
    }

    /// Components of a vector along the tangents.
    pub fn along(&self, vector: &MeasuredVector) -> [f64; 2] {
        self.tangents.map(|tangent| tangent.dot(vector))
    }
}

fn tangents(dimension: usize, normal: &MeasuredVector) -> [MeasuredVector; 2] {
    if dimension == 2 {
        return [MeasuredVector::new(normal.y, -normal.x, 0.0), MeasuredVector::zeros()];
    }
    let least = normal.amin() + EQUALLY_ALIGNED;
    let axis = if normal.x.abs() <= least {
        0
    } else if normal.y.abs() <= least {
        1
    } else {
        2
    };
    let mut across = normal * -normal[axis];
    across[axis] += 1.0;
    let first = across * (1.0 / across.norm());
    [first, normal.cross(&first)]
}
