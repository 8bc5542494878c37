//! Runs a study.

use crate::continuation::method_dispatch::TracedPath;
use crate::continuation::scene::Scene;
use crate::model::InputErrors;
use crate::model::request::Method;
use crate::model::request::study::{Parameter, StudyRequest};
use crate::resources::cancel::CancelFlag;
use crate::result::stop_reason::StopReason;
use crate::studies::error_against_time::plan::{StudyPlan, plan};
use crate::studies::error_against_time::reference::Standard;
use crate::studies::error_against_time::report::StudyReport;
use crate::studies::error_against_time::row::{StudyRow, StudyRun, Time, order};
use crate::studies::error_against_time::trace::StudyTrace;
use std::ops::ControlFlow;

/// Runs a study; `done` are its first runs, from an earlier attempt. Every further run is passed to `accept`, which breaks to end
/// the study. Except for the times, the findings are reproducible.
///
/// `None`: `accept` broke, or the study was cancelled before the reference was complete.
///
/// # Errors
/// As for [`plan`].
pub fn run(
    request: &StudyRequest,
    done: Vec<StudyRun>,
    cancel: &CancelFlag,
    accept: &mut dyn FnMut(&StudyRun) -> ControlFlow<()>,
) -> Result<Option<StudyReport>, InputErrors> {
    let plan = plan(request)?;
    let Some(standard) = Standard::new(request, cancel)? else { return Ok(None) };
    let mut found = StudyInProgress { plan: &plan, rows: Vec::new(), times: vec![Vec::new(); plan.rows as usize] };
    for run in done {
        found.take(&run);
    }
    let begun = found.runs();
    for index in begun..plan.runs {
        let (round, row) = (index / plan.rows, index % plan.rows);
        let (method, value) = plan.row(row);
        let scene = Scene::new(&request.job(method, value))?;
        let traced = if round == 0 {
            first(&scene, &standard, (row, method, value), cancel)
        } else {
            again(&scene, cancel).map(|elapsed_s| (elapsed_s, found.rows[row as usize].clone()))
        };
        let Some((elapsed_s, row)) = traced else {
            return Ok(Some(found.report(request, standard, false)));
        };
        let reference = standard.reference.clone();
        let run = found.complete(StudyRun { index, round, elapsed_s, row, reference });
        found.take(&run);
        if accept(&run).is_break() {
            return Ok(None);
        }
    }
    Ok(Some(found.report(request, standard, true)))
}

/// The findings so far.
struct StudyInProgress<'a> {
    plan: &'a StudyPlan,
    rows: Vec<StudyRow>,
    times: Vec<Vec<f64>>,
}

impl StudyInProgress<'_> {
    fn runs(&self) -> u64 {
        self.rows.len() as u64 + self.times.iter().map(|times| times.len() as u64).sum::<u64>()
    }

    /// Adds the values that depend on the other runs: order and times.
    fn complete(&self, mut run: StudyRun) -> StudyRun {
        let row = run.row.row as usize;
        if run.round == 0 {
            let by_step = self.plan.parameter == Parameter::ArcLength;
            let before = row.checked_sub(1).map(|before| &self.rows[before]);
            let before = before.filter(|before| before.method == run.row.method && before.resolved && run.row.resolved);
            run.row.order = before.and_then(|before| order(before, &run.row, by_step));
        } else {
            let mut times = self.times[row].clone();
            times.push(run.elapsed_s);
            run.row.time = Time::of(&times);
        }
        run
    }

    fn take(&mut self, run: &StudyRun) {
        let row = run.row.row as usize;
        if run.round == 0 {
            self.rows.push(run.row.clone());
        } else if let Some(times) = self.times.get_mut(row) {
            times.push(run.elapsed_s);
            self.rows[row] = run.row.clone();
        }
    }

    fn report(self, request: &StudyRequest, standard: Standard, complete: bool) -> StudyReport {
        StudyReport::new(request.model.name.clone(), self.plan.parameter, standard.reference, self.rows, complete)
    }
}

/// Traces a path and measures it; the time and the row. `None` when cancelled.
fn first(
    scene: &Scene,
    standard: &Standard,
    (row, method, value): (u64, Method, f64),
    cancel: &CancelFlag,
) -> Option<(f64, StudyRow)> {
    let mut path = TracedPath::new(scene, cancel.clone());
    let mut trace = StudyTrace::default();
    let (mut arc_length, mut largest_estimate) = (0.0, 0.0_f64);
    for increment in path.by_ref() {
        trace.add(standard.scales(), &increment);
        arc_length = increment.arc_length;
        largest_estimate = largest_estimate.max(increment.diagnostics.error_estimate);
    }
    let report = path.report().filter(|report| report.stop_reason != StopReason::Cancelled)?;
    let measured = standard.measure(&trace, cancel);
    if cancel.is_cancelled() {
        return None;
    }
    let row = StudyRow {
        row,
        method,
        value,
        mean_step: if report.increments > 0 { arc_length / report.increments as f64 } else { 0.0 },
        path_error: measured.path_error,
        resolved: measured.path_error.is_some_and(|error| error > standard.reference.floor),
        points_outside: measured.points_outside,
        events: measured.events,
        largest_estimate,
        increments: report.increments,
        factorisations: report.factorisations,
        newton_iterations: report.newton_iterations,
        qp_solves: report.qp_solves,
        mpec_solves: report.mpec_solves,
        stop_reason: report.stop_reason,
        time: None,
        order: None,
    };
    Some((report.elapsed_s, row))
}

/// Traces a path for its time alone.
fn again(scene: &Scene, cancel: &CancelFlag) -> Option<f64> {
    let mut path = TracedPath::new(scene, cancel.clone());
    path.by_ref().for_each(drop);
    path.report().filter(|report| report.stop_reason != StopReason::Cancelled).map(|report| report.elapsed_s)
}
