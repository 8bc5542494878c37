//! The built-in scenes, ready to post.

use crate::check::scenes;
use crate::model::JobRequest;
use crate::model::input::names::suggestion_of_all;
use crate::service::http::answer::problem::Problem;
use crate::service::http::document;
use crate::service::http::view::scene::{SceneList, SceneSummary};
use axum::Json;
use axum::extract::Path;
use axum::http::header;
use axum::response::IntoResponse;

/// List the built-in scenes.
#[utoipa::path(
    get, path = "/v1/scenes", tag = document::SCENES, operation_id = "list_scenes",
    responses((status = 200, description = "Every built-in scene.", body = SceneList))
)]
pub async fn list() -> Json<SceneList> {
    let scenes = scenes::ALL
        .iter()
        .map(|scene| SceneSummary { name: scene.name, shows: scene.shows, link: format!("/v1/scenes/{}", scene.name) })
        .collect();
    Json(SceneList { scenes })
}

/// The job request of a built-in scene, ready to post.
#[utoipa::path(
    get, path = "/v1/scenes/{name}", tag = document::SCENES, operation_id = "get_scene",
    params(("name" = String, Path, description = "The scene's name.")),
    responses((status = 200, description = "The job request.", body = JobRequest))
)]
pub async fn get(Path(name): Path<String>) -> Result<impl IntoResponse, Problem> {
    let scene = scenes::find(&name).ok_or_else(|| {
        let nearest = suggestion_of_all(&name, scenes::ALL.iter().map(|scene| scene.name));
        Problem::not_found(format_args!("scene of that name{nearest}; GET /v1/scenes lists them"))
    })?;
    Ok(([(header::CONTENT_TYPE, "application/json")], scene.request))
}
