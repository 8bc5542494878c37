//! The rotations of nodes in space: how degrees of freedom, rotations and reports of them hang together.
//!
//! Three degrees of freedom `θ` are the rotation of a node (or of a released end). Where none of them is supported, the
//! rotation is measured from a reference `θ_n` that follows the path,
//!
//! ```text
//! R = exp(θ - θ_n) exp(θ_n)        ⊞:  θ_n ⊞ ψ = θ_n + ψ        ⊟:  θ ⊟ θ_n = θ - θ_n = log(R R_nᵀ)
//! ```
//!
//! so that path following may add and subtract degrees of freedom as everywhere else. After each accepted point the
//! reference is placed there: `θ` becomes the total rotation vector, `R = exp(θ)`, on the branch nearest to the one
//! before, and rates become spins. Neither the point nor the path changes by it, and no rotation is too large: at the
//! reference a rate of `θ` is the spin itself. The norm of a change of `θ` is the angle between both rotations.
//!
//! Where one of the three is supported, `R = exp(θ)` throughout (`θ_n = 0`): what is prescribed are components of the
//! total rotation vector, whatever the way there. A node held in two components turns about the third axis by any
//! angle, and one held in three goes through the given rotation vectors; one held in a single component turns by less
//! than a full turn.

use crate::mechanics::rotation::{change_by_spin, quaternion, spin, vector_near};
use crate::mechanics::structure::numbering::Numbering;
use std::borrow::Cow;

/// The rotations that follow the path.
#[derive(Debug, Clone, Default, PartialEq)]
pub struct TurningNodes {
    /// The first degree of freedom of each rotation without supports.
    first: Vec<usize>,
    /// `θ_n`, over all degrees of freedom (zero elsewhere); empty before the first.
    references: Vec<f64>,
    freedoms: usize,
}

fn three(values: &[f64], first: usize) -> [f64; 3] {
    [values[first], values[first + 1], values[first + 2]]
}

fn less(a: [f64; 3], b: [f64; 3]) -> [f64; 3] {
    std::array::from_fn(|k| a[k] - b[k])
}

impl TurningNodes {
    /// The rotations of nodes in space none of whose components is supported.
    pub fn of(numbering: &Numbering, unknown_of: &[Option<usize>]) -> Self {
        if numbering.dimension() != 3 {
            return Self::default();
        }
        let all = (0..numbering.nodes()).flat_map(|node| numbering.rotations_of(node).step_by(3));
        let first = all.filter(|first| unknown_of[*first..first + 3].iter().all(Option::is_some)).collect();
        Self { first, references: Vec::new(), freedoms: numbering.freedoms() }
    }

    /// All rotations in space, with the present references; those of supported nodes from no rotation.
    fn with_supported(&self, numbering: &Numbering) -> Self {
        let all = (0..numbering.nodes()).flat_map(|node| numbering.rotations_of(node).step_by(3));
        let first = if numbering.dimension() == 3 { all.collect() } else { Vec::new() };
        Self { first, references: self.references.clone(), freedoms: numbering.freedoms() }
    }

    /// The structure's own rotations and those of supported nodes, with all references at given displacements, and the
    /// displacements by them: forces are then moments in global axes.
    pub fn all_placed(&self, numbering: &Numbering, displacement: &[f64]) -> (Self, Vec<f64>) {
        let all = self.with_supported(numbering);
        let totals = all.totals(displacement).into_owned();
        (all, totals)
    }

    /// Whether there are any.
    pub fn are_there(&self) -> bool {
        !self.first.is_empty()
    }

    fn reference(&self, first: usize) -> [f64; 3] {
        if self.references.is_empty() { [0.0; 3] } else { three(&self.references, first) }
    }

    /// The displacements with the total rotation vector of each node.
    pub fn totals<'a>(&self, displacement: &'a [f64]) -> Cow<'a, [f64]> {
        let mut totals = Cow::Borrowed(displacement);
        for first in &self.first {
            let (own, reference) = (three(displacement, *first), self.reference(*first));
            if own != reference {
                let turned = quaternion(&less(own, reference)) * quaternion(&reference);
                totals.to_mut()[*first..first + 3].copy_from_slice(&vector_near(&turned, &own));
            }
        }
        totals
    }

    /// A rate at given displacements with the spin of each node in place of the rate of its rotation vector.
    pub fn spins(&self, displacement: &[f64], rate: &mut [f64]) {
        for first in &self.first {
            let turned = less(three(displacement, *first), self.reference(*first));
            let spinning = spin(&turned, &three(rate, *first));
            rate[*first..first + 3].copy_from_slice(&spinning);
        }
    }

    /// Takes the given total rotation vectors as references, and returns these.
    pub fn refer_to(&mut self, totals: &[f64]) -> &[f64] {
        self.references.clear();
        self.references.resize(self.freedoms, 0.0);
        for first in &self.first {
            self.references[*first..first + 3].copy_from_slice(&totals[*first..first + 3]);
        }
        &self.references
    }

    /// The references, for another structure to [`refer_to`](Self::refer_to); empty before the first.
    pub fn references(&self) -> &[f64] {
        &self.references
    }

    /// Expresses displacements, and a rate there, by the references of another.
    pub fn express(&self, other: &Self, displacement: &mut [f64], rate: Option<&mut [f64]>) {
        if let Some(rate) = rate {
            self.spins(displacement, rate);
            for first in &other.first {
                let turned = self.moved(other, displacement, *first);
                let changed = change_by_spin(&turned, &three(rate, *first));
                rate[*first..first + 3].copy_from_slice(&changed);
            }
        }
        for first in &other.first {
            let (turned, reference) = (self.moved(other, displacement, *first), other.reference(*first));
            (0..3).for_each(|k| displacement[first + k] = reference[k] + turned[k]);
        }
    }

    /// `log(R R_nᵀ)` by the reference of another.
    fn moved(&self, other: &Self, displacement: &[f64], first: usize) -> [f64; 3] {
        let (own, reference) = (three(displacement, first), self.reference(first));
        let turned = quaternion(&less(own, reference)) * quaternion(&reference);
        vector_near(&(turned * quaternion(&other.reference(first)).conjugate()), &[0.0; 3])
    }
}
