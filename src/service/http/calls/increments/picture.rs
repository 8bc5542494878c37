//! The picture of a path: load factor against a displacement, as `arcslip solve --plot` draws it.

use crate::result::increment::Increment;
use crate::service::http::answer::problem::{Kind, Problem};
use crate::service::http::answer::tag;
use crate::service::http::calls::increments::stored::{Stored, StoredPath};
use crate::service::http::document;
use crate::service::http::input::extract::{Parameters, QueryParameters};
use crate::service::http::tasks::target::Target;
use crate::service::http::view::job::Job;
use crate::studies::picture::PlotError;
use crate::studies::picture::path::{Against, Curve, Farthest, draw_curve};
use crate::studies::picture::raster::png;
use axum::http::header;
use axum::response::Response;
use serde::Deserialize;
use std::io;

/// Most increments of a picture, as all its points are held in memory.
const MOST_POINTS: u64 = 100_000;
/// Bytes of a point of the curve, with what its drawing takes.
const BYTES_OF_A_POINT: usize = 1_000;

#[derive(Debug, Deserialize, utoipa::IntoParams)]
#[serde(deny_unknown_fields)]
#[into_params(parameter_in = Query)]
pub struct PictureParameters {
    /// What to draw: a displacement `NODE.COMPONENT`, such as `tip.x`, or a column of `path.csv`. Default: the largest
    /// displacement.
    against: Option<String>,
}

impl QueryParameters for PictureParameters {
    const EXPECTED: &'static [(&'static str, &'static str)] =
        &[("against", "NODE.COMPONENT, such as `tip.x`, or a column")];
}

/// Load factor against a displacement over the increments stored so far, as SVG.
#[utoipa::path(
    get, path = "/v1/jobs/{id}/picture.svg", tag = document::INCREMENTS, operation_id = "get_path_picture",
    params(PictureParameters),
    responses((status = 200, description = "The picture.", body = String, content_type = "image/svg+xml"))
)]
pub async fn svg(
    target: Target<Job>,
    Parameters(parameters): Parameters<PictureParameters>,
) -> Result<Response, Problem> {
    picture(target, parameters.against, "image/svg+xml", |svg| Ok(svg.into_bytes())).await
}

/// The same as PNG, with twice as many pixels.
#[utoipa::path(
    get, path = "/v1/jobs/{id}/picture.png", tag = document::INCREMENTS, operation_id = "get_path_picture_png",
    params(PictureParameters),
    responses((status = 200, description = "The picture.", body = Vec<u8>, content_type = "image/png"))
)]
pub async fn raster(
    target: Target<Job>,
    Parameters(parameters): Parameters<PictureParameters>,
) -> Result<Response, Problem> {
    picture(target, parameters.against, "image/png", |svg| png(&svg)).await
}

async fn picture(
    target: Target<Job>,
    against: Option<String>,
    media_type: &'static str,
    encode: impl FnOnce(String) -> Result<Vec<u8>, PlotError> + Send + 'static,
) -> Result<Response, Problem> {
    let job = target.standing().await?;
    if job.last_index.is_some_and(|last| last >= MOST_POINTS) {
        let detail = format!("the path has more than {MOST_POINTS} increments; `columns` has the values page by page");
        return Err(Problem::new(Kind::AnswerTooLarge, detail));
    }
    let Target { service, id, headers, .. } = target;
    let offload = service.offload.clone();
    let mut path = StoredPath::new(service, id);
    let model = path.of_request(|request| request.model.clone()).await?;
    let nothing = |why: &str| Problem::not_found(format_args!("picture of job {id}: {why}"));
    let against = match against {
        Some(text) => {
            let asked = path.of_request(move |request| Against::read(&text, request)).await?;
            asked.map_err(|error| nothing(&format!("against {error}")))?
        }
        None => {
            let farthest = over_path(&mut path, job.last_index, Farthest::of(&model), Farthest::push).await?;
            path.rewind();
            farthest.found().ok_or_else(|| nothing("no displacement of it is recorded"))?
        }
    };
    let curve = over_path(&mut path, job.last_index, Curve::new(&model, against), Curve::push).await?;
    let bytes = BYTES_OF_A_POINT * curve.places().count();
    match offload.run(bytes, move || draw_curve(&curve).and_then(encode)).await {
        Ok(drawn) => tag::bytes(&headers, job.status.is_ended(), [(header::CONTENT_TYPE, media_type)], drawn),
        Err(PlotError::Drawing(error)) => {
            tracing::error!(%error, %id, "a picture cannot be drawn");
            Err(Problem::internal())
        }
        Err(_) => Err(nothing("no increment of it has that number")),
    }
}

/// Does for every increment up to the last one that was there what changes a state: a path that grows meanwhile adds none.
async fn over_path<T: Send + 'static>(
    path: &mut StoredPath,
    last: Option<u64>,
    mut state: T,
    change: fn(&mut T, &Increment),
) -> io::Result<T> {
    let is_there = move |index: u64| last.is_some_and(|last| index <= last);
    while let Some(page) = path.next_page().await? {
        let grows = page.last().is_some_and(|line| !is_there(line.index));
        let push = move |state: &mut T, Stored { increment, .. }: Stored| {
            if is_there(increment.index) {
                change(state, &increment);
            }
            Ok(())
        };
        state = path.each(page, state, push).await?;
        if grows {
            break;
        }
    }
    Ok(state)
}
