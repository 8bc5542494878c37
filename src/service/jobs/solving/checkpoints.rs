//! Checkpoints, from which a job can be resumed.
//!
//! The solver's thread makes a checkpoint from time to time ([`Cadence`]), which is stored with its increment or after it.
//! What was computed after the last stored checkpoint is computed again.

use crate::check::judged::JudgedCheckpoint;
use crate::service::jobs::solving::cadence::Cadence;
use crate::service::jobs::solving::solver::Place;
use crate::service::jobs::solving::trail::{self, Written};
use crate::service::store::{Checkpoint, Origin};
use serde::{Deserialize, Serialize};
use std::time::{Duration, Instant};

/// Larger checkpoints (bytes) are not stored: such a job starts again when its worker is lost. 1,000,000 unknowns take
/// about 130 MB.
const LARGEST: usize = 256 << 20;

/// A stored checkpoint without the trail.
#[derive(Debug, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct StoredCheckpoint {
    pub at: JudgedCheckpoint,
    pub clock: Clock,
}

/// The `elapsed_s` of a job over all its attempts: a resumed job continues from the stored time, and work that was repeated
/// counts each time.
#[derive(Debug, Clone, Copy, Default, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Clock {
    /// Seconds of earlier attempts, which the path itself does not count.
    ahead: f64,
    /// The last total that was reported.
    told: f64,
}

impl Clock {
    /// Continues from a total of `told` seconds.
    pub fn go_on_from(&mut self, told: f64) {
        self.ahead += (told - self.told).max(0.0);
        self.told = self.told.max(told);
    }

    /// The total for a time of the path itself.
    pub fn tell(&mut self, elapsed_s: f64) -> f64 {
        self.told = elapsed_s + self.ahead;
        self.told
    }
}

impl StoredCheckpoint {
    /// # Errors
    /// A checkpoint that another version has stored.
    pub fn read(stored: &Origin) -> serde_json::Result<Self> {
        let mut read: Self = serde_json::from_str(&stored.body)?;
        trail::put_back(&mut read.at.path, &stored.trail)?;
        Ok(read)
    }
}

/// Makes the checkpoints of a path, in order.
#[derive(Debug)]
pub struct Checkpoints {
    written: Written,
    /// No checkpoint of this path has been made yet, so that a stored trail does not belong to it.
    begins: bool,
    cadence: Cadence,
}

impl Checkpoints {
    /// Checkpoints at intervals of at least `least`.
    pub fn every(least: Duration) -> Self {
        Self { written: Written::default(), begins: true, cadence: Cadence::after(least) }
    }

    /// Continues after the checkpoint from which a path was resumed, whose stored trail remains valid.
    pub fn after(&mut self, checkpoint: &JudgedCheckpoint) {
        self.written = Written::up_to(&checkpoint.path);
        self.begins = false;
    }

    /// The checkpoint at a point of the path, if one is due and the path supports checkpoints there.
    pub fn at(&mut self, place: &dyn Place, clock: Clock) -> serde_json::Result<Option<Checkpoint>> {
        if !self.cadence.is_due() {
            return Ok(None);
        }
        let began = Instant::now();
        let Some(mut at) = place.checkpoint() else {
            self.cadence.done(began);
            return Ok(None);
        };
        let index = at.path.index();
        let mut written = self.written;
        let part = written.part(&mut at.path)?;
        let body = serde_json::to_string(&StoredCheckpoint { at, clock })?;
        let bytes = body.len() + part.text.as_ref().map_or(0, String::len);
        if bytes > LARGEST {
            tracing::warn!(
                bytes,
                most = LARGEST,
                "the checkpoint is too large to be stored: if the worker is lost, the work from here on is repeated"
            );
            self.cadence.never_again();
            return Ok(None);
        }
        self.written = written;
        self.cadence.done(began);
        let begins = std::mem::take(&mut self.begins);
        Ok(Some(Checkpoint { index, body, trail: part.text, begins_trail: part.is_first || begins }))
    }
}
