//! Curves of limit points as jobs, which the same workers run; of a job's own limit points, or of a model.

use crate::continuation::critical_curve::history::traced_history::CurveRefusal;
use crate::model::request::curve::CurveSettings;
use crate::model::{InputError, InputErrors, ParameterCurve, decode};
use crate::result::increment::{Increment, PointKind};
use crate::result::plan::Plan;
use crate::service::jobs::queue::checks::{CheckContext, Whole};
use crate::service::jobs::queue::submission::{self, Prepared, not_text, queued, wrong_input};
use crate::service::jobs::{Caller, Jobs, JobsError, Posted};
use crate::service::metrics::Write;
use crate::service::store::{JobRecord, Line, Page, Task};
use crate::studies::critical_curves::{CurveFound, CurveRow, CurveSummary};
use serde::{Deserialize, Serialize};
use utoipa::ToSchema;
use uuid::Uuid;

/// What a curve is going to do.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, ToSchema)]
pub struct CurvePlan {
    pub curve: CurveSettings,
    /// The model's own value of the parameter, at which the curve starts.
    pub start: f64,
    /// Longest step between two values.
    pub step: f64,
    /// Dimensions of the space.
    pub dimension: usize,
    /// Points at this step; those where the curve changes, and shorter steps, come in addition.
    pub points: u64,
    /// Of the model at its own value.
    pub scene: Plan,
}

impl Jobs {
    /// The plan of a curve; nothing is queued.
    pub async fn validate_curve(&self, request: impl Into<Posted>) -> Result<CurvePlan, JobsError> {
        Ok(submission::prepared(&self.checks, request.into(), prepare).await?.0.plan)
    }

    pub async fn submit_curve(
        &self,
        caller: &Caller,
        request: impl Into<Posted>,
        idempotency_key: Option<String>,
    ) -> Result<JobRecord, JobsError> {
        let (prepared, _room) = submission::prepared(&self.checks, request.into(), prepare).await?;
        let job = prepared.into_job(caller, Task::Curve, &self.settings, idempotency_key)?;
        queued(self.metrics.work.timed(Write::Submit, self.store.submit(job)).await?)
    }

    /// Queues a curve of a limit point of the job `id`: of its request with these settings.
    pub async fn continue_job(
        &self,
        caller: &Caller,
        id: Uuid,
        posted: impl Into<Posted>,
        idempotency_key: Option<String>,
    ) -> Result<JobRecord, JobsError> {
        let posted: Posted = posted.into();
        let client = posted.client.clone();
        let read = |text: Vec<u8>| {
            Whole::of(move |_: &CheckContext<'_>| {
                decode::curve_settings(&text).map_err(|errors| wrong_input(&text, errors, JobsError::Input))
            })
        };
        let (asked, _) = self.checks.run(posted, read).await?;
        let job = self.find(caller, Task::Path, id).await?;
        if job.parent.is_some() {
            let detail = "the job follows a direction of another one, and a curve starts on the path from the undeformed \
                          structure; take that one";
            return Err(refused("", detail.to_owned()));
        }
        if let Some(increment) = asked.increment {
            self.check_kind(&job, increment).await?;
        }
        let text = self.store.request(id).await?.ok_or(JobsError::NoJob(id))?;
        let document = with_curve(&text, &asked)?;
        let posted = Posted { client, ..Posted::from(document.into_bytes()) };
        self.submit_curve(caller, posted, idempotency_key).await.map_err(|error| match error {
            // The settings are the whole body of this call.
            JobsError::Input(errors) => JobsError::Input(within_settings(errors)),
            other => other,
        })
    }

    /// Refuses an increment that is not stored, and one of a kind that cannot be followed.
    async fn check_kind(&self, job: &JobRecord, increment: u64) -> Result<(), JobsError> {
        let before = increment.checked_sub(1);
        let lines = self.store.increments(job.id, before, Page { rows: 1, bytes: 1 }).await?;
        let Some(line) = lines.first().filter(|line| line.index == increment) else {
            return Err(refused("/increment", format!("found {increment}; it is not stored")));
        };
        let kind = serde_json::from_str::<Increment>(&line.body).map(|increment| increment.point.kind);
        match kind {
            Ok(
                PointKind::SmoothLimit
                | PointKind::NonsmoothLimit
                | PointKind::SmoothBifurcation
                | PointKind::ContactChange,
            ) => Ok(()),
            _ => {
                let detail = CurveRefusal::NotCritical(increment).to_string();
                Err(refused("/increment", detail))
            }
        }
    }
}

/// The findings of a curve so far.
///
/// # Errors
/// The stored plan, report or lines cannot be read.
pub fn found(curve: JobRecord, lines: &[Line]) -> serde_json::Result<CurveFound> {
    let plan: CurvePlan = serde_json::from_str(&curve.plan)?;
    let rows: Vec<CurveRow> = lines.iter().map(|line| serde_json::from_str(&line.body)).collect::<Result<_, _>>()?;
    let summary: Option<CurveSummary> = curve.report.as_deref().map(serde_json::from_str).transpose()?;
    Ok(CurveFound::begun(curve.name, plan.curve, plan.dimension).with(rows, summary))
}

fn prepare(context: &CheckContext<'_>, request: Vec<u8>) -> Result<Prepared<CurvePlan>, JobsError> {
    let curve = ParameterCurve::read(&request).map_err(|errors| wrong_input(&request, errors, JobsError::Input))?;
    let first = curve.request(curve.start).map_err(JobsError::Input)?;
    context.limits.check(&first.model, first.analysis.max_increments).map_err(JobsError::Input)?;
    context.go_on()?;
    let scene = context.solver.plan(&first).map_err(JobsError::Input)?;
    let max_increments = curve.points();
    let ParameterCurve { name, settings, start, step, dimension, .. } = curve;
    let plan = CurvePlan { curve: settings, start, step, dimension, points: max_increments, scene };
    let text = String::from_utf8(request).map_err(not_text)?;
    Ok(Prepared { text, name, plan, summary: None, max_increments, explore: None })
}

/// The request of a job with the settings of a curve.
fn with_curve(request: &str, settings: &CurveSettings) -> Result<String, JobsError> {
    let mut document = decode::object(request.as_bytes()).map_err(JobsError::Input)?;
    document.insert("curve".to_owned(), serde_json::to_value(settings)?);
    // The directions that an exploration follows are no part of a curve.
    if let Some(analysis) = document.get_mut("analysis").and_then(serde_json::Value::as_object_mut) {
        analysis.remove("explore");
    }
    Ok(serde_json::to_string(&document)?)
}

fn within_settings(errors: InputErrors) -> InputErrors {
    let within = |error: InputError| match error.pointer.strip_prefix("/curve") {
        Some(rest) => InputError::new(rest, error.detail),
        None => error,
    };
    InputErrors(errors.0.into_iter().map(within).collect())
}

fn refused(pointer: &str, detail: String) -> JobsError {
    JobsError::Follow(InputErrors(vec![InputError::new(pointer, detail)]))
}
