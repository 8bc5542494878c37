//! What can only be judged on the whole request: names, shapes, magnitudes, geometry, loads, sizes.
//!
//! Everything here takes time linear in the model, except pairs of contacts on one node. Whether the structure is a
//! mechanism is judged here only by what is connected to what; the numbers are looked at where the tangent is at hand.

mod analysis;
mod contacts;
mod loads;
mod mechanism;
mod numbers;
mod obstacles;
mod stages;
mod structure;
mod study;

pub use study::study;

use super::limits::{
    MAX_CONTACTS, MAX_ELEMENTS, MAX_NAME_BYTES, MAX_NODES, MAX_OBSTACLES, MAX_STAGES, MAX_UNKNOWNS,
    PENETRATION_TOLERANCE,
};
use super::mistakes::{Mistakes, Place};
use super::names::{quoted, suggestion};
use super::request::Obstacle;
use super::{InputErrors, JobRequest, Model};

/// Refuses what cannot be solved; every mistake that can be told apart is listed.
///
/// Where the sizes pass the [limits](super::limits) or the dimension is neither 2 nor 3, nothing else of the model is
/// looked at.
///
/// # Errors
/// Never empty; each entry names its place, what was found and what would do.
pub fn check(request: &JobRequest) -> Result<(), InputErrors> {
    let mut mistakes = Mistakes::default();
    let at = Place::ROOT.member("model");
    if sizes(&request.model, &at, &mut mistakes) && dimension(&request.model, &at, &mut mistakes) {
        let free = model(&request.model, &at, &mut mistakes);
        analysis::unknowns_of_method(free, request.analysis.method, &mut mistakes);
        if let Some(record) = &request.analysis.record {
            let at = Place::ROOT.member("analysis");
            analysis::recorded(record, &request.model, &at.member("record"), &mut mistakes);
        }
    }
    analysis::analysis(&request.analysis, &Place::ROOT.member("analysis"), &mut mistakes);
    mistakes.into_result()
}

fn sizes(model: &Model, at: &Place, mistakes: &mut Mistakes) -> bool {
    let before = mistakes.count();
    let sizes = [
        ("nodes", model.nodes.len(), MAX_NODES),
        ("supports", model.supports.len(), MAX_NODES),
        ("elements", model.elements.len(), MAX_ELEMENTS),
        ("obstacles", model.obstacles.len(), MAX_OBSTACLES),
        ("contacts", model.contacts.len(), MAX_CONTACTS),
        ("stages", model.stages.len(), MAX_STAGES),
    ];
    for (field, found, limit) in sizes {
        if found > limit {
            mistakes.add(&at.member(field), || format!("found {found} {field}; at most {limit} are taken"));
        }
    }
    mistakes.count() == before
}

fn dimension(model: &Model, at: &Place, mistakes: &mut Mistakes) -> bool {
    let known = matches!(model.dimension, 2 | 3);
    if !known {
        mistakes.add(&at.member("dimension"), || format!("found {}; 2 or 3 is expected", model.dimension));
    }
    known
}

fn model(model: &Model, at: &Place, mistakes: &mut Mistakes) -> usize {
    if let Some(name) = &model.name {
        printable(name, &at.member("name"), mistakes);
    }
    let scope = Scope::new(model, *at);
    structure::nodes(&scope, mistakes);
    structure::supports(&scope, mistakes);
    structure::elements(&scope, mistakes);
    obstacles::obstacles(&scope, mistakes);
    contacts::contacts(&scope, mistakes);
    mechanism::mechanism(&scope, mistakes);
    stages::stages(&scope, mistakes);
    unknowns(&scope, mistakes)
}

/// Free displacement components.
fn unknowns(scope: &Scope, mistakes: &mut Mistakes) -> usize {
    let dimension = scope.model.dimension;
    let free: usize =
        scope.supported.iter().map(|held| held.iter().take(dimension).filter(|&&held| !held).count()).sum();
    if free > MAX_UNKNOWNS {
        mistakes.add(&scope.at.member("nodes"), || {
            format!(
                "the nodes have {free} free displacement components; at most {MAX_UNKNOWNS} are taken in this version"
            )
        });
    }
    free
}

