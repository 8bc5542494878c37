//! The seam between whoever runs a solve and the path tracer, so that tests can put a solver of their own in its place.

use crate::cancel::CancelFlag;
use crate::judged::{JudgedCheckpoint, JudgedCheckpointError, JudgedIncrement, JudgedPath, JudgedReport};
use crate::model::{InputError, InputErrors, JobRequest, StudyRequest};
use crate::path::{CheckpointError, Plan, Scene};
use crate::studies::{self, Run};
use std::ops::ControlFlow;

/// Where a path begins that follows a direction of another.
#[derive(Debug, Clone)]
pub struct Beginning {
    pub checkpoint: JudgedCheckpoint,
    pub direction: usize,
    /// The event of its first increment.
    pub event: String,
}

/// A point whose directions are listed.
#[derive(Debug, Clone)]
pub struct Junction {
    pub checkpoint: JudgedCheckpoint,
    /// Which of the directions can be followed.
    pub open: Vec<bool>,
}

/// Takes an increment and, where directions are listed with it, what makes its junction.
pub type Accept<'a> = &'a mut dyn FnMut(JudgedIncrement, &dyn Fn() -> Option<Junction>) -> ControlFlow<()>;

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
    ) -> Result<Option<JudgedReport>, InputErrors>;

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
        begin(request, &Scene::new(request)?, Some(beginning), CancelFlag::default()).map(|_| ())
    }

    fn solve(
        &self,
        request: &JobRequest,
        beginning: Option<Beginning>,
        cancel: CancelFlag,
        accept: Accept<'_>,
    ) -> Result<Option<JudgedReport>, InputErrors> {
        let scene = Scene::new(request)?;
        let mut path = begin(request, &scene, beginning, cancel)?;
        let mut off_measure = false;
        while let Some(increment) = path.next() {
            // The first one only: a path that is off once may be off at every point after. The report counts them.
            if path.is_off_measure() && !std::mem::replace(&mut off_measure, true) {
                warn_off_measure(&increment);
            }
            if accept(increment, &|| junction(&path)).is_break() {
                return Ok(None);
            }
        }
        Ok(path.report())
    }
}

fn warn_off_measure(judged: &JudgedIncrement) {
    let errors = serde_json::to_string(&judged.measure).unwrap_or_default();
    tracing::warn!(increment = judged.increment.index, %errors, "an accepted increment is off the measure");
}

fn junction(path: &JudgedPath<'_>) -> Option<Junction> {
    let open = path.open_directions();
    if open.is_empty() { None } else { Some(Junction { checkpoint: path.checkpoint()?, open }) }
}

fn begin<'a>(
    request: &JobRequest,
    scene: &'a Scene,
    beginning: Option<Beginning>,
    cancel: CancelFlag,
) -> Result<JudgedPath<'a>, InputErrors> {
    let Some(Beginning { checkpoint, direction, event }) = beginning else {
        return Ok(JudgedPath::new(request, scene, cancel));
    };
    JudgedPath::follow(request, scene, checkpoint, direction, event, cancel).map_err(|error| {
        let pointer = match &error {
            JudgedCheckpointError::History(_) => "/increment",
            JudgedCheckpointError::Path(error) => match error {
                CheckpointError::Version { .. }
                | CheckpointError::OtherModel { .. }
                | CheckpointError::NothingListed => "/increment",
                CheckpointError::NoSuchDirection { .. }
                | CheckpointError::Mechanism { .. }
                | CheckpointError::StageEnds { .. } => "/direction",
            },
        };
        InputErrors(vec![InputError::new(pointer, error.to_string())])
    })
}
