//! Mortar contacts in space as posted: what covers a triangle by the corners inside and the crossings of edges, in order
//! around their middle; the distance at the corners of the own triangle, where lines along its normal meet the plane of the
//! other; derivatives by dual numbers.
//!
//! ```text
//! g = Σ_k μ_k h_k / Σ_k μ_k,      μ_k = ∫ χ λ_k dA,      χ = φ + s (ψ - φ)
//! ```
//!
//! with the distances `h_k` at the corners of the own triangles, the shape functions `λ_k` of these, and the shape function `φ` and
//! the dual function `ψ` of the node; the mechanics' `contact::bodies::space` says why.

use crate::check::measure::bodies::surface::{MeasuredTriangle, TouchedSurfaces};
use crate::check::measure::bodies::{BodyPlace, BodyState, COVERED, FAR_BEHIND, ROUNDINGS};
use crate::check::measure::numbers::{DualNumber, MeasuredVector, largest};
use crate::model::request::Contact;
use nalgebra::{DMatrix, DVector, Matrix3};
use std::collections::BTreeMap;
use std::sync::Arc;

/// Coordinates of the corners of two triangles.
const VARIABLES: usize = 18;
/// Corners this far outside, as parts of a triangle, count as inside.
const INSIDE: f64 = 1e-12;
/// Edges along an edge of the own triangle, to within this part of it, are shared with the triangle beside.
const ALONG: f64 = 1e-9;
/// Positions and weights of Gauss's three points on (0, 1).
const GAUSS: [(f64, f64); 3] =
    [(0.112_701_665_379_258_31, 5.0 / 18.0), (0.5, 4.0 / 9.0), (0.887_298_334_620_741_7, 5.0 / 18.0)];

type CornerNumber = DualNumber<VARIABLES>;
type NumberVector = [CornerNumber; 3];
type Position<'a> = &'a dyn Fn(usize) -> MeasuredVector;

/// A contact of a node with a surface in space.
#[derive(Debug, Clone)]
pub(in crate::check::measure) struct MeasuredBodyInSpace {
    node: usize,
    /// The faces at the node, which comes first in each.
    faces: Vec<Vec<usize>>,
    own: Vec<OwnTriangle>,
    opposite: Arc<[MeasuredTriangle]>,
    places: Arc<[MeasuredVector]>,
    overlap: f64,
    reach: f64,
}

/// A triangle of a face at the node.
#[derive(Debug, Clone)]
struct OwnTriangle {
    triangle: MeasuredTriangle,
    /// The shape function of the node and its dual function at the corners.
    shape: MeasuredVector,
    dual: MeasuredVector,
    /// Undeformed areas of the triangle and of its face, and the number of this.
    area: f64,
    whole: f64,
    face: usize,
    /// Whether a node of the face is supported: slips are weighted by the shape function then.
    is_held: bool,
}

/// A part of an own triangle that an opposite one covers.
struct Part<'a> {
    own: &'a OwnTriangle,
    opposite: &'a MeasuredTriangle,
    /// `∫ λ_k λ_l dA` for the corners of the own triangle, and `∫ φ λ_k dA`.
    products: Matrix3<f64>,
    moments: [f64; 3],
    /// Distances at the corners of the own triangle, and the shares of the opposite corners at the points met there.
    distances: [CornerNumber; 3],
    shares: [[CornerNumber; 3]; 3],
    weights: MeasuredVector,
    /// The same moments with the function for slips.
    slip_moments: [f64; 3],
    /// How the share of the dual function in `φ` changes with the covered area of the face.
    by_cover: f64,
    /// Places of the own, then of the opposite corners.
    corners: [MeasuredVector; 6],
}

