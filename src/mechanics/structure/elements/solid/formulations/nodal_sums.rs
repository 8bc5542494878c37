//! From the quantities at a point to those of the nodes: `f_ai = Σ_s P_is g_as`, `K_aibk = Σ_st g_as A_iskt g_bt`.

use crate::mechanics::structure::elements::solid::formulations::response::{Slots2, Slots4};

/// A value for each node and direction.
pub type Nodal<const N: usize, const D: usize> = [[f64; D]; N];

/// The displacement gradient in slots.
#[inline(always)]
pub fn gradient<const N: usize, const D: usize, const S: usize>(
    displacement: &Nodal<N, D>,
    slots: &[[f64; S]; N],
) -> Slots2<D, S> {
    let mut gradient = [[0.0; S]; D];
    for (displacement, slots) in displacement.iter().zip(slots) {
        for (row, value) in gradient.iter_mut().zip(displacement) {
            row.iter_mut().zip(slots).for_each(|(entry, slot)| *entry += value * slot);
        }
    }
    gradient
}

/// Adds the nodal forces of a stress times a volume.
#[inline(always)]
pub fn add_forces<const N: usize, const D: usize, const S: usize>(
    stress: &Slots2<D, S>,
    volume: f64,
    slots: &[[f64; S]; N],
    forces: &mut Nodal<N, D>,
) {
    let stress = stress.map(|row| row.map(|value| volume * value));
    for (force, slots) in forces.iter_mut().zip(slots) {
        for (value, row) in force.iter_mut().zip(&stress) {
            *value += row.iter().zip(slots).map(|(stress, slot)| stress * slot).sum::<f64>();
        }
    }
}

/// Adds the stiffness of a tangent times a volume, in the blocks of nodes on and above the diagonal; see
/// [`mirror`].
#[inline(always)]
pub fn add_stiffness<const N: usize, const D: usize, const S: usize>(
    tangent: &Slots4<D, S>,
    volume: f64,
    slots: &[[f64; S]; N],
    stiffness: &mut [f64],
) {
    for (node, own) in slots.iter().enumerate() {
        // Σ_s g_as A_iskt, times the volume.
        let mut applied = [[[0.0; S]; D]; D];
        for (applied, tangent) in applied.iter_mut().zip(tangent) {
            for (tangent, slot) in tangent.iter().zip(own) {
                let factor = volume * slot;
                for (applied, tangent) in applied.iter_mut().zip(tangent) {
                    applied.iter_mut().zip(tangent).for_each(|(value, tangent)| *value += factor * tangent);
                }
            }
        }
        for (row, applied) in applied.iter().enumerate() {
            let entries = &mut stiffness[((node * D + row) * N + node) * D..][..(N - node) * D];
            for (entries, other) in entries.chunks_exact_mut(D).zip(&slots[node..]) {
                for (entry, applied) in entries.iter_mut().zip(applied) {
                    *entry += applied.iter().zip(other).map(|(value, slot)| value * slot).sum::<f64>();
                }
            }
        }
    }
}

/// Adds `factor (a bᵀ + b aᵀ)` in the blocks of nodes on and above the diagonal.
#[inline(always)]
pub fn add_symmetric_dyad<const N: usize, const D: usize>(
    factor: f64,
    a: &Nodal<N, D>,
    b: &Nodal<N, D>,
    stiffness: &mut [f64],
) {
    for node in 0..N {
        for row in 0..D {
            let (of_a, of_b) = (factor * a[node][row], factor * b[node][row]);
            let entries = &mut stiffness[((node * D + row) * N + node) * D..][..(N - node) * D];
            let others = a[node..].iter().flatten().zip(b[node..].iter().flatten());
            entries.iter_mut().zip(others).for_each(|(entry, (a, b))| *entry += of_a * b + of_b * a);
        }
    }
}

/// Copies the upper triangle to the lower one.
#[inline(always)]
pub fn mirror(size: usize, stiffness: &mut [f64]) {
    for row in 1..size {
        let (above, below) = stiffness.split_at_mut(row * size);
        let entries = below[..row].iter_mut().zip(above.chunks_exact(size));
        entries.for_each(|(entry, other)| *entry = other[row]);
    }
}
