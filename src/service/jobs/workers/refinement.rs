//! Adds runs to sweeps where their response changes most, when all of their runs so far have ended.

use crate::service::jobs::Jobs;

/// Queues the next runs of such sweeps, or ends them; after a failure the next call finds them again.
pub(crate) async fn queue(jobs: &Jobs) {
    let sweeps = match jobs.store.refinable_sweeps().await {
        Ok(sweeps) => sweeps,
        Err(error) => return tracing::warn!(%error, "sweeps could not be refined"),
    };
    for id in sweeps {
        match jobs.refine_sweep(id).await {
            Ok(0) => {}
            Ok(count) => tracing::info!(sweep = %id, count, "runs were added to a sweep"),
            Err(error) => tracing::warn!(sweep = %id, %error, "a sweep could not be refined"),
        }
    }
}
