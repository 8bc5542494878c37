//! A structure, its obstacles, and the stages of its load.

pub use crate::mechanics::structure::elements::bar::Strain;
use indexmap::IndexMap;
use serde::{Deserialize, Serialize};

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
    #[cfg_attr(feature = "server", schema(min_items = 1))]
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
        #[cfg_attr(feature = "server", schema(min_items = 2, max_items = 2))]
        nodes: Vec<String>,
        /// EA (force), positive.
        #[cfg_attr(feature = "server", schema(exclusive_minimum = 0.0))]
        axial_stiffness: f64,
        /// Unstressed length; the distance of the nodes when absent.
        #[serde(default, skip_serializing_if = "Option::is_none")]
        #[cfg_attr(feature = "server", schema(exclusive_minimum = 0.0))]
        rest_length: Option<f64>,
        /// Axial force (tension positive) added to the elastic one.
        #[serde(default)]
        prestress: f64,
        #[serde(default)]
        strain: Strain,
        /// By which results and `analysis.record` refer to the element; one element has it.
        #[serde(default, skip_serializing_if = "Option::is_none")]
        name: Option<String>,
    },
    /// A constant stiffness between one node and the ground, or between two nodes; it does not follow rotation.
    Spring {
        /// One or two node names.
        #[cfg_attr(feature = "server", schema(min_items = 1, max_items = 2))]
        nodes: Vec<String>,
        /// Symmetric, `dimension` rows of `dimension` numbers (force per length).
        #[cfg_attr(feature = "server", schema(min_items = 2, max_items = 3))]
        stiffness: Vec<Vec<f64>>,
        /// By which results and `analysis.record` refer to the element; one element has it.
        #[serde(default, skip_serializing_if = "Option::is_none")]
        name: Option<String>,
    },
}

impl Element {
    /// The name by which results refer to the element, where it has one.
    pub fn name(&self) -> Option<&str> {
        let (Self::Bar { name, .. } | Self::Spring { name, .. }) = self;
        name.as_deref()
    }
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
        #[cfg_attr(feature = "server", schema(exclusive_minimum = 0.0))]
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
    #[cfg_attr(feature = "server", schema(minimum = 0.0))]
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
    #[cfg_attr(feature = "server", schema(exclusive_minimum = 0.0))]
    pub load_above: Option<f64>,
    #[serde(default, skip_serializing_if = "Option::is_none")]
    #[cfg_attr(feature = "server", schema(exclusive_maximum = 0.0))]
    pub load_below: Option<f64>,
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
    pub node: String,
    pub component: Component,
    #[serde(default, skip_serializing_if = "Option::is_none")]
    #[cfg_attr(feature = "server", schema(exclusive_minimum = 0.0))]
    pub above: Option<f64>,
    #[serde(default, skip_serializing_if = "Option::is_none")]
    #[cfg_attr(feature = "server", schema(exclusive_maximum = 0.0))]
    pub below: Option<f64>,
}
