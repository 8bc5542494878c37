//! The order of the queue: who comes after whom among jobs of one priority.
//!
//! Every waiting job has a turn, and the least one is claimed first, then the oldest. A job that is queued gets the turn after the
//! last of its owner's, or that of the front of the queue where this is later: so owners are served one after the other, and
//! whoever comes new comes at once, however much others have queued. Then, where jobs of its owner wait of which there are
//! more of a kind (runs of a sweep before studies, studies before single jobs), it changes places with one of those: the next
//! but one after the last of its own kind, so that one of many goes before each single one. What an owner has in all is served
//! as often as before. All of this looks at the ends of indices alone, however long the queue is.

use crate::service::store::Task;
use crate::service::store::contract::error::Result;
use crate::service::store::sql::dialect::{Dialect, values};
use crate::service::store::sql::engine::{Engine, Of, reader, writer};
use crate::service::store::sql::rows;
use uuid::Uuid;

/// Kinds of jobs, the fewest first.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord)]
pub(crate) enum Class {
    Single,
    Study,
    /// Runs of sweeps, and what explorations queue.
    Many,
}

impl Class {
    pub fn of(task: Task) -> Self {
        match task {
            Task::Path => Self::Single,
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

/// The turn of a job that is queued now, of a priority and an owner.
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

/// Which of an owner's jobs a new one of a lower class changes places with: `$1` the new one's id, `$2` its class, `$3` its
/// priority, `$4` its owner. The second of those past the last of its own class, or of a class still lower.
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

/// Puts a job that has just been queued between its owner's others, as a part of the transaction that has queued it.
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
            // Somebody has claimed it just now, and its turn is past.
            return Ok(());
        }
        D::run(connection, "UPDATE jobs SET turn = $2 WHERE id = $1", values![id, turn]).await?;
        // A study that has given its turn away takes one of those of which there are more.
        (id, class) = (other, Class::numbered(rows::number(&partner, "class")?));
    }
    Ok(())
}

/// Owners whose next job is far behind the front of the queue, with how far: jobs before it have been cancelled or dropped.
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

/// Closes such gaps: nobody waits for what is not there any more.
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
