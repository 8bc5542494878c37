//! The solves that run in this process, and the flags that cancel them.

use crate::resources::budget::Budget;
use crate::resources::cancel::CancelFlag;
use crate::service::store::Lease;
use std::collections::HashMap;
use std::sync::{Arc, Mutex, MutexGuard, PoisonError};
use uuid::Uuid;

/// Solves by job and attempt: after a stall in which a lease was lost, two attempts at a job may overlap for a moment.
type Flags = HashMap<(Uuid, u32), Solving>;

struct Solving {
    cancel: CancelFlag,
    /// The budget of its thread, once the thread has started.
    budget: Option<Budget>,
}

#[derive(Clone, Default)]
pub struct Running(Arc<Mutex<Flags>>);

/// Removes the solve from the list on drop.
pub struct Entry {
    running: Running,
    key: (Uuid, u32),
}

impl Running {
    pub fn enter(&self, lease: &Lease) -> (CancelFlag, Entry) {
        let (flag, key) = (CancelFlag::default(), (lease.job, lease.attempt));
        self.flags().insert(key, Solving { cancel: flag.clone(), budget: None });
        (flag, Entry { running: self.clone(), key })
    }

    pub fn cancel(&self, id: Uuid) {
        self.flags().iter().filter(|((job, _), _)| *job == id).for_each(|(_, solving)| solving.cancel.cancel());
    }

    /// Stores the budget of a solve.
    pub fn begun(&self, lease: &Lease, budget: &Budget) {
        if let Some(solving) = self.flags().get_mut(&(lease.job, lease.attempt)) {
            solving.budget = Some(budget.clone());
        }
    }

    /// Whether a solve of this process is locating a bifurcation point of the job at the moment.
    pub fn is_locating_bifurcation(&self, id: Uuid) -> bool {
        let is_locating = |solving: &Solving| solving.budget.as_ref().is_some_and(Budget::is_locating_bifurcation);
        self.flags().iter().any(|((job, _), solving)| *job == id && is_locating(solving))
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
