//! Moves the work on large answers to other threads than those of the runtime: parsing, writing and hashing megabytes takes as
//! long as hundreds of small calls, which would have to wait.

use std::num::NonZeroUsize;
use std::panic::resume_unwind;
use std::sync::Arc;
use tokio::sync::Semaphore;
use tokio::task::spawn_blocking;

/// Work on at most this many bytes takes less than a millisecond, which is less than moving it to another thread costs.
const SMALL: usize = 64 << 10;

/// Runs work on large answers, at most as many pieces at a time as there are processors, so that their memory is bounded.
#[derive(Debug, Clone)]
pub struct Offload(Arc<Semaphore>);

impl Default for Offload {
    fn default() -> Self {
        let processors = std::thread::available_parallelism().map_or(1, NonZeroUsize::get);
        Self(Arc::new(Semaphore::new(processors)))
    }
}

impl Offload {
    /// Runs the work, on a blocking thread if it is about more than [`SMALL`] bytes. A panic is propagated.
    pub async fn run<T: Send + 'static>(&self, bytes: usize, work: impl FnOnce() -> T + Send + 'static) -> T {
        if bytes <= SMALL {
            return work();
        }
        // The semaphore is never closed.
        let turn = Arc::clone(&self.0).acquire_owned().await.ok();
        let made = spawn_blocking(move || {
            let _turn = turn;
            work()
        });
        match made.await.map_err(|ended| ended.try_into_panic()) {
            Ok(made) => made,
            Err(Ok(panic)) => resume_unwind(panic),
            // The runtime shuts down, and this call with it.
            Err(Err(_)) => std::future::pending().await,
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::thread;

    #[tokio::test]
    async fn large_work_is_done_on_another_thread() {
        let (offload, here) = (Offload::default(), thread::current().id());
        assert_eq!(offload.run(SMALL, || thread::current().id()).await, here);
        assert_ne!(offload.run(SMALL + 1, || thread::current().id()).await, here);
    }
}
