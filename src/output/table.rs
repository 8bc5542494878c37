//! Increments as CSV (RFC 4180, lines ended by a single line feed).
//!
//! The request determines the columns: one for every component of every recorded node, a group for every contact that may
//! have a row, such as `tip.x`, `tip.y`, `tip/floor.status`, `tip/floor.gap`, and the forces of recorded elements and supports,
//! such as `elements/0.axial_force` and `pin.reaction.x`. A second contact of one node with one obstacle is `tip/floor#2`. A node with a rotation has it last, as `tip.rz`; a beam has the forces and
//! the moment of its two ends, `elements/0.start.axial_force` and so on. Values are assigned by name; missing values are empty cells.

use crate::check::measure::Errors;
use crate::model::JobRequest;
use crate::model::request::recorded_forces::{element_label, recorded_elements, recorded_supports};
use crate::model::request::{Contact, Element, Record};
use crate::output::csv::{Cells, ChosenCells, CsvRow};
use crate::result::increment::{DeadLoadStability, Diagnostics, Increment, Instability, Point, PointKind, Status};
use serde_json::Value;
use std::collections::{HashMap, HashSet};

pub(crate) const AXES: [&str; 3] = ["x", "y", "z"];

/// The columns of one path.
#[derive(Debug, Clone)]
pub struct Table {
    dimension: usize,
    nodes: Vec<NodeColumns>,
    contacts: Vec<ContactColumns>,
    elements: Vec<ElementColumns>,
    /// Nodes with recorded reactions of their supports.
    supports: Vec<NodeColumns>,
    /// Whether the stability of increments is recorded.
    has_stability: bool,
}

/// Names of the columns that say what is not known of the directions at a point.
pub(crate) const OF_DIRECTIONS: [&str; 3] = ["better_direction", "unexplored_modes", "degenerate"];

/// Names of the columns of stability, the last ones.
pub(crate) const OF_STABILITY: [&str; 3] =
    ["stability.negative_eigenvalues", "stability.dead_load", "stability.instability"];

#[derive(Debug, Clone)]
struct ElementColumns {
    place: u64,
    label: String,
    forces: ForceColumns,
}

/// What an element has columns of.
#[derive(Debug, Clone, Copy)]
enum ForceColumns {
    Axial,
    Vector,
    Ends,
    Moment,
    Stress,
}

#[derive(Debug, Clone)]
struct NodeColumns {
    name: String,
    /// With a rotation after the displacements, or a moment after the forces.
    has_rotation: bool,
}

impl NodeColumns {
    fn names(&self, what: &str, dimension: usize) -> impl Iterator<Item = String> {
        let rotations: &[&str] = if dimension == 2 { &["rz"] } else { &["rx", "ry", "rz"] };
        let rotations = rotations.iter().copied().take(self.rotations(dimension));
        let axes = AXES.into_iter().take(dimension).chain(rotations);
        axes.map(move |axis| format!("{}{what}.{axis}", self.name))
    }

    fn count(&self, dimension: usize) -> usize {
        dimension + self.rotations(dimension)
    }

    fn rotations(&self, dimension: usize) -> usize {
        match (self.has_rotation, dimension) {
            (false, _) => 0,
            (true, 2) => 1,
            (true, _) => 3,
        }
    }
}

/// Names of a beam's ends in columns, and of what they have.
const ENDS: [&str; 2] = ["start", "end"];
const AT_END: [&str; 3] = ["axial_force", "shear_force", "bending_moment"];
const AT_END_IN_SPACE: [&str; 6] =
    ["axial_force", "shear_force.1", "shear_force.2", "torsional_moment", "bending_moment.1", "bending_moment.2"];

/// The same where columns are apart from those of bars and springs, in files of tables and of cells.
#[cfg(feature = "server")]
const BEAM_FORCES: [&str; 3] = ["beam_axial_force", "shear_force", "bending_moment"];
#[cfg(feature = "server")]
const BEAM_FORCES_IN_SPACE: [&str; 6] =
    ["beam_axial_force", "shear_force_1", "shear_force_2", "torsional_moment", "bending_moment_1", "bending_moment_2"];

