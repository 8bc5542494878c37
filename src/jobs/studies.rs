//! Studies as jobs: queued, run and resumed by the same workers as paths are.

use super::submission::{not_text, wrong_input};
use super::{Caller, Jobs, JobsError, Limits, Posted, Solver, queued};
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
    /// The plan of a study; nothing is queued.
    pub async fn validate_study(&self, request: impl Into<Posted>) -> Result<Plan, JobsError> {
        Ok(self.checked(request.into(), prepare).await?.0.plan)
    }

    pub async fn submit_study(
        &self,
        caller: &Caller,
        request: impl Into<Posted>,
        idempotency_key: Option<String>,
    ) -> Result<JobRecord, JobsError> {
        let (Prepared { text, name, plan }, _room) = self.checked(request.into(), prepare).await?;
        let job = NewJob {
            task: Task::Study,
            owner: caller.owner().map(str::to_owned),
            name,
            plan: serde_json::to_string(&plan)?,
            request: text,
            max_increments: plan.runs,
            max_attempts: self.settings.max_attempts,
            most_queued: self.settings.limits.queued,
            priority: 0,
            idempotency_key,
            explore: None,
        };
        queued(self.metrics.work.timed(Write::Submit, self.store.submit(job)).await?)
    }

    /// What a study has found so far; `None` before the first path.
    ///
    /// # Errors
    /// A store that fails, or holds what is none of a study's.
    pub async fn study_so_far(&self, study: &JobRecord) -> Result<Option<Report>, JobsError> {
        let plan: Plan = serde_json::from_str(&study.plan)?;
        // Every row has its latest run among the last ones, one a row.
        let after = study.last_index.and_then(|last| last.checked_sub(plan.rows));
        let lines = self.lines(study.id, after).await?;
        let runs: Vec<Run> = lines.iter().map(|line| serde_json::from_str(&line.body)).collect::<Result<_, _>>()?;
        Ok(Report::of_runs(study.name.clone(), &plan, &runs))
    }

    /// All lines that are stored of a job.
    pub(super) async fn stored(&self, id: Uuid) -> StoreResult<Vec<Line>> {
        self.lines(id, None).await
    }

    async fn lines(&self, id: Uuid, mut after: Option<u64>) -> Result<Vec<Line>, StoreError> {
        let mut lines = Vec::new();
        loop {
            let page = self.store.increments(id, after, PAGE).await?;
            let Some(last) = page.last() else { return Ok(lines) };
            after = Some(last.index);
            lines.extend(page);
        }
    }
}

fn prepare(solver: &dyn Solver, limits: &Limits, request: Vec<u8>) -> Result<Prepared, JobsError> {
    let decoded = decode::study(&request).map_err(|errors| wrong_input(&request, errors, JobsError::Input))?;
    limits.check(&decoded.model, decoded.analysis.max_increments).map_err(JobsError::Input)?;
    let plan = solver.plan_study(&decoded).map_err(JobsError::Input)?;
    Ok(Prepared { text: String::from_utf8(request).map_err(not_text)?, name: decoded.model.name, plan })
}
