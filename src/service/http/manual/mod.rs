//! The manual as pages for browsers: `render` makes HTML of each chapter once, when the first page is asked for.
//!
//! Texts, pictures and style are part of the program, so that it needs no network and no files. Called by
//! [`crate::service::http::router`].

mod render;

use crate::manual::CHAPTERS;
use crate::service::http::answer::embedded::{PAGE, STYLE, answer, media_type};
use crate::service::http::answer::problem::Problem;
use axum::extract::Path;
use axum::http::HeaderMap;
use axum::response::Response;
use rust_embed::RustEmbed;
use std::collections::BTreeMap;
use std::sync::LazyLock;

/// Pictures of paths, which the program draws.
#[derive(RustEmbed)]
#[folder = "src/check/scenes/pictures/"]
struct PathPictures;

/// Pictures of the dashboard.
#[derive(RustEmbed)]
#[folder = "src/service/http/dashboard/pictures/"]
struct DashboardPictures;

/// The key of the contents among the pages, which no chapter has.
const CONTENTS: &str = "";

/// HTML by the name of the chapter.
static PAGES: LazyLock<BTreeMap<&'static str, String>> = LazyLock::new(|| {
    let chapters: Vec<_> = CHAPTERS.iter().map(|chapter| (chapter, render::rendered(chapter.text))).collect();
    let page = |place| render::page(&chapters, place);
    let of_chapters = chapters.iter().enumerate().map(|(place, (chapter, _))| (chapter.name, page(Some(place))));
    of_chapters.chain([(CONTENTS, page(None))]).collect()
});

/// The contents.
pub async fn contents(headers: HeaderMap) -> Result<Response, Problem> {
    page(CONTENTS, &headers)
}

/// A chapter.
pub async fn chapter(Path(name): Path<String>, headers: HeaderMap) -> Result<Response, Problem> {
    page(&name, &headers)
}

/// How the pages look.
pub async fn style(headers: HeaderMap) -> Result<Response, Problem> {
    answer(STYLE, include_str!("style.css"), &headers)
}

/// A picture of a chapter.
pub async fn picture(Path(name): Path<String>, headers: HeaderMap) -> Result<Response, Problem> {
    let found = PathPictures::get(&name).or_else(|| DashboardPictures::get(&name));
    let file = found.ok_or_else(|| Problem::not_found(format_args!("picture of that name")))?;
    answer(media_type(&name), file.data.into_owned(), &headers)
}

fn page(name: &str, headers: &HeaderMap) -> Result<Response, Problem> {
    let page = PAGES.get(name).ok_or_else(|| {
        let known: Vec<_> = CHAPTERS.iter().map(|chapter| chapter.name).collect();
        Problem::not_found(format_args!("chapter of that name; there are {}", known.join(", ")))
    })?;
    answer(PAGE, page.as_str(), headers)
}
