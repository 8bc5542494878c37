//! What jobs, studies and sweeps have in common: how they are submitted, listed, read, followed, cancelled and deleted.
//!
//! A call takes a [`Submission`](submission::Submission), a [`Requester`](requester::Requester) or a
//! [`Target`](target::Target) of the [`Resource`](resource::Resource) that it is about, and passes it on. Each call only has
//! its own OpenAPI description: the document has one for each address.

pub mod feed;
pub mod findings;
pub mod requester;
pub mod resource;
pub mod stream;
pub mod submission;
pub mod target;
