//! The tables of a path, and the rows that an increment adds to each.

use crate::check::measure::Errors;
use crate::model::Model;
use crate::model::request::Units;
use crate::output::parquet::sheet::{Cell, Kind, Sheet};
use crate::output::table::{
    AXES, OF_DIRECTIONS, OF_STABILITY, beam_forces, counts, dead_load, instability, point_kind, status,
    stress_components,
};
use crate::result::increment::{Diagnostics, Increment};
use parquet::errors::Result;
use parquet::file::metadata::KeyValue;
use std::io::Write;

/// A table of a path.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum PathTable {
    /// A row an increment: what happened there, loads, energies, diagnostics and measure.
    Increments,
    /// A row an increment and recorded node: displacement, and the recorded reaction of its supports.
    Nodes,
    /// A row an increment and recorded element: its force.
    Elements,
    /// A row an increment and recorded contact: its state.
    Contacts,
}

/// Most components of a vector or of a stress.
const MOST: usize = 6;

impl PathTable {
    /// All tables, in the order in which they are written.
    pub const ALL: [Self; 4] = [Self::Increments, Self::Nodes, Self::Elements, Self::Contacts];

    /// The name of its file, without extension.
    pub fn name(self) -> &'static str {
        match self {
            Self::Increments => "increments",
            Self::Nodes => "nodes",
            Self::Elements => "elements",
            Self::Contacts => "contacts",
        }
    }

    /// The table's file, without rows, for a model of this dimension. The labels of the model's units stand in its metadata,
    /// as `units.length` and `units.force`.
    ///
    /// # Errors
    /// The file cannot be written.
    pub fn sheet<To: Write + Send>(self, to: To, dimension: usize, units: Option<&Units>) -> Result<Sheet<To>> {
        let mut columns = vec![("index".to_owned(), Kind::Integer)];
        let mut add = |name: &str, kind| columns.push((name.to_owned(), kind));
        match self {
            Self::Increments => {
                add("stage", Kind::Text);
                ["load_factor", "arc_length", "step"].iter().for_each(|name| add(name, Kind::Number));
                add("point", Kind::Text);
                add("bifurcation", Kind::Flag);
                add("event", Kind::Text);
                AXES[..dimension].iter().for_each(|axis| add(&format!("applied_force_{axis}"), Kind::Number));
                for name in ["external_work", "strain_energy", "dissipated", "released"] {
                    add(name, Kind::Number);
                }
                for name in ["elapsed_s", "residual", "complementarity", "energy_error", "error_estimate"] {
                    add(name, Kind::Number);
                }
                counts(&Diagnostics::default()).iter().for_each(|(name, _)| add(name, Kind::Integer));
                Errors::NAMES.iter().for_each(|name| add(&format!("measure.{name}"), Kind::Number));
                let kinds = [Kind::Flag, Kind::Integer, Kind::Flag, Kind::Integer, Kind::Text, Kind::Text];
                OF_DIRECTIONS.iter().chain(&OF_STABILITY).zip(kinds).for_each(|(name, kind)| add(name, kind));
            }
            Self::Nodes => {
                add("node", Kind::Text);
                for name in ["displacement", "reaction"] {
                    AXES[..dimension].iter().for_each(|axis| add(&format!("{name}_{axis}"), Kind::Number));
                }
                for name in ["rotation", "reaction_moment"] {
                    match dimension {
                        2 => add(name, Kind::Number),
                        _ => AXES.iter().for_each(|axis| add(&format!("{name}_{axis}"), Kind::Number)),
                    }
                }
            }
            Self::Elements => {
                add("element", Kind::Integer);
                add("name", Kind::Text);
                add("axial_force", Kind::Number);
                AXES[..dimension].iter().for_each(|axis| add(&format!("force_{axis}"), Kind::Number));
                if dimension == 2 {
                    add("moment", Kind::Number);
                }
                for end in ["first", "last"] {
                    let names = beam_forces(dimension).iter();
                    names.for_each(|name| add(&format!("{name}_at_{end}_node"), Kind::Number));
                }
                let stresses = stress_components(dimension).iter();
                stresses.for_each(|component| add(&format!("stress_{component}"), Kind::Number));
                add("von_mises", Kind::Number);
            }
            Self::Contacts => {
                ["node", "obstacle", "status"].iter().for_each(|name| add(name, Kind::Text));
                ["gap", "normal_reaction"].iter().for_each(|name| add(name, Kind::Number));
                for name in ["tangential_reaction", "slip", "slip_total"] {
                    (1..dimension).for_each(|tangent| add(&format!("{name}_{tangent}"), Kind::Number));
                }
                AXES[..dimension].iter().for_each(|axis| add(&format!("reaction_{axis}"), Kind::Number));
                add("indeterminate", Kind::Flag);
            }
        }
        Sheet::new(to, &columns, about(units))
    }

    /// Adds the rows of an increment.
    ///
    /// # Errors
    /// The file cannot be written.
    pub fn push<To: Write + Send>(
        self,
        sheet: &mut Sheet<To>,
        dimension: usize,
        increment: &Increment,
        measure: Option<&Errors>,
    ) -> Result<()> {
        let index = Cell::Integer(increment.index);
        match self {
            Self::Increments => push_increment(sheet, dimension, increment, measure),
            Self::Nodes => {
                let only_supported =
                    increment.supports.keys().filter(|node| increment.displacements.get(node).is_none());
                increment.displacements.keys().chain(only_supported).try_for_each(|node| {
                    let mut row = vec![index, Cell::Text(node)];
                    for values in [&increment.displacements, &increment.supports] {
                        row.extend(components(values.get(node).unwrap_or_default(), dimension));
                    }
                    let turns = if dimension == 2 { 1 } else { 3 };
                    for values in [&increment.displacements, &increment.supports] {
                        let of_node = values.get(node).unwrap_or_default();
                        row.extend(components(of_node.get(dimension..).unwrap_or_default(), turns));
                    }
                    sheet.push(&row)
                })
            }
            Self::Elements => increment.elements.iter().try_for_each(|state| {
                let name = state.name.as_deref().map_or(Cell::Empty, Cell::Text);
                let mut row = vec![index, Cell::Integer(state.element), name, state.axial_force.into()];
                row.extend(components(state.force.as_deref().unwrap_or_default(), dimension));
                if dimension == 2 {
                    row.push(state.moment.into());
                }
                for end in 0..2 {
                    let values: Vec<f64> = state.ends.iter().flat_map(|ends| ends[end].values()).collect();
                    row.extend((0..beam_forces(dimension).len()).map(|place| Cell::from(values.get(place).copied())));
                }
                row.extend(components(state.stress.as_deref().unwrap_or_default(), stress_components(dimension).len()));
                row.push(state.von_mises.into());
                sheet.push(&row)
            }),
            Self::Contacts => increment.contacts.iter().try_for_each(|state| {
                let mut row = vec![index, Cell::Text(&state.node), Cell::Text(&state.obstacle)];
                row.push(Cell::Text(status(state.status)));
                row.extend([Cell::Number(state.gap), Cell::Number(state.normal_reaction)]);
                for values in [&state.tangential_reaction, &state.slip, &state.slip_total] {
                    row.extend(components(values, dimension - 1));
                }
                row.extend(components(&state.reaction, dimension));
                row.push(Cell::Flag(state.indeterminate));
                sheet.push(&row)
            }),
        }
    }
}

