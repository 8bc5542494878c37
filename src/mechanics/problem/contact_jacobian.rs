//! The motion of a contact with the degrees of freedom of the structure, and its forces on them.
//!
//! ```text
//! x = m(u),      ẋ = B(u) u̇,      f = Bᵀ r
//! ```
//!
//! For a node in front of a rigid obstacle `B` selects its translations; see `contact::kinematics` for the others.

use crate::mechanics::contact::ContactPair;
use crate::mechanics::contact::kinematics::{CoupledKinematics, Kinematics};
use crate::mechanics::contact::vector::{Vector, add, dot};
use crate::mechanics::structure::Structure;
use smallvec::SmallVec;

/// The unit vectors of the axes.
pub(crate) const AXES: [Vector; 3] = [[1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]];

/// The degrees of freedom that move a coupled contact, and their values.
fn gathered(
    structure: &Structure,
    coupled: &dyn CoupledKinematics,
    values: &[f64],
) -> (SmallVec<[usize; 12]>, SmallVec<[f64; 12]>) {
    let count = structure.dimension + coupled.rotations();
    let of_node = |node: &usize| structure.numbering.freedoms_of(*node).take(count);
    let freedoms: SmallVec<[usize; 12]> = coupled.nodes().iter().flat_map(of_node).collect();
    let own = freedoms.iter().map(|freedom| values[*freedom]).collect();
    (freedoms, own)
}

/// The displacement `m(u)` of a contact, in the axes of its obstacle.
#[inline(always)]
pub fn moved(structure: &Structure, contact: &ContactPair, displacement: &[f64]) -> Vector {
    match &contact.kinematics {
        Kinematics::Node(node) => structure.translation_at(*node, displacement),
        Kinematics::Coupled(coupled) => coupled.place(&gathered(structure, coupled.as_ref(), displacement).1),
    }
}

/// The velocity `B(u) u̇` of a contact.
#[inline(always)]
pub fn velocity(structure: &Structure, contact: &ContactPair, displacement: &[f64], rate: &[f64]) -> Vector {
    match &contact.kinematics {
        Kinematics::Node(node) => structure.translation_at(*node, rate),
        Kinematics::Coupled(_) => {
            let mut sum = [0.0; 3];
            each_column(structure, contact, displacement, |freedom, column| sum = add(&sum, rate[freedom], column));
            sum
        }
    }
}

/// Calls `each(freedom, column)` with the columns of `B(u)`: the motion of the contact per degree of freedom.
#[inline(always)]
pub fn each_column(
    structure: &Structure,
    contact: &ContactPair,
    displacement: &[f64],
    mut each: impl FnMut(usize, &Vector),
) {
    match &contact.kinematics {
        Kinematics::Node(node) => {
            structure.translations_of(*node).zip(&AXES).for_each(|(freedom, axis)| each(freedom, axis));
        }
        Kinematics::Coupled(coupled) => {
            let (freedoms, own) = gathered(structure, coupled.as_ref(), displacement);
            let mut columns: SmallVec<[Vector; 12]> = SmallVec::from_elem([0.0; 3], freedoms.len());
            coupled.write_columns(&own, &mut columns);
            freedoms.iter().zip(&columns).for_each(|(freedom, column)| each(*freedom, column));
        }
    }
}

/// Adds a multiple of the forces `Bᵀ r` of a contact to the forces on the degrees of freedom.
#[inline(always)]
pub fn add_force(
    structure: &Structure,
    contact: &ContactPair,
    displacement: &[f64],
    force: &Vector,
    factor: f64,
    forces: &mut [f64],
) {
    each_column(structure, contact, displacement, |freedom, column| forces[freedom] += factor * dot(column, force));
}

/// Calls `add(row, column, value)` with the entries of `∂(Bᵀ r)/∂u` at a constant force; none for a single node.
pub fn each_curvature(
    structure: &Structure,
    contact: &ContactPair,
    displacement: &[f64],
    force: &Vector,
    mut add: impl FnMut(usize, usize, f64),
) {
    let Kinematics::Coupled(coupled) = &contact.kinematics else { return };
    let (freedoms, own) = gathered(structure, coupled.as_ref(), displacement);
    let mut curvature: SmallVec<[f64; 36]> = SmallVec::from_elem(0.0, freedoms.len() * freedoms.len());
    coupled.write_curvature(&own, force, &mut curvature);
    for (row, values) in freedoms.iter().zip(curvature.chunks_exact(freedoms.len())) {
        freedoms.iter().zip(values).for_each(|(column, value)| add(*row, *column, *value));
    }
}
