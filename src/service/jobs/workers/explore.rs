//! Queues jobs for the directions that ended paths have not taken; [`Alternatives`](crate::check::judged::Alternatives) lists
//! these directions.

use crate::service::jobs::Jobs;

/// Queues the alternatives of ended jobs; after a failure the next call finds them again.
pub(crate) async fn queue(jobs: &Jobs) {
    match jobs.store.explore().await {
        Ok(0) => {}
        Ok(count) => tracing::info!(count, "directions not taken were queued"),
        Err(error) => tracing::warn!(%error, "directions not taken could not be queued"),
    }
}
