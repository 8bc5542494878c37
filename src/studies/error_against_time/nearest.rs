//! The distance of a point from a segment of a curve.

use crate::studies::error_against_time::curve::Curve;
use crate::studies::error_against_time::trace::distance;

/// The most steps of the descent.
const MOST_STEPS: usize = 30;
/// The most halvings of a step that does not descend.
const HALVINGS: usize = 6;
/// Half the interval of a difference quotient, as a part of the segment.
const DIFFERENCE: f64 = 1e-4;

/// The least distance, by the Gauss-Newton method for the parameter, starting where the chord is nearest; near the curve an error
/// of the parameter only has a second-order effect. Every parameter tried gives an upper bound. Only parameters within
/// `within` are considered.
pub(super) fn distance_from_segment(curve: &Curve, segment: usize, within: (f64, f64), point: &[f64]) -> f64 {
    let bounded = |part: f64| part.max(within.0).min(within.1);
    let mut part = bounded(chord(&curve.vertices[segment], &curve.vertices[segment + 1], point).1);
    let mut here = curve.at(segment, part);
    let mut least = distance(&here, point);
    for _ in 0..MOST_STEPS {
        let (before, after) = ((part - DIFFERENCE).max(0.0), (part + DIFFERENCE).min(1.0));
        let (from, to) = (curve.at(segment, before), curve.at(segment, after));
        let (mut along, mut squared) = (0.0, 0.0);
        for (((from, to), here), point) in from.iter().zip(&to).zip(&here).zip(point) {
            let slope = (to - from) / (after - before);
            along += (point - here) * slope;
            squared += slope * slope;
        }
        if squared == 0.0 {
            break;
        }
        let mut step = along / squared;
        let mut descended = false;
        for _ in 0..HALVINGS {
            let tried = bounded(part + step);
            let place = curve.at(segment, tried);
            let found = distance(&place, point);
            if found < least {
                (part, here, least, descended) = (tried, place, found, true);
                break;
            }
            step *= 0.5;
        }
        if !descended {
            break;
        }
    }
    least
}

/// Distance of a point from the chord between two points, and the parameter of its foot.
pub(super) fn chord(from: &[f64], to: &[f64], point: &[f64]) -> (f64, f64) {
    let (mut along, mut squared) = (0.0, 0.0);
    for ((from, to), point) in from.iter().zip(to).zip(point) {
        along += (point - from) * (to - from);
        squared += (to - from) * (to - from);
    }
    let part = if squared > 0.0 { (along / squared).clamp(0.0, 1.0) } else { 0.0 };
    let nearest = from.iter().zip(to).zip(point).map(|((from, to), point)| from + part * (to - from) - point);
    (nearest.map(|value| value * value).sum::<f64>().sqrt(), part)
}
