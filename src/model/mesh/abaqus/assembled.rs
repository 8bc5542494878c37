//! The mesh of what a deck defines.

use crate::model::mesh::abaqus::deck;
use crate::model::mesh::abaqus::definitions::{Definitions, SectionDefinition, SurfaceDefinition};
use crate::model::mesh::abaqus::set_members::{Population, ResolvedSets};
use crate::model::mesh::data::draft::MeshDraft;
use crate::model::mesh::data::element_shape::ElementShape;
use crate::model::mesh::data::error::{MeshError, MeshPlace};
use crate::model::mesh::data::label_index::LabelIndex;
use crate::model::mesh::data::member_budget::MemberBudget;
use crate::model::mesh::data::mesh_data::{MeshData, MeshElements, MeshSection};
use crate::model::mesh::data::node_lists::NodeLists;
use std::collections::HashSet;

/// Reads the mesh of a deck.
///
/// # Errors
/// The first mistake, with its line.
pub fn read(bytes: &[u8]) -> Result<MeshData, MeshError> {
    let mut found = deck::definitions(bytes)?;
    let mut budget = MemberBudget::new(bytes.len());
    let node_index = LabelIndex::new(&found.node_labels).map_err(|second| repeated_node(&found, second))?;
    let mut elements = elements(&found, &node_index)?;
    found.element_blocks.iter_mut().for_each(|block| block.nodes = Vec::new());
    let element_index = LabelIndex::new(&elements.labels).map_err(|second| repeated_element(&found, second))?;
    let labels = elements.labels.clone();
    let nodes = Population { what: "node", labels: &found.node_labels, index: &node_index, left_out: &HashSet::new() };
    let node_sets = ResolvedSets::new(nodes, &found.node_sets, &mut budget)?;
    let population =
        Population { what: "element", labels: &labels, index: &element_index, left_out: &found.other_elements };
    let element_sets = ResolvedSets::new(population, &found.element_sets, &mut budget)?;
    let mut draft = MeshDraft::default();
    for section in &found.sections {
        assign(section, &element_sets, &mut elements, &mut draft.mesh.sections, &mut budget)?;
    }
    let dimension = elements.shapes.iter().map(|shape| shape.dimension()).max().unwrap_or(0);
    let mut surface_nodes = Vec::new();
    for surface in &found.surfaces {
        if surface.of_nodes {
            surface_nodes.push((surface.name.clone(), nodes_of(surface, &node_sets, &mut budget)?));
        } else {
            let faces = draft.mesh.surfaces.entry(surface.name.clone()).or_default();
            add_faces(surface, &element_sets, &elements, dimension, faces, &mut budget)?;
        }
    }
    draft.cell_sets = element_sets.named();
    draft.mesh.node_sets = node_sets.named();
    for (name, nodes) in surface_nodes {
        let name = if draft.mesh.node_sets.contains_key(&name) { format!("surface.{name}") } else { name };
        draft.mesh.node_sets.insert(name, nodes);
    }
    Ok(finish(draft, found, elements))
}

/// Fills in what remains.
fn finish(mut draft: MeshDraft, found: Definitions, elements: MeshElements) -> MeshData {
    let count = |dimension| elements.shapes.iter().filter(|shape| shape.dimension() == dimension).count();
    let (plane, space) = (count(2), count(3));
    if plane > 0 && space > 0 {
        let what = "plane elements beside solids in space are taken as faces of the surfaces named as their sets";
        draft.mesh.remarks.push(format!("{plane} {what}"));
    }
    draft.mesh.node_labels = found.node_labels;
    draft.mesh.coordinates = found.coordinates;
    draft.mesh.elements = elements;
    draft.mesh.materials = found.materials;
    draft.mesh.unread = found.unread;
    draft.finish()
}

