//! What has changed since a position: jobs, studies and sweeps in the order of their last changes, and those deleted.
//!
//! Triggers number the changes, whatever made them. Several changes of one job count as one, the last. Numbers below the one
//! that the engine calls settled are complete: no change with such a number can appear any more.

use crate::service::store::contract::error::Result;
use crate::service::store::sql::dialect::{Dialect, Value, values};
use crate::service::store::sql::engine::{Engine, Of, reader};
use crate::service::store::sql::rows::{self, job_columns};
use crate::service::store::{FeedEntry, FeedPage, FeedPosition};
use uuid::Uuid;

/// Texts as long as in lists; a part of a format string.
macro_rules! shown {
    () => {
        job_columns!("substr(name, 1, 200) AS name, substr(error, 1, 1000) AS error, NULL AS report, '{{}}' AS plan")
    };
}

/// Changes after a position and before a number, in order, at most so many; `$1`, `$2` the position, `$3` the number, `$4` the
/// count.
macro_rules! after {
    ($id:literal) => {
        concat!(" (change, ", $id, ") > ($1, $2) AND change < $3 ")
    };
}

/// Changes after a position, at most `most`; of one owner, or of all.
///
/// Without a position, or where the position is not of this database, the page is empty and has the position to begin at.
pub(super) async fn read<E: Engine>(
    engine: &E,
    owner: Option<&str>,
    after: Option<FeedPosition>,
    most: u32,
) -> Result<FeedPage> {
    let mut connection = reader(engine).await?;
    // First, in a statement of its own: the following ones then see every change below the number.
    let settled = Of::<E>::first(&mut connection, <Of<E> as Dialect>::SETTLED, values![]).await?;
    let settled = rows::number(&settled.ok_or(sqlx::Error::RowNotFound)?, "settled")?;
    let end = FeedPosition { change: settled.saturating_sub(1), id: Uuid::max() };
    let Some(after) = after.filter(|position| position.change < settled) else {
        return Ok(FeedPage { entries: Vec::new(), end, more: false, begins: true });
    };
    let mut values = values![after.change, after.id, settled, most].to_vec();
    let mut of_owner = "";
    if let Some(owner) = owner {
        values.push(Value::from(owner));
        of_owner = "AND owner = $5 ";
    }
    let changed = format!(
        concat!("SELECT change, ", shown!(), " FROM jobs WHERE", after!("id"), "{}ORDER BY change, id LIMIT $4"),
        of_owner
    );
    let deleted = format!(
        concat!("SELECT change, job, task FROM deletions WHERE", after!("job"), "{}ORDER BY change, job LIMIT $4"),
        of_owner
    );
    let mut entries = Vec::new();
    for row in Of::<E>::rows(&mut connection, &changed, &values).await? {
        let job = rows::job(&row)?;
        let at = FeedPosition { change: rows::number(&row, "change")?, id: job.id };
        entries.push(FeedEntry { at, task: job.task, job: Some(job) });
    }
    for row in Of::<E>::rows(&mut connection, &deleted, &values).await? {
        let at = FeedPosition { change: rows::number(&row, "change")?, id: rows::id(&row, "job")? };
        entries.push(FeedEntry { at, task: rows::task(&row)?, job: None });
    }
    // Each list is complete up to its last entry, so that the first entries of both together are complete, too.
    entries.sort_by_key(|entry| entry.at);
    let more = entries.len() >= most as usize;
    entries.truncate(most as usize);
    let end = entries.last().filter(|_| more).map_or(end, |entry| entry.at);
    Ok(FeedPage { entries, end, more, begins: false })
}
