//! Curves from points: cubic splines by the second derivatives at their points, and corners by uniform cubic B-splines
//! (C. de Boor, *A Practical Guide to Splines*, Springer 2001).

use crate::algebra::plane_curve::{CurveMistake, PlanePoint, cross, dot, minus, plus, size};

/// Points closer than this, relative to the extent of all, coincide.
const COINCIDENT: f64 = 1e-12;

/// Cosine of the turn (170°) from which on a corner counts as turning back: the rounded corner would have a radius of
/// less than a hundredth of its rounding.
const TURNS_BACK: f64 = -0.984_807_753_012_208;

/// The pieces of the cubic spline.
pub(super) fn through(points: &[PlanePoint], closed: bool) -> Result<Vec<[PlanePoint; 4]>, CurveMistake> {
    let edges = PolylineEdges::of(points, closed)?;
    let bends = edges.bends(closed);
    let pieces = (0..edges.lengths.len()).map(|edge| {
        let next = (edge + 1) % points.len();
        let (length, chord) = (edges.lengths[edge], edges.directions[edge]);
        let (first, last) = (bends[edge], bends[next]);
        let leaves = plus(chord, -length / 6.0, plus(last, 2.0, first));
        let arrives = plus(chord, length / 6.0, plus(first, 2.0, last));
        let (start, end) = (points[edge], points[next]);
        [start, plus(start, length / 3.0, leaves), plus(end, -length / 3.0, arrives), end]
    });
    Ok(pieces.collect())
}

/// The pieces of the polygon with rounded corners.
pub(super) fn rounded(
    points: &[PlanePoint],
    closed: bool,
    rounding: f64,
) -> Result<Vec<[PlanePoint; 4]>, CurveMistake> {
    let edges = PolylineEdges::of(points, closed)?;
    let count = edges.lengths.len();
    let mut pieces = Vec::with_capacity(3 * count);
    for edge in 0..count {
        let next = (edge + 1) % points.len();
        let (has_corner_before, has_corner_after) = (closed || edge > 0, closed || edge + 1 < count);
        let most = edges.lengths[edge] / (1 + usize::from(has_corner_before && has_corner_after)) as f64;
        if (has_corner_before || has_corner_after) && rounding > most * (1.0 + COINCIDENT) {
            return Err(CurveMistake::NoRoom { point: if has_corner_after { next } else { edge }, most });
        }
        let along = edges.directions[edge];
        let start = plus(points[edge], if has_corner_before { rounding } else { 0.0 }, along);
        let end = plus(points[next], if has_corner_after { -rounding } else { 0.0 }, along);
        let straight = minus(end, start);
        if dot(straight, along) > COINCIDENT * edges.lengths[edge] {
            pieces.push([start, plus(start, 1.0 / 3.0, straight), plus(start, 2.0 / 3.0, straight), end]);
        }
        if has_corner_after {
            pieces.extend(corner(end, points[next], along, edges.directions[next], rounding));
        }
    }
    Ok(pieces)
}

/// The two pieces that round off a corner between its neighbouring edges, of directions `before` and `after`.
fn corner(
    start: PlanePoint,
    corner: PlanePoint,
    before: PlanePoint,
    after: PlanePoint,
    rounding: f64,
) -> [[PlanePoint; 4]; 2] {
    let end = plus(corner, rounding, after);
    let between = |a: PlanePoint, b: PlanePoint| plus(a, 1.0 / 3.0, minus(b, a));
    let middle = [0, 1].map(|k| corner[k] + rounding / 6.0 * (after[k] - before[k]));
    [
        [start, between(start, corner), between(corner, start), middle],
        [middle, between(corner, end), between(end, corner), end],
    ]
}

/// The edges between points.
struct PolylineEdges {
    lengths: Vec<f64>,
    /// Unit vectors.
    directions: Vec<PlanePoint>,
}

