//! What can be submitted: the task behind each resource of the interface, its address and its answers.

use crate::service::http::answer::problem::Problem;
use crate::service::http::state::service::Service;
use crate::service::jobs::{Caller, JobsError, Posted};
use crate::service::store::{JobRecord, Task};
use axum::response::Response;
use serde::Serialize;
use uuid::Uuid;

/// A view of a stored record, as it is answered.
pub trait View: TryFrom<JobRecord, Error = serde_json::Error> + Serialize + Send + 'static {}

impl<T: TryFrom<JobRecord, Error = serde_json::Error> + Serialize + Send + 'static> View for T {}

/// What can be submitted; implemented by the view in which a single resource is answered.
pub trait Resource: View {
    const TASK: Task;
    /// The address of a resource, by its id.
    const ADDRESS: fn(Uuid) -> String;
    /// The view of the resource in lists.
    type Listed: View;

    /// Answers what would be done with a request; nothing is queued.
    fn validated(service: &Service, request: Posted) -> impl Future<Output = Result<Response, Problem>> + Send;

    /// Queues the request.
    fn submitted(
        service: &Service,
        caller: &Caller,
        request: Posted,
        idempotency_key: Option<String>,
    ) -> impl Future<Output = Result<JobRecord, JobsError>> + Send;
}
