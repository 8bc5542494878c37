//! What the answers about jobs, studies and sweeps have in common.

use crate::service::store::{JobRecord, Status};
use jiff::Timestamp;
use serde::Serialize;
use utoipa::ToSchema;
use uuid::Uuid;

/// What jobs and studies have in common.
#[derive(Debug, Serialize, ToSchema)]
pub struct Submitted {
    pub id: Uuid,
    /// The name of the token that it was posted with; null where the service asked for none.
    pub owner: Option<String>,
    /// The model's own name.
    pub name: Option<String>,
    pub status: Status,
    /// Why it failed, or which limit of this service stopped it.
    pub error: Option<String>,
    /// What a reader should know of a job that has not ended: that it has lost its worker, and what happens next.
    pub note: Option<String>,
    /// A cancel was asked for; it ends within one iteration.
    pub cancel_requested: bool,
    /// Times it was started.
    pub attempt: u32,
    /// Workers that it has lost in a row (their process ended, or did not answer in time), nothing stored between.
    pub losses: u32,
    /// Those of them that speak against it: it was the only job that was lost then, or had lost a worker before.
    pub counted_losses: u32,
    /// So many of those, and it fails.
    pub max_attempts: u32,
    #[schema(value_type = String, format = DateTime)]
    pub created_at: Timestamp,
    #[schema(value_type = Option<String>, format = DateTime)]
    pub started_at: Option<Timestamp>,
    #[schema(value_type = Option<String>, format = DateTime)]
    pub ended_at: Option<Timestamp>,
}

impl From<&JobRecord> for Submitted {
    fn from(record: &JobRecord) -> Self {
        Self {
            id: record.id,
            owner: record.owner.clone(),
            name: record.name.clone(),
            status: record.status,
            error: record.error.clone(),
            note: lost_worker(record),
            cancel_requested: record.cancel_requested,
            attempt: record.attempt,
            losses: record.losses,
            counted_losses: record.counted_losses,
            max_attempts: record.max_attempts,
            created_at: record.created_at,
            started_at: record.started_at,
            ended_at: record.ended_at,
        }
    }
}

/// What is said of a job that goes on after its worker was lost.
fn lost_worker(record: &JobRecord) -> Option<String> {
    let next = match record.status {
        Status::Queued => "it waits for another worker",
        Status::Running => "another worker has it now",
        Status::Completed | Status::Stopped | Status::Cancelled | Status::Failed => return None,
    };
    let times = match record.losses {
        0 => return None,
        1 => "its worker was lost".to_owned(),
        more => format!("its workers were lost, {more} in a row"),
    };
    let from = match record.last_index {
        Some(index) => format!("goes on after increment {index}, the last one stored"),
        None => "begins anew, as nothing was stored".to_owned(),
    };
    Some(format!("{times}: the process ended, or did not renew its lease in time; {next}, and it {from}"))
}
