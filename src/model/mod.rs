//! What a user posts, decoded from JSON and checked.
//!
//! [`request`], [`study`](request::study) and [`sweep`](request::sweep) hold the types of the contract, [`mod@decode`] reads them from JSON text and says where each mistake is,
//! [`runs`] makes the runs of a sweep, [`mod@check`] looks at what can only be judged on the whole (unknown names, zero lengths, penetration). Nothing here
//! knows how a path is traced. [`read`] does both.

pub mod check;
pub mod decode;
pub mod input;
pub mod request;
pub mod run_mistakes;
pub mod runs;
mod template;

pub use input::error::{InputError, InputErrors};
pub use request::study::StudyRequest;
pub use request::sweep::SweepRequest;
pub use request::variation_summary::VariationSummary;
pub use request::{Analysis, FollowRequest, JobRequest, Model};
pub use run_mistakes::RunMistakes;
pub use runs::Sweep;

/// Reads a job request from JSON text and checks it: what every edge (HTTP, command line) does with what comes in.
///
/// # Errors
/// Everything that is wrong with the text, see [`decode::decode`], or else with what it says, see [`check::check`].
pub fn read(text: &[u8]) -> Result<JobRequest, InputErrors> {
    let request = decode::decode(text)?;
    check::check(&request)?;
    Ok(request)
}