/// The elements with nodes by place.
fn elements(found: &Definitions, index: &LabelIndex) -> Result<MeshElements, MeshError> {
    let mut elements = MeshElements::default();
    for block in &found.element_blocks {
        let lists = block.nodes.chunks_exact(block.shape.nodes());
        elements.nodes.reserve(block.labels.len(), block.nodes.len());
        for (label, list) in block.labels.iter().zip(lists) {
            let mut nodes = [0_u32; ElementShape::MOST_NODES];
            for (place, node) in list.iter().enumerate() {
                let Some(found) = index.get(*node) else {
                    let detail = format!("element {label} has node {node}, which is not in the deck");
                    return Err(MeshError::new(block.place, detail));
                };
                if nodes.iter().take(place).any(|other| *other == found) {
                    let detail = format!("element {label} has node {node} twice; collapsed elements are not read");
                    return Err(MeshError::new(block.place, detail));
                }
                if let Some(entry) = nodes.get_mut(place) {
                    *entry = found;
                }
            }
            elements.push(block.shape, *label, nodes.into_iter().take(list.len()), block.plane_state);
        }
    }
    Ok(elements)
}

fn repeated_node(found: &Definitions, second: usize) -> MeshError {
    let place = found.node_blocks.iter().rev().find(|(_, first)| *first <= second).map(|(place, _)| *place);
    repeated("node", &found.node_labels, second, place)
}

fn repeated_element(found: &Definitions, second: usize) -> MeshError {
    let mut before = 0;
    for block in &found.element_blocks {
        if second < before + block.labels.len() {
            return repeated("element", &block.labels, second - before, Some(block.place));
        }
        before += block.labels.len();
    }
    repeated("element", &[], 0, None)
}

fn repeated(what: &str, labels: &[u64], second: usize, place: Option<MeshPlace>) -> MeshError {
    let place = place.unwrap_or(MeshPlace::File);
    match labels.get(second) {
        Some(label) => MeshError::new(place, format!("{what} {label} is given twice, the second time here")),
        None => MeshError::new(place, format!("too many: at most {} of a kind", u32::MAX - 1)),
    }
}

/// Gives a section's elements their material.
fn assign(
    section: &SectionDefinition,
    sets: &ResolvedSets,
    elements: &mut MeshElements,
    sections: &mut Vec<MeshSection>,
    budget: &mut MemberBudget,
) -> Result<(), MeshError> {
    let Some(members) = sets.get(section.scope, &section.element_set) else {
        let detail = format!("there is no set of elements `{}`", section.element_set);
        return Err(MeshError::new(section.place, detail));
    };
    budget.take(members.len(), section.place)?;
    let number = u32::try_from(sections.len()).ok();
    sections.push(MeshSection { material: section.material.clone(), thickness: section.thickness });
    for member in members.iter().filter_map(|member| usize::try_from(*member).ok()) {
        if let Some(entry) = elements.sections.get_mut(member) {
            if entry.is_some() {
                let label = elements.labels.get(member).copied().unwrap_or_default();
                return Err(MeshError::new(section.place, format!("element {label} has a section already")));
            }
            *entry = number;
        }
    }
    Ok(())
}

/// The nodes of a surface of nodes, ascending.
fn nodes_of(
    surface: &SurfaceDefinition,
    sets: &ResolvedSets,
    budget: &mut MemberBudget,
) -> Result<Vec<u32>, MeshError> {
    let mut nodes = Vec::new();
    for row in &surface.rows {
        sets.extend(&mut nodes, &row.members, surface.scope, row.place, budget)?;
    }
    nodes.sort_unstable();
    nodes.dedup();
    Ok(nodes)
}

/// Adds the faces of a surface to a list; `dimension` is that of the solids.
fn add_faces(
    surface: &SurfaceDefinition,
    sets: &ResolvedSets,
    elements: &MeshElements,
    dimension: usize,
    faces: &mut NodeLists,
    budget: &mut MemberBudget,
) -> Result<(), MeshError> {
    for row in &surface.rows {
        let mut members = Vec::new();
        sets.extend(&mut members, &row.members, surface.scope, row.place, budget)?;
        for member in members.into_iter().filter_map(|member| usize::try_from(member).ok()) {
            let shape = elements.shapes.get(member).filter(|shape| shape.dimension() == dimension);
            let number = row.face.unwrap_or_default();
            let face = shape.and_then(|shape| shape.faces().get(number.checked_sub(1)?));
            let Some(face) = face else {
                let label = elements.labels.get(member).copied().unwrap_or_default();
                return Err(MeshError::new(row.place, format!("element {label} has no face S{number}")));
            };
            budget.take(face.len(), row.place)?;
            let nodes = elements.nodes.get(member);
            faces.push(face.iter().filter_map(|local| nodes.get(*local).copied()));
        }
    }
    Ok(())
}
