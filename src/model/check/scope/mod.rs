//! The model with tables that several checks use.

pub(super) mod numbers;

use crate::model::Model;
use crate::model::input::limits::{MAX_NAME_BYTES, PENETRATION_TOLERANCE};
use crate::model::input::mistakes::{DocumentPlace, Mistakes};
use crate::model::input::names::{quoted, suggestion};
use crate::model::request::{Obstacle, ObstaclePivot};
use indexmap::IndexMap;

/// The model with tables that several checks use. Only its dimension, 2 or 3, has been checked.
pub(crate) struct Scope<'a> {
    pub model: &'a Model,
    pub at: DocumentPlace<'a>,
    /// For each node, whether x, y, z and the rotation are held.
    pub supported: Vec<[bool; 6]>,
    /// For each node, whether it has a rotation.
    pub rotating: Vec<bool>,
    /// The obstacles that turn.
    pub turning: IndexMap<&'a str, ObstaclePivot>,
    /// Diagonal of the box around the well-formed nodes; 0 for a single node.
    pub size: f64,
}

impl<'a> Scope<'a> {
    pub fn new(model: &'a Model, at: DocumentPlace<'a>) -> Self {
        let mut supported = vec![[false; 6]; model.nodes.len()];
        for (name, components) in &model.supports {
            if let Some(held) = model.nodes.get_index_of(name).and_then(|node| supported.get_mut(node)) {
                for component in components {
                    held[component.index()] = true;
                }
            }
        }
        let turning = model.turning_obstacles();
        Self { model, at, supported, rotating: model.rotating_nodes(), turning, size: size(model) }
    }

    /// The number of a node; notes an unknown name.
    pub fn node(&self, name: &str, at: &DocumentPlace, mistakes: &mut Mistakes) -> Option<usize> {
        let found = self.model.nodes.get_index_of(name);
        if found.is_none() {
            let known = || suggestion(name, self.model.nodes.keys().map(String::as_str));
            mistakes.add(at, || format!("there is no node {}{}", quoted(name), known()));
        }
        found
    }

    /// The obstacle and its number; notes an unknown name.
    pub fn obstacle(&self, name: &str, at: &DocumentPlace, mistakes: &mut Mistakes) -> Option<(usize, &'a Obstacle)> {
        let found = self.model.obstacles.get_full(name);
        if found.is_none() {
            let known = || suggestion(name, self.model.obstacles.keys().map(String::as_str));
            mistakes.add(at, || format!("there is no obstacle {}{}", quoted(name), known()));
        }
        found.map(|(number, _, obstacle)| (number, obstacle))
    }

    /// The coordinates of a node if they are well formed.
    pub fn position(&self, node: usize) -> Option<&'a [f64]> {
        let (_, position) = self.model.nodes.get_index(node)?;
        numbers::well_formed(position, self.model.dimension).then_some(position.as_slice())
    }

    pub fn is_free(&self, node: usize, component: usize) -> bool {
        component < self.model.dimension && self.supported.get(node).is_some_and(|held| !held[component])
    }

    /// Whether the node has rotations, and one of them is free.
    pub fn turns_freely(&self, node: usize) -> bool {
        self.rotations().any(|rotation| self.turns_freely_by(node, rotation))
    }

    /// Whether the node has a rotation, by its index among the components, and it is free.
    pub fn turns_freely_by(&self, node: usize, rotation: usize) -> bool {
        self.has_rotation(node) && !self.supported[node][rotation]
    }

    /// The indices of the rotations among the components.
    pub fn rotations(&self) -> std::ops::Range<usize> {
        if self.model.dimension == 2 { 5..6 } else { 3..6 }
    }

    /// The index of a component, by its place among a node's degrees of freedom.
    pub fn component_at(&self, place: usize) -> usize {
        if place < self.model.dimension { place } else { self.rotations().start + place - self.model.dimension }
    }

    pub fn has_rotation(&self, node: usize) -> bool {
        self.rotating.get(node).copied().unwrap_or(false)
    }

    pub fn has_free_component(&self, node: usize) -> bool {
        (0..self.model.dimension).any(|component| self.is_free(node, component)) || self.turns_freely(node)
    }

    /// The largest penetration of an obstacle that rounding can cause, given the largest coordinate or radius.
    pub fn penetration_tolerance(&self, reach: f64) -> f64 {
        PENETRATION_TOLERANCE * self.size + 4.0 * f64::EPSILON * reach
    }
}

pub(crate) fn size(model: &Model) -> f64 {
    let mut extents = [(f64::INFINITY, f64::NEG_INFINITY); 3];
    for position in model.nodes.values().filter(|position| numbers::well_formed(position, model.dimension)) {
        for (extent, &coordinate) in extents.iter_mut().zip(position) {
            *extent = (extent.0.min(coordinate), extent.1.max(coordinate));
        }
    }
    let widths = extents.map(|(least, most)| (most - least).max(0.0));
    numbers::norm(&widths)
}

/// Checks a name, which has to be usable in a table, a log line and a JSON pointer.
pub(crate) fn printable(name: &str, at: &DocumentPlace, mistakes: &mut Mistakes) {
    let bytes = name.len();
    if bytes > MAX_NAME_BYTES {
        mistakes.add(at, || format!("the name {} has {bytes} bytes; at most {MAX_NAME_BYTES} are taken", quoted(name)));
    } else if name.chars().any(char::is_control) {
        mistakes.add(at, || format!("the name {} has a control character; printable ones are expected", quoted(name)));
    }
}

/// A printable name that is not empty.
pub(crate) fn proper_name(name: &str, at: &DocumentPlace, mistakes: &mut Mistakes) {
    if name.is_empty() {
        mistakes.add(at, || "the name is empty; one character or more is expected");
    } else {
        printable(name, at, mistakes);
    }
}
