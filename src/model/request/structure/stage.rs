//! Stages of the load, and where they end.

use crate::model::request::structure::component::Component;
use crate::model::request::structure::rotation::ObstacleRotation;
use indexmap::IndexMap;
use serde::{Deserialize, Serialize};

/// A stage of the load history: a pattern of forces, prescribed displacements and motions of obstacles, multiplied by the
/// load factor, which the path determines.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "server", derive(utoipa::ToSchema))]
#[serde(deny_unknown_fields)]
pub struct Stage {
    /// Name, by which increments tell the stage they belong to.
    pub name: String,
    /// Node name to force; multiplied by the load factor.
    #[serde(default, skip_serializing_if = "IndexMap::is_empty")]
    pub forces: IndexMap<String, Vec<f64>>,
    /// Node name to moment (force times length, counter-clockwise), in the plane at nodes with a rotation; multiplied by
    /// the load factor.
    #[serde(default, skip_serializing_if = "IndexMap::is_empty")]
    pub moments: IndexMap<String, f64>,
    /// Node name to prescribed displacement of its supported components (length; zero on free ones), with the
    /// rotation (radians) last where the node has one and it is to be prescribed; multiplied by the load factor.
    #[serde(default, skip_serializing_if = "IndexMap::is_empty")]
    pub displacements: IndexMap<String, Vec<f64>>,
    /// Material name to force per undeformed volume on its solids; multiplied by the load factor.
    #[serde(default, skip_serializing_if = "IndexMap::is_empty")]
    pub body_forces: IndexMap<String, Vec<f64>>,
    /// Surface name to force per undeformed area, which keeps its direction; multiplied by the load factor.
    #[serde(default, skip_serializing_if = "IndexMap::is_empty")]
    pub tractions: IndexMap<String, Vec<f64>>,
    /// Surface name to pressure (force per deformed area; on sides of bars and beams per length) on it, which follows the
    /// surface; above 0 it presses on the solid, or away from the free side. Multiplied by the load factor.
    #[serde(default, skip_serializing_if = "IndexMap::is_empty")]
    pub pressures: IndexMap<String, f64>,
    /// Obstacle name to translation (length); multiplied by the load factor.
    #[serde(default, skip_serializing_if = "IndexMap::is_empty")]
    pub obstacle_motion: IndexMap<String, Vec<f64>>,
    /// Obstacle name to rotation; its angle is multiplied by the load factor.
    #[serde(default, skip_serializing_if = "IndexMap::is_empty")]
    pub obstacle_rotation: IndexMap<String, ObstacleRotation>,
    /// Where the stage ends; absent: it goes on to `max_increments`.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub until: Option<Until>,
    #[allow(missing_docs)]
    #[serde(default, skip_serializing_if = "StageControl::is_path")]
    pub control: StageControl,
    /// With `control: "load"`: the load factors that the load goes to one after the other, from 0 on; the stage ends at
    /// the last. Absent: the load rises to `until`'s `load_above`, or falls to its `load_below`.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub history: Vec<f64>,
    /// How often the load goes through `history`; 1 or more. Absent: once.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    #[cfg_attr(feature = "server", schema(minimum = 1, maximum = 100_000))]
    pub cycles: Option<u64>,
}

/// What drives a stage. `path`: the arc length, the load rises and falls as equilibrium asks; `load`: the load goes one way,
/// and where it cannot, the structure jumps to the next state at rest (`analysis.jump_motion`). With prescribed
/// displacements or moving obstacles the load factor is that of the motion: `load` is displacement control.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default, Serialize, Deserialize)]
#[cfg_attr(feature = "server", derive(utoipa::ToSchema))]
#[serde(rename_all = "snake_case")]
pub enum StageControl {
    /// The arc length.
    #[default]
    Path,
    /// The load.
    Load,
}

impl StageControl {
    fn is_path(&self) -> bool {
        *self == Self::Path
    }
}

