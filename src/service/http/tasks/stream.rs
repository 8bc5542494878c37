//! Streams of increments or rows: server-sent events, or lines of JSON.
//!
//! A stream subscribes to changes before it reads the store, so that no line is missed. Only stored lines are sent, so that a
//! client that resumes receives every index once. Nothing is queued for a slow reader, who is served from the store at its
//! own pace.

use crate::service::http::answer::problem::{Kind, Problem};
use crate::service::http::input::accept::preferred;
use crate::service::http::input::extract::last_event_id;
use crate::service::http::state::service::Service;
use crate::service::http::tasks::resource::Resource;
use crate::service::http::tasks::target::Target;
use crate::service::http::view::curve::Curve;
use crate::service::http::view::job::Job;
use crate::service::http::view::study::StudyWithReport;
use crate::service::http::view::sweep::Sweep;
use crate::service::store::{JobRecord, Line, Page, StoreError, Task};
use async_stream::stream;
use axum::body::Body;
use axum::http::{HeaderMap, header};
use axum::response::{IntoResponse, Response};
use std::io;
use std::pin::pin;
use std::time::{Duration, Instant};
use tokio::time::timeout;
use tokio_stream::{Stream, StreamExt};
use tokio_util::sync::CancellationToken;
use uuid::Uuid;

const NDJSON: &str = "application/x-ndjson";
pub(super) const EVENT_STREAM: &str = "text/event-stream";
const PAGE: Page = Page { rows: 200, bytes: 1 << 20 };
/// Jobs solved by another process may give no signal here; their streams read the store at this interval.
pub(super) const LOOK_AGAIN: Duration = Duration::from_secs(1);
const KEEP_ALIVE: Duration = Duration::from_secs(15);
/// The number of streams that may read the store at a time: half of the store's readers are left for the other calls.
pub const READING_AT_ONCE: usize = 2;
/// After which time a client should reconnect when the service has shut down.
const RETRY: Duration = Duration::from_secs(2);

/// Why a stream of events ends before what it is about.
pub(super) const INTERRUPTED: &str = "the service shuts down or its tokens have changed; reconnect";
pub(super) const UNAVAILABLE: &str = "the store is not available; reconnect";

/// Streams the stored lines of a job, study, sweep or curve as they come: its increments or its rows.
pub async fn stream_lines<T: Resource>(target: Target<T>) -> Result<Response, Problem> {
    let (task, format) = (T::TASK, Format::accepted(&target.headers)?);
    let after = last_event_id(event_name(task), &target.headers)?;
    let until = StreamEnd::of(&target.service);
    target.standing().await?;
    let Target { service, id, .. } = target;
    let followed = Subscription { service, until, task, id, after };
    Ok(match format {
        Format::Events => as_events(events(followed)),
        // Readers of lines pass over empty ones.
        Format::Lines => {
            ([(header::CONTENT_TYPE, NDJSON)], Body::from_stream(kept_alive(lines(followed), "\n"))).into_response()
        }
    })
}

/// The job, study or sweep that a stream is about.
struct Subscription {
    service: Service,
    until: StreamEnd,
    task: Task,
    id: Uuid,
    /// The index of the last line that the client has received.
    after: Option<u64>,
}

/// The signals that end a stream before its job: the service shuts down, or the tokens are replaced, after which a client has
/// to reconnect with a valid token.
pub(super) struct StreamEnd {
    shutdown: CancellationToken,
    exchange: CancellationToken,
}

impl StreamEnd {
    pub(super) fn of(service: &Service) -> Self {
        Self { shutdown: service.shutdown.clone(), exchange: service.access.next_exchange() }
    }

    pub(super) fn is_over(&self) -> bool {
        self.shutdown.is_cancelled() || self.exchange.is_cancelled()
    }

