//! Answers that every call may give: problems (RFC 9457), entity tags, compression, embedded files.

pub mod embedded;
pub mod gzip;
pub mod problem;
pub mod tag;
