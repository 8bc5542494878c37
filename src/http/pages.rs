//! What a browser sees first, and the OpenAPI document.

use axum::http::header;
use axum::response::{Html, IntoResponse};
use std::sync::Arc;

/// A list of what there is.
pub async fn index() -> Html<&'static str> {
    Html(include_str!("index.html"))
}

pub async fn openapi(document: Arc<str>) -> impl IntoResponse {
    ([(header::CONTENT_TYPE, "application/json")], document.to_string())
}
