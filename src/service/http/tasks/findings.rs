//! What studies and sweeps have found, as tables and as a picture.

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

/// What finds something that is read as tables and drawn.
pub trait Finding: Resource {
    type Findings: Findings + 'static;

    /// What its findings so far are read from.
    fn material(target: &Target<Self>) -> impl Future<Output = Result<Material<Self::Findings>, Problem>> + Send;
}

/// Findings that have still to be read from what is stored of them.
pub struct Material<F> {
    /// Of what is stored.
    pub bytes: usize,
    /// Nothing is added any more.
    pub is_finished: bool,
    pub read: Box<dyn FnOnce() -> Result<F, Problem> + Send>,
}

impl<T: Finding> Target<T> {
    /// An answer of what has been found so far.
    ///
    /// # Errors
    /// As for [`find`](Self::find); what is stored is none of its findings; those of the answer.
    pub(crate) async fn found(
        self,
        answer: fn(&SoFar<T::Findings>, &HeaderMap) -> Result<Response, Problem>,
    ) -> Result<Response, Problem> {
        let Material { bytes, is_finished, read } = T::material(&self).await?;
        let Self { service, id, headers, .. } = self;
        let make = move || answer(&SoFar { task: T::TASK, id, findings: read()?, is_finished }, &headers);
        service.aside.make(bytes, make).await
    }
}

/// What has been found by a study or a sweep so far.
pub(crate) struct SoFar<F> {
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
