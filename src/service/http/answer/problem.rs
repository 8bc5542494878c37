//! The only place where errors become answers: problem documents (RFC 9457).
//!
//! The layers below have typed errors without HTTP status codes. A problem document holds no SQL, no file path of this
//! machine and no stack trace; these go to the log under the id of the request.

use crate::model::{InputError, InputErrors};
use crate::service::jobs::JobsError;
use crate::service::store::{Status, StoreError};
use axum::body::Body;
use axum::extract::Request;
use axum::http::{HeaderValue, StatusCode, header};
use axum::middleware::Next;
use axum::response::{IntoResponse, Response};
use serde::Serialize;
use std::any::Any;
use std::time::Duration;

const MEDIA_TYPE: &str = "application/problem+json";
/// The `Retry-After` of an unavailable service.
const RETRY_AFTER: Duration = Duration::from_secs(2);
/// The `Retry-After` of a full queue and of a full disk, which take longer to recover.
const RETRY_WHEN_FULL: Duration = Duration::from_secs(10);

/// The kinds of problems; each has the last part of its `type`, a status and a title.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Kind {
    InvalidJson,
    InvalidModel,
    InvalidParameter,
    NotFollowable,
    NotRetryable,
    CheckTime,
    KeyReused,
    NotFound,
    MethodNotAllowed,
    NotAcceptable,
    BodyTooLarge,
    UnsupportedMediaType,
    RequestFailed,
    QueueFull,
    Unauthorized,
    Forbidden,
    RateLimited,
    AnswerTooLarge,
    Unavailable,
    StorageFull,
    StorageDamaged,
    Internal,
}

impl Kind {
    pub const ALL: [Self; 22] = [
        Self::InvalidJson,
        Self::InvalidModel,
        Self::InvalidParameter,
        Self::NotFollowable,
        Self::NotRetryable,
        Self::CheckTime,
        Self::KeyReused,
        Self::NotFound,
        Self::MethodNotAllowed,
        Self::NotAcceptable,
        Self::BodyTooLarge,
        Self::UnsupportedMediaType,
        Self::RequestFailed,
        Self::QueueFull,
        Self::Unauthorized,
        Self::Forbidden,
        Self::RateLimited,
        Self::AnswerTooLarge,
        Self::Unavailable,
        Self::StorageFull,
        Self::StorageDamaged,
        Self::Internal,
    ];

    /// Type, status, title.
    pub fn parts(self) -> (&'static str, StatusCode, &'static str) {
        match self {
            Self::InvalidJson => ("/problems/invalid-json", StatusCode::BAD_REQUEST, "The body is not JSON"),
            Self::InvalidModel => {
                ("/problems/invalid-model", StatusCode::UNPROCESSABLE_ENTITY, "The model or its analysis is not valid")
            }
            Self::InvalidParameter => {
                ("/problems/invalid-parameter", StatusCode::BAD_REQUEST, "A parameter or header is not valid")
            }
            Self::NotFollowable => {
                ("/problems/not-followable", StatusCode::UNPROCESSABLE_ENTITY, "There is nothing to follow")
            }
            Self::NotRetryable => ("/problems/not-retryable", StatusCode::CONFLICT, "This job cannot be queued again"),
            Self::CheckTime => {
                ("/problems/check-time-limit", StatusCode::UNPROCESSABLE_ENTITY, "Checking this takes too long")
            }
            Self::KeyReused => (
                "/problems/idempotency-key-reused",
                StatusCode::UNPROCESSABLE_ENTITY,
                "The idempotency key came before with another request",
            ),
            Self::NotFound => ("/problems/not-found", StatusCode::NOT_FOUND, "There is no such thing"),
            Self::MethodNotAllowed => {
                ("/problems/method-not-allowed", StatusCode::METHOD_NOT_ALLOWED, "This address takes other methods")
            }
            Self::NotAcceptable => {
                ("/problems/not-acceptable", StatusCode::NOT_ACCEPTABLE, "None of the accepted media types is offered")
            }
            Self::BodyTooLarge => ("/problems/body-too-large", StatusCode::PAYLOAD_TOO_LARGE, "The body is too large"),
            Self::UnsupportedMediaType => (
                "/problems/unsupported-media-type",
                StatusCode::UNSUPPORTED_MEDIA_TYPE,
                "The body has to be application/json",
            ),
            Self::RequestFailed => {
                ("/problems/request-failed", StatusCode::BAD_REQUEST, "The request could not be read")
            }
            Self::Unavailable => {
                ("/problems/unavailable", StatusCode::SERVICE_UNAVAILABLE, "The service cannot do this now")
            }
            Self::Unauthorized => {
                ("/problems/unauthorized", StatusCode::UNAUTHORIZED, "A token of this service is needed")
            }
            Self::Forbidden => ("/problems/forbidden", StatusCode::FORBIDDEN, "This may not be done"),
            Self::RateLimited => {
                ("/problems/rate-limited", StatusCode::TOO_MANY_REQUESTS, "Too many requests in too short a time")
            }
            Self::AnswerTooLarge => {
                ("/problems/answer-too-large", StatusCode::UNPROCESSABLE_ENTITY, "The answer would be too large")
            }
            Self::QueueFull => ("/problems/queue-full", StatusCode::TOO_MANY_REQUESTS, "Too many jobs wait already"),
            Self::StorageDamaged => {
                ("/problems/storage-damaged", StatusCode::INTERNAL_SERVER_ERROR, "What is stored is damaged")
            }
            Self::StorageFull => {
                ("/problems/storage-full", StatusCode::INSUFFICIENT_STORAGE, "There is no room to store this")
            }
            Self::Internal => ("/problems/internal", StatusCode::INTERNAL_SERVER_ERROR, "The service has a defect"),
        }
    }

