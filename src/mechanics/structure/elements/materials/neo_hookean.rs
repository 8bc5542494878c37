//! A compressible neo-Hookean material: `W = ½ G (I₁ - 3) - G ln J + ½ λ (J - 1)²` with `I₁ = tr Fᵀ F`, `J = det F`.
//!
//! Of the usual volumetric terms, `½ λ (ln J)²` softens beyond `J = e` and so makes limit points of its own under
//! tension from all sides; `½ λ (J - 1)²` is convex in `J`, the energy polyconvex (J. M. Ball, Arch. Ration. Mech. Anal.
//! 63 (1977) 337, doi:10.1007/BF00279992), and infinite as `J → 0`. `λ` may be thousands of `G`.

use crate::mechanics::structure::elements::materials::tensor::{
    IDENTITY, Tensor2, Tensor4, add_crossed, add_dyad, add_product, cofactor, determinant, flat, green_strain,
    logarithm_remainder, product, scaled, second_invariant, sum, trace, volume_change,
};
use crate::mechanics::structure::elements::materials::{ElasticMaterial, ElasticModuli};

/// A compressible neo-Hookean material.
#[derive(Debug, Clone, Copy)]
pub struct NeoHookean {
    /// Its moduli at small strains.
    pub moduli: ElasticModuli,
}

/// `½ (I₁ - 3) - ln J` of Green's strain `E`. With `J² = 1 + x`, `x = 2 tr E + 4 I₂(E) + 8 det E`, the terms of first
/// order are left out where they cancel.
pub(super) fn distortion(strain: &Tensor2) -> f64 {
    let beyond = 2.0 * second_invariant(strain) + 4.0 * determinant(strain);
    -beyond - 0.5 * logarithm_remainder(2.0 * (trace(strain) + beyond))
}

impl ElasticMaterial for NeoHookean {
    fn moduli(&self) -> ElasticModuli {
        self.moduli
    }

    fn energy_density(&self, gradient: &Tensor2) -> f64 {
        let ElasticModuli { shear, lame } = self.moduli;
        shear * distortion(&green_strain(gradient)) + 0.5 * lame * volume_change(gradient).powi(2)
    }

    /// `G (F - F⁻ᵀ) + λ (J - 1) J F⁻ᵀ`, with `F - F⁻ᵀ = F⁻ᵀ 2E`.
    fn stress(&self, gradient: &Tensor2) -> Tensor2 {
        let ElasticModuli { shear, lame } = self.moduli;
        let change = volume_change(gradient);
        let cofactor = cofactor(&sum(gradient, 1.0, &IDENTITY));
        let distortional = product(&cofactor, &green_strain(gradient));
        sum(&scaled(2.0 * shear / (1.0 + change), &distortional), lame * change, &cofactor)
    }

    fn tangent(&self, gradient: &Tensor2) -> Tensor4 {
        let ElasticModuli { shear, lame } = self.moduli;
        let change = volume_change(gradient);
        let volume = 1.0 + change;
        let inverse = scaled(1.0 / volume, &cofactor(&sum(gradient, 1.0, &IDENTITY)));
        let mut tangent = [[0.0; 9]; 9];
        add_product(&mut tangent, shear, &IDENTITY, &IDENTITY);
        add_crossed(&mut tangent, shear - lame * change * volume, &inverse, &inverse);
        add_dyad(&mut tangent, lame * (volume + change) * volume, &flat(&inverse), &flat(&inverse));
        tangent
    }
}
