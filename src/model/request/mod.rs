//! The types of a job request, as `POST /v1/jobs` and `arcslip solve` take them.
//!
//! Quantities are in any consistent set of units; the solver makes them dimensionless. Names are the user's, order is
//! kept as written: it fixes the numbering of unknowns and with it every bit of the result.
//!
//! `structure` is what is modelled, `analysis` how it is traced, `record` what is kept of it. Bounds that a schema can
//! express stand with the fields, for the interface's description; [`check`](crate::model::check) holds to them and to the others.

mod analysis;
pub(crate) mod column_units;
pub mod curve;
mod jump;
mod record;
pub mod recorded_forces;
pub mod response;
mod structure;
pub mod study;
pub mod sweep;
pub mod variation_summary;

use serde::{Deserialize, Serialize};

pub use crate::branching::directions::feasible_direction::Selection;
pub use crate::mechanics::structure::elements::bar::Strain;
pub use crate::mechanics::structure::elements::solid::shapes::kind::{LockingMend, SolidKind};
pub use crate::result::increment::JumpMotionKind;
pub use analysis::{Analysis, ArcLength, Certificate, Events, Explore, LoadSign, Method, Mpec, Regularised};
pub use jump::{JumpMotion, OnPathEnd};
pub use record::{
    ContactRange, ElementReference, ForceRange, Record, RecordedContact, RecordedContacts, RecordedElements,
    RecordedSupports,
};
pub use structure::{
    BendingStiffness, Component, Contact, ContactDiscretisation, ContentEncoding, DisplacementBound, ElasticConstants,
    Element, Material, MeshFile, MeshFormat, MeshGroup, Model, NamedSet, Obstacle, ObstacleRotation, PlaneCondition,
    Polyline, RoundedBox, Section, Side, Solid, Stage, StageControl, Surface, TriangleMesh, Units, Until,
};
pub(crate) use structure::{ObstaclePivot, PostedShape};

/// A model and how to trace it.
#[warn(missing_docs)]
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "server", derive(utoipa::ToSchema))]
#[serde(deny_unknown_fields)]
pub struct JobRequest {
    /// Structure, obstacles and loads.
    pub model: Model,
    /// How the path is traced.
    #[serde(default)]
    pub analysis: Analysis,
}

impl From<Model> for JobRequest {
    /// The model with the default analysis.
    fn from(model: Model) -> Self {
        Self { model, analysis: Analysis::default() }
    }
}

/// A direction of another job, to be followed by a new one with the same model and analysis; it explores nothing.
#[derive(Debug, Clone, PartialEq, Eq, Serialize, Deserialize)]
#[cfg_attr(feature = "server", derive(utoipa::ToSchema))]
#[serde(deny_unknown_fields)]
pub struct FollowRequest {
    /// Index of a stored increment that has `directions`.
    pub increment: u64,
    /// Place in its `directions`, from 0.
    pub direction: u64,
    /// Counted over the new job; absent: the other job's.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    #[cfg_attr(feature = "server", schema(minimum = 1, maximum = 10_000_000))]
    pub max_increments: Option<u64>,
}
