//! Who may ask for what, and how often.
//!
//! [`tokens`] are what callers show, [`admission`] asks for them before any call is reached, [`rates`] says how often,
//! [`origins`] which pages of browsers may call, [`headers`] what browsers are told about answers. Calls learn of all this
//! only the [`Caller`](crate::service::jobs::Caller), whose jobs they show and change.

pub mod admission;
pub mod headers;
pub mod origins;
pub mod rates;
pub mod tokens;

use origins::Origins;
use rates::Rates;
use std::sync::{Arc, PoisonError, RwLock};
use tokens::Tokens;
use tokio_util::sync::CancellationToken;

/// Who may call.
#[derive(Debug)]
pub enum Door {
    /// Whoever is on this machine: nobody else reaches the address that is listened on.
    Loopback,
    /// Everyone; whoever started the service has said so.
    Open,
    /// Whoever shows a token; they can be exchanged while the service runs.
    Tokens(RwLock<Arc<Tokens>>),
}

impl Door {
    pub fn with(tokens: Tokens) -> Self {
        Self::Tokens(RwLock::new(Arc::new(tokens)))
    }
}

#[derive(Debug)]
struct Rules {
    door: Door,
    rates: Rates,
    origins: Origins,
    /// Cancelled, and replaced, when the tokens are exchanged.
    exchange: RwLock<CancellationToken>,
}

/// The rules of one service; cheap to clone.
#[derive(Debug, Clone)]
pub struct Access(Arc<Rules>);

impl Access {
    pub fn new(door: Door, rates: Rates, origins: Origins) -> Self {
        Self(Arc::new(Rules { door, rates, origins, exchange: RwLock::default() }))
    }

    /// For a service that only its own machine reaches.
    pub fn loopback() -> Self {
        Self::new(Door::Loopback, Rates::default(), Origins::default())
    }

    /// The tokens that hold from now on; without effect where none are asked for.
    pub fn exchange(&self, tokens: Tokens) {
        if let Door::Tokens(current) = &self.0.door {
            // What is behind the lock is replaced whole.
            *current.write().unwrap_or_else(PoisonError::into_inner) = Arc::new(tokens);
            // After the tokens: who is sent away because of them finds the new ones.
            std::mem::take(&mut *self.0.exchange.write().unwrap_or_else(PoisonError::into_inner)).cancel();
        }
    }

    pub(super) fn origins(&self) -> &Origins {
        &self.0.origins
    }

    /// Cancelled when the tokens are exchanged the next time.
    pub(super) fn next_exchange(&self) -> CancellationToken {
        self.0.exchange.read().unwrap_or_else(PoisonError::into_inner).clone()
    }

    pub(super) fn asks_tokens(&self) -> bool {
        matches!(self.0.door, Door::Tokens(_))
    }

    /// `None`: no tokens are asked for.
    fn tokens(&self) -> Option<Arc<Tokens>> {
        match &self.0.door {
            Door::Tokens(current) => Some(Arc::clone(&current.read().unwrap_or_else(PoisonError::into_inner))),
            Door::Loopback | Door::Open => None,
        }
    }
}
