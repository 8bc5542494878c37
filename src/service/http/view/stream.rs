//! Events of a stream as they are described.

use serde::Serialize;
use utoipa::ToSchema;

/// One event of a stream (WHATWG HTML, section 9.2); what is absent was not sent.
#[derive(Debug, Serialize, ToSchema)]
pub struct ServerEvent {
    /// `increment` or `row`, then `end`; `deleted` where that ends it.
    #[schema(nullable = false)]
    pub event: Option<String>,
    /// The index, of an increment or row.
    #[schema(nullable = false)]
    pub id: Option<String>,
    /// JSON: the increment or the row; of `end`, the job, the study or the sweep.
    #[schema(nullable = false)]
    pub data: Option<String>,
    /// Milliseconds after which it is worth coming back.
    #[schema(nullable = false)]
    pub retry: Option<u64>,
}
