//! The model as a whole.

use crate::model::request::structure::component::Component;
use crate::model::request::structure::element::Element;
use crate::model::request::structure::material::Material;
use crate::model::request::structure::mesh::MeshFile;
use crate::model::request::structure::obstacle::{Contact, Obstacle};
use crate::model::request::structure::rotation::ObstaclePivot;
use crate::model::request::structure::stage::Stage;
use crate::model::request::structure::surface::{NamedSet, Surface};
use indexmap::IndexMap;
use serde::{Deserialize, Serialize};

/// A structure, its obstacles and its load history.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "server", derive(utoipa::ToSchema))]
#[serde(deny_unknown_fields)]
pub struct Model {
    /// A title.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub name: Option<String>,
    /// Labels of its units, shown with results and never computed with.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub units: Option<Units>,
    /// 2 or 3.
    #[cfg_attr(feature = "server", schema(minimum = 2, maximum = 3))]
    pub dimension: usize,
    /// A mesh file, whose parts join those given here.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub mesh: Option<MeshFile>,
    /// Node name to coordinates (length, `dimension` of them).
    #[serde(default)]
    pub nodes: IndexMap<String, Vec<f64>>,
    /// Node name to the components held.
    #[serde(default, skip_serializing_if = "IndexMap::is_empty")]
    pub supports: IndexMap<String, Vec<Component>>,
    /// Name to material of solids.
    #[serde(default, skip_serializing_if = "IndexMap::is_empty")]
    pub materials: IndexMap<String, Material>,
    /// Bars, springs, beams, solids, and groups of a mesh.
    pub elements: Vec<Element>,
    /// Name to faces of solids.
    #[serde(default, skip_serializing_if = "IndexMap::is_empty")]
    pub surfaces: IndexMap<String, Surface>,
    /// Name to nodes and elements; `@name` stands for the nodes where a node is expected.
    #[serde(default, skip_serializing_if = "IndexMap::is_empty")]
    pub sets: IndexMap<String, NamedSet>,
    /// Obstacle name to obstacle.
    #[serde(default, skip_serializing_if = "IndexMap::is_empty")]
    pub obstacles: IndexMap<String, Obstacle>,
    /// Which nodes may touch which obstacles.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub contacts: Vec<Contact>,
    /// For each of `contacts` its index in the request as posted; empty where none stood for several.
    #[serde(skip)]
    pub(crate) posted_contacts: Vec<usize>,
    /// Run in order; each starts at load factor 0 and holds what earlier ones reached.
    #[cfg_attr(feature = "server", schema(min_items = 1))]
    pub stages: Vec<Stage>,
}

/// Labels of units, such as `m` and `kN`.
#[derive(Debug, Clone, PartialEq, Eq, Default, Serialize, Deserialize)]
#[cfg_attr(feature = "server", derive(utoipa::ToSchema))]
#[serde(deny_unknown_fields)]
pub struct Units {
    /// Of coordinates, displacements, gaps and slips.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub length: Option<String>,
    /// Of forces and reactions.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub force: Option<String>,
}

impl Model {
    /// The index of a contact in the request as posted, where one contact may stand for those of many nodes.
    pub(crate) fn posted_contact(&self, index: usize) -> usize {
        self.posted_contacts.get(index).copied().unwrap_or(index)
    }

    /// Number of rotations of a node that has any: 1 in the plane, 3 in space.
    pub fn rotations(&self) -> usize {
        if self.dimension == 3 { 3 } else { 1 }
    }

    /// For each node, whether it has rotations: where a beam is joined to it rigidly, or a rotational spring acts on it.
    pub fn rotating_nodes(&self) -> Vec<bool> {
        let mut rotating = vec![false; self.nodes.len()];
        for element in &self.elements {
            for node in element.nodes().iter().filter(|node| element.turns_with(node)) {
                if let Some(number) = self.nodes.get_index_of(node) {
                    rotating[number] = true;
                }
            }
        }
        rotating
    }

