//! The form of the model: which members it has, and how sets and surfaces are written.

use crate::model::mesh::convert::ConvertedModel;
use crate::model::mesh::data::mesh_data::{DeckMaterial, MeshSection, PlaneState};
use crate::model::mesh::data::node_lists::NodeLists;
use indexmap::IndexMap;
use serde::ser::SerializeMap;
use serde::{Serialize, Serializer};

/// The request that the model is in.
#[derive(Debug, Serialize)]
pub struct Request<'a> {
    model: ModelBody<'a>,
}

#[derive(Debug, Serialize)]
struct ModelBody<'a> {
    dimension: usize,
    nodes: NodeEntries<'a>,
    #[serde(skip_serializing_if = "IndexMap::is_empty")]
    materials: IndexMap<&'a str, &'a DeckMaterial>,
    elements: ElementEntries<'a>,
    #[serde(skip_serializing_if = "IndexMap::is_empty")]
    surfaces: IndexMap<&'a str, SurfaceEntry<'a>>,
    #[serde(skip_serializing_if = "IndexMap::is_empty")]
    sets: IndexMap<&'a str, SetEntry<'a>>,
    stages: [EmptyStage; 1],
}

/// A stage whose pattern is still to be written.
#[derive(Debug, Serialize)]
struct EmptyStage {
    name: &'static str,
}

/// A set as a model writes it: `{"nodes": [...], "elements": [...]}`, by name; what is empty is left out.
#[derive(Debug, Serialize)]
pub struct SetEntry<'a> {
    /// Its nodes.
    #[serde(skip_serializing_if = "NodeNames::is_empty")]
    nodes: NodeNames<'a>,
    /// Its elements.
    #[serde(skip_serializing_if = "ElementNames::is_empty")]
    elements: ElementNames<'a>,
}

impl<'a> Request<'a> {
    /// The request of a model.
    pub fn new(model: &'a ConvertedModel<'a>) -> Self {
        let mesh = model.mesh;
        let described = mesh.materials.iter().filter(|(_, material)| material.law.is_some());
        // `@name` of a surface stands for its nodes, too.
        let names = mesh.node_sets.keys().chain(mesh.element_sets.keys());
        let names = names.filter(|name| !mesh.surfaces.contains_key(*name));
        let set = |name: &String| SetEntry {
            nodes: NodeNames(model, mesh.node_sets.get(name).map_or(&[], Vec::as_slice)),
            elements: ElementNames(model, mesh.element_sets.get(name).map_or(&[], Vec::as_slice)),
        };
        let sets = names.map(|name| (name.as_str(), set(name)));
        let body = ModelBody {
            dimension: model.dimension,
            nodes: NodeEntries(model),
            materials: described.map(|(name, material)| (name.as_str(), material)).collect(),
            elements: ElementEntries(model),
            surfaces: mesh
                .surfaces
                .iter()
                .map(|(name, faces)| (name.as_str(), SurfaceEntry::new(model, faces)))
                .collect(),
            sets: sets.filter(|(_, set)| !(set.nodes.is_empty() && set.elements.is_empty())).collect(),
            stages: [EmptyStage { name: "loads" }],
        };
        Self { model: body }
    }
}

/// An element's label as a name: `e` before the number, since digits alone are an element's place.
#[derive(Debug)]
struct ElementName(u64);

impl Serialize for ElementName {
    fn serialize<S: Serializer>(&self, serializer: S) -> Result<S::Ok, S::Error> {
        serializer.collect_str(&format_args!("e{}", self.0))
    }
}

/// A node's label as a name.
#[derive(Debug)]
struct Name(u64);

impl Serialize for Name {
    fn serialize<S: Serializer>(&self, serializer: S) -> Result<S::Ok, S::Error> {
        serializer.collect_str(&self.0)
    }
}

#[derive(Debug)]
struct NodeEntries<'a>(&'a ConvertedModel<'a>);

