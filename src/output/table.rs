//! Increments as CSV (RFC 4180, lines ended by a single line feed).
//!
//! The columns come from the first increment: a column for every component of every node, and a group of columns for
//! every contact, so `tip.x`, `tip.y`, `tip/floor.status`, `tip/floor.gap`. Later rows find their values by name; what
//! they lack is an empty cell.

use super::csv::CsvRow;
use crate::measure::Errors;
use crate::path::Increment;
use crate::path::increment::{ContactState, PointKind, Status};
use std::sync::Arc;

const AXES: [&str; 3] = ["x", "y", "z"];

/// The columns of one path.
#[derive(Debug, Clone)]
pub struct Table {
    nodes: Vec<(Arc<str>, usize)>,
    contacts: Vec<ContactColumns>,
}

#[derive(Debug, Clone)]
struct ContactColumns {
    node: Arc<str>,
    obstacle: Arc<str>,
    tangents: usize,
}

impl Table {
    /// The table that fits this increment and those that follow it.
    pub fn fitting(first: &Increment) -> Self {
        let nodes = first.displacements.iter().map(|(name, values)| (Arc::clone(name), values.len())).collect();
        let contacts = first
            .contacts
            .iter()
            .map(|contact| ContactColumns {
                node: Arc::clone(&contact.node),
                obstacle: Arc::clone(&contact.obstacle),
                tangents: contact.tangential_reaction.len().max(contact.slip.len()),
            })
            .collect();
        Self { nodes, contacts }
    }

    /// The first line, its line feed included.
    pub fn header(&self) -> String {
        let mut line = CsvRow::default();
        for name in ["index", "stage", "load_factor", "arc_length", "step", "point", "bifurcation", "event"] {
            line.text(name);
        }
        for (node, size) in &self.nodes {
            for axis in AXES.iter().take(*size) {
                line.text(&format!("{node}.{axis}"));
            }
        }
        for ContactColumns { node, obstacle, tangents } in &self.contacts {
            for name in ["status", "gap", "normal_reaction"] {
                line.text(&format!("{node}/{obstacle}.{name}"));
            }
            for name in ["tangential_reaction", "slip"] {
                for tangent in 1..=*tangents {
                    line.text(&format!("{node}/{obstacle}.{name}.{tangent}"));
                }
            }
        }
        for name in ["external_work", "strain_energy", "dissipated"] {
            line.text(name);
        }
        for name in ["elapsed_s", "residual", "complementarity", "energy_error", "error_estimate"] {
            line.text(name);
        }
        for name in ["factorisations", "newton_iterations", "qp_solves", "mpec_solves"] {
            line.text(name);
        }
        for name in Errors::NAMES {
            line.text(&format!("measure.{name}"));
        }
        line.end()
    }

    /// One increment, its line feed included; without a measure those cells are empty.
    pub fn row(&self, increment: &Increment, measure: Option<&Errors>) -> String {
        let mut line = CsvRow::default();
        line.raw(&increment.index.to_string());
        line.text(&increment.stage);
        line.number(increment.load_factor);
        line.number(increment.arc_length);
        line.number(increment.step);
        line.raw(point_kind(increment.point.kind));
        line.raw(if increment.point.bifurcation { "true" } else { "false" });
        line.text(increment.point.event.as_deref().unwrap_or_default());
        for (node, size) in &self.nodes {
            let values = increment.displacements.get(node).map(Vec::as_slice).unwrap_or_default();
            line.numbers(values, *size);
        }
        for (place, columns) in self.contacts.iter().enumerate() {
            let state = columns.find(place, &increment.contacts);
            line.raw(state.map_or("", |state| status(state.status)));
            line.optional(state.map(|state| state.gap));
            line.optional(state.map(|state| state.normal_reaction));
            line.numbers(state.map(|state| state.tangential_reaction.as_slice()).unwrap_or_default(), columns.tangents);
            line.numbers(state.map(|state| state.slip.as_slice()).unwrap_or_default(), columns.tangents);
        }
        let (energy, diagnostics) = (&increment.energy, &increment.diagnostics);
        for value in [energy.external_work, energy.strain, energy.dissipated] {
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
        for count in
            [diagnostics.factorisations, diagnostics.newton_iterations, diagnostics.qp_solves, diagnostics.mpec_solves]
        {
            line.raw(&count.to_string());
        }
        line.numbers(measure.map(Errors::values).as_ref().map_or(&[], <[f64; _]>::as_slice), Errors::NAMES.len());
        line.end()
    }
}

impl ContactColumns {
    /// A pair of node and obstacle may be listed twice, so the place counts first.
    fn find<'a>(&self, place: usize, contacts: &'a [ContactState]) -> Option<&'a ContactState> {
        let fits = |state: &&ContactState| state.node == self.node && state.obstacle == self.obstacle;
        contacts.get(place).filter(fits).or_else(|| contacts.iter().find(fits))
    }
}

fn status(status: Status) -> &'static str {
    match status {
        Status::Free => "free",
        Status::Stick => "stick",
        Status::Slip => "slip",
    }
}

fn point_kind(kind: PointKind) -> &'static str {
    match kind {
        PointKind::Start => "start",
        PointKind::Regular => "regular",
        PointKind::SmoothLimit => "smooth_limit",
        PointKind::NonsmoothLimit => "nonsmooth_limit",
        PointKind::SmoothBifurcation => "smooth_bifurcation",
        PointKind::ContactChange => "contact_change",
        PointKind::End => "end",
    }
}
