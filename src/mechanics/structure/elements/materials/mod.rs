//! The materials of solid elements, one file each, and the interface of all.
//!
//! A hyperelastic material is an energy density `W` of the deformation gradient `F = 1 + h`, per undeformed volume:
//!
//! ```text
//! P_iJ = ∂W/∂F_iJ        A_iJkL = ∂²W/∂F_iJ ∂F_kL
//! ```
//!
//! `P` is the first Piola-Kirchhoff stress (J. Bonet, R. D. Wood, *Nonlinear Continuum Mechanics for Finite Element
//! Analysis*, Cambridge 2008, chapter 6). Functions take the displacement gradient `h = F - 1` (dimensionless): strains
//! computed from it keep their digits however small they are, where `F` itself would have rounded them away. Stresses
//! and moduli are in one unit, that of the given moduli.

pub mod linear_elastic;
pub mod mooney_rivlin;
pub mod neo_hookean;
pub mod saint_venant_kirchhoff;
pub mod tensor;
#[cfg(test)]
mod tests;

use std::fmt::Debug;
use tensor::{Tensor2, Tensor4};

/// An isotropic elastic material. A material of finite strain is asked only where `det F > 0`.
pub trait ElasticMaterial: Debug + Send + Sync {
    /// The moduli of small strains.
    fn moduli(&self) -> ElasticModuli;

    /// Whether strains count as small: the stress is linear in the displacement gradient.
    fn is_linear(&self) -> bool {
        false
    }

    /// Energy `W` per undeformed volume.
    fn energy_density(&self, gradient: &Tensor2) -> f64;

    /// The first Piola-Kirchhoff stress `P`.
    fn stress(&self, gradient: &Tensor2) -> Tensor2;

    /// The tangent `A`, with the symmetry `A_iJkL = A_kLiJ`.
    fn tangent(&self, gradient: &Tensor2) -> Tensor4;
}

/// The moduli of an isotropic material at small strains, in the unit of stress.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct ElasticModuli {
    /// Shear modulus `G`.
    pub shear: f64,
    /// Lamé's first modulus `λ`.
    pub lame: f64,
}

impl ElasticModuli {
    /// From Young's modulus and Poisson's ratio.
    ///
    /// # Errors
    ///
    /// Where these do not make a stable, compressible material.
    pub fn from_young(young: f64, poisson: f64) -> Result<Self, MaterialError> {
        if !(young > 0.0 && young.is_finite()) {
            return Err(MaterialError::Young(young));
        }
        if !(poisson > -1.0 && poisson < 0.5) {
            return Err(MaterialError::Poisson(poisson));
        }
        let shear = young / (2.0 * (1.0 + poisson));
        Ok(Self { shear, lame: 2.0 * shear * poisson / (1.0 - 2.0 * poisson) })
    }

    /// From the shear modulus and the bulk modulus.
    pub fn from_bulk(shear: f64, bulk: f64) -> Self {
        Self { shear, lame: bulk - shear / 1.5 }
    }

    /// Bulk modulus `κ = λ + ⅔ G`.
    pub fn bulk(&self) -> f64 {
        self.lame + self.shear / 1.5
    }

    /// Young's modulus `E`.
    pub fn young(&self) -> f64 {
        self.shear * (3.0 * self.lame + 2.0 * self.shear) / (self.lame + self.shear)
    }

    /// Poisson's ratio `ν`.
    pub fn poisson(&self) -> f64 {
        0.5 * self.lame / (self.lame + self.shear)
    }
}

/// Constants that make no material.
#[derive(Debug, Clone, Copy, PartialEq, thiserror::Error)]
pub enum MaterialError {
    /// Young's modulus.
    #[error("Young's modulus must be positive, not {0}")]
    Young(f64),
    /// Poisson's ratio.
    #[error(
        "Poisson's ratio must lie between -1 and 0.5 (for nearly incompressible materials up to 0.4999), not be {0}"
    )]
    Poisson(f64),
    /// The constants of Mooney and Rivlin.
    #[error("the constants {0} and {1} must not be negative and their sum must be positive")]
    MooneyRivlin(f64, f64),
    /// Bulk modulus.
    #[error("the bulk modulus must be positive, not {0}")]
    Bulk(f64),
}
