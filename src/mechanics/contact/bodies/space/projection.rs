//! A point in the frame of a triangle: `b = a_0 + ξ_1 e_1 + ξ_2 e_2 + h n` with the edges `e_k = a_k - a_0` and the unit
//! normal `n` of the triangle.

use crate::mechanics::contact::vector::{Vector, add, cross, dot, scaled, size};

/// Coordinates of a point in the frame of a triangle: two as parts of its edges, and the distance along the normal.
#[derive(Debug, Clone, Copy)]
pub(super) struct Projected {
    pub xi: [f64; 2],
    pub height: f64,
}

/// The frame of a triangle.
#[derive(Debug, Clone, Copy)]
pub(super) struct TriangleFrame {
    origin: Vector,
    /// The vectors `e^k` in the plane with `e^k·e_l = δ_kl`.
    dual: [Vector; 2],
    normal: Vector,
    /// Twice the area.
    area: f64,
}

/// A point, its displacement apart from its undeformed place.
#[derive(Debug, Clone, Copy)]
pub(super) struct MovedPoint {
    pub place: Vector,
    pub moved: Vector,
}

/// Weights of the coordinates of a projected point in a function of them: by the two coordinates in the plane, by the
/// height.
pub(super) type CoordinateWeights = [f64; 3];

impl TriangleFrame {
    /// The frame; `None` for a triangle without area.
    pub fn new(corners: &[Vector; 3]) -> Option<Self> {
        let edges = [1, 2].map(|k| add(&corners[k], -1.0, &corners[0]));
        let vector = cross(&edges[0], &edges[1]);
        let area = size(&vector);
        if area <= 0.0 || !area.is_finite() {
            return None;
        }
        let normal = scaled(&vector, 1.0 / area);
        let dual = [cross(&edges[1], &normal), cross(&normal, &edges[0])].map(|vector| scaled(&vector, 1.0 / area));
        Some(Self { origin: corners[0], dual, normal, area })
    }

    pub fn project(&self, point: &Vector) -> Projected {
        let from = add(point, -1.0, &self.origin);
        Projected { xi: self.dual.map(|dual| dot(&dual, &from)), height: dot(&self.normal, &from) }
    }

    /// The height of a point over the triangle, with corners and point given by their displacements apart from their undeformed
    /// places:
    ///
    /// ```text
    /// h |E_1 × E_2| = det(E_1, E_2, Q) = det(E⁰_1, E⁰_2, Q⁰) + det(e_1, E⁰_2, Q⁰) + det(E_1, e_2, Q⁰) + det(E_1, E_2, q)
    /// ```
    ///
    /// The first term is the same in every state; the others have the rounding of displacements, where the whole has that of
    /// coordinates.
    pub fn height(&self, corners: &[MovedPoint; 3], point: &MovedPoint) -> f64 {
        let from = |one: &MovedPoint| {
            let [place, moved] = [(one.place, corners[0].place), (one.moved, corners[0].moved)]
                .map(|(one, first)| add(&one, -1.0, &first));
            MovedPoint { place, moved }
        };
        let [first, second, way] = [from(&corners[1]), from(&corners[2]), from(point)];
        let edge = add(&first.place, 1.0, &first.moved);
        let at_rest = cross(&first.place, &second.place);
        let turned = add(&cross(&first.moved, &second.place), 1.0, &cross(&edge, &second.moved));
        (dot(&at_rest, &way.place) + dot(&turned, &way.place)) / self.area + dot(&self.normal, &way.moved)
    }

    /// The gradient of a weighted sum of a point's coordinates by the corners of the triangle and by the point:
    ///
    /// ```text
    /// ds = p·(db - Σ_k λ_k da_k) + h Σ_k (w·e^k) n·de_k,     p = w + w_h n,     w = Σ_k w_k e^k
    /// ```
    pub fn gradient(&self, point: &Projected, weights: &CoordinateWeights) -> [Vector; 4] {
        let [first, second, by_height] = *weights;
        let plane = add(&scaled(&self.dual[0], first), second, &self.dual[1]);
        let all = add(&plane, by_height, &self.normal);
        let shares = [1.0 - point.xi[0] - point.xi[1], point.xi[0], point.xi[1]];
        let turns = self.dual.map(|dual| point.height * dot(&plane, &dual));
        let corner = |k: usize| {
            let turn = if k == 0 { -turns[0] - turns[1] } else { turns[k - 1] };
            add(&scaled(&all, -shares[k]), turn, &self.normal)
        };
        [corner(0), corner(1), corner(2), all]
    }

    /// The second derivatives of a weighted sum of a point's coordinates, by the vectors `d` from the first corner to the point
    /// and `e_1`, `e_2` to the other corners.
    ///
    /// With `q = δd - Σ_l ξ_l δe_l`, `p = Σ_k w_k e^k` and `g^kl = e^k·e^l` the first variations are `δξ_k = e^k·q + h Σ_l g^kl
    /// n·δe_l` and `δh = n·q`; varied once more, with `S(u, v) = u vᵀ + v uᵀ` of linear functions of the variations,
    ///
    /// ```text
    /// Σ_l S(p·δe_l, -δξ_l) + S(n·δe_l, (p·e^l) n·q - h Σ_m (p·e^m) e^l·δe_m - w_h e^l·q - w_h h/2 Σ_m g^lm n·δe_m)
    /// ```
    pub fn second_derivatives(&self, point: &Projected, weights: &CoordinateWeights) -> [[f64; 9]; 9] {
        let [first, second, by_height] = *weights;
        let plane = add(&scaled(&self.dual[0], first), second, &self.dual[1]);
        let along_dual = self.dual.map(|dual| dot(&plane, &dual));
        let mut values = [[0.0; 9]; 9];
        for (l, dual) in self.dual.iter().enumerate() {
            let (mut change, mut turn) = ([0.0; 9], [0.0; 9]);
            for k in 0..3 {
                change[k] = -dual[k];
                turn[k] = along_dual[l] * self.normal[k] - by_height * dual[k];
                for m in 0..2 {
                    let raised = point.height * dot(dual, &self.dual[m]) * self.normal[k];
                    change[3 + 3 * m + k] = point.xi[m] * dual[k] - raised;
                    turn[3 + 3 * m + k] =
                        -point.xi[m] * turn[k] - point.height * along_dual[m] * dual[k] - 0.5 * by_height * raised;
                }
            }
            for (vector, other) in [(&plane, &change), (&self.normal, &turn)] {
                for (k, part) in vector.iter().enumerate() {
                    let at = 3 + 3 * l + k;
                    for (column, value) in other.iter().enumerate() {
                        values[at][column] += part * value;
                        values[column][at] += part * value;
                    }
                }
            }
        }
        values
    }
}
