//! Polylines as posted, for the measure only: their curves as polynomials in powers of a parameter, and the closest point
//! by sampling and bisection.
//!
//! Through points: the cubic spline by its slopes, which the Gauss–Seidel iteration finds. With rounded corners: the
//! basis functions of the uniform cubic B-spline. Both are stated otherwise than in the solver.

use nalgebra::Vector2;

use crate::model::request::{Polyline, Side};

/// Sweeps of the iteration, each of which reduces the error to less than half.
const SWEEPS: usize = 120;
/// Parts of a piece between which the closest point is looked for.
const SAMPLES: usize = 32;
const HALVINGS: usize = 60;
/// Between two corners that use up their edge, what is left of it is shorter than this part of it and has no direction.
const NO_EDGE: f64 = 1e-12;

type PlanePlace = Vector2<f64>;

/// `c0 + c1 t + c2 t² + c3 t³`, `0 <= t <= 1`; the distance from `c0` is at most `reach`.
#[derive(Debug, Clone)]
struct MeasuredPiece {
    coefficients: [PlanePlace; 4],
    reach: f64,
}

/// The curve of a polyline relative to its first point, and its rays where it is open: their starts and outward unit
/// directions.
#[derive(Debug, Clone)]
pub(super) struct MeasuredCurve {
    pieces: Vec<MeasuredPiece>,
    rays: Vec<(PlanePlace, PlanePlace)>,
    /// 1 where the left of the curve is free, otherwise -1.
    sign: f64,
    /// The largest coordinate of the points.
    pub size: f64,
}

impl MeasuredCurve {
    pub fn new(posted: &Polyline) -> Self {
        let at = |point: &Vec<f64>| PlanePlace::new(point[0], point[1]);
        let origin = posted.points.first().map_or_else(PlanePlace::zeros, at);
        let points: Vec<PlanePlace> = posted.points.iter().map(|point| at(point) - origin).collect();
        let pieces = match posted.rounding {
            Some(rounding) => rounded(&points, posted.closed, rounding),
            None => through(&points, posted.closed),
        };
        let mut rays = Vec::new();
        if let (false, Some(first), Some(last)) = (posted.closed, pieces.first(), pieces.last()) {
            rays.push((first.place(0.0), -first.slope(0.0).normalize()));
            rays.push((last.place(1.0), last.slope(1.0).normalize()));
        }
        let doubled: f64 = (0..points.len()).map(|k| points[k].perp(&points[(k + 1) % points.len()])).sum();
        let leaves_left = !posted.closed || (doubled > 0.0) == (posted.side == Some(Side::Inside));
        let size = posted.points.iter().flatten().fold(0.0_f64, |most, value| most.max(value.abs()));
        Self { pieces, rays, sign: if leaves_left { 1.0 } else { -1.0 }, size }
    }

    /// The gap at a place relative to the first point, and the unit normal into the free side.
    pub fn gap(&self, place: [f64; 2]) -> (f64, [f64; 2]) {
        let place = PlanePlace::new(place[0], place[1]);
        let mut best = (f64::INFINITY, PlanePlace::zeros(), PlanePlace::x());
        let mut try_at = |foot: PlanePlace, along: PlanePlace| {
            let distance = (place - foot).norm();
            if distance < best.0 {
                best = (distance, foot, along);
            }
            best.0
        };
        for (number, (start, outwards)) in self.rays.iter().enumerate() {
            let way = (place - start).dot(outwards).max(0.0);
            try_at(start + outwards * way, if number == 0 { -outwards } else { *outwards });
        }
        let mut least = f64::INFINITY;
        for piece in &self.pieces {
            if (place - piece.coefficients[0]).norm() - piece.reach <= least {
                piece.each_candidate(&place, |t| least = try_at(piece.place(t), piece.slope(t)));
            }
        }
        let (_, foot, along) = best;
        let normal = PlanePlace::new(-along.y, along.x) * (self.sign / along.norm());
        ((place - foot).dot(&normal), [normal.x, normal.y])
    }
}

impl MeasuredPiece {
    fn new(coefficients: [PlanePlace; 4]) -> Self {
        Self { reach: coefficients[1..].iter().map(PlanePlace::norm).sum(), coefficients }
    }

