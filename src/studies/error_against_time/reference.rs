//! The reference against which errors are measured.

use crate::check::scenes::exact::{self, Exact, Reach};
use crate::continuation::path::iterator::Path;
use crate::continuation::scene::Scene;
use crate::model::request::JobRequest;
use crate::model::request::study::{ReferenceChoice, StudyRequest};
use crate::model::{InputError, InputErrors};
use crate::resources::cancel::CancelFlag;
use crate::result::increment::{Increment, PointKind};
use crate::result::report::Report;
use crate::result::stop_reason::StopReason;
use crate::studies::error_against_time::curve::Curve;
use crate::studies::error_against_time::events::{self, EventsFound};
use crate::studies::error_against_time::matching::path_error;
use crate::studies::error_against_time::trace::{StudyTrace, TraceScales};
use serde::{Deserialize, Serialize};

/// Errors below this are round-off and the tolerance of Newton's method.
const ROUND_OFF: f64 = 1e-12;
/// Factor between the measured and the stated uncertainty of a self-converged reference: midway between points at uneven
/// distances the error is not at its maximum, and `error_estimate` is an estimate.
const SAFETY: f64 = 4.0;
/// Errors are resolved if they exceed this many times the uncertainty of the reference.
const CLEAR: f64 = 2.0;
/// The middle between two points is skipped if it is nearer to one of them than this part of their distance.
const CLOSEST: f64 = 0.1;

#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize)]
#[cfg_attr(feature = "server", derive(utoipa::ToSchema))]
#[serde(rename_all = "snake_case")]
pub enum ReferenceKind {
    Exact,
    SelfConverged,
}

/// What the errors of a study are measured against.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "server", derive(utoipa::ToSchema))]
#[cfg_attr(feature = "server", schema(as = StudyReference))]
pub struct Reference {
    pub kind: ReferenceKind,
    /// The exact solution's name and formula, or how the self-converged path was traced.
    pub what: String,
    /// Errors up to this are not resolved: round-off, or twice the reference's own uncertainty.
    pub floor: f64,
    /// Bound on the reference's own error, of self-converged ones: four times the largest distance from it of points traced
    /// in the middle between its own, or the largest `error_estimate` of its increments where that is more.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub uncertainty: Option<f64>,
    /// Largest arc length of the reference; of self-converged ones.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub arc_length: Option<f64>,
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub increments: Option<u64>,
    /// Why the reference ends; of self-converged ones.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub stop_reason: Option<StopReason>,
}

/// The exact solution, if the request admits it; refuses a choice of the reference that is not available.
pub(super) fn exact_of(request: &StudyRequest, job: &JobRequest) -> Result<Option<Exact>, InputErrors> {
    let known = || exact::recognise(job);
    match request.study.reference {
        ReferenceChoice::SelfConverged => Ok(None),
        ReferenceChoice::Auto => Ok(known()),
        ReferenceChoice::Exact => known().map(Some).ok_or_else(|| {
            let detail = "no exact solution of this model is known; `auto` or `self_converged` would do";
            InputErrors(vec![InputError::new("/study/reference", detail)])
        }),
    }
}

pub(super) fn describe_exact(exact: &Exact) -> String {
    format!("exact solution, {}: {}", exact.name(), exact.formula())
}

pub(super) fn describe_fine(job: &JobRequest) -> String {
    let arc_length = job.analysis.arc_length.max;
    format!("self-converged path: method auto, arc lengths up to {arc_length}, joined by polynomials of degree 7")
}

enum Source {
    Exact(Box<Exact>),
    Fine(Vec<Curve>),
}

/// A reference with its curves.
pub(super) struct Standard {
    source: Source,
    scales: TraceScales,
    pub reference: Reference,
}

/// The error of a path.
pub(super) struct Measured {
    pub path_error: Option<f64>,
    pub points_outside: u64,
    pub events: EventsFound,
}

impl Standard {
    /// Takes the exact solution, or traces the finer paths; `None` when cancelled.
    pub fn new(request: &StudyRequest, cancel: &CancelFlag) -> Result<Option<Self>, InputErrors> {
        let fine = request.finer_job(request.study.refinement as f64);
        let scene = Scene::new(&fine)?;
        let scales = TraceScales::new(&request.model, scene.plan());
        if let Some(exact) = exact_of(request, &fine)? {
            let reference = Reference {
                kind: ReferenceKind::Exact,
                what: describe_exact(&exact),
                floor: ROUND_OFF,
                uncertainty: None,
                arc_length: None,
                increments: None,
                stop_reason: None,
            };
            return Ok(Some(Self { source: Source::Exact(Box::new(exact)), scales, reference }));
        }
        let Some(FinePath { trace, report, places, largest_estimate }) = traced(&scene, &scales, cancel) else {
            return Ok(None);
        };
        let mut reference = Reference {
            kind: ReferenceKind::SelfConverged,
            what: describe_fine(&fine),
            floor: ROUND_OFF,
            uncertainty: None,
            arc_length: Some(fine.analysis.arc_length.max),
            increments: Some(report.increments),
            stop_reason: Some(report.stop_reason),
        };
        let curves = trace.stages.into_iter().filter(|stage| !stage.points.is_empty()).map(Curve::interpolating);
        let source = Source::Fine(curves.collect());
        let mut standard = Self { source, scales, reference: reference.clone() };
        let Some(trace) = traced_between(&scene, &standard.scales, &places, cancel) else { return Ok(None) };
        let between = standard.measure(&trace, cancel).path_error;
        reference.uncertainty = between.map(|between| SAFETY * between.max(largest_estimate));
        reference.floor = ROUND_OFF.max(reference.uncertainty.map_or(f64::INFINITY, |own| CLEAR * own));
        standard.reference = reference;
        Ok((!cancel.is_cancelled()).then_some(standard))
    }

