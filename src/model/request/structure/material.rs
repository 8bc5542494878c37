//! Materials of solids.

use serde::{Deserialize, Serialize};

/// An isotropic elastic material.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "server", derive(utoipa::ToSchema))]
#[serde(tag = "kind", rename_all = "snake_case", deny_unknown_fields)]
pub enum Material {
    /// Small strains: the stress is linear in the displacements, and elements do not follow rotations.
    LinearElastic(ElasticConstants),
    /// Large rotations, moderate strains: linear between the second Piola-Kirchhoff stress and Green's strain.
    SaintVenantKirchhoff(ElasticConstants),
    /// Large strains, compressible.
    NeoHookean(ElasticConstants),
    /// Large strains: `c10 (I1' - 3) + c01 (I2' - 3)` of the invariants without the change of volume, and a bulk modulus.
    MooneyRivlin {
        /// First constant (stress), at least 0.
        #[cfg_attr(feature = "server", schema(minimum = 0.0))]
        c10: f64,
        /// Second constant (stress), at least 0; one of both is above 0.
        #[cfg_attr(feature = "server", schema(minimum = 0.0))]
        c01: f64,
        /// Against a change of volume (stress), positive.
        #[cfg_attr(feature = "server", schema(exclusive_minimum = 0.0))]
        bulk_modulus: f64,
        /// Mass per undeformed volume.
        #[serde(default, skip_serializing_if = "Option::is_none")]
        density: Option<f64>,
    },
}

/// Young's modulus and Poisson's ratio of a material at small strains.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "server", derive(utoipa::ToSchema))]
pub struct ElasticConstants {
    /// Young's modulus (stress), positive.
    #[cfg_attr(feature = "server", schema(exclusive_minimum = 0.0))]
    pub young: f64,
    /// Poisson's ratio, above -1 and below 0.5.
    #[cfg_attr(feature = "server", schema(exclusive_minimum = -1.0, exclusive_maximum = 0.5))]
    pub poisson: f64,
    /// Mass per undeformed volume.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub density: Option<f64>,
}

impl Material {
    /// Linear elasticity by Young's modulus (stress) and Poisson's ratio.
    pub fn linear_elastic(young: f64, poisson: f64) -> Self {
        Self::LinearElastic(ElasticConstants { young, poisson, density: None })
    }

    /// Saint Venant's and Kirchhoff's material by Young's modulus (stress) and Poisson's ratio.
    pub fn saint_venant_kirchhoff(young: f64, poisson: f64) -> Self {
        Self::SaintVenantKirchhoff(ElasticConstants { young, poisson, density: None })
    }

    /// A compressible neo-Hookean material by Young's modulus (stress) and Poisson's ratio at small strains.
    pub fn neo_hookean(young: f64, poisson: f64) -> Self {
        Self::NeoHookean(ElasticConstants { young, poisson, density: None })
    }

    /// A nearly incompressible material of Mooney and Rivlin by its two constants and its bulk modulus (stress).
    pub fn mooney_rivlin(c10: f64, c01: f64, bulk_modulus: f64) -> Self {
        Self::MooneyRivlin { c10, c01, bulk_modulus, density: None }
    }
}
