//! The alternatives of a path: directions that it does not take and that other jobs follow.
//!
//! On a stretch of bifurcation points the same alternative exists at every increment; to follow it from each would fill
//! the queue with nearly the same path. An alternative is followed
//!
//! - at the start of a stage and at every contact change and limit point, and
//! - between them where it first appears: where the increment before lists none with the same statuses of the contacts
//!   and the same sign of the load rate, or only one of the two increments is a bifurcation.
//!
//! The way back is no alternative, nor is a direction that cannot be followed (a mechanism; the stage ends). The first
//! increment of a job that follows another is a point of the other path, to which its alternatives belong.

use crate::result::increment::{Direction, Increment, PointKind, Status};
use serde::{Deserialize, Serialize};
use std::sync::Arc;

/// Load rates below this fraction of the largest listed one count as zero.
const STATIONARY: f64 = 1e-9;

/// Receives the increments of a path in order.
#[derive(Debug, Clone, Default, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Alternatives {
    follows: bool,
    bifurcation: bool,
    before: Vec<AlternativeKey>,
}

/// The properties by which an alternative is recognised at the next increment.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
struct AlternativeKey {
    /// The statuses of the contacts that are not free; free ones may come into reach meanwhile.
    held: Vec<(Arc<str>, Arc<str>, Status)>,
    load: i8,
    /// The number among several with the same statuses and sign.
    place: usize,
}

impl Alternatives {
    /// `follows`: the path follows a direction of another.
    pub fn of(follows: bool) -> Self {
        Self { follows, ..Self::default() }
    }

    /// No increment has been received, and the path follows no other.
    pub fn is_fresh(&self) -> bool {
        *self == Self::default()
    }

    /// The directions that are to be followed from this increment; `open` tells for each listed direction whether it can be.
    pub fn at(&mut self, increment: &Increment, open: &[bool]) -> Vec<u64> {
        let directions = increment.directions.as_deref().unwrap_or_default();
        let largest = directions.iter().fold(0.0_f64, |largest, direction| largest.max(direction.load_rate.abs()));
        let same_stretch = increment.point.bifurcation == self.bifurcation
            && match increment.point.kind {
                PointKind::Regular | PointKind::End | PointKind::Motion => true,
                PointKind::Start
                | PointKind::Jump
                | PointKind::SmoothLimit
                | PointKind::NonsmoothLimit
                | PointKind::SmoothBifurcation
                | PointKind::ContactChange => false,
            };
        let mut kinds: Vec<AlternativeKey> = Vec::with_capacity(directions.len());
        let mut found = Vec::new();
        for (index, (direction, is_open)) in (0_u64..).zip(directions.iter().zip(open)) {
            if direction.taken || direction.retrace || !is_open {
                continue;
            }
            let load = sign(direction, largest);
            let rows = increment.contacts.iter().zip(&direction.contacts);
            let held = rows.filter(|(_, status)| **status != Status::Free);
            let held: Vec<_> =
                held.map(|(row, status)| (Arc::clone(&row.node), Arc::clone(&row.obstacle), *status)).collect();
            let alike = |kind: &&AlternativeKey| kind.held == held && kind.load == load;
            let place = kinds.iter().filter(alike).count();
            let kind = AlternativeKey { held, load, place };
            if !(same_stretch && self.before.contains(&kind)) {
                found.push(index);
            }
            kinds.push(kind);
        }
        self.before = kinds;
        self.bifurcation = increment.point.bifurcation;
        if self.follows && increment.index == 0 { Vec::new() } else { found }
    }
}

fn sign(direction: &Direction, largest: f64) -> i8 {
    let threshold = STATIONARY * largest;
    i8::from(direction.load_rate > threshold) - i8::from(direction.load_rate < -threshold)
}

#[cfg(test)]
mod tests {
    use super::Alternatives;
    use crate::result::increment::{ContactState, Diagnostics, Direction, Energy, Increment, Point, PointKind, Status};
    use crate::result::nodal_values::NodalValues;
    use smallvec::smallvec;

    fn direction(contacts: Status, load_rate: f64) -> Direction {
        let contacts = vec![contacts];
        Direction { contacts, load_rate, dissipation_rate: 0.0, taken: false, retrace: false, mechanism: false }
    }

    fn increment(index: u64, kind: PointKind, bifurcation: bool, mut directions: Vec<Direction>) -> Increment {
        directions.insert(0, Direction { taken: true, ..direction(Status::Slip, -0.1) });
        let (event, better_direction, unexplored_modes, degenerate) = (None, false, 0, false);
        let contact = ContactState {
            node: "tip".into(),
            obstacle: "floor".into(),
            status: Status::Slip,
            gap: 0.0,
            normal_reaction: 1.0,
            tangential_reaction: smallvec![-0.3],
            reaction: smallvec![-0.3, 1.0],
            slip: smallvec![0.1],
            slip_total: smallvec![0.1],
            indeterminate: false,
        };
        Increment {
            index,
            stage: "push".into(),
            load_factor: 1.0,
            arc_length: 0.0,
            step: 0.1,
            displacements: NodalValues::default(),
            contacts: vec![contact],
            elements: Vec::new(),
            supports: NodalValues::default(),
            applied_forces: smallvec![],
            point: Point { kind, bifurcation, event, better_direction, unexplored_modes, degenerate },
            directions: Some(directions),
            stability: None,
            other_motion: None,
            energy: Energy::default(),
            diagnostics: Diagnostics::default(),
        }
    }

    #[test]
    fn an_alternative_is_followed_once_a_stretch_and_at_every_event() {
        let mut alternatives = Alternatives::of(false);
        let stuck = || direction(Status::Stick, -1.0);
        let mut at = |index, kind, bifurcation, directions| {
            let increment = increment(index, kind, bifurcation, directions);
            alternatives.at(&increment, &[true; 4][..increment.directions.as_ref().map_or(0, Vec::len)])
        };
        let regular = PointKind::Regular;
        assert_eq!(at(0, PointKind::Start, false, vec![stuck()]), [1]);
        assert!(at(1, regular, false, vec![stuck()]).is_empty());
        // A second one appears, of the same statuses; then the points become bifurcations; then a contact changes.
        assert_eq!(at(2, regular, false, vec![stuck(), stuck()]), [2]);
        assert_eq!(at(3, regular, true, vec![stuck(), stuck()]), [1, 2]);
        assert!(at(4, regular, true, vec![stuck(), stuck()]).is_empty());
        assert_eq!(at(5, PointKind::ContactChange, true, vec![stuck()]), [1]);
        // The other sign of the load rate is another alternative; one that was away is a new one.
        assert_eq!(at(6, regular, true, vec![direction(Status::Stick, 1.0)]), [1]);
        assert_eq!(at(7, regular, true, vec![stuck()]), [1]);
        let retrace = Direction { retrace: true, ..direction(Status::Free, 1.0) };
        assert!(at(8, regular, true, vec![stuck(), retrace]).is_empty());
    }

    #[test]
    fn what_is_closed_or_the_parents_is_left() {
        let mut alternatives = Alternatives::of(true);
        let start = increment(0, PointKind::Start, true, vec![direction(Status::Stick, -1.0)]);
        assert!(alternatives.at(&start, &[true, true]).is_empty());
        let both = vec![direction(Status::Stick, -1.0), direction(Status::Free, -1.0)];
        let next = increment(1, PointKind::Regular, true, both.clone());
        assert!(alternatives.at(&next, &[true, true, false]).is_empty());
        let open = increment(2, PointKind::Regular, true, both);
        assert_eq!(alternatives.at(&open, &[true, true, true]), [2]);
    }
}
