//! What studies and sweeps have found, as tables and as a picture: read by `studies` and `sweeps`.

use super::problem::{Kind, Problem};
use super::tag;
use crate::picture::PlotError;
use crate::picture::findings::Findings;
use crate::store::Task;
use axum::http::{HeaderMap, header};
use axum::response::Response;
use uuid::Uuid;

/// What has been found by a study or a sweep so far.
pub(super) struct SoFar<F> {
    pub task: Task,
    pub id: Uuid,
    pub findings: F,
    /// Nothing is added any more.
    pub is_finished: bool,
}

impl<F: Findings> SoFar<F> {
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
                Err(Problem::new(Kind::Internal, "the log has more under this answer's x-request-id"))
            }
            Err(PlotError::NoErrors | PlotError::Empty | PlotError::NoLimitLoads) => {
                Err(Problem::not_found(format_args!("picture of {task} {id}: {}", F::NOT_DRAWN)))
            }
        }
    }
}
