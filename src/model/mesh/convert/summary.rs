//! What a conversion tells its user.

use crate::model::mesh::convert::ConvertedModel;
use crate::model::mesh::data::mesh_data::DeckLaw;
use indexmap::IndexMap;

/// Names listed in a line at most.
const MOST_NAMES: usize = 20;

/// What is in the model, what was changed, what was not read, and what has to be added, a line each.
pub fn lines(model: &ConvertedModel) -> Vec<String> {
    let mesh = model.mesh;
    let mut lines = vec![counts(model)];
    let unused = model.is_used.iter().filter(|is_used| !**is_used).count();
    if unused > 0 {
        lines.push(format!("{unused} nodes have no element and are left out"));
    }
    lines.extend(mesh.remarks.iter().cloned());
    lines.extend(mesh.unread.lines());
    let missing: Vec<&str> = model.material_names.missing(mesh).collect();
    if !missing.is_empty() {
        lines.push(format!("add to `materials`: {}", listed(&missing)));
    }
    let has = |is_kind: fn(&DeckLaw) -> bool| {
        mesh.materials.values().any(|material| material.law.as_ref().is_some_and(is_kind))
    };
    if has(|law| matches!(law, DeckLaw::LinearElastic { .. })) {
        lines.push("*ELASTIC is linear_elastic, for small strains; saint_venant_kirchhoff also turns far".to_owned());
    }
    if has(|law| matches!(law, DeckLaw::NeoHookean { .. })) {
        lines.push("NEO HOOKE is neo_hookean with the same moduli in small strains".to_owned());
    }
    let is_open =
        model.dimension == 2 && model.plane_state.is_none() && mesh.elements.plane_states.iter().any(Option::is_none);
    if is_open {
        lines.push("add `plane` to the elements: the file does not tell it; see --plane".to_owned());
    }
    lines
}

fn counts(model: &ConvertedModel) -> String {
    let mesh = model.mesh;
    let mut shapes: IndexMap<&str, usize> = IndexMap::new();
    for shape in &mesh.elements.shapes {
        *shapes.entry(shape.name()).or_default() += 1;
    }
    let elements: Vec<String> = shapes.iter().map(|(shape, count)| format!("{count} {shape}")).collect();
    let nodes = model.is_used.iter().filter(|is_used| **is_used).count();
    let is_set = |name: &&String| !mesh.surfaces.contains_key(*name);
    let node_sets = mesh.node_sets.keys().filter(is_set).count();
    let other_sets = mesh.element_sets.keys().filter(is_set).filter(|name| !mesh.node_sets.contains_key(*name)).count();
    format!(
        "{nodes} nodes, {}; {} sets, {} surfaces, {} materials",
        elements.join(", "),
        node_sets + other_sets,
        mesh.surfaces.len(),
        mesh.materials.values().filter(|material| material.law.is_some()).count()
    )
}

fn listed(names: &[&str]) -> String {
    let mut text: Vec<String> = names.iter().take(MOST_NAMES).map(|name| format!("`{name}`")).collect();
    if names.len() > MOST_NAMES {
        text.push(format!("and {} more", names.len() - MOST_NAMES));
    }
    text.join(", ")
}
