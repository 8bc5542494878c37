//! One accepted point of the path, as it is streamed and stored: in the user's units, under the user's names.

use crate::result::nodal_values::NodalValues;
use serde::{Deserialize, Serialize};
use smallvec::SmallVec;
use std::sync::Arc;

/// An increment: what `arcslip solve` prints as a line, a stream sends as an event and the store keeps as a row.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "server", derive(utoipa::ToSchema))]
pub struct Increment {
    /// 0 for the start of the path.
    pub index: u64,
    /// Name of the running stage.
    pub stage: Arc<str>,
    /// Multiplier of the running stage's pattern.
    pub load_factor: f64,
    /// Dimensionless, from the start of the path.
    pub arc_length: f64,
    /// Dimensionless arc length of this increment: 0 where a stage begins, and where a contact change is found at the very
    /// point before.
    pub step: f64,
    /// Node name to displacement (length), in the plane with the rotation (radians, counter-clockwise, turns counted) last
    /// where the node has one; the nodes that `analysis.record` asks for.
    #[cfg_attr(feature = "server", schema(value_type = indexmap::IndexMap<String, Vec<f64>>))]
    pub displacements: NodalValues,
    /// In the model's order; those that `analysis.record` asks for.
    pub contacts: Vec<ContactState>,
    /// Forces of the elements, in the model's order; those that `analysis.record` asks for.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub elements: Vec<ElementState>,
    /// Name of a supported node to the force of the supports on the structure there, in global axes, with the
    /// moment last where the node has a rotation; 0 along free components. The nodes that `analysis.record` asks for.
    #[serde(default, skip_serializing_if = "NodalValues::is_empty")]
    #[cfg_attr(feature = "server", schema(value_type = indexmap::IndexMap<String, Vec<f64>>))]
    pub supports: NodalValues,
    /// Sum of the forces that the load patterns apply to the nodes, supported ones included, in global axes; the reactions
    /// of supports and obstacles are not part of it.
    #[serde(default, skip_serializing_if = "SmallVec::is_empty")]
    #[cfg_attr(feature = "server", schema(value_type = Vec<f64>))]
    pub applied_forces: SpaceVector,
    /// What kind of point of the path this is.
    pub point: Point,
    /// Feasible one-sided directions, the one taken among them; present where there is a choice.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub directions: Option<Vec<Direction>>,
    /// Whether the state is stable; where `analysis.record.stability` asks for it.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub stability: Option<Stability>,
    /// Where the other kind of motion leads; at a jump, where `analysis.jump_motion.compare` asks for it.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub other_motion: Option<Box<OtherMotion>>,
    /// Energies from the start of the path.
    pub energy: Energy,
    /// Accuracy of this point, and work from the start of the path.
    pub diagnostics: Diagnostics,
}

/// The forces that resist the motion of a jump. `overdamped`: damping alone, the motion goes down the potential energy and
/// stops at the first state at rest on its way; `inertial`: mass and damping, the motion may pass states at rest.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default, Serialize, Deserialize)]
#[cfg_attr(feature = "server", derive(utoipa::ToSchema))]
#[serde(rename_all = "snake_case")]
pub enum JumpMotionKind {
    /// Damping alone.
    #[default]
    Overdamped,
    /// Mass and damping.
    Inertial,
}

impl JumpMotionKind {
    /// The name in the JSON contract.
    pub fn name(self) -> &'static str {
        match self {
            Self::Overdamped => "overdamped",
            Self::Inertial => "inertial",
        }
    }
}

/// The other kind of motion from the state from which a structure jumped, beside the one of the path.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "server", derive(utoipa::ToSchema))]
pub struct OtherMotion {
    #[allow(missing_docs)]
    pub kind: JumpMotionKind,
    /// Time steps it took.
    pub time_steps: u64,
    /// Whether it came to rest in a stable state of equilibrium.
    pub at_rest: bool,
    /// Why it did not come to rest.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub failure: Option<String>,
    /// Largest distance of a node between the two states at rest (length); absent where it did not come to rest.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub distance: Option<f64>,
    /// Energy given off in this motion (force times length).
    pub released: f64,
    /// Energy dissipated by friction in this motion (force times length).
    pub dissipated: f64,
}

