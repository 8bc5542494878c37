//! Checks of requests before anything is queued: on blocking threads, short checks apart from long ones, with fair turns
//! between clients, within a time limit, and only while the client waits for the answer.

use crate::model::{InputError, InputErrors};
use crate::resources::budget::{Breach, Budget};
use crate::resources::cancel::CancelFlag;
use crate::service::jobs::configuration::limits::Limits;
use crate::service::jobs::queue::error::JobsError;
use crate::service::jobs::queue::fair_semaphore::{Client, FairSemaphore, Permit};
use crate::service::jobs::solving::solver::Solver;
use std::num::NonZeroUsize;
use std::sync::Arc;
use std::time::{Duration, Instant};
use tokio::time::timeout;

/// A check that takes longer than this is a long one; so is the check of a body with more bytes than this.
const SHORT_TIME: Duration = Duration::from_millis(200);
const SHORT_BYTES: usize = 256 << 10;

/// The text of a request, and the room that it takes in memory.
pub struct Posted {
    pub text: Vec<u8>,
    pub room: Room,
    /// The client that sent the request.
    pub client: Client,
}

/// Reserved memory, released on drop.
pub type Room = Option<Box<dyn Send>>;

impl From<Vec<u8>> for Posted {
    fn from(text: Vec<u8>) -> Self {
        Self { text, room: None, client: Client::default() }
    }
}

/// The permit and the room of a checked request, held until the request is stored, so that the number of large checked
/// requests in memory is bounded.
pub struct Held {
    room: Room,
    _permit: Permit,
}

impl Held {
    /// Releases the permit, for small requests: others may be checked while this one is stored. The room stays reserved.
    pub fn leave(self) -> Room {
        self.room
    }
}

/// Runs checks. Short and long checks have permits of their own, so that long checks do not delay short ones.
#[derive(Clone)]
pub struct Checks {
    solver: Arc<dyn Solver>,
    limits: Limits,
    short: FairSemaphore,
    long: FairSemaphore,
}

/// What a check needs and what limits it.
pub struct CheckContext<'a> {
    pub solver: &'a dyn Solver,
    pub limits: &'a Limits,
    /// Set when the client no longer waits for the answer.
    pub cancel: &'a CancelFlag,
    /// When an interruptible check should be interrupted.
    pub until: Option<Instant>,
}

impl CheckContext<'_> {
    /// # Errors
    /// The client no longer waits for the answer.
    pub fn go_on(&self) -> Result<(), JobsError> {
        if self.cancel.is_cancelled() { Err(JobsError::Abandoned) } else { Ok(()) }
    }

    pub fn is_over_time(&self) -> bool {
        self.until.is_some_and(|until| Instant::now() >= until)
    }
}

/// A check that can be interrupted and resumed.
pub trait Check: Send + 'static {
    type Checked: Send + 'static;

    /// Runs the check; `None` if it was interrupted, in which case the next call resumes it.
    fn go_on(&mut self, context: &CheckContext<'_>) -> Result<Option<Self::Checked>, JobsError>;
}

/// A check that runs in one piece.
pub struct Whole<F>(Option<F>);

impl<F> Whole<F> {
    pub fn of<T>(check: F) -> Self
    where
        F: FnOnce(&CheckContext<'_>) -> Result<T, JobsError>,
    {
        Self(Some(check))
    }
}

impl<T: Send + 'static, F: FnOnce(&CheckContext<'_>) -> Result<T, JobsError> + Send + 'static> Check for Whole<F> {
    type Checked = T;

    fn go_on(&mut self, context: &CheckContext<'_>) -> Result<Option<T>, JobsError> {
        self.0.take().map(|check| check(context)).transpose()
    }
}

/// Cancels a check when its call ends for any reason.
struct StopOnDrop(CancelFlag);

impl Drop for StopOnDrop {
    fn drop(&mut self) {
        self.0.cancel();
    }
}

impl Checks {
    pub fn new(solver: Arc<dyn Solver>, limits: Limits) -> Self {
        let processors = std::thread::available_parallelism().map_or(1, NonZeroUsize::get);
        Self { solver, limits, short: FairSemaphore::of(2 * processors), long: FairSemaphore::of(processors) }
    }

