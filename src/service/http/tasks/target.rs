//! The resource that a request names by its id: read, cancelled or deleted.

use crate::service::http::answer::problem::Problem;
use crate::service::http::answer::tag;
use crate::service::http::input::extract::{JobId, QueryParameters};
use crate::service::http::state::service::Service;
use crate::service::http::tasks::requester::Requester;
use crate::service::http::tasks::resource::{Resource, View};
use crate::service::jobs::{Caller, JobsError};
use crate::service::store::{JobRecord, Page, Standing};
use axum::Json;
use axum::extract::FromRequestParts;
use axum::http::request::Parts;
use axum::http::{HeaderMap, StatusCode};
use axum::response::{IntoResponse, Response};
use serde::{Deserialize, Serialize};
use serde_json::value::RawValue;
use std::marker::PhantomData;
use uuid::Uuid;

/// A page of stored lines ends early when they are large.
const LINE_BYTES: usize = 1 << 20;

/// The most rows of a page.
pub const MOST_ROWS: u32 = 1_000;

#[derive(Debug, Deserialize, utoipa::IntoParams)]
#[serde(deny_unknown_fields)]
#[into_params(parameter_in = Query)]
pub struct RowParameters {
    /// Only rows past this place: `next_after` of the page before.
    pub after: Option<u64>,
    /// Rows at most.
    #[param(minimum = 1, maximum = 1_000, default = 1_000)]
    pub limit: Option<u32>,
}

impl QueryParameters for RowParameters {
    const EXPECTED: &'static [(&'static str, &'static str)] =
        &[("after", "the place of a row, 0 or more,"), ("limit", "a whole number from 1 to 1000")];
}

/// The resource that a request is about, and the caller of the request.
pub struct Target<T> {
    pub service: Service,
    pub caller: Caller,
    pub id: Uuid,
    pub headers: HeaderMap,
    resource: PhantomData<fn() -> T>,
}

impl<T: Resource> FromRequestParts<Service> for Target<T> {
    type Rejection = Problem;

    async fn from_request_parts(parts: &mut Parts, service: &Service) -> Result<Self, Problem> {
        let Requester { service, caller } = Requester::from_request_parts(parts, service).await?;
        let JobId(id) = JobId::from_request_parts(parts, &service).await?;
        Ok(Self { service, caller, id, headers: parts.headers.clone(), resource: PhantomData })
    }
}

impl<T: Resource> Target<T> {
    /// The record of the resource.
    ///
    /// # Errors
    /// The caller sees no resource of this id, or the store fails.
    pub async fn find(&self) -> Result<JobRecord, JobsError> {
        self.service.jobs.find(&self.caller, T::TASK, self.id).await
    }

    /// The status of the resource and the index of its last stored line.
    ///
    /// # Errors
    /// As for [`find`](Self::find).
    pub async fn standing(&self) -> Result<Standing, JobsError> {
        self.service.jobs.standing(&self.caller, T::TASK, self.id).await
    }

    /// Answers the record in the form `V`, with an entity tag where the resource has ended.
    ///
    /// # Errors
    /// A record that cannot be read.
    pub async fn shown<V: View>(self, record: JobRecord) -> Result<Response, Problem> {
        let Self { service, headers, .. } = self;
        let (bytes, is_finished) = (record.bytes(), record.status.is_ended());
        service.offload.run(bytes, move || tag::json(&headers, is_finished, &V::try_from(record)?)).await
    }

    /// Answers a page of at most `rows` stored lines past the index `after`, unchanged.
    ///
    /// # Errors
    /// As for [`find`](Self::find).
    pub async fn lines<P: Serialize>(
        self,
        after: Option<u64>,
        rows: u32,
        page: impl FnOnce(Vec<Box<RawValue>>, Option<u64>) -> P + Send + 'static,
    ) -> Result<Response, Problem> {
        let is_finished = self.standing().await?.status.is_ended();
        let Self { service, id, headers, .. } = self;
        let lines = service.jobs.store().increments(id, after, Page { rows, bytes: LINE_BYTES }).await?;
        let next_after = lines.last().map(|line| line.index).or(after);
        let bytes = lines.iter().map(|line| line.body.len()).sum();
        let make = move || {
            let lines = lines.into_iter().map(|line| RawValue::from_string(line.body)).collect::<Result<_, _>>()?;
            tag::json(&headers, is_finished, &page(lines, next_after))
        };
        service.offload.run(bytes, make).await
    }

    /// Cancels the resource where it has not ended, and answers it.
    ///
    /// # Errors
    /// As for [`find`](Self::find).
    pub async fn cancel(self) -> Result<Response, Problem> {
        let Self { service, caller, id, .. } = self;
        let record = service.jobs.cancel(&caller, T::TASK, id).await?;
        let bytes = record.bytes();
        let made = move || Ok::<_, Problem>(Json(T::try_from(record)?).into_response());
        Ok((StatusCode::ACCEPTED, service.offload.run(bytes, made).await?).into_response())
    }

    /// Cancels the resource and deletes what is stored of it.
    ///
    /// # Errors
    /// As for [`find`](Self::find).
    pub async fn delete(self) -> Result<StatusCode, Problem> {
        self.service.jobs.delete(&self.caller, T::TASK, self.id).await?;
        Ok(StatusCode::NO_CONTENT)
    }
}