    /// The kind of an error answer of the framework, which has a status alone.
    fn of_status(status: StatusCode) -> Self {
        match status {
            StatusCode::NOT_FOUND => Self::NotFound,
            StatusCode::METHOD_NOT_ALLOWED => Self::MethodNotAllowed,
            StatusCode::NOT_ACCEPTABLE => Self::NotAcceptable,
            StatusCode::PAYLOAD_TOO_LARGE => Self::BodyTooLarge,
            StatusCode::UNSUPPORTED_MEDIA_TYPE => Self::UnsupportedMediaType,
            StatusCode::UNAUTHORIZED => Self::Unauthorized,
            StatusCode::FORBIDDEN => Self::Forbidden,
            StatusCode::TOO_MANY_REQUESTS => Self::RateLimited,
            StatusCode::SERVICE_UNAVAILABLE => Self::Unavailable,
            status if status.is_client_error() => Self::RequestFailed,
            _ => Self::Internal,
        }
    }
}

/// The body of every error.
#[derive(Debug, Serialize, utoipa::ToSchema)]
#[schema(as = Problem)]
pub struct Document {
    /// Stable; listed in this document's description.
    #[serde(rename = "type")]
    kind: &'static str,
    title: &'static str,
    /// The HTTP status.
    status: u16,
    /// What is wrong in this case and what would do.
    detail: String,
    /// Every mistake found in the input, each with its place.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    errors: Vec<InputError>,
}

/// An error on its way to a client.
#[derive(Debug)]
pub struct Problem {
    kind: Kind,
    detail: String,
    errors: Vec<InputError>,
    /// After which time the same request may succeed.
    retry_after: Option<Duration>,
}

impl Problem {
    pub fn new(kind: Kind, detail: impl Into<String>) -> Self {
        let retry_after = match kind {
            Kind::Unavailable => Some(RETRY_AFTER),
            Kind::QueueFull | Kind::StorageFull => Some(RETRY_WHEN_FULL),
            _ => None,
        };
        Self { kind, detail: detail.into(), errors: Vec::new(), retry_after }
    }

    /// The rate limit of an address or token is exceeded.
    pub fn too_often(whom: &str, wait: Duration) -> Self {
        let detail = format!("too many requests from {whom}; the next one is answered in {:.3} s", wait.as_secs_f64());
        Self { retry_after: Some(wait), ..Self::new(Kind::RateLimited, detail) }
    }

    fn input(kind: Kind, errors: InputErrors) -> Self {
        let detail = match errors.0.as_slice() {
            [only] => only.to_string(),
            several => format!("{} mistakes were found", several.len()),
        };
        Self { errors: errors.0, ..Self::new(kind, detail) }
    }

    pub fn parameter(name: &str, detail: impl std::fmt::Display) -> Self {
        Self::new(Kind::InvalidParameter, format!("{name}: {detail}"))
    }

    /// What is logged, and none of the caller's business.
    pub fn internal() -> Self {
        Self::new(Kind::Internal, "the log of the service has details under the x-request-id of this answer")
    }

    pub fn not_found(what: impl std::fmt::Display) -> Self {
        Self::new(Kind::NotFound, format!("there is no {what}"))
    }
}

