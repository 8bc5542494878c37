//! What a sweep tells of each of its paths.

use serde::{Deserialize, Serialize};

/// A value of a path at a place of it.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "server", derive(utoipa::ToSchema))]
#[serde(deny_unknown_fields)]
pub struct Response {
    /// A column of `path.csv`, such as `load_factor`, `tip.x`, `tip/floor.gap` or `elements/3.axial_force`.
    #[serde(default = "load_factor")]
    pub value: String,
    /// The place, the first of its kind.
    pub at: ResponsePlace,
    /// The stage in which the place is looked for; absent: any.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub stage: Option<String>,
}

/// A place of a path.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "server", derive(utoipa::ToSchema))]
#[serde(untagged)]
pub enum ResponsePlace {
    /// By its name.
    Named(NamedPlace),
    /// Where a value reaches a number.
    Reached(ReachedValue),
}

/// Places that have a name.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize)]
#[cfg_attr(feature = "server", derive(utoipa::ToSchema))]
#[serde(rename_all = "snake_case")]
pub enum NamedPlace {
    /// The first limit point.
    FirstLimit,
    /// The increment of largest load factor.
    LargestLoad,
    /// The last increment before a recorded contact slips.
    FirstSlip,
    /// The first increment at which the status of a contact changes.
    FirstContactChange,
    /// The last increment.
    End,
}

/// Where a value reaches a number for the first time; other values are interpolated linearly between the increments before
/// and after, unless one of them has this very number, as the end of a stage has.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "server", derive(utoipa::ToSchema))]
#[serde(deny_unknown_fields)]
pub struct ReachedValue {
    /// A column of `path.csv`.
    pub value: String,
    /// The number.
    pub reaches: f64,
}

/// The value of a response that names none.
pub(crate) fn load_factor() -> String {
    "load_factor".to_owned()
}
