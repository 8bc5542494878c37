//! From displacements of the nodes to energy, forces and tangent: which deformation gradient the material sees.

pub mod hourglass_stiffness;
pub mod mean_dilatation;
pub mod mean_gradient;
pub mod nodal_sums;
pub mod pointwise;
pub mod response;

use crate::mechanics::structure::elements::materials::ElasticMaterial;
use crate::mechanics::structure::elements::materials::tensor::{
    IDENTITY, Tensor2, product, scaled, sum, transpose, volume_change,
};
use crate::mechanics::structure::elements::solid::shapes::geometry::{PointGeometry, ReferenceGeometry};
use crate::mechanics::structure::elements::solid::shapes::shape_functions::ShapePoint;
use nodal_sums::{Nodal, gradient};
use response::ConstitutiveLaw;

/// What an element is made of, whatever its formulation.
#[derive(Debug, Clone)]
pub struct Body<const N: usize, const D: usize> {
    /// Undeformed geometry.
    pub geometry: ReferenceGeometry<N, D>,
    /// The quadrature points.
    pub shape: &'static [ShapePoint<N, D>],
    /// The material, in its idealisation.
    pub law: ConstitutiveLaw,
}

/// The stress at a point, or the mean of an element.
#[derive(Debug, Clone, Copy)]
pub struct PointStress<const D: usize> {
    /// Undeformed position relative to the element's first node.
    pub position: [f64; D],
    /// Deformed volume that the point stands for; undeformed where strains count as small.
    pub volume: f64,
    /// Cauchy stress.
    pub stress: Tensor2,
    /// Strain of Green and Lagrange; the linear one where strains count as small. Dimensionless.
    pub strain: Tensor2,
}

/// How energy, forces and tangent follow from the displacements of `N` nodes in `D` dimensions, with `S` slots.
///
/// `None` is the answer where the volume at a point is gone or turned inside out: there is no energy.
pub trait Formulation<const N: usize, const D: usize, const S: usize> {
    /// Strain energy.
    fn energy(&self, body: &Body<N, D>, displacement: &Nodal<N, D>) -> Option<f64>;

    /// Adds the nodal forces.
    fn add_forces(&self, body: &Body<N, D>, displacement: &Nodal<N, D>, forces: &mut Nodal<N, D>) -> Option<()>;

    /// Adds the tangent in the blocks of nodes on and above the diagonal.
    fn add_stiffness(&self, body: &Body<N, D>, displacement: &Nodal<N, D>, stiffness: &mut [f64]) -> Option<()>;

    /// Adds bounds on the terms of the nodal forces; `motions`: the size of each displacement.
    fn add_force_sizes(
        &self,
        body: &Body<N, D>,
        displacement: &Nodal<N, D>,
        motions: &Nodal<N, D>,
        sizes: &mut Nodal<N, D>,
    ) -> Option<()>;

    /// Calls `visit` with the stress at each point where the material is asked.
    fn each_stress(
        &self,
        body: &Body<N, D>,
        displacement: &Nodal<N, D>,
        visit: &mut dyn FnMut(PointStress<D>),
    ) -> Option<()>;

    /// The least volume ratio `J` of the points; may be negative.
    fn least_volume_ratio(&self, body: &Body<N, D>, displacement: &Nodal<N, D>) -> f64 {
        let ratio = |shape| {
            let at: PointGeometry<N, S> = body.geometry.at(shape);
            ratio_of(&body.law, &gradient(displacement, &at.slots))
        };
        body.shape.iter().map(ratio).fold(f64::INFINITY, f64::min)
    }
}

impl<const N: usize, const D: usize> Body<N, D> {
    /// The material.
    #[inline(always)]
    pub fn material(&self) -> &dyn ElasticMaterial {
        self.law.material.as_ref()
    }

    /// Cauchy stress and deformed volume, from a first Piola-Kirchhoff stress.
    fn point_stress(
        &self,
        position: [f64; D],
        volume: f64,
        displacement_gradient: &Tensor2,
        stress: &Tensor2,
    ) -> PointStress<D> {
        let linear = scaled(0.5, &sum(displacement_gradient, 1.0, &transpose(displacement_gradient)));
        if self.material().is_linear() {
            return PointStress { position, volume, stress: *stress, strain: linear };
        }
        let squared = product(&transpose(displacement_gradient), displacement_gradient);
        let ratio = 1.0 + volume_change(displacement_gradient);
        let deformation = sum(displacement_gradient, 1.0, &IDENTITY);
        let stress = scaled(1.0 / ratio, &product(stress, &transpose(&deformation)));
        PointStress { position, volume: volume * ratio, stress, strain: sum(&linear, 0.5, &squared) }
    }
}

/// The volume ratio `J`; 0 where no stretch out of the plane is free of stress.
fn ratio_of<const D: usize, const S: usize>(law: &ConstitutiveLaw, slots: &response::Slots2<D, S>) -> f64 {
    law.unchecked_gradient(slots).map_or(0.0, |gradient| 1.0 + volume_change(&gradient))
}

/// Adds bounds on the terms of the nodal forces at a point: the stress, and the tangent times the gradients that the
/// displacements have without their signs.
fn add_force_sizes<const N: usize, const D: usize, const S: usize>(
    stress: &response::Slots2<D, S>,
    tangent: &response::Slots4<D, S>,
    at: &PointGeometry<N, S>,
    motions: &Nodal<N, D>,
    sizes: &mut Nodal<N, D>,
) {
    let slots = at.slots.map(|slots| slots.map(f64::abs));
    let most = gradient(motions, &slots);
    let mut terms = stress.map(|row| row.map(f64::abs));
    for (terms, tangent) in terms.iter_mut().zip(tangent) {
        for (term, tangent) in terms.iter_mut().zip(tangent) {
            let entries = tangent.iter().flatten().zip(most.iter().flatten());
            *term += entries.map(|(entry, most)| entry.abs() * most).sum::<f64>();
        }
    }
    nodal_sums::add_forces(&terms, at.volume, &slots, sizes);
}
