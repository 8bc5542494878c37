//! The picture of a path: load factor against one displacement component, its events lettered.
//!
//! `curve` extracts the curve from the increments, `legend` explains the letters, `strokes` has lines and marks, `draw` composes
//! the picture. Called by `solve` alone.

pub(crate) mod curve;
pub(crate) mod draw;
pub(crate) mod legend;
pub(crate) mod strokes;

use crate::model::Model;
use crate::model::input::names::{quoted, suggestion};
use crate::model::request::Component;
use crate::result::increment::Increment;
use crate::studies::picture::PlotError;
use curve::Curve;

const COMPONENTS: [Component; 3] = [Component::X, Component::Y, Component::Z];

/// A displacement component of a node, `tip.x` on the command line.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Against {
    pub node: String,
    component: Component,
}

/// There is no such displacement component.
#[derive(Debug, Clone, PartialEq, Eq, thiserror::Error)]
#[error("--against {}: the model has no such displacement (NODE.COMPONENT){suggestion}", quoted(.asked))]
pub struct UnknownDisplacement {
    asked: String,
    suggestion: String,
}

impl Against {
    /// Reads `NODE.COMPONENT`. A node's name may have dots of its own.
    pub fn read(text: &str, model: &Model) -> Result<Self, UnknownDisplacement> {
        let found = text.rsplit_once('.').and_then(|(node, letter)| {
            let component = axes(model).find(|component| name(*component) == letter)?;
            model.nodes.contains_key(node).then(|| Self { node: node.to_owned(), component })
        });
        found.ok_or_else(|| {
            let known: Vec<String> = all(model).map(|displacement| displacement.to_string()).collect();
            let suggestion = suggestion(text, known.iter().map(String::as_str));
            UnknownDisplacement { asked: text.to_owned(), suggestion }
        })
    }

    fn of(&self, increment: &Increment) -> Option<f64> {
        increment.displacements.get(self.node.as_str())?.get(self.component.place(2)).copied()
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
        None => farthest(model, increments).ok_or(PlotError::Empty)?,
    };
    let curve = Curve::new(model, &against, increments);
    if curve.is_empty() {
        return Err(PlotError::Empty);
    }
    draw::draw(&curve).map_err(|error| PlotError::Drawing(error.to_string()))
}

/// The unsupported component with the largest displacement, the first one among equals.
fn farthest(model: &Model, increments: &[Increment]) -> Option<Against> {
    /// By symmetry two nodes may have the same displacement up to rounding, which must not decide between them.
    const ALIKE: f64 = 1e-9;
    let is_free = |displacement: &Against| {
        let held = model.supports.get(&displacement.node);
        !held.is_some_and(|held| held.contains(&displacement.component))
    };
    let mut best: Option<(Against, f64)> = None;
    for displacement in all(model).filter(is_free) {
        let reach = increments.iter().filter_map(|increment| displacement.of(increment)).fold(0.0, reach);
        if best.as_ref().is_none_or(|(_, farthest)| reach > farthest * (1.0 + ALIKE)) {
            best = Some((displacement, reach));
        }
    }
    best.map(|(displacement, _)| displacement)
}

fn reach(farthest: f64, displacement: f64) -> f64 {
    farthest.max(displacement.abs())
}

fn all(model: &Model) -> impl Iterator<Item = Against> {
    model.nodes.keys().flat_map(|node| axes(model).map(|component| Against { node: node.clone(), component }))
}

fn axes(model: &Model) -> impl Iterator<Item = Component> {
    COMPONENTS.into_iter().take(model.dimension)
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
