//! Whether a curve crosses itself: on which side of such a curve a place lies is not defined.
//!
//! The curve is replaced by chords, and pairs of chords whose boxes overlap are compared.

use crate::algebra::plane_curve::{EndRay, PlaneBox, PlaneCurve, PlanePoint, at, cross, minus, plus, size};
use crate::resources::budget;

/// Chords per piece.
const CHORDS: usize = 8;

/// Length of the rays of an open curve, relative to its extent, up to which crossings are looked for.
const FAR: f64 = 1e6;

/// A place near which the curve crosses itself.
pub(super) fn crossing(curve: &PlaneCurve) -> Option<PlanePoint> {
    let chords = chords(curve);
    let closed = curve.rays.is_none();
    let mut order: Vec<usize> = (0..chords.len()).collect();
    let boxes: Vec<PlaneBox> = chords.iter().map(|chord| PlaneBox::of(chord)).collect();
    order.sort_by(|a, b| boxes[*a].low[0].total_cmp(&boxes[*b].low[0]).then(a.cmp(b)));
    // A sweep along x over the chords that have not ended.
    let mut open: Vec<usize> = Vec::new();
    for chord in order {
        open.retain(|other| boxes[*other].high[0] >= boxes[chord].low[0]);
        budget::spend(open.len());
        for other in &open {
            let (first, last) = (chord.min(*other), chord.max(*other));
            let are_neighbours = last - first <= 1 || (closed && first == 0 && last + 1 == chords.len());
            if !are_neighbours && boxes[first].overlaps(&boxes[last]) && cross_over(&chords[first], &chords[last]) {
                return Some(common_point(&chords[first], &chords[last]));
            }
        }
        open.push(chord);
    }
    None
}

fn chords(curve: &PlaneCurve) -> Vec<[PlanePoint; 2]> {
    let far = |ray: &EndRay| {
        let extent = size(minus(curve.boxes[0].high, curve.boxes[0].low));
        plus(ray.start, FAR * extent, ray.outwards)
    };
    let mut places: Vec<PlanePoint> = curve.rays.iter().map(|rays| far(&rays[0])).collect();
    for piece in &curve.pieces {
        places.extend((0..CHORDS).map(|step| at(piece, step as f64 / CHORDS as f64)[0]));
    }
    places.extend(curve.pieces.last().map(|piece| piece[3]));
    places.extend(curve.rays.iter().map(|rays| far(&rays[1])));
    places.windows(2).map(|ends| [ends[0], ends[1]]).collect()
}

/// The point that two chords which cross have in common; of parallel chords the start of the first.
fn common_point(first: &[PlanePoint; 2], second: &[PlanePoint; 2]) -> PlanePoint {
    let [along, across] = [first, second].map(|chord| minus(chord[1], chord[0]));
    let part = cross(minus(second[0], first[0]), across) / cross(along, across);
    if part.is_finite() { plus(first[0], part, along) } else { first[0] }
}

/// Whether two chords have a point in common.
fn cross_over(first: &[PlanePoint; 2], second: &[PlanePoint; 2]) -> bool {
    let splits = |chord: &[PlanePoint; 2], other: &[PlanePoint; 2]| {
        let along = minus(chord[1], chord[0]);
        let [a, b] = other.map(|place| cross(along, minus(place, chord[0])));
        (a <= 0.0 && b >= 0.0) || (a >= 0.0 && b <= 0.0)
    };
    splits(first, second) && splits(second, first)
}
