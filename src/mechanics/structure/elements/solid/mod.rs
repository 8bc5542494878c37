//! Solid elements: triangles, quadrilaterals, tetrahedra and hexahedra, of large strain or small.
//!
//! Total Lagrangian, from an energy: with the undeformed volume `V`, the deformation gradient `F = 1 + ∂u/∂X` and a
//! [material](crate::mechanics::structure::elements::materials)'s energy density `W`,
//!
//! ```text
//! W_e(u) = ∫ W(F) dV,     f = ∂W_e/∂u = ∫ P : ∂F/∂u dV,     K = ∂²W_e/∂u² = ∫ ∂F/∂u : A : ∂F/∂u dV
//! ```
//!
//! Against locking, energies of a mean deformation gradient or a mean dilatation take the place of `W_e`
//! ([`LockingMend`]); forces and tangent are always the exact derivatives of the energy, and the tangent is symmetric.
//! Elements of a linear elastic material are linear.
//!
//! Where an element is turned inside out at a quadrature point (`J` below 1e-4; in plane stress also where no
//! thickness is free of stress), there is no energy: it is infinite. Forces and tangent are then those of linear
//! elasticity, finite for an iteration to go on; [`stretch`](FiniteElement::stretch), the least `J`, tells that the state
//! is none to accept.

pub mod any;
pub mod formulations;
pub mod loads;
pub mod pressure_face;
pub mod shapes;
#[cfg(test)]
mod tests;
pub mod transformed;

use crate::mechanics::structure::elements::materials::ElasticMaterial;
use crate::mechanics::structure::elements::materials::linear_elastic::LinearElastic;
use crate::mechanics::structure::elements::materials::tensor::{Tensor2, contraction, deviator};
use crate::mechanics::structure::elements::{COLLAPSED, FiniteElement, Resultants};
use formulations::hourglass_stiffness::hourglass_stiffness;
use formulations::mean_dilatation::MeanDilatation;
use formulations::mean_gradient::MeanGradient;
use formulations::nodal_sums::{Nodal, mirror};
use formulations::pointwise::Pointwise;
use formulations::response::ConstitutiveLaw;
use formulations::{Body, Formulation, PointStress};
use shapes::geometry::{NodalPositions, ReferenceGeometry};
use shapes::kind::{Idealisation, LockingMend, SolidKind};
use std::sync::Arc;

/// A solid element of `N` nodes in `D` dimensions, which say its [kind](SolidKind).
#[derive(Debug, Clone)]
pub struct SolidElement<const N: usize, const D: usize> {
    nodes: [usize; N],
    body: Body<N, D>,
    mend: LockingMend,
    /// With the mend of the mean gradient.
    mean: Option<Box<MeanGradient<N, D>>>,
}

/// Why nodes and material make no element.
#[derive(Debug, Clone, Copy, PartialEq, thiserror::Error)]
pub enum SolidElementError {
    /// A quadrature point at which the undeformed element has no volume or is turned inside out.
    #[error(
        "the element is degenerate or its nodes are in the wrong order: at quadrature point {point} its Jacobian is \
         {jacobian}"
    )]
    Jacobian {
        /// The point, from 0.
        point: usize,
        /// Volume per natural volume.
        jacobian: f64,
    },
    /// A quadrature point on the wrong side of the axis of revolution.
    #[error("the element reaches across the axis of revolution: a quadrature point has the radius {0}")]
    Radius(f64),
    /// No length out of the plane.
    #[error("the thickness must be positive, not {0}")]
    Thickness(f64),
    /// A plane element in space, or the converse.
    #[error("an element of {0} dimensions can not be {1:?}")]
    Dimension(usize, Idealisation),
    /// No such mend for this kind.
    #[error("{1:?} elements have no mend {0:?} in {2:?}")]
    Mend(LockingMend, SolidKind, Idealisation),
    /// The stiffness against inhomogeneous strains is singular.
    #[error("the element is too distorted: its stiffness against inhomogeneous strains is singular")]
    Distorted,
}

