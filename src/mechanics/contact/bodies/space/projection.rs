//! A point in the frame of a triangle: `b = a_0 + ξ_1 e_1 + ξ_2 e_2 + h n` with the edges `e_k = a_k - a_0` and the unit
//! normal `n` of the triangle.

use crate::algebra::differential::{self, Differential, WithHessian};
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
    edges: [Vector; 2],
    /// The vectors `e^k` in the plane with `e^k·e_l = δ_kl`.
    dual: [Vector; 2],
    normal: Vector,
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
        Some(Self { origin: corners[0], edges, dual, normal })
    }

    pub fn project(&self, point: &Vector) -> Projected {
        let from = add(point, -1.0, &self.origin);
        Projected { xi: self.dual.map(|dual| dot(&dual, &from)), height: dot(&self.normal, &from) }
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

    /// The second derivatives of a weighted sum of a point's coordinates, by the vectors from the first corner to the point
    /// and to the other corners.
    pub fn second_derivatives(&self, point: &Projected, weights: &CoordinateWeights) -> [[f64; 9]; 9] {
        let in_plane = add(&scaled(&self.edges[0], point.xi[0]), point.xi[1], &self.edges[1]);
        let values = [add(&in_plane, point.height, &self.normal), self.edges[0], self.edges[1]];
        let [from, first, second]: [[WithHessian<9>; 3]; 3] = std::array::from_fn(|which| {
            std::array::from_fn(|k| WithHessian::variable(values[which][k], 3 * which + k))
        });
        let vector = differential::cross(&first, &second);
        let square = differential::dot(&vector, &vector);
        let length = square.root();
        // ξ_1 = (d × e_2)·N/|N|², ξ_2 = (e_1 × d)·N/|N|², h = d·N/|N|
        let one = differential::cross(&from, &second);
        let other = differential::cross(&first, &from);
        let weighted: [WithHessian<9>; 3] =
            std::array::from_fn(|k| one[k].times(weights[0]) + other[k].times(weights[1]));
        let along = differential::dot(&weighted, &vector) * square.reciprocal();
        let across = differential::dot(&from, &vector) * length.reciprocal();
        (along + across.times(weights[2])).hessian
    }
}