    /// The obstacles that turn, in the order of the obstacles, each with the pivot of the first stage that turns it.
    pub(crate) fn turning_obstacles(&self) -> IndexMap<&str, ObstaclePivot> {
        let mut turning: IndexMap<&str, ObstaclePivot> = IndexMap::new();
        for (name, rotation) in self.stages.iter().flat_map(|stage| &stage.obstacle_rotation) {
            let pivot = self.obstacles.get(name).and_then(|obstacle| rotation.pivot(obstacle, self.dimension));
            if let Some(pivot) = pivot {
                turning.entry(name).or_insert(pivot);
            }
        }
        turning.sort_by_cached_key(|name, _| self.obstacles.get_index_of(*name));
        turning
    }

    /// A model without nodes, in the plane (2) or in space (3).
    ///
    /// ```
    /// use arcslip::{Component, Element, EquilibriumProblem, Model, Obstacle, Stage};
    ///
    /// let model = Model::new(2)
    ///     .node("pin", [0.0, 1.0])
    ///     .node("tip", [-1.5, 0.0])
    ///     .support("pin", [Component::X, Component::Y])
    ///     .element(Element::bar("pin", "tip", 1.0))
    ///     .obstacle("floor", Obstacle::plane([0.0, 0.0], [0.0, 1.0]))
    ///     .contact("tip", "floor", 0.3)
    ///     .stage(Stage::new("push").force("tip", [1.0, 0.0]));
    /// let problem = EquilibriumProblem::new(model)?;
    /// assert_eq!(problem.plan().unknowns, 2);
    /// # Ok::<(), arcslip::InputErrors>(())
    /// ```
    pub fn new(dimension: usize) -> Self {
        Self {
            name: None,
            units: None,
            dimension,
            mesh: None,
            nodes: IndexMap::new(),
            supports: IndexMap::new(),
            materials: IndexMap::new(),
            elements: Vec::new(),
            surfaces: IndexMap::new(),
            sets: IndexMap::new(),
            obstacles: IndexMap::new(),
            contacts: Vec::new(),
            posted_contacts: Vec::new(),
            stages: Vec::new(),
        }
    }

    /// With a node at its coordinates (length), in place of one of the same name.
    #[must_use]
    pub fn node(mut self, name: impl Into<String>, coordinates: impl Into<Vec<f64>>) -> Self {
        self.nodes.insert(name.into(), coordinates.into());
        self
    }

    /// With the components of a node that are held, in place of those given before.
    #[must_use]
    pub fn support(mut self, node: impl Into<String>, components: impl Into<Vec<Component>>) -> Self {
        self.supports.insert(node.into(), components.into());
        self
    }

    /// With a material, in place of one of the same name.
    #[must_use]
    pub fn material(mut self, name: impl Into<String>, material: Material) -> Self {
        self.materials.insert(name.into(), material);
        self
    }

    /// With a surface of faces, in place of one of the same name.
    #[must_use]
    pub fn surface(mut self, name: impl Into<String>, faces: Vec<Vec<String>>) -> Self {
        self.surfaces.insert(name.into(), Surface { faces, group: None });
        self
    }

    /// With one more element.
    #[must_use]
    pub fn element(mut self, element: Element) -> Self {
        self.elements.push(element);
        self
    }

    /// With an obstacle, in place of one of the same name.
    #[must_use]
    pub fn obstacle(mut self, name: impl Into<String>, obstacle: Obstacle) -> Self {
        self.obstacles.insert(name.into(), obstacle);
        self
    }

    /// With one more contact: see [`Contact::new`].
    #[must_use]
    pub fn contact(mut self, node: impl Into<String>, obstacle: impl Into<String>, friction: f64) -> Self {
        self.contacts.push(Contact::new(node, obstacle, friction));
        self
    }

    /// With one more stage, after those given before.
    #[must_use]
    pub fn stage(mut self, stage: Stage) -> Self {
        self.stages.push(stage);
        self
    }
}
