//! Physical groups become sets.

use crate::model::mesh::data::draft::MeshDraft;
use crate::model::mesh::data::error::{MeshError, MeshPlace};
use crate::model::mesh::data::label_index::LabelIndex;
use crate::model::mesh::data::member_budget::MemberBudget;
use crate::model::mesh::data::mesh_data::{MeshData, MeshElements};
use crate::model::mesh::gmsh::found::{GmshContents, GroupRun, repeated};
use indexmap::IndexMap;
use std::collections::HashMap;

/// Names of geometrical entities by dimension, for groups without a name.
const ENTITIES: [&str; 4] = ["point", "curve", "surface", "volume"];

/// What the note that a run is in a group counts as, in members.
const MEMBERS_OF_RUN: usize = 16;

/// The mesh of what was found. In files of version 2 an element that is in several groups is there several times.
///
/// # Errors
/// An element is given twice, or there is none, or groups have too many members.
pub fn mesh(mut found: GmshContents, may_repeat: bool, bytes: usize) -> Result<MeshData, MeshError> {
    if found.elements.is_empty() {
        return Err(MeshError::new(MeshPlace::File, "there is no element"));
    }
    let count = u32::try_from(found.elements.len()).map_err(|_| repeated(&[], 0, "element", MeshPlace::File))?;
    let mut places: Vec<u32> = (0..count).collect();
    let mut merged = 0;
    if may_repeat {
        (found.elements, places, merged) = merge_repeated(std::mem::take(&mut found.elements));
    }
    let mut draft = MeshDraft::default();
    let mut budget = MemberBudget::new(bytes);
    let mut stamps = vec![0_u32; found.node_labels.len()];
    for (stamp, (name, runs)) in (1..).zip(runs_by_group(&found, &mut budget)?) {
        let members = members(&runs, &places, &mut budget)?;
        let nodes = nodes_of(&members, &found.elements, &mut stamps, stamp);
        budget.take(nodes.len(), MeshPlace::File)?;
        draft.mesh.node_sets.insert(name.clone(), nodes);
        draft.cell_sets.insert(name, members);
    }
    draft.mesh.node_labels = found.node_labels;
    draft.mesh.coordinates = found.coordinates;
    draft.mesh.elements = found.elements;
    draft.mesh.unread = found.unread;
    if merged > 0 {
        let what = "elements are there again for a further group: they are read as one each";
        draft.mesh.remarks.push(format!("{merged} {what}"));
    }
    let mesh = draft.finish();
    let labels = &mesh.elements.labels;
    LabelIndex::new(labels).map_err(|second| repeated(labels, second, "element", MeshPlace::File))?;
    Ok(mesh)
}

/// Elements of the same kind and nodes as one; for every old element its new place; how many have gone.
fn merge_repeated(all: MeshElements) -> (MeshElements, Vec<u32>, usize) {
    let mut first = HashMap::with_capacity(all.len());
    let mut elements = MeshElements::default();
    let mut places = Vec::with_capacity(all.len());
    for ((shape, label), nodes) in all.shapes.iter().zip(&all.labels).zip(all.nodes.iter()) {
        let next = u32::try_from(elements.len()).unwrap_or(u32::MAX);
        let place = *first.entry((*shape, nodes)).or_insert(next);
        if place == next {
            elements.push(*shape, *label, nodes.iter().copied(), None);
        }
        places.push(place);
    }
    let merged = all.len() - elements.len();
    // Without repetitions the elements as they were found are as good.
    drop(first);
    if merged == 0 { (all, places, 0) } else { (elements, places, merged) }
}

/// The runs of elements of each group, by its name.
fn runs_by_group(
    found: &GmshContents,
    budget: &mut MemberBudget,
) -> Result<IndexMap<String, Vec<GroupRun>>, MeshError> {
    let mut groups: IndexMap<(usize, i64), Vec<GroupRun>> = IndexMap::new();
    for run in &found.runs {
        match &found.entities {
            Some(entities) => {
                for tag in entities.get(&(run.dimension, run.tag)).into_iter().flatten() {
                    budget.take(MEMBERS_OF_RUN, MeshPlace::File)?;
                    // A negative tag stands for the entity in the other sense.
                    groups.entry((run.dimension, tag.saturating_abs())).or_default().push(*run);
                }
            }
            None if run.tag != 0 => {
                groups.entry((run.dimension, run.tag.saturating_abs())).or_default().push(*run);
            }
            None => {}
        }
    }
    let mut by_name: IndexMap<String, Vec<GroupRun>> = IndexMap::new();
    for ((dimension, tag), runs) in groups {
        let entity = ENTITIES.get(dimension).copied().unwrap_or_default();
        let name = found.names.get(&(dimension, tag)).cloned().unwrap_or_else(|| format!("{entity}_group_{tag}"));
        by_name.entry(name).or_default().extend(runs);
    }
    Ok(by_name)
}

/// The elements of runs, ascending.
fn members(runs: &[GroupRun], places: &[u32], budget: &mut MemberBudget) -> Result<Vec<u32>, MeshError> {
    budget.take(runs.iter().map(|run| run.count).sum(), MeshPlace::File)?;
    let mut members: Vec<u32> = runs
        .iter()
        .flat_map(|run| places.get(run.first..run.first + run.count).unwrap_or_default().iter().copied())
        .collect();
    members.sort_unstable();
    members.dedup();
    Ok(members)
}

/// The nodes of elements, ascending. `stamps` has the last set that each node was found in.
fn nodes_of(members: &[u32], elements: &MeshElements, stamps: &mut [u32], stamp: u32) -> Vec<u32> {
    let mut nodes = Vec::new();
    for member in members {
        for node in elements.nodes.get(*member as usize) {
            if let Some(last) = stamps.get_mut(*node as usize).filter(|last| **last != stamp) {
                *last = stamp;
                nodes.push(*node);
            }
        }
    }
    nodes.sort_unstable();
    nodes
}
