//! The store in SQL, said once for both engines: [`dialect`] is all that a statement needs to know of the one it runs on.
//!
//! [`claims`] is the queue, [`turns`] its order, [`increments`] what workers append, [`jobs`] what clients see, [`followers`] and [`families`] jobs
//! that go on from others, [`sweeps`] many jobs at once; [`store`] is the [`Store`](super::Store) around them, [`rows`] reads what comes back. Called by the
//! engines; knows nothing of theirs but [`Dialect`](dialect::Dialect) and [`Engine`](store::Engine).

pub(super) mod claims;
pub(super) mod dialect;
mod families;
mod followers;
mod increments;
pub(super) mod jobs;
mod rows;
pub(super) mod store;
pub(super) mod sweeps;
pub(super) mod turns;
