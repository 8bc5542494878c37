//! The OpenAPI document.

use axum::http::header;
use axum::response::IntoResponse;
use std::sync::Arc;

pub async fn openapi(document: Arc<str>) -> impl IntoResponse {
    ([(header::CONTENT_TYPE, "application/json")], document.to_string())
}
