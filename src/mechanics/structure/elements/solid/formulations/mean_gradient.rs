//! Quadrilaterals of 4 and hexahedra of 8 nodes with the mean deformation gradient.
//!
//! The material's energy sees the exact mean `F̄` of the deformation gradient over the undeformed element; what the mean
//! does not see has a quadratic energy with constant coefficients (B. Nadler, M. B. Rubin, Int. J. Solids Struct. 40
//! (2003) 4585, doi:10.1016/S0020-7683(03)00210-5; D. S. Mueller-Hoeppe, S. Loehnert, P. Wriggers, Int. J. Numer. Methods
//! Eng. 77 (2009) 1849, doi:10.1002/nme.2464; compare S. Reese, Comput. Methods Appl. Mech. Eng. 194 (2005) 4685,
//! doi:10.1016/j.cma.2004.12.012):
//!
//! ```text
//! W_e = V W(F̄) + ½ z·H z,     z = (β_1, …, β_m),     β_i = F̄⁻¹ Σ_a Γ_ia x_a = F̄⁻¹ d_i - D_i
//! ```
//!
//! `d_i` and `D_i` are the coefficients of the products `ξη, ηζ, ζξ, ξηζ` in the deformed and in the undeformed position,
//! and `Γ_ia = c_ia - ḡ_a·D_i` with `d_i = Σ_a c_ia x_a`, so that `β` vanishes in every homogeneous deformation: the patch
//! test holds on distorted elements. `β` does not change in rotations, and `H` is positive definite, so that in a
//! homogeneous state the tangent has the negative eigenvalues that the material has, and no others: there are no hourglass
//! instabilities. There is one constraint of volume an element, and no locking. `H` is that of
//! [`hourglass_stiffness`](crate::mechanics::structure::elements::solid::formulations::hourglass_stiffness).
//!
//! In a body of revolution the mean strain around the axis leaves its gradient unseen, with which a turning cross-section
//! is strained. The stretch is `r/R`, its gradient `((F_11 - r/R)/R, F_12/R)`: `z` has two more entries,
//! `ℓ (F̄_11 - F̄_33)` and `ℓ F̄_12`, linear in the displacement (`ℓ² = ` area of the cross-section).

use crate::mechanics::structure::elements::materials::tensor::{IDENTITY, Tensor2, cofactor, determinant, sum};
use crate::mechanics::structure::elements::solid::formulations::nodal_sums::{
    Nodal, add_forces, add_stiffness, gradient,
};
use crate::mechanics::structure::elements::solid::formulations::{
    Body, Formulation, PointStress, add_force_sizes, ratio_of,
};
use crate::mechanics::structure::elements::solid::shapes::geometry::{PointGeometry, ReferenceGeometry};
use crate::mechanics::structure::elements::solid::shapes::shape_functions::{HEXAHEDRON, QUADRILATERAL, ShapePoint};
use std::array::from_fn;

/// Most inhomogeneous strains `z`.
pub const MOST_STRAINS: usize = 12;

/// The mean geometry of an element and its stiffness against inhomogeneous strains.
#[derive(Debug, Clone)]
pub struct MeanGradient<const N: usize, const D: usize> {
    /// Undeformed volume.
    pub volume: f64,
    /// Mean slots `ḡ_a` of the nodes: see [`geometry`](crate::mechanics::structure::elements::solid::shapes::geometry).
    slots: [[f64; 3]; N],
    /// `Γ_i`, a row for each inhomogeneous vector.
    modes: Vec<[f64; N]>,
    /// The length `ℓ` in a body of revolution, else 0.
    hoop_length: f64,
    /// `H`, row by row, in the unit of stress times length.
    stiffness: Vec<f64>,
}

/// The inhomogeneous strains of a displacement.
struct Inhomogeneity<const N: usize, const D: usize> {
    /// `F̄⁻¹`.
    inverse: Tensor2,
    /// `z`.
    strains: [f64; MOST_STRAINS],
    /// `H z`.
    forces: [f64; MOST_STRAINS],
    /// `Γ_ia - ḡ_a·β_i`, by which the displacement of node `a` changes `F̄ β_i`.
    weights: [[f64; 4]; N],
}

