//! A mesh within a request: its nodes, elements, sets and surfaces take the place of what names them.
//!
//! A model is expanded once, after it is read: checks, solver and results know nodes and elements alone.

use crate::mechanics::structure::elements::solid::shapes::kind::SolidKind;
use crate::model::decode::reader::{Choices, Fields, Input, text};
use crate::model::decode::solids::{SolidOptions, solid_options};
use crate::model::input::limits::{MAX_ELEMENTS, MAX_NODES};
use crate::model::input::mistakes::{DocumentPlace, Mistakes};
use crate::model::input::names::{quoted, suggestion};
use crate::model::mesh::convert::check_flat;
use crate::model::mesh::data::element_shape::ElementShape;
use crate::model::mesh::data::mesh_data::{DeckLaw, DeckMaterial, MeshData, PlaneState};
use crate::model::mesh::data::node_lists::NodeLists;
use crate::model::request::{
    ContentEncoding, ElasticConstants, Element, Material, MeshFile, MeshFormat, MeshGroup, Model, NamedSet,
    PlaneCondition, Solid, Surface,
};
use crate::model::solids::faces::{FaceMatch, surface_faces};
use base64::Engine;
use base64::engine::general_purpose::STANDARD;
use std::borrow::Cow;

const MESH: Fields = Fields { what: "a mesh", known: &["format", "content", "encoding", "file"], later: &[] };

const GROUP: Fields = Fields {
    what: "the solids of a group",
    known: &["kind", "group", "material", "plane", "thickness", "locking"],
    later: &[],
};

const FORMAT: Choices<MeshFormat> = Choices {
    what: "a format of meshes",
    known: &[("gmsh", MeshFormat::Gmsh), ("abaqus", MeshFormat::Abaqus)],
    later: &[],
};

const ENCODING: Choices<ContentEncoding> = Choices {
    what: "an encoding",
    known: &[("text", ContentEncoding::Text), ("base64", ContentEncoding::Base64)],
    later: &[],
};

pub(super) fn mesh(input: &Input, mistakes: &mut Mistakes) -> Option<MeshFile> {
    let object = input.object(&MESH, mistakes)?;
    let format = object.optional("format", mistakes, |input, mistakes| input.choice(&FORMAT, mistakes));
    let content = object.optional("content", mistakes, text);
    let encoding = object.optional("encoding", mistakes, |input, mistakes| input.choice(&ENCODING, mistakes));
    let file = object.optional("file", mistakes, text);
    Some(MeshFile { format: format?, content: content?, encoding: encoding?, file: file? })
}

pub(super) fn group(input: &Input, mistakes: &mut Mistakes) -> Option<Element> {
    let object = input.object(&GROUP, mistakes)?;
    let group = object.optional("group", mistakes, text);
    let material = object.optional("material", mistakes, text);
    let SolidOptions { plane, thickness, locking } = solid_options(&object, mistakes)?;
    Some(Element::Solid(MeshGroup { group: group?, material: material?, plane, thickness, locking }))
}

/// Puts the parts of the mesh in place of what names them. Returns whether the model is whole.
pub(super) fn expand(model: &mut Model, mistakes: &mut Mistakes) -> bool {
    let at = DocumentPlace::ROOT.member("model");
    let before = mistakes.count();
    let Some(given) = model.mesh.take() else {
        refuse_groups(model, &at, mistakes);
        return mistakes.count() == before;
    };
    let Some(data) = read(&given, &at.member("mesh"), mistakes) else { return false };
    if let Some(mut parts) = MeshParts::new(&data, model.dimension, &at.member("mesh"), mistakes) {
        parts.add_elements(model, &at.member("elements"), mistakes);
        parts.add_nodes(model, &at.member("nodes"), mistakes);
        parts.add_materials(model);
        parts.add_sets(model);
        parts.add_surfaces(model, &at.member("surfaces"), mistakes);
    }
    mistakes.count() == before
}

