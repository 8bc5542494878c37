//! The stored increments of a job, page by page.

use crate::service::http::answer::problem::Problem;
use crate::service::http::document;
use crate::service::http::input::extract::{Parameters, QueryParameters, bounded, index};
use crate::service::http::tasks::target::Target;
use crate::service::http::view::job::{IncrementPage, Job};
use axum::response::Response;
use serde::Deserialize;

const PAGE_DEFAULT: u32 = 1_000;
const PAGE_LARGEST: u32 = 10_000;

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

impl QueryParameters for PageParameters {
    const EXPECTED: &'static [(&'static str, &'static str)] =
        &[("after", "the index of an increment, 0 or more,"), ("limit", "a whole number from 1 to 10000")];
}

/// Increments stored so far, in order.
#[utoipa::path(
    get, path = "/v1/jobs/{id}/increments", tag = document::INCREMENTS, operation_id = "list_increments",
    params(PageParameters),
    responses((status = 200, description = "A page of increments, empty when there are no more for now.", body = IncrementPage))
)]
pub async fn page(
    target: Target<Job>,
    Parameters(parameters): Parameters<PageParameters>,
) -> Result<Response, Problem> {
    let after = index("after", parameters.after)?;
    let rows = bounded("limit", parameters.limit, PAGE_DEFAULT, PAGE_LARGEST)?;
    target.lines(after, rows, |increments, next_after| IncrementPage { increments, next_after }).await
}
