//! A face in its present position with the pieces of the opposite surface that cover it, and the derivatives of what they
//! give by the positions of the nodes.

use crate::algebra::differential::WithGradient;
use crate::mechanics::contact::bodies::face_moments::{
    FaceAtNode, IN_PLANE, MOMENTS, MeanAtNode, OF_FACE, moments, nodal_values,
};
use crate::mechanics::contact::bodies::{PlaneVector, turned_left};
use smallvec::SmallVec;

/// A piece of the opposite surface in the frame of a face, with `N` values.
pub(super) struct CoveringPiece<const N: usize> {
    /// Its nodes, by their indices among the contact's.
    pub(super) nodes: [usize; 2],
    /// Length of the face, then `s` and `h` of both nodes, in a body of revolution the radii of the face's nodes.
    pub(super) values: [f64; N],
    pub(super) along: [f64; 2],
    /// The same coordinates, less those of the points of the face that were opposite at rest, where the mean over the face does
    /// not depend on the latter: see [`CoveredFace::moments_of_slip`].
    pub(super) slipped: [f64; 2],
    /// Whether the surface ends at the first and at the last node; the piece goes on straight there.
    pub(super) goes_on: [bool; 2],
}

/// A face in its present position, with what covers it.
pub(super) struct CoveredFace<const N: usize> {
    /// Its nodes, by their indices among the contact's.
    pub(super) nodes: [usize; 2],
    pub(super) at: FaceAtNode,
    pub(super) length: f64,
    pub(super) along: PlaneVector,
    pub(super) pieces: SmallVec<[CoveringPiece<N>; 4]>,
}

/// All variables of up to two faces.
pub(super) const VARIABLES: usize = 2 * OF_FACE;

/// Calls `each` with a node and the gradient by its position of the function whose gradient by the variables of the
/// covered faces is `weights`; a node may come several times.
pub(super) fn each_gradient<const N: usize>(
    covered: &[CoveredFace<N>],
    weights: &[f64; VARIABLES],
    mut each: impl FnMut(usize, PlaneVector),
) {
    for (face, weights) in covered.iter().zip(weights.chunks_exact(OF_FACE)) {
        let by_length = weights[MOMENTS];
        face.each_of_length(|node, gradient| each(node, gradient.map(|part| by_length * part)));
        for piece in &face.pieces {
            let mut slopes = [0.0; N];
            for (moment, weight) in face.moments_of(piece).iter().zip(weights) {
                slopes.iter_mut().zip(&moment.gradient).for_each(|(sum, part)| *sum += weight * part);
            }
            face.each_coordinate(piece, &slopes, &mut each);
        }
    }
}

/// Calls `each` with a variable of the covered faces, a node and the variable's gradient by its position, for all
/// variables; a node may come several times.
pub(super) fn each_variable<const N: usize>(
    covered: &[CoveredFace<N>],
    mut each: impl FnMut(usize, usize, PlaneVector),
) {
    for (which, face) in covered.iter().enumerate() {
        let first = which * OF_FACE;
        face.each_of_length(|node, gradient| each(first + MOMENTS, node, gradient));
        for piece in &face.pieces {
            for (k, moment) in face.moments_of(piece).iter().enumerate() {
                face.each_coordinate(piece, &moment.gradient, &mut |node, gradient| each(first + k, node, gradient));
            }
        }
    }
}

impl<const N: usize> CoveredFace<N> {
    /// The moments of a piece with their gradients by the piece's values.
    fn moments_of(&self, piece: &CoveringPiece<N>) -> [WithGradient<N>; MOMENTS] {
        let variables: [_; N] = std::array::from_fn(|k| WithGradient::variable(piece.values[k], k));
        moments(&variables, piece.along, piece.goes_on, self.at.from)
    }

    /// Calls `each` with the gradient of the length by the positions of the nodes.
    fn each_of_length(&self, mut each: impl FnMut(usize, PlaneVector)) {
        each(self.nodes[0], self.along.map(|part| -part));
        each(self.nodes[1], self.along);
    }