/// Notes what names parts of a mesh where there is none.
fn refuse_groups(model: &Model, at: &DocumentPlace, mistakes: &mut Mistakes) {
    let detail = || "this is a part of a mesh, and the model has none; give it as `mesh`";
    for (index, element) in model.elements.iter().enumerate() {
        if matches!(element, Element::Solid(_)) {
            mistakes.add(&at.member("elements").index(index), detail);
        }
    }
    for (name, surface) in &model.surfaces {
        if surface.group.is_some() {
            mistakes.add(&at.member("surfaces").member(name).member("group"), detail);
        }
    }
}

fn read(given: &MeshFile, at: &DocumentPlace, mistakes: &mut Mistakes) -> Option<MeshData> {
    let Some(content) = &given.content else {
        mistakes.add(at, || match given.file {
            Some(_) => "files are opened by the command line alone; put the text of the file into `content`",
            None => "`content`, the text of a mesh file, is missing",
        });
        return None;
    };
    if given.file.is_some() {
        mistakes.add(&at.member("file"), || "`content` is given, too; one of the two is expected");
        return None;
    }
    let at = at.member("content");
    let bytes: Cow<[u8]> = match given.encoding.unwrap_or(ContentEncoding::Text) {
        ContentEncoding::Text => Cow::Borrowed(content.as_bytes()),
        ContentEncoding::Base64 => match STANDARD.decode(content) {
            Ok(bytes) => Cow::Owned(bytes),
            Err(error) => {
                mistakes.add(&at, || format!("the content is not in base 64: {error}"));
                return None;
            }
        },
    };
    let format = match given.format {
        Some(format) => Ok(format),
        None => MeshFormat::of(&bytes),
    };
    match format.and_then(|format| format.read(&bytes)) {
        Ok(data) => Some(data),
        Err(error) => {
            mistakes.add(&at, || error.to_string());
            None
        }
    }
}

/// A mesh, and which parts of it the model has.
struct MeshParts<'a> {
    data: &'a MeshData,
    dimension: usize,
    has_node: Vec<bool>,
    has_element: Vec<bool>,
}

impl<'a> MeshParts<'a> {
    fn new(data: &'a MeshData, dimension: usize, at: &DocumentPlace, mistakes: &mut Mistakes) -> Option<Self> {
        let (nodes, elements) = (data.node_labels.len(), data.elements.len());
        let refusal = if nodes > MAX_NODES {
            Some(format!("the mesh has {nodes} nodes; at most {MAX_NODES} are taken"))
        } else if elements > MAX_ELEMENTS {
            Some(format!("the mesh has {elements} elements; at most {MAX_ELEMENTS} are taken"))
        } else if elements == 0 {
            Some("the mesh has no triangles, quadrilaterals, tetrahedra or hexahedra".to_owned())
        } else if data.dimension() != dimension {
            let found = data.dimension();
            Some(format!(
                "the mesh has solids of {found} dimensions, the model has {dimension}; one number is expected"
            ))
        } else {
            None
        };
        if let Some(refusal) = refusal {
            mistakes.add(at, || refusal);
            return None;
        }
        Some(Self { data, dimension, has_node: vec![false; nodes], has_element: vec![false; elements] })
    }

    fn node_name(&self, node: u32) -> String {
        self.data.node_labels.get(node as usize).map(ToString::to_string).unwrap_or_default()
    }

    fn element_name(&self, element: usize) -> String {
        format!("e{}", self.data.elements.labels[element])
    }

    fn add_elements(&mut self, model: &mut Model, at: &DocumentPlace, mistakes: &mut Mistakes) {
        let mut all = Vec::with_capacity(model.elements.len());
        let mut names_the_mesh = false;
        for (index, element) in std::mem::take(&mut model.elements).into_iter().enumerate() {
            let Element::Solid(group) = element else {
                all.push(element);
                continue;
            };
            names_the_mesh = true;
            let at = at.index(index);
            let Some(members) = self.members(group.group.as_deref(), &at, mistakes) else { continue };
            for member in members {
                if std::mem::replace(&mut self.has_element[member], true) {
                    let name = self.element_name(member);
                    mistakes
                        .add(&at, || format!("the element {name} of the mesh is in another group, too; one has it"));
                    break;
                }
                match self.solid(member, &group) {
                    Some(solid) => all.push(solid),
                    None => {
                        mistakes.add(&at, || "`material` is missing: the mesh file does not tell it");
                        break;
                    }
                }
            }
        }
        model.elements = all;
        if !names_the_mesh {
            let example = "`{\"kind\": \"solid\", \"material\": \"rubber\"}` among them";
            mistakes.add(at, || format!("no element is made of the mesh; {example} takes all of its elements"));
        }
    }

