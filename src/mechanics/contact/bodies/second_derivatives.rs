//! Second derivatives of mortar contacts, from those of the values at the node by the moments, of the moments by the coordinates in the
//! frames of the faces, and of these by the positions of the nodes.

use crate::algebra::differential::{Differential, WithHessian};
use crate::mechanics::contact::bodies::covered_face::{
    CoveredFace, CoveringPiece, MetNodes, VARIABLES, each_gradient, each_variable, nodal_gradients,
};
use crate::mechanics::contact::bodies::face_moments::{MOMENTS, MeanAtNode, OF_FACE, moments, nodal_values};
use crate::mechanics::contact::bodies::turned_left;
use itertools::Itertools;
use smallvec::SmallVec;

/// A square matrix over the degrees of freedom that were met.
struct LocalMatrix {
    met: MetNodes,
    size: usize,
    values: Vec<f64>,
}

impl LocalMatrix {
    fn add(&mut self, row: usize, column: usize, value: f64) {
        self.values[row * self.size + column] += value;
    }
}

pub(super) fn each<const N: usize>(
    covered: &[CoveredFace<N>],
    [along, normal]: [f64; 2],
    add: &mut dyn FnMut(usize, usize, f64),
) {
    if covered.is_empty() {
        return;
    }
    let faces: SmallVec<[_; 2]> = (covered.iter().enumerate())
        .map(|(which, face)| {
            let values = face.moments();
            let variable = |k: usize| WithHessian::<VARIABLES>::variable(values[k], which * OF_FACE + k);
            (face.at, std::array::from_fn(variable))
        })
        .collect();
    let MeanAtNode { gap, place, stretch } = nodal_values(&faces);
    let whole = gap.times(normal) + place.times(along * stretch.value);
    let mut met = MetNodes::default();
    for face in covered {
        let pieces = face.pieces.iter().flat_map(|piece| piece.nodes);
        for node in face.nodes.into_iter().chain(pieces) {
            met.place(node);
        }
    }
    let size = 2 * met.nodes.len();
    let mut local = LocalMatrix { met, size, values: vec![0.0; size * size] };
    by_variables(covered, &whole, &mut local);
    for (face, weights) in covered.iter().zip(whole.gradient.chunks_exact(OF_FACE)) {
        of_length(face, weights[MOMENTS], &mut local);
        face.pieces.iter().for_each(|piece| of_piece(face, piece, weights, &mut local));
    }
    let [_, place, stretch] = nodal_gradients(covered);
    let [place, stretch] = [&place.gradient, &stretch.gradient].map(|weights| {
        let mut row = vec![0.0; size];
        each_gradient(covered, weights, |node, gradient| {
            let at = 2 * local.met.place(node);
            (0..2).for_each(|k| row[at + k] += gradient[k]);
        });
        row
    });
    for (row, by_place) in place.iter().enumerate() {
        for (column, by_stretch) in stretch.iter().enumerate() {
            local.add(row, column, along * by_place * by_stretch);
        }
    }
    let freedom = |at: usize| 2 * local.met.nodes[at / 2] + at % 2;
    for (row, values) in local.values.chunks_exact(size).enumerate() {
        values.iter().enumerate().for_each(|(column, value)| add(freedom(row), freedom(column), *value));
    }
}

/// `Jᵀ H J` with the Jacobian `J` of the variables of the faces.
fn by_variables<const N: usize>(covered: &[CoveredFace<N>], whole: &WithHessian<VARIABLES>, local: &mut LocalMatrix) {
    let size = local.size;
    let count = covered.len() * OF_FACE;
    let mut jacobian = vec![0.0; count * size];
    each_variable(covered, |variable, node, gradient| {
        let at = variable * size + 2 * local.met.place(node);
        (0..2).for_each(|k| jacobian[at + k] += gradient[k]);
    });
    let mut combined = vec![0.0; size];
    for first in 0..count {
        combined.fill(0.0);
        for (second, row) in jacobian.chunks_exact(size).enumerate() {
            let factor = whole.hessian[first][second];
            if factor != 0.0 {
                combined.iter_mut().zip(row).for_each(|(sum, part)| *sum += factor * part);
            }
        }
        let left = &jacobian[first * size..(first + 1) * size];
        for (row, factor) in left.iter().enumerate().filter(|(_, factor)| **factor != 0.0) {
            combined.iter().enumerate().for_each(|(column, value)| local.add(row, column, factor * value));
        }
    }
}