impl<const N: usize, const D: usize> SolidElement<N, D>
where
    [[f64; D]; N]: NodalPositions<N, D>,
{
    /// An element with the usual mend against locking; `positions` are those of the undeformed nodes.
    ///
    /// # Errors
    ///
    /// Where nodes and material make no element.
    pub fn new(
        nodes: [usize; N],
        positions: &[[f64; D]; N],
        idealisation: Idealisation,
        material: Arc<dyn ElasticMaterial>,
    ) -> Result<Self, SolidElementError> {
        let mend = LockingMend::usual(<[[f64; D]; N]>::KIND, idealisation, &material.moduli());
        Self::with_mend(nodes, positions, idealisation, material, mend)
    }

    /// An element with a mend of choice.
    ///
    /// # Errors
    ///
    /// Where nodes and material make no element, or there is no such mend.
    pub fn with_mend(
        nodes: [usize; N],
        positions: &[[f64; D]; N],
        idealisation: Idealisation,
        material: Arc<dyn ElasticMaterial>,
        mend: LockingMend,
    ) -> Result<Self, SolidElementError> {
        if idealisation.dimension() != D {
            return Err(SolidElementError::Dimension(D, idealisation));
        }
        let thickness = idealisation.thickness();
        if !(thickness > 0.0 && thickness.is_finite()) {
            return Err(SolidElementError::Thickness(thickness));
        }
        let kind = <[[f64; D]; N]>::KIND;
        if !mend.suits(kind, idealisation) {
            return Err(SolidElementError::Mend(mend, kind, idealisation));
        }
        let is_plane_stress = matches!(idealisation, Idealisation::PlaneStress { .. });
        let body = Body {
            geometry: ReferenceGeometry::new(positions, idealisation),
            shape: <[[f64; D]; N]>::shape(idealisation),
            law: ConstitutiveLaw { material, is_plane_stress },
        };
        for (point, shape) in body.shape.iter().enumerate() {
            let jacobian = body.geometry.jacobian_determinant(shape);
            if !(jacobian > 0.0 && jacobian.is_finite()) {
                return Err(SolidElementError::Jacobian { point, jacobian });
            }
            let thickness = body.geometry.thickness_at(shape);
            if !(thickness > 0.0 && thickness.is_finite()) {
                return Err(SolidElementError::Radius(body.geometry.radius_at(shape)));
            }
        }
        let mean = match (mend, idealisation) {
            (LockingMend::None | LockingMend::MeanDilatation, _) => None,
            (LockingMend::MeanGradient, Idealisation::Axisymmetric) => Some(Box::new(mean_gradient::<N, D, 3>(&body)?)),
            (LockingMend::MeanGradient, _) => Some(Box::new(mean_gradient::<N, D, D>(&body)?)),
        };
        Ok(Self { nodes, body, mend, mean })
    }

    /// The kind of the element.
    pub fn kind(&self) -> SolidKind {
        <[[f64; D]; N]>::KIND
    }
}

/// The mean geometry with its stiffness.
fn mean_gradient<const N: usize, const D: usize, const S: usize>(
    body: &Body<N, D>,
) -> Result<MeanGradient<N, D>, SolidElementError> {
    let Body { geometry, shape, law } = body;
    let mean = MeanGradient::new::<S>(geometry, shape);
    let stiffness = hourglass_stiffness::<N, D, S>(geometry, shape, &mean, law.material.moduli());
    Ok(mean.with_stiffness(stiffness.ok_or(SolidElementError::Distorted)?))
}

