//! How a path is traced.
//!
//! Fields without a comment are described by their types: the comment of a field would take the place of the type's
//! description in the forms that the dashboard makes of `openapi.json`.

#![warn(missing_docs)]

pub use crate::branching::directions::feasible_direction::Selection;
use crate::model::request::jump::{JumpMotion, OnPathEnd};
use crate::model::request::record::Record;
use serde::{Deserialize, Serialize};

/// How the path is traced.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "server", derive(utoipa::ToSchema))]
#[serde(default, deny_unknown_fields)]
pub struct Analysis {
    #[allow(missing_docs)]
    pub method: Method,
    #[allow(missing_docs)]
    pub selection: Selection,
    #[allow(missing_docs)]
    pub events: Events,
    #[allow(missing_docs)]
    pub arc_length: ArcLength,
    /// Counted over the whole job, the rows in which later stages begin among them; 1 or more.
    #[cfg_attr(feature = "server", schema(minimum = 1, maximum = 10_000_000))]
    pub max_increments: u64,
    /// Branches and contact modes that may be examined at one point when its directions are searched; what lies past it is
    /// reported.
    #[cfg_attr(feature = "server", schema(minimum = 1, maximum = 10_000_000))]
    pub max_modes: u64,
    /// Follow the directions not taken by jobs of their own; absent: none is followed.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub explore: Option<Explore>,
    /// What is kept of the increments; absent: all of everything.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub record: Option<Record>,
    #[allow(missing_docs)]
    #[serde(skip_serializing_if = "is_stop")]
    pub on_path_end: OnPathEnd,
    /// How the structure jumps; given with `on_path_end: "jump"`, or a stage of `control: "load"`. Absent: overdamped.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub jump_motion: Option<JumpMotion>,
    /// Keep contacts that are out of reach in the equations, too. For comparison: the path is the same.
    pub keep_all: bool,
    /// Parameters of `method: "mpec"`; given with that method only.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub mpec: Option<Mpec>,
    /// Parameters of `method: "regularised"`; given with that method only.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub regularised: Option<Regularised>,
}

/// How far the directions not taken are followed: each by a job of its own, queued when this one has completed or stopped.
///
/// A direction is followed from the starts of stages, contact changes and limit points at which it is listed, and between
/// them where it first appears: on a stretch along which the same alternative exists at every increment (the same
/// statuses of the contacts, the same sign of the load rate, all of them bifurcations or none), it is followed from the
/// first. The way back and mechanisms are not followed. Jobs are queued in a fixed order, generation by generation, so
/// that the same request gives the same jobs; what `max_jobs` leaves out is counted in the jobs' `explore`. The service
/// alone does this; `arcslip solve` traces one path and says so.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize)]
#[cfg_attr(feature = "server", derive(utoipa::ToSchema))]
#[serde(deny_unknown_fields)]
pub struct Explore {
    /// Generations of jobs: 1 follows the alternatives of this job's path only. 1 or more.
    #[cfg_attr(feature = "server", schema(minimum = 1, maximum = 100))]
    pub depth: u64,
    /// Jobs queued in all, over every generation, this one not counted; 1 or more.
    #[cfg_attr(feature = "server", schema(minimum = 1, maximum = 10_000))]
    pub max_jobs: u64,
}

impl Analysis {
    /// Whether every increment is found by its program alone.
    pub fn skips_certificate(&self) -> bool {
        let asked = self.mpec.unwrap_or_default().certificate == Certificate::Skip;
        self.method == Method::Mpec && (asked || self.keep_all)
    }
}

fn is_stop(on_path_end: &OnPathEnd) -> bool {
    *on_path_end == OnPathEnd::Stop
}

impl Default for Analysis {
    fn default() -> Self {
        Self {
            method: Method::default(),
            selection: Selection::default(),
            events: Events::default(),
            arc_length: ArcLength::default(),
            max_increments: 1000,
            max_modes: 65_536,
            explore: None,
            record: None,
            on_path_end: OnPathEnd::Stop,
            jump_motion: None,
            keep_all: false,
            mpec: None,
            regularised: None,
        }
    }
}

/// Parameters of `method: "mpec"`.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default, Serialize, Deserialize)]
#[cfg_attr(feature = "server", derive(utoipa::ToSchema))]
#[serde(default, deny_unknown_fields)]
pub struct Mpec {
    #[allow(missing_docs)]
    pub certificate: Certificate,
}

/// Whether a point that Newton's method found in the mode at hand, and that is shown to solve the program of its increment,
/// spares solving that program. Either way the path is the same.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default, Serialize, Deserialize)]
#[cfg_attr(feature = "server", derive(utoipa::ToSchema))]
#[serde(rename_all = "snake_case")]
pub enum Certificate {
    /// The program is not solved where the point is shown to solve it.
    #[default]
    Use,
    /// Every increment's end is found by its program alone, from the point before and the direction there. `keep_all`
    /// skips, too.
    Skip,
}

/// How increments are found. `auto`: arc-length steps in the current contact mode, which is decided where it can change;
/// `mpec`: every increment by the MPEC of Kanno and Martins; `regularised`: the rival, for comparison: penalty contact and
/// regularised friction under a conventional arc-length method.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default, Serialize, Deserialize)]
#[cfg_attr(feature = "server", derive(utoipa::ToSchema))]
#[serde(rename_all = "snake_case")]
pub enum Method {
    /// Arc-length steps in the current contact mode, which is decided where it can change.
    #[default]
    Auto,
    /// Every increment by the MPEC of Kanno and Martins.
    Mpec,
    /// Penalty contact and regularised friction under a conventional arc-length method.
    Regularised,
}

