//! Signals that wake readers as soon as this process has stored something.
//!
//! A signal says that the store has changed. It carries the lines stored last, so that many readers of a job do not all read
//! the same rows. Changes of other processes are signalled, too, if the engine transmits `Announcements`; these may be
//! lost, so that readers also poll the store from time to time.

use crate::service::store::contract::announcements::Announcements;
use crate::service::store::{Lease, Line};
use std::collections::HashMap;
use std::sync::{Arc, Mutex, MutexGuard, PoisonError};
use std::time::Instant;
use tokio::sync::watch;
use uuid::Uuid;

#[derive(Debug)]
pub struct Signals {
    jobs: Mutex<HashMap<Uuid, Heard>>,
    queue: watch::Sender<u64>,
    /// Changes whenever anything does.
    any: watch::Sender<u64>,
    /// The announcements to other processes.
    announcements: Option<Arc<Announcements>>,
}

/// A change of a job.
#[derive(Debug, Clone, Default)]
pub struct Change {
    /// The stored lines, if nothing else was stored.
    pub latest: Option<Arc<Latest>>,
    /// When the lines were stored.
    pub at: Option<Instant>,
    /// The job has ended with this change.
    pub ended: bool,
}

/// The lines of a write.
#[derive(Debug)]
pub struct Latest {
    /// The index of the last line before them; `None` if they are the first of the job.
    after: Option<u64>,
    lines: Vec<Line>,
}

/// A job with subscribers.
#[derive(Debug, Default)]
struct Heard {
    changes: watch::Sender<Change>,
    holder: Option<Holder>,
}

/// The lease under which this process writes the lines of the job, one write after another.
#[derive(Debug)]
struct Holder {
    lease: Lease,
    last_index: Option<u64>,
}

impl Latest {
    /// The lines past the given index, possibly none; `None` if there may be lines in between.
    pub fn beyond(&self, index: Option<u64>) -> Option<&[Line]> {
        let known = self.lines.partition_point(|line| index.is_some_and(|index| line.index <= index));
        (index >= self.after).then(|| &self.lines[known..])
    }
}

impl Default for Signals {
    fn default() -> Self {
        Self { jobs: Mutex::default(), queue: watch::Sender::new(0), any: watch::Sender::new(0), announcements: None }
    }
}

impl Signals {
    /// Signals whose changes are announced to other processes.
    pub fn announced(announcements: Arc<Announcements>) -> Self {
        Self { announcements: Some(announcements), ..Self::default() }
    }

    pub fn job_changes(&self, id: Uuid) -> watch::Receiver<Change> {
        let mut jobs = self.jobs();
        // Jobs without subscribers are removed here, so that the map has only the jobs of open streams.
        jobs.retain(|_, heard| heard.changes.receiver_count() > 0);
        jobs.entry(id).or_default().changes.subscribe()
    }

    pub fn any_change(&self) -> watch::Receiver<u64> {
        self.any.subscribe()
    }

    fn something_changed(&self) {
        self.any.send_modify(|count| *count += 1);
    }

    pub fn queue_changes(&self) -> watch::Receiver<u64> {
        self.queue.subscribe()
    }

    pub fn job_changed(&self, id: Uuid) {
        self.announce_job(id);
        self.job_changed_elsewhere(id);
    }

    /// Another process has changed something of a job.
    pub fn job_changed_elsewhere(&self, id: Uuid) {
        self.something_changed();
        if let Some(heard) = self.jobs().get(&id) {
            heard.changes.send_replace(Change::default());
        }
    }

    /// A job was claimed, with lines up to the given index.
    pub fn job_claimed(&self, lease: &Lease, last_index: Option<u64>) {
        self.announce_job(lease.job);
        self.something_changed();
        if let Some(heard) = self.jobs().get_mut(&lease.job) {
            heard.holder = Some(Holder { lease: lease.clone(), last_index });
            heard.changes.send_replace(Change::default());
        }
    }

    /// Lines were stored.
    pub fn job_appended(&self, lease: &Lease, lines: &[Line]) {
        self.stored(lease, lines, false);
    }

    /// A job has ended, with these lines as its last.
    pub fn job_ended(&self, lease: &Lease, lines: &[Line]) {
        self.stored(lease, lines, true);
    }

