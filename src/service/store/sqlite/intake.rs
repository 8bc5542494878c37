//! Group commit of submissions: those that wait for the writing connection are stored together, with one commit and one sync.
//!
//! The first submission starts a task that waits for the connection; later ones join it. All are answered after the commit.

use crate::service::store::contract::error::Result;
use crate::service::store::sql::jobs;
use crate::service::store::sqlite::SqliteEngine;
use crate::service::store::{NewJob, StoreError, Submitted};
use sqlx::sqlite::{Sqlite, SqlitePool};
use std::sync::{Arc, Mutex, MutexGuard, PoisonError};
use tokio::sync::oneshot;

/// The most jobs in a commit, which then takes no longer than a batch of increments.
const AT_ONCE: usize = 64;

#[derive(Default, Clone)]
pub(super) struct Intake(Arc<Mutex<Vec<Waiting>>>);

struct Waiting {
    job: NewJob,
    answer: oneshot::Sender<Result<Submitted>>,
}

pub(super) async fn submit(engine: &SqliteEngine, job: NewJob) -> Result<Submitted> {
    let (answer, answered) = oneshot::channel();
    let is_first = {
        let mut waiting = engine.intake.waiting();
        waiting.push(Waiting { job, answer });
        waiting.len() == 1
    };
    if is_first {
        // A task of its own, which continues if the first client disconnects.
        tokio::spawn(take_in(engine.writer.clone(), engine.intake.clone()));
    }
    answered.await.map_err(|lost| StoreError::Unavailable(Box::new(lost)))?
}

/// Stores all waiting submissions, and those that come meanwhile.
async fn take_in(writer: SqlitePool, intake: Intake) {
    loop {
        // The connection first: until it is available others may join.
        let begun = writer.begin().await;
        let (together, more) = intake.take();
        match begun {
            Ok(transaction) => store_together(&writer, transaction, together).await,
            Err(error) => {
                let error = StoreError::from(error);
                for waiting in together {
                    waiting.tell(Err(error.told_again()));
                }
            }
        }
        if !more {
            return;
        }
    }
}

/// One commit for all; if it fails, one for each, so that no submission fails because of another.
async fn store_together(
    writer: &SqlitePool,
    mut transaction: sqlx::Transaction<'static, Sqlite>,
    together: Vec<Waiting>,
) {
    let stored = async {
        let mut submitted = Vec::with_capacity(together.len());
        for Waiting { job, .. } in &together {
            submitted.push(jobs::insert::<Sqlite>(&mut transaction, job).await?);
        }
        transaction.commit().await?;
        Ok::<_, StoreError>(submitted)
    };
    match stored.await {
        Ok(submitted) => together.into_iter().zip(submitted).for_each(|(waiting, one)| waiting.tell(Ok(one))),
        Err(_) => {
            for waiting in together {
                let alone = alone(writer, &waiting.job).await;
                waiting.tell(alone);
            }
        }
    }
}

async fn alone(writer: &SqlitePool, job: &NewJob) -> Result<Submitted> {
    let mut transaction = writer.begin().await?;
    let submitted = jobs::insert::<Sqlite>(&mut transaction, job).await?;
    transaction.commit().await?;
    Ok(submitted)
}

impl Waiting {
    fn tell(self, submitted: Result<Submitted>) {
        // The client may have disconnected; the job is queued all the same.
        let _ = self.answer.send(submitted);
    }
}

impl Intake {
    /// The next submissions, and whether there are more.
    fn take(&self) -> (Vec<Waiting>, bool) {
        let mut waiting = self.waiting();
        let together = waiting.len().min(AT_ONCE);
        let rest = waiting.split_off(together);
        let more = !rest.is_empty();
        (std::mem::replace(&mut *waiting, rest), more)
    }

    fn waiting(&self) -> MutexGuard<'_, Vec<Waiting>> {
        // The list is consistent wherever a thread that holds the lock could panic.
        self.0.lock().unwrap_or_else(PoisonError::into_inner)
    }
}
