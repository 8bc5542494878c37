//! Studies: submit, list, read, follow, cancel, delete; their table and picture.

use super::extract::{JobId, JsonText, Parameters, idempotency_key};
use super::findings::SoFar;
use super::problem::Problem;
use super::tasks::{ListByStatus, SubmitParameters, accepted};
use super::view::ServerEvent;
use super::view_study::{Study, StudyList, StudyWithReport, address};
use super::{Service, document, tag, tasks};
use crate::jobs::{Caller, studies};
use crate::model::StudyRequest;
use crate::store::Task;
use crate::studies::{Plan, Report, Run};
use axum::Extension;
use axum::Json;
use axum::extract::State;
use axum::http::{HeaderMap, StatusCode};
use axum::response::{IntoResponse, Response};
use uuid::Uuid;

/// Queue a study, or only check it.
///
/// One scene is traced over a ladder of arc lengths, tolerances or penalties and by several methods; errors are measured
/// against the exact solution where one is known, and against a self-converged path otherwise. A job request is a study
/// too, with the defaults.
#[utoipa::path(
    post, path = "/v1/studies", tag = document::STUDIES, operation_id = "submit_study",
    params(
        SubmitParameters,
        ("Idempotency-Key" = Option<String>, Header, min_length = 1, max_length = 255, pattern = "^[ -~]+$",
         description = "Sent again with the same body, it answers the study of the first time; with another body it is refused.")
    ),
    request_body = StudyRequest,
    responses(
        (status = 202, description = "Queued, or queued before under the same idempotency key.", body = Study,
         headers(("Location" = String, description = "The study's address."))),
        (status = 200, description = "With `validate=true`: what would be done.", body = Plan),
    )
)]
pub async fn submit(
    State(service): State<Service>,
    Extension(caller): Extension<Caller>,
    Parameters(parameters): Parameters<SubmitParameters>,
    headers: HeaderMap,
    JsonText(request): JsonText,
) -> Result<Response, Problem> {
    let key = idempotency_key(&headers)?;
    if parameters.validate {
        return Ok(Json(service.jobs.validate_study(request).await?).into_response());
    }
    accepted::<Study>(&service, service.jobs.submit_study(&caller, request, key).await?, address).await
}

/// List studies, newest first.
#[utoipa::path(
    get, path = "/v1/studies", tag = document::STUDIES, operation_id = "list_studies", params(ListByStatus),
    responses((status = 200, description = "A page of studies.", body = StudyList))
)]
pub async fn list(
    State(service): State<Service>,
    Extension(caller): Extension<Caller>,
    Parameters(parameters): Parameters<ListByStatus>,
) -> Result<Json<StudyList>, Problem> {
    let (studies, next_cursor) = parameters.page(&service, &caller, Task::Study).await?;
    Ok(Json(StudyList { studies, next_cursor }))
}

/// One study: status, plan, progress, and what it has found so far.
#[utoipa::path(
    get, path = "/v1/studies/{id}", tag = document::STUDIES, operation_id = "get_study",
    params(("id" = Uuid, Path, description = "The study's id.")),
    responses((status = 200, description = "The study.", body = StudyWithReport))
)]
pub async fn get(
    State(service): State<Service>,
    Extension(caller): Extension<Caller>,
    JobId(id): JobId,
    headers: HeaderMap,
) -> Result<Response, Problem> {
    let study = service.jobs.find(&caller, Task::Study, id).await?;
    if study.report.is_some() {
        return tasks::shown::<StudyWithReport>(&service, headers, study).await;
    }
    let lines = service.jobs.lines_of_study(&study).await?;
    let bytes = lines.iter().map(|line| line.body.len()).sum();
    let make = move || {
        let report = studies::found(&study, &lines)?;
        tag::json(&headers, study.status.is_ended(), &StudyWithReport::so_far(study, report.as_ref())?)
    };
    service.aside.make(bytes, make).await
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
    params(
        ("id" = Uuid, Path, description = "The study's id."),
        ("Last-Event-ID" = Option<u64>, Header, description = "Index of the last row received.")
    ),
    responses((status = 200, description = "Paths in order of their index.", content(
        (ServerEvent = "text/event-stream"),
        (Run = "application/x-ndjson")
    )))
)]
pub async fn stream(
    State(service): State<Service>,
    Extension(caller): Extension<Caller>,
    JobId(id): JobId,
    headers: HeaderMap,
) -> Result<Response, Problem> {
    super::stream::answer(service, &caller, Task::Study, id, &headers).await
}

