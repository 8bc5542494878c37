//! The point of a curve closest to a place.
//!
//! A branch-and-bound search over a binary tree of boxes, the nearer box first. On a piece `C(t)` the distance is least
//! at an end or where the polynomial `(C - p)·C'` of degree five rises through zero. Its roots are isolated by the signs
//! of its Bernstein coefficients, which bound their number (J. M. Lane and R. F. Riesenfeld, BIT 21 (1981) 112,
//! doi:10.1007/BF01934076).

use crate::algebra::plane_curve::{EndRay, PlaneBox, PlaneCurve, PlanePoint, at, cross, dot, minus, plus, size};
use crate::algebra::scalar_root::find_root;

/// Halvings of a parameter interval after which its middle stands for the roots in it.
const MOST_HALVINGS: u32 = 40;

/// Coefficients up to this, relative to their terms, are round-off: about a centre of curvature all of them are.
const NEGLIGIBLE: f64 = 4.0 * f64::EPSILON;

/// Least value of `1 - k g` (curvature and distance), which is 0 at a centre of curvature: there the closest point is
/// not unique, and no contact is closed.
const NEAR_CENTRE: f64 = 1e-9;

/// A curve at its point closest to a place.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct ClosestPoint {
    /// The signed distance of the place, positive to the left of the curve.
    pub distance: f64,
    /// The unit normal to the left.
    pub normal: PlanePoint,
    /// The curvature of the curve (1/length), positive where it turns left.
    pub curvature: f64,
}

/// The boxes of a binary tree over the pieces: a box, then those of the first half, then those of the second.
pub(super) fn boxes(pieces: &[[PlanePoint; 4]]) -> Vec<PlaneBox> {
    let mut boxes = Vec::with_capacity(2 * pieces.len());
    append_boxes(pieces, &mut boxes);
    boxes
}

fn append_boxes(pieces: &[[PlanePoint; 4]], boxes: &mut Vec<PlaneBox>) {
    boxes.push(pieces.iter().map(|piece| PlaneBox::of(piece)).reduce(|a, b| a.joined(&b)).unwrap_or(NOWHERE));
    if pieces.len() > 1 {
        let (first, second) = pieces.split_at(pieces.len() / 2);
        append_boxes(first, boxes);
        append_boxes(second, boxes);
    }
}

const NOWHERE: PlaneBox = PlaneBox { low: [f64::INFINITY; 2], high: [f64::NEG_INFINITY; 2] };

/// Number of boxes of a tree over so many pieces.
fn size_of_tree(pieces: usize) -> usize {
    (2 * pieces).saturating_sub(1)
}

/// The best so far: the distance, and where.
struct NearestFoot {
    distance: f64,
    found: Foot,
}

#[derive(Clone, Copy)]
enum Foot {
    OnPiece { piece: usize, t: f64 },
    OnRay { foot: PlanePoint, direction: PlanePoint },
}

/// See [`PlaneCurve::closest`].
pub(super) fn closest(curve: &PlaneCurve, place: PlanePoint) -> ClosestPoint {
    let mut best = NearestFoot { distance: f64::INFINITY, found: Foot::OnPiece { piece: 0, t: 0.0 } };
    for (ray, EndRay { start, outwards }) in curve.rays.iter().flatten().enumerate() {
        let along = dot(minus(place, *start), *outwards);
        if along > 0.0 {
            // The ray before the curve leads against its direction.
            let direction = if ray == 0 { outwards.map(|part| -part) } else { *outwards };
            let foot = plus(*start, along, *outwards);
            best.try_at(size(minus(place, foot)), Foot::OnRay { foot, direction });
        }
    }
    search(curve, place, 0, 0..curve.pieces.len(), &mut best);
    match best.found {
        Foot::OnPiece { piece, t } => at_piece(&curve.pieces[piece], t, place),
        Foot::OnRay { foot, direction } => {
            let normal = [-direction[1], direction[0]];
            ClosestPoint { distance: dot(normal, minus(place, foot)), normal, curvature: 0.0 }
        }
    }
}

fn search(curve: &PlaneCurve, place: PlanePoint, tree: usize, pieces: std::ops::Range<usize>, best: &mut NearestFoot) {
    if curve.boxes[tree].distance(place) >= best.distance {
        return;
    }
    if pieces.len() == 1 {
        best.try_piece(pieces.start, &curve.pieces[pieces.start], place);
        return;
    }
    let middle = pieces.start + pieces.len() / 2;
    let first = (tree + 1, pieces.start..middle);
    let second = (tree + 1 + size_of_tree(first.1.len()), middle..pieces.end);
    let distances = [&first, &second].map(|(tree, _)| curve.boxes[*tree].distance(place));
    let order = if distances[0] <= distances[1] { [first, second] } else { [second, first] };
    for (tree, pieces) in order {
        search(curve, place, tree, pieces, best);
    }
}

