//! The interface between the workers and the path tracer, so that tests can substitute another solver.

use crate::check::judged::{JudgedCheckpoint, JudgedCheckpointError, JudgedIncrement, JudgedPath, JudgedReport, Step};
use crate::continuation::path::checkpoint::CheckpointError;
use crate::continuation::scene::Scene;
use crate::model::{InputError, InputErrors, JobRequest, ParameterCurve, StudyRequest};
use crate::resources::cancel::CancelFlag;
use crate::result::plan::Plan;
use crate::studies::critical_curves::{self, CurveRow, CurveSummary};
use crate::studies::error_against_time::{self, StudyRun};
use std::ops::ControlFlow;

/// The beginning of a path that follows a direction of another path.
#[derive(Debug, Clone)]
pub struct Beginning {
    /// A checkpoint of the other path at this increment or before it.
    pub checkpoint: JudgedCheckpoint,
    pub increment: u64,
    pub direction: usize,
    /// The event of the first increment of the new path.
    pub event: String,
}

/// A path at the end of a step.
pub trait Place {
    /// The directions listed here that are listed for the first time: see [`crate::check::judged::Alternatives`].
    fn alternatives(&self) -> &[u64];

    /// A checkpoint of the path here; `None` for a method without checkpoints.
    fn checkpoint(&self) -> Option<JudgedCheckpoint>;
}

/// Receives a step of the path and the point to which it led.
pub type Accept<'a> = &'a mut dyn FnMut(Step, &dyn Place) -> ControlFlow<()>;

/// Why a path was not resumed.
#[derive(Debug, thiserror::Error)]
pub enum ResumeError {
    #[error(transparent)]
    Input(#[from] InputErrors),
    /// The checkpoint is of another version of this program; the path can be traced from its start.
    #[error(transparent)]
    Checkpoint(#[from] JudgedCheckpointError),
}

/// The scene of the previous request, if there is one.
#[derive(Debug, Default)]
pub struct Before(Option<Scene>);

pub trait Solver: Send + Sync + 'static {
    /// Checks a request and answers its plan.
    fn plan(&self, request: &JobRequest) -> Result<Plan, InputErrors>;

    /// As [`plan`](Self::plan), for a request that may differ from the previous one in numbers alone.
    fn plan_after(&self, before: &mut Before, request: &JobRequest) -> Result<Plan, InputErrors> {
        let _ = before;
        self.plan(request)
    }

    /// Refuses a beginning from which no path starts; the pointers in the errors are those of a [`crate::model::FollowRequest`].
    fn check_beginning(&self, request: &JobRequest, beginning: Beginning) -> Result<(), InputErrors>;

    /// Traces the path, from its start or from a beginning; every step is passed to `accept`, which breaks to end the solve.
    /// `None`: `accept` broke, or the solver ended without a report, which is a defect.
    fn solve(
        &self,
        request: &JobRequest,
        beginning: Option<Beginning>,
        cancel: CancelFlag,
        accept: Accept<'_>,
    ) -> Result<Option<JudgedReport>, InputErrors>;

    /// Resumes a path from a checkpoint; otherwise as [`solve`](Self::solve).
    fn resume(
        &self,
        request: &JobRequest,
        checkpoint: JudgedCheckpoint,
        cancel: CancelFlag,
        accept: Accept<'_>,
    ) -> Result<Option<JudgedReport>, ResumeError>;

    /// Checks a study and answers its plan.
    fn plan_study(&self, request: &StudyRequest) -> Result<error_against_time::StudyPlan, InputErrors> {
        error_against_time::plan(request)
    }

    /// Runs a study; `done` are its runs so far, see `error_against_time::run`.
    fn study(
        &self,
        request: &StudyRequest,
        done: Vec<StudyRun>,
        cancel: &CancelFlag,
        accept: &mut dyn FnMut(&StudyRun) -> ControlFlow<()>,
    ) -> Result<Option<error_against_time::StudyReport>, InputErrors> {
        error_against_time::run(request, done, cancel, accept)
    }

    /// Follows a curve of limit points, see `critical_curves::run`.
    fn curve(
        &self,
        curve: &ParameterCurve,
        cancel: &CancelFlag,
        accept: &mut dyn FnMut(CurveRow) -> ControlFlow<()>,
    ) -> Result<CurveSummary, InputErrors> {
        critical_curves::run(curve, cancel, accept)
    }
}

/// The solver of this crate.
#[derive(Debug, Clone, Copy, Default)]
pub struct PathSolver;

impl Solver for PathSolver {
    fn plan(&self, request: &JobRequest) -> Result<Plan, InputErrors> {
        Ok(Scene::new(request)?.plan().clone())
    }

