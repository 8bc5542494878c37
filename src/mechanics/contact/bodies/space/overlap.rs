//! Integrals over the part of a triangle that another one covers, in the coordinates `ξ` of the first, and their
//! derivatives by the corners `ξ_l` of the other.
//!
//! ```text
//! Q_l = ∫_P φ β_l dξ,      ∂/∂ξ_m ∫_P φ f dξ = -Q_m ∇f + ∮ φ f β_m n ds,      f = Σ_l β_l f_l
//! ```
//!
//! with any function `φ` that is linear over the first triangle. The boundary integral runs over the edges of the other triangle. Where a function is continuous from one triangle of a
//! surface to the next, the integrals over their common edge cancel: they are left out but for edges at which the surface
//! ends. So edges that coincide, as in meshes that match, need no care.

use crate::algebra::differential::{Differential, WithGradient};
use crate::mechanics::contact::bodies::PlaneVector;
use smallvec::SmallVec;

/// The part of a triangle that another one covers.
#[derive(Debug, Clone, Copy)]
pub(super) struct Overlap {
    /// `Q_l`, over the unit triangle.
    pub moments: [f64; 3],
    /// `∫_P λ_k β_l dξ` with the shape functions `λ_k` of the first triangle.
    products: [[f64; 3]; 3],
    /// `∇β_l`
    pub slopes: [PlaneVector; 3],
    /// The corners of the other triangle.
    corners: [PlaneVector; 3],
    /// `φ` at the corners of the first.
    weights: [f64; 3],
}

/// A point by its shares in the corners of both triangles.
#[derive(Debug, Clone, Copy)]
struct Vertex {
    own: [f64; 3],
    other: [f64; 3],
}

/// Parameters of the two points of Gauss's rule on (0, 1), exact for cubic polynomials.
const GAUSS: [f64; 2] = [0.211_324_865_405_187_13, 0.788_675_134_594_812_9];

/// Edges that run along the limit of a triangle to within this part of it end nowhere in particular.
const ALONG: f64 = 1e-9;

/// Within this part of a triangle beside its limit, second derivatives pass from those of the triangle to those of the next
/// one. Where edges of two meshes run along each other, as by symmetry, they jump, and iterations for a point at the jump would
/// go to and fro between two tangents. The width is above the corrections in such iterations, slips of a thousandth of a face in
/// directions that are off by 1e-5, and so small that few points are within it by chance.
const PASSAGE: f64 = 1e-6;

impl Overlap {
    /// What the triangle with corners `corners` covers of the unit triangle; `None` where that is nothing, or where the
    /// corners run counter-clockwise: such a triangle looks the same way. `φ` is 1.
    pub fn new(corners: [PlaneVector; 3]) -> Option<Self> {
        let [a, b, c] = corners;
        let third = |point: PlaneVector| 1.0 - point[0] - point[1];
        let is_beside = |share: &dyn Fn(PlaneVector) -> f64| corners.iter().all(|corner| share(*corner) <= 0.0);
        if is_beside(&|point| point[0]) || is_beside(&|point| point[1]) || is_beside(&third) {
            return None;
        }
        let area = (b[0] - a[0]) * (c[1] - a[1]) - (b[1] - a[1]) * (c[0] - a[0]);
        if area >= 0.0 || !area.is_finite() {
            return None;
        }
        let polygon = clipped(&corners)?;
        let mut products = [[0.0; 3]; 3];
        for k in 1..polygon.len() - 1 {
            let triangle = [&polygon[0], &polygon[k], &polygon[k + 1]];
            let [p, q, r] = triangle.map(|vertex| [vertex.own[1], vertex.own[2]]);
            let doubled = ((q[0] - p[0]) * (r[1] - p[1]) - (q[1] - p[1]) * (r[0] - p[0])).abs();
            for (own, row) in products.iter_mut().enumerate() {
                // The integral of a product of linear functions: A/12 (Σ f Σ g + Σ f g).
                let values = triangle.map(|vertex| vertex.own[own]);
                let sum: f64 = values.iter().sum();
                for (other, product) in row.iter_mut().enumerate() {
                    let shares = triangle.map(|vertex| vertex.other[other]);
                    let both: f64 = values.iter().zip(shares).map(|(value, share)| value * share).sum();
                    *product += doubled / 24.0 * (sum * shares.iter().sum::<f64>() + both);
                }
            }
        }
        let slope = |one: PlaneVector, two: PlaneVector| [(one[1] - two[1]) / area, (two[0] - one[0]) / area];
        let slopes = [slope(b, c), slope(c, a), slope(a, b)];
        let plain = Self { moments: [0.0; 3], products, slopes, corners, weights: [0.0; 3] };
        Some(plain.weighted([1.0; 3]))
    }

