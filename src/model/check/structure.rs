//! Checks nodes, supports and elements.

use crate::model::check::beams;
use crate::model::check::loads;
use crate::model::check::scope::numbers::{self, difference, largest, norm};
use crate::model::check::scope::{Scope, proper_name};
use crate::model::check::solids;
use crate::model::input::limits::{COINCIDENCE_TOLERANCE, SYMMETRY_TOLERANCE};
use crate::model::input::mistakes::{DocumentPlace, Mistakes};
use crate::model::input::names::quoted;
use crate::model::request::{Component, Element, Model};
use std::collections::HashMap;

pub(super) fn nodes(scope: &Scope, mistakes: &mut Mistakes) {
    let at = scope.at.member("nodes");
    if scope.model.nodes.is_empty() {
        mistakes.add(&at, || "there are no nodes; at least one is expected");
    }
    for (name, position) in &scope.model.nodes {
        let at = at.member(name);
        proper_name(name, &at, mistakes);
        if name.starts_with('@') {
            mistakes.add(&at, || {
                format!("found {}; a name without `@` at its start is expected: that names sets", quoted(name))
            });
        }
        numbers::vector(position, scope.model.dimension, &at, mistakes);
    }
}

pub(super) fn supports(scope: &Scope, mistakes: &mut Mistakes) {
    let at = scope.at.member("supports");
    for (name, components) in &scope.model.supports {
        let at = at.member(name);
        let node = scope.node(name, &at, mistakes);
        if components.is_empty() {
            mistakes.add(&at, || "no component is named; name one or more, or leave the support out");
        }
        for (index, &held) in components.iter().enumerate() {
            let at = at.index(index);
            let known = component(held, scope.model.dimension, &at, mistakes);
            if let (true, true, Some(node)) = (held.is_rotation(), known, node) {
                loads::rotation(scope, node, name, &at, mistakes);
            }
            if components.iter().take(index).any(|&earlier| earlier == held) {
                mistakes.add(&at, || format!("the component {} is named twice", component_name(held)));
            }
        }
    }
}

/// Notes a component that the dimension does not have.
pub(super) fn component(component: Component, dimension: usize, at: &DocumentPlace, mistakes: &mut Mistakes) -> bool {
    let known = component.is_in(dimension);
    if !known {
        let name = component_name(component);
        let others = if dimension == 2 { "`x`, `y` or `rz`" } else { "`x`, `y` or `z`" };
        mistakes.add(at, || format!("there is no component {name} in {dimension} dimensions; {others} would do"));
    }
    known
}

/// Requests from JSON are expanded; models in code are where their user asks for it.
const UNEXPANDED: &str =
    "this names a part of a mesh, or a set or surface; `expanded` puts the parts in place of names first";

/// Notes what only the expansion of the request reads.
pub(super) fn unexpanded(model: &Model, at: &DocumentPlace, mistakes: &mut Mistakes) {
    if model.mesh.is_some() {
        mistakes.add(&at.member("mesh"), || UNEXPANDED);
    }
    for (name, _) in model.surfaces.iter().filter(|(_, surface)| surface.group.is_some()) {
        mistakes.add(&at.member("surfaces").member(name).member("group"), || UNEXPANDED);
    }
    for (index, _) in model.contacts.iter().enumerate().filter(|(_, contact)| contact.names_whole_surface()) {
        mistakes.add(&at.member("contacts").index(index).member("surface"), || UNEXPANDED);
    }
}

/// By index of the component.
pub(super) const COMPONENT_NAMES: [&str; 6] = ["`x`", "`y`", "`z`", "`rx`", "`ry`", "`rz`"];

pub(super) fn component_name(component: Component) -> &'static str {
    COMPONENT_NAMES[component.index()]
}

