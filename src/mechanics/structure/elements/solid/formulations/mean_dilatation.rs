//! Mean dilatation: the material's energy with the volume ratio averaged over the element.
//!
//! ```text
//! W_e = Σ_q V_q W(F̂_q),     F̂_q = (J̄/J_q)^a F_q,     J̄ = Σ_q V_q J_q / Σ_q V_q
//! ```
//!
//! With `a = ⅓` the volume ratio of `F̂` is the mean `J̄` (J. C. Simo, R. L. Taylor, K. S. Pister, Comput. Methods Appl.
//! Mech. Eng. 51 (1985) 177, doi:10.1016/0045-7825(85)90033-7; as an energy: B. Moran, M. Ortiz, C. F. Shih, Int. J. Numer.
//! Methods Eng. 29 (1990) 483, doi:10.1002/nme.1620290304), and the pressure is constant in the element, which quadratic
//! displacements bear stably. But then the quadratic displacements `2 (b·x) x - (x·x) b`, whose deviatoric strain is 0, have
//! no energy in a single element in space: three modes, one around an axis. Therefore
//!
//! ```text
//! a = ⅓ (1 - √(G/κ)),     0 where κ < G:
//! ```
//!
//! the inhomogeneous part of the dilatation is resisted with the modulus `(1 - 3a)² κ = G`, which locks nothing and leaves no
//! mode without energy; in a compressible material the mend vanishes. For a material of small strains the dilatation `tr h`
//! takes the place of `J`: `ĥ = h + a (mean(tr h) - tr h) 1`.
//!
//! With `Ψ(F, J̄) = W((J̄/J)^a F)` and the pressure `p = Σ V_q ∂Ψ/∂J̄ / Σ V_q`, nodal forces and tangent are
//!
//! ```text
//! f = Σ_q V_q (Ψ_F + p ∂J/∂F) : ∂F/∂u
//! K = Σ_q V_q ∂F/∂u : (Ψ_FF + p ∂²J/∂F²) : ∂F/∂u + h gᵀ + g hᵀ + c g gᵀ
//! g = ∂J̄/∂u,     h = Σ_q V_q Ψ_FJ : ∂F/∂u,     c = Σ_q V_q Ψ_JJ
//! ```

use crate::mechanics::structure::elements::materials::ElasticMaterial;
use crate::mechanics::structure::elements::materials::tensor::{
    Flat, IDENTITY, Tensor2, Tensor4, add_crossed, add_dyad, applied, cofactor, contraction, flat, scaled, sum, trace,
    unflat, volume_change,
};
use crate::mechanics::structure::elements::solid::formulations::nodal_sums::{
    Nodal, add_forces, add_stiffness, add_symmetric_dyad, gradient,
};
use crate::mechanics::structure::elements::solid::formulations::response::{reduced_stress, reduced_tangent};
use crate::mechanics::structure::elements::solid::formulations::{Body, Formulation, PointStress, add_force_sizes};
use crate::mechanics::structure::elements::solid::shapes::geometry::PointGeometry;

/// The displacement gradient at a point and the material there.
#[derive(Clone, Copy)]
pub struct DilatedPoint<'a> {
    material: &'a dyn ElasticMaterial,
    gradient: Tensor2,
    /// `J̄ - 1`, or the mean of `tr h`.
    mean_change: f64,
    /// The exponent `a`.
    exponent: f64,
    /// `ĥ = F̂ - 1`.
    mended: Tensor2,
}

/// The derivatives of `Ψ` of first order.
#[derive(Clone, Copy)]
pub struct DilatedStress {
    /// `Ψ_F`.
    pub stress: Tensor2,
    /// `Ψ_J̄`.
    pub pressure: f64,
    /// `∂J/∂F`, or the identity for small strains.
    pub volume_slope: Tensor2,
}

/// The derivatives of `Ψ` of second order.
#[derive(Clone, Copy)]
pub struct DilatedTangent {
    /// `Ψ_FF + p ∂²J/∂F²`.
    pub tangent: Tensor4,
    /// `Ψ_FJ̄`.
    pub mixed: Tensor2,
    /// `Ψ_J̄J̄`.
    pub bulk: f64,
}

