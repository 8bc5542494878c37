//! Points from which another direction can be followed, on their way to the store and back.
//!
//! Not every point where directions are listed is put down: a job that follows one traces its parent's path on to there from
//! the nearest point before it that was, which gives the same bits.

use crate::check::judged::{Alternatives, JudgedCheckpoint};
use crate::service::jobs::solving::cadence::Cadence;
use crate::service::jobs::solving::solver::{Beginning, Place};
use crate::service::jobs::solving::trail::{self, Written};
use crate::service::store::{Branch, Origin, Parent};
use std::time::{Duration, Instant};

/// Makes branches of a path, in order.
#[derive(Debug)]
pub struct Branches {
    written: Written,
    cadence: Cadence,
}

impl Branches {
    /// The first where directions are listed for the first time, and none sooner than `least` after another unless there are
    /// alternatives. `last`: the body of the last branch that is stored.
    pub fn every(least: Duration, last: Option<&str>) -> Self {
        let last = last.and_then(|last| serde_json::from_str::<JudgedCheckpoint>(last).ok());
        let written = last.map_or_else(Written::default, |last| Written::up_to(&last.path));
        Self { written, cadence: Cadence::from_now(least) }
    }

    /// The branch at a place where directions are listed; `alternatives` are followed from here by jobs of their own.
    pub fn at(&mut self, place: &dyn Place, alternatives: Vec<u64>) -> serde_json::Result<Option<Branch>> {
        if alternatives.is_empty() && !self.cadence.is_due() {
            return Ok(None);
        }
        let began = Instant::now();
        let Some(mut checkpoint) = place.checkpoint() else { return Ok(None) };
        let part = self.written.part(&mut checkpoint.path)?;
        // Another direction has alternatives of its own.
        checkpoint.alternatives = Alternatives::default();
        let body = serde_json::to_string(&checkpoint)?;
        self.cadence.done(began);
        Ok(Some(Branch { body, trail: part.text, alternatives }))
    }
}

/// Where a job begins that follows another.
pub fn beginning(parent: &Parent, origin: &Origin) -> serde_json::Result<Beginning> {
    let mut checkpoint: JudgedCheckpoint = serde_json::from_str(&origin.body)?;
    trail::put_back(&mut checkpoint.path, &origin.trail)?;
    let Parent { job, increment, direction } = parent;
    let event = format!("follows direction {direction} of increment {increment} of job {job}");
    // A direction too large for this machine is as absent as one past the end of the list.
    Ok(Beginning {
        checkpoint,
        increment: *increment,
        direction: usize::try_from(*direction).unwrap_or(usize::MAX),
        event,
    })
}
