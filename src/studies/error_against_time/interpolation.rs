//! Interpolation of the curve through the points of a path, between two neighbouring points.
//!
//! Over the chord of a few points the curve is the graph of a smooth function, which is interpolated by a polynomial of degree
//! up to seven in the coordinate along the chord, through the two points and their neighbours on both sides. The sum of
//! chords would not be a suitable parameter: it is not smooth in the arc length, so that interpolation in it is of fourth
//! order at most (M. S. Floater, T. Surazhsky, *Parameterization for curve interpolation*, in: Topics in
//! Multivariate Approximation and Interpolation, Elsevier 2006, 39). Neighbours are chosen far enough apart that
//! round-off is not magnified, and only as many that the curve is nowhere at a steep angle to their chord.

use crate::studies::error_against_time::trace::{ScaledPoint, distance};

/// The most points of a polynomial.
const MOST: usize = 8;
/// Neighbours closer than this to the last chosen one, relative to the chord, are skipped.
const CLOSEST: f64 = 0.25;
/// Cosine of the steepest angle with the chord of all.
const GENTLE: f64 = 0.5;

/// A polynomial from one point to the next.
#[derive(Debug, Clone)]
pub(super) struct SegmentPolynomial {
    /// The indices of the nodes among the points, in order.
    nodes: Vec<usize>,
    /// Coordinates of the nodes along the chord; 0 and 1 are the ends of the segment.
    places: Vec<f64>,
    /// Weights of barycentric interpolation (J.-P. Berrut, L. N. Trefethen, SIAM Rev. 46 (2004) 501).
    weights: Vec<f64>,
    /// The index of the first point of the segment among the nodes.
    start: usize,
}

impl SegmentPolynomial {
    /// Between the points `segment` and `segment + 1`, with neighbours from `first` to `last`.
    pub fn new(points: &[ScaledPoint], segment: usize, first: usize, last: usize) -> Self {
        let mut nodes = neighbours(points, segment, first, last);
        let places = loop {
            match places(points, segment, &nodes) {
                Some(places) => break places,
                // The two points by themselves: their chord.
                None if nodes.len() <= 2 => {
                    nodes = vec![segment, segment + 1];
                    break vec![0.0, 1.0];
                }
                None => {
                    let far = |node: usize| distance(&points[node], &points[segment]);
                    let (front, back) = (far(nodes[0]), far(nodes[nodes.len() - 1]));
                    let drop_front = nodes[0] < segment && (front >= back || nodes[nodes.len() - 1] == segment + 1);
                    nodes.remove(if drop_front { 0 } else { nodes.len() - 1 });
                }
            }
        };
        let weights = places
            .iter()
            .enumerate()
            .map(|(k, place)| {
                let others = places.iter().enumerate().filter(|(other, _)| *other != k);
                1.0 / others.map(|(_, other)| place - other).product::<f64>()
            })
            .collect();
        let start = nodes.iter().position(|node| *node == segment).unwrap_or_default();
        Self { nodes, places, weights, start }
    }

    /// The point at a parameter from 0 to 1.
    pub fn at(&self, points: &[ScaledPoint], part: f64) -> ScaledPoint {
        if let Some(node) = self.places.iter().position(|place| *place == part) {
            return points[self.nodes[node]].clone();
        }
        // As a difference from the first point, to avoid round-off.
        let from = &points[self.nodes[self.start]];
        let shares: Vec<f64> =
            self.places.iter().zip(&self.weights).map(|(place, weight)| weight / (part - place)).collect();
        let total: f64 = shares.iter().sum();
        let mut point = from.clone();
        for (node, share) in self.nodes.iter().zip(&shares) {
            for ((value, end), start) in point.iter_mut().zip(&points[*node]).zip(from) {
                *value += share / total * (end - start);
            }
        }
        point
    }
}

/// The two points of a segment and neighbours on both sides, in order, as far as there are any.
fn neighbours(points: &[ScaledPoint], segment: usize, first: usize, last: usize) -> Vec<usize> {
    let closest = CLOSEST * distance(&points[segment], &points[segment + 1]);
    let mut nodes = std::collections::VecDeque::from([segment, segment + 1]);
    let (mut before, mut after) = (true, true);
    // From both sides in turn, so that the two points remain in the middle.
    while nodes.len() < MOST && (before || after) {
        if before {
            let end = nodes[0];
            let next = (first..end).rev().find(|next| distance(&points[*next], &points[end]) >= closest);
            next.into_iter().for_each(|next| nodes.push_front(next));
            before = next.is_some();
        }
        if after && nodes.len() < MOST {
            let end = nodes[nodes.len() - 1];
            let next = (end + 1..=last).find(|next| distance(&points[*next], &points[end]) >= closest);
            next.into_iter().for_each(|next| nodes.push_back(next));
            after = next.is_some();
        }
    }
    nodes.into()
}

/// Coordinates of the nodes along the chord from the first to the last, 0 and 1 at the ends of the segment; `None` if the curve
/// is at too steep an angle to the chord.
fn places(points: &[ScaledPoint], segment: usize, nodes: &[usize]) -> Option<Vec<f64>> {
    let (from, to) = (&points[*nodes.first()?], &points[*nodes.last()?]);
    let length = distance(from, to);
    let along: Vec<f64> = nodes
        .iter()
        .map(|node| {
            let parts = points[*node].iter().zip(from).zip(to);
            parts.map(|((x, from), to)| (x - from) * (to - from)).sum::<f64>() / length
        })
        .collect();
    let gentle = nodes.windows(2).zip(along.windows(2)).all(|(nodes, along)| {
        let chord = distance(&points[nodes[0]], &points[nodes[1]]);
        chord > 0.0 && along[1] - along[0] >= GENTLE * chord
    });
    let start = nodes.iter().position(|node| *node == segment)?;
    let (zero, one) = (along[start], along[start + 1]);
    gentle.then(|| along.iter().map(|place| (place - zero) / (one - zero)).collect())
}
