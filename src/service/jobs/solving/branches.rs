//! Branch points, from which other directions can be followed: written to the store and read back.
//!
//! Not every point with listed directions is stored. A job that follows a direction of another point first retraces the path
//! of its parent from the nearest stored point before, which gives identical results.

use crate::check::judged::{Alternatives, JudgedCheckpoint};
use crate::service::jobs::solving::cadence::Cadence;
use crate::service::jobs::solving::solver::{Beginning, Place};
use crate::service::jobs::solving::trail::{self, Written};
use crate::service::store::{Branch, Origin, Parent};
use std::time::{Duration, Instant};

/// Makes the branch points of a path, in order.
#[derive(Debug)]
pub struct Branches {
    written: Written,
    cadence: Cadence,
}

impl Branches {
    /// Stores the first point with listed directions, then points at intervals of at least `least`, and every point with
    /// alternatives. `last`: the body of the last stored branch.
    pub fn every(least: Duration, last: Option<&str>) -> Self {
        let last = last.and_then(|last| serde_json::from_str::<JudgedCheckpoint>(last).ok());
        let written = last.map_or_else(Written::default, |last| Written::up_to(&last.path));
        Self { written, cadence: Cadence::from_now(least) }
    }

    /// The branch at a point with listed directions, if it is to be stored; `alternatives` are followed from here by other jobs.
    pub fn at(&mut self, place: &dyn Place, alternatives: Vec<u64>) -> serde_json::Result<Option<Branch>> {
        if alternatives.is_empty() && !self.cadence.is_due() {
            return Ok(None);
        }
        let began = Instant::now();
        let Some(mut checkpoint) = place.checkpoint() else { return Ok(None) };
        let part = self.written.part(&mut checkpoint.path)?;
        // The path along another direction has alternatives of its own.
        checkpoint.alternatives = Alternatives::default();
        let body = serde_json::to_string(&checkpoint)?;
        self.cadence.done(began);
        Ok(Some(Branch { body, trail: part.text, alternatives }))
    }
}

/// The beginning of a job that follows a direction of another job.
pub fn beginning(parent: &Parent, origin: &Origin) -> serde_json::Result<Beginning> {
    let mut checkpoint: JudgedCheckpoint = serde_json::from_str(&origin.body)?;
    trail::put_back(&mut checkpoint.path, &origin.trail)?;
    let Parent { job, increment, direction } = parent;
    let event = format!("follows direction {direction} of increment {increment} of job {job}");
    // An index too large for this machine is past the end of every list of directions.
    Ok(Beginning {
        checkpoint,
        increment: *increment,
        direction: usize::try_from(*direction).unwrap_or(usize::MAX),
        event,
    })
}
