//! The dashboard: a page with scripts and styles that are part of the program, so that it needs no network and no files.
//!
//! The page is in `page/`: plain ES modules that use the calls of version 1 and nothing else. The plotting library
//! is in `plotly/`. Called by [`crate::service::http::router`].

mod plotly;

use crate::service::http::answer::embedded::{answer, media_type};
use crate::service::http::answer::problem::Problem;
use axum::extract::Path;
use axum::http::HeaderMap;
use axum::response::Response;
use rust_embed::RustEmbed;

/// Read from the folder in a debug build, part of the program in a release build.
#[derive(RustEmbed)]
#[folder = "src/service/http/dashboard/page/"]
struct Page;

/// The page.
pub async fn index(headers: HeaderMap) -> Result<Response, Problem> {
    embedded("index.html", &headers)
}

/// Scripts, styles and pictures of the page.
pub async fn asset(Path(name): Path<String>, headers: HeaderMap) -> Result<Response, Problem> {
    if name == plotly::NAME { plotly::PLOTLY.answer(&headers).await } else { embedded(&name, &headers) }
}

fn embedded(name: &str, headers: &HeaderMap) -> Result<Response, Problem> {
    let file = Page::get(name).ok_or_else(|| Problem::not_found(format_args!("part of the page of that name")))?;
    answer(media_type(name), file.data.into_owned(), headers)
}
