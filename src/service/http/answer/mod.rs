//! Answers that every call may give: problems (RFC 9457) and entity tags.

pub mod problem;
pub mod tag;