impl MeasuredBodyInSpace {
    /// The contact of a checked model: a node, and the surface that it touches.
    pub fn new(contact: &Contact, (node, against): (usize, &str), surfaces: &TouchedSurfaces) -> Option<Self> {
        let faces = surfaces.around(contact.surface.as_deref()?, node);
        let places = Arc::clone(&surfaces.places);
        let opposite = Arc::clone(surfaces.triangles.get(against)?);
        let place = |node: usize| places[node];
        let own = faces
            .iter()
            .enumerate()
            .flat_map(|(number, face)| OwnTriangle::of_face(number, face, surfaces.is_held(face), &place));
        let own = own.collect();
        let touched = opposite.iter().flat_map(|triangle| triangle.corners.iter().flatten().map(|(node, _)| *node));
        let reach = touched.chain([node]).map(|node| largest(&places[node])).fold(0.0, f64::max);
        let mut body = Self { node, faces, own, opposite, places: Arc::clone(&places), overlap: 0.0, reach };
        body.overlap = body.gap(&surfaces.no_displacements).min(0.0);
        Some(body)
    }

    pub fn rounding(&self, displacements: &[MeasuredVector]) -> f64 {
        ROUNDINGS * f64::EPSILON * self.reach.max(largest(&displacements[self.node]))
    }

    /// The gap at displacements.
    pub fn gap(&self, displacements: &[MeasuredVector]) -> f64 {
        let position = |node: usize| self.places[node] + displacements[node];
        let gap = mean(&self.parts(&position), |part, k| part.distances[k].0);
        gap.unwrap_or_else(|| self.nearest(&position).0) - self.overlap
    }

    /// The contact at displacements.
    pub fn state(&self, displacements: &[MeasuredVector]) -> BodyState {
        let position = |node: usize| self.places[node] + displacements[node];
        let parts = self.parts(&position);
        let tangents = self.tangents(&position);
        let mut rows: BTreeMap<usize, [MeasuredVector; 3]> = BTreeMap::new();
        let area: f64 = parts.iter().flat_map(|part| part.moments).sum();
        let slip_area: f64 = parts.iter().flat_map(|part| part.slip_moments).sum();
        let areas = [area, slip_area, slip_area];
        let gap = mean(&parts, |part, k| part.distances[k].0);
        for part in &parts {
            let along = |tangent: &MeasuredVector| {
                let mut slopes = [0.0; VARIABLES];
                for (shares, moment) in part.shares.iter().zip(part.slip_moments) {
                    for (share, l) in shares.iter().zip(3..) {
                        let value = moment * tangent.dot(&(part.corners[l] - part.corners[3]));
                        slopes.iter_mut().zip(share.1).for_each(|(slope, change)| *slope += value * change);
                    }
                }
                slopes
            };
            let mut of_gap = part.slopes_of_gap(gap.unwrap_or(0.0));
            if part.by_cover != 0.0 {
                // Where the surface ends, the dual function gives way.
                let of_face = parts.iter().filter(|other| other.own.face == part.own.face);
                let changed: f64 = of_face.map(|other| other.change_to_dual(gap.unwrap_or(0.0))).sum();
                let by_area = part.slopes_at_ends(&MeasuredVector::repeat(1.0), &[1.0; 3]);
                (0..VARIABLES).for_each(|k| of_gap[k] += changed * part.by_cover * by_area[k]);
            }
            let all = [of_gap, along(&tangents[0]), along(&tangents[1])];
            let corners = part.own.triangle.corners.iter().chain(&part.opposite.corners).enumerate();
            for ((at, corner), (which, slopes)) in itertools::iproduct!(corners, all.iter().enumerate()) {
                for (node, share) in corner {
                    let row = rows.entry(*node).or_insert([MeasuredVector::zeros(); 3]);
                    (0..3).for_each(|axis| row[which][axis] += share * slopes[3 * at + axis] / areas[which]);
                }
            }
        }
        let from_node = self.places.iter().zip(displacements).map(|(place, moved)| place + moved - position(self.node));
        let axes = Matrix3::from_columns(&[tangents[0], tangents[1], tangents[0].cross(&tangents[1])]);
        let place = BodyPlace::Around { from_node: from_node.collect(), axes };
        let is_own = |node: &usize| self.faces.iter().any(|face| face.contains(node));
        let rows = rows.into_iter().map(|(node, row)| (node, row, is_own(&node))).collect();
        BodyState { gap: gap.unwrap_or_else(|| self.nearest(&position).0) - self.overlap, place, rows }
    }