impl<const N: usize, const D: usize> MeanGradient<N, D> {
    /// The mean geometry; `H` is still to be given: see [`Self::with_stiffness`].
    pub fn new<const S: usize>(geometry: &ReferenceGeometry<N, D>, shape: &[ShapePoint<N, D>]) -> Self {
        let (mut volume, mut area, mut slots) = (0.0, 0.0, [[0.0; 3]; N]);
        for point in shape {
            let at: PointGeometry<N, S> = geometry.at(point);
            volume += at.volume;
            area += point.weight * geometry.jacobian_determinant(point);
            for (mean, own) in slots.iter_mut().zip(&at.slots) {
                mean.iter_mut().zip(own).for_each(|(mean, own)| *mean += at.volume * own);
            }
        }
        slots.iter_mut().flatten().for_each(|value| *value /= volume);
        let natural =
            |node: usize, axis: usize| if D == 2 { QUADRILATERAL[node][axis] } else { HEXAHEDRON[node][axis] };
        // The products of natural coordinates that the inhomogeneous vectors go with.
        let products: &[&[usize]] = if D == 2 { &[&[0, 1]] } else { &[&[1, 2], &[0, 2], &[0, 1], &[0, 1, 2]] };
        let mode = |axes: &&[usize]| {
            let coefficients: [f64; N] =
                from_fn(|node| axes.iter().map(|axis| natural(node, *axis)).product::<f64>() / N as f64);
            let undeformed: [f64; D] = from_fn(|axis| {
                coefficients.iter().zip(&geometry.positions).map(|(value, position)| value * position[axis]).sum()
            });
            from_fn(|node| {
                let linear: f64 = slots[node].iter().zip(&undeformed).map(|(slot, value)| slot * value).sum();
                coefficients[node] - linear
            })
        };
        let modes = products.iter().map(mode).collect();
        let hoop_length = if S > D { area.sqrt() } else { 0.0 };
        Self { volume, slots, modes, hoop_length, stiffness: Vec::new() }
    }

    /// With the stiffness `H`, row by row.
    #[must_use]
    pub fn with_stiffness(self, stiffness: Vec<f64>) -> Self {
        Self { stiffness, ..self }
    }

    /// The mean slots.
    #[inline(always)]
    pub fn slots<const S: usize>(&self) -> [[f64; S]; N] {
        self.slots.map(|slots| from_fn(|slot| slots[slot]))
    }

    /// Number of inhomogeneous strains.
    pub fn strains(&self) -> usize {
        D * self.modes.len() + if self.hoop_length > 0.0 { 2 } else { 0 }
    }

    /// Writes the derivatives of `z` by the displacement of a node, row by row, in place of zeros.
    #[inline(always)]
    fn write_slopes(&self, node: usize, inverse: &Tensor2, weights: &[f64; 4], slopes: &mut [[f64; D]; MOST_STRAINS]) {
        let modes = self.modes.len();
        for (rows, weight) in slopes.chunks_exact_mut(D).zip(&weights[..modes]) {
            rows.iter_mut().zip(inverse).for_each(|(row, inverse)| *row = from_fn(|axis| weight * inverse[axis]));
        }
        if self.hoop_length > 0.0 {
            let [radial, axial, hoop] = self.slots[node];
            slopes[D * modes][0] = self.hoop_length * (radial - hoop);
            slopes[D * modes + 1][0] = self.hoop_length * axial;
        }
    }

    /// The derivatives of `z` by the displacement of each node in the undeformed state.
    pub fn slopes_at_rest(&self, node: usize) -> [[f64; D]; MOST_STRAINS] {
        let mut slopes = [[0.0; D]; MOST_STRAINS];
        self.write_slopes(node, &IDENTITY, &self.weights(node), &mut slopes);
        slopes
    }

    /// The entries `Γ_ia` of a node.
    #[inline(always)]
    fn weights(&self, node: usize) -> [f64; 4] {
        from_fn(|mode| self.modes.get(mode).map_or(0.0, |mode| mode[node]))
    }

    /// The inhomogeneous strains of a displacement; `deformation`: `F̄`, of positive determinant, or the identity where
    /// strains count as small.
    fn inhomogeneity(&self, displacement: &Nodal<N, D>, deformation: &Tensor2, is_small: bool) -> Inhomogeneity<N, D> {
        let inverse = if is_small { IDENTITY } else { Self::inverse_in_plane(deformation) };
        let mut strains = [0.0; MOST_STRAINS];
        for (own, mode) in strains.chunks_exact_mut(D).zip(&self.modes) {
            let mut vector = [0.0; D];
            for (displacement, weight) in displacement.iter().zip(mode) {
                vector.iter_mut().zip(displacement).for_each(|(value, displacement)| *value += weight * displacement);
            }
            for (strain, row) in own.iter_mut().zip(&inverse) {
                *strain = row.iter().zip(&vector).map(|(entry, value)| entry * value).sum();
            }
        }
        let modes = self.modes.len();
        if self.hoop_length > 0.0 {
            for (displacement, [radial, axial, hoop]) in displacement.iter().zip(&self.slots) {
                strains[D * modes] += self.hoop_length * (radial - hoop) * displacement[0];
                strains[D * modes + 1] += self.hoop_length * axial * displacement[0];
            }
        }
        let count = self.strains();
        let mut forces = [0.0; MOST_STRAINS];
        for (force, row) in forces.iter_mut().zip(self.stiffness.chunks_exact(count)) {
            *force = row.iter().zip(&strains).map(|(entry, strain)| entry * strain).sum();
        }
        let weights = from_fn(|node| {
            let mut weights = self.weights(node);
            if !is_small {
                for (weight, strain) in weights.iter_mut().zip(strains.chunks_exact(D)).take(modes) {
                    *weight -= self.slots[node].iter().zip(strain).map(|(slot, strain)| slot * strain).sum::<f64>();
                }
            }
            weights
        });
        Inhomogeneity { inverse, strains, forces, weights }
    }