    /// The elements of a group; all of them where none is named.
    fn members(&self, group: Option<&str>, at: &DocumentPlace, mistakes: &mut Mistakes) -> Option<Vec<usize>> {
        let Some(group) = group else { return Some((0..self.data.elements.len()).collect()) };
        let Some(members) = self.data.element_sets.get(group) else {
            mistakes.add(&at.member("group"), || {
                let known = suggestion(group, self.data.element_sets.keys().map(String::as_str));
                format!("the mesh has no group of elements {}{known}", quoted(group))
            });
            return None;
        };
        Some(members.iter().map(|member| *member as usize).filter(|member| *member < self.has_element.len()).collect())
    }

    /// An element as a solid; `None` where nothing tells its material.
    fn solid(&mut self, element: usize, group: &MeshGroup) -> Option<Element> {
        let elements = &self.data.elements;
        let section = elements.sections[element].and_then(|section| self.data.sections.get(section as usize));
        let plane = elements.plane_states[element].map(|state| match state {
            PlaneState::Strain => PlaneCondition::Strain,
            PlaneState::Stress => PlaneCondition::Stress,
            PlaneState::Axisymmetric => PlaneCondition::Axisymmetric,
        });
        let plane = group.plane.or(plane).filter(|_| self.dimension == 2 || group.plane.is_some());
        let own_thickness = section.and_then(|section| section.thickness);
        let has_thickness = self.dimension == 2 && plane != Some(PlaneCondition::Axisymmetric);
        let nodes = elements.nodes.get(element);
        nodes.iter().for_each(|node| self.has_node[*node as usize] = true);
        let solid = Solid {
            nodes: nodes.iter().map(|node| self.node_name(*node)).collect(),
            material: group
                .material
                .clone()
                .or_else(|| section.map(|section| self.material_name(&section.material)))?,
            plane,
            thickness: group.thickness.or(own_thickness.filter(|_| has_thickness)),
            locking: group.locking,
            name: Some(self.element_name(element)),
        };
        Some(Element::of_solid(solid_kind(elements.shapes[element])?, solid))
    }

    /// The material as the deck writes it where it defines it: upper and lower case are alike there.
    fn material_name(&self, name: &str) -> String {
        let known = self.data.materials.keys().find(|known| known.eq_ignore_ascii_case(name));
        known.map_or(name, String::as_str).to_owned()
    }

    fn add_nodes(&self, model: &mut Model, at: &DocumentPlace, mistakes: &mut Mistakes) {
        if self.dimension == 2
            && let Err(error) = check_flat(self.data, &self.has_node)
        {
            mistakes.add(&DocumentPlace::ROOT.member("model").member("mesh"), || error.to_string());
        }
        let places = self.data.node_labels.iter().zip(&self.data.coordinates).zip(&self.has_node);
        for ((label, place), _) in places.filter(|(_, has_node)| **has_node) {
            let name = label.to_string();
            if model.nodes.contains_key(&name) {
                mistakes.add(&at.member(&name), || "the mesh has a node of this name, too; rename this one");
                continue;
            }
            model.nodes.insert(name, place[..self.dimension].to_vec());
        }
    }

    /// Adds the materials of the file that the model does not give itself.
    fn add_materials(&self, model: &mut Model) {
        for (name, material) in &self.data.materials {
            if let (false, Some(material)) = (model.materials.contains_key(name), request_material(material)) {
                model.materials.insert(name.clone(), material);
            }
        }
    }