    /// The tangents at the node: the first edge of its first face, across the sum of the area vectors of its faces.
    fn tangents(&self, position: Position) -> [MeasuredVector; 2] {
        let mut normal = MeasuredVector::zeros();
        for face in &self.faces {
            let corners: Vec<MeasuredVector> = face.iter().map(|node| position(*node)).collect();
            (1..face.len() - 1).for_each(|k| normal += (corners[k] - corners[0]).cross(&(corners[k + 1] - corners[0])));
        }
        let normal = normal.normalize();
        let edge = self.faces.first().map_or(MeasuredVector::x(), |face| position(face[1]) - position(face[0]));
        let first = (edge - normal * normal.dot(&edge)).normalize();
        [first, normal.cross(&first)]
    }

    /// The parts of the faces that the nearest part of the opposite surface covers.
    fn parts(&self, position: Position) -> Vec<Part<'_>> {
        let several = self.opposite.iter().any(|triangle| triangle.part != self.opposite[0].part);
        let nearest = if several { self.nearest(position).1 } else { self.opposite.first().map_or(0, |one| one.part) };
        let mut parts: Vec<Part> = Vec::new();
        let mut whole = 0.0;
        for own in &self.own {
            let corners = own.triangle.places(position);
            let face = own.triangle.face.iter().map(|node| position(*node)).collect::<Vec<_>>();
            let around = (1..face.len() - 1).map(|k| (face[k] - face[0]).cross(&(face[k + 1] - face[0])) / 2.0);
            let size = around.sum::<MeasuredVector>().norm().sqrt();
            whole += own.area * own.shape.sum() / 3.0;
            let reach = corners.iter().map(|corner| (corner - corners[0]).norm()).fold(0.0, f64::max);
            let across = (corners[1] - corners[0]).cross(&(corners[2] - corners[0])).normalize();
            for opposite in self.opposite.iter().filter(|opposite| opposite.part == nearest) {
                let others = opposite.places(position);
                let flat = |from: MeasuredVector| (from - across * across.dot(&from)).norm();
                let extent = others.iter().map(|other| flat(other - others[0])).fold(0.0, f64::max);
                if flat(others[0] - corners[0]) > reach + extent {
                    continue;
                }
                let all = [corners[0], corners[1], corners[2], others[0], others[1], others[2]];
                parts.extend(Part::new((own, opposite), all, FAR_BEHIND * size));
            }
        }
        let mut covered = vec![0.0; self.faces.len()];
        let mut by_shape = 0.0;
        for part in &parts {
            covered[part.own.face] += part.products.sum();
            by_shape += (part.products * part.own.shape).sum();
        }
        for part in &mut parts {
            let OwnTriangle { shape, dual, whole, face, .. } = part.own;
            // From half a face on, a polynomial with two continuous derivatives.
            let x = (2.0 * covered[*face] / whole - 1.0).clamp(0.0, 1.0);
            let share = x.powi(3) * (6.0 * x * x - 15.0 * x + 10.0);
            part.by_cover = 30.0 * (x * (1.0 - x)).powi(2) * 2.0 / whole;
            part.weights = shape + (dual - shape) * share;
            part.moments = (part.products * part.weights).into();
            part.slip_moments = if part.own.is_held { (part.products * shape).into() } else { part.moments };
        }
        if by_shape > COVERED * whole { parts } else { Vec::new() }
    }

    /// The distance of the node from the opposite surface, and the part of the surface that is nearest.
    fn nearest(&self, position: Position) -> (f64, usize) {
        let own = position(self.node);
        let distances =
            self.opposite.iter().map(|triangle| (from_triangle(own, &triangle.places(position)), triangle.part));
        distances.fold((f64::INFINITY, 0), |best, other| if other.0 < best.0 { other } else { best })
    }

    /// The smallest distance between the faces and the opposite surface.
    pub fn distance(&self, displacements: &[MeasuredVector]) -> f64 {
        let position = |node: usize| self.places[node] + displacements[node];
        let own: Vec<_> = self.own.iter().map(|own| own.triangle.places(&position)).collect();
        let mut least = f64::INFINITY;
        for other in self.opposite.iter().map(|triangle| triangle.places(&position)) {
            let extent = other.iter().map(|corner| (corner - other[0]).norm()).fold(0.0, f64::max);
            for one in &own {
                let reach = one.iter().map(|corner| (corner - one[0]).norm()).fold(0.0, f64::max);
                if (other[0] - one[0]).norm() - reach - extent >= least {
                    continue;
                }
                for k in 0..3 {
                    least = least.min(from_triangle(one[k], &other)).min(from_triangle(other[k], one));
                    (0..3).for_each(|l| {
                        let edges = [[one[k], one[(k + 1) % 3]], [other[l], other[(l + 1) % 3]]];
                        least = least.min(of_segments(edges));
                    });
                }
            }
        }
        least
    }
}

