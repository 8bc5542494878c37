//! The distance of the points of a path from a curve, with the points matched to the curve in their order.
//!
//! Whether all points can be matched within a distance `e` to places in non-decreasing order is decided greedily: each point is
//! matched to the first place within `e` that does not precede the place of the previous point. The least `e` is bracketed on
//! the polygon through the vertices of the curve; the earliest and the latest place of each point for this `e` bound the part
//! of the curve to which its distance is computed.

use crate::resources::cancel::CancelFlag;
use crate::studies::error_against_time::curve::Curve;
use crate::studies::error_against_time::nearest::{chord, distance_from_segment};
use crate::studies::error_against_time::trace::{ScaledPoint, distance};

/// Bisections of the logarithm of the distance: from seventeen decades to a part in a hundred.
const BISECTIONS: usize = 12;
const DECADES: f64 = 1e-17;
/// Corresponding places on the polygon and on the curve are at most this many times the sag of the curve apart.
const SLACK: f64 = 4.0;

/// The largest distance of a point; infinite on overflow or cancellation.
pub(super) fn path_error(points: &[ScaledPoint], curve: &Curve, cancel: &CancelFlag) -> f64 {
    let polygon = Polygon { vertices: &curve.vertices, arc: &curve.arc, backward: false };
    let Some(start) = curve.vertices.first() else { return f64::INFINITY };
    // Within this distance all points can be matched to the first place.
    let mut enough = points.iter().map(|point| distance(point, start)).fold(0.0, f64::max);
    if enough == 0.0 || !enough.is_finite() {
        return enough;
    }
    let mut least = enough * DECADES;
    for _ in 0..BISECTIONS {
        if cancel.is_cancelled() {
            return f64::INFINITY;
        }
        let between = (least * enough).sqrt();
        match polygon.places(points.iter(), between) {
            Some(_) => enough = between,
            None => least = between,
        }
    }
    let whole = curve.segments() as f64;
    let earliest = polygon.places(points.iter(), enough).unwrap_or_else(|| vec![0.0; points.len()]);
    let turned = Polygon { backward: true, ..polygon };
    let latest = turned.places(points.iter().rev(), enough).unwrap_or_else(|| vec![0.0; points.len()]);
    let windows = earliest.iter().zip(latest.iter().rev().map(|place| whole - place));
    let aside = SLACK * curve.sag();
    points
        .iter()
        .zip(windows)
        .map(|(point, (from, to))| {
            if cancel.is_cancelled() {
                return f64::INFINITY;
            }
            let from = polygon.place_at(polygon.length_at(*from) - aside);
            let to = polygon.place_at(polygon.length_at(to.max(from)) + aside);
            distance_from_window(curve, &polygon, (from, to), point)
        })
        .fold(0.0, f64::max)
}

/// Distance of a point from a curve between two places, computed for the segment with the nearest chord and its neighbours.
fn distance_from_window(curve: &Curve, polygon: &Polygon<'_>, (from, to): (f64, f64), point: &[f64]) -> f64 {
    let last = curve.segments() - 1;
    let (first, last) = ((from.floor() as usize).min(last), (to.floor() as usize).min(last));
    let mut nearest = (first, f64::INFINITY);
    let mut segment = first;
    while segment <= last {
        let found = chord(&curve.vertices[segment], &curve.vertices[segment + 1], point).0;
        if found < nearest.1 {
            nearest = (segment, found);
        }
        // Segments before this one cannot be nearer than the nearest so far.
        let beyond = distance(&curve.vertices[segment + 1], point) - nearest.1;
        segment = polygon.first_ending_past(polygon.length(segment + 1) + beyond, segment + 1);
    }
    let near = nearest.0.saturating_sub(1).max(first)..=(nearest.0 + 1).min(last);
    near.map(|segment| {
        let begins = segment as f64;
        let parts = ((from - begins).clamp(0.0, 1.0), (to - begins).clamp(0.0, 1.0));
        distance_from_segment(curve, segment, parts, point)
    })
    .fold(f64::INFINITY, f64::min)
}

