//! Calls that read the increments of a job: page by page, by column, as a stream and as a table, and the path in closed form.

pub mod columns;
pub mod csv;
pub mod exact;
pub mod page;
pub mod stream;
