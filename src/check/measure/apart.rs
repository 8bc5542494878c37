//! Contacts without a row: the increment says of them that they are out of reach, so their gaps must be open.
//!
//! Over a dimensionless distance `a` a node moves by at most `ℓ a cos α`, its obstacle by `|d| σ a sin α` (`d` its motion
//! per load factor, `σ` the load scale), so a gap changes by at most `a √(ℓ² + |d|² σ²)`, and an open one needs no look
//! before it could have closed.

use crate::check::measure::errors::{Errors, worse};
use crate::check::measure::posted::{Posted, PostedContact, PostedLoading};
use crate::check::measure::vector::MeasuredVector;
use std::cmp::Reverse;
use std::collections::BinaryHeap;

/// What rounding may do to a bound.
const ROUNDING: f64 = 1e-9;

#[derive(Debug, Clone)]
pub(super) struct Apart {
    /// The plan's displacement scale.
    length: f64,
    /// For each contact, how far its gap may change by unit distance (length).
    fastest: Vec<f64>,
    /// Distance that the path has gone.
    travelled: f64,
    /// Contacts without a row, and perhaps some that have one by now; the one that may close first on top.
    waiting: BinaryHeap<Reverse<SeparatedContact>>,
    /// For each contact, whether it has a row.
    has_row: Vec<bool>,
    /// Those that have.
    rows: Vec<usize>,
}

/// A contact, and the distance that the path has to go before its gap can have closed.
#[derive(Debug, Clone, Copy, PartialEq)]
struct SeparatedContact {
    until: f64,
    contact: usize,
}

impl Eq for SeparatedContact {}

impl Ord for SeparatedContact {
    fn cmp(&self, other: &Self) -> std::cmp::Ordering {
        self.until.total_cmp(&other.until).then(self.contact.cmp(&other.contact))
    }
}

impl PartialOrd for SeparatedContact {
    fn partial_cmp(&self, other: &Self) -> Option<std::cmp::Ordering> {
        Some(self.cmp(other))
    }
}

impl Apart {
    pub fn new(posted: &Posted, length: f64) -> Self {
        let of_stage = |contact: &PostedContact| {
            let fastest = posted.stages.iter().map(|stage| stage.motion(contact).norm() * stage.load_scale);
            fastest.fold(0.0, f64::max)
        };
        let fastest = |contact: &PostedContact| {
            if contact.motion.is_none() { length } else { length.hypot(of_stage(contact)) }
        };
        let fastest = posted.contacts.iter().map(fastest).collect();
        let has_row = vec![false; posted.contacts.len()];
        let waiting = BinaryHeap::new();
        Self { length, fastest, travelled: 0.0, waiting, has_row, rows: Vec::new() }
    }

    /// Begins with no rows at all, where everything is now.
    pub fn begin(&mut self, posted: &Posted, loading: &PostedLoading, displacements: &[MeasuredVector]) {
        let waiting = |(contact, posted_contact)| {
            let gap = posted.frame(posted_contact, loading, displacements).gap;
            Reverse(self.waiting(contact, gap))
        };
        let waiting = posted.contacts.iter().enumerate().map(waiting).collect();
        self.waiting = waiting;
        self.has_row.fill(false);
        self.rows.clear();
    }

    fn waiting(&self, contact: usize, gap: f64) -> SeparatedContact {
        let way = gap.max(0.0) / self.fastest[contact];
        SeparatedContact { until: self.travelled + way - ROUNDING * (self.travelled + way), contact }
    }

    /// From now on these contacts have rows, and all others none.
    pub fn rows_are(&mut self, rows: &[usize]) {
        let before = std::mem::replace(&mut self.rows, rows.to_vec());
        before.iter().for_each(|contact| self.has_row[*contact] = false);
        rows.iter().for_each(|contact| self.has_row[*contact] = true);
        // They wait again; one that has never been taken off waits twice, and does no harm.
        let lost = before.iter().filter(|contact| !self.has_row[**contact]);
        self.waiting
            .extend(lost.map(|contact| Reverse(SeparatedContact { until: f64::NEG_INFINITY, contact: *contact })));
    }

    /// Takes into `errors` the gaps that are not open at the end of an increment of this length.
    pub fn judge(
        &mut self,
        posted: &Posted,
        loading: &PostedLoading,
        displacements: &[MeasuredVector],
        distance: f64,
        errors: &mut Errors,
    ) {
        if self.waiting.is_empty() {
            return;
        }
        self.travelled += distance;
        if !self.travelled.is_finite() {
            // An error without bound already, of `arc_length`.
            self.travelled = 0.0;
            self.waiting =
                self.waiting.drain().map(|Reverse(one)| Reverse(SeparatedContact { until: 0.0, ..one })).collect();
        }
        let mut looked_at = Vec::new();
        while self.waiting.peek().is_some_and(|Reverse(first)| first.until <= self.travelled) {
            let Some(Reverse(SeparatedContact { contact, .. })) = self.waiting.pop() else { break };
            if self.has_row[contact] {
                continue;
            }
            let gap = posted.frame(&posted.contacts[contact], loading, displacements).gap;
            errors.contact = worse(errors.contact, if gap > 0.0 { 0.0 } else { gap.abs() / self.length });
            looked_at.push(Reverse(self.waiting(contact, gap)));
        }
        self.waiting.extend(looked_at);
    }
}
