//! The types of a job request, as `POST /v1/jobs` and `arcslip solve` take them.
//!
//! Quantities are in any consistent set of units; the solver makes them dimensionless. Names are the user's, order is
//! kept as written: it fixes the numbering of unknowns and with it every bit of the result.

use indexmap::IndexMap;
use serde::{Deserialize, Serialize};

/// A model and how to trace it.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "server", derive(utoipa::ToSchema))]
#[serde(deny_unknown_fields)]
pub struct JobRequest {
    pub model: Model,
    #[serde(default)]
    pub analysis: Analysis,
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
    pub max_increments: Option<u64>,
}

/// A structure, its obstacles and its load history.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "server", derive(utoipa::ToSchema))]
#[serde(deny_unknown_fields)]
pub struct Model {
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub name: Option<String>,
    /// 2 or 3.
    #[cfg_attr(feature = "server", schema(minimum = 2, maximum = 3))]
    pub dimension: usize,
    /// Node name to coordinates (length, `dimension` of them).
    pub nodes: IndexMap<String, Vec<f64>>,
    /// Node name to the components held.
    #[serde(default, skip_serializing_if = "IndexMap::is_empty")]
    pub supports: IndexMap<String, Vec<Component>>,
    pub elements: Vec<Element>,
    #[serde(default, skip_serializing_if = "IndexMap::is_empty")]
    pub obstacles: IndexMap<String, Obstacle>,
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub contacts: Vec<Contact>,
    /// Run in order; each starts at load factor 0 and holds what earlier ones reached.
    pub stages: Vec<Stage>,
}

/// A coordinate direction.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash, Serialize, Deserialize)]
#[cfg_attr(feature = "server", derive(utoipa::ToSchema))]
#[serde(rename_all = "snake_case")]
pub enum Component {
    X,
    Y,
    Z,
}

impl Component {
    pub fn index(self) -> usize {
        match self {
            Self::X => 0,
            Self::Y => 1,
            Self::Z => 2,
        }
    }
}

#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "server", derive(utoipa::ToSchema))]
#[serde(tag = "kind", rename_all = "snake_case", deny_unknown_fields)]
pub enum Element {
    /// A pin-jointed bar, geometrically exact.
    Bar {
        /// Two different node names.
        nodes: Vec<String>,
        /// EA (force), positive.
        axial_stiffness: f64,
        /// Unstressed length; the distance of the nodes when absent.
        #[serde(default, skip_serializing_if = "Option::is_none")]
        rest_length: Option<f64>,
        /// Axial force (tension positive) added to the elastic one.
        #[serde(default)]
        prestress: f64,
        #[serde(default)]
        strain: Strain,
    },
    /// A constant stiffness between one node and the ground, or between two nodes; it does not follow rotation.
    Spring {
        /// One or two node names.
        nodes: Vec<String>,
        /// Symmetric, `dimension` rows of `dimension` numbers (force per length).
        stiffness: Vec<Vec<f64>>,
    },
}

/// How a bar's strain is measured; `λ = L/L0`.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default, Serialize, Deserialize)]
#[cfg_attr(feature = "server", derive(utoipa::ToSchema))]
#[serde(rename_all = "snake_case")]
pub enum Strain {
    /// `λ - 1`
    #[default]
    Engineering,
    /// `(λ² - 1)/2`
    Green,
    /// `ln λ`
    Log,
}

#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "server", derive(utoipa::ToSchema))]
#[serde(tag = "kind", rename_all = "snake_case", deny_unknown_fields)]
pub enum Obstacle {
    /// A half-space; `normal` points into the free side and need not have unit length.
    Plane { point: Vec<f64>, normal: Vec<f64> },
    /// A circle in 2D, a sphere in 3D.
    Ball {
        center: Vec<f64>,
        /// Length, positive.
        radius: f64,
        #[serde(default)]
        side: Side,
    },
}

/// On which side of a ball the nodes are free.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default, Serialize, Deserialize)]
#[cfg_attr(feature = "server", derive(utoipa::ToSchema))]
#[serde(rename_all = "snake_case")]
pub enum Side {
    /// Nodes stay out of the ball.
    #[default]
    Outside,
    /// Nodes stay in the ball.
    Inside,
}

