//! What jobs, studies and sweeps have in common: how they are submitted, listed, read, cancelled and dropped.
//!
//! A call takes a [`Submission`], an [`Asking`] or an [`Asked`] of the [`Resource`] that it is about and hands it on. Only
//! its description is its own: the document has one for each address.

use crate::service::http::answer::problem::{Kind, Problem};
use crate::service::http::answer::tag;
use crate::service::http::extract::{JobId, JsonText, Parameters, Taken, bounded, idempotency_key};
use crate::service::http::service::Service;
use crate::service::jobs::{Caller, JobsError, Posted};
use crate::service::store::{JobRecord, ListFilter, Listed, Page, Standing, Status, Task};
use axum::Json;
use axum::extract::{FromRequest, FromRequestParts, Request};
use axum::http::request::Parts;
use axum::http::{HeaderMap, StatusCode, header};
use axum::response::{IntoResponse, Response};
use serde::{Deserialize, Serialize};
use serde_json::value::RawValue;
use std::marker::PhantomData;
use uuid::Uuid;

const LIST_DEFAULT: u32 = 50;
const LIST_LARGEST: u32 = 200;
/// A page ends early when what it lists is large.
const LIST_BYTES: usize = 1 << 20;
/// A page of stored lines likewise.
const LINE_BYTES: usize = 1 << 20;

#[derive(Debug, Deserialize, utoipa::IntoParams)]
#[serde(deny_unknown_fields)]
#[into_params(parameter_in = Query)]
pub struct SubmitParameters {
    /// Check the request and answer its plan; queue nothing.
    #[serde(default)]
    validate: bool,
}

impl Taken for SubmitParameters {
    const TAKEN: &'static [(&'static str, &'static str)] = &[("validate", "`true` or `false`")];
}

/// Of lists that are chosen from by status alone.
#[derive(Debug, Deserialize, utoipa::IntoParams)]
#[serde(deny_unknown_fields)]
#[into_params(parameter_in = Query)]
pub struct ListByStatus {
    /// Only those with this status.
    status: Option<Status>,
    /// `next_cursor` of the page before.
    cursor: Option<Uuid>,
    #[param(minimum = 1, maximum = 200, default = 50)]
    limit: Option<u32>,
}

impl Taken for ListByStatus {
    const TAKEN: &'static [(&'static str, &'static str)] = &[
        ("status", "`queued`, `running`, `completed`, `stopped`, `cancelled` or `failed`"),
        ("cursor", "the `next_cursor` of the page before, a UUID,"),
        ("limit", "a whole number from 1 to 200"),
    ];
}

/// Which of them a list is to have.
#[derive(Debug, Default)]
pub struct Chosen {
    pub status: Option<Status>,
    pub sweep: Option<Uuid>,
    pub parent: Option<Uuid>,
    pub cursor: Option<Uuid>,
    pub limit: Option<u32>,
}

impl From<ListByStatus> for Chosen {
    fn from(ListByStatus { status, cursor, limit }: ListByStatus) -> Self {
        Self { status, cursor, limit, ..Self::default() }
    }
}

/// A record as it is answered.
pub trait View: TryFrom<JobRecord, Error = serde_json::Error> + Serialize + Send + 'static {}

impl<T: TryFrom<JobRecord, Error = serde_json::Error> + Serialize + Send + 'static> View for T {}

/// What can be submitted, by the form in which one of it is answered.
pub trait Resource: View {
    const TASK: Task;
    /// Where one is, by its id.
    const ADDRESS: fn(Uuid) -> String;
    /// The form in which lists have it.
    type Listed: View;

    /// What would be done with a request; nothing is queued.
    fn validated(service: &Service, request: Posted) -> impl Future<Output = Result<Response, Problem>> + Send;

    /// Queues what is requested.
    fn submitted(
        service: &Service,
        caller: &Caller,
        request: Posted,
        idempotency_key: Option<String>,
    ) -> impl Future<Output = Result<JobRecord, JobsError>> + Send;
}

/// Who asks.
pub struct Asking {
    service: Service,
    caller: Caller,
}

impl FromRequestParts<Service> for Asking {
    type Rejection = Problem;

    async fn from_request_parts(parts: &mut Parts, service: &Service) -> Result<Self, Problem> {
        // Put there before any call.
        let caller = parts.extensions.get::<Caller>().cloned();
        let caller = caller.ok_or_else(|| Problem::new(Kind::Internal, "it is not known who calls"))?;
        Ok(Self { service: service.clone(), caller })
    }
}

impl Asking {
    /// What is the caller's and chosen, newest first, and the cursor of the next page.
    ///
    /// # Errors
    /// A limit out of its bounds, or a store that fails.
    pub async fn page<T: Resource>(self, chosen: Chosen) -> Result<(Vec<T::Listed>, Option<Uuid>), Problem> {
        let Self { service, caller } = self;
        let Chosen { status, sweep, parent, cursor: before, limit } = chosen;
        let rows = bounded("limit", limit, LIST_DEFAULT, LIST_LARGEST)?;
        let (owner, page) = (caller.seen_owner().map(str::to_owned), Page { rows, bytes: LIST_BYTES });
        let filter = ListFilter { task: T::TASK, owner, status, sweep, parent, before, page };
        let Listed { jobs, more } = service.jobs.store().jobs(filter).await?;
        let next_cursor = jobs.last().map(|record| record.id).filter(|_| more);
        let bytes = jobs.iter().map(JobRecord::bytes).sum();
        let made =
            service.aside.make(bytes, move || jobs.into_iter().map(T::Listed::try_from).collect::<Result<_, _>>());
        Ok((made.await?, next_cursor))
    }
}

