//! Studies: submit, list, read, follow, cancel, delete; their table and picture.

use crate::model::StudyRequest;
use crate::service::http::answer::problem::Problem;
use crate::service::http::answer::tag;
use crate::service::http::document;
use crate::service::http::input::extract::Parameters;
use crate::service::http::state::service::Service;
use crate::service::http::tasks::findings::{FindingsSoFar, StoredFindings, WithFindings};
use crate::service::http::tasks::requester::{ListByStatus, Requester};
use crate::service::http::tasks::resource::Resource;
use crate::service::http::tasks::stream::stream_lines;
use crate::service::http::tasks::submission::{Submission, SubmitParameters};
use crate::service::http::tasks::target::Target;
use crate::service::http::view::stream::ServerEvent;
use crate::service::http::view::study::{Study, StudyList, StudyWithReport, address};
use crate::service::jobs::queue::studies;
use crate::service::jobs::{Caller, JobsError, Posted};
use crate::service::store::{JobRecord, Task};
use crate::studies::error_against_time::{StudyPlan, StudyReport, StudyRun};
use axum::Json;
use axum::http::StatusCode;
use axum::response::{IntoResponse, Response};
use uuid::Uuid;

impl Resource for Study {
    const TASK: Task = Task::Study;
    const ADDRESS: fn(Uuid) -> String = address;
    type Listed = Self;

    async fn validated(service: &Service, request: Posted) -> Result<Response, Problem> {
        Ok(Json(service.jobs.validate_study(request).await?).into_response())
    }

    async fn submitted(
        service: &Service,
        caller: &Caller,
        request: Posted,
        idempotency_key: Option<String>,
    ) -> Result<JobRecord, JobsError> {
        service.jobs.submit_study(caller, request, idempotency_key).await
    }
}

impl WithFindings for Study {
    type Findings = StudyReport;

    /// A problem before the first path has been traced.
    async fn stored_findings(target: &Target<Self>) -> Result<StoredFindings<StudyReport>, Problem> {
        let (id, study) = (target.id, target.find().await?);
        let lines =
            if study.report.is_some() { Vec::new() } else { target.service.jobs.lines_of_study(&study).await? };
        let bytes = study.bytes() + lines.iter().map(|line| line.body.len()).sum::<usize>();
        let is_finished = study.status.is_ended();
        let read = move || match &study.report {
            Some(report) => Ok(serde_json::from_str(report)?),
            None => studies::found(&study, &lines)?.ok_or_else(|| {
                Problem::not_found(format_args!("table of study {id}: no path of it has been traced yet"))
            }),
        };
        Ok(StoredFindings { bytes, is_finished, read: Box::new(read) })
    }
}

/// Queue a study, or only check it.
///
/// One scene is traced over a ladder of arc lengths, tolerances or penalties and by several methods; errors are measured
/// against the exact solution where one is known, and against a self-converged path otherwise. A job request is a study
/// too, with the defaults.
#[utoipa::path(
    post, path = "/v1/studies", tag = document::STUDIES, operation_id = "submit_study",
    params(SubmitParameters),
    request_body = StudyRequest,
    responses(
        (status = 202, description = "Queued, or queued before under the same idempotency key.", body = Study),
        (status = 200, description = "With `validate=true`: what would be done.", body = StudyPlan),
    )
)]
pub async fn submit(submission: Submission<Study>) -> Result<Response, Problem> {
    submission.submit().await
}

/// List studies, newest first.
#[utoipa::path(
    get, path = "/v1/studies", tag = document::STUDIES, operation_id = "list_studies", params(ListByStatus),
    responses((status = 200, description = "A page of studies.", body = StudyList))
)]
pub async fn list(
    requester: Requester,
    Parameters(parameters): Parameters<ListByStatus>,
) -> Result<Json<StudyList>, Problem> {
    let (studies, next_cursor) = requester.page::<Study>(parameters.into()).await?;
    Ok(Json(StudyList { studies, next_cursor }))
}

