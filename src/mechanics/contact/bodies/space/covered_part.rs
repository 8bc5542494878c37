//! What the opposite surface covers of the faces at a node, triangle by triangle, and the means over it:
//!
//! ```text
//! A = Σ ∫ χ dA,      g = Σ ∫ χ h dA / A,      ∂/∂x ∫ χ (h - g) dA = Σ_l (∂/∂ξ_l, ∂/∂h_l) ∫ χ (h - g) dA · ∂(ξ_l, h_l)/∂x
//! ```
//!
//! with the coordinates `(ξ_l, h_l)` of the opposite corners in the frame of the own triangle.

use crate::mechanics::contact::bodies::space::overlap::Overlap;
use crate::mechanics::contact::bodies::space::own_face::FaceCover;
use crate::mechanics::contact::bodies::space::projection::{Projected, TriangleFrame};
use crate::mechanics::contact::bodies::space::surface::FaceTriangle;
use crate::mechanics::contact::vector::{Vector, add, dot, scaled};
use smallvec::SmallVec;

/// The parts of the node's faces that the opposite surface covers.
pub(super) struct Covered<'a> {
    pub parts: Vec<CoveredPart<'a>>,
    /// By the faces at the node.
    pub faces: SmallVec<[FaceCover; 8]>,
    /// The share of the faces that is covered, as the shape function of the node counts it.
    pub share: f64,
}

/// A triangle of a face at the node and a triangle of the opposite surface that covers a part of it.
#[derive(Clone, Copy)]
pub(super) struct CoveredPart<'a> {
    pub own: FaceTriangle<'a>,
    pub frame: TriangleFrame,
    pub opposite: FaceTriangle<'a>,
    pub projected: [Projected; 3],
    /// Weighted by the function of the node for gaps, and by that for slips.
    pub overlap: Overlap,
    pub slip: Overlap,
    /// Undeformed area of the own triangle, twice.
    pub scale: f64,
    /// The face of the own triangle, as a place among those at the node.
    pub face: usize,
    /// The shape function of the node and its dual function at the own corners.
    pub functions: [[f64; 3]; 2],
    /// Whether slips are weighted by the shape function.
    pub slips_by_shape: bool,
}

/// Means at the node: of the gap, and of the place that the node is in front of; with the areas `∫ φ dA` of both.
pub(super) struct NodalMeans {
    pub area: f64,
    pub gap: f64,
    pub slip_area: f64,
    pub place: Vector,
}

impl<'a> Covered<'a> {
    pub(super) fn of_face(&self, face: usize) -> impl Iterator<Item = &CoveredPart<'a>> {
        self.parts.iter().filter(move |part| part.face == face)
    }

    /// The change of `∫ φ (h - gap) dA` with the share of the dual function of a face.
    pub(super) fn by_dual(&self, face: usize, gap: f64) -> f64 {
        self.of_face(face).map(|part| part.change_to_dual().integral(&part.heights_from(gap))).sum()
    }
}

impl NodalMeans {
    /// The means over covered parts; `None` where there is none.
    pub(super) fn new(parts: &[CoveredPart<'_>]) -> Option<Self> {
        let (mut area, mut gap, mut slip_area, mut place) = (0.0, 0.0, 0.0, [0.0; 3]);
        for part in parts {
            for l in 0..3 {
                let weight = part.scale * part.overlap.moments[l];
                area += weight;
                gap += weight * part.projected[l].height;
                let weight = part.scale * part.slip.moments[l];
                slip_area += weight;
                place = add(&place, weight, &part.opposite.points[l].place);
            }
        }
        (area > 0.0 && slip_area > 0.0).then(|| Self {
            area,
            gap: gap / area,
            slip_area,
            place: scaled(&place, 1.0 / slip_area),
        })
    }
}

impl CoveredPart<'_> {
    /// `∫ φ dA`
    pub(super) fn area(&self) -> f64 {
        self.integral(&[1.0; 3])
    }

    /// `∫ φ f dA` of a function with `values` at the opposite corners.
    pub(super) fn integral(&self, values: &[f64; 3]) -> f64 {
        self.scale * values.iter().zip(self.overlap.moments).map(|(value, moment)| value * moment).sum::<f64>()
    }