/// A request that is submitted.
pub struct Submission<T> {
    asking: Asking,
    validate: bool,
    request: Posted,
    idempotency_key: Option<String>,
    resource: PhantomData<fn() -> T>,
}

impl<T: Resource> FromRequest<Service> for Submission<T> {
    type Rejection = Problem;

    async fn from_request(request: Request, service: &Service) -> Result<Self, Problem> {
        let (mut parts, body) = request.into_parts();
        let asking = Asking::from_request_parts(&mut parts, service).await?;
        let Parameters(SubmitParameters { validate }) = Parameters::from_request_parts(&mut parts, service).await?;
        let headers = parts.headers.clone();
        let JsonText(request) = JsonText::from_request(Request::from_parts(parts, body), service).await?;
        let idempotency_key = idempotency_key(&headers)?;
        Ok(Self { asking, validate, request, idempotency_key, resource: PhantomData })
    }
}

impl<T: Resource> Submission<T> {
    /// Queues it, or only checks it.
    ///
    /// # Errors
    /// A request that is refused.
    pub async fn submit(self) -> Result<Response, Problem> {
        let Self { asking: Asking { service, caller }, validate, request, idempotency_key, .. } = self;
        if validate {
            return T::validated(&service, request).await;
        }
        accepted::<T>(&service, T::submitted(&service, &caller, request, idempotency_key).await?).await
    }
}

/// The answer to what has been queued: where it is, and what it is.
pub(super) async fn accepted<T: Resource>(service: &Service, record: JobRecord) -> Result<Response, Problem> {
    let location = (T::ADDRESS)(record.id);
    let made = service.aside.make(record.bytes(), move || Ok::<_, Problem>(Json(T::try_from(record)?).into_response()));
    Ok((StatusCode::ACCEPTED, [(header::LOCATION, location)], made.await?).into_response())
}

/// Who asks, and about which one.
pub struct Asked<T> {
    pub service: Service,
    pub caller: Caller,
    pub id: Uuid,
    pub headers: HeaderMap,
    resource: PhantomData<fn() -> T>,
}

impl<T: Resource> FromRequestParts<Service> for Asked<T> {
    type Rejection = Problem;

    async fn from_request_parts(parts: &mut Parts, service: &Service) -> Result<Self, Problem> {
        let Asking { service, caller } = Asking::from_request_parts(parts, service).await?;
        let JobId(id) = JobId::from_request_parts(parts, &service).await?;
        Ok(Self { service, caller, id, headers: parts.headers.clone(), resource: PhantomData })
    }
}

impl<T: Resource> Asked<T> {
    /// The one that is asked about.
    ///
    /// # Errors
    /// There is none that the caller sees, or the store fails.
    pub async fn find(&self) -> Result<JobRecord, JobsError> {
        self.service.jobs.find(&self.caller, T::TASK, self.id).await
    }

    /// How far it has come.
    ///
    /// # Errors
    /// As for [`find`](Self::find).
    pub async fn standing(&self) -> Result<Standing, JobsError> {
        self.service.jobs.standing(&self.caller, T::TASK, self.id).await
    }

    /// A record of it in some form, with a tag where it has ended.
    ///
    /// # Errors
    /// A record that cannot be read.
    pub async fn shown<V: View>(self, record: JobRecord) -> Result<Response, Problem> {
        let Self { service, headers, .. } = self;
        let (bytes, is_finished) = (record.bytes(), record.status.is_ended());
        service.aside.make(bytes, move || tag::json(&headers, is_finished, &V::try_from(record)?)).await
    }

    /// A page of its stored lines past that index, so many at most, as they stand.
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
        service.aside.make(bytes, make).await
    }

    /// Stops it where it has not ended, and answers it.
    ///
    /// # Errors
    /// As for [`find`](Self::find).
    pub async fn cancel(self) -> Result<Response, Problem> {
        let Self { service, caller, id, .. } = self;
        let record = service.jobs.cancel(&caller, T::TASK, id).await?;
        let bytes = record.bytes();
        let made = move || Ok::<_, Problem>(Json(T::try_from(record)?).into_response());
        Ok((StatusCode::ACCEPTED, service.aside.make(bytes, made).await?).into_response())
    }

    /// Stops and drops it.
    ///
    /// # Errors
    /// As for [`find`](Self::find).
    pub async fn delete(self) -> Result<StatusCode, Problem> {
        self.service.jobs.delete(&self.caller, T::TASK, self.id).await?;
        Ok(StatusCode::NO_CONTENT)
    }
}
