//! The seam between whoever runs a solve and the path tracer, so that tests can put a solver of their own in its place.

use crate::cancel::CancelFlag;
use crate::model::{InputError, InputErrors, JobRequest, StudyRequest};
use crate::path::{Checkpoint, CheckpointError, Increment, Path, Plan, Report, Scene, TracedPath};
use crate::studies::{self, Run};
use std::ops::ControlFlow;

/// Where a path begins that follows a direction of another.
#[derive(Debug, Clone)]
pub struct Beginning {
    pub checkpoint: Checkpoint,
    pub direction: usize,
    /// The event of its first increment.
    pub event: String,
}

/// A point whose directions are listed.
#[derive(Debug, Clone)]
pub struct Junction {
    pub checkpoint: Checkpoint,
    /// Which of the directions can be followed.
    pub open: Vec<bool>,
}

/// Takes an increment and, where directions are listed with it, what makes its junction.
pub type Accept<'a> = &'a mut dyn FnMut(Increment, &dyn Fn() -> Option<Junction>) -> ControlFlow<()>;

pub trait Solver: Send + Sync + 'static {
    /// Checks a request as a whole and says what it needs.
    fn plan(&self, request: &JobRequest) -> Result<Plan, InputErrors>;

    /// Refuses a beginning from which there is no path; pointers are those of a [`crate::model::FollowRequest`].
    fn check_beginning(&self, request: &JobRequest, beginning: Beginning) -> Result<(), InputErrors>;

    /// Traces the path, from its start or from a beginning; every increment goes to `accept`, which breaks when nobody wants more.
    /// `None`: the solver ended without saying why, which is a defect, or `accept` broke.
    fn solve(
        &self,
        request: &JobRequest,
        beginning: Option<Beginning>,
        cancel: CancelFlag,
        accept: Accept<'_>,
    ) -> Result<Option<Report>, InputErrors>;

    /// Checks a study and says what it is going to do.
    fn plan_study(&self, request: &StudyRequest) -> Result<studies::Plan, InputErrors> {
        studies::plan(request)
    }

    /// Runs a study, `done` being its first runs; see [`studies::run`].
    fn study(
        &self,
        request: &StudyRequest,
        done: Vec<Run>,
        cancel: &CancelFlag,
        accept: &mut dyn FnMut(&Run) -> ControlFlow<()>,
    ) -> Result<Option<studies::Report>, InputErrors> {
        studies::run(request, done, cancel, accept)
    }
}

/// The solver of this crate.
#[derive(Debug, Clone, Copy, Default)]
pub struct PathSolver;

impl Solver for PathSolver {
    fn plan(&self, request: &JobRequest) -> Result<Plan, InputErrors> {
        Ok(Scene::new(request)?.plan().clone())
    }

    fn check_beginning(&self, request: &JobRequest, beginning: Beginning) -> Result<(), InputErrors> {
        begin(&Scene::new(request)?, Some(beginning), CancelFlag::default()).map(|_| ())
    }

    fn solve(
        &self,
        request: &JobRequest,
        beginning: Option<Beginning>,
        cancel: CancelFlag,
        accept: Accept<'_>,
    ) -> Result<Option<Report>, InputErrors> {
        let scene = Scene::new(request)?;
        let mut path = begin(&scene, beginning, cancel)?;
        while let Some(increment) = path.next() {
            if accept(increment, &|| junction(&path)).is_break() {
                return Ok(None);
            }
        }
        Ok(path.report())
    }
}

fn junction(path: &TracedPath<'_>) -> Option<Junction> {
    let TracedPath::Exact(path) = path else { return None };
    let listed = path.listed_directions();
    let open = || (0..listed).map(|direction| path.can_be_followed(direction)).collect();
    (listed > 0).then(|| Junction { checkpoint: path.checkpoint(), open: open() })
}

fn begin(scene: &Scene, beginning: Option<Beginning>, cancel: CancelFlag) -> Result<TracedPath<'_>, InputErrors> {
    let Some(Beginning { checkpoint, direction, event }) = beginning else {
        return Ok(TracedPath::new(scene, cancel));
    };
    let followed = Path::follow(scene, checkpoint, direction, event, cancel);
    followed.map(|path| TracedPath::Exact(Box::new(path))).map_err(|error| {
        let pointer = match error {
            CheckpointError::Version { .. } | CheckpointError::OtherModel { .. } | CheckpointError::NothingListed => {
                "/increment"
            }
            CheckpointError::NoSuchDirection { .. }
            | CheckpointError::Mechanism { .. }
            | CheckpointError::StageEnds { .. } => "/direction",
        };
        InputErrors(vec![InputError::new(pointer, error.to_string())])
    })
}
