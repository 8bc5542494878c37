//! The picture of a path: load factor against one displacement component, its events lettered.
//!
//! `curve` extracts the curve from the increments, `legend` explains the letters, `strokes` has lines and marks, `draw` composes
//! the picture. Called by `command` and `http`.

pub(crate) mod curve;
pub(crate) mod draw;
pub(crate) mod legend;
pub(crate) mod strokes;

use crate::model::Model;
use crate::model::input::names::{quoted, suggestion};
use crate::model::request::Component;
use crate::result::increment::Increment;
use crate::studies::picture::PlotError;
pub use curve::Curve;
use std::collections::BTreeSet;

const COMPONENTS: [Component; 6] =
    [Component::X, Component::Y, Component::Z, Component::Rx, Component::Ry, Component::Rz];

/// A displacement component or a rotation of a node, `tip.x` on the command line.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Against {
    pub node: String,
    component: Component,
    /// The component's place among the node's.
    place: usize,
}

/// There is no such displacement component.
#[derive(Debug, Clone, PartialEq, Eq, thiserror::Error)]
#[error("{}: the model has no such displacement (NODE.COMPONENT){suggestion}", quoted(.asked))]
pub struct UnknownDisplacement {
    asked: String,
    suggestion: String,
}

impl Against {
    /// Reads `NODE.COMPONENT`. A node's name may have dots of its own.
    pub fn read(text: &str, model: &Model) -> Result<Self, UnknownDisplacement> {
        let found = text.rsplit_once('.').and_then(|(node, letter)| {
            let component = axes(model).find(|component| name(*component) == letter)?;
            let there =
                model.nodes.contains_key(node) && (!component.is_rotation() || turning_nodes(model).contains(node));
            there.then(|| Self { node: node.to_owned(), component, place: component.place(model.dimension) })
        });
        found.ok_or_else(|| {
            let known: Vec<String> = all(model).map(|displacement| displacement.to_string()).collect();
            let suggestion = suggestion(text, known.iter().map(String::as_str));
            UnknownDisplacement { asked: text.to_owned(), suggestion }
        })
    }

    fn is_rotation(&self) -> bool {
        self.component.is_rotation()
    }

    fn of(&self, increment: &Increment) -> Option<f64> {
        increment.displacements.get(self.node.as_str())?.get(self.place).copied()
    }
}

impl std::fmt::Display for Against {
    fn fmt(&self, formatter: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        write!(formatter, "{}.{}", self.node, name(self.component))
    }
}

/// The picture as SVG text, which only depends on the increments, not on times.
pub fn svg(model: &Model, increments: &[Increment], against: Option<Against>) -> Result<String, PlotError> {
    let against = match against {
        Some(against) => against,
        None => {
            let mut farthest = Farthest::of(model);
            increments.iter().for_each(|increment| farthest.push(increment));
            farthest.found().ok_or(PlotError::Empty)?
        }
    };
    let mut curve = Curve::new(model, against);
    increments.iter().for_each(|increment| curve.push(increment));
    draw_curve(&curve)
}

/// The picture of a curve as SVG text.
pub fn draw_curve(curve: &Curve) -> Result<String, PlotError> {
    if curve.is_empty() {
        return Err(PlotError::Empty);
    }
    draw::draw(curve).map_err(|error| PlotError::Drawing(error.to_string()))
}

/// Finds the unsupported component with the largest displacement, the first one among equals.
#[derive(Debug)]
pub struct Farthest {
    /// Each component with its largest displacement so far.
    reaches: Vec<(Against, f64)>,
}

impl Farthest {
    /// Of a model's components. Radians and lengths are not compared: a rotation is drawn where one asks for it.
    pub fn of(model: &Model) -> Self {
        let is_free = |displacement: &Against| {
            let held = model.supports.get(&displacement.node);
            !held.is_some_and(|held| held.contains(&displacement.component))
        };
        let all = all(model).filter(|displacement| !displacement.component.is_rotation()).filter(is_free);
        Self { reaches: all.map(|displacement| (displacement, 0.0)).collect() }
    }

    pub fn push(&mut self, increment: &Increment) {
        for (displacement, farthest) in &mut self.reaches {
            *farthest = displacement.of(increment).map_or(*farthest, |now| reach(*farthest, now));
        }
    }

    pub fn found(self) -> Option<Against> {
        /// By symmetry two nodes may have the same displacement up to rounding, which must not decide between them.
        const ALIKE: f64 = 1e-9;
        let mut best: Option<(Against, f64)> = None;
        for (displacement, reach) in self.reaches {
            if best.as_ref().is_none_or(|(_, farthest)| reach > farthest * (1.0 + ALIKE)) {
                best = Some((displacement, reach));
            }
        }
        best.map(|(displacement, _)| displacement)
    }
}

fn reach(farthest: f64, displacement: f64) -> f64 {
    farthest.max(displacement.abs())
}

fn all(model: &Model) -> impl Iterator<Item = Against> {
    let turning = turning_nodes(model);
    model.nodes.keys().flat_map(move |node| {
        let turns = turning.contains(node.as_str());
        let own = axes(model).filter(move |component| !component.is_rotation() || turns);
        own.map(|component| Against { node: node.clone(), component, place: component.place(model.dimension) })
    })
}

fn axes(model: &Model) -> impl Iterator<Item = Component> {
    let dimension = model.dimension;
    COMPONENTS.into_iter().filter(move |component| component.is_in(dimension))
}

/// The nodes of which increments have a rotation.
fn turning_nodes(model: &Model) -> BTreeSet<&str> {
    let nodes = model.elements.iter().flat_map(|element| element.nodes().iter().map(move |node| (element, node)));
    nodes.filter(|(element, node)| element.turns_with(node)).map(|(_, node)| node.as_str()).collect()
}

fn name(component: Component) -> &'static str {
    match component {
        Component::X => "x",
        Component::Y => "y",
        Component::Z => "z",
        Component::Rx => "rx",
        Component::Ry => "ry",
        Component::Rz => "rz",
    }
}
