//! The seam between whoever runs a solve and the path tracer, so that tests can put a solver of their own in its place.

use crate::cancel::CancelFlag;
use crate::model::{InputErrors, JobRequest};
use crate::path::{Increment, Plan, Report, Scene, TracedPath};
use std::ops::ControlFlow;

pub trait Solver: Send + Sync + 'static {
    /// Checks a request as a whole and says what it needs.
    fn plan(&self, request: &JobRequest) -> Result<Plan, InputErrors>;

    /// Traces the path; every increment goes to `accept`, which breaks when nobody wants more.
    /// `None`: the solver ended without saying why, which is a defect, or `accept` broke.
    fn solve(
        &self,
        request: &JobRequest,
        cancel: CancelFlag,
        accept: &mut dyn FnMut(Increment) -> ControlFlow<()>,
    ) -> Result<Option<Report>, InputErrors>;
}

/// The solver of this crate.
#[derive(Debug, Clone, Copy, Default)]
pub struct PathSolver;

impl Solver for PathSolver {
    fn plan(&self, request: &JobRequest) -> Result<Plan, InputErrors> {
        Ok(Scene::new(request)?.plan().clone())
    }

    fn solve(
        &self,
        request: &JobRequest,
        cancel: CancelFlag,
        accept: &mut dyn FnMut(Increment) -> ControlFlow<()>,
    ) -> Result<Option<Report>, InputErrors> {
        let scene = Scene::new(request)?;
        let mut path = TracedPath::new(&scene, cancel);
        for increment in path.by_ref() {
            if accept(increment).is_break() {
                return Ok(None);
            }
        }
        Ok(path.report())
    }
}