/// A contact at an increment.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "server", derive(utoipa::ToSchema))]
pub struct ContactState {
    /// Name of the node.
    pub node: Arc<str>,
    /// Name of the obstacle.
    pub obstacle: Arc<str>,
    /// Whether and how they touch.
    pub status: Status,
    /// Distance to the obstacle (length).
    pub gap: f64,
    /// Force, 0 or more.
    pub normal_reaction: f64,
    /// Force on the node along the obstacle's tangents at the node's place (`dimension - 1` of them): in 2D the normal `n`
    /// turned clockwise; in 3D the coordinate axis least aligned with `n` (the first of those within 1e-9) made
    /// perpendicular to it and of unit length, `t`, and `n × t`.
    #[cfg_attr(feature = "server", schema(value_type = Vec<f64>))]
    pub tangential_reaction: Tangential,
    /// Force of the obstacle on the node in global axes (`dimension` components): normal and tangential reaction together.
    #[serde(default, skip_serializing_if = "SmallVec::is_empty")]
    #[cfg_attr(feature = "server", schema(value_type = Vec<f64>))]
    pub reaction: SpaceVector,
    /// Motion against the obstacle in this increment along the same tangents (length).
    #[cfg_attr(feature = "server", schema(value_type = Vec<f64>))]
    pub slip: Tangential,
    /// Sum of `slip` over the increments from the start of the path (length), each along the tangents of its increment.
    #[serde(default, skip_serializing_if = "SmallVec::is_empty")]
    #[cfg_attr(feature = "server", schema(value_type = Vec<f64>))]
    pub slip_total: Tangential,
    /// Equilibrium does not tell this contact's reaction from those of others that hold the same node: the reactions of
    /// least norm are given.
    #[serde(default, skip_serializing_if = "std::ops::Not::not")]
    pub indeterminate: bool,
}

/// Components along an obstacle's tangents.
pub type Tangential = SmallVec<[f64; 2]>;

/// Components along the global axes, as many as the space has dimensions.
pub type SpaceVector = SmallVec<[f64; 3]>;

/// The force that an element carries.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "server", derive(utoipa::ToSchema))]
pub struct ElementState {
    /// Place in the model's `elements`, from 0.
    pub element: u64,
    /// The element's name, where the model gives one.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    #[cfg_attr(feature = "server", schema(value_type = Option<String>))]
    pub name: Option<Arc<str>>,
    /// Of a bar: force along its axis, tension positive, prestress included.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub axial_force: Option<f64>,
    /// Of a spring: its stiffness times the displacement of its first node relative to the second, or to the ground, in
    /// global axes. The spring acts on its first node with the opposite of this force.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    #[cfg_attr(feature = "server", schema(value_type = Option<Vec<f64>>))]
    pub force: Option<SpaceVector>,
    /// Of a beam: forces and moment at its first and its last node.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub ends: Option<[BeamEndForces; 2]>,
    /// Of a rotational spring: its stiffness times the rotation of its first node relative to the second, or to the ground.
    /// The spring acts on its first node with the opposite of this moment.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub moment: Option<f64>,
    /// Of a solid: the mean Cauchy stress over its deformed volume (with a material of small strains, of the stress), tension
    /// positive, in global axes: `xx`, `yy`, `zz`, `xy`, and in space `yz`, `xz`. In the plane `z` is the third direction, of a
    /// body of revolution the one around its axis.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    #[cfg_attr(feature = "server", schema(value_type = Option<Vec<f64>>))]
    pub stress: Option<SmallVec<[f64; 6]>>,
    /// Of a solid: the equivalent stress of von Mises of `stress`.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub von_mises: Option<f64>,
}

/// The force in a beam at one of its ends, in the axes of the deformed cross-section. In the plane: `t` along the beam,
/// `n` a quarter turn counter-clockwise from it. In space: `t`, axis 1 and axis 2 of the beam. Forces and moments are
/// those on the part of the beam before the cross-section.
#[derive(Debug, Clone, Copy, PartialEq, Default, Serialize, Deserialize)]
#[cfg_attr(feature = "server", derive(utoipa::ToSchema))]
pub struct BeamEndForces {
    /// Along `t`, tension positive.
    pub axial_force: f64,
    /// In the plane, along `n`.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub shear_force: Option<f64>,
    /// In the plane, EI times the change of curvature: positive where the rotation grows along the beam.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub bending_moment: Option<f64>,
    /// In space, along axes 1 and 2.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub shear_forces: Option<[f64; 2]>,
    /// In space, about `t`.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub torsional_moment: Option<f64>,
    /// In space, about axes 1 and 2.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub bending_moments: Option<[f64; 2]>,
}

