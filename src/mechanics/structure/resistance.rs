//! The resistance of the elements to a motion.
//!
//! An element that carries no force does not resist a motion `v` where `K_e v = 0`. Elements that carry force may turn
//! with it: a part under self-stress that moves as a rigid body, with the spin `ω`, changes the forces of its elements
//! by `K_e v = ω × f_e`, and nothing resists where these changes cancel at every node.

use crate::mechanics::structure::Structure;
use crate::mechanics::structure::assembly::{ElementAt, ForceBuffer, StiffnessBuffer};
use nalgebra::{Matrix3, Vector3};
use std::collections::BTreeMap;

/// Change of an element's forces, over its stiffness times the size of the motion, up to which the element counts as
/// unmoved by itself. It lies above round-off and below the margins to which resistances are compared.
const UNCHANGED: f64 = 1e-11;

/// Singular value, relative to the largest, below which forces do not say how their element spins: all are parallel.
const PARALLEL: f64 = 1e-9;

/// An element's forces and their change under a motion.
struct MovedElement<'a> {
    at: ElementAt<'a>,
    /// Nodal forces, one for each of the element's degrees of freedom.
    force: Vec<f64>,
    /// Change of the nodal forces.
    change: Vec<f64>,
    /// The stiffness to which the change of each nodal force is compared.
    stiffness: Vec<f64>,
}

impl MovedElement<'_> {
    /// The largest change over the stiffness times the size of the motion.
    fn resistance(&self, size: f64) -> f64 {
        let changes = self.change.iter().zip(&self.stiffness).filter(|(_, stiffness)| **stiffness > 0.0);
        changes.fold(0.0, |most, (change, stiffness)| f64::max(most, change.abs() / (stiffness * size)))
    }

    /// The largest stiffness against translations, and against rotations.
    fn largest_stiffness(&self, dimension: usize) -> [f64; 2] {
        let per_node = self.force.len() / self.at.element.nodes().len();
        let mut largest = [0.0_f64; 2];
        for (place, stiffness) in self.stiffness.iter().enumerate() {
            let kind = usize::from(place % per_node >= dimension);
            largest[kind] = largest[kind].max(*stiffness);
        }
        largest
    }

    /// Forces and moments at the element's nodes with their changes; in 2D forces lie in the plane, and moments turn
    /// about its normal.
    fn vectors(&self, dimension: usize) -> impl Iterator<Item = (Vector3<f64>, Vector3<f64>)> {
        let vector = |values: &[f64]| match values {
            [x, y] => Vector3::new(*x, *y, 0.0),
            [x, y, z] => Vector3::new(*x, *y, *z),
            [moment] => Vector3::new(0.0, 0.0, *moment),
            _ => Vector3::zeros(),
        };
        let per_node = self.force.len() / self.at.element.nodes().len();
        self.force.chunks(per_node).zip(self.change.chunks(per_node)).flat_map(move |(force, change)| {
            let (force, moment) = force.split_at(dimension);
            let (change, turned) = change.split_at(dimension);
            [(vector(force), vector(change)), (vector(moment), vector(turned))]
        })
    }
}

/// [`Structure::resistance`].
pub fn resistance(structure: &Structure, displacement: &[f64], rate: &[f64]) -> f64 {
    let size = rate.iter().fold(0.0_f64, |size, value| size.max(value.abs()));
    if size == 0.0 {
        return 0.0;
    }
    let mut buffers = (StiffnessBuffer::default(), ForceBuffer::default());
    let (mut largest, mut turning) = (0.0_f64, Vec::new());
    for at in structure.elements().filter(|at| !at.element.is_load()) {
        let moved = moved(at, displacement, rate, &mut buffers);
        let resistance = moved.resistance(size);
        if at.element.is_linear() || resistance <= UNCHANGED {
            largest = largest.max(resistance);
        } else {
            turning.push(moved);
        }
    }
    parts(&turning).iter().map(|part| resistance_of(part, structure.dimension, size)).fold(largest, f64::max)
}

