//! The mixed form of Newton's method: forces in elements as variables of the iteration.
//!
//! Where an element resists stretching far more than bending, the force that the displacements of an iterate give is far
//! off: a transverse correction `w` stretches by `w²/2`, and the axial stiffness multiplies this error. A tangent with
//! such a force is of no use, and the iteration converges from ever closer guesses only. An element of Hellinger and
//! Reissner's kind offers a remedy: its force `F` stays a variable of the iteration, which the correction changes by the
//! linear equations alone (D. Magisano, L. Leonetti, G. Garcea, Int. J. Numer. Meth. Engng 109 (2017) 1237,
//! doi:10.1002/nme.5322). With the energy `L(q, F)` of an element, stationary in `F`,
//!
//! ```text
//! residual  L_q + L_qF ΔF,   ΔF = -L_FF⁻¹ L_F;    tangent  L_qq - L_qF L_FF⁻¹ L_Fq;    F ← F + ΔF - L_FF⁻¹ L_Fq δq
//! ```
//!
//! The solution is that of the displacements: at `L_F = 0` residual and tangent are the usual ones, and the convergence
//! near the solution is quadratic as before.

use crate::mechanics::structure::Structure;
use crate::mechanics::structure::assembly::ElementAt;
use crate::mechanics::structure::elements::FiniteElement;
use smallvec::SmallVec;

/// The forces of all elements that are variables of the iteration, element by element, in the order of the input.
#[derive(Debug, Clone, PartialEq)]
pub struct IndependentForces(Vec<f64>);

/// Numbers over the degrees of freedom of an element.
type ElementVector = SmallVec<[f64; 12]>;

impl IndependentForces {
    /// The forces at given displacements; `None` where no element has independent forces.
    pub fn at(structure: &Structure, displacement: &[f64]) -> Option<Self> {
        if !structure.has_independent_forces() {
            return None;
        }
        let mut forces = Vec::new();
        for at in structure.elements() {
            let first = forces.len();
            forces.resize(first + at.element.independent_forces(), 0.0);
            if forces.len() > first {
                at.element.write_independent_forces(&gathered(at, displacement), &mut forces[first..]);
            }
        }
        Some(Self(forces))
    }

    /// Adds to the forces on all degrees of freedom what the residual of the mixed form exceeds `f_int(u)` by.
    pub fn add_to_residual(&self, structure: &Structure, displacement: &[f64], unbalanced: &mut [f64]) {
        let mut excess = ElementVector::new();
        each(structure, &self.0, |at, own_forces| {
            let own = gathered(at, displacement);
            excess.resize(own.len(), 0.0);
            at.element.write_mixed_excess(&own, own_forces, &mut excess);
            at.freedoms.iter().zip(&excess).for_each(|(freedom, value)| unbalanced[*freedom] += value);
        });
    }

    /// As [`Structure::each_stiffness`], with the tangents of the mixed form; the same entries in the same order.
    /// `write_stiffness` writes the tangents of the elements without independent forces.
    pub fn each_stiffness(
        &self,
        structure: &Structure,
        displacement: &[f64],
        write_stiffness: impl Fn(&dyn FiniteElement, &[f64], &mut [f64]),
        add: &mut impl FnMut(usize, usize, f64),
    ) {
        let mut tangent: SmallVec<[f64; 144]> = SmallVec::new();
        each_of_all(structure, &self.0, |at, own_forces| {
            let own = gathered(at, displacement);
            tangent.resize(own.len() * own.len(), 0.0);
            if own_forces.is_empty() {
                write_stiffness(at.element, &own, &mut tangent);
            } else {
                at.element.write_mixed_stiffness(&own, own_forces, &mut tangent);
            }
            at.alone().each_entry(&tangent, add);
        });
    }

    /// Changes the forces by the linear equations of the mixed form: `change` gives the change of each degree of freedom
    /// from the displacements `from`.
    pub fn advance(&mut self, structure: &Structure, from: &[f64], change: impl Fn(usize) -> f64) {
        let mut own_change = ElementVector::new();
        let mut left = self.0.as_mut_slice();
        for at in structure.elements() {
            let (own_forces, others) = std::mem::take(&mut left).split_at_mut(at.element.independent_forces());
            left = others;
            if own_forces.is_empty() {
                continue;
            }
            own_change.clear();
            own_change.extend(at.freedoms.iter().map(|freedom| change(*freedom)));
            at.element.advance_independent_forces(&gathered(at, from), &own_change, own_forces);
        }
    }
}

fn gathered(at: ElementAt<'_>, displacement: &[f64]) -> ElementVector {
    at.freedoms.iter().map(|freedom| displacement[*freedom]).collect()
}

