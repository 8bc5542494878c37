//! The findings of a curve of limit points, bifurcation points or contact changes.

use crate::check::measure::Errors;
use crate::model::request::curve::CurveSettings;
use crate::result::increment::{ContactState, PointKind};
use crate::result::nodal_values::NodalValues;
use serde::{Deserialize, Serialize};
use std::sync::Arc;

/// A point of a curve.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "server", derive(utoipa::ToSchema))]
pub struct CurveRow {
    /// In the order of finding, from 0 at the model's own value; then towards larger, then towards smaller values.
    pub index: u64,
    /// Place along the curve: 0 at the model's own value, 1, 2 and so on from there towards larger values, -1, -2 and so on
    /// towards smaller ones. Where the curve turns back the values do, too.
    pub place: i64,
    /// The value of the parameter.
    pub value: f64,
    /// Its kind.
    pub kind: PointKind,
    /// Name of the stage that it belongs to.
    pub stage: Arc<str>,
    /// Multiplier of the stage's pattern.
    pub load_factor: f64,
    /// Of all nodes, as in an increment.
    #[cfg_attr(feature = "server", schema(value_type = indexmap::IndexMap<String, Vec<f64>>))]
    pub displacements: NodalValues,
    /// Of all contacts, as in an increment; `slip` is 0.
    pub contacts: Vec<ContactState>,
    /// What happens here, in words; null at ordinary points.
    pub event: Option<String>,
    /// The points change their kind here, or the path to them its changes of contact.
    #[serde(default, skip_serializing_if = "std::ops::Not::not")]
    pub codimension_two: bool,
    /// Found on a path that was traced for it; the other points are found from their neighbours on the curve.
    #[serde(default, skip_serializing_if = "std::ops::Not::not")]
    pub from_path: bool,
    /// How far the state is from the equations.
    pub measure: Errors,
}

/// A curve of limit points, bifurcation points or contact changes.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct CurveFound {
    /// The model's own name.
    pub name: Option<String>,
    pub curve: CurveSettings,
    /// Dimensions of the space: so many of a node's displacements are translations, the others rotations.
    pub dimension: usize,
    /// In order along the curve, which turns back in the parameter where two limit points meet.
    pub rows: Vec<CurveRow>,
    /// Null where the curve has not ended yet.
    pub summary: Option<CurveSummary>,
}

impl CurveFound {
    /// Without points so far.
    pub fn begun(name: Option<String>, curve: CurveSettings, dimension: usize) -> Self {
        Self { name, curve, dimension, rows: Vec::new(), summary: None }
    }

    /// With these points, in any order, and how it ended.
    pub fn with(self, mut rows: Vec<CurveRow>, summary: Option<CurveSummary>) -> Self {
        rows.sort_by_key(|row| row.place);
        Self { rows, summary, ..self }
    }
}

impl CurveFound {
    /// The same without the points that are not known to be on a path.
    pub fn known_on_path(&self) -> Self {
        let is_known = |row: &&CurveRow| self.summary.as_ref().is_none_or(|summary| !summary.is_off_path(row));
        Self { rows: self.rows.iter().filter(is_known).cloned().collect(), ..self.clone() }
    }
}

impl CurveSummary {
    /// Whether a point of the curve is not known to be on a path.
    pub fn is_off_path(&self, row: &CurveRow) -> bool {
        self.off_path_from.is_some_and(|from| row.place >= from) || self.off_path_to.is_some_and(|to| row.place <= to)
    }
}

/// How a curve ended.
#[derive(Debug, Clone, Default, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "server", derive(utoipa::ToSchema))]
pub struct CurveSummary {
    /// Why it ends towards smaller values, in words; null where it was cancelled before.
    pub ends_below: Option<String>,
    /// Why it ends towards larger values.
    pub ends_above: Option<String>,
    /// The place from which on, towards larger values, points are not known to be on a path: one traced at the end of the
    /// curve was another. Null where it was the same.
    #[serde(default)]
    pub off_path_from: Option<i64>,
    /// The same towards smaller values: points at this place and before.
    #[serde(default)]
    pub off_path_to: Option<i64>,
    /// Paths that were traced for it.
    pub paths: u64,
    /// Newton iterations, without those of the paths.
    pub newton_iterations: u64,
    /// It was followed to both ends; not where it was cancelled.
    pub complete: bool,
}