impl Method {
    /// As the contract spells it.
    pub fn name(self) -> &'static str {
        match self {
            Self::Auto => "auto",
            Self::Mpec => "mpec",
            Self::Regularised => "regularised",
        }
    }
}

/// Parameters of the rival method: penalties of contact and friction, and Crisfield's arc-length control.
///
/// Penalties are multiples of the plan's `force_scale / displacement_scale`, the stiffness of the softest bar that resists the load.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "server", derive(utoipa::ToSchema))]
#[serde(default, deny_unknown_fields)]
pub struct Regularised {
    /// Normal reaction per penetration; above 0.
    #[cfg_attr(feature = "server", schema(exclusive_minimum = 0.0))]
    pub normal_penalty: f64,
    /// Tangential reaction per elastic slip while the contact sticks; above 0.
    #[cfg_attr(feature = "server", schema(exclusive_minimum = 0.0))]
    pub tangential_penalty: f64,
    /// Newton iterations that the step length aims at; four times as many are tried. 1 or more.
    #[cfg_attr(feature = "server", schema(minimum = 1, maximum = 1000))]
    pub desired_iterations: u64,
    /// Equilibrium residual over the largest force at which an increment has converged; between 0 and 1. Round-off in
    /// gaps is multiplied by the penalty: stiff penalties ask for a looser tolerance.
    #[cfg_attr(feature = "server", schema(exclusive_minimum = 0.0, exclusive_maximum = 1.0))]
    pub tolerance: f64,
    /// Crisfield's ψ: the weight of the load in the arc length that `arc_length` bounds, 0 (cylindrical) or more. With 1
    /// (spherical) that is the arc length of the other methods, which increments report in any case. Where the load
    /// changes and no displacement does, as under an obstacle that slides along, it has to be above 0.
    #[cfg_attr(feature = "server", schema(minimum = 0.0))]
    pub load_weight: f64,
    #[allow(missing_docs)]
    pub load_sign: LoadSign,
}

impl Default for Regularised {
    fn default() -> Self {
        Self {
            normal_penalty: 1e4,
            tangential_penalty: 1e4,
            desired_iterations: 5,
            tolerance: 1e-8,
            load_weight: 0.0,
            load_sign: LoadSign::default(),
        }
    }
}

/// How the sign of the load in the predictor is chosen.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default, Serialize, Deserialize)]
#[cfg_attr(feature = "server", derive(utoipa::ToSchema))]
#[serde(rename_all = "snake_case")]
pub enum LoadSign {
    /// The sign of the tangent's determinant (Crisfield 1981).
    Determinant,
    /// The side to which the previous increment's displacements went (Feng, Perić and Owen 1996).
    #[default]
    PreviousIncrement,
}

/// Which contact changes become points of the path. Contacts without friction that touch or lift off within one step are
/// taken together by `auto` where that leads to the same state, as far as counts of eigenvalues at both ends of the step
/// tell: the increment's event names each of them.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default, Serialize, Deserialize)]
#[cfg_attr(feature = "server", derive(utoipa::ToSchema))]
#[serde(rename_all = "snake_case")]
pub enum Events {
    /// Each that leaves a choice, is counted by a stage, or has friction; others may be taken together.
    #[default]
    Auto,
    /// Every contact change.
    All,
}

/// Arc lengths are dimensionless: `‖(Δu/displacement_scale, Δs/load_scale)‖`.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "server", derive(utoipa::ToSchema))]
#[serde(default, deny_unknown_fields)]
pub struct ArcLength {
    /// The first step. Absent: 0.02, or the nearest value between `min` and `max`.
    #[cfg_attr(feature = "server", schema(nullable, exclusive_minimum = 0.0))]
    pub initial: f64,
    /// Absent: 1e-9, or the smallest of the other two if that is less.
    #[cfg_attr(feature = "server", schema(nullable, exclusive_minimum = 0.0))]
    pub min: f64,
    /// Absent: 0.5, or the largest of the other two if that is more.
    #[cfg_attr(feature = "server", schema(nullable, exclusive_minimum = 0.0))]
    pub max: f64,
    /// Length; computed from the scene when absent.
    #[serde(skip_serializing_if = "Option::is_none")]
    #[cfg_attr(feature = "server", schema(exclusive_minimum = 0.0))]
    pub displacement_scale: Option<f64>,
    /// Load factor (dimensionless, or as the pattern has it); computed from the scene when absent.
    #[serde(skip_serializing_if = "Option::is_none")]
    #[cfg_attr(feature = "server", schema(exclusive_minimum = 0.0))]
    pub load_scale: Option<f64>,
    /// Whether straight stretches are one increment, however long: where every element is linear, every contact in reach a
    /// plane's and no slip turns, up to the next event, but not along stretches of bifurcations. Absent: true if `max` is
    /// absent.
    #[cfg_attr(feature = "server", schema(nullable))]
    pub jump: bool,
}

impl Default for ArcLength {
    fn default() -> Self {
        Self { initial: 0.02, min: 1e-9, max: 0.5, displacement_scale: None, load_scale: None, jump: true }
    }
}

impl ArcLength {
    /// Bounds from those that are given; an absent one takes its default or follows the given ones, so that
    /// `"max": 0.01` alone is not a contradiction. Given bounds are kept, contradictory or not.
    pub fn with_defaults(initial: Option<f64>, min: Option<f64>, max: Option<f64>) -> Self {
        let default = Self::default();
        let given = [initial, min, max].into_iter().flatten();
        let lower = min.unwrap_or_else(|| given.clone().fold(default.min, f64::min));
        let upper = max.unwrap_or_else(|| given.fold(default.max, f64::max));
        let initial = initial.unwrap_or_else(|| default.initial.min(upper).max(lower));
        Self { initial, min: lower, max: upper, jump: max.is_none(), ..default }
    }
}
