//! What is kept of ended jobs, and room given back to the disk.

use crate::service::jobs::Jobs;
use std::time::Duration;

/// Between parts of the work, for which the database is not free.
const PAUSE: Duration = Duration::from_millis(20);

/// Drops what is not to be kept, and gives back the room that it took.
pub(crate) async fn tidy(jobs: &Jobs) {
    if let Some(keep) = jobs.settings.keep {
        let mut dropped = 0;
        loop {
            match jobs.store.retire(keep).await {
                Ok(0) => break,
                Ok(count) => dropped += count,
                Err(error) => {
                    tracing::warn!(%error, "ended jobs could not be dropped");
                    break;
                }
            }
            tokio::time::sleep(PAUSE).await;
        }
        if dropped > 0 {
            tracing::info!(dropped, "ended jobs that were not to be kept");
        }
    }
    loop {
        match jobs.store.shrink().await {
            Ok(true) => tokio::time::sleep(PAUSE).await,
            Ok(false) => return,
            Err(error) => {
                tracing::warn!(%error, "room could not be given back to the disk");
                return;
            }
        }
    }
}
