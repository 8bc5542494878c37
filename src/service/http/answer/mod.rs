//! Answers that every call may give: problems (RFC 9457), entity tags, compression.

pub mod gzip;
pub mod problem;
pub mod tag;