    pub(super) async fn over(&self) {
        tokio::select! {
            () = self.shutdown.cancelled() => {}
            () = self.exchange.cancelled() => {}
        }
    }
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

/// The events of a stream, in order; the last four end it.
enum StreamEvent {
    /// Lines that were read at once.
    Lines(Vec<Line>),
    /// The job, study or sweep has ended; with its JSON.
    Ended(serde_json::Result<String>),
    Deleted,
    Interrupted,
    Failed(StoreError),
}

fn follow(followed: Subscription) -> impl Stream<Item = StreamEvent> {
    let Subscription { service, until, task, id, mut after } = followed;
    stream! {
        let store = service.jobs.store();
        let streams = &service.jobs.metrics().streams;
        let _open = streams.open();
        // The time at which the lines that have still to be read were stored, if known.
        let mut stored: Option<Instant> = None;
        let mut changes = store.job_changes(id);
        loop {
            changes.mark_unchanged();
            // The job before its increments: once it has ended, all of them are there to be read.
            let standing = match in_turn(&service, store.standing(id)).await {
                Ok(Some(standing)) => standing,
                Ok(None) => { yield StreamEvent::Deleted; return; }
                Err(error) => { yield StreamEvent::Failed(error); return; }
            };
            while after < standing.last_index && !until.is_over() {
                let page = match in_turn(&service, store.increments(id, after, PAGE)).await {
                    Ok(page) => page,
                    Err(error) => { yield StreamEvent::Failed(error); return; }
                };
                // Deleted meanwhile.
                let Some(last) = page.last() else { break };
                after = Some(last.index);
                if let Some(at) = stored.take() {
                    streams.sent_after(at.elapsed());
                }
                yield StreamEvent::Lines(page);
            }
            if until.is_over() {
                yield StreamEvent::Interrupted;
                return;
            }
            if standing.status.is_ended() {
                yield match store.job(id).await {
                    Ok(Some(job)) => StreamEvent::Ended(service.offload.run(job.bytes(), move || end(task, job)).await),
                    Ok(None) => StreamEvent::Deleted,
                    Err(error) => StreamEvent::Failed(error),
                };
                return;
            }
            // Lines that come with the signal are sent at once; other lines are read from the store.
            loop {
                stored = None;
                tokio::select! {
                    () = until.over() => break,
                    () = tokio::time::sleep(LOOK_AGAIN) => break,
                    _ = changes.changed() => {}
                }
                let change = changes.borrow_and_update().clone();
                stored = change.at;
                let Some(latest) = change.latest else { break };
                let Some(lines) = latest.beyond(after) else { break };
                if let Some(last) = lines.last() {
                    after = Some(last.index);
                    if let Some(at) = stored.take() {
                        streams.sent_after(at.elapsed());
                    }
                    yield StreamEvent::Lines(lines.to_vec());
                }
                if change.ended {
                    break;
                }
            }
        }
    }
}

pub(super) async fn in_turn<T>(service: &Service, reading: impl Future<Output = T>) -> T {
    // The semaphore is never closed.
    let _turn = service.stream_turns.acquire().await;
    reading.await
}

/// Parts of a body, and `waiting` where none has come for a while: readers and what stands between can tell a quiet stream from
/// a dead one.
pub(super) fn kept_alive(
    parts: impl Stream<Item = io::Result<String>>,
    waiting: &'static str,
) -> impl Stream<Item = io::Result<String>> {
    stream! {
        let mut parts = pin!(parts);
        loop {
            match timeout(KEEP_ALIVE, parts.next()).await {
                Ok(Some(part)) => yield part,
                Ok(None) => return,
                Err(_) => yield Ok(waiting.to_owned()),
            }
        }
    }
}

/// Server-sent events, with comments between them.
pub(super) fn as_events(parts: impl Stream<Item = String> + Send + 'static) -> Response {
    let as_they_come = [(header::CONTENT_TYPE, EVENT_STREAM), (header::CACHE_CONTROL, "no-cache")];
    (as_they_come, Body::from_stream(kept_alive(parts.map(Ok), ": waiting\n\n"))).into_response()
}

fn events(followed: Subscription) -> impl Stream<Item = String> {
    // The span of a request ends with the head of its answer; later log messages of the stream belong to the span, too.
    let span = tracing::Span::current();
    let (task, id) = (followed.task, followed.id);
    follow(followed).map(move |happening| {
        span.in_scope(|| match happening {
            // One chunk for all lines, as each chunk is sent separately.
            StreamEvent::Lines(lines) => {
                let name = event_name(task);
                let event = |line: &Line| format!("event: {name}\nid: {}\ndata: {}\n\n", line.index, line.body);
                lines.iter().map(event).collect()
            }
            StreamEvent::Ended(written) => last_event(id, written),
            StreamEvent::Deleted => format!("event: deleted\ndata: {{\"id\":\"{id}\"}}\n\n"),
            StreamEvent::Interrupted => come_back(INTERRUPTED),
            StreamEvent::Failed(error) => {
                tracing::error!(%error, job = %id, "a stream failed");
                come_back(UNAVAILABLE)
            }
        })
    })
}

fn last_event(id: Uuid, written: serde_json::Result<String>) -> String {
    match written {
        Ok(job) => format!("event: end\ndata: {job}\n\n"),
        Err(error) => {
            tracing::error!(%error, job = %id, "the end cannot be written");
            come_back("the job cannot be read")
        }
    }
}

pub(super) fn come_back(why: &str) -> String {
    format!("retry: {}\n: {why}\n\n", RETRY.as_millis())
}

fn event_name(task: Task) -> &'static str {
    match task {
        Task::Path => "increment",
        Task::Study | Task::Sweep | Task::Curve => "row",
    }
}

fn end(task: Task, job: JobRecord) -> serde_json::Result<String> {
    match task {
        Task::Path => serde_json::to_string(&Job::try_from(job)?),
        Task::Study => serde_json::to_string(&StudyWithReport::try_from(job)?),
        Task::Sweep => serde_json::to_string(&Sweep::try_from(job)?),
        Task::Curve => serde_json::to_string(&Curve::try_from(job)?),
    }
}

/// The line after the last row of a study, sweep or curve; a path has none, as its last increment shows that it is the last.
fn closing_line(task: Task, written: serde_json::Result<String>) -> Option<io::Result<String>> {
    match task {
        Task::Path => None,
        Task::Study | Task::Sweep | Task::Curve => Some(written.map(|whole| whole + "\n").map_err(|error| {
            tracing::error!(%error, "the end cannot be written");
            io::Error::other("the result cannot be read")
        })),
    }
}

fn lines(followed: Subscription) -> impl Stream<Item = io::Result<String>> {
    // An error truncates the body, so that a client can tell a complete path from a part of one.
    let broken = |why: &str| Some(Err(io::Error::other(why.to_owned())));
    let span = tracing::Span::current();
    let (task, id) = (followed.task, followed.id);
    follow(followed).filter_map(move |happening| {
        let _entered = span.enter();
        match happening {
            // One chunk for all lines, as each chunk is sent separately.
            StreamEvent::Lines(lines) => Some(Ok(lines.into_iter().map(|line| line.body + "\n").collect())),
            StreamEvent::Ended(written) => closing_line(task, written),
            StreamEvent::Deleted => broken("the job was deleted"),
            StreamEvent::Interrupted => broken("the service shuts down or its tokens have changed"),
            StreamEvent::Failed(error) => {
                tracing::error!(%error, job = %id, "a stream failed");
                broken("the store is not available")
            }
        }
    })
}