impl PolylineEdges {
    fn of(points: &[PlanePoint], closed: bool) -> Result<Self, CurveMistake> {
        let needed = if closed { 3 } else { 2 };
        if points.len() < needed {
            return Err(CurveMistake::TooFew { needed });
        }
        let extent = points.iter().fold(0.0_f64, |most, point| most.max(size(minus(*point, points[0]))));
        let count = points.len() - usize::from(!closed);
        let mut edges = Self { lengths: Vec::with_capacity(count), directions: Vec::with_capacity(count) };
        for edge in 0..count {
            let next = (edge + 1) % points.len();
            let chord = minus(points[next], points[edge]);
            let length = size(chord);
            if length <= COINCIDENT * extent {
                return Err(CurveMistake::Coincident { point: next.max(edge) });
            }
            edges.lengths.push(length);
            edges.directions.push(chord.map(|part| part / length));
        }
        for edge in usize::from(!closed)..count {
            let before = (edge + count - 1) % count;
            if dot(edges.directions[before], edges.directions[edge]) < TURNS_BACK {
                return Err(CurveMistake::TurnsBack { point: edge });
            }
        }
        Ok(edges)
    }

    /// The second derivatives of the spline at its points.
    fn bends(&self, closed: bool) -> Vec<PlanePoint> {
        let count = self.lengths.len();
        let jump = |edge: usize| {
            let before = (edge + count - 1) % count;
            minus(self.directions[edge], self.directions[before]).map(|part| 6.0 * part)
        };
        let diagonal = |edge: usize| 2.0 * (self.lengths[(edge + count - 1) % count] + self.lengths[edge]);
        if !closed {
            let inner: Vec<PlanePoint> = (1..count).map(jump).collect();
            let diagonals: Vec<f64> = (1..count).map(diagonal).collect();
            let beside = &self.lengths[1..];
            let inner = solve_tridiagonal(&diagonals, beside, inner);
            return std::iter::once([0.0; 2]).chain(inner).chain([[0.0; 2]]).collect();
        }
        // The corners of the cyclic matrix are a matrix of rank one (Sherman and Morrison), taken so that the rest
        // remains diagonally dominant.
        let corner = self.lengths[count - 1];
        let mut diagonals: Vec<f64> = (0..count).map(diagonal).collect();
        diagonals[0] -= corner;
        diagonals[count - 1] -= corner;
        let mut unit = vec![[0.0; 2]; count];
        (unit[0], unit[count - 1]) = ([1.0; 2], [1.0; 2]);
        let beside = &self.lengths[..count - 1];
        let mut bends = solve_tridiagonal(&diagonals, beside, (0..count).map(jump).collect());
        let by_corner = solve_tridiagonal(&diagonals, beside, unit);
        let ends = |values: &[PlanePoint]| plus(values[0], 1.0, values[count - 1]);
        let factor = corner / (1.0 + corner * ends(&by_corner)[0]);
        let weights = ends(&bends).map(|part| factor * part);
        bends.iter_mut().zip(&by_corner).for_each(|(bend, column)| {
            *bend = [0, 1].map(|k| bend[k] - weights[k] * column[k]);
        });
        bends
    }
}

/// Solves a symmetric diagonally dominant tridiagonal system for two columns; `beside` are the entries beside the
/// diagonal.
fn solve_tridiagonal(diagonals: &[f64], beside: &[f64], mut columns: Vec<PlanePoint>) -> Vec<PlanePoint> {
    let mut pivots = diagonals.to_vec();
    for row in 1..pivots.len() {
        let factor = beside[row - 1] / pivots[row - 1];
        pivots[row] -= factor * beside[row - 1];
        columns[row] = plus(columns[row], -factor, columns[row - 1]);
    }
    for row in (0..pivots.len()).rev() {
        if row + 1 < pivots.len() {
            columns[row] = plus(columns[row], -beside[row], columns[row + 1]);
        }
        columns[row] = columns[row].map(|part| part / pivots[row]);
    }
    columns
}

/// Twice the area that a closed polygon encloses, positive where it runs counter-clockwise.
pub fn doubled_area(points: &[PlanePoint]) -> f64 {
    let Some(origin) = points.first() else { return 0.0 };
    points.windows(2).map(|edge| cross(minus(edge[0], *origin), minus(edge[1], *origin))).sum()
}