impl ClosestPoint {
    /// The curvature of the parallel curve through the place: the normal turns by `-k/(1 - k g)` per length there.
    pub fn curvature_at_place(&self) -> f64 {
        self.curvature / (1.0 - self.curvature * self.distance).max(NEAR_CENTRE)
    }
}

fn at_piece(piece: &[PlanePoint; 4], t: f64, place: PlanePoint) -> ClosestPoint {
    let [foot, slope, bend] = at(piece, t);
    let speed = size(slope);
    let normal = [-slope[1] / speed, slope[0] / speed];
    let curvature = cross(slope, bend) / (speed * speed * speed);
    ClosestPoint { distance: dot(normal, minus(place, foot)), normal, curvature }
}

impl NearestFoot {
    fn try_at(&mut self, distance: f64, found: Foot) {
        if distance < self.distance {
            *self = Self { distance, found };
        }
    }

    fn try_piece(&mut self, number: usize, piece: &[PlanePoint; 4], place: PlanePoint) {
        let mut try_at = |t: f64| {
            let distance = size(minus(place, at(piece, t)[0]));
            self.try_at(distance, Foot::OnPiece { piece: number, t });
        };
        try_at(0.0);
        try_at(1.0);
        let values = coefficients(piece, place);
        let negligible = NEGLIGIBLE * largest_product(piece, place);
        each_minimum(&values, negligible, [0.0, 1.0], MOST_HALVINGS, &mut |between| {
            let value = |t: f64| {
                let [foot, slope, _] = at(piece, t);
                dot(minus(foot, place), slope)
            };
            let [low, high] = between.map(|t| (t, value(t)));
            if low.1 >= 0.0 {
                try_at(low.0);
            } else if high.1 <= 0.0 {
                try_at(high.0);
            } else if let Some(t) = find_root(|t| Some(value(t)), high, low, 0.0) {
                try_at(t);
            }
        });
    }
}

/// The Bernstein coefficients of `(C - p)·C'/3`.
fn coefficients(piece: &[PlanePoint; 4], place: PlanePoint) -> [f64; 6] {
    const OF_THREE: [f64; 4] = [1.0, 3.0, 3.0, 1.0];
    const OF_TWO: [f64; 3] = [1.0, 2.0, 1.0];
    const OF_FIVE: [f64; 6] = [1.0, 5.0, 10.0, 10.0, 5.0, 1.0];
    let from = piece.map(|point| minus(point, place));
    let slopes = [0, 1, 2].map(|k| minus(piece[k + 1], piece[k]));
    let mut sums = [0.0; 6];
    for (i, from) in from.iter().enumerate() {
        for (j, slope) in slopes.iter().enumerate() {
            sums[i + j] += OF_THREE[i] * OF_TWO[j] / OF_FIVE[i + j] * dot(*from, *slope);
        }
    }
    sums
}

/// A bound on the terms of these coefficients.
fn largest_product(piece: &[PlanePoint; 4], place: PlanePoint) -> f64 {
    let far = piece.iter().map(|point| size(minus(*point, place))).fold(0.0, f64::max);
    let fast = piece.windows(2).map(|ends| size(minus(ends[1], ends[0]))).fold(0.0, f64::max);
    far * fast
}

/// Calls `each` with intervals that hold one rise through zero each, or are too short to tell several apart.
fn each_minimum(values: &[f64; 6], negligible: f64, between: [f64; 2], halvings: u32, each: &mut impl FnMut([f64; 2])) {
    let signs = values.iter().filter(|value| value.abs() > negligible).map(|value| *value > 0.0);
    let changes = signs.clone().zip(signs.clone().skip(1)).filter(|(a, b)| a != b).count();
    if changes == 0 || (changes == 1 && signs.clone().next() == Some(true)) {
        return;
    }
    if changes == 1 || halvings == 0 {
        each(between);
        return;
    }
    let (mut left, mut right, mut row) = ([0.0; 6], [0.0; 6], *values);
    for level in 0..6 {
        left[level] = row[0];
        right[5 - level] = row[5 - level];
        for k in 0..5 - level {
            row[k] = 0.5 * (row[k] + row[k + 1]);
        }
    }
    let middle = 0.5 * (between[0] + between[1]);
    if left[5].abs() <= negligible {
        each([middle; 2]);
    }
    each_minimum(&left, negligible, [between[0], middle], halvings - 1, each);
    each_minimum(&right, negligible, [middle, between[1]], halvings - 1, each);
}
