//! The path as a table.

use crate::output::Table;
use crate::service::http::answer::problem::Problem;
use crate::service::http::answer::tag::Tag;
use crate::service::http::calls::increments::stored::{Stored, StoredPath};
use crate::service::http::document;
use crate::service::http::state::service::Service;
use crate::service::http::tasks::target::Target;
use crate::service::http::view::job::Job;
use async_stream::try_stream;
use axum::body::Body;
use axum::http::header;
use axum::response::{IntoResponse, Response};
use std::io;
use std::sync::Arc;
use tokio_stream::Stream;
use uuid::Uuid;

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

/// The rows of the table.
fn rows(service: Service, id: Uuid) -> impl Stream<Item = io::Result<String>> {
    try_stream! {
        let mut path = StoredPath::new(service, id);
        let table = Arc::new(path.of_request(Table::of).await?);
        let mut header = table.header();
        while let Some(page) = path.next_page().await? {
            let table = Arc::clone(&table);
            let push = move |text: &mut String, Stored { increment, measure }: Stored| {
                text.push_str(&table.row(&increment, measure.as_ref()));
                Ok(())
            };
            yield path.each(page, std::mem::take(&mut header), push).await?;
        }
    }
}