    /// The same part with another function `φ`, by its values at the corners of the first triangle.
    pub fn weighted(mut self, weights: [f64; 3]) -> Self {
        let moment = |l: usize| (0..3).map(|k| weights[k] * self.products[k][l]).sum();
        self.moments = [moment(0), moment(1), moment(2)];
        self.weights = weights;
        self
    }

    /// `∇f` of a function by its values at the corners.
    pub fn slope(&self, values: &[f64; 3]) -> PlaneVector {
        [0, 1].map(|k| (0..3).map(|l| values[l] * self.slopes[l][k]).sum())
    }

    /// `∂/∂ξ_m ∫ φ f dξ`; `ends` says at which edges, each from a corner to the next, the surface ends.
    pub fn gradient(&self, values: &[f64; 3], ends: &[bool; 3]) -> [PlaneVector; 3] {
        let mut gradient = self.gradient_at_points(values);
        for edge in (0..3).filter(|edge| ends[*edge]) {
            let [first, last] = [edge, (edge + 1) % 3];
            let along = self.end_integral(first, last, values, |_, point| point);
            for (corner, value) in [first, last].into_iter().zip(along) {
                (0..2).for_each(|k| gradient[corner][k] += value[k]);
            }
        }
        gradient
    }

    /// `-Q_m ∇f`: the gradient of the mean at fixed points, whatever the edges do.
    pub fn gradient_at_points(&self, values: &[f64; 3]) -> [PlaneVector; 3] {
        let slope = self.slope(values);
        self.moments.map(|moment| slope.map(|part| -moment * part))
    }

    /// The derivatives of [`Self::gradient`], or of [`Self::gradient_at_points`], by the corners, component by component.
    pub fn second_derivatives(&self, values: &[f64; 3], ends: &[bool; 3], at_points: bool) -> [[f64; 6]; 6] {
        let slope = self.slope(values);
        let mut matrix = [[0.0; 6]; 6];
        for (row, entries) in matrix.iter_mut().enumerate() {
            for (column, entry) in entries.iter_mut().enumerate() {
                let ([m, a], [n, b]) = ([row / 2, row % 2], [column / 2, column % 2]);
                *entry =
                    self.moments[n] * self.slopes[m][b] * slope[a] + self.moments[m] * self.slopes[n][a] * slope[b];
            }
        }
        for (edge, is_end) in ends.iter().enumerate() {
            let Some((pair, along, products)) = self.edge(edge, (!*is_end).then_some(PASSAGE)) else {
                continue;
            };
            for (i, m) in pair.into_iter().enumerate() {
                for (j, n) in pair.into_iter().enumerate() {
                    for a in 0..2 {
                        for b in 0..2 {
                            // Symmetric in the sum over the triangles beside the edge.
                            let jump = 0.5 * (along[b] * slope[a] + along[a] * slope[b]);
                            let whole = if *is_end { along[b] * slope[a] } else { jump };
                            matrix[2 * m + a][2 * n + b] -= products[i][j] * whole;
                        }
                    }
                }
            }
            if *is_end && !at_points {
                self.at_end(pair, values, &mut matrix);
            }
        }
        matrix
    }