    /// The inverse of `F̄`, in the plane that of its part in the plane.
    #[inline(always)]
    fn inverse_in_plane(deformation: &Tensor2) -> Tensor2 {
        let mut own = *deformation;
        if D == 2 {
            own[2] = IDENTITY[2];
        }
        let (cofactor, determinant) = (cofactor(&own), determinant(&own));
        from_fn(|row| from_fn(|column| cofactor[column][row] / determinant))
    }

    /// `½ z·H z`.
    fn own_energy(&self, of: &Inhomogeneity<N, D>) -> f64 {
        0.5 * of.strains.iter().zip(&of.forces).map(|(strain, force)| strain * force).sum::<f64>()
    }

    /// The force vectors `F̄⁻ᵀ (H z)_i`.
    #[inline(always)]
    fn vectors(&self, of: &Inhomogeneity<N, D>) -> [[f64; D]; 4] {
        let mut vectors = [[0.0; D]; 4];
        for (vector, own) in vectors.iter_mut().zip(of.forces.chunks_exact(D)).take(self.modes.len()) {
            for (row, force) in of.inverse.iter().zip(own) {
                vector.iter_mut().zip(row).for_each(|(value, entry)| *value += entry * force);
            }
        }
        vectors
    }

    /// Adds the nodal forces.
    fn add_own_forces(&self, of: &Inhomogeneity<N, D>, forces: &mut Nodal<N, D>) {
        let vectors = self.vectors(of);
        let hoop = D * self.modes.len();
        for ((force, weights), [radial, axial, around]) in forces.iter_mut().zip(&of.weights).zip(&self.slots) {
            for (vector, weight) in vectors.iter().zip(weights) {
                force.iter_mut().zip(vector).for_each(|(value, vector)| *value += weight * vector);
            }
            if self.hoop_length > 0.0 {
                let by_gradient = (radial - around) * of.forces[hoop] + axial * of.forces[hoop + 1];
                force[0] += self.hoop_length * by_gradient;
            }
        }
    }

    /// Adds the tangent in the blocks of nodes on and above the diagonal.
    fn add_own_stiffness(&self, of: &Inhomogeneity<N, D>, is_small: bool, stiffness: &mut [f64]) {
        let count = self.strains();
        let mut slopes = [[[0.0; D]; MOST_STRAINS]; N];
        for (node, slopes) in slopes.iter_mut().enumerate() {
            self.write_slopes(node, &of.inverse, &of.weights[node], slopes);
        }
        let vectors = self.vectors(of);
        // `F̄⁻ᵀ ḡ_a`: the mean gradients in the deformed state.
        let deformed: [[f64; D]; N] =
            from_fn(|node| from_fn(|axis| (0..D).map(|row| of.inverse[row][axis] * self.slots[node][row]).sum()));
        for node in 0..N {
            // `Z_aᵀ H`.
            let mut applied = [[0.0; MOST_STRAINS]; D];
            for (slopes, row) in slopes[node].iter().zip(self.stiffness.chunks_exact(count)) {
                for (applied, slope) in applied.iter_mut().zip(slopes) {
                    applied.iter_mut().zip(row).for_each(|(value, entry)| *value += slope * entry);
                }
            }
            for row in 0..D {
                let entries = &mut stiffness[((node * D + row) * N + node) * D..][..(N - node) * D];
                for (place, entries) in entries.chunks_exact_mut(D).enumerate() {
                    let other = node + place;
                    for (value, slopes) in applied[row].iter().zip(&slopes[other]).take(count) {
                        entries.iter_mut().zip(slopes).for_each(|(entry, slope)| *entry += value * slope);
                    }
                    if is_small {
                        continue;
                    }
                    // `H z` times the second derivative of `z`.
                    for (mode, vector) in vectors.iter().enumerate().take(self.modes.len()) {
                        let one = of.weights[other][mode] * vector[row];
                        let two = of.weights[node][mode] * deformed[other][row];
                        for ((entry, gradient), vector) in entries.iter_mut().zip(&deformed[node]).zip(vector) {
                            *entry -= one * gradient + two * vector;
                        }
                    }
                }
            }
        }
    }

