//! The page of the calls, to read and to try: Swagger UI (Apache licence 2.0, see `LICENSE` and `NOTICE`), which shows
//! `/openapi.json`. `renew.py` makes its files of a released package. Called by [`crate::service::http::router`].

use crate::service::http::answer::embedded::{PAGE, Packed, SCRIPT, STYLE, answer};
use crate::service::http::answer::problem::Problem;
use axum::extract::Path;
use axum::http::HeaderMap;
use axum::response::{Redirect, Response};

static BUNDLE: Packed = Packed::new(include_bytes!("swagger-ui-bundle.js.gz"), SCRIPT);
static SWAGGER_STYLE: Packed = Packed::new(include_bytes!("swagger-ui.css.gz"), STYLE);

/// `/docs` leads to the page, whose parts are named relative to its folder.
pub async fn folder() -> Redirect {
    Redirect::to("/docs/")
}

/// The page.
pub async fn index(headers: HeaderMap) -> Result<Response, Problem> {
    answer(PAGE, include_str!("index.html"), &headers)
}

/// Scripts and styles of the page.
pub async fn asset(Path(name): Path<String>, headers: HeaderMap) -> Result<Response, Problem> {
    match name.as_str() {
        "swagger-ui-bundle.js" => BUNDLE.answer(&headers).await,
        "swagger-ui.css" => SWAGGER_STYLE.answer(&headers).await,
        "start.js" => answer(SCRIPT, include_str!("start.js"), &headers),
        _ => Err(Problem::not_found(format_args!("part of the page of that name"))),
    }
}
