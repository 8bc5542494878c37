//! The loop of a worker: claim a job, solve it, store its increments and its end.

use crate::check::judged::JudgedReport;
use crate::output::columns::name_of;
use crate::resources::cancel::CancelFlag;
use crate::result::stop_reason::Outcome;
use crate::service::jobs::Jobs;
use crate::service::jobs::solving::running;
use crate::service::jobs::solving::solve::{self, Solve};
use crate::service::jobs::solving::solve_output::SolveEnd;
use crate::service::jobs::workers::batch::{self, Drained};
use crate::service::jobs::workers::{refinement, responses};
use crate::service::metrics::Write;
use crate::service::store::{Batch, Claim, Ending, Lease, LeaseAnswer, Status, StoreError, Task};
use crate::studies::critical_curves::CurveSummary;
use crate::studies::error_against_time;
use std::time::Duration;
use tokio_util::sync::CancellationToken;
use tokio_util::task::AbortOnDropHandle;
use tracing::Instrument;

/// How long a worker tries to release its job when the database is not available; after that the lease expires.
const TO_HAND_BACK: Duration = Duration::from_secs(1);

/// The stop reason of a solve that would exceed its memory limit, as for a path.
const MEMORY_LIMIT: &str = "memory_limit";

/// The stop reason of a curve whose limit point is not found, or cannot be followed.
const NO_LIMIT_POINT: &str = "no_limit_point";

/// Works until `shutdown`; a running job then returns to the queue.
pub async fn work(jobs: Jobs, name: String, shutdown: CancellationToken) {
    let mut queue = jobs.store.queue_changes();
    while !shutdown.is_cancelled() {
        // Marked as seen before the claim, so that a job queued in between wakes the worker at once.
        queue.borrow_and_update();
        match jobs.metrics.work.timed(Write::Claim, jobs.store.claim(&name, jobs.settings.lease)).await {
            Ok(Some(claim)) => {
                if let Some(wait) = claim.waited {
                    jobs.metrics.work.started_after(wait);
                }
                let span =
                    tracing::info_span!("job", job = %claim.lease.job, attempt = claim.lease.attempt, worker = name);
                guarded(&jobs, claim, &shutdown).instrument(span).await;
                continue;
            }
            Ok(None) => {}
            Err(error) => tracing::warn!(%error, worker = name, "no job could be claimed"),
        }
        tokio::select! {
            () = shutdown.cancelled() => {}
            _ = queue.changed() => {}
            () = tokio::time::sleep(jobs.settings.poll_interval) => {}
        }
    }
}

/// Runs a claimed job in a task of its own: a panic of the service fails this job only, and the worker continues. (A panic of
/// the solver is caught on the solver's thread.)
async fn guarded(jobs: &Jobs, claim: Claim, shutdown: &CancellationToken) {
    let lease = claim.lease.clone();
    let task = {
        let (jobs, shutdown) = (jobs.clone(), shutdown.clone());
        tokio::spawn(async move { run(&jobs, claim, &shutdown).await }.in_current_span())
    };
    let Err(error) = AbortOnDropHandle::new(task).await else { return };
    let ending = Ending::failed(format!("the service has a defect: {error}"));
    match finish(jobs, &lease, &Batch::default(), &ending, shutdown).await {
        Ok(_) => tracing::error!(%error, "a worker panicked; the job failed"),
        Err(unstored) => tracing::error!(%error, %unstored, "a worker panicked, and the end was not stored"),
    }
}

async fn run(jobs: &Jobs, claim: Claim, shutdown: &CancellationToken) {
    tracing::info!(stored = claim.last.as_ref().map(|line| line.index), "started");
    match trace(jobs, &claim, shutdown).await {
        Ok(Finished::Ended(status)) => {
            tracing::info!(status = status.name(), "ended");
            if claim.explores {
                crate::service::jobs::workers::explore::queue(jobs).await;
            }
            refinement::queue(jobs).await;
        }
        Ok(Finished::Released) => tracing::info!("returned to the queue"),
        Ok(Finished::Lost) => tell_loss(jobs, &claim.lease).await,
        // The end cannot be stored now: the lease expires and the job is tried again.
        Err(error) => tracing::error!(%error, source = ?std::error::Error::source(&error), "the end was not stored"),
    }
}