/// The polygon through the vertices of a curve, traversed from either end. A place is a number: its integer part is the segment,
/// its fraction the parameter on the segment.
#[derive(Clone, Copy)]
struct Polygon<'a> {
    vertices: &'a [ScaledPoint],
    arc: &'a [f64],
    backward: bool,
}

impl Polygon<'_> {
    fn segments(&self) -> usize {
        self.vertices.len() - 1
    }

    fn vertex(&self, number: usize) -> &[f64] {
        &self.vertices[if self.backward { self.segments() - number } else { number }]
    }

    /// Length up to a vertex.
    fn length(&self, number: usize) -> f64 {
        let segments = self.segments();
        if self.backward { self.arc[segments] - self.arc[segments - number] } else { self.arc[number] }
    }

    /// Length up to a place.
    fn length_at(&self, place: f64) -> f64 {
        let segment = (place.floor() as usize).min(self.segments() - 1);
        let (start, end) = (self.length(segment), self.length(segment + 1));
        start + (place - segment as f64) * (end - start)
    }

    /// The place at a length, within the polygon.
    fn place_at(&self, length: f64) -> f64 {
        let segment = self.first_ending_past(length, 0).min(self.segments() - 1);
        let (start, end) = (self.length(segment), self.length(segment + 1));
        let part = if end > start { ((length - start) / (end - start)).clamp(0.0, 1.0) } else { 0.0 };
        segment as f64 + part
    }

    /// The first segment from the given one on that ends at or after a length; the number of segments if there is none.
    fn first_ending_past(&self, length: f64, from: usize) -> usize {
        let (mut low, mut high) = (from, self.segments());
        while low < high {
            let middle = (low + high) / 2;
            if self.length(middle + 1) < length { low = middle + 1 } else { high = middle }
        }
        low
    }

    /// The earliest places of the points in order, each within a distance; `None` if the points cannot be matched.
    fn places<'b>(&self, points: impl Iterator<Item = &'b ScaledPoint>, within: f64) -> Option<Vec<f64>> {
        let mut place = 0.0;
        points
            .map(|point| {
                place = self.first_within(point, place, within)?;
                Some(place)
            })
            .collect()
    }

    fn first_within(&self, point: &[f64], from: f64, within: f64) -> Option<f64> {
        let segments = self.segments();
        let mut segment = (from.floor() as usize).min(segments - 1);
        let mut part = from - segment as f64;
        while segment < segments {
            let (start, end) = (self.vertex(segment), self.vertex(segment + 1));
            if let Some((first, last)) = parts_within(start, end, point, within)
                && first.max(part) <= last
            {
                return Some(segment as f64 + first.max(part));
            }
            // All places closer along the polygon than this are too far from the point.
            let clear = self.length(segment + 1) + (distance(end, point) - within);
            segment = self.first_ending_past(clear, segment + 1);
            part = 0.0;
        }
        None
    }
}

/// The interval of parameters, from 0 to 1, of a segment within a distance of a point.
fn parts_within(start: &[f64], end: &[f64], point: &[f64], within: f64) -> Option<(f64, f64)> {
    let (mut squared, mut along, mut apart) = (0.0, 0.0, 0.0);
    for ((start, end), point) in start.iter().zip(end).zip(point) {
        squared += (end - start) * (end - start);
        along += (point - start) * (end - start);
        apart += (point - start) * (point - start);
    }
    if squared == 0.0 {
        return (apart.sqrt() <= within).then_some((0.0, 1.0));
    }
    let middle = along / squared;
    // From the foot itself, as the difference of the squares would cancel.
    let foot = start.iter().zip(end).zip(point).map(|((start, end), point)| start + middle * (end - start) - point);
    let beside = foot.map(|value| value * value).sum::<f64>();
    let room = within * within - beside;
    if room < 0.0 {
        return None;
    }
    let half = (room / squared).sqrt();
    let (first, last) = ((middle - half).max(0.0), (middle + half).min(1.0));
    (first <= last).then_some((first, last))
}