impl Stage {
    /// A stage without load and without end.
    ///
    /// ```
    /// use arcslip::{Component, DisplacementBound, Stage};
    ///
    /// let stage = Stage::new("push")
    ///     .force("tip", [1.0, 0.0])
    ///     .until_load_above(2.0)
    ///     .until_displacement(DisplacementBound::above("tip", Component::X, 0.5));
    /// assert_eq!(stage.until.unwrap().load_above, Some(2.0));
    /// ```
    pub fn new(name: impl Into<String>) -> Self {
        Self {
            name: name.into(),
            forces: IndexMap::new(),
            moments: IndexMap::new(),
            displacements: IndexMap::new(),
            body_forces: IndexMap::new(),
            tractions: IndexMap::new(),
            pressures: IndexMap::new(),
            obstacle_motion: IndexMap::new(),
            obstacle_rotation: IndexMap::new(),
            until: None,
            control: StageControl::Path,
            history: Vec::new(),
            cycles: None,
        }
    }

    /// With a force on a node (`dimension` components), in place of one given before.
    #[must_use]
    pub fn force(mut self, node: impl Into<String>, force: impl Into<Vec<f64>>) -> Self {
        self.forces.insert(node.into(), force.into());
        self
    }

    /// With a moment on a node (counter-clockwise), in place of one given before.
    #[must_use]
    pub fn moment(mut self, node: impl Into<String>, moment: f64) -> Self {
        self.moments.insert(node.into(), moment);
        self
    }

    /// With a prescribed displacement of a supported node (length, `dimension` components), in place of one given before.
    #[must_use]
    pub fn displacement(mut self, node: impl Into<String>, displacement: impl Into<Vec<f64>>) -> Self {
        self.displacements.insert(node.into(), displacement.into());
        self
    }

    /// With a force per undeformed volume on the solids of a material, in place of one given before.
    #[must_use]
    pub fn body_force(mut self, material: impl Into<String>, force: impl Into<Vec<f64>>) -> Self {
        self.body_forces.insert(material.into(), force.into());
        self
    }

    /// With a force per undeformed area on a surface, in place of one given before.
    #[must_use]
    pub fn traction(mut self, surface: impl Into<String>, traction: impl Into<Vec<f64>>) -> Self {
        self.tractions.insert(surface.into(), traction.into());
        self
    }

    /// With a pressure on a surface (force per deformed area), in place of one given before.
    #[must_use]
    pub fn pressure(mut self, surface: impl Into<String>, pressure: f64) -> Self {
        self.pressures.insert(surface.into(), pressure);
        self
    }

    /// With a translation of an obstacle (length, `dimension` components), in place of one given before.
    #[must_use]
    pub fn obstacle_motion(mut self, obstacle: impl Into<String>, translation: impl Into<Vec<f64>>) -> Self {
        self.obstacle_motion.insert(obstacle.into(), translation.into());
        self
    }

    /// With a rotation of an obstacle, in place of one given before.
    #[must_use]
    pub fn obstacle_rotation(mut self, obstacle: impl Into<String>, rotation: ObstacleRotation) -> Self {
        self.obstacle_rotation.insert(obstacle.into(), rotation);
        self
    }

    /// With a load that only goes one way: where it cannot, the structure jumps.
    #[must_use]
    pub fn under_load_control(mut self) -> Self {
        self.control = StageControl::Load;
        self
    }

    /// With a load that goes through these load factors, so many times, and jumps where it must.
    ///
    /// ```
    /// use arcslip::{Stage, StageControl};
    ///
    /// let stage = Stage::new("shake").force("crown", [0.0, -1.0]).load_history([1.0, -1.0], 10);
    /// assert_eq!((stage.control, stage.cycles), (StageControl::Load, Some(10)));
    /// ```
    #[must_use]
    pub fn load_history(mut self, load_factors: impl Into<Vec<f64>>, cycles: u64) -> Self {
        (self.history, self.cycles) = (load_factors.into(), Some(cycles));
        self.under_load_control()
    }