    /// `∮ φ β_l β_m n ds` over the edges at which the surface ends, the change of `Q_l` that a gradient of heights needs.
    pub fn changes_at_ends(&self, ends: &[bool; 3]) -> [[PlaneVector; 3]; 3] {
        let mut changes = [[[0.0; 2]; 3]; 3];
        for edge in (0..3).filter(|edge| ends[*edge]) {
            let Some((pair, along, products)) = self.edge(edge, None) else { continue };
            for (i, l) in pair.into_iter().enumerate() {
                for (j, m) in pair.into_iter().enumerate() {
                    (0..2).for_each(|k| changes[l][m][k] += products[i][j] * along[k]);
                }
            }
        }
        changes
    }

    /// The corners of an edge, the edge turned outwards (as long as the edge; the corners run clockwise) and `∫ φ β_i β_j dt`
    /// over its part inside the first triangle, with the width of a passage to the next triangle, if there is one; `None` where
    /// it has none.
    fn edge(&self, edge: usize, passage: Option<f64>) -> Option<([usize; 2], PlaneVector, [[f64; 2]; 2])> {
        let pair = [edge, (edge + 1) % 3];
        let (from, to, share) = self.inside(pair[0], pair[1], passage)?;
        let [one, other] = pair.map(|corner| self.corners[corner]);
        let products = edge_products(from, to, |t| share * self.weight_at(pair, t));
        Some((pair, [one[1] - other[1], other[0] - one[0]], products))
    }

    /// The derivatives of the integrals over an edge at which the surface ends.
    fn at_end(&self, pair: [usize; 2], values: &[f64; 3], matrix: &mut [[f64; 6]; 6]) {
        let freedom = |which: usize| 2 * pair[which / 2] + which % 2;
        let variable =
            |which: usize, point: PlaneVector| [0, 1].map(|k| WithGradient::<4>::variable(point[k], 2 * which + k));
        let rows = self.end_integral(pair[0], pair[1], values, variable);
        for (i, row) in rows.iter().enumerate() {
            for (k, value) in row.iter().enumerate() {
                for (which, slope) in value.gradient.iter().enumerate() {
                    matrix[2 * pair[i] + k][freedom(which)] += slope;
                }
            }
        }
    }

    /// `∫ φ f β_m n ds` over the edge between two corners, for both of them.
    fn end_integral<D: Differential>(
        &self,
        first: usize,
        last: usize,
        values: &[f64; 3],
        number: impl Fn(usize, PlaneVector) -> [D; 2],
    ) -> [[D; 2]; 2] {
        let zero = D::constant(0.0);
        let Some((_, _, share)) = self.inside(first, last, None) else { return [[zero; 2]; 2] };
        let (one, other) = (number(0, self.corners[first]), number(1, self.corners[last]));
        let (from, to) = limits(one, other, ALONG);
        let along = [other[0] - one[0], other[1] - one[1]];
        let outward = [-along[1], along[0]];
        let mut sums = [zero; 2];
        for gauss in GAUSS {
            let t = from + (to - from).times(gauss);
            let rest = t.times(-1.0).plus(1.0);
            let xi = [0, 1].map(|k| rest * one[k] + t * other[k]);
            let remaining = (xi[0] + xi[1]).times(-1.0).plus(1.0);
            let weight = remaining.times(self.weights[0]) + xi[0].times(self.weights[1]) + xi[1].times(self.weights[2]);
            let value = rest.times(values[first]) + t.times(values[last]);
            let product = weight * value * (to - from).times(0.5 * share);
            sums = [sums[0] + product * rest, sums[1] + product * t];
        }
        sums.map(|sum| outward.map(|part| sum * part))
    }

