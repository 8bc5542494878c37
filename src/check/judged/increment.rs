//! An increment with its measure of error.

use crate::check::measure::Errors;
use crate::result::increment::Increment;
use serde::{Deserialize, Serialize};

/// An increment as it is printed, streamed and stored: one flat object, `measure` its last member.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct JudgedIncrement {
    /// The point of the path.
    #[serde(flatten)]
    pub increment: Increment,
    /// How far the point is from the equations, dimensionless.
    pub measure: Errors,
}
