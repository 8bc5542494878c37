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

/// The unit vectors of the axes.
pub(crate) const AXES: [Vector; 3] = [[1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]];

/// The degree of freedom of the structure for each that moves a coupled contact.
fn freedom_of<'a>(structure: &'a Structure, coupled: &'a dyn CoupledKinematics) -> impl Fn(usize) -> usize + 'a {
    let count = structure.dimension + coupled.rotations();
    move |at| structure.numbering.freedoms_of(coupled.nodes()[at / count]).start + at % count
}

/// The displacement `m(u)` of a contact, in the axes of its obstacle.
#[inline(always)]
pub fn moved(structure: &Structure, contact: &ContactPair, displacement: &[f64]) -> Vector {
    match &contact.kinematics {
        Kinematics::Node(node) => structure.translation_at(*node, displacement),
        Kinematics::Coupled(coupled) => {
            let freedom = freedom_of(structure, coupled.as_ref());
            coupled.place(&|at| displacement[freedom(at)])
        }
    }
}

/// The motion `∫ B du` of a coupled contact between two positions of one path, in the axes of its obstacle; `None` for a
/// single node, whose motion is the difference of its positions.
#[inline(always)]
pub fn coupled_motion(structure: &Structure, contact: &ContactPair, from: &[f64], to: &[f64]) -> Option<Vector> {
    let Kinematics::Coupled(coupled) = &contact.kinematics else { return None };
    let freedom = freedom_of(structure, coupled.as_ref());
    Some(coupled.motion(&|at| from[freedom(at)], &|at| to[freedom(at)]))
}

/// A distance that has to be covered before a contact can close, and by how much a unit motion of the degrees of freedom
/// shortens it at most; the gap of a single node bounds itself. A contact without a bound has no distance to cover.
pub fn clearance(structure: &Structure, contact: &ContactPair, displacement: &[f64], gap: f64) -> (f64, f64) {
    match &contact.kinematics {
        Kinematics::Node(_) => (gap, 1.0),
        Kinematics::Coupled(coupled) => {
            let freedom = freedom_of(structure, coupled.as_ref());
            coupled.clearance(&|at| displacement[freedom(at)]).unwrap_or((0.0, 1.0))
        }
    }
}

/// See [`CoupledKinematics::distance_to_end`]; infinite for a single node.
pub fn distance_to_end(structure: &Structure, contact: &ContactPair, displacement: &[f64]) -> f64 {
    let Kinematics::Coupled(coupled) = &contact.kinematics else { return f64::INFINITY };
    let freedom = freedom_of(structure, coupled.as_ref());
    coupled.distance_to_end(&|at| displacement[freedom(at)])
}

/// See [`CoupledKinematics::beyond_end`]; `None` for a single node.
pub fn beyond_end(structure: &Structure, contact: &ContactPair, displacement: &[f64]) -> Option<f64> {
    let Kinematics::Coupled(coupled) = &contact.kinematics else { return None };
    let freedom = freedom_of(structure, coupled.as_ref());
    coupled.beyond_end(&|at| displacement[freedom(at)])
}

/// The force of a contact on the body of the node that the contact is named after, in the axes of space: most of it acts
/// on this node, and all of it where the surfaces fit each other.
pub fn force_on_own_body(structure: &Structure, contact: &ContactPair, displacement: &[f64], force: &Vector) -> Vector {
    let mut total = [0.0; 3];
    each_column(structure, contact, displacement, |freedom, column| {
        let mut own = contact.kinematics.own_nodes().iter().map(|node| structure.translations_of(*node));
        if let Some(translations) = own.find(|translations| translations.contains(&freedom)) {
            total[freedom - translations.start] += dot(column, force);
        }
    });
    total
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
            let freedom = freedom_of(structure, coupled.as_ref());
            coupled.each_column(&|at| displacement[freedom(at)], &mut |at, column| each(freedom(at), column));
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
    let freedom = freedom_of(structure, coupled.as_ref());
    coupled.each_curvature(&|at| displacement[freedom(at)], force, &mut |row, column, value| {
        add(freedom(row), freedom(column), value);
    });
}