impl From<JobsError> for Problem {
    fn from(error: JobsError) -> Self {
        match error {
            JobsError::NotJson(errors) => Self::input(Kind::InvalidJson, errors),
            JobsError::Input(errors) => Self::input(Kind::InvalidModel, errors),
            JobsError::Follow(errors) => Self::input(Kind::NotFollowable, errors),
            JobsError::KeyReused => {
                Self::new(Kind::KeyReused, "repeat the first request byte for byte, or send another Idempotency-Key")
            }
            JobsError::QueueFull(most) => Self::new(
                Kind::QueueFull,
                format!("at most {most} jobs may wait, and the queue has no room for more; try again later"),
            ),
            JobsError::CheckTime(most) => Self::new(
                Kind::CheckTime,
                format!(
                    "the check took longer than {:.3} s, the limit of this service (--max-check-time); send a smaller \
                     model, or fewer runs at a time",
                    most.as_secs_f64()
                ),
            ),
            JobsError::NotRetryable(job) if job.status != Status::Failed => Self::new(
                Kind::NotRetryable,
                format!("job {} is {}; only one that has failed can be queued again", job.id, job.status.name()),
            ),
            JobsError::NotRetryable(job) => Self::new(
                Kind::NotRetryable,
                format!(
                    "job {0} is a run of a sweep, which is not queued again; its request (GET /v1/jobs/{0}/request) can be \
                     posted as a new job",
                    job.id
                ),
            ),
            JobsError::Abandoned => Self::new(Kind::Unavailable, "the check was stopped; try again"),
            JobsError::NoJob(id) => Self::not_found(format_args!("job {id}; GET /v1/jobs lists them, /docs all calls")),
            JobsError::NoStudy(id) => {
                Self::not_found(format_args!("study {id}; GET /v1/studies lists them, /docs all calls"))
            }
            JobsError::NoSweep(id) => {
                Self::not_found(format_args!("sweep {id}; GET /v1/sweeps lists them, /docs all calls"))
            }
            JobsError::NoCurve(id) => {
                Self::not_found(format_args!("curve {id}; GET /v1/curves lists them, /docs all calls"))
            }
            JobsError::Store(error) => error.into(),
            JobsError::Task(_) | JobsError::Write(_) => {
                tracing::error!(%error, "a request failed");
                Self::internal()
            }
        }
    }
}

impl From<StoreError> for Problem {
    fn from(error: StoreError) -> Self {
        tracing::error!(%error, source = ?std::error::Error::source(&error), "the store failed");
        match error {
            StoreError::Unavailable(_) => Self::new(Kind::Unavailable, "the database is not available; try again"),
            StoreError::Full(_) => Self::new(Kind::StorageFull, "the disk that holds the database is full"),
            StoreError::Damaged(_) => Self::new(
                Kind::StorageDamaged,
                "the database is damaged; no changes are accepted until the operator has restored a backup",
            ),
            StoreError::Open(_) | StoreError::Refused(_) => Self::internal(),
        }
    }
}

/// What went wrong while the increments of a job were read.
impl From<std::io::Error> for Problem {
    fn from(error: std::io::Error) -> Self {
        match error.downcast::<StoreError>() {
            Ok(error) => error.into(),
            Err(error) => {
                tracing::error!(%error, "stored increments cannot be read");
                Self::internal()
            }
        }
    }
}

impl From<serde_json::Error> for Problem {
    fn from(error: serde_json::Error) -> Self {
        tracing::error!(%error, "a stored record cannot be written as JSON");
        Self::new(Kind::Internal, "the stored record cannot be read")
    }
}

impl IntoResponse for Problem {
    fn into_response(self) -> Response {
        let (kind, status, title) = self.kind.parts();
        let document = Document { kind, title, status: status.as_u16(), detail: self.detail, errors: self.errors };
        // Five plain members, which can always be written as JSON.
        let body = serde_json::to_vec(&document).unwrap_or_default();
        let mut response = (status, [(header::CONTENT_TYPE, MEDIA_TYPE)], body).into_response();
        if let Some(wait) = self.retry_after {
            // Whole seconds (RFC 9110, section 10.2.3), rounded up.
            response.headers_mut().insert(header::RETRY_AFTER, HeaderValue::from(wait.as_secs_f64().ceil() as u64));
        }
        if self.kind == Kind::Unauthorized {
            response
                .headers_mut()
                .insert(header::WWW_AUTHENTICATE, HeaderValue::from_static("Bearer realm=\"arcslip\""));
        }
        response
    }
}

/// Turns error answers of the framework (unknown address, method or body) into problem documents and keeps their headers.
pub async fn every_error(request: Request, next: Next) -> Response {
    let asked = format!("{} {}", request.method(), request.uri().path());
    let response = next.run(request).await;
    let status = response.status();
    let is_problem = response.headers().get(header::CONTENT_TYPE).is_some_and(|value| value == MEDIA_TYPE);
    if is_problem || !(status.is_client_error() || status.is_server_error()) {
        return response;
    }
    let kind = Kind::of_status(status);
    let detail = match kind {
        Kind::NotFound => format!("nothing is served at {asked}; /docs lists what is, with examples"),
        Kind::MethodNotAllowed => format!("{asked} is not offered; the Allow header lists what is"),
        _ => format!("{asked}: {status}"),
    };
    let (mut parts, _) = response.into_parts();
    let (problem, body) = Problem::new(kind, detail).into_response().into_parts();
    parts.status = problem.status;
    parts.headers.remove(header::CONTENT_LENGTH);
    parts.headers.insert(header::CONTENT_TYPE, HeaderValue::from_static(MEDIA_TYPE));
    Response::from_parts(parts, body)
}

/// The answer to a call that panicked; the text of the panic only goes to the log.
pub fn from_panic(panic: Box<dyn Any + Send + 'static>) -> Response<Body> {
    let text = panic.downcast_ref::<String>().map(String::as_str).or(panic.downcast_ref::<&str>().copied());
    tracing::error!(panic = text, "a call panicked");
    Problem::internal().into_response()
}
