//! How requests are read and checked before anything is queued: on threads of their own, short ones beside long ones, in turn
//! between clients, within a bound of time, and for no longer than somebody waits for the answer.

use crate::model::{InputError, InputErrors};
use crate::resources::budget::{Breach, Budget};
use crate::resources::cancel::CancelFlag;
use crate::service::jobs::configuration::limits::Limits;
use crate::service::jobs::queue::error::JobsError;
use crate::service::jobs::queue::lanes::{Client, Lane, Place};
use crate::service::jobs::solving::solver::Solver;
use std::num::NonZeroUsize;
use std::sync::Arc;
use std::time::{Duration, Instant};
use tokio::time::timeout;

/// A check that has not come to its end in this time is a long one; so is one of a larger body.
const SHORT_TIME: Duration = Duration::from_millis(200);
const SHORT_BYTES: usize = 256 << 10;

/// A request as it came, and what is held for as long as it is: the room that it takes.
pub struct Posted {
    pub text: Vec<u8>,
    pub room: Room,
    /// Who sent it.
    pub client: Client,
}

/// Given back when it is dropped.
pub type Room = Option<Box<dyn Send>>;

impl From<Vec<u8>> for Posted {
    fn from(text: Vec<u8>) -> Self {
        Self { text, room: None, client: Client::default() }
    }
}

/// What is held until what was checked is stored: where that is large, no more of it is made meanwhile than there are places.
pub struct Held {
    room: Room,
    _place: Place,
}

impl Held {
    /// For what is small: others may be checked while it is stored. The room of what was posted stays.
    pub fn leave(self) -> Room {
        self.room
    }
}

/// Places at which requests are checked. Short checks find one however many long ones there are.
#[derive(Clone)]
pub struct Checks {
    solver: Arc<dyn Solver>,
    limits: Limits,
    short: Lane,
    long: Lane,
}

/// What a check may use.
pub struct Desk<'a> {
    pub solver: &'a dyn Solver,
    pub limits: &'a Limits,
    /// Set when nobody waits for the answer any more.
    pub cancel: &'a CancelFlag,
    /// When a check that can be interrupted is to be.
    pub until: Option<Instant>,
}

impl Desk<'_> {
    /// # Errors
    /// Nobody waits for the answer any more.
    pub fn go_on(&self) -> Result<(), JobsError> {
        if self.cancel.is_cancelled() { Err(JobsError::Abandoned) } else { Ok(()) }
    }

    pub fn is_over_time(&self) -> bool {
        self.until.is_some_and(|until| Instant::now() >= until)
    }
}

/// A check that can be interrupted.
pub trait Check: Send + 'static {
    type Checked: Send + 'static;

    /// `None`: its time was over before its end; the next call goes on.
    fn go_on(&mut self, desk: &Desk<'_>) -> Result<Option<Self::Checked>, JobsError>;
}

/// A check in one piece.
pub struct Whole<F>(Option<F>);

impl<F> Whole<F> {
    pub fn of<T>(check: F) -> Self
    where
        F: FnOnce(&Desk<'_>) -> Result<T, JobsError>,
    {
        Self(Some(check))
    }
}

impl<T: Send + 'static, F: FnOnce(&Desk<'_>) -> Result<T, JobsError> + Send + 'static> Check for Whole<F> {
    type Checked = T;

    fn go_on(&mut self, desk: &Desk<'_>) -> Result<Option<T>, JobsError> {
        self.0.take().map(|check| check(desk)).transpose()
    }
}

/// Stops what is being checked when the call that asked for it ends, whatever ends it.
struct StopOnDrop(CancelFlag);

impl Drop for StopOnDrop {
    fn drop(&mut self) {
        self.0.cancel();
    }
}

impl Checks {
    pub fn new(solver: Arc<dyn Solver>, limits: Limits) -> Self {
        let processors = std::thread::available_parallelism().map_or(1, NonZeroUsize::get);
        Self { solver, limits, short: Lane::of(2 * processors), long: Lane::of(processors) }
    }

    /// Reads and checks what was posted, on a thread that is not the runtime's. A check that is dropped is stopped; its place
    /// is free when its thread has come to its end.
    ///
    /// # Errors
    /// Those of the check, and the bound of its time.
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
            let lane = if is_short { &self.short } else { &self.long };
            let place = lane.place(&client).await;
            let (solver, limits, cancel) = (Arc::clone(&self.solver), self.limits, cancel.clone());
            let began = Instant::now();
            let part = tokio::task::spawn_blocking(move || {
                let until = is_short.then(|| Instant::now() + SHORT_TIME);
                let desk = Desk { solver: solver.as_ref(), limits: &limits, cancel: &cancel, until };
                let budget = Budget::new(cancel.clone(), limits.bounds);
                let found = budget.during(|| check.go_on(&desk)).unwrap_or_else(|breach| Err(ended(breach)));
                (found, check, Held { room, _place: place })
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

/// Why a check was ended from outside, or would have gone past a bound.
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

    /// Lasts until it is stopped.
    struct Endless(mpsc::Sender<()>);

    impl Check for Endless {
        type Checked = ();

        fn go_on(&mut self, desk: &Desk<'_>) -> Result<Option<()>, JobsError> {
            while !desk.is_over_time() {
                if desk.go_on().is_err() {
                    let _ = self.0.send(());
                }
                desk.go_on()?;
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
        // A long one of somebody else finds a place, too.
        let mut parts = 0;
        struct TwoParts(u32);
        impl Check for TwoParts {
            type Checked = u32;

            fn go_on(&mut self, _: &Desk<'_>) -> Result<Option<u32>, JobsError> {
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
        stopped.recv_timeout(Duration::from_secs(600)).expect("it is stopped");
    }
}