/// `J - 1`, or `tr h` for small strains.
#[inline(always)]
pub fn dilatation(material: &dyn ElasticMaterial, gradient: &Tensor2) -> f64 {
    if material.is_linear() { trace(gradient) } else { volume_change(gradient) }
}

impl<'a> DilatedPoint<'a> {
    /// A point where `det F > 0`, in an element of mean dilatation `mean_change > -1`.
    fn new(material: &'a dyn ElasticMaterial, gradient: &Tensor2, mean_change: f64) -> Self {
        let moduli = material.moduli();
        let exponent = (1.0 - (moduli.shear / moduli.bulk().max(moduli.shear)).sqrt()) / 3.0;
        let own = dilatation(material, gradient);
        let mended = if material.is_linear() {
            sum(gradient, exponent * (mean_change - own), &IDENTITY)
        } else {
            let excess = (exponent * (mean_change.ln_1p() - own.ln_1p())).exp_m1();
            sum(gradient, excess, &sum(gradient, 1.0, &IDENTITY))
        };
        Self { material, gradient: *gradient, mean_change, exponent, mended }
    }

    /// Energy `Ψ`.
    pub fn energy_density(&self) -> f64 {
        self.material.energy_density(&self.mended)
    }

    /// `∂J/∂F`, or the identity for small strains.
    fn volume_slope(&self) -> Tensor2 {
        if self.material.is_linear() { IDENTITY } else { cofactor(&sum(&self.gradient, 1.0, &IDENTITY)) }
    }

    /// The derivatives of first order.
    pub fn stress(&self) -> DilatedStress {
        let stress = self.material.stress(&self.mended);
        if self.material.is_linear() {
            let mean = self.exponent * trace(&stress);
            return DilatedStress { stress: sum(&stress, -mean, &IDENTITY), pressure: mean, volume_slope: IDENTITY };
        }
        let deformation = sum(&self.gradient, 1.0, &IDENTITY);
        let volume = 1.0 + volume_change(&self.gradient);
        let volume_slope = self.volume_slope();
        let scale = ((1.0 + self.mean_change) / volume).powf(self.exponent);
        let work = contraction(&stress, &deformation);
        DilatedStress {
            stress: scaled(scale, &sum(&stress, -self.exponent * work / volume, &volume_slope)),
            pressure: self.exponent * scale * work / (1.0 + self.mean_change),
            volume_slope,
        }
    }

    /// The derivatives of second order; `pressure` is the element's `p`.
    pub fn tangent(&self, pressure: f64) -> DilatedTangent {
        let tangent = self.material.tangent(&self.mended);
        if self.material.is_linear() {
            return self.small_tangent(tangent);
        }
        let deformation = sum(&self.gradient, 1.0, &IDENTITY);
        let (volume, mean) = (1.0 + volume_change(&self.gradient), 1.0 + self.mean_change);
        let inverse = scaled(1.0 / volume, &cofactor(&deformation));
        let exponent = self.exponent;
        let scale = (mean / volume).powf(exponent);
        let stress = self.material.stress(&self.mended);
        let work = contraction(&stress, &deformation);
        let radial = applied(&tangent, &flat(&deformation));
        let stiffness = contraction(&unflat(&radial), &deformation);
        let (flat_inverse, flat_stress) = (flat(&inverse), flat(&stress));
        // `θ² Πᵀ Â Π` and what follows from the second derivative of `F̂`, with `Π = 1 - a F ⊗ F⁻ᵀ`.
        let mut whole = tangent.map(|row| row.map(|value| scale * scale * value));
        let coupled: Flat =
            std::array::from_fn(|place| -exponent * scale * (scale * radial[place] + flat_stress[place]));
        add_dyad(&mut whole, 1.0, &coupled, &flat_inverse);
        add_dyad(&mut whole, 1.0, &flat_inverse, &coupled);
        let dyad = exponent * exponent * scale * (scale * stiffness + work) + pressure * volume;
        add_dyad(&mut whole, dyad, &flat_inverse, &flat_inverse);
        add_crossed(&mut whole, exponent * scale * work - pressure * volume, &inverse, &inverse);
        let mixed = sum(&scaled(scale, &unflat(&radial)), 1.0, &stress);
        let mixed = sum(&mixed, -exponent * (scale * stiffness + work), &inverse);
        DilatedTangent {
            tangent: whole,
            mixed: scaled(exponent * scale / mean, &mixed),
            bulk: exponent * scale * (exponent * scale * stiffness + (exponent - 1.0) * work) / (mean * mean),
        }
    }

