//! What a scene needs and what is omitted, reported before the solve.

use serde::{Deserialize, Serialize};

/// The plan of a job.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "server", derive(utoipa::ToSchema))]
pub struct Plan {
    /// Free displacement components.
    pub unknowns: u64,
    /// Contacts of the model.
    pub contacts: u64,
    /// Stages of the model.
    pub stages: u64,
    /// Length that makes displacements dimensionless.
    pub displacement_scale: f64,
    /// Force that makes forces dimensionless.
    pub force_scale: f64,
    /// Load factor that makes the load dimensionless, one a stage.
    pub load_scales: Vec<f64>,
    /// What this scene does not need, and why.
    pub left_out: Vec<LeftOut>,
    /// What is valid and may be a mistake.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub warnings: Vec<Warning>,
}

/// Something in a request that is valid and may be a mistake.
#[derive(Debug, Clone, PartialEq, Eq, Serialize, Deserialize)]
#[cfg_attr(feature = "server", derive(utoipa::ToSchema))]
pub struct Warning {
    /// JSON pointer (RFC 6901) to the value.
    pub pointer: String,
    /// What may be wrong.
    pub detail: String,
}

/// Something that is not done, and the reason.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "server", derive(utoipa::ToSchema))]
pub struct LeftOut {
    /// What is not done.
    pub what: String,
    /// The reason.
    pub why: String,
}