    fn plan_after(&self, before: &mut Before, request: &JobRequest) -> Result<Plan, InputErrors> {
        let scene = Scene::like(before.0.as_ref(), request)?;
        Ok(before.0.insert(scene).plan().clone())
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
        Ok(trace(begin(request, &scene, beginning, cancel)?, accept))
    }

    fn resume(
        &self,
        request: &JobRequest,
        checkpoint: JudgedCheckpoint,
        cancel: CancelFlag,
        accept: Accept<'_>,
    ) -> Result<Option<JudgedReport>, ResumeError> {
        let scene = Scene::new(request)?;
        Ok(trace(JudgedPath::resume(request, &scene, checkpoint, cancel)?, accept))
    }
}

/// Traces the path of a scene that has been built for this request; otherwise as [`Solver::solve`].
pub fn solve_scene(request: &JobRequest, scene: &Scene, accept: Accept<'_>) -> Option<JudgedReport> {
    trace(JudgedPath::new(request, scene, CancelFlag::default()), accept)
}

fn trace(mut path: JudgedPath<'_>, accept: Accept<'_>) -> Option<JudgedReport> {
    let mut off_measure = false;
    while let Some(step) = path.step() {
        // Only the first one is logged: all points after it may be off, too. The report counts them.
        if let Some(judged) = step.given.as_ref().filter(|_| path.is_off_measure())
            && !std::mem::replace(&mut off_measure, true)
        {
            warn_off_measure(judged);
        }
        if accept(step, &path).is_break() {
            return None;
        }
    }
    path.report()
}

fn warn_off_measure(judged: &JudgedIncrement) {
    let errors = serde_json::to_string(&judged.measure).unwrap_or_default();
    tracing::warn!(increment = judged.increment.index, %errors, "an accepted increment is off the measure");
}

impl Place for JudgedPath<'_> {
    fn alternatives(&self) -> &[u64] {
        JudgedPath::alternatives(self)
    }

    fn checkpoint(&self) -> Option<JudgedCheckpoint> {
        JudgedPath::checkpoint(self)
    }
}

fn begin<'a>(
    request: &JobRequest,
    scene: &'a Scene,
    beginning: Option<Beginning>,
    cancel: CancelFlag,
) -> Result<JudgedPath<'a>, InputErrors> {
    let Some(Beginning { checkpoint, increment, direction, event }) = beginning else {
        return Ok(JudgedPath::new(request, scene, cancel));
    };
    let checkpoint = led_to(request, checkpoint, increment, &cancel)?;
    JudgedPath::follow(request, scene, checkpoint, direction, event, cancel).map_err(|error| refused(&error))
}

/// A checkpoint at this increment, to which the path is traced from an earlier checkpoint.
fn led_to(
    request: &JobRequest,
    checkpoint: JudgedCheckpoint,
    increment: u64,
    cancel: &CancelFlag,
) -> Result<JudgedCheckpoint, InputErrors> {
    if checkpoint.path.index() == increment {
        return Ok(checkpoint);
    }
    // A path that ends at the increment records it even if not every increment is recorded.
    let mut request = request.clone();
    request.analysis.max_increments = increment;
    let scene = Scene::new(&request)?;
    let mut path = JudgedPath::resume(&request, &scene, checkpoint, cancel.clone()).map_err(|error| refused(&error))?;
    while path.next().is_some_and(|judged| judged.increment.index < increment) {}
    path.checkpoint().filter(|checkpoint| checkpoint.path.index() == increment).ok_or_else(|| {
        let detail = format!("the path does not reach increment {increment} again: trace it anew");
        InputErrors(vec![InputError::new("/increment", detail)])
    })
}

fn refused(error: &JudgedCheckpointError) -> InputErrors {
    let pointer = match error {
        JudgedCheckpointError::History(_) => "/increment",
        JudgedCheckpointError::Path(error) => match error {
            CheckpointError::Version { .. } | CheckpointError::OtherModel { .. } | CheckpointError::NothingListed => {
                "/increment"
            }
            CheckpointError::NoSuchDirection { .. }
            | CheckpointError::Mechanism { .. }
            | CheckpointError::StageEnds { .. } => "/direction",
        },
    };
    InputErrors(vec![InputError::new(pointer, error.to_string())])
}
