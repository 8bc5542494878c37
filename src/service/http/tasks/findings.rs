//! The findings of studies, sweeps and curves, as tables and as a picture.

use crate::service::http::answer::problem::{Kind, Problem};
use crate::service::http::answer::tag;
use crate::service::http::tasks::resource::Resource;
use crate::service::http::tasks::target::Target;
use crate::service::store::Task;
use crate::studies::picture::PlotError;
use crate::studies::picture::findings::Findings;
use axum::http::{HeaderMap, header};
use axum::response::Response;
use uuid::Uuid;

/// A resource whose findings are answered as tables and as a picture.
pub trait WithFindings: Resource {
    type Findings: Findings + 'static;

    /// The stored form of the findings so far.
    fn stored_findings(
        target: &Target<Self>,
    ) -> impl Future<Output = Result<StoredFindings<Self::Findings>, Problem>> + Send;
}

/// Stored findings that have not been parsed yet.
pub struct StoredFindings<F> {
    /// Bytes of the stored text.
    pub bytes: usize,
    /// The findings are complete.
    pub is_finished: bool,
    pub read: Box<dyn FnOnce() -> Result<F, Problem> + Send>,
}

impl<T: WithFindings> Target<T> {
    /// Answers the findings so far.
    ///
    /// # Errors
    /// As for [`find`](Self::find); stored findings that cannot be parsed; the errors of `answer`.
    pub(crate) async fn found(
        self,
        answer: fn(&FindingsSoFar<T::Findings>, &HeaderMap) -> Result<Response, Problem>,
    ) -> Result<Response, Problem> {
        let StoredFindings { bytes, is_finished, read } = T::stored_findings(&self).await?;
        let Self { service, id, headers, .. } = self;
        let make = move || answer(&FindingsSoFar { task: T::TASK, id, findings: read()?, is_finished }, &headers);
        service.offload.run(bytes, make).await
    }
}

/// Bytes of the rows of a table or picture, which are held in memory.
pub(crate) const MOST_OF_A_TABLE: usize = 64 << 20;

/// The problem of rows that are too many for a table or picture; `rows` is the address of their pages.
pub(crate) fn too_large(rows: &str) -> Problem {
    let detail = format!("its rows have more than {MOST_OF_A_TABLE} bytes; read them page by page at {rows}");
    Problem::new(Kind::AnswerTooLarge, detail)
}

/// The findings of a study, sweep or curve so far.
pub(crate) struct FindingsSoFar<F> {
    pub task: Task,
    pub id: Uuid,
    pub findings: F,
    /// The findings are complete.
    pub is_finished: bool,
}

impl<F: Findings> FindingsSoFar<F> {
    /// The table as a file of comma-separated values.
    ///
    /// # Errors
    /// A number that cannot be written.
    pub fn csv(&self, headers: &HeaderMap) -> Result<Response, Problem> {
        let name = format!("attachment; filename=\"{}-{}.csv\"", self.task.name(), self.id);
        let own = [(header::CONTENT_TYPE, "text/csv; charset=utf-8".to_owned()), (header::CONTENT_DISPOSITION, name)];
        tag::bytes(headers, self.is_finished, own, self.findings.csv()?)
    }

    /// The table as columns of text.
    ///
    /// # Errors
    /// A number that cannot be written.
    pub fn text(&self, headers: &HeaderMap) -> Result<Response, Problem> {
        let own = [(header::CONTENT_TYPE, "text/plain; charset=utf-8")];
        tag::bytes(headers, self.is_finished, own, self.findings.text()?)
    }

    /// The picture.
    ///
    /// # Errors
    /// There is nothing to be drawn yet, or the drawing failed.
    pub fn picture(&self, headers: &HeaderMap) -> Result<Response, Problem> {
        let Self { task, id, .. } = self;
        let task = task.name();
        match self.findings.svg() {
            Ok(svg) => tag::bytes(headers, self.is_finished, [(header::CONTENT_TYPE, "image/svg+xml")], svg),
            Err(PlotError::Drawing(error)) => {
                tracing::error!(%error, task, %id, "a picture cannot be drawn");
                Err(Problem::internal())
            }
            Err(PlotError::NoErrors | PlotError::NoPoints | PlotError::Empty | PlotError::NothingFound { .. }) => {
                Err(Problem::not_found(format_args!("picture of {task} {id}: {}", F::NOT_DRAWN)))
            }
        }
    }
}
