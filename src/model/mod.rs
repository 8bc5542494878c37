//! What a user posts, decoded from JSON and checked.
//!
//! [`request`] holds the types of the contract, [`decode`] reads them from JSON text and says where each mistake is,
//! [`check`] looks at what can only be judged on the whole (unknown names, zero lengths, penetration). Nothing here
//! knows how a path is traced.

pub mod check;
pub mod decode;
pub mod error;
pub mod json;
pub mod request;

pub use error::{InputError, InputErrors};
pub use request::{Analysis, JobRequest, Model};
