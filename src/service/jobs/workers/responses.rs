//! The responses of a run of a sweep: found at the run's end in its stored increments, whoever stored them.

use crate::check::judged::JudgedIncrement;
use crate::model::decode;
use crate::service::jobs::Jobs;
use crate::service::jobs::workers::batch;
use crate::service::store::{Claim, Line, Page, StoreError};
use crate::studies::sweeps::ResponseFinder;
use tokio::task::spawn_blocking;
use tokio_util::sync::CancellationToken;

/// How much is read at a time.
const PAGE: Page = Page { rows: 1_000, bytes: 1 << 20 };

/// The responses of a job as JSON, those of its `last` lines among them, which are not stored yet; `None` if nobody asks for any,
/// or if increments of another version of this program cannot be read.
///
/// # Errors
/// The stored increments cannot be fetched.
pub async fn of(
    jobs: &Jobs,
    claim: &Claim,
    last: &[Line],
    shutdown: &CancellationToken,
) -> Result<Option<String>, StoreError> {
    let Some(asked) = &claim.asked else { return Ok(None) };
    let Ok(request) = decode::decode(claim.request.as_bytes()) else { return Ok(None) };
    let Ok(asked) = serde_json::from_str(asked) else { return Ok(None) };
    let Ok(mut finder) = ResponseFinder::new(&asked, &request) else { return Ok(None) };
    let mut after = None;
    loop {
        let read = || jobs.store.increments(claim.lease.job, after, PAGE);
        let lines = batch::retry(jobs.settings.lease, shutdown, read).await?;
        let Some(end) = lines.last() else { break };
        after = Some(end.index);
        match take(finder, lines).await {
            Some(going_on) => finder = going_on,
            None => return Ok(None),
        }
    }
    let last = last.iter().map(Line::alone).collect();
    let found = take(finder, last).await.and_then(ResponseFinder::found);
    Ok(found.and_then(|found| serde_json::to_string(&found).ok()))
}

/// Lets a finder look at these increments, off the threads that answer; `None` if one of them cannot be read.
async fn take(mut finder: ResponseFinder, lines: Vec<Line>) -> Option<ResponseFinder> {
    let look = move || {
        for line in &lines {
            let judged: JudgedIncrement = serde_json::from_str(&line.body).ok()?;
            finder.take(&judged.increment, Some(&judged.measure));
        }
        Some(finder)
    };
    spawn_blocking(look).await.ok().flatten()
}
