//! JSON text to a job request.
use super::{InputError, InputErrors, JobRequest};

/// Decodes and checks nothing but form.
pub fn decode(text: &[u8]) -> Result<JobRequest, InputErrors> {
    serde_json::from_slice(text).map_err(|error| InputErrors(vec![InputError::new("", error.to_string())]))
}
