//! Jobs that follow a direction listed at an increment of another job.

use crate::model::{InputError, InputErrors, decode};
use crate::result::increment::Increment;
use crate::service::jobs::queue::checks::{CheckContext, Whole};
use crate::service::jobs::queue::submission::{queued, wrong_input};
use crate::service::jobs::solving::branches;
use crate::service::jobs::{Caller, Jobs, JobsError, Posted};
use crate::service::metrics::Write;
use crate::service::store::{JobRecord, NewFollower, Page, Parent, Submitted, Task};
use uuid::Uuid;

impl Jobs {
    /// Queues a job that follows a direction of the job `id`.
    pub async fn follow(
        &self,
        caller: &Caller,
        id: Uuid,
        posted: impl Into<Posted>,
        idempotency_key: Option<String>,
    ) -> Result<JobRecord, JobsError> {
        let posted: Posted = posted.into();
        let client = posted.client.clone();
        let read = |text: Vec<u8>| {
            Whole::of(move |_: &CheckContext<'_>| {
                decode::follow(&text).map_err(|errors| wrong_input(&text, errors, JobsError::Input))
            })
        };
        let (asked, _) = self.checks.run(posted, read).await?;
        let limits = self.settings.limits;
        if let Some(past) = asked.max_increments.and_then(|most| limits.past_increments("/max_increments", most)) {
            return Err(JobsError::Input(InputErrors(vec![past])));
        }
        let parent = Parent { job: id, increment: asked.increment, direction: asked.direction };
        let owner = caller.owner().map(str::to_owned);
        let follower = |max_increments| NewFollower {
            parent,
            owner: owner.clone(),
            max_increments,
            idempotency_key: idempotency_key.clone(),
            most_queued: limits.queued,
        };
        let job = match self.find(caller, Task::Path, id).await {
            // The parent has been deleted: nothing can be queued, but a repeated call gets the answer of the first one.
            Err(absent) if idempotency_key.is_some() && self.store.job(id).await?.is_none() => {
                return match self.store.follow(follower(asked.max_increments)).await? {
                    Some(known @ (Submitted::Repeated(_) | Submitted::KeyReused)) => queued(known),
                    _ => Err(absent),
                };
            }
            found => found?,
        };
        self.check_listed(&job, asked.increment).await?;
        let Some(origin) = self.store.branch(id, asked.increment).await? else {
            let increment = asked.increment;
            return Err(refused(
                "/increment",
                format!("increment {increment} was stored by a version without checkpoints: trace the path anew"),
            ));
        };
        let text = self.store.request(id).await?.ok_or(JobsError::NoJob(id))?;
        let posted = Posted { client, ..Posted::from(text.into_bytes()) };
        let check = move |text: Vec<u8>| {
            Whole::of(move |context: &CheckContext<'_>| {
                let request = decode::decode(&text).map_err(|errors| {
                    refused("", format!("the model of the job is no longer accepted, post it anew: {errors}"))
                })?;
                let beginning = branches::beginning(&parent, &origin).map_err(|error| {
                    refused("/increment", format!("its checkpoint cannot be read, trace the path anew: {error}"))
                })?;
                context.go_on()?;
                context.solver.check_beginning(&request, beginning).map_err(JobsError::Follow)
            })
        };
        let _room = self.checks.run(posted, check).await?.1.leave();
        // The service may have had a larger limit when the parent was queued.
        let max_increments = Some(asked.max_increments.unwrap_or(job.max_increments.min(limits.increments)));
        // `None`: the parent has been deleted meanwhile.
        let submitted = self.metrics.work.timed(Write::Submit, self.store.follow(follower(max_increments))).await?;
        queued(submitted.ok_or(JobsError::NoJob(id))?)
    }

    /// Refuses an increment that is not stored, and one that lists no directions.
    async fn check_listed(&self, job: &JobRecord, increment: u64) -> Result<(), JobsError> {
        let before = increment.checked_sub(1);
        let lines = self.store.increments(job.id, before, Page { rows: 1, bytes: 1 }).await?;
        let Some(line) = lines.first().filter(|line| line.index == increment) else {
            let stored = match job.last_index {
                Some(last) => format!("it is not stored; the last recorded increment is {last} so far"),
                None => "no increment is stored yet".to_owned(),
            };
            return Err(refused("/increment", format!("found {increment}; {stored}")));
        };
        let lists = serde_json::from_str::<Increment>(&line.body).is_ok_and(|increment| increment.directions.is_some());
        if lists {
            return Ok(());
        }
        let detail = format!(
            "increment {increment} lists no directions, the path has one way on; take one that has `directions`"
        );
        Err(refused("/increment", detail))
    }
}

fn refused(pointer: &str, detail: String) -> JobsError {
    JobsError::Follow(InputErrors(vec![InputError::new(pointer, detail)]))
}