/// Calls a function of [`Formulation`] for the mend of an element and its number of slots.
macro_rules! with_formulation {
    ($element:expr, $body:expr, $function:ident($($argument:expr),*)) => {{
        let is_axisymmetric = matches!($element.body.geometry.idealisation, Idealisation::Axisymmetric);
        match (&$element.mean, $element.mend, is_axisymmetric) {
            (Some(mean), _, false) => Formulation::<N, D, D>::$function(mean.as_ref(), $body, $($argument),*),
            (Some(mean), _, true) => Formulation::<N, D, 3>::$function(mean.as_ref(), $body, $($argument),*),
            (None, LockingMend::MeanDilatation, false) => {
                Formulation::<N, D, D>::$function(&MeanDilatation, $body, $($argument),*)
            }
            (None, LockingMend::MeanDilatation, true) => {
                Formulation::<N, D, 3>::$function(&MeanDilatation, $body, $($argument),*)
            }
            (None, _, false) => Formulation::<N, D, D>::$function(&Pointwise, $body, $($argument),*),
            (None, _, true) => Formulation::<N, D, 3>::$function(&Pointwise, $body, $($argument),*),
        }
    }};
}

/// The displacements node by node; what is missing is 0.
#[inline(always)]
fn by_nodes<const N: usize, const D: usize>(values: &[f64]) -> Nodal<N, D> {
    let mut nodal = [[0.0; D]; N];
    nodal.iter_mut().flatten().zip(values).for_each(|(own, value)| *own = *value);
    nodal
}

impl<const N: usize, const D: usize> SolidElement<N, D> {
    /// The mend against locking.
    pub fn mend(&self) -> LockingMend {
        self.mend
    }

    /// Undeformed volume: of the thickness, or the whole revolution.
    pub fn volume(&self) -> f64 {
        let Body { geometry, shape, .. } = &self.body;
        let volume_of = |shape| shape_volume(geometry, shape);
        shape.iter().map(volume_of).sum()
    }

    /// Size of the element: the edge of the square or cube of its area or volume.
    fn length(&self) -> f64 {
        let Body { geometry, shape, .. } = &self.body;
        let content: f64 = shape.iter().map(|shape| shape.weight * geometry.jacobian_determinant(shape)).sum();
        if D == 2 { content.sqrt() } else { content.cbrt() }
    }

    /// The element of linear elasticity that takes its place where it is turned inside out.
    fn linear_body(&self) -> Body<N, D> {
        let material = Arc::new(LinearElastic { moduli: self.body.material().moduli() });
        Body { law: ConstitutiveLaw { material, ..self.body.law }, ..self.body.clone() }
    }

    /// Calls `visit` with the stress at each point where the material is asked: the quadrature points, or the middle of an
    /// element of the mean gradient. Not called where the element is turned inside out.
    pub fn each_stress(&self, displacement: &[f64], visit: &mut dyn FnMut(PointStress<D>)) {
        let displacement = by_nodes(displacement);
        if with_formulation!(self, &self.body, least_volume_ratio(&displacement)) > COLLAPSED
            || self.body.material().is_linear()
        {
            let _ = with_formulation!(self, &self.body, each_stress(&displacement, visit));
        }
    }

    /// The mean Cauchy stress over the deformed volume; 0 where the element is turned inside out.
    pub fn mean_stress(&self, displacement: &[f64]) -> Tensor2 {
        self.mean(displacement, |point| &point.stress)
    }

    /// The mean strain, of Green and Lagrange or linear where strains count as small, over the same volume; 0 where the
    /// element is turned inside out. Dimensionless.
    pub fn mean_strain(&self, displacement: &[f64]) -> Tensor2 {
        self.mean(displacement, |point| &point.strain)
    }

    fn mean(&self, displacement: &[f64], of: impl Fn(&PointStress<D>) -> &Tensor2) -> Tensor2 {
        let (mut volume, mut mean) = (0.0, [[0.0; 3]; 3]);
        self.each_stress(displacement, &mut |point| {
            volume += point.volume;
            let entries = mean.iter_mut().flatten().zip(of(&point).iter().flatten());
            entries.for_each(|(mean, value): (&mut f64, &f64)| *mean += point.volume * value);
        });
        if volume > 0.0 { mean.map(|row| row.map(|value| value / volume)) } else { mean }
    }