fn push_increment<To: Write + Send>(
    sheet: &mut Sheet<To>,
    dimension: usize,
    increment: &Increment,
    measure: Option<&Errors>,
) -> Result<()> {
    let (point, energy, diagnostics) = (&increment.point, &increment.energy, &increment.diagnostics);
    let mut row = vec![Cell::Integer(increment.index), Cell::Text(&increment.stage)];
    row.extend([increment.load_factor, increment.arc_length, increment.step].map(Cell::Number));
    row.extend([Cell::Text(point_kind(point.kind)), Cell::Flag(point.bifurcation)]);
    row.push(point.event.as_deref().map_or(Cell::Empty, Cell::Text));
    row.extend(components(&increment.applied_forces, dimension));
    row.extend([energy.external_work, energy.strain, energy.dissipated, energy.released].map(Cell::Number));
    row.extend(
        [
            diagnostics.elapsed_s,
            diagnostics.residual,
            diagnostics.complementarity,
            diagnostics.energy_error,
            diagnostics.error_estimate,
        ]
        .map(Cell::Number),
    );
    row.extend(counts(diagnostics).map(|(_, count)| Cell::Integer(count)));
    match measure {
        Some(measure) => row.extend(measure.values().map(Cell::Number)),
        None => row.extend(Errors::NAMES.map(|_| Cell::Empty)),
    }
    row.push(Cell::Flag(point.better_direction));
    row.extend([Cell::Integer(point.unexplored_modes), Cell::Flag(point.degenerate)]);
    let stability = increment.stability;
    row.push(stability.and_then(|found| found.negative_eigenvalues).map_or(Cell::Empty, Cell::Integer));
    row.push(stability.map_or(Cell::Empty, |found| Cell::Text(dead_load(found.dead_load))));
    row.push(stability.and_then(|found| found.instability).map_or(Cell::Empty, |found| Cell::Text(instability(found))));
    sheet.push(&row)
}

/// The labels of units, for readers of a file.
fn about(units: Option<&Units>) -> Vec<KeyValue> {
    let Some(Units { length, force }) = units else { return Vec::new() };
    let labels = [("units.length", length), ("units.force", force)];
    labels.into_iter().filter_map(|(key, label)| Some(KeyValue::new(key.to_owned(), label.clone()?))).collect()
}

/// As many cells as asked for, empty where there is no component.
fn components<'a>(values: &[f64], count: usize) -> impl Iterator<Item = Cell<'a>> + use<'a> {
    let mut cells = [Cell::Empty; MOST];
    cells.iter_mut().zip(values).for_each(|(cell, value)| *cell = Cell::Number(*value));
    cells.into_iter().take(count)
}

/// The files of all tables of one path.
pub struct PathSheets<To: Write + Send> {
    dimension: usize,
    sheets: [Sheet<To>; PathTable::ALL.len()],
}

impl<To: Write + Send> PathSheets<To> {
    /// `open` gives the file of each table.
    ///
    /// # Errors
    /// A file cannot be opened or written.
    pub fn new(model: &Model, open: impl Fn(PathTable) -> Result<To>) -> Result<Self> {
        let [increments, nodes, elements, contacts] = PathTable::ALL;
        let dimension = model.dimension;
        let sheet = |table: PathTable| table.sheet(open(table)?, dimension, model.units.as_ref());
        Ok(Self { dimension, sheets: [sheet(increments)?, sheet(nodes)?, sheet(elements)?, sheet(contacts)?] })
    }

    /// Adds an increment to every table.
    ///
    /// # Errors
    /// A file cannot be written.
    pub fn push(&mut self, increment: &Increment, measure: Option<&Errors>) -> Result<()> {
        for (table, sheet) in PathTable::ALL.into_iter().zip(&mut self.sheets) {
            table.push(sheet, self.dimension, increment, measure)?;
        }
        Ok(())
    }

    /// Writes the ends of the files.
    ///
    /// # Errors
    /// A file cannot be written.
    pub fn finish(self) -> Result<()> {
        self.sheets.into_iter().try_for_each(|sheet| sheet.finish().map(drop))
    }
}
