//! Studies as jobs: queued, run and resumed by the same workers as paths are.

use super::checks::{Desk, Room, Whole};
use super::submission::{not_text, wrong_input};
use super::{Caller, Jobs, JobsError, Posted, queued};
use crate::metrics::Write;
use crate::model::decode;
use crate::store::{JobRecord, Line, NewJob, Page, Task};
use crate::store::{Result as StoreResult, StoreError};
use crate::studies::{Plan, Report, Run};
use uuid::Uuid;

const PAGE: Page = Page { rows: 1000, bytes: 4 << 20 };

/// A study that can be queued.
struct Prepared {
    text: String,
    name: Option<String>,
    plan: Plan,
}

impl Jobs {
    async fn prepared_study(&self, request: Posted) -> Result<(Prepared, Room), JobsError> {
        let check = |text| Whole::of(|desk: &Desk<'_>| prepare(desk, text));
        let (prepared, held) = self.checked(request, check).await?;
        Ok((prepared, held.leave()))
    }

    /// The plan of a study; nothing is queued.
    pub async fn validate_study(&self, request: impl Into<Posted>) -> Result<Plan, JobsError> {
        Ok(self.prepared_study(request.into()).await?.0.plan)
    }

    pub async fn submit_study(
        &self,
        caller: &Caller,
        request: impl Into<Posted>,
        idempotency_key: Option<String>,
    ) -> Result<JobRecord, JobsError> {
        let (Prepared { text, name, plan }, _room) = self.prepared_study(request.into()).await?;
        let job = NewJob {
            task: Task::Study,
            owner: caller.owner().map(str::to_owned),
            name,
            plan: serde_json::to_string(&plan)?,
            request: text,
            max_increments: plan.runs,
            max_attempts: self.settings.max_attempts,
            summary: None,
            most_queued: self.settings.limits.queued,
            priority: 0,
            idempotency_key,
            explore: None,
        };
        queued(self.metrics.work.timed(Write::Submit, self.store.submit(job)).await?)
    }

    /// The lines that tell what a study has found so far.
    ///
    /// # Errors
    /// A store that fails, or holds what is none of a study's.
    pub async fn lines_of_study(&self, study: &JobRecord) -> Result<Vec<Line>, JobsError> {
        let plan: Plan = serde_json::from_str(&study.plan)?;
        // Every row has its latest run among the last ones, one a row.
        let after = study.last_index.and_then(|last| last.checked_sub(plan.rows));
        Ok(self.lines(study.id, after, usize::MAX).await?)
    }

    /// All lines that are stored of a job.
    pub(super) async fn stored(&self, id: Uuid) -> StoreResult<Vec<Line>> {
        self.lines(id, None, usize::MAX).await
    }

    /// Lines past that one; they break off past so many bytes.
    pub async fn lines(&self, id: Uuid, mut after: Option<u64>, most: usize) -> Result<Vec<Line>, StoreError> {
        let (mut lines, mut bytes) = (Vec::new(), 0);
        loop {
            let page = self.store.increments(id, after, PAGE).await?;
            let Some(last) = page.last() else { return Ok(lines) };
            after = Some(last.index);
            bytes += page.iter().map(|line| line.body.len()).sum::<usize>();
            lines.extend(page);
            if bytes > most {
                return Ok(lines);
            }
        }
    }
}

/// What a study has found, by its last lines; `None` before the first path.
///
/// # Errors
/// What is stored is none of a study's.
pub fn found(study: &JobRecord, lines: &[Line]) -> serde_json::Result<Option<Report>> {
    let plan: Plan = serde_json::from_str(&study.plan)?;
    let runs: Vec<Run> = lines.iter().map(|line| serde_json::from_str(&line.body)).collect::<Result<_, _>>()?;
    Ok(Report::of_runs(study.name.clone(), &plan, &runs))
}

fn prepare(desk: &Desk<'_>, request: Vec<u8>) -> Result<Prepared, JobsError> {
    let decoded = decode::study(&request).map_err(|errors| wrong_input(&request, errors, JobsError::Input))?;
    desk.limits.check(&decoded.model, decoded.analysis.max_increments).map_err(JobsError::Input)?;
    desk.go_on()?;
    let plan = desk.solver.plan_study(&decoded).map_err(JobsError::Input)?;
    Ok(Prepared { text: String::from_utf8(request).map_err(not_text)?, name: decoded.model.name, plan })
}
