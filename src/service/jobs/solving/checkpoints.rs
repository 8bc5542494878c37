//! Where a running job can be taken up again.
//!
//! On the solver's thread the path is put down now and then ([`Cadence`]), and what that gives is stored with or after
//! its increment. What was computed after the last one stored is computed again.

use crate::check::judged::JudgedCheckpoint;
use crate::service::jobs::solving::cadence::Cadence;
use crate::service::jobs::solving::solver::Place;
use crate::service::jobs::solving::trail::{self, Written};
use crate::service::store::{Checkpoint, Origin};
use serde::{Deserialize, Serialize};
use std::time::{Duration, Instant};

/// Larger ones (bytes) are not stored: such a job begins anew when its worker is lost. 150,000 unknowns take some 20 MB.
const LARGEST: usize = 64 << 20;

/// What is stored, but for the trail.
#[derive(Debug, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct PutDown {
    pub at: JudgedCheckpoint,
    pub clock: Clock,
}

/// `elapsed_s` of a job that is taken up goes on from what is stored: what its attempts computed more than once counts each
/// time.
#[derive(Debug, Clone, Copy, Default, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Clock {
    /// Seconds that the path itself does not count.
    ahead: f64,
    /// The last time told.
    told: f64,
}

impl Clock {
    /// So many seconds have been told in all.
    pub fn go_on_from(&mut self, told: f64) {
        self.ahead += (told - self.told).max(0.0);
        self.told = self.told.max(told);
    }

    /// What a path's own time is in all.
    pub fn tell(&mut self, elapsed_s: f64) -> f64 {
        self.told = elapsed_s + self.ahead;
        self.told
    }
}

impl PutDown {
    /// # Errors
    /// What another version has stored.
    pub fn read(stored: &Origin) -> serde_json::Result<Self> {
        let mut read: Self = serde_json::from_str(&stored.body)?;
        trail::put_back(&mut read.at.path, &stored.trail)?;
        Ok(read)
    }
}

/// Makes checkpoints of a path, in order.
#[derive(Debug)]
pub struct Checkpoints {
    written: Written,
    /// None has been made of this path yet, and what may be stored of its trail is of no use.
    begins: bool,
    cadence: Cadence,
}

impl Checkpoints {
    /// None sooner than `least` after another.
    pub fn every(least: Duration) -> Self {
        Self { written: Written::default(), begins: true, cadence: Cadence::after(least) }
    }

    /// Of a path that is taken up: what is stored of its trail stands.
    pub fn after(&mut self, checkpoint: &JudgedCheckpoint) {
        self.written = Written::up_to(&checkpoint.path);
        self.begins = false;
    }

    /// The checkpoint at a place, if one is due and the path can be put down there.
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
        let body = serde_json::to_string(&PutDown { at, clock })?;
        let bytes = body.len() + part.text.as_ref().map_or(0, String::len);
        if bytes > LARGEST {
            tracing::warn!(
                bytes,
                most = LARGEST,
                "too large to be put down: a lost worker costs what comes from here on"
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
