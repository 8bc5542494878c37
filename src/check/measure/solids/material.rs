//! The materials by their second Piola-Kirchhoff stress of Green's strain `E = ½ (FᵀF - 1)`, `P = F S`:
//!
//! ```text
//! linear elastic          P = λ tr ε 1 + 2 G ε,     ε = ½ (h + hᵀ)
//! Saint Venant-Kirchhoff  S = λ tr E 1 + 2 G E
//! neo-Hookean             S = C⁻¹ (2 G E + λ (J - 1) J)
//! Mooney-Rivlin           S = C⁻¹ (4 C₁ J^(-2/3) dev E + 2 C₂ J^(-4/3) M + ½ κ (J² - 1)),     C = 1 + 2 E
//!                         M = 2 dev E + 4 tr E E - 4 E² - 8/3 I₂(E)
//! ```
//!
//! The energy of small gradients is the work of this stress along the straight way, by Gauss's rule; of others the closed
//! form.

use crate::model::request;
use nalgebra::Matrix3;

/// Displacement gradients whose largest entry is below this have the energy of the work along the way.
const SMALL_GRADIENT: f64 = 0.02;

/// Gauss's rule of five points on `[0, 1]`.
const WAY: [(f64, f64); 5] = [
    (0.046_910_077_030_668, 0.118_463_442_528_094_5),
    (0.230_765_344_947_158_5, 0.239_314_335_249_683_2),
    (0.5, 0.284_444_444_444_444_4),
    (0.769_234_655_052_841_5, 0.239_314_335_249_683_2),
    (0.953_089_922_969_332, 0.118_463_442_528_094_5),
];

#[derive(Debug, Clone, Copy)]
pub enum MeasuredMaterial {
    LinearElastic { shear: f64, lame: f64 },
    SaintVenantKirchhoff { shear: f64, lame: f64 },
    NeoHookean { shear: f64, lame: f64 },
    MooneyRivlin { first: f64, second: f64, bulk: f64 },
}

impl MeasuredMaterial {
    pub fn new(posted: &request::Material) -> Self {
        let moduli = |constants: &request::ElasticConstants| {
            let request::ElasticConstants { young, poisson, .. } = *constants;
            let lame = young * poisson / ((1.0 + poisson) * (1.0 - 2.0 * poisson));
            (0.5 * young / (1.0 + poisson), lame)
        };
        match posted {
            request::Material::LinearElastic(constants) => {
                let (shear, lame) = moduli(constants);
                Self::LinearElastic { shear, lame }
            }
            request::Material::SaintVenantKirchhoff(constants) => {
                let (shear, lame) = moduli(constants);
                Self::SaintVenantKirchhoff { shear, lame }
            }
            request::Material::NeoHookean(constants) => {
                let (shear, lame) = moduli(constants);
                Self::NeoHookean { shear, lame }
            }
            request::Material::MooneyRivlin { c10, c01, bulk_modulus, .. } => {
                Self::MooneyRivlin { first: *c10, second: *c01, bulk: *bulk_modulus }
            }
        }
    }

    /// Shear modulus and Lamé's first modulus at small strains.
    pub fn moduli(&self) -> (f64, f64) {
        match *self {
            Self::LinearElastic { shear, lame }
            | Self::SaintVenantKirchhoff { shear, lame }
            | Self::NeoHookean { shear, lame } => (shear, lame),
            Self::MooneyRivlin { first, second, bulk } => {
                let shear = 2.0 * (first + second);
                (shear, bulk - 2.0 / 3.0 * shear)
            }
        }
    }

    pub fn is_small(&self) -> bool {
        matches!(self, Self::LinearElastic { .. })
    }

    /// The first Piola-Kirchhoff stress of a displacement gradient.
    pub fn stress(&self, gradient: &Matrix3<f64>) -> Matrix3<f64> {
        let (shear, lame) = self.moduli();
        if self.is_small() {
            return Matrix3::identity() * (lame * gradient.trace()) + (gradient + gradient.transpose()) * shear;
        }
        (Matrix3::identity() + gradient) * self.second_stress(gradient)
    }

