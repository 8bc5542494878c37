//! The real solver, watched: what is computed and from where, and held at an increment.

use arcslip::check::judged::{JudgedCheckpoint, JudgedReport, Step};
use arcslip::model::{InputErrors, JobRequest};
use arcslip::resources::cancel::CancelFlag;
use arcslip::result::plan::Plan;
use arcslip::service::jobs::solving::solver::{Accept, Beginning, Place, ResumeError};
use arcslip::service::jobs::{PathSolver, Solver};
use std::ops::ControlFlow;
use std::sync::{Arc, Mutex, MutexGuard};
use std::time::Duration;

/// Long enough that the next increment is one at which a path is put down.
const UNTIL_PUT_DOWN: Duration = Duration::from_millis(100);

#[derive(Clone, Default)]
pub struct Watched {
    /// The solve waits after this increment, at which its path is put down, until it is cancelled.
    pub hold_after: Arc<Mutex<Option<u64>>>,
    seen: Arc<Mutex<Seen>>,
}

#[derive(Default)]
pub struct Seen {
    /// Solves begun at the start of their paths.
    pub begun: u64,
    /// Indices at which paths were taken up.
    pub resumed: Vec<u64>,
    /// Indices of all increments computed.
    pub computed: Vec<u64>,
}

impl Watched {
    pub fn holding_after(index: u64) -> Self {
        Self { hold_after: Arc::new(Mutex::new(Some(index))), ..Self::default() }
    }

    pub fn let_go(&self) {
        *self.hold_after.lock().expect("a lock") = None;
        *self.seen() = Seen::default();
    }

    /// Solves begun, and paths taken up.
    pub fn starts(&self) -> (u64, usize) {
        let seen = self.seen();
        (seen.begun, seen.resumed.len())
    }

    pub fn seen(&self) -> MutexGuard<'_, Seen> {
        self.seen.lock().expect("a lock")
    }

    fn watch(&self, step: Step, place: &dyn Place, cancel: &CancelFlag, accept: Accept<'_>) -> ControlFlow<()> {
        let index = step.index;
        self.seen().computed.push(index);
        let held = || self.hold_after.lock().expect("a lock").is_some_and(|hold| index >= hold);
        if !held() {
            return accept(step, place);
        }
        std::thread::sleep(UNTIL_PUT_DOWN);
        accept(step, place)?;
        while held() && !cancel.is_cancelled() {
            std::thread::sleep(Duration::from_millis(1));
        }
        ControlFlow::Continue(())
    }
}

impl Solver for Watched {
    fn plan(&self, request: &JobRequest) -> Result<Plan, InputErrors> {
        PathSolver.plan(request)
    }

    fn check_beginning(&self, request: &JobRequest, beginning: Beginning) -> Result<(), InputErrors> {
        PathSolver.check_beginning(request, beginning)
    }

    fn solve(
        &self,
        request: &JobRequest,
        beginning: Option<Beginning>,
        cancel: CancelFlag,
        accept: Accept<'_>,
    ) -> Result<Option<JudgedReport>, InputErrors> {
        self.seen().begun += 1;
        let flag = cancel.clone();
        PathSolver.solve(request, beginning, cancel, &mut |step, place| self.watch(step, place, &flag, &mut *accept))
    }

    fn resume(
        &self,
        request: &JobRequest,
        checkpoint: JudgedCheckpoint,
        cancel: CancelFlag,
        accept: Accept<'_>,
    ) -> Result<Option<JudgedReport>, ResumeError> {
        let index = checkpoint.path.index();
        let flag = cancel.clone();
        let answer = PathSolver
            .resume(request, checkpoint, cancel, &mut |step, place| self.watch(step, place, &flag, &mut *accept));
        if answer.is_ok() {
            self.seen().resumed.push(index);
        }
        answer
    }
}