/// The mean of a function by its values at the corners of the own triangles; `None` where nothing is opposite.
fn mean(parts: &[Part], value: impl Fn(&Part, usize) -> f64) -> Option<f64> {
    let (mut sum, mut area) = (0.0, 0.0);
    for part in parts {
        sum += (0..3).map(|k| part.moments[k] * value(part, k)).sum::<f64>();
        area += part.moments.iter().sum::<f64>();
    }
    (area > 0.0).then(|| sum / area)
}

impl OwnTriangle {
    /// The triangles of a face from the node on.
    fn of_face(number: usize, face: &[usize], is_held: bool, place: &dyn Fn(usize) -> MeasuredVector) -> Vec<Self> {
        let triangles = MeasuredTriangle::of_face(face, &vec![false; face.len()], 0);
        let values = |triangle: &MeasuredTriangle| {
            let share = |node: usize, corner: usize| -> f64 {
                triangle.corners[corner].iter().filter(|(other, _)| *other == face[node]).map(|one| one.1).sum()
            };
            DMatrix::from_fn(face.len(), 3, share)
        };
        let areas = triangles.iter().map(|triangle| {
            let [a, b, c] = triangle.places(place);
            (b - a).cross(&(c - a)).norm() / 2.0
        });
        let areas: Vec<f64> = areas.collect();
        let mut mass = DMatrix::zeros(face.len(), face.len());
        for (triangle, area) in triangles.iter().zip(&areas) {
            let values = values(triangle);
            for corner in 0..3 {
                let middle = (values.column(corner) + values.column((corner + 1) % 3)) / 2.0;
                mass += &middle * middle.transpose() * (area / 3.0);
            }
        }
        // The dual function of the first node, by the inverse of the mass matrix.
        let sum = mass.row(0).sum();
        let shares = mass.try_inverse().map(|inverse| inverse.column(0) * sum);
        let shares = shares.unwrap_or_else(|| DVector::repeat(face.len(), f64::NAN));
        let whole = areas.iter().sum();
        let all = triangles.into_iter().zip(areas).map(|(triangle, area)| {
            let values = values(&triangle);
            let dual = values.transpose() * &shares;
            let shape = MeasuredVector::new(values[(0, 0)], values[(0, 1)], values[(0, 2)]);
            let dual = MeasuredVector::new(dual[0], dual[1], dual[2]);
            Self { triangle, shape, dual, area, whole, face: number, is_held }
        });
        all.collect()
    }
}

