//! The quantity against which the load factor is drawn.

use crate::model::input::names::{quoted, suggestion};
use crate::model::request::column_units::unit_of;
use crate::model::request::{Component, Units};
use crate::model::{JobRequest, Model};
use crate::output::Table;
use crate::result::increment::Increment;
use std::collections::BTreeSet;
use std::fmt;

const COMPONENTS: [Component; 6] =
    [Component::X, Component::Y, Component::Z, Component::Rx, Component::Ry, Component::Rz];

/// A displacement component or a rotation of a node, `tip.x` on the command line, or another number that increments record.
#[derive(Debug, Clone)]
pub enum Against {
    Displacement(NodalDisplacement),
    /// A column of the table of increments.
    Column(Box<Column>),
}

/// A displacement component or a rotation of a node.
#[derive(Debug, Clone)]
pub struct NodalDisplacement {
    node: String,
    component: Component,
    /// The component's place among the node's.
    place: usize,
}

/// A column of the table of increments.
#[derive(Debug, Clone)]
pub struct Column {
    name: String,
    table: Table,
    place: usize,
}

/// Increments have no such quantity.
#[derive(Debug, Clone, PartialEq, Eq, thiserror::Error)]
#[error("{}: the model has no such displacement (NODE.COMPONENT), and increments no such column{suggestion}", quoted(.asked))]
pub struct UnknownQuantity {
    asked: String,
    suggestion: String,
}

impl Against {
    /// Reads `NODE.COMPONENT` or the name of a column of `path.csv`. A node's name may have dots of its own.
    ///
    /// # Errors
    /// There is no such quantity.
    pub fn read(text: &str, request: &JobRequest) -> Result<Self, UnknownQuantity> {
        if let Some(displacement) = NodalDisplacement::read(text, &request.model) {
            return Ok(Self::Displacement(displacement));
        }
        let table = Table::of(request);
        let names = table.names();
        match names.iter().position(|name| name == text) {
            Some(place) => Ok(Self::Column(Box::new(Column { name: text.to_owned(), table, place }))),
            None => {
                let displacements = NodalDisplacement::all(&request.model).map(|displacement| displacement.to_string());
                let known: Vec<String> = displacements.chain(names).collect();
                let suggestion = suggestion(text, known.iter().map(String::as_str));
                Err(UnknownQuantity { asked: text.to_owned(), suggestion })
            }
        }
    }

    /// The node whose displacement this is.
    pub fn node(&self) -> Option<&str> {
        match self {
            Self::Displacement(displacement) => Some(&displacement.node),
            Self::Column(_) => None,
        }
    }

    /// What an axis says.
    pub(super) fn name(&self) -> String {
        match self {
            Self::Displacement(displacement) => format!("displacement {displacement}"),
            Self::Column(column) => column.name.clone(),
        }
    }

    /// The label of the unit.
    pub(super) fn unit(&self, units: Option<&Units>) -> Option<String> {
        match self {
            Self::Displacement(one) if one.component.is_rotation() => Some("rad".to_owned()),
            Self::Displacement(_) => units?.length.clone(),
            Self::Column(column) => unit_of(&column.name, units?),
        }
    }

    /// The quantity of an increment; `None` where it has none, or what it has is no number.
    pub(super) fn of(&self, increment: &Increment) -> Option<f64> {
        match self {
            Self::Displacement(displacement) => displacement.of(increment),
            Self::Column(column) => column.table.values(increment, None, &[column.place]).first()?.as_f64(),
        }
    }
}

impl NodalDisplacement {
    fn read(text: &str, model: &Model) -> Option<Self> {
        let (node, letter) = text.rsplit_once('.')?;
        let component = axes(model).find(|component| name(*component) == letter)?;
        let there = model.nodes.contains_key(node) && (!component.is_rotation() || turning_nodes(model).contains(node));
        there.then(|| Self { node: node.to_owned(), component, place: component.place(model.dimension) })
    }

    fn of(&self, increment: &Increment) -> Option<f64> {
        increment.displacements.get(self.node.as_str())?.get(self.place).copied()
    }

    fn all(model: &Model) -> impl Iterator<Item = Self> {
        let turning = turning_nodes(model);
        model.nodes.keys().flat_map(move |node| {
            let turns = turning.contains(node.as_str());
            let own = axes(model).filter(move |component| !component.is_rotation() || turns);
            own.map(|component| Self { node: node.clone(), component, place: component.place(model.dimension) })
        })
    }
}

impl fmt::Display for NodalDisplacement {
    fn fmt(&self, formatter: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(formatter, "{}.{}", self.node, name(self.component))
    }
}

/// Finds the unsupported component with the largest displacement, the first one among equals.
#[derive(Debug)]
pub struct Farthest {
    /// Each component with its largest displacement so far.
    reaches: Vec<(NodalDisplacement, f64)>,
}

impl Farthest {
    /// Of a model's components. Radians and lengths are not compared: a rotation is drawn where one asks for it.
    pub fn of(model: &Model) -> Self {
        let is_free = |displacement: &NodalDisplacement| {
            let held = model.supports.get(&displacement.node);
            !held.is_some_and(|held| held.contains(&displacement.component))
        };
        let all = NodalDisplacement::all(model).filter(|displacement| !displacement.component.is_rotation());
        Self { reaches: all.filter(is_free).map(|displacement| (displacement, 0.0)).collect() }
    }

    pub fn push(&mut self, increment: &Increment) {
        for (displacement, farthest) in &mut self.reaches {
            *farthest = displacement.of(increment).map_or(*farthest, |now| farthest.max(now.abs()));
        }
    }

    pub fn found(self) -> Option<Against> {
        /// By symmetry two nodes may have the same displacement up to rounding, which must not decide between them.
        const ALIKE: f64 = 1e-9;
        let mut best: Option<(NodalDisplacement, f64)> = None;
        for (displacement, reach) in self.reaches {
            if best.as_ref().is_none_or(|(_, farthest)| reach > farthest * (1.0 + ALIKE)) {
                best = Some((displacement, reach));
            }
        }
        best.map(|(displacement, _)| Against::Displacement(displacement))
    }
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
