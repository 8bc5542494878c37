//! Wakes readers as soon as something was stored in this process.
//!
//! A signal only says "look again"; what is true is in the store. Changes made by other processes give no signal, so
//! whoever waits also looks from time to time.

use std::collections::HashMap;
use std::sync::{Mutex, MutexGuard, PoisonError};
use tokio::sync::watch;
use uuid::Uuid;

#[derive(Debug)]
pub struct Signals {
    jobs: Mutex<HashMap<Uuid, watch::Sender<u64>>>,
    queue: watch::Sender<u64>,
}

impl Default for Signals {
    fn default() -> Self {
        Self { jobs: Mutex::default(), queue: watch::Sender::new(0) }
    }
}

impl Signals {
    pub fn job_changes(&self, id: Uuid) -> watch::Receiver<u64> {
        let mut jobs = self.jobs();
        // A job nobody listens to any more is forgotten here, so that the map stays as small as the open streams.
        jobs.retain(|_, sender| sender.receiver_count() > 0);
        jobs.entry(id).or_insert_with(|| watch::Sender::new(0)).subscribe()
    }

    pub fn queue_changes(&self) -> watch::Receiver<u64> {
        self.queue.subscribe()
    }

    pub fn job_changed(&self, id: Uuid) {
        if let Some(sender) = self.jobs().get(&id) {
            sender.send_modify(|count| *count += 1);
        }
    }

    pub fn queue_changed(&self) {
        self.queue.send_modify(|count| *count += 1);
    }

    fn jobs(&self) -> MutexGuard<'_, HashMap<Uuid, watch::Sender<u64>>> {
        // The map is whole at every point where its holder could panic.
        self.jobs.lock().unwrap_or_else(PoisonError::into_inner)
    }
}
