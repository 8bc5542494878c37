//! The order of the queue among jobs of the same priority.
//!
//! Every waiting job has a turn number. The job with the least number is claimed first, among equals the oldest. A new job gets
//! the number after the last one of its owner, or that of the front of the queue if this is larger: owners are served in turn,
//! and a new owner is served at once, however many jobs others have queued. The new job then exchanges its number with a job of
//! the same owner that belongs to a larger group (runs of sweeps before studies, studies before single jobs): the second one
//! after the last job of its own class, so that jobs of both classes alternate. The share of the owner does not change. All
//! statements only read the ends of indices, however long the queue is.

use crate::service::store::Task;
use crate::service::store::contract::error::Result;
use crate::service::store::sql::dialect::{Dialect, values};
use crate::service::store::sql::engine::{Engine, Of, reader, writer};
use crate::service::store::sql::rows;
use uuid::Uuid;

/// Classes of jobs by the usual size of their groups, the smallest first.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord)]
pub(crate) enum Class {
    Single,
    Study,
    /// Runs of sweeps, and jobs of explorations.
    Many,
}

impl Class {
    pub fn of(task: Task) -> Self {
        match task {
            Task::Path | Task::Curve => Self::Single,
            Task::Study => Self::Study,
            Task::Sweep => Self::Many,
        }
    }

    pub fn numbered(number: u64) -> Self {
        match number {
            0 => Self::Single,
            1 => Self::Study,
            _ => Self::Many,
        }
    }

    pub fn number(self) -> i64 {
        match self {
            Self::Single => 0,
            Self::Study => 1,
            Self::Many => 2,
        }
    }
}

/// The first or last turn (`min` or `max`) of an owner's waiting jobs of one class.
macro_rules! turn_of_class {
    ($which:literal, $priority:literal, $owner:literal, $class:literal) => {
        concat!(
            "(SELECT ",
            $which,
            "(turn) FROM jobs WHERE status = 'queued' AND priority = ",
            $priority,
            " AND coalesce(owner, '') = coalesce(",
            $owner,
            ", '') AND class = ",
            $class,
            ")"
        )
    };
}

/// The turn of a new job of the given priority and owner.
macro_rules! next_turn {
    ($priority:literal, $owner:literal) => {
        concat!(
            "(SELECT coalesce(max(turn), 0) FROM (SELECT (SELECT turn FROM jobs WHERE status = 'queued' AND priority = ",
            $priority,
            " ORDER BY turn, id LIMIT 1) AS turn UNION ALL SELECT 1 + ",
            $crate::service::store::sql::turns::turn_of_class!("max", $priority, $owner, "0"),
            " UNION ALL SELECT 1 + ",
            $crate::service::store::sql::turns::turn_of_class!("max", $priority, $owner, "1"),
            " UNION ALL SELECT 1 + ",
            $crate::service::store::sql::turns::turn_of_class!("max", $priority, $owner, "2"),
            ") AS turns)"
        )
    };
}
pub(crate) use next_turn;
pub(crate) use turn_of_class;

/// The job of an owner with which a new job of a lower class exchanges turns: `$1` id, `$2` class, `$3` priority and `$4` owner of
/// the new job. It is the second one past the last job of the same or a lower class.
pub(crate) const PARTNER: &str = "WITH past AS (SELECT coalesce(max(turn), -1) AS turn FROM (\
     SELECT (SELECT turn FROM jobs WHERE status = 'queued' AND priority = $3 AND coalesce(owner, '') = coalesce($4, '') \
     AND class = 0 AND id <> $1 ORDER BY turn DESC LIMIT 1) AS turn UNION ALL \
     SELECT (SELECT turn FROM jobs WHERE status = 'queued' AND priority = $3 AND coalesce(owner, '') = coalesce($4, '') \
     AND class = 1 AND $2 >= 1 AND id <> $1 ORDER BY turn DESC LIMIT 1)) AS own) \
     SELECT id, turn, class FROM (SELECT id, turn, class FROM jobs WHERE status = 'queued' AND priority = $3 \
     AND coalesce(owner, '') = coalesce($4, '') AND class = 1 AND $2 < 1 AND turn > (SELECT turn FROM past) \
     ORDER BY turn, id LIMIT 2) AS studies UNION ALL \
     SELECT id, turn, class FROM (SELECT id, turn, class FROM jobs WHERE status = 'queued' AND priority = $3 \
     AND coalesce(owner, '') = coalesce($4, '') AND class = 2 AND turn > (SELECT turn FROM past) \
     ORDER BY turn, id LIMIT 2) AS many ORDER BY turn, id LIMIT 1 OFFSET 1";

