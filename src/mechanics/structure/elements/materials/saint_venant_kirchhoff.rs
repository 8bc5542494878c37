//! The material of Saint Venant and Kirchhoff: `W = ½ λ tr²E + G E : E` with Green's strain `E = ½ (Fᵀ F - 1)`.
//!
//! For small strains at any rotation. Under strong compression it softens and fails (a bar's force has its extremum at
//! the stretch `1/√3`).

use crate::mechanics::structure::elements::materials::tensor::{
    IDENTITY, Tensor2, Tensor4, add_crossed, add_dyad, add_product, contraction, flat, green_strain, product, scaled,
    sum, trace, transpose,
};
use crate::mechanics::structure::elements::materials::{ElasticMaterial, ElasticModuli};

/// A material of Saint Venant and Kirchhoff.
#[derive(Debug, Clone, Copy)]
pub struct SaintVenantKirchhoff {
    /// Its moduli.
    pub moduli: ElasticModuli,
}

impl SaintVenantKirchhoff {
    /// The second Piola-Kirchhoff stress `λ (tr E) 1 + 2 G E`.
    #[inline(always)]
    fn second_stress(&self, strain: &Tensor2) -> Tensor2 {
        sum(&scaled(2.0 * self.moduli.shear, strain), self.moduli.lame * trace(strain), &IDENTITY)
    }
}

impl ElasticMaterial for SaintVenantKirchhoff {
    fn moduli(&self) -> ElasticModuli {
        self.moduli
    }

    fn energy_density(&self, gradient: &Tensor2) -> f64 {
        let strain = green_strain(gradient);
        0.5 * contraction(&self.second_stress(&strain), &strain)
    }

    fn stress(&self, gradient: &Tensor2) -> Tensor2 {
        product(&sum(gradient, 1.0, &IDENTITY), &self.second_stress(&green_strain(gradient)))
    }

    fn tangent(&self, gradient: &Tensor2) -> Tensor4 {
        let ElasticModuli { shear, lame } = self.moduli;
        let deformation = sum(gradient, 1.0, &IDENTITY);
        let left = product(&deformation, &transpose(&deformation));
        let mut tangent = [[0.0; 9]; 9];
        add_product(&mut tangent, 1.0, &IDENTITY, &self.second_stress(&green_strain(gradient)));
        add_dyad(&mut tangent, lame, &flat(&deformation), &flat(&deformation));
        add_crossed(&mut tangent, shear, &deformation, &deformation);
        add_product(&mut tangent, shear, &left, &IDENTITY);
        tangent
    }
}