    /// Ending where the load factor reaches a value above 0 from below.
    #[must_use]
    pub fn until_load_above(self, load_factor: f64) -> Self {
        self.ending(|until| until.load_above = Some(load_factor))
    }

    /// Ending where the load factor reaches a value below 0 from above.
    #[must_use]
    pub fn until_load_below(self, load_factor: f64) -> Self {
        self.ending(|until| until.load_below = Some(load_factor))
    }

    /// Ending where a displacement reaches a value.
    #[must_use]
    pub fn until_displacement(self, bound: DisplacementBound) -> Self {
        self.ending(|until| until.displacement = Some(bound))
    }

    /// Ending at the limit point of this number, counted from 1 along the stage.
    #[must_use]
    pub fn until_limit_points(self, number: u64) -> Self {
        self.ending(|until| until.limit_points = Some(number))
    }

    /// Ending at the contact change of this number, counted from 1 along the stage.
    #[must_use]
    pub fn until_contact_changes(self, number: u64) -> Self {
        self.ending(|until| until.contact_change = Some(number))
    }

    /// Ending after this many increments of the stage.
    #[must_use]
    pub fn until_increments(self, number: u64) -> Self {
        self.ending(|until| until.increments = Some(number))
    }

    fn ending(mut self, set: impl FnOnce(&mut Until)) -> Self {
        set(self.until.get_or_insert_default());
        self
    }
}

/// Ends of a stage; the first that is met ends it, and it ends exactly there.
#[derive(Debug, Clone, PartialEq, Default, Serialize, Deserialize)]
#[cfg_attr(feature = "server", derive(utoipa::ToSchema))]
#[serde(deny_unknown_fields)]
pub struct Until {
    /// The load factor reaches this from below; above 0.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    #[cfg_attr(feature = "server", schema(exclusive_minimum = 0.0))]
    pub load_above: Option<f64>,
    /// The load factor reaches this from above; below 0.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    #[cfg_attr(feature = "server", schema(exclusive_maximum = 0.0))]
    pub load_below: Option<f64>,
    /// A displacement reaches a value.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub displacement: Option<DisplacementBound>,
    /// This many limit points of the stage, smooth and nonsmooth.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    #[cfg_attr(feature = "server", schema(minimum = 1))]
    pub limit_points: Option<u64>,
    /// This many contact changes of the stage.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    #[cfg_attr(feature = "server", schema(minimum = 1))]
    pub contact_change: Option<u64>,
    /// This many increments of the stage.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    #[cfg_attr(feature = "server", schema(minimum = 1))]
    pub increments: Option<u64>,
}

/// A displacement reaches a value from below (`above`) or from above (`below`); exactly one of the two is given.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "server", derive(utoipa::ToSchema))]
#[serde(deny_unknown_fields)]
pub struct DisplacementBound {
    /// Name of the node.
    pub node: String,
    /// Direction of the displacement.
    pub component: Component,
    /// Length (an angle of a rotation), above 0.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    #[cfg_attr(feature = "server", schema(exclusive_minimum = 0.0))]
    pub above: Option<f64>,
    /// Length (an angle of a rotation), below 0.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    #[cfg_attr(feature = "server", schema(exclusive_maximum = 0.0))]
    pub below: Option<f64>,
}

impl DisplacementBound {
    /// The displacement reaches a value above 0 (length) from below.
    pub fn above(node: impl Into<String>, component: Component, value: f64) -> Self {
        Self { node: node.into(), component, above: Some(value), below: None }
    }

    /// The displacement reaches a value below 0 (length) from above.
    pub fn below(node: impl Into<String>, component: Component, value: f64) -> Self {
        Self { node: node.into(), component, above: None, below: Some(value) }
    }
}
