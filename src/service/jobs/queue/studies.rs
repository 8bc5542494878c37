//! Studies as jobs, which the same workers run and resume.

use crate::model::decode;
use crate::service::jobs::queue::checks::CheckContext;
use crate::service::jobs::queue::submission::{self, Prepared, not_text, queued, wrong_input};
use crate::service::jobs::{Caller, Jobs, JobsError, Posted};
use crate::service::metrics::Write;
use crate::service::store::{JobRecord, Line, Task};
use crate::studies::error_against_time::{StudyPlan, StudyReport, StudyRun};

impl Jobs {
    /// The plan of a study; nothing is queued.
    pub async fn validate_study(&self, request: impl Into<Posted>) -> Result<StudyPlan, JobsError> {
        Ok(submission::prepared(&self.checks, request.into(), prepare).await?.0.plan)
    }

    pub async fn submit_study(
        &self,
        caller: &Caller,
        request: impl Into<Posted>,
        idempotency_key: Option<String>,
    ) -> Result<JobRecord, JobsError> {
        let (prepared, _room) = submission::prepared(&self.checks, request.into(), prepare).await?;
        let job = prepared.into_job(caller, Task::Study, &self.settings, idempotency_key)?;
        queued(self.metrics.work.timed(Write::Submit, self.store.submit(job)).await?)
    }

    /// The stored lines with the current findings of a study.
    ///
    /// # Errors
    /// The store fails, or the stored plan cannot be read.
    pub async fn lines_of_study(&self, study: &JobRecord) -> Result<Vec<Line>, JobsError> {
        let plan: StudyPlan = serde_json::from_str(&study.plan)?;
        // The last lines, as many as there are rows, contain the latest run of every row.
        let after = study.last_index.and_then(|last| last.checked_sub(plan.rows));
        Ok(self.lines(study.id, after, usize::MAX).await?)
    }
}

/// The findings of a study, read from its last lines; `None` before the first path.
///
/// # Errors
/// The stored plan or lines cannot be read.
pub fn found(study: &JobRecord, lines: &[Line]) -> serde_json::Result<Option<StudyReport>> {
    let plan: StudyPlan = serde_json::from_str(&study.plan)?;
    let runs: Vec<StudyRun> = lines.iter().map(|line| serde_json::from_str(&line.body)).collect::<Result<_, _>>()?;
    Ok(StudyReport::of_runs(study.name.clone(), &plan, &runs))
}

fn prepare(context: &CheckContext<'_>, request: Vec<u8>) -> Result<Prepared<StudyPlan>, JobsError> {
    let decoded = decode::study(&request).map_err(|errors| wrong_input(&request, errors, JobsError::Input))?;
    context.limits.check(&decoded.model, decoded.analysis.max_increments).map_err(JobsError::Input)?;
    context.go_on()?;
    let plan = context.solver.plan_study(&decoded).map_err(JobsError::Input)?;
    let (text, max_increments) = (String::from_utf8(request).map_err(not_text)?, plan.runs);
    Ok(Prepared { text, name: decoded.model.name, plan, summary: None, max_increments, explore: None })
}
