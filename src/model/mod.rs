//! Requests of users, decoded from JSON and checked.
//!
//! [`request`], [`study`](request::study) and [`sweep`](request::sweep) have the types of the contract, [`mod@decode`] reads
//! them from JSON text and reports the place of each mistake, [`runs`] makes the runs of a sweep and [`curves`] the models of a curve, [`mod@check`] checks decoded
//! requests (unknown names, zero lengths, penetration). [`mesh`] reads mesh files and makes models of them. Nothing here
//! knows how a path is traced. [`read`] decodes and checks.

pub mod check;
pub mod curves;
pub mod decode;
pub mod input;
pub mod mesh;
pub mod request;
pub mod run_mistakes;
pub mod runs;
pub(crate) mod solids;
mod template;

pub use curves::ParameterCurve;
pub use input::error::{InputError, InputErrors};
pub use request::study::StudyRequest;
pub use request::sweep::SweepRequest;
pub use request::variation_summary::VariationSummary;
pub use request::{Analysis, FollowRequest, JobRequest, Model};
pub use run_mistakes::RunMistakes;
pub use runs::Sweep;

/// Reads a job request from JSON text and checks it, as HTTP and command line do with every request.
///
/// # Errors
/// All mistakes of form, see [`decode::decode`], or else of content, see [`check::check`].
pub fn read(text: &[u8]) -> Result<JobRequest, InputErrors> {
    let request = decode::decode(text)?;
    check::check(&request)?;
    Ok(request)
}
