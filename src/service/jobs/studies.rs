//! Studies as jobs: queued, run and resumed by the same workers as paths are.

use crate::model::decode;
use crate::service::jobs::checks::Desk;
use crate::service::jobs::submission::{Prepared, not_text, wrong_input};
use crate::service::jobs::{Caller, Jobs, JobsError, Posted, queued};
use crate::service::metrics::Write;
use crate::service::store::contract::error::Result as StoreResult;
use crate::service::store::{JobRecord, Line, Page, StoreError, Task};
use crate::studies::error_against_time::{Plan, Report, Run};
use uuid::Uuid;

const PAGE: Page = Page { rows: 1000, bytes: 4 << 20 };

impl Jobs {
    /// The plan of a study; nothing is queued.
    pub async fn validate_study(&self, request: impl Into<Posted>) -> Result<Plan, JobsError> {
        Ok(self.prepared(request.into(), prepare).await?.0.plan)
    }

    pub async fn submit_study(
        &self,
        caller: &Caller,
        request: impl Into<Posted>,
        idempotency_key: Option<String>,
    ) -> Result<JobRecord, JobsError> {
        let (prepared, _room) = self.prepared(request.into(), prepare).await?;
        let job = self.new_job(caller, Task::Study, prepared, idempotency_key)?;
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

fn prepare(desk: &Desk<'_>, request: Vec<u8>) -> Result<Prepared<Plan>, JobsError> {
    let decoded = decode::study(&request).map_err(|errors| wrong_input(&request, errors, JobsError::Input))?;
    desk.limits.check(&decoded.model, decoded.analysis.max_increments).map_err(JobsError::Input)?;
    desk.go_on()?;
    let plan = desk.solver.plan_study(&decoded).map_err(JobsError::Input)?;
    let (text, max_increments) = (String::from_utf8(request).map_err(not_text)?, plan.runs);
    Ok(Prepared { text, name: decoded.model.name, plan, summary: None, max_increments, explore: None })
}