    /// Of a self-converged reference.
    #[cfg(test)]
    pub fn curves(&self) -> &[Curve] {
        match &self.source {
            Source::Fine(curves) => curves,
            Source::Exact(_) => &[],
        }
    }

    pub fn scales(&self) -> &TraceScales {
        &self.scales
    }

    /// Meaningless after a cancellation.
    pub fn measure(&self, trace: &StudyTrace, cancel: &CancelFlag) -> Measured {
        match &self.source {
            Source::Fine(curves) => against(trace, curves, cancel),
            Source::Exact(exact) => {
                let (displacement, load) = trace.largest();
                let largest_scale = trace.stages.iter().map(|stage| self.scales.load(stage.stage)).fold(0.0, f64::max);
                let reach = Reach { load: load * largest_scale, displacement: displacement * self.scales.displacement };
                let stages = exact.stages(reach).into_iter().enumerate();
                let reached = trace.stages.last().map_or(0, |last| last.stage);
                let curves: Vec<Curve> = stages
                    .take_while(|(number, _)| *number <= reached)
                    .map(|(number, stage)| Curve::exact(number, stage, &self.scales))
                    .collect();
                against(trace, &curves, cancel)
            }
        }
    }
}

fn against(trace: &StudyTrace, curves: &[Curve], cancel: &CancelFlag) -> Measured {
    let mut largest = None;
    let mut outside = 0;
    for stage in &trace.stages {
        match curves.iter().find(|curve| curve.stage == stage.stage) {
            Some(curve) => {
                let error = path_error(&stage.points, curve, cancel);
                largest = Some(largest.map_or(error, |largest: f64| largest.max(error)));
            }
            None => outside += stage.points.len() as u64,
        }
    }
    // JSON has no infinity: a path that overflows has no error.
    let path_error = largest.filter(|error| error.is_finite());
    Measured { path_error, points_outside: outside, events: events::compare(trace, curves) }
}

/// A whole path of the method `auto`.
struct FinePath {
    trace: StudyTrace,
    report: Report,
    /// Of every point.
    places: Vec<PlaceOnPath>,
    /// Largest `error_estimate` of an increment.
    largest_estimate: f64,
}

/// The place of a point on a path.
struct PlaceOnPath {
    arc_length: f64,
    is_event: bool,
}

impl PlaceOnPath {
    fn of(increment: &Increment) -> Self {
        let is_event = !matches!(increment.point.kind, PointKind::Start | PointKind::Regular);
        Self { arc_length: increment.arc_length, is_event }
    }
}

/// `None` when cancelled, or without a report, which is a defect.
fn traced(scene: &Scene, scales: &TraceScales, cancel: &CancelFlag) -> Option<FinePath> {
    let (mut trace, mut places, mut largest_estimate) = (StudyTrace::default(), Vec::new(), 0.0_f64);
    let mut path = Path::new(scene, cancel.clone());
    for increment in path.by_ref() {
        trace.add(scales, &increment);
        places.push(PlaceOnPath::of(&increment));
        largest_estimate = largest_estimate.max(increment.diagnostics.error_estimate);
    }
    let report = path.report().filter(|report| report.stop_reason != StopReason::Cancelled)?;
    Some(FinePath { trace, report, places, largest_estimate })
}

/// The same path once more, with its points in the middle between those of the first time: where a curve through those is
/// farthest from the path. Arc lengths are sums of chords, and differ a little; events set them right.
fn traced_between(
    scene: &Scene,
    scales: &TraceScales,
    places: &[PlaceOnPath],
    cancel: &CancelFlag,
) -> Option<StudyTrace> {
    let mut trace = StudyTrace::default();
    let mut path = Path::new(scene, cancel.clone());
    let mut events = places.iter().filter(|place| place.is_event);
    let (mut segment, mut ahead) = (0, 0.0);
    while let Some(increment) = path.next() {
        trace.add(scales, &increment);
        if PlaceOnPath::of(&increment).is_event
            && let Some(event) = events.next()
        {
            ahead = event.arc_length - increment.arc_length;
        }
        let here = increment.arc_length + ahead;
        while let Some([from, to]) = places.get(segment..segment + 2) {
            let (middle, length) = (0.5 * (from.arc_length + to.arc_length), to.arc_length - from.arc_length);
            if middle - here > CLOSEST * length {
                path.shorten_next(middle - here);
                break;
            }
            segment += 1;
        }
    }
    path.report().filter(|report| report.stop_reason != StopReason::Cancelled).map(|_| trace)
}
