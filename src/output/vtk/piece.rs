//! The file of one increment.

use crate::output::table::{beam_forces, point_kind};
use crate::output::vtk::arrays::{DataArray, text_array, write_texts};
use crate::output::vtk::grid::Grid;
use crate::result::increment::{ElementState, Increment, Status};
use crate::result::nodal_values::NodalValues;
use quick_xml::Writer;
use quick_xml::events::{BytesDecl, Event};
use std::io::{self, Write};

/// What `contact_status` says of a node: none of its contacts is recorded; the numbers of the others are larger the more
/// they hold the node's motion back.
const NO_CONTACT: u8 = 255;

fn number_of(status: Status) -> u8 {
    match status {
        Status::Free => 0,
        Status::Slip => 1,
        Status::Stick => 2,
    }
}

impl Grid {
    /// Writes the file of an increment (`.vtu`). Values that are not recorded are not-a-number.
    ///
    /// # Errors
    /// The file cannot be written.
    pub fn write(&self, increment: &Increment, to: impl Write) -> io::Result<()> {
        let mut to = Writer::new(to);
        to.write_event(Event::Decl(BytesDecl::new("1.0", None, None)))?;
        to.create_element("VTKFile")
            .with_attribute(("type", "UnstructuredGrid"))
            .with_attribute(("version", "1.0"))
            .with_attribute(("byte_order", "LittleEndian"))
            .with_attribute(("header_type", "UInt64"))
            .write_inner_content(|to| {
                to.create_element("UnstructuredGrid").write_inner_content(|to| {
                    to.create_element("FieldData").write_inner_content(|to| self.write_fields(increment, to))?;
                    to.create_element("Piece")
                        .with_attribute(("NumberOfPoints", self.place_of_node.len().to_string().as_str()))
                        .with_attribute(("NumberOfCells", self.number_of_elements.to_string().as_str()))
                        .write_inner_content(|to| self.write_piece(increment, to))
                        .map(drop)
                })?;
                Ok(())
            })?;
        Ok(())
    }

    fn write_fields<To: Write>(&self, increment: &Increment, to: &mut Writer<To>) -> io::Result<()> {
        let energy = &increment.energy;
        for (name, value) in [
            ("TimeValue", increment.arc_length),
            ("arc_length", increment.arc_length),
            ("load_factor", increment.load_factor),
            ("external_work", energy.external_work),
            ("strain_energy", energy.strain),
            ("dissipated", energy.dissipated),
            ("released", energy.released),
        ] {
            DataArray::numbers(name, 1, &[value]).write(to, Some(1))?;
        }
        DataArray::numbers("applied_force", 3, &in_space(&increment.applied_forces)).write(to, Some(1))?;
        let point = &increment.point;
        let whole = |count: u64| i64::try_from(count).unwrap_or(i64::MAX);
        for (name, value) in [
            ("index", whole(increment.index)),
            ("bifurcation", i64::from(point.bifurcation)),
            ("better_direction", i64::from(point.better_direction)),
            ("unexplored_modes", whole(point.unexplored_modes)),
            ("degenerate", i64::from(point.degenerate)),
        ] {
            DataArray::integers(name, std::iter::once(value)).write(to, Some(1))?;
        }
        for (name, text) in [
            ("stage", &*increment.stage),
            ("point", point_kind(point.kind)),
            ("event", point.event.as_deref().unwrap_or_default()),
            ("branch", &self.branch),
        ] {
            write_texts(to, name, &text_array(std::iter::once(text)), Some(1))?;
        }
        for (name, label) in [("length_unit", &self.units.length), ("force_unit", &self.units.force)] {
            let Some(label) = label else { continue };
            write_texts(to, name, &text_array(std::iter::once(label.as_str())), Some(1))?;
        }
        Ok(())
    }