    /// The derivatives of second order for small strains.
    fn small_tangent(&self, mut tangent: Tensor4) -> DilatedTangent {
        let (identity, exponent) = (flat(&IDENTITY), self.exponent);
        let radial = applied(&tangent, &identity);
        let stiffness = trace(&unflat(&radial));
        let coupled: Flat = std::array::from_fn(|place| -exponent * radial[place]);
        add_dyad(&mut tangent, 1.0, &coupled, &identity);
        add_dyad(&mut tangent, 1.0, &identity, &coupled);
        add_dyad(&mut tangent, exponent * exponent * stiffness, &identity, &identity);
        let mixed = sum(&scaled(exponent, &unflat(&radial)), -exponent * exponent * stiffness, &IDENTITY);
        DilatedTangent { tangent, mixed, bulk: exponent * exponent * stiffness }
    }
}

/// The formulation with the mean dilatation.
#[derive(Debug, Clone, Copy)]
pub struct MeanDilatation;

/// The means over an element.
#[derive(Clone, Copy)]
struct Means {
    /// Undeformed volume.
    volume: f64,
    /// `J̄ - 1`.
    change: f64,
    /// The pressure `p`.
    pressure: f64,
}

/// The displacement gradient at a point.
#[inline(always)]
fn gradient_at<const N: usize, const D: usize, const S: usize>(
    body: &Body<N, D>,
    displacement: &Nodal<N, D>,
    at: &PointGeometry<N, S>,
) -> Option<Tensor2> {
    body.law.gradient(&gradient(displacement, &at.slots))
}

/// The mean change of volume with the volume, the pressure still 0.
fn mean_change<const N: usize, const D: usize, const S: usize>(
    body: &Body<N, D>,
    displacement: &Nodal<N, D>,
) -> Option<Means> {
    let (mut volume, mut change) = (0.0, 0.0);
    for shape in body.shape {
        let at: PointGeometry<N, S> = body.geometry.at(shape);
        volume += at.volume;
        change += at.volume * dilatation(body.material(), &gradient_at(body, displacement, &at)?);
    }
    Some(Means { volume, change: change / volume, pressure: 0.0 })
}

/// All means.
fn means<const N: usize, const D: usize, const S: usize>(
    body: &Body<N, D>,
    displacement: &Nodal<N, D>,
) -> Option<Means> {
    let means = mean_change::<N, D, S>(body, displacement)?;
    let mut pressure = 0.0;
    for shape in body.shape {
        let at: PointGeometry<N, S> = body.geometry.at(shape);
        let gradient = gradient_at(body, displacement, &at)?;
        pressure += at.volume * DilatedPoint::new(body.material(), &gradient, means.change).stress().pressure;
    }
    Some(Means { pressure: pressure / means.volume, ..means })
}

impl DilatedStress {
    /// The stress with the pressure of the element: `Ψ_F + p ∂J/∂F`.
    fn with_pressure(&self, pressure: f64) -> Tensor2 {
        sum(&self.stress, pressure, &self.volume_slope)
    }
}

impl<const N: usize, const D: usize, const S: usize> Formulation<N, D, S> for MeanDilatation {
    fn energy(&self, body: &Body<N, D>, displacement: &Nodal<N, D>) -> Option<f64> {
        let means = mean_change::<N, D, S>(body, displacement)?;
        body.shape.iter().try_fold(0.0, |energy, shape| {
            let at: PointGeometry<N, S> = body.geometry.at(shape);
            let gradient = gradient_at(body, displacement, &at)?;
            let point = DilatedPoint::new(body.material(), &gradient, means.change);
            Some(energy + at.volume * point.energy_density())
        })
    }