    /// The part of an edge inside the unit triangle, and its share: half where the edge runs along the triangle's own, as the
    /// neighbour there counts it, too; over the width of a passage from all to none.
    fn inside(&self, first: usize, last: usize, passage: Option<f64>) -> Option<(f64, f64, f64)> {
        let width = passage.unwrap_or(ALONG);
        let (one, other) = (self.corners[first], self.corners[last]);
        let (from, to) = limits(one, other, width);
        let shares = [one, other].map(|[x, y]| [1.0 - x - y, x, y]);
        let mut counted = 1.0;
        for [a, b] in [0, 1, 2].map(|k| shares.map(|share| share[k])) {
            if a.abs() <= width && b.abs() <= width {
                counted *= passage.map_or(0.5, |width| 0.5 + 0.25 * (a + b) / width);
            }
        }
        (to > from && counted > 0.0).then_some((from, to, counted))
    }

    fn weight_at(&self, [first, last]: [usize; 2], t: f64) -> f64 {
        let (one, other) = (self.corners[first], self.corners[last]);
        let [x, y] = [0, 1].map(|k| (1.0 - t) * one[k] + t * other[k]);
        self.weights[0] * (1.0 - x - y) + self.weights[1] * x + self.weights[2] * y
    }
}

/// `∫ φ β_i β_j dt` along an edge.
fn edge_products(from: f64, to: f64, weight: impl Fn(f64) -> f64) -> [[f64; 2]; 2] {
    let mut products = [[0.0; 2]; 2];
    for gauss in GAUSS {
        let t = from + gauss * (to - from);
        let (shares, factor) = ([1.0 - t, t], 0.5 * (to - from) * weight(t));
        for (i, row) in products.iter_mut().enumerate() {
            row.iter_mut().enumerate().for_each(|(j, value)| *value += factor * shares[i] * shares[j]);
        }
    }
    products
}

/// The parameters between which a segment is inside the unit triangle, whose limit is as wide as `width`; the second is not
/// the larger one where it is not.
fn limits<D: Differential>(one: [D; 2], other: [D; 2], width: f64) -> (D, D) {
    let (mut from, mut to) = (D::constant(0.0), D::constant(1.0));
    let third = |point: [D; 2]| (point[0] + point[1]).times(-1.0).plus(1.0);
    for (start, end) in [(one[0], other[0]), (one[1], other[1]), (third(one), third(other))] {
        let (a, b) = (start.value(), end.value());
        if a.abs() <= width && b.abs() <= width {
            continue;
        }
        let at = || start * (start - end).reciprocal();
        if a < 0.0 && b < 0.0 {
            return (D::constant(1.0), D::constant(0.0));
        } else if a < 0.0 && b >= 0.0 {
            let at = at();
            from = if at.value() > from.value() { at } else { from };
        } else if a >= 0.0 && b < 0.0 {
            let at = at();
            to = if at.value() < to.value() { at } else { to };
        }
    }
    (from, to)
}

/// The polygon that a triangle with these corners and the unit triangle share, with each vertex by its shares in the corners
/// of both (I. E. Sutherland, G. W. Hodgman, Reentrant polygon clipping, Comm. ACM 17, 1974).
fn clipped(corners: &[PlaneVector; 3]) -> Option<SmallVec<[Vertex; 8]>> {
    let mut polygon: SmallVec<[Vertex; 8]> = (0..3)
        .map(|k| {
            let [x, y] = corners[k];
            Vertex { own: [1.0 - x - y, x, y], other: std::array::from_fn(|l| if l == k { 1.0 } else { 0.0 }) }
        })
        .collect();
    for side in 0..3 {
        let mut next = SmallVec::new();
        for (k, vertex) in polygon.iter().enumerate() {
            let before = &polygon[(k + polygon.len() - 1) % polygon.len()];
            let (a, b) = (before.own[side], vertex.own[side]);
            if (a < 0.0) != (b < 0.0) {
                let t = a / (a - b);
                let between = |from: &[f64; 3], to: &[f64; 3]| std::array::from_fn(|l| from[l] + t * (to[l] - from[l]));
                let mut own: [f64; 3] = between(&before.own, &vertex.own);
                own[side] = 0.0;
                next.push(Vertex { own, other: between(&before.other, &vertex.other) });
            }
            if b >= 0.0 {
                next.push(*vertex);
            }
        }
        polygon = next;
    }
    (polygon.len() >= 3).then_some(polygon)
}
