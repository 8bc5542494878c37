//! The interface of the store to its callers: records, errors and signals, without SQL.

pub(crate) mod announcements;
pub mod error;
pub mod interface;
pub mod location;
pub mod record;
pub mod signals;