    fn write_piece<To: Write>(&self, increment: &Increment, to: &mut Writer<To>) -> io::Result<()> {
        to.create_element("Points").write_inner_content(|to| self.points.write(to, None))?;
        to.create_element("Cells")
            .write_inner_content(|to| self.cells.iter().try_for_each(|array| array.write(to, None)))?;
        to.create_element("PointData").with_attribute(("Vectors", "displacement")).write_inner_content(|to| {
            write_texts(to, "node", &self.node_names, None)?;
            self.at_nodes("displacement", &increment.displacements).write(to, None)?;
            if self.has_rotations {
                self.rotations("rotation", &increment.displacements).write(to, None)?;
            }
            if self.has_supports {
                self.at_nodes("support_reaction", &increment.supports).write(to, None)?;
                if self.has_rotations {
                    self.rotations("support_moment", &increment.supports).write(to, None)?;
                }
            }
            if self.has_contacts {
                self.contact_arrays(increment).iter().try_for_each(|array| array.write(to, None))?;
            }
            Ok(())
        })?;
        to.create_element("CellData").write_inner_content(|to| {
            self.elements.write(to, None)?;
            if let Some(names) = &self.element_names {
                write_texts(to, "element_name", names, None)?;
            }
            self.force_arrays(increment).iter().try_for_each(|array| array.write(to, None))
        })?;
        Ok(())
    }

    fn at_nodes(&self, name: &'static str, values: &NodalValues) -> DataArray {
        let mut all = vec![f64::NAN; 3 * self.place_of_node.len()];
        for (node, components) in values.iter() {
            if let Some(place) = self.place_of_node.get(&**node) {
                all[3 * place..3 * place + 3]
                    .copy_from_slice(&in_space(&components[..components.len().min(self.dimension)]));
            }
        }
        DataArray::numbers(name, 3, &all)
    }

    /// What belongs to the rotations of nodes: about the axis out of the plane, or a vector in space; not-a-number of nodes
    /// that have none.
    fn rotations(&self, name: &'static str, values: &NodalValues) -> DataArray {
        let count = if self.dimension == 2 { 1 } else { 3 };
        let mut all = vec![f64::NAN; count * self.place_of_node.len()];
        for (node, components) in values.iter() {
            let turns = components.get(self.dimension..self.dimension + count);
            if let (Some(place), Some(turns)) = (self.place_of_node.get(&**node), turns) {
                all[count * place..count * (place + 1)].copy_from_slice(turns);
            }
        }
        DataArray::numbers(name, count, &all)
    }

    /// Of a node with several contacts: the status that holds it most, the smallest gap, the sum of the reactions, the largest
    /// normal reaction, the largest slip in total and the largest pressure.
    fn contact_arrays(&self, increment: &Increment) -> Vec<DataArray> {
        let nodes = self.place_of_node.len();
        let mut statuses = vec![NO_CONTACT; nodes];
        let (mut gaps, mut reactions) = (vec![f64::NAN; nodes], vec![0.0; 3 * nodes]);
        let (mut normals, mut slips) = (vec![f64::NAN; nodes], vec![f64::NAN; nodes]);
        let mut pressures = vec![f64::NAN; nodes];
        for contact in &increment.contacts {
            let Some(place) = self.place_of_node.get(&*contact.node) else { continue };
            let status = number_of(contact.status);
            statuses[*place] = if statuses[*place] == NO_CONTACT { status } else { statuses[*place].max(status) };
            gaps[*place] = gaps[*place].min(contact.gap);
            // The largest of numbers and of none is the number.
            normals[*place] = normals[*place].max(contact.normal_reaction);
            let slip = contact.slip_total.iter().map(|part| part * part).sum::<f64>().sqrt();
            slips[*place] = slips[*place].max(slip);
            let areas = self.contact_areas.get(place).into_iter().flatten();
            if let Some((_, area)) = areas.into_iter().find(|(touched, _)| **touched == *contact.obstacle) {
                pressures[*place] = pressures[*place].max(contact.normal_reaction / area);
            }
            let own = &mut reactions[3 * place..3 * place + 3];
            own.iter_mut().zip(in_space(&contact.reaction)).for_each(|(sum, value)| *sum += value);
        }
        let mut arrays = vec![
            DataArray::bytes("contact_status", statuses.into_iter()),
            DataArray::numbers("gap", 1, &gaps),
            DataArray::numbers("contact_reaction", 3, &reactions),
            DataArray::numbers("normal_reaction", 1, &normals),
            DataArray::numbers("slip_total", 1, &slips),
        ];
        if !self.contact_areas.is_empty() {
            arrays.push(DataArray::numbers("contact_pressure", 1, &pressures));
        }
        arrays
    }

