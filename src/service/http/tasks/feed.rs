//! The feed of all changes that a caller may see: each job, study and sweep as it is after it has changed.
//!
//! The store numbers the changes, so that any process of the service goes on where another has stopped. Nothing is kept for a
//! reader: what changes while the reader is slow is sent once, as it is then.

use crate::service::http::answer::problem::Problem;
use crate::service::http::input::extract::feed_position;
use crate::service::http::state::service::Service;
use crate::service::http::tasks::requester::Requester;
use crate::service::http::tasks::stream::{
    INTERRUPTED, LOOK_AGAIN, StreamEnd, UNAVAILABLE, as_events, come_back, in_turn,
};
use crate::service::http::view::change::{ChangedTask, DeletedTask, event_id};
use crate::service::store::{FeedEntry, FeedPosition};
use async_stream::stream;
use axum::http::HeaderMap;
use axum::response::Response;
use serde::Serialize;
use std::time::Duration;
use tokio_stream::Stream;

/// The most changes that are read at once.
const CHANGES_AT_ONCE: u32 = 200;
/// Changes within this time are read together.
const GATHERED: Duration = Duration::from_millis(100);

/// Streams what changes from now on, or has changed since the event that the client had last.
///
/// # Errors
/// The header `Last-Event-ID` is given more than once.
pub fn stream_changes(requester: Requester, headers: &HeaderMap) -> Result<Response, Problem> {
    let Requester { service, caller } = requester;
    let after = feed_position(headers)?;
    Ok(as_events(events(service, caller.seen_owner().map(str::to_owned), after)))
}

fn events(service: Service, owner: Option<String>, mut after: Option<FeedPosition>) -> impl Stream<Item = String> {
    let span = tracing::Span::current();
    let until = StreamEnd::of(&service);
    stream! {
        let store = service.jobs.store();
        let _open = service.jobs.metrics().streams.open();
        let mut changes = store.any_change();
        while !until.is_over() {
            changes.mark_unchanged();
            let page = match in_turn(&service, store.changes(owner.as_deref(), after, CHANGES_AT_ONCE)).await {
                Ok(page) => page,
                Err(error) => {
                    span.in_scope(|| tracing::error!(%error, "the feed of changes failed"));
                    yield come_back(UNAVAILABLE);
                    return;
                }
            };
            after = Some(page.end);
            if page.begins {
                yield event("begin", page.end, &serde_json::json!({}));
            }
            if !page.entries.is_empty() {
                yield page.entries.into_iter().map(told).collect::<String>();
            }
            if page.more {
                continue;
            }
            tokio::select! {
                () = until.over() => {}
                () = tokio::time::sleep(LOOK_AGAIN) => {}
                _ = changes.changed() => tokio::select! {
                    () = until.over() => {}
                    () = tokio::time::sleep(GATHERED) => {}
                },
            }
        }
        yield come_back(INTERRUPTED);
    }
}

fn told(FeedEntry { at, task, job }: FeedEntry) -> String {
    match job {
        Some(record) => event("changed", at, &ChangedTask::from(record)),
        None => event("deleted", at, &DeletedTask { kind: task.into(), id: at.id }),
    }
}

fn event(name: &str, at: FeedPosition, data: &impl Serialize) -> String {
    match serde_json::to_string(data) {
        Ok(data) => format!("event: {name}\nid: {}\ndata: {data}\n\n", event_id(at)),
        Err(error) => {
            tracing::error!(%error, "a change cannot be written");
            String::new()
        }
    }
}