/// Stop a study within one iteration; what it has found is kept. An ended study stays as it is.
#[utoipa::path(
    post, path = "/v1/studies/{id}/cancel", tag = document::STUDIES, operation_id = "cancel_study",
    params(("id" = Uuid, Path, description = "The study's id.")),
    responses((status = 202, description = "The study; a running one ends shortly.", body = Study))
)]
pub async fn cancel(
    State(service): State<Service>,
    Extension(caller): Extension<Caller>,
    JobId(id): JobId,
) -> Result<Response, Problem> {
    tasks::cancel::<Study>(&service, &caller, Task::Study, id).await
}

/// Stop a study and drop what is stored.
#[utoipa::path(
    delete, path = "/v1/studies/{id}", tag = document::STUDIES, operation_id = "delete_study",
    params(("id" = Uuid, Path, description = "The study's id.")),
    responses((status = 204, description = "The study is gone."))
)]
pub async fn delete(
    State(service): State<Service>,
    Extension(caller): Extension<Caller>,
    JobId(id): JobId,
) -> Result<StatusCode, Problem> {
    tasks::delete(&service, &caller, Task::Study, id).await
}

/// The rows found so far, as CSV.
#[utoipa::path(
    get, path = "/v1/studies/{id}/table.csv", tag = document::STUDIES, operation_id = "get_study_table_csv",
    params(("id" = Uuid, Path, description = "The study's id.")),
    responses((status = 200, description = "The table; one line a row.", body = String, content_type = "text/csv"))
)]
pub async fn table_csv(
    State(service): State<Service>,
    Extension(caller): Extension<Caller>,
    JobId(id): JobId,
    headers: HeaderMap,
) -> Result<Response, Problem> {
    found(&service, &caller, id, move |found| found.csv(&headers)).await
}

/// The rows found so far, as columns of text.
#[utoipa::path(
    get, path = "/v1/studies/{id}/table.txt", tag = document::STUDIES, operation_id = "get_study_table_txt",
    params(("id" = Uuid, Path, description = "The study's id.")),
    responses((status = 200, description = "The table, for a reader.", body = String, content_type = "text/plain"))
)]
pub async fn table_txt(
    State(service): State<Service>,
    Extension(caller): Extension<Caller>,
    JobId(id): JobId,
    headers: HeaderMap,
) -> Result<Response, Problem> {
    found(&service, &caller, id, move |found| found.text(&headers)).await
}

/// Error against time so far, on logarithmic scales, one line a method.
///
/// Until every row has been timed, and where `repeats` is 0, what is varied stands in the place of the time.
#[utoipa::path(
    get, path = "/v1/studies/{id}/picture.svg", tag = document::STUDIES, operation_id = "get_study_picture",
    params(("id" = Uuid, Path, description = "The study's id.")),
    responses((status = 200, description = "The picture.", body = String, content_type = "image/svg+xml"))
)]
pub async fn picture(
    State(service): State<Service>,
    Extension(caller): Extension<Caller>,
    JobId(id): JobId,
    headers: HeaderMap,
) -> Result<Response, Problem> {
    found(&service, &caller, id, move |found| found.picture(&headers)).await
}

/// An answer of what a study has found so far; a problem before its first path.
async fn found(
    service: &Service,
    caller: &Caller,
    id: Uuid,
    make: impl FnOnce(SoFar<Report>) -> Result<Response, Problem> + Send + 'static,
) -> Result<Response, Problem> {
    let task = Task::Study;
    let study = service.jobs.find(caller, task, id).await?;
    let lines = if study.report.is_some() { Vec::new() } else { service.jobs.lines_of_study(&study).await? };
    let bytes = study.bytes() + lines.iter().map(|line| line.body.len()).sum::<usize>();
    let made = move || {
        let findings = match &study.report {
            Some(report) => serde_json::from_str(report)?,
            None => studies::found(&study, &lines)?.ok_or_else(|| {
                Problem::not_found(format_args!("table of study {id}: no path of it has been traced yet"))
            })?,
        };
        make(SoFar { task, id, findings, is_finished: study.status.is_ended() })
    };
    service.aside.make(bytes, made).await
}