    /// From its ends and the slopes there.
    fn between(start: PlanePlace, end: PlanePlace, leaves: PlanePlace, arrives: PlanePlace) -> Self {
        let chord = end - start;
        Self::new([start, leaves, chord * 3.0 - leaves * 2.0 - arrives, leaves + arrives - chord * 2.0])
    }

    fn place(&self, t: f64) -> PlanePlace {
        let [a, b, c, d] = &self.coefficients;
        a + (b + (c + d * t) * t) * t
    }

    fn slope(&self, t: f64) -> PlanePlace {
        let [_, b, c, d] = &self.coefficients;
        b + (c * 2.0 + d * (3.0 * t)) * t
    }

    /// Calls `each` with the parameters of its ends and of the minima of the distance that sampling shows.
    fn each_candidate(&self, place: &PlanePlace, mut each: impl FnMut(f64)) {
        let rise = |t: f64| (self.place(t) - place).dot(&self.slope(t));
        each(0.0);
        each(1.0);
        for sample in 0..SAMPLES {
            let [mut low, mut high] = [sample, sample + 1].map(|k| k as f64 / SAMPLES as f64);
            if rise(low) > 0.0 || rise(high) < 0.0 {
                continue;
            }
            for _ in 0..HALVINGS {
                let middle = 0.5 * (low + high);
                if rise(middle) < 0.0 { low = middle } else { high = middle }
            }
            each(0.5 * (low + high));
        }
    }
}

fn through(points: &[PlanePlace], closed: bool) -> Vec<MeasuredPiece> {
    let count = points.len();
    let edges = if closed { count } else { count - 1 };
    let chords: Vec<PlanePlace> = (0..edges).map(|edge| points[(edge + 1) % count] - points[edge]).collect();
    let lengths: Vec<f64> = chords.iter().map(PlanePlace::norm).collect();
    let mut slopes = vec![PlanePlace::zeros(); count];
    for _ in 0..SWEEPS {
        for point in 0..count {
            let before = (closed || point > 0).then(|| (point + count - 1) % count);
            let behind = (closed || point < edges).then(|| (point + 1) % count);
            let (mut sum, mut weight) = (PlanePlace::zeros(), 0.0);
            for (edge, neighbour) in [(before, before), (behind.map(|_| point), behind)] {
                let (Some(edge), Some(neighbour)) = (edge, neighbour) else { continue };
                let length = lengths[edge];
                sum += chords[edge] * (3.0 / (length * length)) - slopes[neighbour] / length;
                weight += 2.0 / length;
            }
            slopes[point] = sum / weight;
        }
    }
    (0..edges)
        .map(|edge| {
            let next = (edge + 1) % count;
            let length = lengths[edge];
            MeasuredPiece::between(points[edge], points[next], slopes[edge] * length, slopes[next] * length)
        })
        .collect()
}

fn rounded(points: &[PlanePlace], closed: bool, rounding: f64) -> Vec<MeasuredPiece> {
    let count = points.len();
    let edges = if closed { count } else { count - 1 };
    let direction = |edge: usize| (points[(edge + 1) % count] - points[edge]).normalize();
    let mut pieces = Vec::new();
    for edge in 0..edges {
        let along = direction(edge);
        let starts_round = closed || edge > 0;
        let ends_round = closed || edge + 1 < edges;
        let start = points[edge] + along * if starts_round { rounding } else { 0.0 };
        let corner = points[(edge + 1) % count];
        let end = corner - along * if ends_round { rounding } else { 0.0 };
        if (end - start).dot(&along) > NO_EDGE * (corner - points[edge]).norm() {
            pieces.push(MeasuredPiece::between(start, end, end - start, end - start));
        }
        if ends_round {
            let onwards = direction((edge + 1) % count);
            let control = [
                corner - along * (2.0 * rounding),
                end,
                corner,
                corner + onwards * rounding,
                corner + onwards * (2.0 * rounding),
            ];
            pieces.extend(control.windows(4).map(|four| b_spline([four[0], four[1], four[2], four[3]])));
        }
    }
    pieces
}

/// A piece of the uniform cubic B-spline with these control points.
fn b_spline([p, q, r, s]: [PlanePlace; 4]) -> MeasuredPiece {
    MeasuredPiece::new([
        (p + q * 4.0 + r) / 6.0,
        (r - p) / 2.0,
        (p - q * 2.0 + r) / 2.0,
        (s - r * 3.0 + q * 3.0 - p) / 6.0,
    ])
}
