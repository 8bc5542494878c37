//! The path as a table.

use crate::check::measure::Errors;
use crate::output::Table;
use crate::result::increment::Increment;
use crate::service::http::answer::problem::Problem;
use crate::service::http::answer::tag::Tag;
use crate::service::http::document;
use crate::service::http::state::service::Service;
use crate::service::http::tasks::target::Target;
use crate::service::http::view::job::Job;
use crate::service::store::Page;
use async_stream::try_stream;
use axum::body::Body;
use axum::http::header;
use axum::response::{IntoResponse, Response};
use serde::Deserialize;
use std::io;
use std::sync::Arc;
use tokio_stream::Stream;
use uuid::Uuid;

const PAGE: Page = Page { rows: 500, bytes: 1 << 20 };

/// The increments stored so far, one row each.
///
/// The first line names the columns: `index, stage, load_factor, arc_length, step, point, bifurcation, event`, then
/// `node.x`, `node.y` for every node, `node/obstacle.status`, `.gap`, `.normal_reaction`, `.tangential_reaction.1`,
/// `.slip.1` for every contact, the energies, the diagnostics, and the figures of the measure as `measure.equilibrium` and
/// so on. A path without increments has no lines at all. Names that a spreadsheet would take for formulas, those that begin
/// with `=`, `+`, `-` or `@`, have an apostrophe before them; numbers have none.
#[utoipa::path(
    get, path = "/v1/jobs/{id}/path.csv", tag = document::INCREMENTS, operation_id = "get_path_csv",
    responses((status = 200, description = "The table.", body = String, content_type = "text/csv"))
)]
pub async fn path_csv(target: Target<Job>) -> Result<Response, Problem> {
    let job = target.standing().await?;
    let Target { service, id, headers, .. } = target;
    let own = [
        (header::CONTENT_TYPE, "text/csv; charset=utf-8".to_owned()),
        (header::CONTENT_DISPOSITION, format!("attachment; filename=\"path-{id}.csv\"")),
    ];
    let make = || Ok((own, Body::from_stream(rows(service, id))).into_response());
    if !job.status.is_ended() {
        return make();
    }
    // Increments never change and an ended job gets no more: their last index determines the table.
    Tag::of(format!("{id} {:?}", job.last_index).as_bytes()).answer(&headers, make)
}

/// A stored increment.
#[derive(Deserialize)]
struct Stored {
    #[serde(flatten)]
    increment: Increment,
    /// Absent from increments that older versions have stored.
    #[serde(default)]
    measure: Option<Errors>,
}

/// The rows of the table. One page of increments is read at a time, so that memory does not grow with the path.
fn rows(service: Service, id: Uuid) -> impl Stream<Item = io::Result<String>> {
    try_stream! {
        let mut after = None;
        let request = service.jobs.store().request(id).await.map_err(io::Error::other)?;
        let request = request.ok_or_else(|| io::Error::other("the job has been deleted"))?;
        let bytes = request.len();
        let read = move || serde_json::from_str(&request).map(|request| Table::of(&request));
        let table = Arc::new(service.offload.run(bytes, read).await?);
        loop {
            let page = service.jobs.store().increments(id, after, PAGE).await.map_err(io::Error::other)?;
            let Some(last) = page.last() else { break };
            let mut text = if after.is_none() { table.header() } else { String::new() };
            after = Some(last.index);
            let bytes = page.iter().map(|line| line.body.len()).sum();
            let table = Arc::clone(&table);
            let write = move || {
                for line in &page {
                    let Stored { increment, measure } = serde_json::from_str(&line.body)?;
                    text.push_str(&table.row(&increment, measure.as_ref()));
                }
                Ok::<_, io::Error>(text)
            };
            yield service.offload.run(bytes, write).await?;
        }
    }
}
