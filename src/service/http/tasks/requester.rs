//! Who makes a request, and the lists of resources that they see.

use crate::service::http::answer::problem::{Kind, Problem};
use crate::service::http::input::extract::{QueryParameters, bounded};
use crate::service::http::state::service::Service;
use crate::service::http::tasks::resource::Resource;
use crate::service::jobs::Caller;
use crate::service::store::{JobRecord, ListFilter, Listed, Page, Status};
use axum::extract::FromRequestParts;
use axum::http::request::Parts;
use serde::Deserialize;
use uuid::Uuid;

const LIST_DEFAULT: u32 = 50;
const LIST_LARGEST: u32 = 200;
/// A page ends early when what it lists is large.
const LIST_BYTES: usize = 1 << 20;

/// The query of a list that is filtered by status alone.
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

impl QueryParameters for ListByStatus {
    const EXPECTED: &'static [(&'static str, &'static str)] = &[
        ("status", "`queued`, `running`, `completed`, `stopped`, `cancelled` or `failed`"),
        ("cursor", "the `next_cursor` of the page before, a UUID,"),
        ("limit", "a whole number from 1 to 200"),
    ];
}

/// Which resources a list is to show, and which page of it.
#[derive(Debug, Default)]
pub struct ListQuery {
    pub status: Option<Status>,
    pub sweep: Option<Uuid>,
    pub parent: Option<Uuid>,
    pub cursor: Option<Uuid>,
    pub limit: Option<u32>,
}

impl From<ListByStatus> for ListQuery {
    fn from(ListByStatus { status, cursor, limit }: ListByStatus) -> Self {
        Self { status, cursor, limit, ..Self::default() }
    }
}

/// The caller of a request.
pub struct Requester {
    pub service: Service,
    pub caller: Caller,
}

impl FromRequestParts<Service> for Requester {
    type Rejection = Problem;

    async fn from_request_parts(parts: &mut Parts, service: &Service) -> Result<Self, Problem> {
        // Admission has put the caller there before any call is reached.
        let caller = parts.extensions.get::<Caller>().cloned();
        let caller = caller.ok_or_else(|| Problem::new(Kind::Internal, "the caller is not known"))?;
        Ok(Self { service: service.clone(), caller })
    }
}

impl Requester {
    /// The resources that the caller sees and the query selects, newest first, and the cursor of the next page.
    ///
    /// # Errors
    /// A limit out of its bounds, or a store that fails.
    pub async fn page<T: Resource>(self, query: ListQuery) -> Result<(Vec<T::Listed>, Option<Uuid>), Problem> {
        let Self { service, caller } = self;
        let ListQuery { status, sweep, parent, cursor: before, limit } = query;
        let rows = bounded("limit", limit, LIST_DEFAULT, LIST_LARGEST)?;
        let (owner, page) = (caller.seen_owner().map(str::to_owned), Page { rows, bytes: LIST_BYTES });
        let filter = ListFilter { task: T::TASK, owner, status, sweep, parent, before, page };
        let Listed { jobs, more } = service.jobs.store().jobs(filter).await?;
        let next_cursor = jobs.last().map(|record| record.id).filter(|_| more);
        let bytes = jobs.iter().map(JobRecord::bytes).sum();
        let made =
            service.offload.run(bytes, move || jobs.into_iter().map(T::Listed::try_from).collect::<Result<_, _>>());
        Ok((made.await?, next_cursor))
    }
}
