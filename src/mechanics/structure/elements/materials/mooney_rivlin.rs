//! A compressible material of Mooney and Rivlin with decoupled invariants:
//!
//! ```text
//! W = C₁ (J^(-2/3) I₁ - 3) + C₂ (J^(-4/3) I₂ - 3) + ¼ κ (J² - 1 - 2 ln J)
//! ```
//!
//! `I₁ = tr C`, `I₂ = ½ (tr²C - tr C²)`, `C = Fᵀ F`, `J = det F`. The volumetric term (J. C. Simo, R. L. Taylor, Comput.
//! Methods Appl. Mech. Eng. 85 (1991) 273, doi:10.1016/0045-7825(91)90100-K) is convex in `J` and infinite as `J → 0`,
//! where the distortional terms alone would not resist. At small strains the shear modulus is `2 (C₁ + C₂)`, the bulk
//! modulus `κ`.

use crate::mechanics::structure::elements::materials::neo_hookean::distortion;
use crate::mechanics::structure::elements::materials::tensor::{
    IDENTITY, Tensor2, Tensor4, add_crossed, add_dyad, add_product, cofactor, contraction, deviator,
    exponential_remainder, flat, green_strain, logarithm_remainder, product, scaled, second_invariant, sum, trace,
    transpose, volume_change,
};
use crate::mechanics::structure::elements::materials::{ElasticMaterial, ElasticModuli, MaterialError};

/// A material of Mooney and Rivlin.
#[derive(Debug, Clone, Copy)]
pub struct MooneyRivlin {
    first: f64,
    second: f64,
    bulk: f64,
}

impl MooneyRivlin {
    /// From the constants `C₁` and `C₂` and the bulk modulus `κ`.
    ///
    /// # Errors
    ///
    /// Where these do not make a stable material.
    pub fn new(first: f64, second: f64, bulk: f64) -> Result<Self, MaterialError> {
        if !(first >= 0.0 && second >= 0.0 && first + second > 0.0 && (first + second).is_finite()) {
            return Err(MaterialError::MooneyRivlin(first, second));
        }
        if !(bulk > 0.0 && bulk.is_finite()) {
            return Err(MaterialError::Bulk(bulk));
        }
        Ok(Self { first, second, bulk })
    }
}

impl ElasticMaterial for MooneyRivlin {
    fn moduli(&self) -> ElasticModuli {
        ElasticModuli::from_bulk(2.0 * (self.first + self.second), self.bulk)
    }

    /// Terms of first order in the strain, which cancel, are left out.
    fn energy_density(&self, gradient: &Tensor2) -> f64 {
        let strain = green_strain(gradient);
        let change = volume_change(gradient);
        let logarithm = change.ln_1p();
        // `Ī₁ - 3` and `Ī₂ - 3`, with `I₁ = 3 + 2 tr E` and `I₂ = 3 + 4 tr E + 4 I₂(E)`.
        let (distorted, stretched) = (distortion(&strain), trace(&strain));
        let first = {
            let power = -2.0 / 3.0 * logarithm;
            3.0 * exponential_remainder(power) + 2.0 * distorted + 2.0 * power.exp_m1() * stretched
        };
        let second = {
            let power = -4.0 / 3.0 * logarithm;
            3.0 * exponential_remainder(power)
                + 4.0 * distorted
                + 4.0 * power.exp_m1() * stretched
                + 4.0 * power.exp() * second_invariant(&strain)
        };
        let volumetric = change * change - 2.0 * logarithm_remainder(change);
        self.first * first + self.second * second + 0.25 * self.bulk * volumetric
    }

    /// `F⁻ᵀ (2 C₁ J^(-2/3) dev C + 2 C₂ J^(-4/3) dev(I₁ C - C²) + ½ κ (J² - 1) 1)`; the deviators are those of `2E` and of
    /// `2 (I₁ - 2) E - 4 E²`.
    fn stress(&self, gradient: &Tensor2) -> Tensor2 {
        let strain = green_strain(gradient);
        let change = volume_change(gradient);
        let volume = 1.0 + change;
        let (power, first_invariant) = (volume.powf(-2.0 / 3.0), 3.0 + 2.0 * trace(&strain));
        let of_second =
            deviator(&sum(&scaled(2.0 * (first_invariant - 2.0), &strain), -4.0, &product(&strain, &strain)));
        let distortional =
            sum(&scaled(4.0 * self.first * power, &deviator(&strain)), 2.0 * self.second * power * power, &of_second);
        let whole = sum(&distortional, 0.5 * self.bulk * change * (volume + 1.0), &IDENTITY);
        scaled(1.0 / volume, &product(&cofactor(&sum(gradient, 1.0, &IDENTITY)), &whole))
    }

    fn tangent(&self, gradient: &Tensor2) -> Tensor4 {
        let deformation = sum(gradient, 1.0, &IDENTITY);
        let change = volume_change(gradient);
        let volume = 1.0 + change;
        let inverse = scaled(1.0 / volume, &cofactor(&deformation));
        let right = product(&transpose(&deformation), &deformation);
        let left = product(&deformation, &transpose(&deformation));
        let (one, two) = (trace(&right), 0.5 * (trace(&right).powi(2) - contraction(&right, &right)));
        let (flat_deformation, flat_inverse) = (flat(&deformation), flat(&inverse));
        let power = volume.powf(-2.0 / 3.0);
        let (first, second) = (2.0 * self.first * power, self.second * power * power);
        let by_volume = 0.5 * self.bulk;
        let mut tangent = [[0.0; 9]; 9];
        // C₁ (J^(-2/3) I₁).
        add_product(&mut tangent, first + 2.0 * second * one, &IDENTITY, &IDENTITY);
        add_dyad(&mut tangent, -first / 1.5, &flat_deformation, &flat_inverse);
        add_dyad(&mut tangent, -first / 1.5, &flat_inverse, &flat_deformation);
        // C₂ (J^(-4/3) I₂), with `∂I₂/∂F = 2 (I₁ F - F C)`.
        let slope = scaled(2.0, &sum(&scaled(one, &deformation), -1.0, &product(&deformation, &right)));
        let slope = flat(&slope);
        add_dyad(&mut tangent, 4.0 * second, &flat_deformation, &flat_deformation);
        add_product(&mut tangent, -2.0 * second, &IDENTITY, &right);
        add_product(&mut tangent, -2.0 * second, &left, &IDENTITY);
        add_crossed(&mut tangent, -2.0 * second, &deformation, &deformation);
        add_dyad(&mut tangent, -4.0 / 3.0 * second, &slope, &flat_inverse);
        add_dyad(&mut tangent, -4.0 / 3.0 * second, &flat_inverse, &slope);
        // The powers of `J` and the volumetric term.
        let dyad = first * one / 4.5 + second * two / 0.5625 + by_volume * 2.0 * volume * volume;
        let crossed = first * one / 3.0 + second * two / 0.75 - by_volume * change * (volume + 1.0);
        add_dyad(&mut tangent, dyad, &flat_inverse, &flat_inverse);
        add_crossed(&mut tangent, crossed, &inverse, &inverse);
        tangent
    }
}
