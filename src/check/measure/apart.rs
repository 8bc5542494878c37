//! Checks the contacts without a row in an increment. These contacts are out of reach, so that their gaps must be open.
//!
//! Over a dimensionless distance `a`, a node moves by at most `ℓ a cos α` and an obstacle by at most `|d| σ a sin α`,
//! where `d` is the motion of the obstacle per load factor and `σ` the load scale. A gap therefore changes by at most
//! `a √(ℓ² + |d|² σ²)`, and an open gap needs no check until the path is long enough to close the gap.

use crate::check::measure::errors::{Errors, worse};
use crate::check::measure::numbers::MeasuredVector;
use crate::check::measure::posted::{Posted, PostedContact, PostedLoading};
use std::cmp::Reverse;
use std::collections::BinaryHeap;

/// Relative allowance for rounding in a bound.
const ROUNDING: f64 = 1e-9;

#[derive(Debug, Clone)]
pub(super) struct Apart {
    /// The displacement scale of the plan.
    length: f64,
    /// For each contact, the largest change of its gap per unit distance (length).
    fastest: Vec<f64>,
    /// The dimensionless length of the path so far.
    travelled: f64,
    /// A heap of the contacts without a row, and possibly of contacts that have a row by now; the contact that may
    /// close first is on top.
    waiting: BinaryHeap<Reverse<SeparatedContact>>,
    /// For each contact, whether it has a row.
    has_row: Vec<bool>,
    /// The contacts with a row.
    rows: Vec<usize>,
}

/// A contact, and the length of the path before which its gap cannot have closed.
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
            match contact.motion {
                None => length,
                // The farther from the pivot, the faster: such a gap is looked at after every increment.
                Some(place) if posted.moving[place].is_some() => f64::INFINITY,
                Some(_) => length.hypot(of_stage(contact)),
            }
        };
        let fastest = posted.contacts.iter().map(fastest).collect();
        let has_row = vec![false; posted.contacts.len()];
        let waiting = BinaryHeap::new();
        Self { length, fastest, travelled: 0.0, waiting, has_row, rows: Vec::new() }
    }

    /// Starts at the current state, without any rows.
    pub fn begin(&mut self, posted: &Posted, loading: &PostedLoading, displacements: &[MeasuredVector]) {
        let waiting = |(contact, posted_contact)| {
            let way = posted.clearance(posted_contact, loading, displacements);
            Reverse(self.waiting(contact, way))
        };
        let waiting = posted.contacts.iter().enumerate().map(waiting).collect();
        self.waiting = waiting;
        self.has_row.fill(false);
        self.rows.clear();
    }

    fn waiting(&self, contact: usize, clearance: f64) -> SeparatedContact {
        let way = clearance.max(0.0) / self.fastest[contact];
        SeparatedContact { until: self.travelled + way - ROUNDING * (self.travelled + way), contact }
    }

    /// Sets the contacts that have rows from now on.
    pub fn rows_are(&mut self, rows: &[usize]) {
        let before = std::mem::replace(&mut self.rows, rows.to_vec());
        before.iter().for_each(|contact| self.has_row[*contact] = false);
        rows.iter().for_each(|contact| self.has_row[*contact] = true);
        // Contacts that lost their row return to the heap. A contact that is still in the heap is then there twice,
        // which does no harm.
        let lost = before.iter().filter(|contact| !self.has_row[**contact]);
        self.waiting
            .extend(lost.map(|contact| Reverse(SeparatedContact { until: f64::NEG_INFINITY, contact: *contact })));
    }

    /// Adds to `errors` the gaps that are not open at the end of an increment of the given length.
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
            // The error of `arc_length` is already unbounded.
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
            let way = posted.clearance(&posted.contacts[contact], loading, displacements);
            looked_at.push(Reverse(self.waiting(contact, way)));
        }
        self.waiting.extend(looked_at);
    }
}