impl<'a> Part<'a> {
    fn new(
        (own, opposite): (&'a OwnTriangle, &'a MeasuredTriangle),
        corners: [MeasuredVector; 6],
        deepest: f64,
    ) -> Option<Self> {
        let [a, b, c, d, e, f] = corners;
        let (normal, other) = ((b - a).cross(&(c - a)), (e - d).cross(&(f - d)));
        let highest = [d, e, f].map(|corner| normal.dot(&(corner - a)) / normal.norm());
        if normal.dot(&other) >= 0.0 || highest.iter().all(|height| *height < -deepest) {
            return None;
        }
        let flat = |point: MeasuredVector| shares_in([a, b, c], point);
        let polygon = common_polygon([d, e, f].map(flat));
        let mut products = Matrix3::zeros();
        for k in 1..polygon.len().max(2) - 1 {
            let triangle = [polygon[0], polygon[k], polygon[k + 1]];
            let [[p, q], [r, s]] = [1, 2].map(|corner| [1, 2].map(|axis| triangle[corner][axis] - triangle[0][axis]));
            // The middles of the edges integrate quadratic functions exactly.
            for corner in 0..3 {
                let middle = (triangle[corner] + triangle[(corner + 1) % 3]) / 2.0;
                products += middle * middle.transpose() * ((p * s - q * r).abs() / 3.0 * own.area);
            }
        }
        if products.sum() <= 0.0 {
            return None;
        }
        let point = |at: usize| -> NumberVector {
            [0, 1, 2].map(|axis| CornerNumber::variable(corners[at][axis], 3 * at + axis))
        };
        let met = [0, 1, 2].map(|k| above(k, point));
        let (distances, shares) = (met.map(|met| met.0), met.map(|met| met.1));
        let (moments, slip_moments) = ([0.0; 3], [0.0; 3]);
        let (weights, by_cover) = (MeasuredVector::zeros(), 0.0);
        Some(Self { own, opposite, products, moments, slip_moments, distances, shares, weights, by_cover, corners })
    }

    /// Heights of the opposite corners over the own triangle.
    fn opposite_heights(&self) -> [f64; 3] {
        let [a, b, c, ..] = self.corners;
        let normal = (b - a).cross(&(c - a)).normalize();
        [3, 4, 5].map(|l| normal.dot(&(self.corners[l] - a)))
    }

    /// The slopes of `∫ φ (h - mean) dA`: by the distances at the own corners, and where the surface ends by the motion of
    /// its edge.
    fn slopes_of_gap(&self, mean: f64) -> [f64; VARIABLES] {
        let mut slopes = self.slopes_at_ends(&self.weights, &self.opposite_heights().map(|height| height - mean));
        for (value, moment) in self.distances.iter().zip(self.moments) {
            (0..VARIABLES).for_each(|k| slopes[k] += moment * value.1[k]);
        }
        slopes
    }

    /// The change of `∫ φ (h - mean) dA` with the share of the dual function.
    fn change_to_dual(&self, mean: f64) -> f64 {
        let moments = self.products * (self.own.dual - self.own.shape);
        (0..3).map(|k| moments[k] * (self.distances[k].0 - mean)).sum()
    }

