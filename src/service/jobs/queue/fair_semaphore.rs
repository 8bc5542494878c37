//! A semaphore that shares its permits fairly between clients. The next permit goes to the client that holds the fewest, then
//! to the one that was served longest ago, then to the one that came first; no client holds all permits.

use std::collections::HashMap;
use std::sync::{Arc, Mutex, MutexGuard, PoisonError};
use tokio::sync::oneshot;

/// A client: an owner of jobs, or an address where callers are anonymous.
#[derive(Debug, Clone, PartialEq, Eq, Hash, Default)]
pub struct Client(pub String);

/// A semaphore with a fixed number of permits.
#[derive(Debug, Clone)]
pub struct FairSemaphore(Arc<Shared>);

#[derive(Debug)]
struct Shared {
    permits: usize,
    state: Mutex<State>,
}

#[derive(Debug, Default)]
struct State {
    taken: usize,
    /// The clients that hold permits or wait for one.
    clients: HashMap<Client, Served>,
    /// The waiting requests, in the order in which they came.
    waiting: Vec<Waiting>,
    /// The number of permits issued so far.
    given: u64,
}

#[derive(Debug, Default)]
struct Served {
    holds: usize,
    waits: usize,
    /// The number of the last permit issued to this client.
    last: u64,
}

#[derive(Debug)]
struct Waiting {
    client: Client,
    permit: oneshot::Sender<Permit>,
}

/// A permit, released on drop.
#[derive(Debug)]
pub struct Permit {
    semaphore: Option<FairSemaphore>,
    client: Client,
}

impl FairSemaphore {
    /// A semaphore with at least two permits: one client may hold all but one of them.
    pub fn of(permits: usize) -> Self {
        Self(Arc::new(Shared { permits: permits.max(2), state: Mutex::default() }))
    }

    /// Waits for a permit. Dropping the future is safe: an issued permit returns to the semaphore.
    pub async fn acquire(&self, client: &Client) -> Permit {
        let (permit, given) = oneshot::channel();
        {
            let mut state = self.state();
            state.clients.entry(client.clone()).or_default().waits += 1;
            state.waiting.push(Waiting { client: client.clone(), permit });
            self.give(&mut state);
        }
        match given.await {
            Ok(permit) => permit,
            // The sender is only dropped with the semaphore, which this call borrows.
            Err(_) => std::future::pending().await,
        }
    }

    /// Issues the free permits to the clients that come next.
    fn give(&self, state: &mut State) {
        let State { taken, clients, waiting, given } = state;
        waiting.retain(|one| {
            let gone = one.permit.is_closed();
            if gone {
                Self::count(clients, &one.client, |served| served.waits -= 1);
            }
            !gone
        });
        while *taken < self.0.permits {
            let permits = self.0.permits;
            let standing =
                |one: &Waiting| clients.get(&one.client).map_or((0, 0), |served| (served.holds, served.last));
            let waits = waiting.iter().enumerate().map(|(number, one)| (standing(one), number));
            let Some((_, next)) = waits.filter(|((holds, _), _)| holds + 1 < permits).min() else { return };
            let Waiting { client, permit } = waiting.remove(next);
            let offered = Permit { semaphore: Some(self.clone()), client: client.clone() };
            let is_taken = match permit.send(offered) {
                Ok(()) => true,
                Err(mut refused) => {
                    // Released without `drop`, which would lock the state that is locked here.
                    refused.semaphore = None;
                    false
                }
            };
            if is_taken {
                *given += 1;
                *taken += 1;
            }
            let number = *given;
            Self::count(clients, &client, |served| {
                served.waits -= 1;
                if is_taken {
                    served.holds += 1;
                    served.last = number;
                }
            });
        }
    }

    /// Changes the counts of a client, and removes a client that neither holds nor awaits permits.
    fn count(clients: &mut HashMap<Client, Served>, client: &Client, change: impl FnOnce(&mut Served)) {
        if let Some(served) = clients.get_mut(client) {
            change(served);
            if served.holds == 0 && served.waits == 0 {
                clients.remove(client);
            }
        }
    }

    fn state(&self) -> MutexGuard<'_, State> {
        // The state is consistent wherever a thread that holds the lock could panic.
        self.0.state.lock().unwrap_or_else(PoisonError::into_inner)
    }
}

impl Drop for Permit {
    fn drop(&mut self) {
        let Some(semaphore) = self.semaphore.take() else { return };
        let mut state = semaphore.state();
        state.taken -= 1;
        FairSemaphore::count(&mut state.clients, &self.client, |served| served.holds -= 1);
        semaphore.give(&mut state);
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::sync::mpsc;
    use tokio::task::yield_now;

    fn client(name: &str) -> Client {
        Client(name.to_owned())
    }

    /// Waits for a permit in a task, and sends it when it has been issued.
    fn wait(semaphore: &FairSemaphore, name: &'static str, told: &mpsc::Sender<(&'static str, Permit)>) {
        let (semaphore, told) = (semaphore.clone(), told.clone());
        tokio::spawn(async move {
            let permit = semaphore.acquire(&client(name)).await;
            let _ = told.send((name, permit));
        });
    }

    #[tokio::test]
    async fn one_client_never_holds_all_places_and_takes_turns_with_others() {
        let semaphore = FairSemaphore::of(2);
        let (told, given) = mpsc::channel();
        for name in ["a", "a", "a", "b", "b", "c"] {
            wait(&semaphore, name, &told);
            yield_now().await;
        }
        let mut served = Vec::new();
        let mut held: Vec<(&str, Permit)> = given.try_iter().collect();
        while !held.is_empty() {
            let names: Vec<&str> = held.iter().map(|(name, _)| *name).collect();
            assert!(names.len() <= 2 && names != ["a", "a"], "{names:?}");
            let (name, permit) = held.remove(0);
            served.push(name);
            drop(permit);
            yield_now().await;
            held.extend(given.try_iter());
        }
        assert_eq!(served, ["a", "b", "c", "a", "b", "a"]);
        let state = semaphore.state();
        assert_eq!((state.taken, state.clients.len(), state.waiting.len()), (0, 0, 0), "nothing is left behind");
    }

    #[tokio::test]
    async fn whoever_stops_waiting_is_passed_over() {
        let semaphore = FairSemaphore::of(2);
        let first = semaphore.acquire(&client("a")).await;
        let waits = tokio::spawn({
            let semaphore = semaphore.clone();
            async move { semaphore.acquire(&client("a")).await }
        });
        yield_now().await;
        waits.abort();
        assert!(waits.await.is_err());
        let other = semaphore.acquire(&client("b")).await;
        drop((first, other));
        drop(semaphore.acquire(&client("a")).await);
        let state = semaphore.state();
        assert_eq!((state.taken, state.clients.len(), state.waiting.len()), (0, 0, 0));
    }
}