    fn stored(&self, lease: &Lease, lines: &[Line], ended: bool) {
        self.announce_job(lease.job);
        self.something_changed();
        let mut jobs = self.jobs();
        let Some(heard) = jobs.get_mut(&lease.job) else { return };
        let Some(last) = lines.last() else {
            heard.changes.send_replace(Change { ended, ..Change::default() });
            return;
        };
        // Between two writes under the same lease nobody else writes; between writes under different leases others may have.
        let after = heard.holder.take().filter(|holder| holder.lease == *lease).map(|holder| holder.last_index);
        heard.holder = Some(Holder { lease: lease.clone(), last_index: Some(last.index) });
        let latest = after.map(|after| Arc::new(Latest { after, lines: lines.iter().map(Line::alone).collect() }));
        heard.changes.send_replace(Change { latest, at: Some(Instant::now()), ended });
    }

    pub fn queue_changed(&self) {
        if let Some(announcements) = &self.announcements {
            announcements.queue();
        }
        self.queue_changed_elsewhere();
    }

    /// Another process has put a job into the queue.
    pub fn queue_changed_elsewhere(&self) {
        self.queue.send_modify(|count| *count += 1);
        self.something_changed();
    }

    /// Anything may have changed in other processes.
    pub fn all_changed_elsewhere(&self) {
        for heard in self.jobs().values() {
            heard.changes.send_replace(Change::default());
        }
        self.queue_changed_elsewhere();
    }

    fn announce_job(&self, id: Uuid) {
        if let Some(announcements) = &self.announcements {
            announcements.job(id);
        }
    }

    fn jobs(&self) -> MutexGuard<'_, HashMap<Uuid, Heard>> {
        // The map is consistent wherever a thread that holds the lock could panic.
        self.jobs.lock().unwrap_or_else(PoisonError::into_inner)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn lease(attempt: u32) -> Lease {
        Lease { job: Uuid::nil(), worker: "worker".to_owned(), attempt }
    }

    fn lines(indices: &[u64]) -> Vec<Line> {
        indices.iter().map(|index| Line { index: *index, body: "{}".to_owned(), branch: None }).collect()
    }

    fn beyond(changes: &mut watch::Receiver<Change>, index: Option<u64>) -> Option<Vec<u64>> {
        let change = changes.borrow_and_update().clone();
        let lines = change.latest.as_ref()?.beyond(index)?;
        Some(lines.iter().map(|line| line.index).collect())
    }

    #[test]
    fn lines_come_along_where_none_can_be_missing() {
        let signals = Signals::default();
        let mut changes = signals.job_changes(Uuid::nil());
        signals.job_claimed(&lease(1), None);
        assert_eq!(beyond(&mut changes, None), None, "a claim brings no lines");
        signals.job_appended(&lease(1), &lines(&[0, 5]));
        assert_eq!(beyond(&mut changes, None), Some(vec![0, 5]));
        assert_eq!(beyond(&mut changes, Some(0)), Some(vec![5]));
        assert_eq!(beyond(&mut changes, Some(7)), Some(vec![]));
        signals.job_appended(&lease(1), &lines(&[10]));
        assert_eq!(beyond(&mut changes, Some(5)), Some(vec![10]));
        assert_eq!(beyond(&mut changes, Some(0)), None, "5 is missing");
        signals.job_changed(Uuid::nil());
        assert_eq!(beyond(&mut changes, Some(5)), None);
        signals.job_ended(&lease(1), &lines(&[11]));
        assert_eq!(beyond(&mut changes, Some(10)), Some(vec![11]), "the last ones come with the end");
        assert!(changes.borrow().ended);
        signals.job_ended(&lease(1), &[]);
        assert!(changes.borrow().ended && changes.borrow().latest.is_none());
    }

    #[test]
    fn another_lease_begins_anew() {
        let signals = Signals::default();
        let mut changes = signals.job_changes(Uuid::nil());
        // Claimed before the subscription: the lines before these are not known.
        signals.job_appended(&lease(1), &lines(&[3]));
        assert_eq!(beyond(&mut changes, Some(2)), None);
        signals.job_appended(&lease(1), &lines(&[4]));
        assert_eq!(beyond(&mut changes, Some(3)), Some(vec![4]));
        // Another process may have written 5 to 8.
        signals.job_appended(&lease(3), &lines(&[9]));
        assert_eq!(beyond(&mut changes, Some(4)), None);
        signals.job_claimed(&lease(4), Some(9));
        signals.job_appended(&lease(4), &lines(&[10]));
        assert_eq!(beyond(&mut changes, Some(9)), Some(vec![10]));
        // A late signal of an earlier write.
        signals.job_appended(&lease(3), &lines(&[9]));
        signals.job_appended(&lease(4), &lines(&[11]));
        assert_eq!(beyond(&mut changes, Some(10)), None);
    }
}