    /// The slopes of `∫ w f dA` by the motion of the edges at which the surface ends, by the values of `w` at the own and of
    /// `f` at the opposite corners.
    fn slopes_at_ends(&self, weights: &MeasuredVector, at_opposite: &[f64; 3]) -> [f64; VARIABLES] {
        let mut slopes = [0.0; VARIABLES];
        for edge in (0..3).filter(|edge| self.opposite.ends[*edge]) {
            let [first, last] = [edge, (edge + 1) % 3];
            let point = |at: usize| [0, 1, 2].map(|axis| CornerNumber::variable(self.corners[at][axis], 3 * at + axis));
            let ends = [first, last].map(|corner| foot(corner + 3, point));
            let value =
                |end: usize, k: usize| [1.0 - ends[end][0].0 - ends[end][1].0, ends[end][0].0, ends[end][1].0][k];
            let (mut from, mut to) = (0.0_f64, 1.0_f64);
            let along = |k: usize| value(0, k).abs() <= ALONG && value(1, k).abs() <= ALONG;
            for k in (0..3).filter(|k| !along(*k)) {
                let (start, end) = (value(0, k), value(1, k));
                match (start < 0.0, end < 0.0) {
                    (true, true) => to = -1.0,
                    (true, false) => from = from.max(start / (start - end)),
                    (false, true) => to = to.min(start / (start - end)),
                    (false, false) => {}
                }
            }
            if to <= from {
                continue;
            }
            let share = if (0..3).any(along) { 0.5 } else { 1.0 };
            let edge_vector = [0, 1].map(|k| ends[1][k].0 - ends[0][k].0);
            // The opposite corners run clockwise around the normal.
            let outward = [-edge_vector[1], edge_vector[0]];
            for (at, weight) in GAUSS {
                let t = from + at * (to - from);
                let between = |k: usize| (1.0 - t) * value(0, k) + t * value(1, k);
                let here: f64 = (0..3).map(|k| weights[k] * between(k)).sum();
                let function = (1.0 - t) * at_opposite[first] + t * at_opposite[last];
                let factor = share * weight * (to - from) * here * function * 2.0 * self.own.area;
                for (k, slope) in slopes.iter_mut().enumerate() {
                    let moved = [0, 1].map(|axis| (1.0 - t) * ends[0][axis].1[k] + t * ends[1][axis].1[k]);
                    *slope += factor * (moved[0] * outward[0] + moved[1] * outward[1]);
                }
            }
        }
        slopes
    }
}

fn minus(a: NumberVector, b: NumberVector) -> NumberVector {
    [0, 1, 2].map(|k| a[k].minus(b[k]))
}

fn product(a: NumberVector, b: NumberVector) -> CornerNumber {
    a[0].by(b[0]).plus(a[1].by(b[1])).plus(a[2].by(b[2]))
}

fn cross(a: NumberVector, b: NumberVector) -> NumberVector {
    let part = |k: usize, l: usize| a[k].by(b[l]).minus(a[l].by(b[k]));
    [part(1, 2), part(2, 0), part(0, 1)]
}

/// Where the line along the normal through an own corner meets the plane of the opposite triangle: the distance, and the
/// shares of the opposite corners.
fn above(corner: usize, point: impl Fn(usize) -> NumberVector) -> (CornerNumber, [CornerNumber; 3]) {
    let (origin, start) = (point(corner), point(3));
    let normal = cross(minus(point(1), point(0)), minus(point(2), point(0)));
    let size = product(normal, normal);
    let length = size.map(size.0.sqrt(), 0.5 / size.0.sqrt());
    let other = cross(minus(point(4), start), minus(point(5), start));
    let distance = product(other, minus(start, origin)).by(length).over(product(other, normal));
    let met = [0, 1, 2].map(|k| origin[k].plus(distance.by(normal[k]).over(length)));
    let square = product(other, other);
    let second = product(cross(minus(met, start), minus(point(5), start)), other).over(square);
    let third = product(cross(minus(point(4), start), minus(met, start)), other).over(square);
    (distance, [CornerNumber::constant(1.0).minus(second).minus(third), second, third])
}

/// The shares of the second and the third own corner at the foot of a point on the own triangle.
fn foot(corner: usize, point: impl Fn(usize) -> NumberVector) -> [CornerNumber; 2] {
    let (first, second) = (minus(point(1), point(0)), minus(point(2), point(0)));
    let (normal, from) = (cross(first, second), minus(point(corner), point(0)));
    let square = product(normal, normal);
    [product(cross(from, second), normal).over(square), product(cross(first, from), normal).over(square)]
}

