//! Calls that read the increments of a job: page by page, by column, as a stream, as a table, as a picture and in the formats
//! of other programs, and the path in closed form.

mod archive;
pub mod columns;
pub mod csv;
pub mod exact;
pub mod page;
pub mod picture;
pub mod results;
mod stored;
pub mod stream;
