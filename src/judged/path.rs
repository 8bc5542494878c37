//! A path being traced and judged.

use super::checkpoint::{JudgedCheckpoint, JudgedCheckpointError};
use super::increment::JudgedIncrement;
use super::report::{JudgedReport, MeasureReport, OFF_MEASURE};
use crate::cancel::CancelFlag;
use crate::measure::Judge;
use crate::model::JobRequest;
use crate::model::request::Method;
use crate::path::{Path, Scene, TracedPath};

/// An iterator of judged increments, by whichever method the analysis names.
pub struct JudgedPath<'a> {
    path: TracedPath<'a>,
    judge: Judge,
    measure: MeasureReport,
    /// The last increment is off the measure.
    off_measure: bool,
}

impl<'a> JudgedPath<'a> {
    /// From the start; `scene` is the request's.
    pub fn new(request: &JobRequest, scene: &'a Scene, cancel: CancelFlag) -> Self {
        Self::of(TracedPath::new(scene, cancel), judge(request, scene), fresh(request))
    }

    fn of(path: TracedPath<'a>, judge: Judge, measure: MeasureReport) -> Self {
        Self { path, judge, measure, off_measure: false }
    }

    /// Along a direction listed at a checkpoint: see [`Path::follow`]. The judge goes on from where it was; the maxima
    /// are the new path's own.
    ///
    /// # Errors
    /// A checkpoint that does not fit, and a direction along which there is no path.
    pub fn follow(
        request: &JobRequest,
        scene: &'a Scene,
        checkpoint: JudgedCheckpoint,
        direction: usize,
        event: String,
        cancel: CancelFlag,
    ) -> Result<Self, JudgedCheckpointError> {
        let JudgedCheckpoint { path, history, measure: _ } = checkpoint;
        let path = Path::follow(scene, path, direction, event, cancel)?;
        let judge = judge(request, scene).taking_up(history)?;
        Ok(Self::of(TracedPath::Exact(Box::new(path)), judge, fresh(request)))
    }

    /// Takes a path up where it was put down: increments and report are the same as if it had not been.
    ///
    /// # Errors
    /// A checkpoint of another model, or of another version of this program.
    pub fn resume(
        request: &JobRequest,
        scene: &'a Scene,
        checkpoint: JudgedCheckpoint,
        cancel: CancelFlag,
    ) -> Result<Self, JudgedCheckpointError> {
        let JudgedCheckpoint { path, history, measure } = checkpoint;
        let path = Path::resume(scene, path, cancel)?;
        let judge = judge(request, scene).taking_up(history)?;
        Ok(Self::of(TracedPath::Exact(Box::new(path)), judge, measure))
    }

    /// The path at its present point; `None` by a method whose paths cannot be put down.
    pub fn checkpoint(&self) -> Option<JudgedCheckpoint> {
        let TracedPath::Exact(path) = &self.path else { return None };
        Some(JudgedCheckpoint { path: path.checkpoint(), history: self.judge.history(), measure: self.measure })
    }

    /// For each direction listed at the present point, whether a path goes along it; empty where there is one way on.
    pub fn open_directions(&self) -> Vec<bool> {
        let TracedPath::Exact(path) = &self.path else { return Vec::new() };
        (0..path.listed_directions()).map(|direction| path.can_be_followed(direction)).collect()
    }

    /// Whether the last increment is off the measure: a defect of the solver.
    pub fn is_off_measure(&self) -> bool {
        self.off_measure
    }

    /// Present when the path has ended, that is when `next` has returned `None`.
    pub fn report(&self) -> Option<JudgedReport> {
        self.path.report().map(|report| JudgedReport { report, measure: self.measure })
    }
}

fn judge(request: &JobRequest, scene: &Scene) -> Judge {
    let plan = scene.plan();
    Judge::new(request, plan.displacement_scale, &plan.load_scales)
}

fn fresh(request: &JobRequest) -> MeasureReport {
    MeasureReport::with_bar(match request.analysis.method {
        Method::Auto | Method::Mpec => Some(OFF_MEASURE),
        Method::Regularised => None,
    })
}

impl Iterator for JudgedPath<'_> {
    type Item = JudgedIncrement;

    fn next(&mut self) -> Option<JudgedIncrement> {
        let increment = self.path.next()?;
        let measure = self.judge.judge(&increment);
        self.off_measure = self.measure.include(increment.index, &measure);
        Some(JudgedIncrement { increment, measure })
    }
}
