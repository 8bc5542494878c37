//! The store in SQL, said once for both engines: [`dialect`] is all that a statement needs to know of the one it runs on.
//!
//! [`claims`] is the queue, [`leases`] what fences its workers, [`turns`] its order, [`increments`] what workers append, [`jobs`] what clients see, [`followers`] and [`families`] jobs
//! that go on from others, [`sweeps`] many jobs at once; [`store`] is the [`Store`](crate::service::store::contract::interface::Store) around them, [`rows`] reads what comes back. Called by the
//! engines; knows nothing of theirs but [`Dialect`](dialect::Dialect) and [`Engine`](engine::Engine).

pub(crate) mod claims;
pub(crate) mod dialect;
pub(crate) mod engine;
pub(crate) mod families;
pub(crate) mod followers;
pub(crate) mod increments;
pub(crate) mod jobs;
pub(crate) mod leases;
pub(crate) mod rows;
pub(crate) mod store;
pub(crate) mod sweeps;
pub(crate) mod turns;
