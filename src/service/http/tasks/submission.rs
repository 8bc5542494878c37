//! Requests that are submitted: checked only, or queued.

use crate::service::http::answer::problem::Problem;
use crate::service::http::input::extract::{JsonText, Parameters, QueryParameters, idempotency_key};
use crate::service::http::state::service::Service;
use crate::service::http::tasks::requester::Requester;
use crate::service::http::tasks::resource::Resource;
use crate::service::jobs::Posted;
use crate::service::store::JobRecord;
use axum::Json;
use axum::extract::{FromRequest, FromRequestParts, Request};
use axum::http::{StatusCode, header};
use axum::response::{IntoResponse, Response};
use serde::Deserialize;
use std::marker::PhantomData;

#[derive(Debug, Deserialize, utoipa::IntoParams)]
#[serde(deny_unknown_fields)]
#[into_params(parameter_in = Query)]
pub struct SubmitParameters {
    /// Check the request and answer its plan; queue nothing.
    #[serde(default)]
    validate: bool,
}

impl QueryParameters for SubmitParameters {
    const EXPECTED: &'static [(&'static str, &'static str)] = &[("validate", "`true` or `false`")];
}

/// A request that is submitted.
pub struct Submission<T> {
    requester: Requester,
    validate: bool,
    request: Posted,
    idempotency_key: Option<String>,
    resource: PhantomData<fn() -> T>,
}

impl<T: Resource> FromRequest<Service> for Submission<T> {
    type Rejection = Problem;

    async fn from_request(request: Request, service: &Service) -> Result<Self, Problem> {
        let (mut parts, body) = request.into_parts();
        let requester = Requester::from_request_parts(&mut parts, service).await?;
        let Parameters(SubmitParameters { validate }) = Parameters::from_request_parts(&mut parts, service).await?;
        let headers = parts.headers.clone();
        let JsonText(request) = JsonText::from_request(Request::from_parts(parts, body), service).await?;
        let idempotency_key = idempotency_key(&headers)?;
        Ok(Self { requester, validate, request, idempotency_key, resource: PhantomData })
    }
}

impl<T: Resource> Submission<T> {
    /// Queues the request, or only checks it.
    ///
    /// # Errors
    /// A request that is refused.
    pub async fn submit(self) -> Result<Response, Problem> {
        let Self { requester: Requester { service, caller }, validate, request, idempotency_key, .. } = self;
        if validate {
            return T::validated(&service, request).await;
        }
        accepted::<T>(&service, T::submitted(&service, &caller, request, idempotency_key).await?).await
    }
}

/// The answer to a queued request: the address of the resource, and the resource.
pub async fn accepted<T: Resource>(service: &Service, record: JobRecord) -> Result<Response, Problem> {
    let location = (T::ADDRESS)(record.id);
    let made =
        service.offload.run(record.bytes(), move || Ok::<_, Problem>(Json(T::try_from(record)?).into_response()));
    Ok((StatusCode::ACCEPTED, [(header::LOCATION, location)], made.await?).into_response())
}