/// One node against one obstacle.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "server", derive(utoipa::ToSchema))]
#[serde(deny_unknown_fields)]
pub struct Contact {
    pub node: String,
    pub obstacle: String,
    /// Coulomb's coefficient, 0 or more; 0 is frictionless.
    #[serde(default)]
    pub friction: f64,
}

#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "server", derive(utoipa::ToSchema))]
#[serde(deny_unknown_fields)]
pub struct Stage {
    pub name: String,
    /// Node name to force; multiplied by the load factor.
    #[serde(default, skip_serializing_if = "IndexMap::is_empty")]
    pub forces: IndexMap<String, Vec<f64>>,
    /// Node name to prescribed displacement of its supported components (length; zero on free ones); multiplied by the
    /// load factor.
    #[serde(default, skip_serializing_if = "IndexMap::is_empty")]
    pub displacements: IndexMap<String, Vec<f64>>,
    /// Obstacle name to translation (length); multiplied by the load factor.
    #[serde(default, skip_serializing_if = "IndexMap::is_empty")]
    pub obstacle_motion: IndexMap<String, Vec<f64>>,
    /// Where the stage ends; absent: it goes on to `max_increments`.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub until: Option<Until>,
}

/// Ends of a stage; the first that is met ends it, and it ends exactly there.
#[derive(Debug, Clone, PartialEq, Default, Serialize, Deserialize)]
#[cfg_attr(feature = "server", derive(utoipa::ToSchema))]
#[serde(deny_unknown_fields)]
pub struct Until {
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub load_above: Option<f64>,
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub load_below: Option<f64>,
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub displacement: Option<DisplacementBound>,
    /// This many limit points of the stage, smooth and nonsmooth.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub limit_points: Option<u64>,
    /// This many contact changes of the stage.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub contact_change: Option<u64>,
    /// This many increments of the stage.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub increments: Option<u64>,
}

/// A displacement reaches a value from below (`above`) or from above (`below`); exactly one of the two is given.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "server", derive(utoipa::ToSchema))]
#[serde(deny_unknown_fields)]
pub struct DisplacementBound {
    pub node: String,
    pub component: Component,
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub above: Option<f64>,
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub below: Option<f64>,
}

/// How the path is traced.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "server", derive(utoipa::ToSchema))]
#[serde(default, deny_unknown_fields)]
pub struct Analysis {
    pub method: Method,
    pub selection: Selection,
    pub events: Events,
    pub arc_length: ArcLength,
    /// Counted over the whole job, the rows in which later stages begin among them; 1 or more.
    pub max_increments: u64,
    /// Branches and contact modes that may be examined at one point when its directions are searched; what lies past it is
    /// reported.
    pub max_modes: u64,
    /// Follow the directions not taken by jobs of their own; absent: none is followed.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub explore: Option<Explore>,
    /// What is kept of the increments; absent: all of everything.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub record: Option<Record>,
    /// Keep contacts that are out of reach in the equations, too. For comparison: the path is the same.
    pub keep_all: bool,
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
    pub depth: u64,
    /// Jobs queued in all, over every generation, this one not counted; 1 or more.
    pub max_jobs: u64,
}

/// What is kept of the increments: printed, streamed and stored. Every increment is traced and judged in full before
/// anything of it is left out, and the report is that of all of them.
#[derive(Debug, Clone, PartialEq, Eq, Serialize, Deserialize)]
#[cfg_attr(feature = "server", derive(utoipa::ToSchema))]
#[serde(default, deny_unknown_fields)]
pub struct Record {
    /// Nodes whose displacements are kept; absent: all.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub nodes: Option<Vec<String>>,
    /// Contacts whose rows are kept, in the increments and in their directions, in the order of the model; absent: all,
    /// but in models of more than 100 contacts those within reach.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub contacts: Option<RecordedContacts>,
    /// Of the regular increments, those whose index is a multiple of this are kept; 1 or more. Kept in any case: starts
    /// and ends of the path and of its stages, contact changes, limit and bifurcation points at which something happens,
    /// increments at which another direction first appears, and those off the measure.
    pub every: u64,
    /// Whether directions are listed. Without them none can be followed.
    pub directions: bool,
}

/// Which contacts have rows: `all`, those `in_reach` of the path, or the ones that are named.
#[derive(Debug, Clone, PartialEq, Eq, Serialize, Deserialize)]
#[cfg_attr(feature = "server", derive(utoipa::ToSchema))]
#[serde(untagged)]
pub enum RecordedContacts {
    Range(ContactRange),
    Named(Vec<RecordedContact>),
}