    /// Adds bounds on the terms of the nodal forces: `|Z_a|ᵀ |H| |Z| |u|`.
    fn add_own_force_sizes(&self, motions: &Nodal<N, D>, sizes: &mut Nodal<N, D>) {
        let count = self.strains();
        let mut strains = [0.0; MOST_STRAINS];
        let mut slopes = [[[0.0; D]; MOST_STRAINS]; N];
        for (node, slopes) in slopes.iter_mut().enumerate() {
            self.write_slopes(node, &IDENTITY, &self.weights(node), slopes);
        }
        for (slopes, motion) in slopes.iter().zip(motions) {
            for (strain, slopes) in strains.iter_mut().zip(slopes) {
                *strain += slopes.iter().zip(motion).map(|(slope, motion)| slope.abs() * motion).sum::<f64>();
            }
        }
        let rows = self.stiffness.chunks_exact(count);
        for (strain_row, row) in rows.enumerate() {
            let force: f64 = row.iter().zip(&strains).map(|(entry, strain)| entry.abs() * strain).sum();
            for (size, slopes) in sizes.iter_mut().zip(&slopes) {
                size.iter_mut().zip(&slopes[strain_row]).for_each(|(size, slope)| *size += force * slope.abs());
            }
        }
    }
}

impl<const N: usize, const D: usize> MeanGradient<N, D> {
    /// The mean displacement gradient and the inhomogeneous strains.
    #[inline(always)]
    fn state<const S: usize>(
        &self,
        body: &Body<N, D>,
        displacement: &Nodal<N, D>,
    ) -> Option<(PointGeometry<N, S>, Tensor2, Inhomogeneity<N, D>)> {
        let at = PointGeometry { volume: self.volume, slots: self.slots() };
        let gradient = body.law.gradient(&gradient(displacement, &at.slots))?;
        let of = self.inhomogeneity(displacement, &sum(&gradient, 1.0, &IDENTITY), body.material().is_linear());
        Some((at, gradient, of))
    }
}

impl<const N: usize, const D: usize, const S: usize> Formulation<N, D, S> for MeanGradient<N, D> {
    fn energy(&self, body: &Body<N, D>, displacement: &Nodal<N, D>) -> Option<f64> {
        let (at, gradient, of) = self.state::<S>(body, displacement)?;
        Some(at.volume * body.material().energy_density(&gradient) + self.own_energy(&of))
    }

    fn add_forces(&self, body: &Body<N, D>, displacement: &Nodal<N, D>, forces: &mut Nodal<N, D>) -> Option<()> {
        let (at, gradient, of) = self.state::<S>(body, displacement)?;
        add_forces(&body.law.stress::<D, S>(&gradient), at.volume, &at.slots, forces);
        self.add_own_forces(&of, forces);
        Some(())
    }

    fn add_stiffness(&self, body: &Body<N, D>, displacement: &Nodal<N, D>, stiffness: &mut [f64]) -> Option<()> {
        let (at, gradient, of) = self.state::<S>(body, displacement)?;
        add_stiffness(&body.law.tangent::<D, S>(&gradient), at.volume, &at.slots, stiffness);
        self.add_own_stiffness(&of, body.material().is_linear(), stiffness);
        Some(())
    }

    fn add_force_sizes(
        &self,
        body: &Body<N, D>,
        displacement: &Nodal<N, D>,
        motions: &Nodal<N, D>,
        sizes: &mut Nodal<N, D>,
    ) -> Option<()> {
        let (at, gradient, _) = self.state::<S>(body, displacement)?;
        let stress = body.law.stress::<D, S>(&gradient);
        add_force_sizes(&stress, &body.law.tangent(&gradient), &at, motions, sizes);
        self.add_own_force_sizes(motions, sizes);
        Some(())
    }

    fn each_stress(
        &self,
        body: &Body<N, D>,
        displacement: &Nodal<N, D>,
        visit: &mut dyn FnMut(PointStress<D>),
    ) -> Option<()> {
        let (at, gradient, _) = self.state::<S>(body, displacement)?;
        let positions = body.geometry.positions.iter();
        let middle = positions.fold([0.0; D], |sum, position| from_fn(|axis| sum[axis] + position[axis] / N as f64));
        visit(body.point_stress(middle, at.volume, &gradient, &body.material().stress(&gradient)));
        Some(())
    }

    fn least_volume_ratio(&self, body: &Body<N, D>, displacement: &Nodal<N, D>) -> f64 {
        ratio_of(&body.law, &gradient(displacement, &self.slots::<S>()))
    }
}