impl BeamEndForces {
    /// Forces in the plane.
    pub(crate) fn in_plane(axial_force: f64, shear_force: f64, bending_moment: f64) -> Self {
        Self { axial_force, shear_force: Some(shear_force), bending_moment: Some(bending_moment), ..Self::default() }
    }

    /// Forces in space.
    pub(crate) fn in_space(
        axial_force: f64,
        shear_forces: [f64; 2],
        torsional_moment: f64,
        bending_moments: [f64; 2],
    ) -> Self {
        Self {
            axial_force,
            shear_forces: Some(shear_forces),
            torsional_moment: Some(torsional_moment),
            bending_moments: Some(bending_moments),
            ..Self::default()
        }
    }

    /// Forces, then moments, each in the order of the axes: three numbers in the plane, six in space.
    pub(crate) fn values(&self) -> impl Iterator<Item = f64> {
        let forces = self.shear_force.into_iter().chain(self.shear_forces.into_iter().flatten());
        let moments = self.bending_moment.into_iter().chain(self.torsional_moment);
        std::iter::once(self.axial_force).chain(forces).chain(moments).chain(self.bending_moments.into_iter().flatten())
    }
}

/// Status of a contact.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash, Serialize, Deserialize)]
#[cfg_attr(feature = "server", derive(utoipa::ToSchema))]
#[serde(rename_all = "snake_case")]
pub enum Status {
    /// They do not touch, or touch without a reaction and part.
    Free,
    /// They touch and the node does not move along the obstacle.
    Stick,
    /// They touch and the node moves along the obstacle.
    Slip,
}

/// A point of the path: what happens there and what was found of its directions.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "server", derive(utoipa::ToSchema))]
pub struct Point {
    /// Its kind.
    pub kind: PointKind,
    /// Two or more feasible directions share the sign of the load rate.
    pub bifurcation: bool,
    /// What happens here, in words; null at regular points.
    pub event: Option<String>,
    /// A listed direction dissipates more than the one the path keeps.
    #[serde(default, skip_serializing_if = "std::ops::Not::not")]
    pub better_direction: bool,
    /// Contact modes that were not examined because `max_modes` was reached.
    #[serde(default, skip_serializing_if = "is_zero")]
    pub unexplored_modes: u64,
    /// The number of directions found is odd, or their set has more than one dimension: the list may be incomplete.
    #[serde(default, skip_serializing_if = "std::ops::Not::not")]
    pub degenerate: bool,
}

impl Point {
    /// A point with one way on.
    pub fn plain(kind: PointKind, event: Option<String>) -> Self {
        Self { kind, bifurcation: false, event, better_direction: false, unexplored_modes: 0, degenerate: false }
    }
}

fn is_zero(count: &u64) -> bool {
    *count == 0
}

/// Kind of a point of the path.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash, Serialize, Deserialize)]
#[cfg_attr(feature = "server", derive(utoipa::ToSchema))]
#[serde(rename_all = "snake_case")]
pub enum PointKind {
    /// The start of the path or of a stage.
    Start,
    /// No event.
    Regular,
    /// The load rate changes its sign continuously, within a contact mode.
    SmoothLimit,
    /// The load rate changes its sign by a jump, where a contact changes.
    NonsmoothLimit,
    /// Paths of one contact mode cross or branch.
    SmoothBifurcation,
    /// A contact changes its status, the load rate keeps its sign.
    ContactChange,
    /// The end of a stage.
    End,
    /// A state at rest to which the structure has jumped at a constant load.
    Jump,
    /// A state of the motion of a jump, not at rest (`jump_motion.keep_steps`).
    Motion,
}

/// A feasible one-sided direction of the path.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "server", derive(utoipa::ToSchema))]
pub struct Direction {
    /// Status along the direction, one a contact, as in the increment's `contacts`.
    pub contacts: Vec<Status>,
    /// Load factor per arc length.
    pub load_rate: f64,
    /// Energy per arc length.
    pub dissipation_rate: f64,
    /// Whether the path goes on this way.
    pub taken: bool,
    /// The way the path came from; never taken.
    #[serde(default, skip_serializing_if = "std::ops::Not::not")]
    pub retrace: bool,
    /// A motion that no element resists: a path cannot go this way.
    #[serde(default, skip_serializing_if = "std::ops::Not::not")]
    pub mechanism: bool,
}