    pub(super) fn heights_from(&self, gap: f64) -> [f64; 3] {
        self.projected.map(|point| point.height - gap)
    }

    /// The same part with the function 1.
    pub(super) fn plain(&self) -> Self {
        Self { overlap: self.overlap.weighted([1.0; 3]), ..*self }
    }

    /// The same part with the dual function less the shape function.
    pub(super) fn change_to_dual(&self) -> Self {
        let [shape, dual] = &self.functions;
        let weights = std::array::from_fn(|corner| dual[corner] - shape[corner]);
        let slip = self.slip.weighted(if self.slips_by_shape { [0.0; 3] } else { weights });
        Self { overlap: self.overlap.weighted(weights), slip, ..*self }
    }

    /// The gradient of `∫ φ (h - mean) dA` by the corners of the own triangle and those of the opposite one; `heights` are
    /// those of the opposite corners, less their mean.
    pub(super) fn gradient(&self, heights: &[f64; 3]) -> [Vector; 6] {
        self.spread(&self.weights_of_gap(heights))
    }

    /// The rates of `∫ φ (t·y) dA` at fixed points of the own triangle for both tangents.
    pub(super) fn along(&self, means: &NodalMeans, tangents: &[Vector; 2]) -> [[Vector; 6]; 2] {
        let places = self.opposite.points.map(|point| add(&point.place, -1.0, &means.place));
        tangents.map(|tangent| self.at_points(&places.map(|place| dot(&tangent, &place))))
    }

    /// The rate of `∫ φ f dA` at fixed points of the own triangle, of a function with `values` at the opposite corners.
    pub(super) fn at_points(&self, values: &[f64; 3]) -> [Vector; 6] {
        self.spread(&self.weights_at_points(values))
    }

    /// The slopes by the coordinates of the opposite corners.
    pub(super) fn weights_of_gap(&self, heights: &[f64; 3]) -> [[f64; 3]; 3] {
        let in_plane = self.overlap.gradient(heights, &self.opposite.ends);
        self.scaled_weights(in_plane, 1.0)
    }

    pub(super) fn weights_at_points(&self, values: &[f64; 3]) -> [[f64; 3]; 3] {
        self.scaled_weights(self.slip.gradient_at_points(values), 0.0)
    }

    /// The gradient of `∫ φ dA`, which changes where the surface ends.
    pub(super) fn gradient_of_area(&self) -> [Vector; 6] {
        self.spread(&self.scaled_weights(self.overlap.gradient(&[1.0; 3], &self.opposite.ends), 0.0))
    }

    /// The gradient of the area of slips.
    pub(super) fn gradient_of_slip_area(&self) -> [Vector; 6] {
        self.spread(&self.scaled_weights(self.slip.gradient(&[1.0; 3], &self.opposite.ends), 0.0))
    }

    /// The area of slips.
    pub(super) fn slip_area(&self) -> f64 {
        self.scale * self.slip.moments.iter().sum::<f64>()
    }

    fn scaled_weights(&self, in_plane: [[f64; 2]; 3], by_height: f64) -> [[f64; 3]; 3] {
        std::array::from_fn(|l| {
            let [x, y] = in_plane[l];
            [self.scale * x, self.scale * y, self.scale * by_height * self.overlap.moments[l]]
        })
    }

    /// A gradient by the coordinates of the opposite corners as one by the places of all corners.
    fn spread(&self, weights: &[[f64; 3]; 3]) -> [Vector; 6] {
        let mut gradient = [[0.0; 3]; 6];
        for (l, weights) in weights.iter().enumerate() {
            let [a, b, c, own] = self.frame.gradient(&self.projected[l], weights);
            for (sum, part) in gradient.iter_mut().zip([a, b, c]) {
                *sum = add(sum, 1.0, &part);
            }
            gradient[3 + l] = own;
        }
        gradient
    }

    /// Calls `each` with the nodes of the six corners and a gradient by the places of these.
    pub(super) fn each_node(&self, gradient: &[Vector; 6], each: &mut impl FnMut(usize, Vector)) {
        for (point, vector) in self.own.points.iter().chain(&self.opposite.points).zip(gradient) {
            point.shares().for_each(|(node, share)| each(node, scaled(vector, share)));
        }
    }
}
