//! A curve of limit points or others: one model, a place in it, and the range of the number there, as `arcslip continue` and
//! `POST /v1/jobs/{id}/continue` take it.

use crate::model::request::{Analysis, Model};
use serde::{Deserialize, Serialize};

/// A model, how to trace its path, and what of it varies.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "server", derive(utoipa::ToSchema))]
#[serde(deny_unknown_fields)]
pub struct CurveRequest {
    pub model: Model,
    #[serde(default)]
    pub analysis: Analysis,
    pub curve: CurveSettings,
}

/// Which point is followed, and in what.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "server", derive(utoipa::ToSchema))]
#[serde(deny_unknown_fields)]
pub struct CurveSettings {
    /// JSON pointer (RFC 6901) to a number of the model, such as `/model/contacts/0/friction`, an element's stiffness or a
    /// coordinate. A step `*` stands for every item of a list or member of an object; the numbers there are equal.
    pub parameter: String,
    /// Least and largest value; the model's own lies between them.
    pub range: [f64; 2],
    /// Longest step between two values. Default: the range over 40.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub step: Option<f64>,
    /// The limit point of this number on the model's path, from 1. The default is 1, unless `increment` is given.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub limit_point: Option<u64>,
    /// The limit point, smooth bifurcation point or contact change at the increment of this index.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub increment: Option<u64>,
}