/// The model with what several checks look up. Its dimension is 2 or 3; nothing else in it can be relied on.
struct Scope<'a> {
    model: &'a Model,
    at: Place<'a>,
    /// For each node, whether x, y, z are held.
    supported: Vec<[bool; 3]>,
    /// Diagonal of the box around the well-formed nodes; 0 for a single node.
    size: f64,
}

impl<'a> Scope<'a> {
    fn new(model: &'a Model, at: Place<'a>) -> Self {
        let mut supported = vec![[false; 3]; model.nodes.len()];
        for (name, components) in &model.supports {
            if let Some(held) = model.nodes.get_index_of(name).and_then(|node| supported.get_mut(node)) {
                for component in components {
                    held[component.index()] = true;
                }
            }
        }
        Self { model, at, supported, size: size(model) }
    }

    /// The node's number; an unknown name is noted.
    fn node(&self, name: &str, at: &Place, mistakes: &mut Mistakes) -> Option<usize> {
        let found = self.model.nodes.get_index_of(name);
        if found.is_none() {
            let known = || suggestion(name, self.model.nodes.keys().map(String::as_str));
            mistakes.add(at, || format!("there is no node {}{}", quoted(name), known()));
        }
        found
    }

    /// The obstacle and its number; an unknown name is noted.
    fn obstacle(&self, name: &str, at: &Place, mistakes: &mut Mistakes) -> Option<(usize, &'a Obstacle)> {
        let found = self.model.obstacles.get_full(name);
        if found.is_none() {
            let known = || suggestion(name, self.model.obstacles.keys().map(String::as_str));
            mistakes.add(at, || format!("there is no obstacle {}{}", quoted(name), known()));
        }
        found.map(|(number, _, obstacle)| (number, obstacle))
    }

    /// The coordinates of a node if they are well formed.
    fn position(&self, node: usize) -> Option<&'a [f64]> {
        let (_, position) = self.model.nodes.get_index(node)?;
        numbers::well_formed(position, self.model.dimension).then_some(position.as_slice())
    }

    fn is_free(&self, node: usize, component: usize) -> bool {
        component < self.model.dimension && self.supported.get(node).is_some_and(|held| !held[component])
    }

    fn has_free_component(&self, node: usize) -> bool {
        (0..self.model.dimension).any(|component| self.is_free(node, component))
    }

    /// How far behind an obstacle rounding alone can put a node, given the largest coordinate or radius involved.
    fn penetration_tolerance(&self, reach: f64) -> f64 {
        PENETRATION_TOLERANCE * self.size + 4.0 * f64::EPSILON * reach
    }
}

fn size(model: &Model) -> f64 {
    let mut extents = [(f64::INFINITY, f64::NEG_INFINITY); 3];
    for position in model.nodes.values().filter(|position| numbers::well_formed(position, model.dimension)) {
        for (extent, &coordinate) in extents.iter_mut().zip(position) {
            *extent = (extent.0.min(coordinate), extent.1.max(coordinate));
        }
    }
    let widths = extents.map(|(least, most)| (most - least).max(0.0));
    numbers::norm(&widths)
}

/// A name that can stand in a table, a log line and a JSON pointer.
fn printable(name: &str, at: &Place, mistakes: &mut Mistakes) {
    let bytes = name.len();
    if bytes > MAX_NAME_BYTES {
        mistakes.add(at, || format!("the name {} has {bytes} bytes; at most {MAX_NAME_BYTES} are taken", quoted(name)));
    } else if name.chars().any(char::is_control) {
        mistakes.add(at, || format!("the name {} has a control character; printable ones are expected", quoted(name)));
    }
}

/// A printable name that is not empty.
fn proper_name(name: &str, at: &Place, mistakes: &mut Mistakes) {
    if name.is_empty() {
        mistakes.add(at, || "the name is empty; one character or more is expected");
    } else {
        printable(name, at, mistakes);
    }
}

#[cfg(test)]
mod tests;
