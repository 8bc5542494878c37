//! The service: a queue of jobs, their storage, and HTTP.
//!
//! | room | what it holds |
//! |---|---|
//! | [`store`] | jobs, increments and checkpoints in SQLite or PostgreSQL; nothing else knows SQL |
//! | [`metrics`] | counts and times of what `jobs` and `http` do |
//! | [`jobs`] | the queue and its workers |
//! | [`http`] | the interface over HTTP, and the dashboard |

pub mod http;
pub mod jobs;
pub mod metrics;
pub mod store;