fn moved<'a>(
    at: ElementAt<'a>,
    displacement: &[f64],
    rate: &[f64],
    (stiffnesses, forces): &mut (StiffnessBuffer, ForceBuffer),
) -> MovedElement<'a> {
    let count = at.freedoms.len();
    let place = |freedom: usize| at.freedoms.iter().position(|own| *own == freedom);
    let (mut force, mut change, mut of_row) = (vec![0.0; count], vec![0.0; count], vec![0.0_f64; count]);
    at.alone().each_force(displacement, forces, |freedom, value| {
        if let Some(place) = place(freedom) {
            force[place] += value;
        }
    });
    at.alone().each_stiffness(displacement, stiffnesses, &mut |row, column, value: f64| {
        if let Some(place) = place(row) {
            change[place] += value * rate[column];
            of_row[place] = of_row[place].max(value.abs());
        }
    });
    let stiffest = of_row.iter().fold(0.0_f64, |most, stiffness| most.max(*stiffness));
    if !at.element.is_linear() {
        of_row.iter_mut().enumerate().for_each(|(freedom, stiffness)| {
            *stiffness = at.element.least_stiffness(freedom).unwrap_or(stiffest);
        });
    }
    MovedElement { at, force, change, stiffness: of_row }
}

/// The elements in groups that share nodes.
fn parts<'a, 'b>(elements: &'b [MovedElement<'a>]) -> Vec<Vec<&'b MovedElement<'a>>> {
    // The part of each element is the smallest index of an element that it is joined to.
    let mut joined: Vec<usize> = (0..elements.len()).collect();
    fn root(joined: &mut [usize], mut index: usize) -> usize {
        while joined[index] != index {
            joined[index] = joined[joined[index]];
            index = joined[index];
        }
        index
    }
    let mut first_at: BTreeMap<usize, usize> = BTreeMap::new();
    for (index, element) in elements.iter().enumerate() {
        for node in element.at.element.nodes() {
            let other = *first_at.entry(*node).or_insert(index);
            let (one, other) = (root(&mut joined, index), root(&mut joined, other));
            joined[one.max(other)] = one.min(other);
        }
    }
    let mut parts: BTreeMap<usize, Vec<&MovedElement<'_>>> = BTreeMap::new();
    for (index, element) in elements.iter().enumerate() {
        parts.entry(root(&mut joined, index)).or_default().push(element);
    }
    parts.into_values().collect()
}