    fn add_sets(&self, model: &mut Model) {
        let names = self.data.node_sets.keys().chain(self.data.element_sets.keys());
        for name in names {
            if model.sets.contains_key(name)
                || model.surfaces.contains_key(name)
                || self.data.surfaces.contains_key(name)
            {
                continue;
            }
            let nodes = self.data.node_sets.get(name).into_iter().flatten();
            let nodes = nodes.filter(|node| self.has_node.get(**node as usize) == Some(&true));
            let elements = self.data.element_sets.get(name).into_iter().flatten().map(|element| *element as usize);
            let elements = elements.filter(|element| self.has_element.get(*element) == Some(&true));
            let set = NamedSet {
                nodes: nodes.map(|node| self.node_name(*node)).collect(),
                elements: elements.map(|element| self.element_name(element)).collect(),
            };
            if !(set.nodes.is_empty() && set.elements.is_empty()) {
                model.sets.insert(name.clone(), set);
            }
        }
    }

    fn faces(&self, faces: &NodeLists) -> Vec<Vec<String>> {
        let has = |node: &u32| self.has_node.get(*node as usize) == Some(&true);
        let faces = faces.iter().filter(|face| face.iter().all(has));
        faces.map(|face| face.iter().map(|node| self.node_name(*node)).collect()).collect()
    }

    /// Gives the surfaces that name groups their faces, and adds those that are not named. A group of faces that are not
    /// all outer ones of solids is a set of nodes.
    fn add_surfaces(&self, model: &mut Model, at: &DocumentPlace, mistakes: &mut Mistakes) {
        for (name, surface) in &mut model.surfaces {
            let Some(group) = surface.group.take() else { continue };
            match self.data.surfaces.get(&group) {
                Some(faces) => surface.faces = self.faces(faces),
                None => mistakes.add(&at.member(name).member("group"), || {
                    let known = suggestion(&group, self.data.surfaces.keys().map(String::as_str));
                    format!("the mesh has no group of faces {}{known}", quoted(&group))
                }),
            }
        }
        let mut added = Vec::new();
        for (name, faces) in &self.data.surfaces {
            let faces = self.faces(faces);
            if !(faces.is_empty() || model.surfaces.contains_key(name) || model.sets.contains_key(name)) {
                model.surfaces.insert(name.clone(), Surface { faces, group: None });
                added.push(name);
            }
        }
        let is_outside = |faces: &Vec<FaceMatch>| faces.iter().all(|face| matches!(face, FaceMatch::Face(_)));
        let is_outside: Vec<bool> = surface_faces(model).iter().map(is_outside).collect();
        let inside: Vec<&String> = added
            .into_iter()
            .filter(|name| model.surfaces.get_index_of(*name).is_some_and(|place| !is_outside[place]))
            .collect();
        for name in inside {
            if let Some(surface) = model.surfaces.shift_remove(name) {
                let nodes: indexmap::IndexSet<String> = surface.faces.into_iter().flatten().collect();
                model.sets.insert(name.clone(), NamedSet { nodes: nodes.into_iter().collect(), elements: Vec::new() });
            }
        }
    }
}

fn solid_kind(shape: ElementShape) -> Option<SolidKind> {
    Some(match shape {
        ElementShape::Point | ElementShape::Segment2 | ElementShape::Segment3 => return None,
        ElementShape::Triangle3 => SolidKind::Triangle3,
        ElementShape::Triangle6 => SolidKind::Triangle6,
        ElementShape::Quadrilateral4 => SolidKind::Quadrilateral4,
        ElementShape::Quadrilateral8 => SolidKind::Quadrilateral8,
        ElementShape::Tetrahedron4 => SolidKind::Tetrahedron4,
        ElementShape::Tetrahedron10 => SolidKind::Tetrahedron10,
        ElementShape::Hexahedron8 => SolidKind::Hexahedron8,
        ElementShape::Hexahedron20 => SolidKind::Hexahedron20,
    })
}

/// A material of a deck; `None` where its law was not read.
fn request_material(given: &DeckMaterial) -> Option<Material> {
    let constants = |young: f64, poisson: f64| ElasticConstants { young, poisson, density: given.density };
    Some(match given.law? {
        DeckLaw::LinearElastic { young, poisson } => Material::LinearElastic(constants(young, poisson)),
        DeckLaw::NeoHookean { young, poisson } => Material::NeoHookean(constants(young, poisson)),
        DeckLaw::MooneyRivlin { c10, c01, bulk_modulus } => {
            Material::MooneyRivlin { c10, c01, bulk_modulus, density: given.density }
        }
    })
}