    fn add_forces(&self, body: &Body<N, D>, displacement: &Nodal<N, D>, forces: &mut Nodal<N, D>) -> Option<()> {
        let means = mean_change::<N, D, S>(body, displacement)?;
        let (mut pressure, mut volume_forces) = (0.0, [[0.0; D]; N]);
        for shape in body.shape {
            let at: PointGeometry<N, S> = body.geometry.at(shape);
            let gradient = gradient_at(body, displacement, &at)?;
            let of_point = DilatedPoint::new(body.material(), &gradient, means.change).stress();
            pressure += at.volume * of_point.pressure;
            add_forces(&reduced_stress::<D, S>(&of_point.stress), at.volume, &at.slots, forces);
            let slope = reduced_stress::<D, S>(&of_point.volume_slope);
            add_forces(&slope, at.volume, &at.slots, &mut volume_forces);
        }
        pressure /= means.volume;
        let entries = forces.iter_mut().flatten().zip(volume_forces.iter().flatten());
        entries.for_each(|(force, value)| *force += pressure * value);
        Some(())
    }

    fn add_stiffness(&self, body: &Body<N, D>, displacement: &Nodal<N, D>, stiffness: &mut [f64]) -> Option<()> {
        let means = means::<N, D, S>(body, displacement)?;
        let (mut slope, mut mixed, mut bulk) = ([[0.0; D]; N], [[0.0; D]; N], 0.0);
        for shape in body.shape {
            let at: PointGeometry<N, S> = body.geometry.at(shape);
            let gradient = gradient_at(body, displacement, &at)?;
            let point = DilatedPoint::new(body.material(), &gradient, means.change);
            let tangent = point.tangent(means.pressure);
            add_stiffness(&reduced_tangent::<D, S>(&tangent.tangent), at.volume, &at.slots, stiffness);
            add_forces(&reduced_stress::<D, S>(&tangent.mixed), at.volume, &at.slots, &mut mixed);
            let of_volume = reduced_stress::<D, S>(&point.volume_slope());
            add_forces(&of_volume, at.volume / means.volume, &at.slots, &mut slope);
            bulk += at.volume * tangent.bulk;
        }
        // `h gᵀ + g hᵀ + c g gᵀ = (h + ½ c g) gᵀ + g (h + ½ c g)ᵀ`.
        let whole: Nodal<N, D> =
            std::array::from_fn(|node| std::array::from_fn(|axis| mixed[node][axis] + 0.5 * bulk * slope[node][axis]));
        add_symmetric_dyad(1.0, &whole, &slope, stiffness);
        Some(())
    }

    fn add_force_sizes(
        &self,
        body: &Body<N, D>,
        displacement: &Nodal<N, D>,
        motions: &Nodal<N, D>,
        sizes: &mut Nodal<N, D>,
    ) -> Option<()> {
        let means = means::<N, D, S>(body, displacement)?;
        for shape in body.shape {
            let at: PointGeometry<N, S> = body.geometry.at(shape);
            let gradient = gradient_at(body, displacement, &at)?;
            let point = DilatedPoint::new(body.material(), &gradient, means.change);
            let stress = reduced_stress(&point.stress().with_pressure(means.pressure));
            // The terms of the mended gradient: with the volume's, whether it is a mean or not.
            let tangent = reduced_tangent::<D, S>(&body.material().tangent(&point.mended));
            add_force_sizes(&stress, &tangent, &at, motions, sizes);
        }
        Some(())
    }

    fn each_stress(
        &self,
        body: &Body<N, D>,
        displacement: &Nodal<N, D>,
        visit: &mut dyn FnMut(PointStress<D>),
    ) -> Option<()> {
        let means = means::<N, D, S>(body, displacement)?;
        for shape in body.shape {
            let at: PointGeometry<N, S> = body.geometry.at(shape);
            let gradient = gradient_at(body, displacement, &at)?;
            let stress = DilatedPoint::new(body.material(), &gradient, means.change).stress();
            let stress = stress.with_pressure(means.pressure);
            visit(body.point_stress(body.geometry.position_at(shape), at.volume, &gradient, &stress));
        }
        Some(())
    }
}