#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize)]
#[cfg_attr(feature = "server", derive(utoipa::ToSchema))]
#[serde(rename_all = "snake_case")]
pub enum ContactRange {
    /// Every contact of the model.
    All,
    /// Those that take part in the equations. Before the path comes near a contact it has no row; from then on it has one.
    InReach,
}

/// A contact, by the names in the model; contacts listed twice there are meant together.
#[derive(Debug, Clone, PartialEq, Eq, Serialize, Deserialize)]
#[cfg_attr(feature = "server", derive(utoipa::ToSchema))]
#[serde(deny_unknown_fields)]
pub struct RecordedContact {
    pub node: String,
    pub obstacle: String,
}

impl Record {
    /// The contacts that are named, where some are.
    pub fn named_contacts(&self) -> Option<&[RecordedContact]> {
        match &self.contacts {
            Some(RecordedContacts::Named(named)) => Some(named),
            None | Some(RecordedContacts::Range(_)) => None,
        }
    }
}

impl Default for Record {
    fn default() -> Self {
        Self { nodes: None, contacts: None, every: 1, directions: true }
    }
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
            keep_all: false,
            regularised: None,
        }
    }
}

#[derive(Debug, Clone, Copy, PartialEq, Eq, Default, Serialize, Deserialize)]
#[cfg_attr(feature = "server", derive(utoipa::ToSchema))]
#[serde(rename_all = "snake_case")]
pub enum Method {
    /// Arc-length steps in the current contact mode; the mode is decided where it can change.
    #[default]
    Auto,
    /// Every increment by the MPEC of Kanno and Martins.
    Mpec,
    /// The rival, for comparison: penalty contact and regularised friction under a conventional arc-length method.
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
/// Penalties are multiples of the plan's `force_scale / displacement_scale`, the stiffness of the softest bar.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "server", derive(utoipa::ToSchema))]
#[serde(default, deny_unknown_fields)]
pub struct Regularised {
    /// Normal reaction per penetration; above 0.
    pub normal_penalty: f64,
    /// Tangential reaction per elastic slip while the contact sticks; above 0.
    pub tangential_penalty: f64,
    /// Newton iterations that the step length aims at; four times as many are tried. 1 or more.
    pub desired_iterations: u64,
    /// Equilibrium residual over the largest force at which an increment has converged; between 0 and 1. Round-off in
    /// gaps is multiplied by the penalty: stiff penalties ask for a looser tolerance.
    pub tolerance: f64,
    /// Crisfield's ψ: the weight of the load in the arc length that `arc_length` bounds, 0 (cylindrical) or more. With 1
    /// (spherical) that is the arc length of the other methods, which increments report in any case. Where the load
    /// changes and no displacement does, as under an obstacle that slides along, it has to be above 0.
    pub load_weight: f64,
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

#[derive(Debug, Clone, Copy, PartialEq, Eq, Default, Serialize, Deserialize)]
#[cfg_attr(feature = "server", derive(utoipa::ToSchema))]
#[serde(rename_all = "snake_case")]
pub enum Selection {
    /// The direction of largest dissipation per arc length; ties go to the straightest.
    #[default]
    MaxDissipation,
    /// The direction along which the potential energy of structure and loads falls fastest per arc length; ties go to
    /// the straightest.
    MinPotentialEnergy,
    /// The direction whose displacement rate makes the smallest angle with the incoming one.
    Straightest,
}

/// Which contact changes become points of the path. Contacts without friction that touch or lift off within one step are
/// taken together by `auto`, where that is certain to lead to the same state: the increment's event names each of them.
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
    pub initial: f64,
    /// Absent: 1e-9, or the smallest of the other two if that is less.
    pub min: f64,
    /// Absent: 0.5, or the largest of the other two if that is more.
    pub max: f64,
    /// Length; computed from the scene when absent.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub displacement_scale: Option<f64>,
    /// Load factor (dimensionless, or as the pattern has it); computed from the scene when absent.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub load_scale: Option<f64>,
    /// Whether straight stretches are one increment, however long: where every element is linear, every contact in reach a
    /// plane's and no slip turns, up to the next event, but not along stretches of bifurcations. Absent: true if `max` is
    /// absent.
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