/// The names of what a beam's end has, by the dimension of the space, in the order of `BeamEndForces::values`.
#[cfg(feature = "server")]
pub(crate) fn beam_forces(dimension: usize) -> &'static [&'static str] {
    if dimension == 2 { &BEAM_FORCES } else { &BEAM_FORCES_IN_SPACE }
}

/// Names of the components of a solid's stress, in the order of `ElementState::stress`.
pub(crate) fn stress_components(dimension: usize) -> &'static [&'static str] {
    if dimension == 2 { &["xx", "yy", "zz", "xy"] } else { &["xx", "yy", "zz", "xy", "yz", "xz"] }
}

/// What a beam's end has, by the dimension of the space.
pub(crate) fn at_end(dimension: usize) -> &'static [&'static str] {
    if dimension == 2 { &AT_END } else { &AT_END_IN_SPACE }
}

#[derive(Debug, Clone)]
struct ContactColumns {
    node: String,
    obstacle: String,
    /// Which of the contacts of this node with this obstacle, from 1.
    number: usize,
}

impl ContactColumns {
    /// `tip/floor`, and `tip/floor#2` of a further contact of the same two.
    fn label(&self) -> String {
        match self.number {
            0 | 1 => format!("{}/{}", self.node, self.obstacle),
            further => format!("{}/{}#{further}", self.node, self.obstacle),
        }
    }
}