/// The resistance of elements that share nodes: what is left over of `K_e v = ω × f_e` with the spin that fits best, and
/// of the sum of the changes at each node.
fn resistance_of(part: &[&MovedElement<'_>], dimension: usize, size: f64) -> f64 {
    let alone = part.iter().fold(0.0, |most, element| f64::max(most, element.resistance(size)));
    // Least squares: Σ (|f|² I - f fᵀ) ω = Σ f × K_e v.
    let (mut matrix, mut moment) = (Matrix3::zeros(), Vector3::zeros());
    for (force, change) in part.iter().flat_map(|element| element.vectors(dimension)) {
        matrix += Matrix3::identity() * force.norm_squared() - force * force.transpose();
        moment += force.cross(&change);
    }
    let decomposition = matrix.svd(true, true);
    let Ok(spin) = decomposition.solve(&moment, PARALLEL * decomposition.singular_values.max()) else { return alone };
    let (mut left_over, mut stiffest) = (0.0_f64, [0.0_f64; 2]);
    // For each degree of freedom whether it is a rotation, and the sum.
    let mut sums: BTreeMap<usize, (usize, f64)> = BTreeMap::new();
    for element in part {
        let stiffness = element.largest_stiffness(dimension);
        (0..2).for_each(|kind| stiffest[kind] = stiffest[kind].max(stiffness[kind]));
        for ((force, change), kind) in element.vectors(dimension).zip([0, 1].into_iter().cycle()) {
            if stiffness[kind] > 0.0 {
                left_over = left_over.max((change - spin.cross(&force)).amax() / (stiffness[kind] * size));
            }
        }
        let per_node = element.force.len() / element.at.element.nodes().len();
        for (place, (freedom, change)) in element.at.freedoms.iter().zip(&element.change).enumerate() {
            sums.entry(*freedom).or_insert((usize::from(place % per_node >= dimension), 0.0)).1 += change;
        }
    }
    let together = sums.values().fold(left_over, |most, (kind, sum)| {
        if stiffest[*kind] > 0.0 { most.max(sum.abs() / (stiffest[*kind] * size)) } else { most }
    });
    together.min(alone)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::mechanics::structure::element_list::ElementList;
    use crate::mechanics::structure::elements::bar::{Bar, Strain};

    /// Five nodes in space, each joined to each: one more bar than holds them, and so one state of self-stress.
    const NODES: [[f64; 3]; 5] = [[0.0, 0.0, 0.0], [1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0], [0.7, 0.9, 0.8]];

    fn bars() -> Vec<(usize, usize)> {
        (0..5).flat_map(|one| (one + 1..5).map(move |other| (one, other))).collect()
    }

    fn difference(one: usize, other: usize) -> [f64; 3] {
        [0, 1, 2].map(|axis| NODES[other][axis] - NODES[one][axis])
    }

    /// The self-stress with the force densities `q_ij = c_i c_j`, where `Σ c_i = 0` and `Σ c_i x_i = 0`.
    fn self_stress() -> Vec<f64> {
        let last = NODES[4];
        let share = [1.0 - last[0] - last[1] - last[2], last[0], last[1], last[2], -1.0];
        bars().iter().map(|(one, other)| share[*one] * share[*other]).collect()
    }

    fn structure(scale: f64) -> Structure {
        let bars = bars().into_iter().zip(self_stress()).map(|((one, other), density)| {
            let reference = difference(one, other);
            let length = reference.iter().map(|value| value * value).sum::<f64>().sqrt();
            Bar {
                nodes: [one, other],
                reference,
                reference_length: length,
                axial_stiffness: 1.0,
                rest_length: length,
                prestress: scale * density * length,
                strain: Strain::Engineering,
            }
        });
        let mut elements = ElementList::default();
        bars.for_each(|bar| elements.push(bar));
        Structure::new(3, 5, &[], elements)
    }

    fn spin(about: [f64; 3]) -> Vec<f64> {
        let turn = |x: &[f64; 3]| {
            [about[1] * x[2] - about[2] * x[1], about[2] * x[0] - about[0] * x[2], about[0] * x[1] - about[1] * x[0]]
        };
        NODES.iter().flat_map(turn).collect()
    }

    #[test]
    fn a_body_under_self_stress_does_not_resist_its_spin() {
        let still = [0.0; 15];
        for scale in [0.0, 1e-3, 0.1] {
            let structure = structure(scale);
            for about in [[1.0, 0.0, 0.0], [0.3, -0.5, 0.8]] {
                assert!(structure.resistance(&still, &spin(about)) < 1e-14, "{scale} {about:?}");
            }
            let mut stretched = spin([0.0, 0.0, 1.0]);
            stretched[12] += 1e-3;
            assert!(structure.resistance(&still, &stretched) > 1e-5);
        }
    }

    #[test]
    fn a_part_that_carries_force_resists_its_spin() {
        let reference = [1.0, 0.0, 0.0];
        let (reference_length, axial_stiffness, rest_length) = (1.0, 1.0, 1.0);
        let strain = Strain::Engineering;
        let bar =
            Bar { nodes: [0, 1], reference, reference_length, axial_stiffness, rest_length, prestress: 0.1, strain };
        let mut elements = ElementList::default();
        elements.push(bar);
        let structure = Structure::new(3, 2, &[], elements);
        let turned = [0.0, 0.0, 0.0, 0.0, 1.0, 0.0];
        assert!((structure.resistance(&[0.0; 6], &turned) - 0.1).abs() < 1e-12);
    }
}
