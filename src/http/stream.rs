//! Increments as they converge: server-sent events, or lines of JSON.
//!
//! A stream subscribes first and reads the store then, again and again: whatever is stored after a reading wakes it, so
//! there is no gap, and only what is stored is sent, so that a client which resumes sees every index once. Nothing is
//! queued for a slow reader; it is served from the store at its own pace.

use super::accept::preferred;
use super::extract::{JobId, last_event_id};
use super::problem::{Kind, Problem};
use super::view::{Job, ServerEvent};
use super::view_study::StudyWithReport;
use super::{Service, document};
use crate::jobs::Caller;
use crate::judged::JudgedIncrement;
use crate::store::{JobRecord, Line, Page, StoreError, Task};
use async_stream::stream;
use axum::Extension;
use axum::body::Body;
use axum::extract::State;
use axum::http::{HeaderMap, header};
use axum::response::sse::{Event, KeepAlive, Sse};
use axum::response::{IntoResponse, Response};
use std::convert::Infallible;
use std::io;
use std::time::Duration;
use tokio_stream::{Stream, StreamExt};
use uuid::Uuid;

const NDJSON: &str = "application/x-ndjson";
const EVENT_STREAM: &str = "text/event-stream";
const PAGE: Page = Page { rows: 200, bytes: 1 << 20 };
/// Jobs solved by another process give no signal here; their streams look so often.
const LOOK_AGAIN: Duration = Duration::from_secs(1);
const KEEP_ALIVE: Duration = Duration::from_secs(15);
/// When a client should come back after the service went down.
const RETRY: Duration = Duration::from_secs(2);

/// Follow a job: its increments as they converge, then its end.
///
/// As server-sent events: `increment` events whose id is the index, then one `end` event with the job. A client that
/// comes back with `Last-Event-ID` goes on after that index, without gap or repeat. When the service goes down the stream
/// ends without `end`, after a `retry:`; a deleted job ends its streams with a `deleted` event.
///
/// With `Accept: application/x-ndjson`: one increment a line and nothing else; the answer is complete when the job has
/// ended, and breaks off (without the last chunk) otherwise.
#[utoipa::path(
    get, path = "/v1/jobs/{id}/stream", tag = document::INCREMENTS, operation_id = "stream_increments",
    params(
        ("id" = Uuid, Path, description = "The job's id."),
        ("Last-Event-ID" = Option<u64>, Header, description = "Index of the last increment received.")
    ),
    responses((status = 200, description = "Increments in order of their index.", content(
        (ServerEvent = "text/event-stream"),
        (JudgedIncrement = "application/x-ndjson")
    )))
)]
pub async fn stream(
    State(service): State<Service>,
    Extension(caller): Extension<Caller>,
    JobId(id): JobId,
    headers: HeaderMap,
) -> Result<Response, Problem> {
    answer(service, &caller, Task::Path, id, &headers).await
}

/// The lines of a job of that task as they come.
pub(super) async fn answer(
    service: Service,
    caller: &Caller,
    task: Task,
    id: Uuid,
    headers: &HeaderMap,
) -> Result<Response, Problem> {
    let format = Format::accepted(headers)?;
    let after = last_event_id(event_name(task), headers)?;
    service.jobs.find(caller, task, id).await?;
    Ok(match format {
        Format::Events => Sse::new(events(service, task, id, after))
            .keep_alive(KeepAlive::new().interval(KEEP_ALIVE).text("waiting"))
            .into_response(),
        Format::Lines => {
            ([(header::CONTENT_TYPE, NDJSON)], Body::from_stream(lines(service, task, id, after))).into_response()
        }
    })
}

enum Format {
    Events,
    Lines,
}

impl Format {
    fn accepted(headers: &HeaderMap) -> Result<Self, Problem> {
        match preferred(headers, &[EVENT_STREAM, NDJSON]) {
            Some(0) => Ok(Self::Events),
            Some(_) => Ok(Self::Lines),
            None => Err(Problem::new(Kind::NotAcceptable, format!("offered are {EVENT_STREAM} and {NDJSON}"))),
        }
    }
}