    /// The nodal forces; those of linear elasticity where the element is turned inside out.
    #[inline(always)]
    fn forces(&self, displacement: &Nodal<N, D>) -> Nodal<N, D> {
        let mut forces = [[0.0; D]; N];
        if with_formulation!(self, &self.body, add_forces(displacement, &mut forces)).is_none() {
            forces = [[0.0; D]; N];
            let _ = with_formulation!(self, &self.linear_body(), add_forces(displacement, &mut forces));
        }
        forces
    }
}

/// The undeformed volume that a quadrature point stands for.
fn shape_volume<const N: usize, const D: usize>(
    geometry: &ReferenceGeometry<N, D>,
    shape: &shapes::shape_functions::ShapePoint<N, D>,
) -> f64 {
    shape.weight * geometry.jacobian_determinant(shape) * geometry.thickness_at(shape)
}

/// The equivalent stress of von Mises, `√(3/2 dev σ : dev σ)`.
pub fn von_mises(stress: &Tensor2) -> f64 {
    let deviator = deviator(stress);
    (1.5 * contraction(&deviator, &deviator)).sqrt()
}

impl<const N: usize, const D: usize> FiniteElement for SolidElement<N, D> {
    fn nodes(&self) -> &[usize] {
        &self.nodes
    }

    fn energy(&self, displacement: &[f64]) -> f64 {
        let energy = with_formulation!(self, &self.body, energy(&by_nodes(displacement)));
        energy.unwrap_or(f64::INFINITY)
    }

    fn write_force(&self, displacement: &[f64], force: &mut [f64]) -> f64 {
        let forces = self.forces(&by_nodes(displacement));
        force.iter_mut().zip(forces.iter().flatten()).for_each(|(force, value)| *force = *value);
        forces.iter().flatten().fold(0.0, |most, value| value.abs().max(most))
    }

    fn write_stiffness(&self, displacement: &[f64], stiffness: &mut [f64]) {
        let displacement = by_nodes(displacement);
        stiffness.fill(0.0);
        if with_formulation!(self, &self.body, add_stiffness(&displacement, stiffness)).is_none() {
            stiffness.fill(0.0);
            let _ = with_formulation!(self, &self.linear_body(), add_stiffness(&displacement, stiffness));
        }
        mirror(N * D, stiffness);
    }

    /// The stress, and the tangent times gradients made of the displacements without their signs, at each point.
    fn write_force_sizes(&self, displacement: &[f64], least: f64, sizes: &mut [f64]) {
        let displacement: Nodal<N, D> = by_nodes(displacement);
        let motions = displacement.map(|own| own.map(|value| value.abs().max(least)));
        let mut terms = [[0.0; D]; N];
        if with_formulation!(self, &self.body, add_force_sizes(&displacement, &motions, &mut terms)).is_none() {
            terms = [[0.0; D]; N];
            let linear = self.linear_body();
            let _ = with_formulation!(self, &linear, add_force_sizes(&displacement, &motions, &mut terms));
        }
        sizes.iter_mut().zip(terms.iter().flatten()).for_each(|(size, value)| *size = *value);
    }

    /// Young's modulus times the cross-section of a cube, or a block of the thickness, as large as the element.
    fn axial_stiffness(&self, _motion: &[f64]) -> f64 {
        self.body.material().moduli().young() * self.volume() / self.length()
    }

    fn is_linear(&self) -> bool {
        self.body.material().is_linear()
    }

    fn resultants(&self, displacement: &[f64]) -> Option<Resultants> {
        let stress = self.mean_stress(displacement);
        let [[xx, xy, xz], [_, yy, yz], [_, _, zz]] = stress;
        Some(Resultants::Stress { stress: [xx, yy, zz, xy, yz, xz], von_mises: von_mises(&stress) })
    }

    /// The least volume ratio `J` of the quadrature points, negative where the element is turned inside out; of elements
    /// of the mean gradient that of the mean. `None` for small strains.
    fn stretch(&self, displacement: &[f64]) -> Option<f64> {
        let displacement = by_nodes(displacement);
        (!self.is_linear()).then(|| with_formulation!(self, &self.body, least_volume_ratio(&displacement)))
    }
}
