//! The HTTP interface of the service, version 1.
//!
//! [`server`] starts and stops the service, [`listen`] accepts connections, [`router`] assigns a call to each address and
//! [`request_id`] names each request. [`access`] decides who may call and how often. [`calls`] has one function for each
//! operation: they read requests with [`input`], share [`tasks`] and [`state`], and answer with the types in [`view`] and
//! [`answer`]. [`document`] completes the OpenAPI description of the calls, [`docs`] serves the page that shows it,
//! [`dashboard`] the pages of jobs, [`manual`] the manual.
//! Called by `command`; uses `jobs` and, for reading, `store`.

pub mod access;
pub mod answer;
pub mod calls;
pub mod dashboard;
pub mod docs;
pub mod document;
pub mod input;
pub mod listen;
pub mod manual;
pub mod request_id;
pub mod router;
pub mod server;
pub mod state;
pub mod tasks;
pub mod view;
