//! Built-in scenes as they are listed.

use serde::Serialize;
use utoipa::ToSchema;

/// A built-in scene.
#[derive(Debug, Serialize, ToSchema)]
pub struct SceneSummary {
    pub name: &'static str,
    /// What it shows.
    pub shows: &'static str,
    /// Where its job request is, ready to post.
    pub link: String,
}

#[derive(Debug, Serialize, ToSchema)]
pub struct SceneList {
    pub scenes: Vec<SceneSummary>,
}
