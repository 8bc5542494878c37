//! The solves of this process and the flags that stop them.

use crate::cancel::CancelFlag;
use std::collections::HashMap;
use std::sync::{Arc, Mutex, MutexGuard, PoisonError};
use uuid::Uuid;

#[derive(Clone, Default)]
pub struct Running(Arc<Mutex<HashMap<Uuid, CancelFlag>>>);

/// Takes the job off the list when dropped.
pub struct Entry {
    running: Running,
    id: Uuid,
}

impl Running {
    pub fn enter(&self, id: Uuid) -> (CancelFlag, Entry) {
        let flag = CancelFlag::default();
        self.flags().insert(id, flag.clone());
        (flag, Entry { running: self.clone(), id })
    }

    pub fn cancel(&self, id: Uuid) {
        if let Some(flag) = self.flags().get(&id) {
            flag.cancel();
        }
    }

    fn flags(&self) -> MutexGuard<'_, HashMap<Uuid, CancelFlag>> {
        self.0.lock().unwrap_or_else(PoisonError::into_inner)
    }
}

impl Drop for Entry {
    fn drop(&mut self) {
        self.running.flags().remove(&self.id);
    }
}
