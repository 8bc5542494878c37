//! Compares the events of a path with those of the reference: the longest common subsequence of their kinds.

use crate::result::increment::PointKind;
use crate::studies::error_against_time::curve::Curve;
use crate::studies::error_against_time::trace::{ScaledPoint, StudyTrace, distance};
use serde::{Deserialize, Serialize};

/// Comparisons of one event with another that are made. Past it only events before the first and after the last
/// difference are matched, and those between count as not found.
const MOST_COMPARED: usize = 4_000_000;

/// Contact changes, limit points, smooth bifurcations and ends, as a sequence beside the reference's.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "server", derive(utoipa::ToSchema))]
pub struct EventsFound {
    /// Events of the reference.
    pub expected: u64,
    /// Of those, found in order and of the same kind.
    pub found: u64,
    /// Events of the path that the reference does not have there.
    pub others: u64,
    /// Largest distance of those found from the reference's, in the plan's scaled norm; null where none is.
    pub largest_error: Option<f64>,
}

struct ComparedEvent<'a> {
    stage: usize,
    kind: PointKind,
    point: &'a ScaledPoint,
}

impl ComparedEvent<'_> {
    fn is_like(&self, other: &Self) -> bool {
        self.stage == other.stage && self.kind == other.kind
    }
}

pub(super) fn compare(trace: &StudyTrace, curves: &[Curve]) -> EventsFound {
    let found: Vec<ComparedEvent> = trace
        .stages
        .iter()
        .flat_map(|stage| {
            stage.events.iter().map(|event| ComparedEvent {
                stage: stage.stage,
                kind: event.kind,
                point: &stage.points[event.point],
            })
        })
        .collect();
    let expected: Vec<ComparedEvent> = curves
        .iter()
        .flat_map(|curve| {
            curve.events.iter().map(|(kind, point)| ComparedEvent { stage: curve.stage, kind: *kind, point })
        })
        .collect();
    let pairs = in_common(&found, &expected);
    let errors = pairs.iter().map(|(mine, theirs)| distance(found[*mine].point, expected[*theirs].point));
    EventsFound {
        expected: expected.len() as u64,
        found: pairs.len() as u64,
        others: (found.len() - pairs.len()) as u64,
        largest_error: errors.reduce(f64::max),
    }
}

/// The longest sequence of pairs of events of the same kind, in order.
fn in_common(found: &[ComparedEvent], expected: &[ComparedEvent]) -> Vec<(usize, usize)> {
    let alike = found.iter().zip(expected).take_while(|(a, b)| a.is_like(b)).count();
    let mut pairs: Vec<(usize, usize)> = (0..alike).map(|index| (index, index)).collect();
    let (rest, other_rest) = (&found[alike..], &expected[alike..]);
    let ends = rest.iter().rev().zip(other_rest.iter().rev()).take_while(|(a, b)| a.is_like(b)).count();
    let (columns, rows) = (rest.len() - ends, other_rest.len() - ends);
    if columns * rows <= MOST_COMPARED {
        // Lengths of the longest common subsequences of the remaining events.
        let width = columns + 1;
        let mut longest = vec![0_u32; width * (rows + 1)];
        for row in (0..rows).rev() {
            for column in (0..columns).rev() {
                longest[row * width + column] = if rest[column].is_like(&other_rest[row]) {
                    longest[(row + 1) * width + column + 1] + 1
                } else {
                    longest[(row + 1) * width + column].max(longest[row * width + column + 1])
                };
            }
        }
        let (mut row, mut column) = (0, 0);
        while row < rows && column < columns {
            let here = longest[row * width + column];
            if rest[column].is_like(&other_rest[row]) {
                pairs.push((alike + column, alike + row));
                (row, column) = (row + 1, column + 1);
            } else if longest[(row + 1) * width + column] == here {
                row += 1;
            } else {
                column += 1;
            }
        }
    }
    pairs.extend((0..ends).map(|index| (found.len() - ends + index, expected.len() - ends + index)));
    pairs
}
