//! The response of the material at a point in the components that the displacements of an element have.
//!
//! Components are reduced to the slots of [`geometry`](crate::mechanics::structure::elements::solid::shapes::geometry): `(i, s)` is
//! the component `i s` of a tensor, and `(0, 2)` in the plane is the component `22` around the axis. In plane stress the
//! stretch out of the plane is solved for, `∂W/∂F_22 = 0`, and leaves the tangent by condensation.

use crate::mechanics::structure::elements::COLLAPSED;
use crate::mechanics::structure::elements::materials::ElasticMaterial;
use crate::mechanics::structure::elements::materials::tensor::{Tensor2, Tensor4, volume_change};
use std::sync::Arc;

/// A tensor of second order in slots.
pub type Slots2<const D: usize, const S: usize> = [[f64; S]; D];

/// A tensor of fourth order in slots.
pub type Slots4<const D: usize, const S: usize> = [[[[f64; S]; D]; S]; D];

/// Most Newton iterations for the stretch out of the plane.
const MOST_ITERATIONS: usize = 60;

/// Bounds on the stretch out of the plane.
const STRETCHES: [f64; 2] = [1e-4, 1e4];

/// The change of the stretch, relative to it, below which one more iteration makes it exact.
const CONVERGED: f64 = 1e-9;

/// A material, and whether the stress out of the plane is 0.
#[derive(Debug, Clone)]
pub struct ConstitutiveLaw {
    /// The material.
    pub material: Arc<dyn ElasticMaterial>,
    /// Whether the stretch out of the plane is solved for.
    pub is_plane_stress: bool,
}

/// The component of a flat tensor that stands in a slot; `None` for the one that is always 0.
#[inline(always)]
const fn component<const D: usize>(row: usize, slot: usize) -> Option<usize> {
    match (D, row, slot) {
        (2, 0, 2) => Some(8),
        (2, _, 2) => None,
        _ => Some(3 * row + slot),
    }
}

impl ConstitutiveLaw {
    /// The displacement gradient in all components; `None` where the volume is gone or turned inside out, or where no
    /// stretch out of the plane is free of stress.
    #[inline(always)]
    pub fn gradient<const D: usize, const S: usize>(&self, slots: &Slots2<D, S>) -> Option<Tensor2> {
        let gradient = self.unchecked_gradient(slots)?;
        (self.material.is_linear() || volume_change(&gradient) > COLLAPSED - 1.0).then_some(gradient)
    }

    /// As [`gradient`](Self::gradient), whatever the volume.
    #[inline(always)]
    pub fn unchecked_gradient<const D: usize, const S: usize>(&self, slots: &Slots2<D, S>) -> Option<Tensor2> {
        let mut gradient = [[0.0; 3]; 3];
        for (row, own) in slots.iter().enumerate() {
            for (slot, value) in own.iter().enumerate() {
                if let Some(place) = component::<D>(row, slot) {
                    gradient[place / 3][place % 3] = *value;
                }
            }
        }
        if self.is_plane_stress {
            gradient[2][2] = self.thickness_change(&gradient)?;
        }
        Some(gradient)
    }

    /// The stretch out of the plane, less 1, at which the stress there is 0: Newton's method from the stretch at which a
    /// material of the same Poisson's ratio would be, each iteration at most halving or doubling the stretch.
    fn thickness_change(&self, gradient: &Tensor2) -> Option<f64> {
        let mut gradient = *gradient;
        let [[h00, h01, _], [h10, h11, _], _] = gradient;
        let area_change = h00 + h11 + (h00 * h11 - h01 * h10);
        let is_linear = self.material.is_linear();
        if !is_linear {
            if area_change <= COLLAPSED - 1.0 {
                return None;
            }
            let poisson = self.material.moduli().poisson();
            gradient[2][2] = (-poisson / (1.0 - poisson) * area_change.ln_1p()).exp_m1();
        }
        let mut is_last = false;
        for _ in 0..MOST_ITERATIONS {
            let slope = self.material.tangent(&gradient)[8][8];
            let stress = self.material.stress(&gradient)[2][2];
            let stretch = 1.0 + gradient[2][2];
            let newton = -stress / slope;
            // Where the energy is not convex, downhill.
            let step = if slope > 0.0 { newton } else { -stress.signum() * stretch };
            let step = if is_linear { step } else { step.clamp(-0.5 * stretch, stretch) };
            gradient[2][2] += step;
            if !step.is_finite() || !is_linear && !(STRETCHES[0]..STRETCHES[1]).contains(&(1.0 + gradient[2][2])) {
                return None;
            }
            if is_last {
                return Some(gradient[2][2]);
            }
            is_last = slope > 0.0 && step.abs() <= CONVERGED * stretch.abs().max(CONVERGED);
        }
        None
    }

    /// The stress in slots.
    #[inline(always)]
    pub fn stress<const D: usize, const S: usize>(&self, gradient: &Tensor2) -> Slots2<D, S> {
        reduced_stress(&self.material.stress(gradient))
    }

    /// The tangent in slots.
    #[inline(always)]
    pub fn tangent<const D: usize, const S: usize>(&self, gradient: &Tensor2) -> Slots4<D, S> {
        let mut tangent = self.material.tangent(gradient);
        if self.is_plane_stress {
            let through = tangent[8];
            for (row, factor) in tangent.iter_mut().zip(&through) {
                row.iter_mut().zip(&through).for_each(|(value, other)| *value -= factor * other / through[8]);
            }
        }
        reduced_tangent(&tangent)
    }
}

/// The components of a stress that stand in slots.
#[inline(always)]
pub fn reduced_stress<const D: usize, const S: usize>(stress: &Tensor2) -> Slots2<D, S> {
    std::array::from_fn(|row| {
        std::array::from_fn(|slot| component::<D>(row, slot).map_or(0.0, |place| stress[place / 3][place % 3]))
    })
}

/// The components of a tangent that stand in slots.
#[inline(always)]
pub fn reduced_tangent<const D: usize, const S: usize>(tangent: &Tensor4) -> Slots4<D, S> {
    std::array::from_fn(|row| {
        std::array::from_fn(|slot| {
            let Some(place) = component::<D>(row, slot) else { return [[0.0; S]; D] };
            std::array::from_fn(|other| {
                std::array::from_fn(|place_of| component::<D>(other, place_of).map_or(0.0, |k| tangent[place][k]))
            })
        })
    })
}