/// The second derivative of the length of a face.
fn of_length<const N: usize>(face: &CoveredFace<N>, weight: f64, local: &mut LocalMatrix) {
    let normal = turned_left(face.along);
    let places = face.nodes.map(|node| 2 * local.met.place(node));
    for (i, row) in places.into_iter().enumerate() {
        for (j, column) in places.into_iter().enumerate() {
            let sign = if i == j { weight } else { -weight };
            for k in 0..2 {
                (0..2).for_each(|l| local.add(row + k, column + l, sign * normal[k] * normal[l] / face.length));
            }
        }
    }
}

/// The second derivatives of the moments of a piece by the positions of its nodes and the face's.
fn of_piece<const N: usize>(face: &CoveredFace<N>, piece: &CoveringPiece<N>, weights: &[f64], local: &mut LocalMatrix) {
    let variables: [_; N] = std::array::from_fn(|k| WithHessian::<N>::variable(piece.values[k], k));
    let moments = moments(&variables, piece.along, piece.goes_on, face.at.from);
    let mut sum = WithHessian::<N>::constant(0.0);
    for (moment, weight) in moments.iter().zip(weights) {
        sum = sum + moment.times(*weight);
    }
    // Second derivatives by the coordinates in the frame, in terms of the gradients of these.
    let mut rows = [const { SmallVec::<[(usize, [f64; 2]); 4]>::new_const() }; N];
    for (which, row) in rows.iter_mut().enumerate() {
        let mut slopes = [0.0; N];
        slopes[which] = 1.0;
        face.each_coordinate(piece, &slopes, &mut |node, gradient| row.push((2 * local.met.place(node), gradient)));
    }
    for (first, values) in rows.iter().zip(&sum.hessian) {
        for (second, factor) in rows.iter().zip(values) {
            for ((row, left), (column, right)) in first.iter().cartesian_product(second) {
                for ((k, left), (l, right)) in left.iter().enumerate().cartesian_product(right.iter().enumerate()) {
                    local.add(row + k, column + l, factor * left * right);
                }
            }
        }
    }
    of_length(face, sum.gradient[0], local);
    for (end, node) in piece.nodes.into_iter().enumerate() {
        let [by_s, by_h] = [1, 2].map(|k| sum.gradient[k + 2 * end]);
        of_coordinates(face, [piece.values[1 + 2 * end], piece.values[2 + 2 * end]], node, [by_s, by_h], local);
    }
}

/// The second derivatives of `s = q·d/L` and `h = d × q/L` of a node, with `d` along the face and `q` from its first
/// node, times the slopes by these.
fn of_coordinates<const N: usize>(
    face: &CoveredFace<N>,
    [s, h]: [f64; 2],
    node: usize,
    [by_s, by_h]: [f64; 2],
    local: &mut LocalMatrix,
) {
    let normal = turned_left(face.along);
    let vector = face.along.map(|part| part * face.length);
    let from_first = [0, 1].map(|k| s * face.along[k] + h * normal[k]);
    let [d, q] = [0, 2].map(|first| {
        let values = if first == 0 { vector } else { from_first };
        [0, 1].map(|k| WithHessian::<4>::variable(values[k], first + k))
    });
    let inverse = (d[0] * d[0] + d[1] * d[1]).root().reciprocal();
    let along = (d[0] * q[0] + d[1] * q[1]) * inverse;
    let across = (d[0] * q[1] - d[1] * q[0]) * inverse;
    let whole = along.times(by_s) + across.times(by_h);
    // d = x₂ - x₁ and q = x - x₁.
    let [first, last, own] = [face.nodes[0], face.nodes[1], node].map(|node| 2 * local.met.place(node));
    let ends = [[(last, 1.0), (first, -1.0)], [(own, 1.0), (first, -1.0)]];
    for row in 0..4 {
        for column in 0..4 {
            for (at, sign) in ends[row / 2] {
                for (other, other_sign) in ends[column / 2] {
                    let value = sign * other_sign * whole.hessian[row][column];
                    local.add(at + row % 2, other + column % 2, value);
                }
            }
        }
    }
}