/// Logs what has become of a job that this worker may no longer write to.
async fn tell_loss(jobs: &Jobs, lease: &Lease) {
    let lasts = jobs.settings.lease;
    let job = match jobs.store.job(lease.job).await {
        Ok(Some(job)) => job,
        Ok(None) => return tracing::info!("the job was deleted while it ran"),
        Err(error) => return tracing::warn!(%error, "the lease was lost: nothing could be stored within {lasts:?}"),
    };
    let now = match job.status {
        Status::Cancelled => {
            return tracing::info!("the job was cancelled; what this worker had not stored is dropped");
        }
        Status::Running if job.attempt > lease.attempt => "another worker has the job and goes on after what is stored",
        Status::Running => "the job goes back to the queue, and then on after what is stored",
        Status::Queued => "the job waits in the queue, and then goes on after what is stored",
        Status::Completed | Status::Stopped => "another worker has brought the job to its end",
        Status::Failed => "the job has lost too many workers and failed",
    };
    tracing::warn!(
        now,
        "the lease was lost: it was not renewed within {lasts:?}, by this process or its database being held up"
    );
}

enum Finished {
    Ended(Status),
    Released,
    Lost,
}

async fn trace(jobs: &Jobs, claim: &Claim, shutdown: &CancellationToken) -> Result<Finished, StoreError> {
    let lease = &claim.lease;
    let (cancel, _entry): (CancelFlag, running::Entry) = jobs.running.enter(lease);
    // A cancellation between the claim and the line above found no flag to set.
    let job = batch::retry(jobs.settings.lease, shutdown, || jobs.store.job(lease.job)).await?;
    if job.is_none_or(|job| job.cancel_requested) {
        cancel.cancel();
    }
    let stored = match claim.task {
        Task::Path | Task::Sweep => Vec::new(),
        Task::Study | Task::Curve => {
            batch::retry(jobs.settings.lease, shutdown, || jobs.lines(lease.job, None, usize::MAX)).await?
        }
    };
    let mut solve = match solve::start(jobs.solve_context(), claim, stored, cancel.clone()) {
        Ok(solve) => solve,
        Err(error) => {
            let ending = Ending::failed(format!("no thread could be started: {error}"));
            return end(jobs, claim, Batch::default(), ending, shutdown).await;
        }
    };
    let store = jobs.store.as_ref();
    match batch::drain(jobs, claim, &mut solve.sent, &cancel, shutdown).await {
        Drained::Complete(batch) => {
            let mut ending = ending(solve.end.await.unwrap_or(SolveEnd::Silent));
            ending.responses = responses::of(jobs, claim, &batch.lines, shutdown).await?;
            end(jobs, claim, batch, ending, shutdown).await
        }
        Drained::ShuttingDown => {
            cancel.cancel();
            // Closed before the solver sees the flag, as nothing that it sends after the cancellation may be stored.
            solve.sent.close();
            // Not for the whole lease, as the service is shutting down.
            let going = CancellationToken::new();
            let answer = batch::retry(TO_HAND_BACK, &going, || store.release(lease)).await;
            stop(solve).await;
            Ok(match answer? {
                LeaseAnswer::Held { .. } => Finished::Released,
                LeaseAnswer::Lost => Finished::Lost,
            })
        }
        Drained::Reached(reached) => {
            cancel.cancel();
            // Nothing that the solver still sends may be stored; the end is stored before the thread has ended.
            solve.sent.close();
            let ending = Ending {
                status: Status::Stopped,
                stop_reason: Some(reached.name().to_owned()),
                report: None,
                error: Some(jobs.settings.limits.sentence(reached)),
                responses: responses::of(jobs, claim, &[], shutdown).await?,
            };
            let answer = end(jobs, claim, Batch::default(), ending, shutdown).await;
            stop(solve).await;
            answer
        }
        Drained::LeaseLost => {
            cancel.cancel();
            stop(solve).await;
            Ok(Finished::Lost)
        }
        Drained::Failed(error) => {
            cancel.cancel();
            stop(solve).await;
            end(jobs, claim, Batch::default(), not_stored(&error), shutdown).await
        }
    }
}

/// Waits for the thread of a solve and drops its remaining output.
async fn stop(solve: Solve) {
    drop(solve.sent);
    // An error means that the thread has ended, too.
    let _ = solve.end.await;
}

fn not_stored(error: &StoreError) -> Ending {
    tracing::error!(%error, source = ?std::error::Error::source(error), "increments could not be stored");
    Ending::failed(format!("increments could not be stored: {error}"))
}

