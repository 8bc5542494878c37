//! A face at a node: the shape function `φ` of the node and its dual function `ψ`, and how the two share the weight of a point.
//!
//! ```text
//! ψ_j = Σ_k a_k φ_k,   ∫ ψ_j φ_k dA = δ_jk ∫ φ_j dA,      χ_j = φ_j + s (ψ_j - φ_j)
//! ```
//!
//! The integrals run over the undeformed face. The share `s` falls from 1 on a face that is covered as a whole to 0 on one that
//! is covered by half, with two continuous derivatives: the mean by `ψ` need not have a positive weight on a part of a face.
//! The functions `χ` of all nodes of a face sum to 1 at any share, so that an even pressure goes through it.

use crate::mechanics::contact::bodies::space::surface::{FaceInSpace, FaceTriangle, SurfacePoint};
use crate::mechanics::contact::vector::{Vector, add, cross, size};
use nalgebra::{DMatrix, DVector};
use smallvec::SmallVec;

/// Below this share of its area that is covered, a face has means by shape functions alone.
const LEAST_DUAL: f64 = 0.5;

/// A face at the node.
#[derive(Debug)]
pub(super) struct OwnFace {
    /// The node comes first; nodes are indices into those of the contact.
    pub face: FaceInSpace,
    /// Undeformed areas of the triangles of the face, twice.
    pub areas: SmallVec<[f64; 4]>,
    /// The shape function of the node and its dual function at the corners of the triangles.
    pub functions: SmallVec<[[[f64; 3]; 2]; 4]>,
    /// Whether one of its nodes is supported. By the dual function of such a node friction would have hardly any motion to
    /// act on; slips are weighted by shape functions there.
    pub is_held: bool,
}

/// How far a face is covered.
#[derive(Debug, Clone, Copy)]
pub(super) struct FaceCover {
    /// The share of the dual function in the function of the node.
    dual: f64,
    /// The first two derivatives of that by the covered area.
    pub slopes: [f64; 2],
}

impl OwnFace {
    pub(super) fn new(face: FaceInSpace, places: &[Vector], is_held: bool) -> Self {
        let corners: SmallVec<[Vector; 4]> = face.nodes.iter().map(|node| places[*node]).collect();
        let count = face.nodes.len();
        // The shape functions of all nodes at the corners of each triangle.
        let value = |point: &SurfacePoint, node: usize| {
            point.shares().find(|(other, _)| *other == face.nodes[node]).map_or(0.0, |(_, share)| share)
        };
        let of_triangle = |triangle: FaceTriangle| {
            let [a, b, c] = triangle.points.map(|point| point.place);
            let area = size(&cross(&add(&b, -1.0, &a), &add(&c, -1.0, &a)));
            (area, DMatrix::from_fn(count, 3, |node, corner| value(&triangle.points[corner], node)))
        };
        let (areas, values): (SmallVec<[f64; 4]>, SmallVec<[DMatrix<f64>; 4]>) =
            face.triangles(&corners, 0).into_iter().map(of_triangle).unzip();
        let of_corners = DMatrix::from_fn(3, 3, |k, l| if k == l { 1.0 / 12.0 } else { 1.0 / 24.0 });
        let (mut mass, mut sums) = (DMatrix::zeros(count, count), DVector::zeros(count));
        for (values, area) in values.iter().zip(&areas) {
            mass += values * &of_corners * values.transpose() * *area;
            sums += values.column_sum() * (*area / 6.0);
        }
        // The dual function has the integral of the shape function with itself, and none with those of the other nodes.
        let first = DVector::from_fn(count, |node, _| if node == 0 { sums[0] } else { 0.0 });
        let shares = mass.cholesky().map(|factor| factor.solve(&first)).unwrap_or(first);
        let functions = values.iter().map(|values| {
            let dual = values.transpose() * &shares;
            [std::array::from_fn(|corner| values[(0, corner)]), std::array::from_fn(|corner| dual[corner])]
        });
        let functions = functions.collect();
        Self { face, areas, functions, is_held }
    }

    /// The cover of the face by its covered area: where a part is not covered, the dual function gives way to the shape
    /// function, whose mean has positive weights on any part.
    pub(super) fn cover(&self, area: f64) -> FaceCover {
        let whole = 0.5 * self.areas.iter().sum::<f64>();
        let x = ((area / whole - LEAST_DUAL) / (1.0 - LEAST_DUAL)).clamp(0.0, 1.0);
        let by_area = 1.0 / (whole * (1.0 - LEAST_DUAL));
        let rest = 1.0 - x;
        FaceCover {
            dual: x * x * x * (10.0 - x * (15.0 - 6.0 * x)),
            slopes: [30.0 * x * x * rest * rest * by_area, 60.0 * x * rest * (1.0 - 2.0 * x) * by_area * by_area],
        }
    }
}

impl FaceCover {
    /// The function of the node at the corners of a triangle.
    pub(super) fn blended(&self, [shape, dual]: &[[f64; 3]; 2]) -> [f64; 3] {
        std::array::from_fn(|corner| shape[corner] + self.dual * (dual[corner] - shape[corner]))
    }
}