    fn force_arrays(&self, increment: &Increment) -> Vec<DataArray> {
        let cells = self.number_of_elements;
        let (mut axial, mut forces) = (vec![f64::NAN; cells], vec![f64::NAN; 3 * cells]);
        let names = if self.has_beam_forces { beam_forces(self.dimension) } else { &[] };
        let mut at_ends: Vec<Vec<f64>> = names.iter().map(|_| vec![f64::NAN; 2 * cells]).collect();
        for state in &increment.elements {
            let Ok(place) = usize::try_from(state.element) else { continue };
            if let (Some(value), Some(cell)) = (state.axial_force, axial.get_mut(place)) {
                *cell = value;
            }
            for (values, end) in at_ends.iter_mut().zip(of_ends(state)) {
                if let Some(cell) = values.get_mut(2 * place..2 * place + 2) {
                    cell.copy_from_slice(&end);
                }
            }
            if let (Some(force), Some(cell)) = (&state.force, forces.get_mut(3 * place..3 * place + 3)) {
                cell.copy_from_slice(&in_space(force));
            }
        }
        let mut arrays = Vec::new();
        arrays.extend(names.iter().zip(&at_ends).map(|(name, values)| DataArray::at_ends(name, values)));
        if self.has_bar_forces {
            arrays.push(DataArray::numbers("axial_force", 1, &axial));
        }
        if self.has_spring_forces {
            arrays.push(DataArray::numbers("spring_force", 3, &forces));
        }
        if let Some(strained) = &self.strained {
            arrays.extend(self.stress_arrays(increment));
            let strains = strained.strains(self.number_of_elements, &self.place_of_node, &increment.displacements);
            arrays.push(DataArray::numbers("strain", 6, &strains));
        }
        arrays
    }

    /// Stresses in the order of a symmetric tensor of VTK: `xx`, `yy`, `zz`, `xy`, `yz`, `xz`.
    fn stress_arrays(&self, increment: &Increment) -> [DataArray; 2] {
        let cells = self.number_of_elements;
        let (mut stresses, mut equivalent) = (vec![f64::NAN; 6 * cells], vec![f64::NAN; cells]);
        for state in &increment.elements {
            let (Ok(place), Some(stress)) = (usize::try_from(state.element), &state.stress) else { continue };
            if let Some(cell) = stresses.get_mut(6 * place..6 * place + 6) {
                cell.fill(0.0);
                cell.iter_mut().zip(stress).for_each(|(own, value)| *own = *value);
            }
            if let (Some(cell), Some(value)) = (equivalent.get_mut(place), state.von_mises) {
                *cell = value;
            }
        }
        [DataArray::numbers("stress", 6, &stresses), DataArray::numbers("von_mises", 1, &equivalent)]
    }
}

/// What [`beam_forces`] names, of an element, one pair of values for each name; none where it is no beam.
fn of_ends(state: &ElementState) -> impl Iterator<Item = [f64; 2]> {
    state
        .ends
        .into_iter()
        .flat_map(|[first, last]| first.values().zip(last.values()).map(|(a, b)| [a, b]).collect::<Vec<_>>())
}

/// Three components; the third is 0 in the plane.
fn in_space(components: &[f64]) -> [f64; 3] {
    let mut all = [0.0; 3];
    all.iter_mut().zip(components).for_each(|(own, value)| *own = *value);
    all
}
