//! The store in SQL, common to both engines; [`dialect`] has the differences between their statements.
//!
//! [`claims`] is the queue, [`turns`] its order, [`leases`] the rights of its workers, [`increments`] what workers append,
//! [`jobs`] the operations of clients, [`followers`] and [`families`] jobs that continue others, [`sweeps`] groups of jobs,
//! [`changes`] the feed of what has changed,
//! [`migrations`] the schema.
//! [`store`] implements [`Store`](crate::service::store::contract::interface::Store) with them, and [`rows`] reads records.
//! Called by the engines, of which it only knows [`Dialect`](dialect::Dialect) and [`Engine`](engine::Engine).

pub(crate) mod changes;
pub(crate) mod claims;
pub(crate) mod dialect;
pub(crate) mod engine;
pub(crate) mod families;
pub(crate) mod followers;
pub(crate) mod increments;
pub(crate) mod jobs;
pub(crate) mod leases;
pub(crate) mod migrations;
pub(crate) mod rows;
pub(crate) mod store;
pub(crate) mod sweeps;
pub(crate) mod turns;
