//! Which of the directions that a path does not take are followed by jobs of their own.
//!
//! On a stretch of bifurcation points the same alternative exists at every increment; to follow it from each would fill
//! the queue with nearly the same path. An alternative is followed
//!
//! - at the start and at every contact change and limit point, and
//! - between them where it first appears: where the increment before lists none with the same statuses of the contacts
//!   and the same sign of the load rate, or only one of the two increments is a bifurcation.
//!
//! The way back is no alternative, nor is a direction that cannot be followed (a mechanism; the stage ends). The first
//! increment of a job that follows another is a point of that one, whose alternatives are that one's.

use super::Jobs;
use crate::path::Increment;
use crate::path::increment::{Direction, PointKind, Status};

/// Load rates below this fraction of the largest one listed have no sign.
const STATIONARY: f64 = 1e-9;

/// Sees the increments of one path in order.
#[derive(Debug, Default)]
pub struct Alternatives {
    follows: bool,
    bifurcation: bool,
    before: Vec<Kind>,
}

/// By what an alternative is known again at the next increment.
#[derive(Debug, Clone, PartialEq)]
struct Kind {
    contacts: Vec<Status>,
    load: i8,
    /// Among several with the same statuses and sign.
    place: usize,
}

impl Alternatives {
    /// `follows`: the path follows a direction of another.
    pub fn of(follows: bool) -> Self {
        Self { follows, ..Self::default() }
    }

    /// The directions that are followed from this increment; `open` says which of those listed can be.
    pub fn at(&mut self, increment: &Increment, open: &[bool]) -> Vec<u64> {
        let directions = increment.directions.as_deref().unwrap_or_default();
        let largest = directions.iter().fold(0.0_f64, |largest, direction| largest.max(direction.load_rate.abs()));
        let same_stretch = increment.point.bifurcation == self.bifurcation
            && match increment.point.kind {
                PointKind::Regular | PointKind::End => true,
                PointKind::Start
                | PointKind::SmoothLimit
                | PointKind::NonsmoothLimit
                | PointKind::SmoothBifurcation
                | PointKind::ContactChange => false,
            };
        let mut kinds: Vec<Kind> = Vec::with_capacity(directions.len());
        let mut found = Vec::new();
        for (index, (direction, is_open)) in (0_u64..).zip(directions.iter().zip(open)) {
            if direction.taken || direction.retrace || !is_open {
                continue;
            }
            let load = sign(direction, largest);
            let alike = |kind: &&Kind| kind.contacts == direction.contacts && kind.load == load;
            let kind = Kind { contacts: direction.contacts.clone(), load, place: kinds.iter().filter(alike).count() };
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

/// Queues what ended jobs have found; what fails now is found again the next time.
pub(super) async fn queue(jobs: &Jobs) {
    match jobs.store.explore().await {
        Ok(0) => {}
        Ok(count) => tracing::info!(count, "directions not taken were queued"),
        Err(error) => tracing::warn!(%error, "directions not taken could not be queued"),
    }
}