    pub(super) fn moments(&self) -> [f64; OF_FACE] {
        let mut sums = [0.0; OF_FACE];
        for piece in &self.pieces {
            let own = moments(&piece.values, piece.along, piece.goes_on, self.at.from);
            sums.iter_mut().zip(own).for_each(|(sum, part)| *sum += part);
        }
        sums[MOMENTS] = self.length;
        sums
    }

    /// As [`Self::moments`], with the positions less the undeformed coordinates of the face, `S + σ`. The value at the node of
    /// the line that fits them is that of the positions alone, for the coordinate of the node is none of the state; and where
    /// positions have the rounding of coordinates, these have that of displacements.
    pub(super) fn moments_of_slip(&self) -> [f64; OF_FACE] {
        let mut sums = self.moments();
        let [places, places_first] = [MOMENTS - 3, MOMENTS - 2];
        (sums[places], sums[places_first]) = (0.0, 0.0);
        for piece in &self.pieces {
            let own = moments(&piece.values, piece.slipped, piece.goes_on, self.at.from);
            sums[places] += own[places];
            sums[places_first] += own[places_first];
        }
        sums
    }

    /// Calls `each` with the gradient by the positions of nodes of a function of the piece's values with these slopes:
    ///
    /// ```text
    /// ds = t·(dx - dx₁) + h/L n·(dx₂ - dx₁),   dh = n·(dx - dx₁) - s/L n·(dx₂ - dx₁),   dL = t·(dx₂ - dx₁),   dr = dx·e
    /// ```
    pub(super) fn each_coordinate(
        &self,
        piece: &CoveringPiece<N>,
        slopes: &[f64; N],
        each: &mut impl FnMut(usize, PlaneVector),
    ) {
        let (along, normal) = (self.along, turned_left(self.along));
        let combined = |a: f64, b: f64| [a * along[0] + b * normal[0], a * along[1] + b * normal[1]];
        let mut turning = 0.0;
        let (mut sum_s, mut sum_h) = (0.0, 0.0);
        for (end, node) in piece.nodes.into_iter().enumerate() {
            let ([s, h], [by_s, by_h]) =
                ([1, 2].map(|k| piece.values[k + 2 * end]), [1, 2].map(|k| slopes[k + 2 * end]));
            each(node, combined(by_s, by_h));
            turning += (by_s * h - by_h * s) / self.length;
            (sum_s, sum_h) = (sum_s + by_s, sum_h + by_h);
        }
        each(self.nodes[0], combined(-sum_s - slopes[0], -sum_h - turning));
        each(self.nodes[1], combined(slopes[0], turning));
        self.nodes.into_iter().zip(&slopes[IN_PLANE..]).for_each(|(node, by_radius)| each(node, [*by_radius, 0.0]));
    }
}

/// Local numbers of nodes, in the order in which they are met.
#[derive(Default)]
pub(super) struct MetNodes {
    pub(super) nodes: SmallVec<[usize; 12]>,
}

impl MetNodes {
    pub(super) fn place(&mut self, node: usize) -> usize {
        self.nodes.iter().position(|met| *met == node).unwrap_or_else(|| {
            self.nodes.push(node);
            self.nodes.len() - 1
        })
    }
}

/// The gradients of gap, place and stretch by the variables of the faces.
pub(super) fn nodal_gradients<const N: usize>(covered: &[CoveredFace<N>]) -> [WithGradient<VARIABLES>; 3] {
    let faces: SmallVec<[_; 2]> = (covered.iter().enumerate())
        .map(|(which, face)| {
            let values = face.moments();
            let variable = |k: usize| WithGradient::variable(values[k], which * OF_FACE + k);
            (face.at, std::array::from_fn(variable))
        })
        .collect();
    let MeanAtNode { gap, place, stretch } = nodal_values(&faces);
    [gap, place, stretch]
}