/// What happens on a stream, in order; the last four end it.
enum Happening {
    Line(Line),
    Ended(Box<JobRecord>),
    Deleted,
    ShuttingDown,
    Failed(StoreError),
}

fn follow(service: Service, id: Uuid, mut after: Option<u64>) -> impl Stream<Item = Happening> {
    stream! {
        let store = service.jobs.store();
        let mut changes = store.job_changes(id);
        loop {
            changes.borrow_and_update();
            // The job before its increments: once it has ended, all of them are there to be read.
            let job = match store.job(id).await {
                Ok(Some(job)) => job,
                Ok(None) => { yield Happening::Deleted; return; }
                Err(error) => { yield Happening::Failed(error); return; }
            };
            loop {
                let page = match store.increments(id, after, PAGE).await {
                    Ok(page) => page,
                    Err(error) => { yield Happening::Failed(error); return; }
                };
                let Some(last) = page.last() else { break };
                after = Some(last.index);
                for line in page {
                    yield Happening::Line(line);
                }
                if service.shutdown.is_cancelled() {
                    break;
                }
            }
            if service.shutdown.is_cancelled() {
                yield Happening::ShuttingDown;
                return;
            }
            if job.status.is_ended() {
                yield Happening::Ended(Box::new(job));
                return;
            }
            tokio::select! {
                () = service.shutdown.cancelled() => {}
                _ = changes.changed() => {}
                () = tokio::time::sleep(LOOK_AGAIN) => {}
            }
        }
    }
}

fn events(service: Service, task: Task, id: Uuid, after: Option<u64>) -> impl Stream<Item = Result<Event, Infallible>> {
    // The request's span ends with its answer's head; what a stream has to say later still belongs to it.
    let span = tracing::Span::current();
    follow(service, id, after).map(move |happening| {
        let _entered = span.enter();
        let retry = || Event::default().retry(RETRY);
        Ok(match happening {
            Happening::Line(line) => {
                Event::default().event(event_name(task)).id(line.index.to_string()).data(line.body)
            }
            Happening::Ended(job) => match end(task, *job) {
                Ok(job) => Event::default().event("end").data(job),
                Err(error) => {
                    tracing::error!(%error, job = %id, "the end cannot be written");
                    retry().comment("the job cannot be read")
                }
            },
            Happening::Deleted => Event::default().event("deleted").data(format!("{{\"id\":\"{id}\"}}")),
            Happening::ShuttingDown => retry().comment("the service is going down; come back"),
            Happening::Failed(error) => {
                tracing::error!(%error, job = %id, "a stream broke off");
                retry().comment("the store is not available; come back")
            }
        })
    })
}

fn event_name(task: Task) -> &'static str {
    match task {
        Task::Path => "increment",
        Task::Study => "row",
    }
}

fn end(task: Task, job: JobRecord) -> serde_json::Result<String> {
    match task {
        Task::Path => serde_json::to_string(&Job::try_from(job)?),
        Task::Study => serde_json::to_string(&StudyWithReport::try_from(job)?),
    }
}

/// What follows the last line of a path, which says itself that it is the end, or of a study, which does not.
fn closing_line(task: Task, job: JobRecord) -> Option<io::Result<String>> {
    match task {
        Task::Path => None,
        Task::Study => Some(end(task, job).map(|study| study + "\n").map_err(|error| {
            tracing::error!(%error, "the end cannot be written");
            io::Error::other("the study cannot be read")
        })),
    }
}

fn lines(service: Service, task: Task, id: Uuid, after: Option<u64>) -> impl Stream<Item = io::Result<String>> {
    // An error breaks the body off, so that a client can tell a whole path from a part of one.
    let broken = |why: &str| Some(Err(io::Error::other(why.to_owned())));
    let span = tracing::Span::current();
    follow(service, id, after).filter_map(move |happening| {
        let _entered = span.enter();
        match happening {
            Happening::Line(line) => Some(Ok(line.body + "\n")),
            Happening::Ended(job) => closing_line(task, *job),
            Happening::Deleted => broken("the job was deleted"),
            Happening::ShuttingDown => broken("the service is going down"),
            Happening::Failed(error) => {
                tracing::error!(%error, job = %id, "a stream broke off");
                broken("the store is not available")
            }
        }
    })
}
