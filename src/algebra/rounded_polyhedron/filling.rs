//! The share of a ball that a polyhedron fills, in closed form.
//!
//! With the radius 1, the centre `y` and its distance `d` behind the plane of a face, the divergence theorem turns the
//! integral over the inside into integrals over the parts of the faces in the ball:
//!
//! ```text
//! F  =  χ + Σ ∫ d k(r) dA / W,    k(r) = 1/3 - 2r²/5 + r⁴/7 - 8/(105 r³),    W = 32π/105
//! ∇F = -Σ n ∫ w(r) dA / W
//! ∇∇F = -Σ n ⊗ ∫ 4 (1 - r²) (p - y) dA / W
//! ```
//!
//! `χ` is 1 inside the polyhedron and 0 outside. In polar coordinates about the foot of `y` in the plane of a face each
//! integral is a sum over the edges of the face: of polynomials along an edge where it is in the ball, and of an angle where
//! the ball ends before the edge. The last term of `k` gives solid angles.

use crate::algebra::rounded_polyhedron::polyhedron::{FlatFace, Polyhedron};
use nalgebra::{Matrix3, Vector3};
use std::f64::consts::PI;

/// `W`
const WHOLE: f64 = 32.0 * PI / 105.0;
/// `W / 4π`, the factor of the solid angle.
const OVER_SPHERE: f64 = 8.0 / 105.0;

/// The filled share of a ball, and its derivatives with respect to the centre.
#[derive(Debug, Clone, Copy)]
pub(super) struct Filling {
    pub share: f64,
    pub gradient: Vector3<f64>,
    pub second: Matrix3<f64>,
}

/// The filled share of the ball about a centre; 0, inside as outside, where no face is in the ball.
///
/// On an edge itself the share is undetermined: the solid angles have no limit there.
pub(super) fn filling(polyhedron: &Polyhedron, center: &Vector3<f64>) -> Filling {
    let mut found = Filling { share: 0.0, gradient: Vector3::zeros(), second: Matrix3::zeros() };
    for face in polyhedron.triangles.faces_within(1.0, center) {
        found.add_face(polyhedron, &polyhedron.faces[face], center);
    }
    // Faces take from the whole inside, and add to nothing outside.
    found.share = found.share / WHOLE + if found.share < 0.0 { 1.0 } else { 0.0 };
    found.gradient /= WHOLE;
    found.second = (found.second + found.second.transpose()) * (0.5 / WHOLE);
    found
}

impl Filling {
    fn add_face(&mut self, polyhedron: &Polyhedron, face: &FlatFace, center: &Vector3<f64>) {
        let Some(first) = face.boundary.first() else { return };
        let normal = &face.normal;
        let depth = (polyhedron.edges[first.edge].ends[0] - center).dot(normal);
        let side = if depth >= 0.0 { 1.0 } else { -1.0 };
        let mut sums = FaceIntegrals::default();
        let mut across = Vector3::zeros();
        for boundary in &face.boundary {
            let edge = &polyhedron.edges[boundary.edge];
            let ends = edge.ends.map(|end| end - center);
            let [from, to] = ends.map(|end| end.dot(&edge.direction));
            // From the nearer end: the foot on the edge is then exact enough for the two faces of an edge to agree on the
            // angle between them, however near the centre is.
            let nearer = if ends[0].norm_squared() <= ends[1].norm_squared() { 0 } else { 1 };
            let foot = ends[nearer] - edge.direction * [from, to][nearer];
            let part = EdgePart {
                depth: foot.dot(normal),
                across: foot.dot(&boundary.outwards),
                along: if boundary.sense > 0.0 { [from, to] } else { [-to, -from] },
                side,
            };
            let along_edge = part.add_to(&mut sums);
            across += boundary.outwards * along_edge;
        }
        self.share += sums.of_kernel;
        self.gradient -= normal * sums.of_weight;
        self.second -= normal * (normal * (4.0 * depth * sums.of_slope) - across).transpose();
    }
}

/// Integrals over the part of a face in the ball.
#[derive(Debug, Clone, Copy, Default)]
struct FaceIntegrals {
    /// `∫ d k dA`
    of_kernel: f64,
    /// `∫ w dA`
    of_weight: f64,
    /// `∫ (1 - r²) dA`
    of_slope: f64,
}

/// The triangle between the foot of the centre in the plane of a face and an edge of the face.
struct EdgePart {
    /// Distance of the centre behind the face.
    depth: f64,
    /// Distance of the edge from the foot, positive out of the face.
    across: f64,
    /// Where the edge begins and ends, along itself.
    along: [f64; 2],
    /// The sign of the depth, the same at all edges of the face.
    side: f64,
}

impl EdgePart {
    /// Adds what the edge contributes to the integrals; the integral of the weight along the edge.
    fn add_to(&self, sums: &mut FaceIntegrals) -> f64 {
        let Self { depth, across, along: [from, to], side } = *self;
        let (square, near) = (depth * depth, across * across);
        let within = (1.0 - square).max(0.0);
        let half_chord = (within - near).max(0.0).sqrt();
        let [low, high] = [from.max(-half_chord), to.min(half_chord)];
        let is_within = -half_chord <= from && to <= half_chord;
        let mut beyond = if is_within { 0.0 } else { self.angle(from, to) };
        let mut weight_along = 0.0;
        if low < high {
            let angle = self.angle(low, high);
            if !is_within {
                beyond -= angle;
            }
            // Powers of the distance from the foot, integrated along the edge.
            let line = high - low;
            let squares = (high.powi(3) - low.powi(3)) / 3.0;
            let second = near * line + squares;
            let fourth = near * near * line + 2.0 * near * squares + (high.powi(5) - low.powi(5)) / 5.0;
            let polynomial = line / 3.0 - (2.0 * square * line + second) / 5.0
                + (3.0 * square * square * line + 3.0 * square * second + fourth) / 21.0;
            let solid_angle = side * angle - self.lacking(low, high);
            sums.of_kernel += 0.5 * depth * across * polynomial - OVER_SPHERE * solid_angle;
            sums.of_weight += across / 6.0 * (3.0 * within * within * line - 3.0 * within * second + fourth);
            sums.of_slope += across * (0.5 * within * line - 0.25 * second);
            weight_along = within * within * line - 2.0 * within * second + fourth;
        }
        let polynomial = 19.0 / 105.0 - square * (1.0 / 3.0 - square * (0.2 - square / 21.0));
        sums.of_kernel += beyond * (0.5 * depth * polynomial - OVER_SPHERE * (side - depth));
        sums.of_weight += beyond * within.powi(3) / 6.0;
        sums.of_slope += beyond * within * within / 4.0;
        weight_along
    }

    /// The angle at the foot between two places along the edge.
    fn angle(&self, from: f64, to: f64) -> f64 {
        (self.across * (to - from)).atan2(self.across * self.across + from * to)
    }

    /// By how much the solid angle between two places along the edge, as the foot sees them, is less than their angle, with
    /// the sign of the depth.
    ///
    /// That of the right triangle from the foot across to the edge and up to `q` along it is `atan(d q/(ℓ r))`, with the
    /// distance `r` from the centre.
    fn lacking(&self, from: f64, to: f64) -> f64 {
        let size = |along: f64| (self.depth * self.depth + self.across * self.across + along * along).sqrt();
        let across = self.across.abs();
        let [first, second] = [from, to].map(|along| (across * size(along), self.depth * along));
        let difference = (second.1 * first.0 - first.1 * second.0).atan2(second.0 * first.0 + second.1 * first.1);
        difference * self.across.signum()
    }
}
