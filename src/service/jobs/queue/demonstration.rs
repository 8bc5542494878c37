//! Queues the built-in scenes as jobs, for a first look at the service.

use crate::check::scenes;
use crate::service::jobs::{Caller, Jobs, JobsError};

/// Queues every built-in scene once: an idempotency key prevents a second job.
pub async fn queue_scenes(jobs: &Jobs) -> Result<(), JobsError> {
    for scene in scenes::ALL {
        let key = format!("demonstration/{}", scene.name);
        match jobs.submit(&Caller::Anyone, scene.request.as_bytes().to_vec(), Some(key)).await {
            Ok(_) => {}
            // Queued from another version of the scene, whose job is kept.
            Err(JobsError::KeyReused) => tracing::info!(scene = scene.name, "already queued from an earlier version"),
            Err(error) => return Err(error),
        }
    }
    Ok(())
}
