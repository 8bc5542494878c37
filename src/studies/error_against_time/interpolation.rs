//! The curve through the points of a path, between two neighbours.
//!
//! Over the chord of a few points the curve is the graph of a smooth function, and that is what is interpolated: a
//! polynomial of degree up to seven in the place along the chord, through the two points and their neighbours on both
//! sides. A parameter such as the sum of chords would not do: it is not smooth in the arc length, and interpolation in it
//! is of fourth order at most (M. S. Floater, T. Surazhsky, *Parameterization for curve interpolation*, in: Topics in
//! Multivariate Approximation and Interpolation, Elsevier 2006, 39). Neighbours are so far apart that round-off is not
//! magnified, and only as many as the curve runs along their chord at no steep angle.

use crate::studies::error_against_time::trace::{ScaledPoint, distance};

/// Points of a polynomial at most.
const MOST: usize = 8;
/// Neighbours closer than this to the last one taken, in chords, are passed over.
const CLOSEST: f64 = 0.25;
/// Cosine of the steepest angle with the chord of all.
const GENTLE: f64 = 0.5;

/// A polynomial from one point to the next.
#[derive(Debug, Clone)]
pub(super) struct SegmentPolynomial {
    /// Which of the points, in order.
    nodes: Vec<usize>,
    /// Places along the chord; 0 and 1 are the segment's ends.
    places: Vec<f64>,
    /// Of barycentric interpolation (J.-P. Berrut, L. N. Trefethen, SIAM Rev. 46 (2004) 501).
    weights: Vec<f64>,
    /// Which of the nodes is the segment's first.
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

    /// The point at a part of the way, from 0 to 1.
    pub fn at(&self, points: &[ScaledPoint], part: f64) -> ScaledPoint {
        if let Some(node) = self.places.iter().position(|place| *place == part) {
            return points[self.nodes[node]].clone();
        }
        // As a change from the first point, which keeps its digits.
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
    // From both sides in turn, so that the two points stay in the middle.
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

/// Places of the nodes along the chord from the first to the last, 0 and 1 at the segment's ends; none where the curve
/// runs at too steep an angle.
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