/// One study: status, plan, progress, and what it has found so far.
#[utoipa::path(
    get, path = "/v1/studies/{id}", tag = document::STUDIES, operation_id = "get_study",
    responses((status = 200, description = "The study.", body = StudyWithReport))
)]
pub async fn get(target: Target<Study>) -> Result<Response, Problem> {
    let study = target.find().await?;
    if study.report.is_some() {
        return target.shown::<StudyWithReport>(study).await;
    }
    let Target { service, headers, .. } = target;
    let lines = service.jobs.lines_of_study(&study).await?;
    let bytes = lines.iter().map(|line| line.body.len()).sum();
    let make = move || {
        let report = studies::found(&study, &lines)?;
        tag::json(&headers, study.status.is_ended(), &StudyWithReport::so_far(study, report.as_ref())?)
    };
    service.offload.run(bytes, make).await
}

/// Follow a study: its rows as paths are traced, then its end.
///
/// Server-sent events: `row` events, one a path, whose id is its number and whose row is the row as it stands then; the
/// first round has every row's errors, later ones add times. Then one `end` event with the study and its report.
/// `Last-Event-ID` and a service that goes down are as for a job's stream.
///
/// With `Accept: application/x-ndjson`: one path a line, and a last line with the study and its report, which has a
/// `status` and no `index`.
#[utoipa::path(
    get, path = "/v1/studies/{id}/stream", tag = document::STUDIES, operation_id = "stream_study",
    params(("Last-Event-ID" = Option<u64>, Header, description = "Index of the last row received.")),
    responses((status = 200, description = "Paths in order of their index.", content(
        (ServerEvent = "text/event-stream"),
        (StudyRun = "application/x-ndjson")
    )))
)]
pub async fn stream(target: Target<Study>) -> Result<Response, Problem> {
    stream_lines(target).await
}

/// Stop a study within one iteration; what it has found is kept. An ended study stays as it is.
#[utoipa::path(
    post, path = "/v1/studies/{id}/cancel", tag = document::STUDIES, operation_id = "cancel_study",
    responses((status = 202, description = "The study; a running one ends shortly.", body = Study))
)]
pub async fn cancel(target: Target<Study>) -> Result<Response, Problem> {
    target.cancel().await
}

/// Stop a study and drop what is stored.
#[utoipa::path(
    delete, path = "/v1/studies/{id}", tag = document::STUDIES, operation_id = "delete_study",
    responses((status = 204, description = "The study is gone."))
)]
pub async fn delete(target: Target<Study>) -> Result<StatusCode, Problem> {
    target.delete().await
}

/// The rows found so far, as CSV.
#[utoipa::path(
    get, path = "/v1/studies/{id}/table.csv", tag = document::STUDIES, operation_id = "get_study_table_csv",
    responses((status = 200, description = "The table; one line a row.", body = String, content_type = "text/csv"))
)]
pub async fn table_csv(target: Target<Study>) -> Result<Response, Problem> {
    target.found(FindingsSoFar::csv).await
}

/// The rows found so far, as columns of text.
#[utoipa::path(
    get, path = "/v1/studies/{id}/table.txt", tag = document::STUDIES, operation_id = "get_study_table_txt",
    responses((status = 200, description = "The table, for a reader.", body = String, content_type = "text/plain"))
)]
pub async fn table_txt(target: Target<Study>) -> Result<Response, Problem> {
    target.found(FindingsSoFar::text).await
}

/// Error against time so far, on logarithmic scales, one line a method.
///
/// Until every row has been timed, and where `repeats` is 0, what is varied stands in the place of the time.
#[utoipa::path(
    get, path = "/v1/studies/{id}/picture.svg", tag = document::STUDIES, operation_id = "get_study_picture",
    responses((status = 200, description = "The picture.", body = String, content_type = "image/svg+xml"))
)]
pub async fn picture(target: Target<Study>) -> Result<Response, Problem> {
    target.found(FindingsSoFar::picture).await
}