    /// The second Piola-Kirchhoff stress.
    pub fn second_stress(&self, gradient: &Matrix3<f64>) -> Matrix3<f64> {
        let strain = (gradient + gradient.transpose() + gradient.transpose() * gradient) * 0.5;
        let one = Matrix3::identity();
        let change = volume_change(gradient);
        let volume = 1.0 + change;
        let trace = strain.trace();
        let inverse = || (one + strain * 2.0).try_inverse().unwrap_or_else(|| Matrix3::from_element(f64::NAN));
        match *self {
            Self::LinearElastic { shear, lame } | Self::SaintVenantKirchhoff { shear, lame } => {
                one * (lame * trace) + strain * (2.0 * shear)
            }
            Self::NeoHookean { shear, lame } => inverse() * (strain * (2.0 * shear) + one * (lame * change * volume)),
            Self::MooneyRivlin { first, second, bulk } => {
                let deviator = strain - one * (trace / 3.0);
                let square = strain * strain;
                let invariant = 0.5 * (trace * trace - square.trace());
                let mixed = deviator * 2.0 + strain * (4.0 * trace) - square * 4.0 - one * (8.0 / 3.0 * invariant);
                let by_first = deviator * (4.0 * first * volume.powf(-2.0 / 3.0));
                let by_second = mixed * (2.0 * second * volume.powf(-4.0 / 3.0));
                inverse() * (by_first + by_second + one * (0.5 * bulk * change * (volume + 1.0)))
            }
        }
    }

    /// Energy per undeformed volume.
    pub fn energy(&self, gradient: &Matrix3<f64>) -> f64 {
        if self.is_small() {
            return 0.5 * self.stress(gradient).dot(gradient);
        }
        if gradient.amax() < SMALL_GRADIENT {
            let work = |(share, weight): (f64, f64)| weight * self.stress(&(gradient * share)).dot(gradient);
            return WAY.into_iter().map(work).sum();
        }
        let deformation = Matrix3::identity() + gradient;
        let right = deformation.transpose() * deformation;
        let (one, volume) = (right.trace(), deformation.determinant());
        match *self {
            Self::LinearElastic { shear, lame } | Self::SaintVenantKirchhoff { shear, lame } => {
                let strain = (right - Matrix3::identity()) * 0.5;
                0.5 * lame * strain.trace().powi(2) + shear * strain.dot(&strain)
            }
            Self::NeoHookean { shear, lame } => {
                0.5 * shear * (one - 3.0) - shear * volume.ln() + 0.5 * lame * (volume - 1.0).powi(2)
            }
            Self::MooneyRivlin { first, second, bulk } => {
                let two = 0.5 * (one * one - (right * right).trace());
                first * (volume.powf(-2.0 / 3.0) * one - 3.0)
                    + second * (volume.powf(-4.0 / 3.0) * two - 3.0)
                    + 0.25 * bulk * (volume * volume - 1.0 - 2.0 * volume.ln())
            }
        }
    }

    /// The strain out of the plane at which the stress there is 0, by the secant method.
    pub fn thickness_change(&self, gradient: &Matrix3<f64>) -> f64 {
        let (shear, lame) = self.moduli();
        let ratio = lame / (lame + 2.0 * shear);
        let mut plane = *gradient;
        plane[(2, 2)] = 0.0;
        if self.is_small() {
            return -ratio * (plane[(0, 0)] + plane[(1, 1)]);
        }
        let stress = |change: f64| {
            let mut whole = plane;
            whole[(2, 2)] = change;
            self.second_stress(&whole)[(2, 2)]
        };
        let mut before = (-ratio * volume_change(&plane).ln_1p()).exp_m1();
        let mut of_before = stress(before);
        let mut change = before - of_before / (lame + 2.0 * shear);
        for _ in 0..100 {
            let here = stress(change);
            let step = here * (change - before) / (here - of_before);
            if !step.is_finite() || step == 0.0 {
                break;
            }
            (before, of_before) = (change, here);
            change = (change - step).max(0.5 * (change - 1.0));
        }
        change
    }
}

/// `det(1 + h) - 1` without the loss of digits at small gradients.
pub fn volume_change(gradient: &Matrix3<f64>) -> f64 {
    let trace = gradient.trace();
    let invariant = 0.5 * (trace * trace - (gradient * gradient).trace());
    trace + invariant + gradient.determinant()
}
