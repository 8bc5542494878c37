//! What storage says to those who use it: records, errors, signals; no SQL.

pub(crate) mod announcements;
pub mod error;
pub mod interface;
pub mod location;
pub mod record;
pub mod signals;
