//! The responses of a run of a sweep: found at the run's end in its stored increments, whoever stored them.

use crate::check::judged::JudgedIncrement;
use crate::model::decode;
use crate::service::jobs::Jobs;
use crate::service::jobs::workers::batch;
use crate::service::store::{Batch, Claim, Line, Page, StoreError};
use crate::studies::sweeps::ResponseFinder;
use std::time::Instant;
use tokio::task::spawn_blocking;
use tokio_util::sync::CancellationToken;

/// How much is read at a time.
const PAGE: Page = Page { rows: 1_000, bytes: 1 << 20 };

/// The responses of a job as JSON, those of its `last` lines among them, which are not stored yet; `None` if nobody asks for any,
/// or if increments of another version of this program cannot be read. The lease is renewed meanwhile.
///
/// # Errors
/// The stored increments cannot be fetched.
pub async fn of(
    jobs: &Jobs,
    claim: &Claim,
    last: &[Line],
    shutdown: &CancellationToken,
) -> Result<Option<String>, StoreError> {
    let Some(asked) = claim.asked.clone() else { return Ok(None) };
    let request = claim.request.clone();
    let Some(mut finder) = elsewhere(move || finder(&asked, &request)).await else { return Ok(None) };
    let (lease, duration) = (&claim.lease, jobs.settings.lease);
    let (nothing, mut after, mut renewed) = (Batch::default(), None, Instant::now());
    loop {
        let lines = batch::retry(duration, shutdown, || jobs.store.increments(lease.job, after, PAGE)).await?;
        let Some(end) = lines.last() else { break };
        after = Some(end.index);
        let Some(going_on) = take(finder, lines).await else { return Ok(None) };
        finder = going_on;
        if renewed.elapsed() > duration / 3 {
            // A lease that is lost is noticed where the end is stored.
            batch::retry(duration, shutdown, || jobs.store.append(lease, &nothing, duration)).await?;
            renewed = Instant::now();
        }
    }
    let last = last.iter().map(Line::alone).collect();
    let found = take(finder, last).await.and_then(ResponseFinder::found);
    Ok(found.and_then(|found| serde_json::to_string(&found).ok()))
}

fn finder(asked: &str, request: &str) -> Option<ResponseFinder> {
    let request = decode::decode(request.as_bytes()).ok()?;
    ResponseFinder::new(&serde_json::from_str(asked).ok()?, &request).ok()
}

/// Lets a finder look at these increments; `None` if one of them cannot be read.
async fn take(mut finder: ResponseFinder, lines: Vec<Line>) -> Option<ResponseFinder> {
    elsewhere(move || {
        for line in &lines {
            let judged: JudgedIncrement = serde_json::from_str(&line.body).ok()?;
            finder.take(&judged.increment, Some(&judged.measure));
        }
        Some(finder)
    })
    .await
}

/// Off the threads that answer.
async fn elsewhere<T: Send + 'static>(work: impl FnOnce() -> Option<T> + Send + 'static) -> Option<T> {
    spawn_blocking(work).await.ok().flatten()
}
