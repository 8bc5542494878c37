//! Places for work that clients ask for, shared out between them: whoever holds the fewest comes next, then whoever was last
//! served longest ago, then whoever came first; and no client holds them all.

use std::collections::HashMap;
use std::sync::{Arc, Mutex, MutexGuard, PoisonError};
use tokio::sync::oneshot;

/// Whose work it is: an owner, or where there is none an address.
#[derive(Debug, Clone, PartialEq, Eq, Hash, Default)]
pub struct Client(pub String);

/// So many places.
#[derive(Debug, Clone)]
pub struct Lane(Arc<Shared>);

#[derive(Debug)]
struct Shared {
    places: usize,
    state: Mutex<State>,
}

#[derive(Debug, Default)]
struct State {
    taken: usize,
    /// Those who hold places or wait for one.
    clients: HashMap<Client, Served>,
    /// In the order in which they came.
    waiting: Vec<Waiting>,
    /// Places given so far.
    given: u64,
}

#[derive(Debug, Default)]
struct Served {
    holds: usize,
    waits: usize,
    /// The number of the last place given to it.
    last: u64,
}

#[derive(Debug)]
struct Waiting {
    client: Client,
    place: oneshot::Sender<Place>,
}

/// A place, given back when it is dropped.
#[derive(Debug)]
pub struct Place {
    lane: Option<Lane>,
    client: Client,
}

impl Lane {
    /// Of at least two places: one client may hold all but one of them.
    pub fn of(places: usize) -> Self {
        Self(Arc::new(Shared { places: places.max(2), state: Mutex::default() }))
    }

    /// Waits for a place. Whoever stops waiting has lost nothing to anybody.
    pub async fn place(&self, client: &Client) -> Place {
        let (place, given) = oneshot::channel();
        {
            let mut state = self.state();
            state.clients.entry(client.clone()).or_default().waits += 1;
            state.waiting.push(Waiting { client: client.clone(), place });
            self.give(&mut state);
        }
        match given.await {
            Ok(place) => place,
            // Only dropped with the lane, which this call holds.
            Err(_) => std::future::pending().await,
        }
    }

    /// Gives the places that are free to those who are next.
    fn give(&self, state: &mut State) {
        let State { taken, clients, waiting, given } = state;
        waiting.retain(|one| {
            let gone = one.place.is_closed();
            if gone {
                Self::count(clients, &one.client, |served| served.waits -= 1);
            }
            !gone
        });
        while *taken < self.0.places {
            let places = self.0.places;
            let standing =
                |one: &Waiting| clients.get(&one.client).map_or((0, 0), |served| (served.holds, served.last));
            let waits = waiting.iter().enumerate().map(|(number, one)| (standing(one), number));
            let Some((_, next)) = waits.filter(|((holds, _), _)| holds + 1 < places).min() else { return };
            let Waiting { client, place } = waiting.remove(next);
            let offered = Place { lane: Some(self.clone()), client: client.clone() };
            let is_taken = match place.send(offered) {
                Ok(()) => true,
                Err(mut refused) => {
                    // Given back without its drop, which would look into what is held here.
                    refused.lane = None;
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

    /// Changes what is known of a client, and forgets one that neither holds nor waits.
    fn count(clients: &mut HashMap<Client, Served>, client: &Client, change: impl FnOnce(&mut Served)) {
        if let Some(served) = clients.get_mut(client) {
            change(served);
            if served.holds == 0 && served.waits == 0 {
                clients.remove(client);
            }
        }
    }

    fn state(&self) -> MutexGuard<'_, State> {
        // The state is whole at every point where its holder could panic.
        self.0.state.lock().unwrap_or_else(PoisonError::into_inner)
    }
}

impl Drop for Place {
    fn drop(&mut self) {
        let Some(lane) = self.lane.take() else { return };
        let mut state = lane.state();
        state.taken -= 1;
        Lane::count(&mut state.clients, &self.client, |served| served.holds -= 1);
        lane.give(&mut state);
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

    /// Waits in a task, and tells when it has its place.
    fn wait(lane: &Lane, name: &'static str, told: &mpsc::Sender<(&'static str, Place)>) {
        let (lane, told) = (lane.clone(), told.clone());
        tokio::spawn(async move {
            let place = lane.place(&client(name)).await;
            let _ = told.send((name, place));
        });
    }

    #[tokio::test]
    async fn one_client_never_holds_all_places_and_takes_turns_with_others() {
        let lane = Lane::of(2);
        let (told, given) = mpsc::channel();
        for name in ["a", "a", "a", "b", "b", "c"] {
            wait(&lane, name, &told);
            yield_now().await;
        }
        let mut served = Vec::new();
        let mut held: Vec<(&str, Place)> = given.try_iter().collect();
        while !held.is_empty() {
            let names: Vec<&str> = held.iter().map(|(name, _)| *name).collect();
            assert!(names.len() <= 2 && names != ["a", "a"], "{names:?}");
            let (name, place) = held.remove(0);
            served.push(name);
            drop(place);
            yield_now().await;
            held.extend(given.try_iter());
        }
        assert_eq!(served, ["a", "b", "c", "a", "b", "a"]);
        let state = lane.state();
        assert_eq!((state.taken, state.clients.len(), state.waiting.len()), (0, 0, 0), "nothing is left behind");
    }

    #[tokio::test]
    async fn whoever_stops_waiting_is_passed_over() {
        let lane = Lane::of(2);
        let first = lane.place(&client("a")).await;
        let waits = tokio::spawn({
            let lane = lane.clone();
            async move { lane.place(&client("a")).await }
        });
        yield_now().await;
        waits.abort();
        assert!(waits.await.is_err());
        let other = lane.place(&client("b")).await;
        drop((first, other));
        drop(lane.place(&client("a")).await);
        let state = lane.state();
        assert_eq!((state.taken, state.clients.len(), state.waiting.len()), (0, 0, 0));
    }
}