/// Stores the end of a job together with its last increments; if these cannot be stored, the job fails. On a full disk the end
/// waits for space, otherwise for at most the duration of the lease; if it is not stored by then, the job is resumed from its
/// last checkpoint.
async fn end(
    jobs: &Jobs,
    claim: &Claim,
    mut batch: Batch,
    mut ending: Ending,
    shutdown: &CancellationToken,
) -> Result<Finished, StoreError> {
    loop {
        match finish(jobs, &claim.lease, &batch, &ending, shutdown).await {
            Ok(LeaseAnswer::Held { .. }) => {
                jobs.metrics.work.stored(batch.lines.len());
                return Ok(Finished::Ended(ending.status));
            }
            Ok(LeaseAnswer::Lost) => return Ok(Finished::Lost),
            Err(error) if !error.is_passing() && !batch.is_empty() => {
                ending = not_stored(&error);
                batch = Batch::default();
            }
            Err(error @ StoreError::Full(_)) => {
                tracing::error!(%error, "the end of the job waits for space on the disk");
                tokio::select! {
                    () = shutdown.cancelled() => return Err(error),
                    () = tokio::time::sleep(jobs.settings.poll_interval) => {}
                }
            }
            Err(error) => return Err(error),
        }
    }
}

async fn finish(
    jobs: &Jobs,
    lease: &Lease,
    batch: &Batch,
    ending: &Ending,
    shutdown: &CancellationToken,
) -> Result<LeaseAnswer, StoreError> {
    let finish = || jobs.metrics.work.timed(Write::Finish, jobs.store.finish(lease, batch, ending));
    batch::retry(jobs.settings.lease, shutdown, finish).await
}

fn ending(end: SolveEnd) -> Ending {
    match end {
        SolveEnd::Reported(report) => {
            reported(&report).unwrap_or_else(|error| Ending::failed(format!("the report cannot be written: {error}")))
        }
        SolveEnd::Studied(report) => {
            studied(&report).unwrap_or_else(|error| Ending::failed(format!("the report cannot be written: {error}")))
        }
        SolveEnd::Curved(summary) => {
            curved(&summary).unwrap_or_else(|error| Ending::failed(format!("the report cannot be written: {error}")))
        }
        SolveEnd::NoCurve(errors) => Ending {
            status: Status::Stopped,
            stop_reason: Some(NO_LIMIT_POINT.to_owned()),
            report: None,
            error: Some(errors.to_string()),
            responses: None,
        },
        SolveEnd::Cancelled => cancelled(None),
        SolveEnd::Exceeded(breach) => Ending {
            status: Status::Stopped,
            stop_reason: Some(MEMORY_LIMIT.to_owned()),
            report: None,
            error: Some(breach.to_string()),
            responses: None,
        },
        SolveEnd::Refused(errors) => Ending::failed(format!("the stored request is not accepted: {errors}")),
        SolveEnd::Panicked(text) => Ending::failed(format!("the solver panicked: {text}")),
        SolveEnd::Unwritable(error) => Ending::failed(format!("an increment cannot be written: {error}")),
        SolveEnd::Differs(index) => Ending::failed(format!(
            "increment {index} was stored by another version of this program and comes out otherwise now, so that the path \
             cannot go on from there: what is stored stands; post the job anew for a path of one piece"
        )),
        SolveEnd::Unreadable(error) => Ending::failed(format!("the stored data of the job cannot be read: {error}")),
        SolveEnd::Silent => Ending::failed("the solver ended without a report"),
    }
}

fn studied(report: &error_against_time::StudyReport) -> serde_json::Result<Ending> {
    let text = Some(serde_json::to_string(report)?);
    let completed =
        Ending { status: Status::Completed, stop_reason: None, report: text.clone(), error: None, responses: None };
    Ok(if report.complete { completed } else { cancelled(text) })
}

fn curved(summary: &CurveSummary) -> serde_json::Result<Ending> {
    let text = Some(serde_json::to_string(summary)?);
    let completed =
        Ending { status: Status::Completed, stop_reason: None, report: text.clone(), error: None, responses: None };
    Ok(if summary.complete { completed } else { cancelled(text) })
}

fn cancelled(report: Option<String>) -> Ending {
    Ending {
        status: Status::Cancelled,
        stop_reason: Some("cancelled".to_owned()),
        report,
        error: None,
        responses: None,
    }
}

fn reported(judged: &JudgedReport) -> serde_json::Result<Ending> {
    let status = match judged.report.stop_reason.outcome() {
        Outcome::Completed => Status::Completed,
        Outcome::Stopped => Status::Stopped,
        Outcome::Cancelled => Status::Cancelled,
    };
    Ok(Ending {
        status,
        stop_reason: Some(name_of(&judged.report.stop_reason)?),
        report: Some(serde_json::to_string(judged)?),
        error: None,
        responses: None,
    })
}