impl Serialize for NodeEntries<'_> {
    fn serialize<S: Serializer>(&self, serializer: S) -> Result<S::Ok, S::Error> {
        let mesh = self.0.mesh;
        let mut map = serializer.serialize_map(None)?;
        for ((label, point), is_used) in mesh.node_labels.iter().zip(&mesh.coordinates).zip(&self.0.is_used) {
            if *is_used {
                map.serialize_entry(&Name(*label), point.get(..self.0.dimension).unwrap_or(point))?;
            }
        }
        map.end()
    }
}

#[derive(Debug)]
struct NodeNames<'a>(&'a ConvertedModel<'a>, &'a [u32]);

impl NodeNames<'_> {
    fn is_empty(&self) -> bool {
        self.0.used(self.1).next().is_none()
    }
}

impl Serialize for NodeNames<'_> {
    fn serialize<S: Serializer>(&self, serializer: S) -> Result<S::Ok, S::Error> {
        serializer.collect_seq(self.0.used(self.1).map(|node| Name(self.0.node_label(node))))
    }
}

#[derive(Debug)]
struct ElementNames<'a>(&'a ConvertedModel<'a>, &'a [u32]);

impl ElementNames<'_> {
    fn is_empty(&self) -> bool {
        self.1.is_empty()
    }
}

impl Serialize for ElementNames<'_> {
    fn serialize<S: Serializer>(&self, serializer: S) -> Result<S::Ok, S::Error> {
        let labels = &self.0.mesh.elements.labels;
        serializer.collect_seq(
            self.1.iter().filter_map(|element| labels.get(*element as usize)).map(|label| ElementName(*label)),
        )
    }
}

#[derive(Debug)]
struct ElementEntries<'a>(&'a ConvertedModel<'a>);

#[derive(Debug, Serialize)]
struct SolidEntry<'a> {
    kind: &'static str,
    name: ElementName,
    nodes: NodeNames<'a>,
    material: &'a str,
    #[serde(skip_serializing_if = "Option::is_none")]
    plane: Option<PlaneState>,
    #[serde(skip_serializing_if = "Option::is_none")]
    thickness: Option<f64>,
}

impl Serialize for ElementEntries<'_> {
    fn serialize<S: Serializer>(&self, serializer: S) -> Result<S::Ok, S::Error> {
        let model = self.0;
        let elements = &model.mesh.elements;
        let parts = elements.plane_states.iter().zip(&elements.sections).zip(elements.nodes.iter());
        let entries = elements.shapes.iter().zip(&elements.labels).zip(parts).enumerate().map(
            |(place, ((shape, label), ((plane_state, section), nodes)))| {
                let plane = plane_state.or(model.plane_state).filter(|_| model.dimension == 2);
                let section: Option<&MeshSection> =
                    section.and_then(|section| model.mesh.sections.get(section as usize));
                let has_thickness = model.dimension == 2 && plane != Some(PlaneState::Axisymmetric);
                SolidEntry {
                    kind: shape.name(),
                    name: ElementName(*label),
                    nodes: NodeNames(model, nodes),
                    material: model.material_names.of(place),
                    plane,
                    thickness: section.and_then(|section| section.thickness).filter(|_| has_thickness),
                }
            },
        );
        serializer.collect_seq(entries)
    }
}

/// A surface: `{"faces": [["1", "2"], ...]}`.
#[derive(Debug, Serialize)]
struct SurfaceEntry<'a> {
    faces: Vec<NodeNames<'a>>,
}

impl<'a> SurfaceEntry<'a> {
    /// The faces whose nodes are all in the model.
    fn new(model: &'a ConvertedModel<'a>, faces: &'a NodeLists) -> Self {
        let faces = faces.iter().filter(|face| model.used(face).count() == face.len());
        Self { faces: faces.map(|face| NodeNames(model, face)).collect() }
    }
}