/// Whether the state of an increment is stable.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize)]
#[cfg_attr(feature = "server", derive(utoipa::ToSchema))]
pub struct Stability {
    /// Negative eigenvalues of the tangent in the contact mode of the increment, those with a negative real part where slip
    /// against friction or a following load makes it unsymmetric; absent where they are not known.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub negative_eigenvalues: Option<u64>,
    /// Whether the state stays while the load does.
    pub dead_load: DeadLoadStability,
    /// How the state is left, where it is unstable in some sense.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub instability: Option<Instability>,
}

/// Stability under a load that stays, by the directional criterion of frictional contact.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize)]
#[cfg_attr(feature = "server", derive(utoipa::ToSchema))]
#[serde(rename_all = "snake_case")]
pub enum DeadLoadStability {
    /// No admissible motion grows.
    Stable,
    /// An admissible motion grows.
    Unstable,
    /// Neither was shown.
    Unknown,
}

/// How a state is left that is not stable.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize)]
#[cfg_attr(feature = "server", derive(utoipa::ToSchema))]
#[serde(rename_all = "snake_case")]
pub enum Instability {
    /// A motion grows in one sense.
    Divergence,
    /// Two eigenvalues are a complex pair: without damping, the motion in the contact mode of the increment swings with a
    /// growing amplitude.
    Flutter,
}

/// Totals from the start of the path.
#[derive(Debug, Clone, Copy, PartialEq, Default, Serialize, Deserialize)]
#[cfg_attr(feature = "server", derive(utoipa::ToSchema))]
pub struct Energy {
    /// Work of forces, prescribed displacements and moving obstacles (force times length).
    pub external_work: f64,
    /// Strain energy of the elements (force times length).
    pub strain: f64,
    /// Energy dissipated by friction (force times length).
    pub dissipated: f64,
    /// Energy given off by the motion of jumps (force times length): what loads and strain energy gave and friction did not
    /// take. Absent where there was no jump.
    #[serde(default, skip_serializing_if = "is_none")]
    pub released: f64,
}

fn is_none(energy: &f64) -> bool {
    *energy == 0.0
}

/// Accuracy of an increment, and totals of work up to it.
#[derive(Debug, Clone, Copy, PartialEq, Default, Serialize, Deserialize)]
#[cfg_attr(feature = "server", derive(utoipa::ToSchema))]
pub struct Diagnostics {
    /// Solver time since the job began; the only figure here that differs from run to run.
    pub elapsed_s: f64,
    /// Largest equilibrium residual over the force scale.
    pub residual: f64,
    /// Largest violation of contact and friction, dimensionless.
    pub complementarity: f64,
    /// `|external work - strain - dissipated - released|` over the largest energy so far.
    pub energy_error: f64,
    /// Estimated error of this point (dimensionless displacement).
    pub error_estimate: f64,
    /// Factorisations of matrices.
    pub factorisations: u64,
    /// Of the factorisations those that smooth bifurcation points took: to locate them and to list the directions there.
    #[serde(default)]
    pub bifurcation_factorisations: u64,
    /// Iterations of Newton's method.
    pub newton_iterations: u64,
    /// Quadratic programs.
    pub qp_solves: u64,
    /// Programs of increments that were solved; a certificate is not one.
    pub mpec_solves: u64,
    /// Steps of sequential quadratic programming.
    #[serde(default)]
    pub sqp_iterations: u64,
    /// Points shown to solve their increment's program without solving it.
    #[serde(default)]
    pub certificates: u64,
    /// Increments whose end the program alone did not find (`mpec.certificate: "skip"`): they stand as the contact mode's
    /// own equations gave them.
    #[serde(default)]
    pub mpec_fallbacks: u64,
    /// The last bound `ε` on the products of complementary quantities, of the last program that was solved; absent before
    /// the first, and where no program needed one.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub last_relaxation: Option<f64>,
    /// With `method: "mpec"`: whether the program named the mode of this increment. Where it did not (it is solved
    /// locally, and a contact just at the end of its mode is a coin's edge), the mode was kept by continuity.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub mode_named_by_mpec: Option<bool>,
}
