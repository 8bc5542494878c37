//! Deletes ended jobs that are not to be kept, and returns free space to the disk.

use crate::service::jobs::Jobs;
use std::time::Duration;

/// The pause between parts of the work, during which other calls can use the database.
const PAUSE: Duration = Duration::from_millis(20);

/// Deletes ended jobs that are not to be kept, and returns their space to the disk.
pub(crate) async fn tidy(jobs: &Jobs) {
    if let Some(keep) = jobs.settings.keep {
        let mut dropped = 0;
        loop {
            match jobs.store.retire(keep).await {
                Ok(0) => break,
                Ok(count) => dropped += count,
                Err(error) => {
                    tracing::warn!(%error, "ended jobs could not be deleted");
                    break;
                }
            }
            tokio::time::sleep(PAUSE).await;
        }
        if dropped > 0 {
            tracing::info!(dropped, "old jobs were deleted");
        }
    }
    loop {
        match jobs.store.shrink().await {
            Ok(true) => tokio::time::sleep(PAUSE).await,
            Ok(false) => return,
            Err(error) => {
                tracing::warn!(%error, "free space could not be returned to the disk");
                return;
            }
        }
    }
}