pub(super) fn elements(scope: &Scope, mistakes: &mut Mistakes) {
    let at = scope.at.member("elements");
    let mut named: HashMap<&str, usize> = HashMap::new();
    for (index, element) in scope.model.elements.iter().enumerate() {
        let at = at.index(index);
        if let Some(name) = element.name() {
            element_name(name, &at.member("name"), mistakes);
            if let Some(first) = named.get(name) {
                mistakes.add(&at.member("name"), || {
                    format!("element {first} has the name {}, too; each name is to be given once", quoted(name))
                });
            }
            named.entry(name).or_insert(index);
        }
        match element {
            Element::Bar { nodes, axial_stiffness, rest_length, prestress, strain: _, name: _ } => {
                bar_nodes(scope, nodes, &at, mistakes);
                numbers::positive(*axial_stiffness, &at.member("axial_stiffness"), mistakes);
                if let Some(rest_length) = *rest_length {
                    numbers::positive(rest_length, &at.member("rest_length"), mistakes);
                }
                numbers::number(*prestress, &at.member("prestress"), mistakes);
            }
            Element::Spring { nodes, stiffness, name: _ } => {
                if !matches!(nodes.len(), 1 | 2) {
                    let found = nodes.len();
                    let detail = move || format!("found {found} nodes; a spring has 1 (to the ground) or 2");
                    mistakes.add(&at.member("nodes"), detail);
                }
                distinct_nodes(scope, nodes, 2, &at, mistakes);
                symmetric(stiffness, scope.model.dimension, &at.member("stiffness"), mistakes);
            }
            Element::Beam { .. } => beams::beam(scope, element, &at, mistakes),
            Element::RotationalSpring { nodes, stiffness, name: _ } => {
                beams::plane("a rotational spring", scope, &at, mistakes);
                if !matches!(nodes.len(), 1 | 2) {
                    let found = nodes.len();
                    let detail = move || format!("found {found} nodes; a rotational spring has 1 (to the ground) or 2");
                    mistakes.add(&at.member("nodes"), detail);
                }
                distinct_nodes(scope, nodes, 2, &at, mistakes);
                numbers::positive(*stiffness, &at.member("stiffness"), mistakes);
            }
            Element::Solid(_) => mistakes.add(&at, || UNEXPANDED),
            _ => {
                if let Some((kind, solid)) = element.solid() {
                    solids::solid(scope, kind, solid, &at, mistakes);
                }
            }
        }
    }
}

/// Digits alone are the place of an element, in results as in `analysis.record`.
fn element_name(name: &str, at: &DocumentPlace, mistakes: &mut Mistakes) {
    if !name.is_empty() && name.bytes().all(|byte| byte.is_ascii_digit()) {
        mistakes.add(at, || {
            format!("found {}; a name with a letter is expected: digits alone are an element's place", quoted(name))
        });
    } else {
        proper_name(name, at, mistakes);
    }
}

fn bar_nodes(scope: &Scope, nodes: &[String], at: &DocumentPlace, mistakes: &mut Mistakes) {
    let found = distinct_nodes(scope, nodes, 2, at, mistakes);
    let at = at.member("nodes");
    if nodes.len() != 2 {
        mistakes.add(&at, || format!("found {} nodes; a bar has 2", nodes.len()));
    }
    let Some([first, second]) = found.as_deref() else { return };
    if let (Some(start), Some(end)) = (scope.position(*first), scope.position(*second)) {
        let length = norm(&difference(end, start));
        if length <= COINCIDENCE_TOLERANCE * largest(start).max(largest(end)) {
            mistakes.add(&at, || {
                format!("the bar has length {length:?}: its nodes are at the same place; a length above 0 is expected")
            });
        }
    }
}

/// The numbers of the nodes if all are known and none occurs twice. Beyond the number that an element of its kind has at
/// most, a list is not checked.
pub(super) fn distinct_nodes(
    scope: &Scope,
    names: &[String],
    most: usize,
    at: &DocumentPlace,
    mistakes: &mut Mistakes,
) -> Option<Vec<usize>> {
    let at = at.member("nodes");
    let before = mistakes.count();
    let mut found = Vec::with_capacity(names.len());
    for (index, name) in names.iter().enumerate().take(most) {
        let at = at.index(index);
        found.extend(scope.node(name, &at, mistakes));
        if names.iter().take(index).any(|earlier| earlier == name) {
            mistakes.add(&at, || format!("the node {} stands twice; two different nodes are expected", quoted(name)));
        }
    }
    (mistakes.count() == before).then_some(found)
}

fn symmetric(matrix: &[Vec<f64>], dimension: usize, at: &DocumentPlace, mistakes: &mut Mistakes) {
    let before = mistakes.count();
    if matrix.len() != dimension {
        let found = matrix.len();
        mistakes.add(at, || format!("found {found} rows; {dimension} rows of {dimension} numbers are expected"));
    }
    for (index, row) in matrix.iter().enumerate() {
        numbers::vector(row, dimension, &at.index(index), mistakes);
    }
    if mistakes.count() > before {
        return;
    }
    let scale = matrix.iter().map(|row| largest(row)).fold(0.0, f64::max);
    if scale == 0.0 {
        mistakes.add(at, || "the stiffness is zero: the spring does nothing; leave it out");
    }
    for (index, row) in matrix.iter().enumerate() {
        for (column, (&value, across)) in row.iter().zip(matrix).enumerate().take(index) {
            let mirrored = across.get(index).copied().unwrap_or_default();
            if (value - mirrored).abs() > SYMMETRY_TOLERANCE * scale {
                let row_at = at.index(index);
                mistakes.add(&row_at.index(column), || {
                    format!("found {value:?}, and {mirrored:?} across the diagonal; a symmetric matrix is expected")
                });
            }
        }
    }
}
