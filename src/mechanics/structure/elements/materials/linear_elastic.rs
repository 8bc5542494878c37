//! Isotropic linear elasticity of small strains: `W = ½ λ tr²ε + G ε : ε` with `ε = sym h`.
//!
//! Rotations are not followed; a structure of such elements is linear.

use crate::mechanics::structure::elements::materials::tensor::{
    IDENTITY, Tensor2, Tensor4, add_crossed, add_dyad, add_product, contraction, flat, scaled, sum, trace, transpose,
};
use crate::mechanics::structure::elements::materials::{ElasticMaterial, ElasticModuli};

/// A linear elastic material.
#[derive(Debug, Clone, Copy)]
pub struct LinearElastic {
    /// Its moduli.
    pub moduli: ElasticModuli,
}

impl ElasticMaterial for LinearElastic {
    fn moduli(&self) -> ElasticModuli {
        self.moduli
    }

    fn is_linear(&self) -> bool {
        true
    }

    fn energy_density(&self, gradient: &Tensor2) -> f64 {
        0.5 * contraction(&self.stress(gradient), gradient)
    }

    fn stress(&self, gradient: &Tensor2) -> Tensor2 {
        let doubled = sum(gradient, 1.0, &transpose(gradient));
        sum(&scaled(self.moduli.shear, &doubled), self.moduli.lame * trace(gradient), &IDENTITY)
    }

    fn tangent(&self, _gradient: &Tensor2) -> Tensor4 {
        let ElasticModuli { shear, lame } = self.moduli;
        let mut tangent = [[0.0; 9]; 9];
        add_dyad(&mut tangent, lame, &flat(&IDENTITY), &flat(&IDENTITY));
        add_product(&mut tangent, shear, &IDENTITY, &IDENTITY);
        add_crossed(&mut tangent, shear, &IDENTITY, &IDENTITY);
        tangent
    }
}