    /// Reads and checks a posted request on a blocking thread. A check that is dropped is cancelled; its permit is released
    /// when its thread has ended.
    ///
    /// # Errors
    /// Those of the check, and its time limit.
    pub(crate) async fn run<C: Check>(
        &self,
        posted: Posted,
        begin: impl FnOnce(Vec<u8>) -> C,
    ) -> Result<(C::Checked, Held), JobsError> {
        let Posted { text, mut room, client } = posted;
        let cancel = CancelFlag::default();
        let _stop = StopOnDrop(cancel.clone());
        let mut is_short = text.len() <= SHORT_BYTES;
        let most = self.limits.check_time;
        let mut left = most;
        let mut check = begin(text);
        loop {
            let semaphore = if is_short { &self.short } else { &self.long };
            let permit = semaphore.acquire(&client).await;
            let (solver, limits, cancel) = (Arc::clone(&self.solver), self.limits, cancel.clone());
            let began = Instant::now();
            let part = tokio::task::spawn_blocking(move || {
                let until = is_short.then(|| Instant::now() + SHORT_TIME);
                let context = CheckContext { solver: solver.as_ref(), limits: &limits, cancel: &cancel, until };
                let budget = Budget::new(cancel.clone(), limits.bounds);
                let found = budget.during(|| check.go_on(&context)).unwrap_or_else(|breach| Err(ended(breach)));
                (found, check, Held { room, _permit: permit })
            });
            let late = |_| JobsError::CheckTime(most);
            let (found, rest, held) = timeout(left, part).await.map_err(late)??;
            if let Some(checked) = found? {
                return Ok((checked, held));
            }
            left = left.saturating_sub(began.elapsed());
            is_short = false;
            check = rest;
            room = held.room;
        }
    }
}

/// The error of a check that was cancelled or would have exceeded a bound.
fn ended(breach: Breach) -> JobsError {
    match breach {
        Breach::Cancelled => JobsError::Abandoned,
        Breach::Memory { .. } | Breach::FactorEntries { .. } | Breach::FactorWork { .. } => {
            JobsError::Input(InputErrors(vec![InputError::new("/model", breach.to_string())]))
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::service::jobs::PathSolver;
    use std::sync::mpsc;

    fn checks(check_time: Duration) -> Checks {
        Checks::new(Arc::new(PathSolver), Limits { check_time, ..Limits::default() })
    }

    fn posted(client: &str) -> Posted {
        Posted { client: Client(client.to_owned()), ..Posted::from(Vec::new()) }
    }

    /// A check that runs until it is cancelled.
    struct Endless(mpsc::Sender<()>);

    impl Check for Endless {
        type Checked = ();

        fn go_on(&mut self, context: &CheckContext<'_>) -> Result<Option<()>, JobsError> {
            while !context.is_over_time() {
                if context.go_on().is_err() {
                    let _ = self.0.send(());
                }
                context.go_on()?;
                std::thread::sleep(Duration::from_millis(1));
            }
            Ok(None)
        }
    }

    #[tokio::test(flavor = "multi_thread")]
    async fn endless_checks_hold_up_nobody_and_end_with_their_calls() {
        let checks = checks(Duration::from_secs(3600));
        let (told, stopped) = mpsc::channel();
        let many = 3 * std::thread::available_parallelism().map_or(1, NonZeroUsize::get);
        let mut calls = Vec::new();
        for _ in 0..many {
            let (checks, told) = (checks.clone(), told.clone());
            calls.push(tokio::spawn(async move { checks.run(posted("one"), |_| Endless(told)).await.map(|_| ()) }));
        }
        tokio::time::sleep(2 * SHORT_TIME).await;
        for client in ["one", "another"] {
            let (seven, _held) = checks.run(posted(client), |_| Whole::of(|_| Ok(7))).await.expect("checked");
            assert_eq!(seven, 7);
        }
        // A long check of another client gets a permit, too.
        let mut parts = 0;
        struct TwoParts(u32);
        impl Check for TwoParts {
            type Checked = u32;

            fn go_on(&mut self, _: &CheckContext<'_>) -> Result<Option<u32>, JobsError> {
                self.0 += 1;
                Ok((self.0 == 2).then_some(self.0))
            }
        }
        parts += checks.run(posted("another"), |_| TwoParts(0)).await.expect("checked").0;
        assert_eq!(parts, 2);
        calls.iter().for_each(tokio::task::JoinHandle::abort);
        stopped.recv_timeout(Duration::from_secs(600)).expect("it is stopped");
    }

    #[tokio::test(flavor = "multi_thread")]
    async fn a_check_past_its_time_is_stopped_and_says_so() {
        let checks = checks(Duration::from_millis(300));
        let (told, stopped) = mpsc::channel();
        let ended = checks.run(posted("one"), |_| Endless(told)).await;
        assert!(matches!(ended, Err(JobsError::CheckTime(most)) if most == Duration::from_millis(300)));
        // On a busy machine the time may be over before the check has begun: then it is dropped, not stopped.
        let is_stopped = stopped.recv_timeout(Duration::from_secs(600));
        assert_ne!(is_stopped, Err(mpsc::RecvTimeoutError::Timeout), "the check goes on");
    }
}
