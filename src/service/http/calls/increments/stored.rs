//! The stored increments of a job, one page after another, so that memory does not grow with the path.

use crate::check::measure::Errors;
use crate::model::JobRequest;
use crate::result::increment::Increment;
use crate::service::http::state::service::Service;
use crate::service::store::{Line, Page};
use serde::Deserialize;
use std::io;
use uuid::Uuid;

const PAGE: Page = Page { rows: 500, bytes: 1 << 20 };

/// A stored increment.
#[derive(Deserialize)]
pub struct Stored {
    #[serde(flatten)]
    pub increment: Increment,
    /// Absent from increments that older versions have stored.
    #[serde(default)]
    pub measure: Option<Errors>,
}

/// Reads the increments of a job from the first on.
pub struct StoredPath {
    service: Service,
    id: Uuid,
    after: Option<u64>,
}

impl StoredPath {
    pub fn new(service: Service, id: Uuid) -> Self {
        Self { service, id, after: None }
    }

    /// What is made of the job's request.
    pub async fn of_request<T: Send + 'static>(
        &self,
        make: impl FnOnce(&JobRequest) -> T + Send + 'static,
    ) -> io::Result<T> {
        let request = self.service.jobs.store().request(self.id).await.map_err(io::Error::other)?;
        let request = request.ok_or_else(|| io::Error::other("the job has been deleted"))?;
        let bytes = request.len();
        let read = move || serde_json::from_str(&request).map(|request| make(&request));
        Ok(self.service.offload.run(bytes, read).await?)
    }

    /// The next page, `None` after the last.
    pub async fn next_page(&mut self) -> io::Result<Option<Vec<Line>>> {
        let page = self.service.jobs.store().increments(self.id, self.after, PAGE).await.map_err(io::Error::other)?;
        let Some(last) = page.last() else { return Ok(None) };
        self.after = Some(last.index);
        Ok(Some(page))
    }

    /// Does for every increment of a page what changes a state, and returns the state.
    pub async fn each<T: Send + 'static>(
        &self,
        page: Vec<Line>,
        mut state: T,
        mut change: impl FnMut(&mut T, Stored) -> io::Result<()> + Send + 'static,
    ) -> io::Result<T> {
        let bytes = page.iter().map(|line| line.body.len()).sum();
        let work = move || {
            for line in &page {
                change(&mut state, serde_json::from_str(&line.body)?)?;
            }
            Ok(state)
        };
        self.service.offload.run(bytes, work).await
    }

    /// Begins again with the first.
    pub fn rewind(&mut self) {
        self.after = None;
    }
}
