//! Queues the directions that ended paths have not taken; [`Alternatives`](crate::check::judged::Alternatives) says which.

use crate::service::jobs::Jobs;

/// Queues what ended jobs have found; what fails now is found again the next time.
pub(crate) async fn queue(jobs: &Jobs) {
    match jobs.store.explore().await {
        Ok(0) => {}
        Ok(count) => tracing::info!(count, "directions not taken were queued"),
        Err(error) => tracing::warn!(%error, "directions not taken could not be queued"),
    }
}
