//! The solves of this process and the flags that stop them.

use crate::cancel::CancelFlag;
use crate::store::Lease;
use std::collections::HashMap;
use std::sync::{Arc, Mutex, MutexGuard, PoisonError};
use uuid::Uuid;

/// By job and attempt: after a stall that cost a lease, two attempts at one job may overlap for a moment.
type Flags = HashMap<(Uuid, u32), CancelFlag>;

#[derive(Clone, Default)]
pub struct Running(Arc<Mutex<Flags>>);

/// Takes the job off the list when dropped.
pub struct Entry {
    running: Running,
    key: (Uuid, u32),
}

impl Running {
    pub fn enter(&self, lease: &Lease) -> (CancelFlag, Entry) {
        let (flag, key) = (CancelFlag::default(), (lease.job, lease.attempt));
        self.flags().insert(key, flag.clone());
        (flag, Entry { running: self.clone(), key })
    }

    pub fn cancel(&self, id: Uuid) {
        for ((job, _), flag) in self.flags().iter() {
            if *job == id {
                flag.cancel();
            }
        }
    }

    fn flags(&self) -> MutexGuard<'_, Flags> {
        self.0.lock().unwrap_or_else(PoisonError::into_inner)
    }
}

impl Drop for Entry {
    fn drop(&mut self) {
        self.running.flags().remove(&self.key);
    }
}
