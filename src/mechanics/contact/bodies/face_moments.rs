//! Integrals over the part of a face that an opposite surface covers.
//!
//! In the frame of the face, `s` along it and `h` towards its free side, the opposite surface is the graph `h(s)` of
//! straight pieces. All integrals are closed forms of the coordinates of the nodes, over every piece
//!
//! ```text
//! W_k = ∫ s^k ds  (k = 0, 1, 2),    F_k = ∫ h s^k ds,    S_k = ∫ S s^k ds  (k = 0, 1),    Λ = ∫ |dS/ds| ds
//! ```
//!
//! In bodies of revolution the weight of a point is its distance `r` from the axis, the first coordinate: `r ds` takes the place
//! of `ds` in all of them.
//!
//! They are twice differentiable in the coordinates as long as no node passes the end of the face, and once at that. An
//! end of the opposite surface would spoil this; the last face goes on straight beyond it.

use crate::algebra::differential::Differential;
use crate::mechanics::contact::bodies::tolerances::LEAST_COVERED;

/// Number of integrals of a face; the length of the face follows them among the variables of [`nodal_values`].
pub(super) const MOMENTS: usize = 8;

/// Number of values of a piece in the plane: the length of the face, then `s` and `h` of both nodes of the opposite face.
pub(super) const IN_PLANE: usize = 5;

/// Number of values of a piece in a body of revolution: the distances of the face's nodes from the axis follow.
pub(super) const REVOLVED: usize = IN_PLANE + 2;

/// The variables of a face: its moments and its length.
pub(super) const OF_FACE: usize = MOMENTS + 1;

/// The moments of one piece, of [`IN_PLANE`] or [`REVOLVED`] values. `piece`: the length of the face, then `s` and `h` of the
/// first node of the opposite face and `s` and `h` of its last one, in a body of revolution the radii of the face's nodes;
/// `along`: its coordinates along the opposite surface; `from`: the position on the face
/// from which `s` is counted in the moments; `goes_on`: whether the piece goes on straight beyond its first and its last
/// node.
pub(super) fn moments<D: Differential, const N: usize>(
    piece: &[D; N],
    along: [f64; 2],
    goes_on: [bool; 2],
    from: f64,
) -> [D; MOMENTS] {
    let (plane, radii) = piece.split_at(IN_PLANE);
    let [length, first, first_height, last, last_height] = std::array::from_fn(|k| plane[k]);
    // The opposite surface runs the other way: its last node is on the side of smaller s. Beyond a node that is next to the end
    // of the face the piece goes on to that end: what is left is too short to count as covered.
    let least = LEAST_COVERED * length.value();
    let low = if last.value() > least && !goes_on[1] { last } else { D::constant(0.0) };
    let high = if first.value() < length.value() - least && !goes_on[0] { first } else { length };
    let width = high - low;
    let middle = (high + low).times(0.5);
    let inverse = (first - last).reciprocal();
    let rise = (first_height - last_height) * inverse;
    let height = last_height + rise * (middle - last);
    let advance = inverse.times(along[0] - along[1]);
    let place = (advance * (middle - last)).plus(along[1]);
    let middle = middle.plus(-from);
    let spread = width * width.times(1.0 / 12.0);
    let undeformed = inverse.times(along[1] - along[0]);
    let square = middle * middle + spread;
    let [area, first, second] = [D::constant(1.0), middle, square].map(|mean| width * mean);
    // ∫ f ds and ∫ f s ds of a function that is linear on the piece, by its value at the middle and its slope.
    let of_line = |value: D, slope: D| [width * value, width * (value * middle + slope * spread)];
    let [[heights, heights_first], [places, places_first]] = [of_line(height, rise), of_line(place, advance)];
    let [radius_first, radius_last] = *radii else {
        return [area, first, second, heights, heights_first, places, places_first, area * undeformed];
    };
    // r = r₀ + k s
    let slope = (radius_last - radius_first) * length.reciprocal();
    let radius = radius_first + slope.times(from);
    let third = width * (middle * (middle * middle + spread.times(3.0)));
    let second_of_line = |value: D, slope: D| width * (value * square + (slope * middle * spread).times(2.0));
    let weighted = |one: D, next: D| radius * one + slope * next;
    let area_weighted = weighted(area, first);
    [
        area_weighted,
        weighted(first, second),
        weighted(second, third),
        weighted(heights, heights_first),
        weighted(heights_first, second_of_line(height, rise)),
        weighted(places, places_first),
        weighted(places_first, second_of_line(place, advance)),
        area_weighted * undeformed,
    ]
}

/// What the faces at a node give at the node.
pub(super) struct MeanAtNode<D> {
    pub gap: D,
    /// Position along the opposite surface.
    pub place: D,
    /// Ratio of the deformed to the undeformed length of the opposite surface.
    pub stretch: D,
}

/// A face at a node.
#[derive(Debug, Clone, Copy)]
pub(super) struct FaceAtNode {
    /// Whether the node is the last of the face, not the first.
    pub is_last: bool,
    /// The position from which `s` is counted in the moments.
    pub from: f64,
    /// Whether the node is the only one of the face with a multiplier.
    pub is_alone: bool,
}

/// The values at a node: means over its faces, weighted by dual functions, which are linear on each face and orthogonal to
/// the shape functions of its other nodes over the covered part (B. I. Wohlmuth, A mortar finite element method using dual
/// spaces for the Lagrange multiplier, SIAM J. Numer. Anal. 38, 2000). The mean of `h` is the value at the node of the line
/// that fits `h` best; the weight of a face is the integral of the node's shape function. On a face
/// on which it is alone with a multiplier the node has the mean.
pub(super) fn nodal_values<D: Differential>(faces: &[(FaceAtNode, [D; OF_FACE])]) -> MeanAtNode<D> {
    let mut sums = [D::constant(0.0); 5];
    for (at, [area, first, second, heights, heights_first, places, places_first, undeformed, length]) in faces {
        if at.is_alone {
            let parts = [*area, *heights, *places, *area, *undeformed];
            sums.iter_mut().zip(parts).for_each(|(sum, part)| *sum = *sum + part);
            continue;
        }
        let inverse = area.reciprocal();
        let centre = *first * inverse;
        let spread = *second * inverse - centre * centre;
        // The node's position and shape function, from where s is counted.
        let own = if at.is_last { *length } else { D::constant(0.0) }.plus(-at.from);
        let last_share = (area.times(at.from) + *first) * length.reciprocal();
        let weight = if at.is_last { last_share } else { *area - last_share };
        let lever = (own - centre) * spread.reciprocal();
        let fitted = |mean: D, first: D| {
            let mean = mean * inverse;
            mean + (first * inverse - centre * mean) * lever
        };
        let parts = [
            weight,
            weight * fitted(*heights, *heights_first),
            weight * fitted(*places, *places_first),
            *area,
            *undeformed,
        ];
        sums.iter_mut().zip(parts).for_each(|(sum, part)| *sum = *sum + part);
    }
    let [weight, gap, place, area, undeformed] = sums;
    let inverse = weight.reciprocal();
    MeanAtNode { gap: gap * inverse, place: place * inverse, stretch: area * undeformed.reciprocal() }
}
