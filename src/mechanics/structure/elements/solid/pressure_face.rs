//! A pressure that follows a face, as an element of its own.
//!
//! The pressure is a degree of freedom that the load factor prescribes, as it prescribes the motion of a support: the
//! first of an auxiliary node, all of whose degrees of freedom are held. Tangents thus contain the change of the load with
//! the displacements, and columns of the load factor the present force, wherever they are formed.
//!
//! ```text
//! f_a = q P ∫ N_a n da,      p = q P,   P = AUXILIARY_UNIT
//! ```
//!
//! An internal force is the load with the opposite sign. The tangent is not symmetric: see
//! [`loads`](crate::mechanics::structure::elements::solid::loads). The element stores no energy.

use crate::mechanics::AUXILIARY_UNIT;
use crate::mechanics::structure::basis_transformation::BasisTransformation;
use crate::mechanics::structure::element_list::ElementList;
use crate::mechanics::structure::elements::FiniteElement;
use crate::mechanics::structure::elements::solid::any::leading;
use crate::mechanics::structure::elements::solid::formulations::nodal_sums::Nodal;
use crate::mechanics::structure::elements::solid::loads::{pressure_force, write_pressure_stiffness};
use crate::mechanics::structure::elements::solid::shapes::faces::{FaceKind, FacePositions};
use crate::mechanics::structure::elements::solid::shapes::kind::Idealisation;
use crate::mechanics::structure::elements::solid::transformed::push_transformed;

/// A face of `N` nodes under a pressure.
#[derive(Debug, Clone)]
pub struct PressureFace<const N: usize, const D: usize> {
    /// The nodes of the face, then the auxiliary node.
    nodes: Vec<usize>,
    /// Undeformed positions of the face's nodes.
    positions: [[f64; D]; N],
    idealisation: Idealisation,
}

impl<const N: usize, const D: usize> PressureFace<N, D>
where
    [[f64; D]; N]: FacePositions<N, D>,
{
    fn deformed(&self, displacement: &[f64]) -> [[f64; D]; N] {
        let mut positions = self.positions;
        for (position, moved) in positions.iter_mut().flatten().zip(displacement) {
            *position += moved;
        }
        positions
    }

    /// The external forces of a pressure on the nodes of the face.
    fn forces(&self, displacement: &[f64], pressure: f64) -> Nodal<N, D> {
        pressure_force(&self.deformed(displacement), self.idealisation, pressure)
    }

    /// Calls `each(row, column, derivative)` with the derivatives of the external forces by the displacements of the face.
    fn each_slope(&self, displacement: &[f64], mut each: impl FnMut(usize, usize, f64)) {
        let size = N * D;
        let mut slopes = vec![0.0; size * size];
        let pressure = pressure_of::<N, D>(displacement);
        write_pressure_stiffness(&self.deformed(displacement), self.idealisation, pressure, &mut slopes);
        for (row, entries) in slopes.chunks_exact(size).enumerate() {
            entries.iter().enumerate().for_each(|(column, value)| each(row, column, *value));
        }
    }
}

/// The pressure among the displacements of an element.
fn pressure_of<const N: usize, const D: usize>(displacement: &[f64]) -> f64 {
    displacement[N * D] * AUXILIARY_UNIT
}

impl<const N: usize, const D: usize> FiniteElement for PressureFace<N, D>
where
    [[f64; D]; N]: FacePositions<N, D>,
{
    fn nodes(&self) -> &[usize] {
        &self.nodes
    }

    fn is_load(&self) -> bool {
        true
    }

    fn energy(&self, _displacement: &[f64]) -> f64 {
        0.0
    }

    fn write_force(&self, displacement: &[f64], force: &mut [f64]) -> f64 {
        force.fill(0.0);
        let forces = self.forces(displacement, pressure_of::<N, D>(displacement));
        force.iter_mut().zip(forces.iter().flatten()).for_each(|(force, value)| *force = -value);
        forces.iter().flatten().fold(0.0, |most, value| value.abs().max(most))
    }

    fn write_stiffness(&self, displacement: &[f64], stiffness: &mut [f64]) {
        stiffness.fill(0.0);
        let size = (N + 1) * D;
        self.each_slope(displacement, |row, column, slope| stiffness[row * size + column] = -slope);
        let by_pressure = self.forces(displacement, AUXILIARY_UNIT);
        by_pressure.iter().flatten().enumerate().for_each(|(row, force)| stiffness[row * size + N * D] = -force);
    }

    fn write_force_sizes(&self, displacement: &[f64], least: f64, sizes: &mut [f64]) {
        self.write_force(displacement, sizes);
        sizes.iter_mut().for_each(|size| *size = size.abs());
        self.each_slope(displacement, |row, column, slope| {
            sizes[row] += slope.abs() * displacement[column].abs().max(least);
        });
    }

    fn axial_stiffness(&self, _motion: &[f64]) -> f64 {
        0.0
    }
}

/// Adds a face with its outward orientation to a list; `auxiliary`: the node whose first degree of freedom is the
/// pressure. Positions of the face's nodes are undeformed; in the plane the third component does not count.
pub fn push_pressure_face(
    list: &mut ElementList,
    (kind, idealisation): (FaceKind, Idealisation),
    nodes: &[usize],
    positions: &[[f64; 3]],
    auxiliary: usize,
    basis: &BasisTransformation,
) {
    let nodes: Vec<usize> = nodes.iter().copied().chain([auxiliary]).collect();
    let edges = basis.edges_among(&nodes);
    macro_rules! push {
        ($count:literal, $dimension:literal) => {{
            let face = PressureFace::<$count, $dimension> { nodes, positions: leading(positions), idealisation };
            push_transformed(list, face, &edges, $dimension)
        }};
    }
    match kind {
        FaceKind::Segment2 => push!(2, 2),
        FaceKind::Segment3 => push!(3, 2),
        FaceKind::Triangle3 => push!(3, 3),
        FaceKind::Triangle6 => push!(6, 3),
        FaceKind::Quadrilateral4 => push!(4, 3),
        FaceKind::Quadrilateral8 => push!(8, 3),
    }
}
