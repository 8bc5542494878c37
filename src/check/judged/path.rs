//! Traces and judges a path.

use crate::check::judged::alternatives::Alternatives;
use crate::check::judged::checkpoint::{JudgedCheckpoint, JudgedCheckpointError};
use crate::check::judged::increment::JudgedIncrement;
use crate::check::judged::record::Recorder;
use crate::check::judged::report::{JudgedReport, MeasureReport, OFF_MEASURE};
use crate::check::measure::{Judge, history};
use crate::continuation::method_dispatch::TracedPath;
use crate::continuation::path::iterator::Path;
use crate::continuation::scene::Scene;
use crate::model::JobRequest;
use crate::model::request::Method;
use crate::resources::cancel::CancelFlag;
use crate::result::increment::{Diagnostics, Increment};

/// An iterator over judged increments, for every method of the analysis.
pub struct JudgedPath<'a> {
    path: TracedPath<'a>,
    judge: Judge,
    measure: MeasureReport,
    record: Recorder,
    /// The last increment exceeds the tolerance of the measure.
    off_measure: bool,
    alternatives: Alternatives,
    /// The directions that are listed for the first time at the last increment.
    found: Vec<u64>,
    /// The last increment, if it was not recorded: it is emitted if it is the last of the path.
    left_out: Option<PendingIncrement>,
    /// A checkpoint at the last emitted increment, if the path has continued from there.
    put_down: Option<Option<PausedPath>>,
}

/// A step of the path, with its increment if this is recorded.
#[derive(Debug)]
pub struct Step {
    /// Index of the increment.
    pub index: u64,
    /// The totals of the path.
    pub diagnostics: Diagnostics,
    /// The increment, if it is recorded.
    pub given: Option<JudgedIncrement>,
}

/// An increment that has not been emitted yet.
struct PendingIncrement {
    judged: JudgedIncrement,
    place: Option<PausedPath>,
}

/// A checkpoint at an increment with listed directions.
struct PausedPath {
    checkpoint: JudgedCheckpoint,
    open: Vec<bool>,
}

impl<'a> JudgedPath<'a> {
    /// Traces the path from its start; `scene` is that of the request.
    pub fn new(request: &JobRequest, scene: &'a Scene, cancel: CancelFlag) -> Self {
        Self::of(request, TracedPath::new(scene, cancel), judge(request, scene), fresh(request))
    }

    fn of(request: &JobRequest, path: TracedPath<'a>, judge: Judge, measure: MeasureReport) -> Self {
        Self {
            path,
            judge,
            measure,
            record: Recorder::new(request),
            off_measure: false,
            alternatives: Alternatives::default(),
            found: Vec::new(),
            left_out: None,
            put_down: None,
        }
    }

    /// Follows a direction listed at a checkpoint: see [`Path::follow`]. The judge continues with its history; the maxima are
    /// those of the new path.
    ///
    /// # Errors
    /// The checkpoint does not fit, or there is no path along the direction.
    pub fn follow(
        request: &JobRequest,
        scene: &'a Scene,
        checkpoint: JudgedCheckpoint,
        direction: usize,
        event: String,
        cancel: CancelFlag,
    ) -> Result<Self, JudgedCheckpointError> {
        let JudgedCheckpoint { path, history, measure: _, alternatives: _, left_out: _ } = checkpoint;
        let path = Path::follow(scene, path, direction, event, cancel)?;
        let judge = history::take_up(judge(request, scene), history)?;
        let mut followed = Self::of(request, TracedPath::Exact(Box::new(path)), judge, fresh(request));
        followed.alternatives = Alternatives::of(true);
        Ok(followed)
    }

