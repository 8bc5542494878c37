//! Jobs: submit, list, read, cancel, delete.

use crate::model::JobRequest;
use crate::result::plan::Plan;
use crate::service::http::answer::problem::Problem;
use crate::service::http::answer::tag;
use crate::service::http::document;
use crate::service::http::input::extract::{Parameters, QueryParameters};
use crate::service::http::state::service::Service;
use crate::service::http::tasks::requester::{ListQuery, Requester};
use crate::service::http::tasks::resource::Resource;
use crate::service::http::tasks::submission::{Submission, SubmitParameters, accepted};
use crate::service::http::tasks::target::Target;
use crate::service::http::view::job::{Job, JobList, address};
use crate::service::jobs::{Caller, JobsError, Posted};
use crate::service::store::{JobRecord, Status, Task};
use axum::Json;
use axum::http::StatusCode;
use axum::response::{IntoResponse, Response};
use serde::Deserialize;
use uuid::Uuid;

impl Resource for Job {
    const TASK: Task = Task::Path;
    const ADDRESS: fn(Uuid) -> String = address;
    type Listed = Self;

    async fn validated(service: &Service, request: Posted) -> Result<Response, Problem> {
        Ok(Json(service.jobs.validate(request).await?).into_response())
    }

    async fn submitted(
        service: &Service,
        caller: &Caller,
        request: Posted,
        idempotency_key: Option<String>,
    ) -> Result<JobRecord, JobsError> {
        service.jobs.submit(caller, request, idempotency_key).await
    }
}

/// Queue a job, or only check it.
#[utoipa::path(
    post, path = "/v1/jobs", tag = document::JOBS, operation_id = "submit_job",
    params(SubmitParameters),
    request_body = JobRequest,
    responses(
        (status = 202, description = "Queued, or queued before under the same idempotency key.", body = Job),
        (status = 200, description = "With `validate=true`: what would be done.", body = Plan),
    )
)]
pub async fn submit(submission: Submission<Job>) -> Result<Response, Problem> {
    submission.submit().await
}

#[derive(Debug, Deserialize, utoipa::IntoParams)]
#[serde(deny_unknown_fields)]
#[into_params(parameter_in = Query)]
pub struct ListParameters {
    /// Only jobs with this status.
    status: Option<Status>,
    /// Only runs of this sweep.
    sweep: Option<Uuid>,
    /// Only jobs that follow a direction of this one.
    parent: Option<Uuid>,
    /// `next_cursor` of the page before.
    cursor: Option<Uuid>,
    #[param(minimum = 1, maximum = 200, default = 50)]
    limit: Option<u32>,
}

impl QueryParameters for ListParameters {
    const EXPECTED: &'static [(&'static str, &'static str)] = &[
        ("status", "`queued`, `running`, `completed`, `stopped`, `cancelled` or `failed`"),
        ("sweep", "the id of a sweep, a UUID,"),
        ("parent", "the id of a job, a UUID,"),
        ("cursor", "the `next_cursor` of the page before, a UUID,"),
        ("limit", "a whole number from 1 to 200"),
    ];
}

/// List jobs, newest first.
#[utoipa::path(
    get, path = "/v1/jobs", tag = document::JOBS, operation_id = "list_jobs", params(ListParameters),
    responses((status = 200, description = "A page of jobs.", body = JobList))
)]
pub async fn list(
    requester: Requester,
    Parameters(parameters): Parameters<ListParameters>,
) -> Result<Json<JobList>, Problem> {
    let ListParameters { status, sweep, parent, cursor, limit } = parameters;
    let (jobs, next_cursor) = requester.page::<Job>(ListQuery { status, sweep, parent, cursor, limit }).await?;
    Ok(Json(JobList { jobs, next_cursor }))
}

/// One job: status, plan, progress, stop reason, report.
#[utoipa::path(
    get, path = "/v1/jobs/{id}", tag = document::JOBS, operation_id = "get_job",
    responses((status = 200, description = "The job.", body = Job))
)]
pub async fn get(target: Target<Job>) -> Result<Response, Problem> {
    let record = target.find().await?;
    let Target { service, id, headers, .. } = target;
    let (bytes, is_finished) = (record.bytes(), record.status.is_ended());
    let locating_bifurcation = service.jobs.is_locating_bifurcation(id);
    let shown = move || {
        let mut job = Job::try_from(record)?;
        job.progress.locating_bifurcation = locating_bifurcation && !is_finished;
        tag::json(&headers, is_finished, &job)
    };
    service.offload.run(bytes, shown).await
}

/// Stop a job within one iteration; what is stored is kept. An ended job stays as it is.
#[utoipa::path(
    post, path = "/v1/jobs/{id}/cancel", tag = document::JOBS, operation_id = "cancel_job",
    responses((status = 202, description = "The job; a running one ends shortly.", body = Job))
)]
pub async fn cancel(target: Target<Job>) -> Result<Response, Problem> {
    target.cancel().await
}

/// Queue a failed job again.
///
/// What it has stored stands, and it goes on from there; the workers that it has lost are forgotten. Runs of sweeps are not
/// queued again.
#[utoipa::path(
    post, path = "/v1/jobs/{id}/retry", tag = document::JOBS, operation_id = "retry_job",
    responses((status = 202, description = "The job, which waits.", body = Job))
)]
pub async fn retry(target: Target<Job>) -> Result<Response, Problem> {
    let Target { service, caller, id, .. } = target;
    accepted::<Job>(&service, service.jobs.retry(&caller, id).await?).await
}

/// Stop a job and drop what is stored.
#[utoipa::path(
    delete, path = "/v1/jobs/{id}", tag = document::JOBS, operation_id = "delete_job",
    responses((status = 204, description = "The job is gone."))
)]
pub async fn delete(target: Target<Job>) -> Result<StatusCode, Problem> {
    target.delete().await
}
