//! Access control: who may call, and how often.
//!
//! [`tokens`] reads the bearer tokens, [`admission`] checks every request before any call is reached, [`rates`] limits the
//! rate of requests, [`origins`] lists the pages of browsers that may call, [`headers`] sets the security headers of
//! answers. Calls only receive the [`Caller`](crate::service::jobs::Caller), whose jobs they show and change.

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
pub enum AccessPolicy {
    /// Everyone on this machine: the service listens on a loopback address.
    Loopback,
    /// Everyone, as the operator has chosen.
    Open,
    /// Everyone with a valid token; the list of tokens can be replaced while the service runs.
    Tokens(RwLock<Arc<Tokens>>),
}

impl AccessPolicy {
    pub fn with(tokens: Tokens) -> Self {
        Self::Tokens(RwLock::new(Arc::new(tokens)))
    }
}

#[derive(Debug)]
struct Rules {
    policy: AccessPolicy,
    rates: Rates,
    origins: Origins,
    /// Cancelled, and replaced by a new one, when the list of tokens is replaced.
    exchange: RwLock<CancellationToken>,
}

/// The rules of one service; cheap to clone.
#[derive(Debug, Clone)]
pub struct Access(Arc<Rules>);

impl Access {
    pub fn new(policy: AccessPolicy, rates: Rates, origins: Origins) -> Self {
        Self(Arc::new(Rules { policy, rates, origins, exchange: RwLock::default() }))
    }

    /// The rules of a service that only its own machine reaches.
    pub fn loopback() -> Self {
        Self::new(AccessPolicy::Loopback, Rates::default(), Origins::default())
    }

    /// Replaces the list of tokens; without effect on a service that asks for no tokens.
    pub fn exchange(&self, tokens: Tokens) {
        if let AccessPolicy::Tokens(current) = &self.0.policy {
            // The value behind the lock is replaced as a whole, so that a poisoned lock holds a valid one.
            *current.write().unwrap_or_else(PoisonError::into_inner) = Arc::new(tokens);
            // After the tokens: a client whose stream ends now authenticates against the new tokens.
            std::mem::take(&mut *self.0.exchange.write().unwrap_or_else(PoisonError::into_inner)).cancel();
        }
    }

    pub(super) fn origins(&self) -> &Origins {
        &self.0.origins
    }

    /// A signal that is cancelled when the tokens are replaced next.
    pub(super) fn next_exchange(&self) -> CancellationToken {
        self.0.exchange.read().unwrap_or_else(PoisonError::into_inner).clone()
    }

    pub(super) fn asks_tokens(&self) -> bool {
        matches!(self.0.policy, AccessPolicy::Tokens(_))
    }

    /// The valid tokens; `None` where the service asks for no tokens.
    fn tokens(&self) -> Option<Arc<Tokens>> {
        match &self.0.policy {
            AccessPolicy::Tokens(current) => Some(Arc::clone(&current.read().unwrap_or_else(PoisonError::into_inner))),
            AccessPolicy::Loopback | AccessPolicy::Open => None,
        }
    }
}
