//! Making what can be large, away from the runtime's threads: reading, writing and hashing megabytes takes as long as hundreds of
//! small calls, which would wait for it.

use std::num::NonZeroUsize;
use std::panic::resume_unwind;
use std::sync::Arc;
use tokio::sync::Semaphore;
use tokio::task::spawn_blocking;

/// What is made of so many bytes takes less than a millisecond, and costs less where it is asked for than elsewhere.
const SMALL: usize = 64 << 10;

/// Turns at work on large answers: as many at a time as there are processors, so that what they take in memory is bounded.
#[derive(Debug, Clone)]
pub struct Aside(Arc<Semaphore>);

impl Default for Aside {
    fn default() -> Self {
        let processors = std::thread::available_parallelism().map_or(1, NonZeroUsize::get);
        Self(Arc::new(Semaphore::new(processors)))
    }
}

impl Aside {
    /// Does the work, on a thread of its own where it is about more than a few bytes. A panic is passed on.
    pub async fn make<T: Send + 'static>(&self, bytes: usize, work: impl FnOnce() -> T + Send + 'static) -> T {
        if bytes <= SMALL {
            return work();
        }
        // Nobody closes it.
        let turn = Arc::clone(&self.0).acquire_owned().await.ok();
        let made = spawn_blocking(move || {
            let _turn = turn;
            work()
        });
        match made.await.map_err(|ended| ended.try_into_panic()) {
            Ok(made) => made,
            Err(Ok(panic)) => resume_unwind(panic),
            // The runtime goes down, and this call with it.
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
        let (aside, here) = (Aside::default(), thread::current().id());
        assert_eq!(aside.make(SMALL, || thread::current().id()).await, here);
        assert_ne!(aside.make(SMALL + 1, || thread::current().id()).await, here);
    }
}