/// Calls `f` for every element with the element's independent forces.
fn each_of_all(structure: &Structure, forces: &[f64], mut f: impl FnMut(ElementAt<'_>, &[f64])) {
    let mut left = forces;
    for at in structure.elements() {
        let (own, others) = left.split_at(at.element.independent_forces());
        left = others;
        f(at, own);
    }
}

/// Calls `f` for the elements that have independent forces.
fn each(structure: &Structure, forces: &[f64], mut f: impl FnMut(ElementAt<'_>, &[f64])) {
    each_of_all(structure, forces, |at, own| {
        if !own.is_empty() {
            f(at, own);
        }
    });
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::mechanics::structure::element_list::ElementList;
    use crate::mechanics::structure::elements::beam::Beam;
    use crate::mechanics::structure::elements::beam::segment::SectionStiffness;
    use nalgebra::{DMatrix, DVector};

    const ELEMENTS: usize = 8;

    /// A clamped beam of unit length and unit bending stiffness.
    fn cantilever(slenderness: f64) -> Structure {
        let section = SectionStiffness { axial: slenderness * slenderness, bending: 1.0, shear: None };
        let chord = [1.0 / ELEMENTS as f64, 0.0];
        let elements = (0..ELEMENTS).map(|place| Beam::straight([place, place + 1], chord, section));
        let clamped = [(0, 0), (0, 1), (0, 2)];
        Structure::new(2, ELEMENTS + 1, &clamped, elements.collect::<ElementList>())
    }

    /// The size of the correction in each iteration from the beam at rest, with a force at the tip.
    fn corrections(structure: &Structure, load: f64) -> (Vec<f64>, Vec<f64>) {
        let mut displacement = vec![0.0; structure.freedoms()];
        let mut forces = IndependentForces::at(structure, &displacement).expect("beams have independent forces");
        let mut corrections = Vec::new();
        for _ in 0..10 {
            let mut unbalanced = vec![0.0; structure.freedoms()];
            structure.internal_force(&displacement, &mut unbalanced);
            forces.add_to_residual(structure, &displacement, &mut unbalanced);
            unbalanced[structure.translations_of(ELEMENTS).start + 1] -= load;
            let unknowns = structure.unknowns();
            let mut tangent = DMatrix::zeros(unknowns, unknowns);
            let mut add = |row: usize, column: usize, value: f64| {
                if let (Some(row), Some(column)) = (structure.unknown_of[row], structure.unknown_of[column]) {
                    tangent[(row, column)] += value;
                }
            };
            let none = |_: &dyn FiniteElement, _: &[f64], _: &mut [f64]| unreachable!("all elements are beams");
            forces.each_stiffness(structure, &displacement, none, &mut add);
            let residual = DVector::from_iterator(unknowns, structure.freedom_of.iter().map(|k| unbalanced[*k]));
            let correction = tangent.lu().solve(&residual).expect("the tangent is regular");
            let before = displacement.clone();
            structure.freedom_of.iter().zip(&correction).for_each(|(k, value)| displacement[*k] -= value);
            forces.advance(structure, &before, |k| displacement[k] - before[k]);
            corrections.push(correction.norm());
        }
        (corrections, displacement)
    }

    #[test]
    fn the_number_of_iterations_does_not_grow_with_slenderness() {
        for slenderness in [1e1, 1e2, 1e3, 1e4, 1e5, 1e6] {
            let structure = cantilever(slenderness);
            let (corrections, displacement) = corrections(&structure, 2.0);
            println!("{slenderness:e}: {corrections:?}");
            assert!(corrections[6] < 1e-9, "{slenderness:e}: {corrections:?}");
            let mut balance = vec![0.0; structure.freedoms()];
            structure.internal_force(&displacement, &mut balance);
            balance[structure.translations_of(ELEMENTS).start + 1] -= 2.0;
            // The rounding of displacements strains the beam.
            let left = structure.freedom_of.iter().fold(0.0_f64, |most, k| most.max(balance[*k].abs()));
            assert!(left < 1e-12 + 1e-15 * slenderness * slenderness, "{slenderness:e}: {left:e}");
        }
    }

    #[test]
    fn at_the_forces_of_the_displacements_the_mixed_form_is_the_usual_one() {
        let structure = cantilever(30.0);
        let displacement: Vec<f64> = (0..structure.freedoms()).map(|k| 0.1 * (1.3 * k as f64).sin()).collect();
        let forces = IndependentForces::at(&structure, &displacement).expect("beams have independent forces");
        let mut excess = vec![0.0; structure.freedoms()];
        forces.add_to_residual(&structure, &displacement, &mut excess);
        let mut usual = Vec::new();
        structure.each_stiffness(&displacement, &mut |row, column, value| usual.push((row, column, value)));
        let largest = usual.iter().fold(0.0_f64, |most, (.., value)| most.max(value.abs()));
        assert!(excess.iter().all(|value| value.abs() < 1e-14 * largest));
        let mut expected = usual.iter();
        let none = |_: &dyn FiniteElement, _: &[f64], _: &mut [f64]| unreachable!("all elements are beams");
        forces.each_stiffness(&structure, &displacement, none, &mut |row, column, value| {
            let (of_row, of_column, usual) = expected.next().expect("as many entries");
            assert!((row, column) == (*of_row, *of_column) && (value - usual).abs() < 1e-14 * largest);
        });
        assert!(expected.next().is_none());
        // The forces follow a small motion to second order.
        let [one, other] = [1e-3, 5e-4].map(|step| {
            let moved: Vec<f64> =
                displacement.iter().enumerate().map(|(k, value)| value + step * (0.7 * k as f64).cos()).collect();
            let mut followed = forces.clone();
            followed.advance(&structure, &displacement, |k| moved[k] - displacement[k]);
            let exact = IndependentForces::at(&structure, &moved).expect("beams have independent forces");
            followed.0.iter().zip(&exact.0).fold(0.0_f64, |most, (one, other)| most.max((one - other).abs()))
        });
        assert!((one / other - 4.0).abs() < 0.1, "{one:e} {other:e}");
    }
}
