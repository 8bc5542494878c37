//! Stored increments, a page at a time.

use super::extract::{JobId, Parameters, Taken, bounded, index};
use super::problem::Problem;
use super::view::IncrementPage;
use super::{Service, document, tag, tasks};
use crate::jobs::Caller;
use crate::store::{Page, Task};
use axum::Extension;
use axum::extract::State;
use axum::http::HeaderMap;
use axum::response::Response;
use serde::Deserialize;

const PAGE_DEFAULT: u32 = 1_000;
const PAGE_LARGEST: u32 = 10_000;
/// A page ends early when its increments are large.
const PAGE_BYTES: usize = 1 << 20;

#[derive(Debug, Deserialize, utoipa::IntoParams)]
#[serde(deny_unknown_fields)]
#[into_params(parameter_in = Query)]
pub struct PageParameters {
    /// Only increments with a larger index: `next_after` of the page before.
    after: Option<u64>,
    /// Increments at most; a page of large increments may hold fewer and not be the last.
    #[param(minimum = 1, maximum = 10_000, default = 1_000)]
    limit: Option<u32>,
}

impl Taken for PageParameters {
    const TAKEN: &'static [(&'static str, &'static str)] =
        &[("after", "the index of an increment, 0 or more,"), ("limit", "a whole number from 1 to 10000")];
}

/// Increments stored so far, in order.
#[utoipa::path(
    get, path = "/v1/jobs/{id}/increments", tag = document::INCREMENTS, operation_id = "list_increments",
    params(("id" = Uuid, Path, description = "The job's id."), PageParameters),
    responses((status = 200, description = "A page of increments, empty when there are no more for now.", body = IncrementPage))
)]
pub async fn page(
    State(service): State<Service>,
    Extension(caller): Extension<Caller>,
    JobId(id): JobId,
    Parameters(parameters): Parameters<PageParameters>,
    headers: HeaderMap,
) -> Result<Response, Problem> {
    let after = index("after", parameters.after)?;
    let rows = bounded("limit", parameters.limit, PAGE_DEFAULT, PAGE_LARGEST)?;
    let store = service.jobs.store();
    let is_finished = service.jobs.standing(&caller, Task::Path, id).await?.status.is_ended();
    let lines = store.increments(id, after, Page { rows, bytes: PAGE_BYTES }).await?;
    let next_after = lines.last().map(|line| line.index).or(after);
    let make = move |increments| tag::json(&headers, is_finished, &IncrementPage { increments, next_after });
    tasks::of_lines(&service, lines, make).await
}
