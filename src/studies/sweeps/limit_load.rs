//! The limit load of a structure: the load at a limit point.

use crate::result::increment::{Increment, PointKind};
use serde::{Deserialize, Serialize};
use std::sync::Arc;

/// A limit point of a path.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "server", derive(utoipa::ToSchema))]
pub struct LimitLoad {
    pub increment: u64,
    pub kind: PointKind,
    pub stage: Arc<str>,
    /// Multiplier of the stage's pattern.
    pub load_factor: f64,
    /// Dimensionless, from the start of the path.
    pub arc_length: f64,
}

impl LimitLoad {
    /// The limit load of an increment that is a limit point.
    pub fn at(increment: &Increment) -> Option<Self> {
        let kind = increment.point.kind;
        match kind {
            PointKind::SmoothLimit | PointKind::NonsmoothLimit => Some(Self {
                increment: increment.index,
                kind,
                stage: Arc::clone(&increment.stage),
                load_factor: increment.load_factor,
                arc_length: increment.arc_length,
            }),
            PointKind::Start
            | PointKind::Regular
            | PointKind::SmoothBifurcation
            | PointKind::ContactChange
            | PointKind::End
            | PointKind::Jump
            | PointKind::Motion => None,
        }
    }
}