impl Table {
    /// The table of the path of a request.
    pub fn of<'r>(request: &'r JobRequest) -> Self {
        let (model, record) = (&request.model, request.analysis.record.as_ref());
        let named = record.and_then(|record| record.nodes.as_ref());
        let named: Option<HashSet<&String>> = named.map(|nodes| nodes.iter().collect());
        let is_named = |name: &&String| named.as_ref().is_none_or(|named| named.contains(*name));
        let rotating = model.rotating_nodes();
        let node_columns = |name: &str| NodeColumns {
            name: name.to_owned(),
            has_rotation: model.nodes.get_index_of(name).is_some_and(|number| rotating[number]),
        };
        let nodes = model.nodes.keys().filter(is_named).map(|name| node_columns(name)).collect();
        let named = record.and_then(Record::named_contacts);
        let named: Option<HashSet<(&str, &str)>> =
            named.map(|named| named.iter().map(|one| (one.node.as_str(), one.obstacle.as_str())).collect());
        let contacts = model.contacts.iter().filter(|contact| {
            named.as_ref().is_none_or(|named| named.contains(&(contact.node.as_str(), contact.counterpart())))
        });
        let mut numbers: HashMap<(&str, &str), usize> = HashMap::new();
        let mut columns = |contact: &'r Contact| {
            let number = numbers.entry((contact.node.as_str(), contact.counterpart())).or_default();
            *number += 1;
            let (node, obstacle) = (contact.node.clone(), contact.counterpart().to_owned());
            ContactColumns { node, obstacle, number: *number }
        };
        let element = |place: usize| ElementColumns {
            place: place as u64,
            label: element_label(model, place),
            forces: match model.elements[place] {
                Element::Bar { .. } => ForceColumns::Axial,
                Element::Spring { .. } => ForceColumns::Vector,
                Element::Beam { .. } => ForceColumns::Ends,
                Element::RotationalSpring { .. } => ForceColumns::Moment,
                _ => ForceColumns::Stress,
            },
        };
        Self {
            dimension: model.dimension,
            nodes,
            contacts: contacts.map(&mut columns).collect(),
            elements: recorded_elements(request).into_iter().map(element).collect(),
            supports: recorded_supports(request).into_iter().map(node_columns).collect(),
            has_stability: record.is_some_and(|record| record.stability),
        }
    }

    /// The names of the columns.
    pub fn names(&self) -> Vec<String> {
        let axes = || AXES.iter().take(self.dimension);
        let mut names: Vec<String> =
            ["index", "stage", "load_factor", "arc_length", "step", "point", "bifurcation", "event"]
                .map(str::to_owned)
                .into();
        for node in &self.nodes {
            names.extend(node.names("", self.dimension));
        }
        for contact in &self.contacts {
            let label = contact.label();
            names.extend(["status", "gap", "normal_reaction"].map(|name| format!("{label}.{name}")));
            for name in ["tangential_reaction", "slip", "slip_total"] {
                names.extend((1..self.dimension).map(|tangent| format!("{label}.{name}.{tangent}")));
            }
            names.extend(axes().map(|axis| format!("{label}.reaction.{axis}")));
        }
        for ElementColumns { label, forces, .. } in &self.elements {
            match forces {
                ForceColumns::Axial => names.push(format!("elements/{label}.axial_force")),
                ForceColumns::Vector => names.extend(axes().map(|axis| format!("elements/{label}.force.{axis}"))),
                ForceColumns::Ends => names.extend(ENDS.iter().flat_map(|end| {
                    at_end(self.dimension).iter().map(move |what| format!("elements/{label}.{end}.{what}"))
                })),
                ForceColumns::Moment => names.push(format!("elements/{label}.moment")),
                ForceColumns::Stress => {
                    let components = stress_components(self.dimension).iter();
                    names.extend(components.map(|component| format!("elements/{label}.stress.{component}")));
                    names.push(format!("elements/{label}.von_mises"));
                }
            }
        }
        for node in &self.supports {
            names.extend(node.names(".reaction", self.dimension));
        }
        names.extend(axes().map(|axis| format!("applied_force_{axis}")));
        names.extend(["external_work", "strain_energy", "dissipated", "released"].map(str::to_owned));
        names.extend(["elapsed_s", "residual", "complementarity", "energy_error", "error_estimate"].map(str::to_owned));
        names.extend(counts(&Diagnostics::default()).map(|(name, _)| name.to_owned()));
        names.extend(OF_DIRECTIONS.map(str::to_owned));
        names.extend(Errors::NAMES.map(|name| format!("measure.{name}")));
        if self.has_stability {
            names.extend(OF_STABILITY.map(str::to_owned));
        }
        names
    }

    /// The header line with its line feed.
    pub fn header(&self) -> String {
        let mut line = CsvRow::default();
        self.names().iter().for_each(|name| line.text(name));
        line.end()
    }

    /// The line of an increment with its line feed; without a measure the cells of the measure are empty.
    pub fn row(&self, increment: &Increment, measure: Option<&Errors>) -> String {
        let mut line = CsvRow::default();
        self.write(increment, measure, &mut line);
        line.end()
    }

    /// The values of an increment in these columns, which ascend; null where there is none.
    pub fn values(&self, increment: &Increment, measure: Option<&Errors>, columns: &[usize]) -> Vec<Value> {
        let mut cells = ChosenCells::of(columns);
        self.write(increment, measure, &mut cells);
        cells.values()
    }

    fn write(&self, increment: &Increment, measure: Option<&Errors>, line: &mut impl Cells) {
        line.count(increment.index);
        line.text(&increment.stage);
        line.number(increment.load_factor);
        line.number(increment.arc_length);
        line.number(increment.step);
        line.word(point_kind(increment.point.kind));
        line.flag(increment.point.bifurcation);
        line.text(increment.point.event.as_deref().unwrap_or_default());
        let tangents = self.dimension - 1;
        for node in &self.nodes {
            let values = increment.displacements.get(&node.name).unwrap_or_default();
            line.numbers(values, node.count(self.dimension));
        }
        // Rows and columns are in the order of the model.
        let mut rows = increment.contacts.iter().peekable();
        for columns in &self.contacts {
            let state = rows.next_if(|row| *row.node == columns.node && *row.obstacle == columns.obstacle);
            line.word(state.map_or("", |state| status(state.status)));
            line.optional(state.map(|state| state.gap));
            line.optional(state.map(|state| state.normal_reaction));
            line.numbers(state.map(|state| state.tangential_reaction.as_slice()).unwrap_or_default(), tangents);
            line.numbers(state.map(|state| state.slip.as_slice()).unwrap_or_default(), tangents);
            line.numbers(state.map(|state| state.slip_total.as_slice()).unwrap_or_default(), tangents);
            line.numbers(state.map(|state| state.reaction.as_slice()).unwrap_or_default(), self.dimension);
        }
        let mut rows = increment.elements.iter().peekable();
        for columns in &self.elements {
            let state = rows.next_if(|row| row.element == columns.place);
            match columns.forces {
                ForceColumns::Axial => line.optional(state.and_then(|state| state.axial_force)),
                ForceColumns::Vector => {
                    let force = state.and_then(|state| state.force.as_deref());
                    line.numbers(force.unwrap_or_default(), self.dimension);
                }
                ForceColumns::Ends => {
                    let ends = state.and_then(|state| state.ends);
                    for place in 0..ENDS.len() {
                        let values: Vec<f64> = ends.iter().flat_map(|ends| ends[place].values()).collect();
                        line.numbers(&values, at_end(self.dimension).len());
                    }
                }
                ForceColumns::Moment => line.optional(state.and_then(|state| state.moment)),
                ForceColumns::Stress => {
                    let stress = state.and_then(|state| state.stress.as_deref());
                    line.numbers(stress.unwrap_or_default(), stress_components(self.dimension).len());
                    line.optional(state.and_then(|state| state.von_mises));
                }
            }
        }
        for node in &self.supports {
            line.numbers(increment.supports.get(&node.name).unwrap_or_default(), node.count(self.dimension));
        }
        line.numbers(&increment.applied_forces, self.dimension);
        let (energy, diagnostics) = (&increment.energy, &increment.diagnostics);
        for value in [energy.external_work, energy.strain, energy.dissipated, energy.released] {
            line.number(value);
        }
        for value in [
            diagnostics.elapsed_s,
            diagnostics.residual,
            diagnostics.complementarity,
            diagnostics.energy_error,
            diagnostics.error_estimate,
        ] {
            line.number(value);
        }
        for (_, count) in counts(diagnostics) {
            line.count(count);
        }
        write_directions(&increment.point, line);
        line.numbers(measure.map(Errors::values).as_ref().map_or(&[], <[f64; _]>::as_slice), Errors::NAMES.len());
        if self.has_stability {
            let stability = increment.stability;
            line.optional(stability.and_then(|found| found.negative_eigenvalues).map(|count| count as f64));
            line.word(stability.map_or("", |found| dead_load(found.dead_load)));
            line.word(stability.and_then(|found| found.instability).map_or("", instability));
        }
    }
}

