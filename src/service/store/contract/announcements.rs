//! Announcements of changes to other processes, gathered until they are sent.
//!
//! An announcement only says that something has changed: one that comes twice, late or not at all costs a read of the store.
//! Changes within a short time are therefore announced together, after they have been stored and apart from the transaction.

use std::collections::BTreeSet;
use std::sync::{Mutex, MutexGuard, PoisonError};
use tokio::sync::Notify;
use uuid::Uuid;

/// The most ids in a message, which may have 8,000 bytes.
const JOBS_A_MESSAGE: usize = 100;
const QUEUE: &str = "queue";

#[derive(Debug)]
pub struct Announcements {
    /// The name of this process, by which it ignores its own messages.
    from: Uuid,
    waiting: Mutex<Waiting>,
    more: Notify,
}

#[derive(Debug, Default)]
struct Waiting {
    queue: bool,
    jobs: BTreeSet<Uuid>,
}

/// An announcement of another process.
#[derive(Debug, PartialEq, Eq)]
pub enum Announced {
    Queue,
    Job(Uuid),
}

impl Announcements {
    pub fn new() -> Self {
        Self { from: Uuid::now_v7(), waiting: Mutex::default(), more: Notify::new() }
    }

    pub fn queue(&self) {
        self.waiting().queue = true;
        self.more.notify_one();
    }

    pub fn job(&self, id: Uuid) {
        self.waiting().jobs.insert(id);
        self.more.notify_one();
    }

    /// Waits for changes; answers the messages that announce them.
    pub async fn next(&self) -> Vec<String> {
        loop {
            let messages = self.take();
            if !messages.is_empty() {
                return messages;
            }
            self.more.notified().await;
        }
    }

    /// The messages for the changes gathered so far.
    pub fn take(&self) -> Vec<String> {
        let Waiting { queue, jobs } = std::mem::take(&mut *self.waiting());
        let mut words: Vec<String> = jobs.iter().map(|id| id.simple().to_string()).collect();
        if queue {
            words.push(QUEUE.to_owned());
        }
        words.chunks(JOBS_A_MESSAGE).map(|words| format!("{} {}", self.from.simple(), words.join(" "))).collect()
    }

    /// The announcements in a message of another process. Parts that cannot be read may be of a later version and are ignored.
    pub fn read(&self, message: &str) -> Vec<Announced> {
        let mut words = message.split(' ');
        if words.next().and_then(|from| from.parse::<Uuid>().ok()) == Some(self.from) {
            return Vec::new();
        }
        let announced = words.filter_map(|word| match word {
            QUEUE => Some(Announced::Queue),
            id => id.parse().ok().map(Announced::Job),
        });
        announced.collect()
    }

    fn waiting(&self) -> MutexGuard<'_, Waiting> {
        // Consistent wherever a thread that holds the lock could panic.
        self.waiting.lock().unwrap_or_else(PoisonError::into_inner)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn what_one_says_the_others_read_and_itself_does_not() {
        let (one, other) = (Announcements::new(), Announcements::new());
        let ids: Vec<Uuid> = (0..250).map(|_| Uuid::now_v7()).collect();
        for id in ids.iter().chain(&ids) {
            one.job(*id);
        }
        one.queue();
        let messages = one.take();
        assert!(messages.iter().all(|message| message.len() < 8000), "PostgreSQL takes no longer one");
        let read: Vec<Announced> = messages.iter().flat_map(|message| other.read(message)).collect();
        assert_eq!(read[..250], ids.into_iter().map(Announced::Job).collect::<Vec<_>>());
        assert_eq!(read[250..], [Announced::Queue]);
        assert_eq!(messages.iter().flat_map(|message| one.read(message)).count(), 0);
        assert_eq!(one.take(), Vec::<String>::new());
        assert_eq!(other.read("a later version's words queue"), [Announced::Queue]);
    }
}