/// The shares of the corners of a triangle at the foot of a point.
fn shares_in([a, b, c]: [MeasuredVector; 3], point: MeasuredVector) -> MeasuredVector {
    let normal = (b - a).cross(&(c - a));
    let share = |one: MeasuredVector, other: MeasuredVector| {
        (one - point).cross(&(other - point)).dot(&normal) / normal.norm_squared()
    };
    MeasuredVector::new(share(b, c), share(c, a), share(a, b))
}

/// The corners of what a triangle, given by the shares of its corners, has in common with the one in which these are shares:
/// in order around their middle.
fn common_polygon(corners: [MeasuredVector; 3]) -> Vec<MeasuredVector> {
    let inside = |shares: &MeasuredVector| shares.iter().all(|share| *share >= -INSIDE);
    let mut vertices: Vec<MeasuredVector> = corners.iter().copied().filter(inside).collect();
    let plane = |shares: &MeasuredVector| [shares[1], shares[2]];
    let twice = |p: [f64; 2], q: [f64; 2], r: [f64; 2]| (q[0] - p[0]) * (r[1] - p[1]) - (q[1] - p[1]) * (r[0] - p[0]);
    let [d, e, f] = corners.map(|corner| plane(&corner));
    let whole = twice(d, e, f);
    let own = [MeasuredVector::x(), MeasuredVector::y(), MeasuredVector::z()];
    for corner in own {
        let at = plane(&corner);
        let shares = MeasuredVector::new(twice(e, f, at), twice(f, d, at), twice(d, e, at)) / whole;
        vertices.extend(Some(corner).filter(|_| inside(&shares)));
    }
    for (start, end) in (0..3).map(|k| (corners[k], corners[(k + 1) % 3])) {
        for k in (0..3).filter(|k| (start[*k] < 0.0) != (end[*k] < 0.0)) {
            let mut point = start + (end - start) * (start[k] / (start[k] - end[k]));
            point[k] = 0.0;
            vertices.extend(Some(point).filter(inside));
        }
    }
    let middle = vertices.iter().sum::<MeasuredVector>() / vertices.len().max(1) as f64;
    let angle = |vertex: &MeasuredVector| (vertex[2] - middle[2]).atan2(vertex[1] - middle[1]);
    vertices.sort_by(|one, other| angle(one).total_cmp(&angle(other)));
    vertices
}

fn from_segment(point: MeasuredVector, [first, last]: [MeasuredVector; 2]) -> f64 {
    let edge = last - first;
    let share = ((point - first).dot(&edge) / edge.norm_squared()).clamp(0.0, 1.0);
    (point - first - edge * share).norm()
}

fn from_triangle(point: MeasuredVector, corners: &[MeasuredVector; 3]) -> f64 {
    let shares = shares_in(*corners, point);
    if shares.iter().all(|share| *share >= 0.0) {
        let normal = (corners[1] - corners[0]).cross(&(corners[2] - corners[0])).normalize();
        return normal.dot(&(point - corners[0])).abs();
    }
    let edges = (0..3).map(|k| from_segment(point, [corners[k], corners[(k + 1) % 3]]));
    edges.fold(f64::INFINITY, f64::min)
}

/// The distance of two segments that do not meet.
fn of_segments([one, other]: [[MeasuredVector; 2]; 2]) -> f64 {
    let across = (one[1] - one[0]).cross(&(other[1] - other[0]));
    let square = across.norm_squared();
    if square > 0.0 {
        let from = other[0] - one[0];
        let s = from.cross(&(other[1] - other[0])).dot(&across) / square;
        let t = from.cross(&(one[1] - one[0])).dot(&across) / square;
        if (0.0..=1.0).contains(&s) && (0.0..=1.0).contains(&t) {
            return (from.dot(&across) / square.sqrt()).abs();
        }
    }
    let ends =
        one.map(|point| from_segment(point, other)).into_iter().chain(other.map(|point| from_segment(point, one)));
    ends.fold(f64::INFINITY, f64::min)
}