/// What [`OF_DIRECTIONS`] names.
fn write_directions(point: &Point, line: &mut impl Cells) {
    line.flag(point.better_direction);
    line.count(point.unexplored_modes);
    line.flag(point.degenerate);
}

/// The counts of the solver's work, with the names of their columns.
pub(crate) fn counts(diagnostics: &Diagnostics) -> [(&'static str, u64); 8] {
    [
        ("factorisations", diagnostics.factorisations),
        ("newton_iterations", diagnostics.newton_iterations),
        ("qp_solves", diagnostics.qp_solves),
        ("mpec_solves", diagnostics.mpec_solves),
        ("sqp_iterations", diagnostics.sqp_iterations),
        ("certificates", diagnostics.certificates),
        ("mpec_fallbacks", diagnostics.mpec_fallbacks),
        ("bifurcation_factorisations", diagnostics.bifurcation_factorisations),
    ]
}

pub(crate) fn dead_load(stability: DeadLoadStability) -> &'static str {
    match stability {
        DeadLoadStability::Stable => "stable",
        DeadLoadStability::Unstable => "unstable",
        DeadLoadStability::Unknown => "unknown",
    }
}

pub(crate) fn instability(instability: Instability) -> &'static str {
    match instability {
        Instability::Divergence => "divergence",
        Instability::Flutter => "flutter",
    }
}

pub(crate) fn status(status: Status) -> &'static str {
    match status {
        Status::Free => "free",
        Status::Stick => "stick",
        Status::Slip => "slip",
    }
}

pub(crate) fn point_kind(kind: PointKind) -> &'static str {
    match kind {
        PointKind::Start => "start",
        PointKind::Regular => "regular",
        PointKind::SmoothLimit => "smooth_limit",
        PointKind::NonsmoothLimit => "nonsmooth_limit",
        PointKind::SmoothBifurcation => "smooth_bifurcation",
        PointKind::ContactChange => "contact_change",
        PointKind::End => "end",
        PointKind::Jump => "jump",
        PointKind::Motion => "motion",
    }
}
