//! The states that a path has left, to detect a cycle in bounded memory.
//!
//! Where a direction is taken the state is compared with those kept and is kept itself, until their number reaches its
//! limit; then every second state is removed and from there on only every second one is kept, and so on. Every state is
//! compared, so that a path along a closed curve is detected: at its first return if no state has been removed; if only
//! every `stride`-th state is kept, fewer than `stride` states later.

use crate::continuation::scene::Scene;
use crate::mechanics::contact::{Mode, Reaction};
use serde::{Deserialize, Serialize};
use std::sync::Arc;

/// Largest number of states kept: each comparison examines all of them.
const MOST_STATES: usize = 4096;
/// Largest number of their bytes, where states are large ...
const MOST_BYTES: usize = 64 << 20;
/// ... but no fewer states than this are kept.
const FEWEST_STATES: usize = 8;

/// States at which a direction was taken in the running stage.
#[derive(Debug, Clone, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub(crate) struct VisitedStates {
    /// Number of states so far.
    seen: u64,
    /// One state in `stride` is kept: those whose number is a multiple of it.
    stride: u64,
    kept: Vec<Numbered>,
}

/// A state with its number in the stage, from 0.
#[derive(Debug, Clone, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub(crate) struct Numbered {
    number: u64,
    pub visited: Arc<Visited>,
}

impl Default for VisitedStates {
    fn default() -> Self {
        Self { seen: 0, stride: 1, kept: Vec::new() }
    }
}

/// The number of states of a scene that are kept.
pub(crate) fn room(scene: &Scene) -> usize {
    (MOST_BYTES / Visited::most_bytes(scene).max(1)).clamp(FEWEST_STATES, MOST_STATES)
}

impl VisitedStates {
    /// The number of states so far.
    pub fn seen(&self) -> u64 {
        self.seen
    }

    /// The states kept.
    pub fn states(&self) -> impl Iterator<Item = &Visited> {
        self.kept.iter().map(|one| &*one.visited)
    }

    /// Records a state; `room`: largest number of states kept.
    pub fn remember(&mut self, visited: Visited, room: usize) {
        let number = self.seen;
        self.seen += 1;
        if !number.is_multiple_of(self.stride) {
            return;
        }
        self.kept.push(Numbered { number, visited: Arc::new(visited) });
        while self.kept.len() > room.max(1) {
            self.stride *= 2;
            self.kept.retain(|one| one.number.is_multiple_of(self.stride));
        }
    }

    /// Takes all states out and returns those from this number on.
    pub fn take(&mut self, from: u64) -> Vec<Numbered> {
        let mut kept = std::mem::take(&mut self.kept);
        kept.retain(|one| one.number >= from);
        kept
    }

    /// Puts states back that were taken out; only those of the given stage that are still to be kept.
    pub fn put(&mut self, states: impl Iterator<Item = Numbered>, stage: usize) {
        let known = |one: &Numbered| {
            one.visited.stage == stage && one.number < self.seen && one.number.is_multiple_of(self.stride)
        };
        self.kept = states.filter(known).collect();
    }
}

/// A state that the path has passed.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub(crate) struct Visited {
    pub stage: usize,
    pub displacement: Vec<f64>,
    pub load: f64,
    /// The contacts that are not free, in ascending order.
    pub held: Vec<ClosedContact>,
}

/// A contact of the scene that sticks or slips.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub(crate) struct ClosedContact {
    pub contact: usize,
    pub mode: Mode,
    pub reaction: Reaction,
}

impl Visited {
    /// Bytes of a state of a scene with all contacts closed.
    pub fn most_bytes(scene: &Scene) -> usize {
        scene.structure.freedoms() * size_of::<f64>()
            + scene.contacts.len() * size_of::<ClosedContact>()
            + size_of::<Self>()
    }

    /// Whether another state coincides with this one, up to differences below `distance` (of displacements and load
    /// together) and `force`.
    pub fn is(&self, other: &Self, distance: f64, force: f64) -> bool {
        let alike = |(one, other): (&ClosedContact, &ClosedContact)| {
            one.contact == other.contact
                && one.mode.continues(other.mode)
                && one.reaction.difference(&other.reaction) < force
        };
        let apart = |(one, other): (&f64, &f64)| (one - other).powi(2);
        // Most states differ in the load alone.
        self.stage == other.stage
            && (self.load - other.load).abs() < distance
            && self.held.len() == other.held.len()
            && self.held.iter().zip(&other.held).all(alike)
            && self.displacement.iter().zip(&other.displacement).map(apart).sum::<f64>()
                + (self.load - other.load).powi(2)
                < distance * distance
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn state(place: f64) -> Visited {
        Visited { stage: 0, displacement: vec![place, 1.0], load: 0.5, held: Vec::new() }
    }

    fn is_known(history: &VisitedStates, place: f64) -> bool {
        let here = state(place);
        history.states().any(|known| known.is(&here, 1e-9, 1e-9))
    }

    #[test]
    fn memory_is_bounded_and_a_cycle_is_found_soon() {
        for (before, round) in [(0, 10), (90, 7), (1_000, 100), (20_000, 3), (100_000, 700)] {
            let mut history = VisitedStates::default();
            let (room, mut found) = (32, None);
            for event in 0..2 * before + 4 * round + 64 {
                // A different state each time, then a cycle.
                let place = if event < before { -1.0 - event as f64 } else { ((event - before) % round) as f64 };
                if is_known(&history, place) {
                    found = Some(event);
                    break;
                }
                history.remember(state(place), room);
                assert!(history.kept.len() <= room);
            }
            let found = found.unwrap_or_else(|| panic!("{before} and {round}: no cycle"));
            let first = before + round;
            assert!(
                (first..first + history.stride).contains(&found),
                "{before} and {round}: {found}, stride {}",
                history.stride
            );
        }
    }

    #[test]
    fn stored_in_parts_and_put_back_it_is_the_same() {
        let (mut history, mut parts, mut written) = (VisitedStates::default(), Vec::new(), 0);
        for event in 0..1_000_u64 {
            history.remember(state(event as f64), 10);
            if event % 7 == 0 {
                let mut copy = history.clone();
                parts.extend(copy.take(written));
                written = history.seen();
                copy.put(parts.iter().cloned(), 0);
                let numbers = |history: &VisitedStates| history.kept.iter().map(|one| one.number).collect::<Vec<_>>();
                assert_eq!(numbers(&copy), numbers(&history));
            }
        }
    }
}