/// Moves a new job between the other jobs of its owner, in the transaction that has queued it.
pub(crate) async fn put_between<D: Dialect>(
    connection: &mut D::Connection,
    mut id: Uuid,
    mut class: Class,
    priority: i64,
    owner: Option<&str>,
) -> Result<()> {
    while class < Class::Many {
        let partner = D::first(connection, PARTNER, values![id, class.number(), priority, owner]).await?;
        let Some(partner) = partner else { return Ok(()) };
        let (other, turn) = (rows::id(&partner, "id")?, rows::number(&partner, "turn")?);
        let later = "UPDATE jobs SET turn = (SELECT turn FROM jobs AS one WHERE one.id = $1) WHERE id = $2 AND status = 'queued'";
        if D::run(connection, later, values![id, other]).await? == 0 {
            // The other job has just been claimed.
            return Ok(());
        }
        D::run(connection, "UPDATE jobs SET turn = $2 WHERE id = $1", values![id, turn]).await?;
        // A study that has given its turn away exchanges turns with a job of a higher class.
        (id, class) = (other, Class::numbered(rows::number(&partner, "class")?));
    }
    Ok(())
}

/// The owners whose next job is far behind the front of the queue, and the distance: jobs before it were cancelled or deleted.
const BEHIND: &str = concat!(
    "WITH RECURSIVE front AS (SELECT priority, turn FROM jobs {waiting} WHERE status = 'queued' \
     ORDER BY priority DESC, turn, id LIMIT 1), \
     owners AS (SELECT (SELECT min(coalesce(owner, '')) FROM jobs WHERE status = 'queued' \
     AND priority = (SELECT priority FROM front)) AS owner UNION ALL \
     SELECT (SELECT min(coalesce(jobs.owner, '')) FROM jobs WHERE status = 'queued' \
     AND priority = (SELECT priority FROM front) AND coalesce(jobs.owner, '') > owners.owner) \
     FROM owners WHERE owners.owner IS NOT NULL), \
     firsts AS (SELECT owners.owner AS owner, (SELECT min(turn) FROM (SELECT ",
    turn_of_class!("min", "(SELECT priority FROM front)", "owners.owner", "0"),
    " AS turn UNION ALL SELECT ",
    turn_of_class!("min", "(SELECT priority FROM front)", "owners.owner", "1"),
    " UNION ALL SELECT ",
    turn_of_class!("min", "(SELECT priority FROM front)", "owners.owner", "2"),
    ") AS own) AS turn FROM owners WHERE owners.owner IS NOT NULL) \
     SELECT firsts.owner AS owner, front.priority AS priority, firsts.turn - front.turn AS behind FROM firsts, front \
     WHERE firsts.turn > front.turn + 1"
);

/// Closes such gaps, so that no job waits for cancelled ones.
pub(super) async fn close_gaps<E: Engine>(engine: &E) -> Result<()> {
    let behind = Of::<E>::rows(&mut *reader(engine).await?, BEHIND, values![]).await?;
    for row in behind {
        let (owner, distance) = (rows::text(&row, "owner")?, rows::number(&row, "behind")?);
        let priority = rows::signed(&row, "priority")?;
        let forward = "UPDATE jobs SET turn = turn - $3 WHERE id IN (SELECT id FROM jobs WHERE status = 'queued' \
                       AND priority = $1 AND coalesce(owner, '') = $2 {free})";
        Of::<E>::run(&mut *writer(engine).await?, forward, values![priority, &owner, distance]).await?;
    }
    Ok(())
}