    /// Resumes a path from a checkpoint: increments and report are the same as without the interruption, except for
    /// `elapsed_s`.
    ///
    /// # Errors
    /// The checkpoint is of another model, or of another version of this program.
    pub fn resume(
        request: &JobRequest,
        scene: &'a Scene,
        checkpoint: JudgedCheckpoint,
        cancel: CancelFlag,
    ) -> Result<Self, JudgedCheckpointError> {
        let JudgedCheckpoint { path, history, measure, alternatives, left_out } = checkpoint;
        let path = Path::resume(scene, path, cancel)?;
        let judge = history::take_up(judge(request, scene), history)?;
        let path = TracedPath::Exact(Box::new(path));
        let mut resumed = Self { alternatives, ..Self::of(request, path, judge, measure) };
        resumed.left_out = left_out.map(|judged| PendingIncrement { judged: *judged, place: resumed.place() });
        Ok(resumed)
    }

    /// A checkpoint at the last step; `None` for a method without checkpoints.
    pub fn checkpoint(&self) -> Option<JudgedCheckpoint> {
        match &self.put_down {
            Some(place) => place.as_ref().map(|place| place.checkpoint.clone()),
            None => {
                let left_out = self.left_out.as_ref().map(|left_out| Box::new(left_out.judged.clone()));
                self.present().map(|checkpoint| JudgedCheckpoint { left_out, ..checkpoint })
            }
        }
    }

    /// Traces and judges one more increment. The last increment of a path is emitted even if it would not be recorded.
    pub fn step(&mut self) -> Option<Step> {
        self.put_down = None;
        let Some(increment) = self.path.next() else {
            let PendingIncrement { judged, place } = self.left_out.take()?;
            self.put_down = Some(place);
            self.off_measure = false;
            let Increment { index, diagnostics, .. } = judged.increment;
            return Some(Step { index, diagnostics, given: Some(judged) });
        };
        let Increment { index, diagnostics, .. } = increment;
        let measure = self.judge.judge(&increment);
        self.off_measure = self.measure.include(index, &measure);
        self.found = self.alternatives.at(&increment, &self.open());
        let kept = self.off_measure || !self.found.is_empty() || self.record.keeps(&increment);
        let judged = JudgedIncrement { increment: self.record.cut(increment), measure };
        if kept {
            self.left_out = None;
            return Some(Step { index, diagnostics, given: Some(judged) });
        }
        self.left_out = Some(PendingIncrement { judged, place: self.place() });
        Some(Step { index, diagnostics, given: None })
    }

    fn present(&self) -> Option<JudgedCheckpoint> {
        let TracedPath::Exact(path) = &self.path else { return None };
        let alternatives = self.alternatives.clone();
        Some(JudgedCheckpoint {
            path: path.checkpoint(),
            history: history::history_of(&self.judge),
            measure: self.measure,
            alternatives,
            left_out: None,
        })
    }

    /// Makes a checkpoint where directions are listed: the next step may fail and leave another state behind.
    fn place(&self) -> Option<PausedPath> {
        let open = self.open_directions();
        if open.is_empty() { None } else { self.present().map(|checkpoint| PausedPath { checkpoint, open }) }
    }

    /// For each direction listed at the last increment, whether it can be followed; empty if no directions are listed or
    /// recorded.
    pub fn open_directions(&self) -> Vec<bool> {
        match &self.put_down {
            _ if !self.record.directions() => Vec::new(),
            Some(place) => place.as_ref().map_or_else(Vec::new, |place| place.open.clone()),
            None => self.open(),
        }
    }

    /// The directions that are listed for the first time at the last increment.
    pub fn alternatives(&self) -> &[u64] {
        &self.found
    }

    fn open(&self) -> Vec<bool> {
        let TracedPath::Exact(path) = &self.path else { return Vec::new() };
        (0..path.listed_directions()).map(|direction| path.can_be_followed(direction)).collect()
    }

    /// Whether the last increment exceeds the tolerance of the measure, which is a defect of the solver.
    pub fn is_off_measure(&self) -> bool {
        self.off_measure
    }

    /// The report, once the path has ended, that is when `next` has returned `None`.
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
        loop {
            if let Some(judged) = self.step()?.given {
                return Some(judged);
            }
        }
    }
}
