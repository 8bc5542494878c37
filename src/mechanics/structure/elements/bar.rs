//! A pin-jointed bar with exact rotation.
//!
//! With `λ = L/L0` the strain energy is `W = ½ EA L0 ε(λ)² + N0 (L - L0)` for
//!
//! ```text
//! engineering  ε = λ - 1         N = EA ε + N0            N' = EA/L0
//! Green        ε = (λ² - 1)/2    N = EA ε λ + N0          N' = EA (3λ² - 1)/(2 L0)
//! logarithmic  ε = ln λ          N = EA ε/λ + N0          N' = EA (1 - ε)/(λ² L0)
//! ```
//!
//! `N = ∂W/∂L` is the axial force in the deformed direction `d`; the tangent is `N' d dᵀ + (N/L)(I - d dᵀ)`.
//! (Crisfield, *Non-linear Finite Element Analysis of Solids and Structures* 1, Wiley 1991, chapter 3.)

use crate::mechanics::structure::elements::{FiniteElement, Resultants, Stretching};
use serde::{Deserialize, Serialize};

#[derive(Debug, Clone)]
pub struct Bar {
    pub nodes: [usize; 2],
    /// Undeformed vector from the first node to the second; computed from the positions as given, so that close nodes
    /// far from the origin keep their digits.
    pub reference: [f64; 3],
    /// Length of `reference`. Its excess over the rest length adds to the elongation, so that small strains lose no
    /// digits.
    pub reference_length: f64,
    pub axial_stiffness: f64,
    pub rest_length: f64,
    pub prestress: f64,
    pub strain: Strain,
}

/// Bound on the stiffness of a bar over its undeformed stiffness and the square of its stretch, in the estimate of
/// rounding: `N'` of Green strain.
const MOST_STIFFENED: f64 = 1.5;

#[derive(Clone, Copy)]
struct Deformed {
    direction: [f64; 3],
    length: f64,
    elongation: f64,
}

impl Bar {
    /// Deformed direction, length and elongation. The elongation comes from `L² - X² = 2 X·Δu + Δu·Δu`, which keeps
    /// its digits where `L - L0` would cancel.
    #[inline(always)]
    fn deformed(&self, displacement: &[f64]) -> Deformed {
        match *displacement {
            [x0, y0, x1, y1] => self.deformed_by([x1 - x0, y1 - y0]),
            [x0, y0, z0, x1, y1, z1] => self.deformed_by([x1 - x0, y1 - y0, z1 - z0]),
            _ => self.deformed_by([]),
        }
    }

    /// The deformed direction, length and elongation from the displacement of the second node relative to the first.
    #[inline(always)]
    fn deformed_by<const DIMENSION: usize>(&self, relative: [f64; DIMENSION]) -> Deformed {
        let mut direction = [0.0; 3];
        let (mut squared, mut change) = (0.0, 0.0);
        for ((direction, reference), relative) in direction.iter_mut().zip(&self.reference).zip(relative) {
            *direction = reference + relative;
            squared += *direction * *direction;
            change += (2.0 * reference + relative) * relative;
        }
        let length = squared.sqrt();
        if length > 0.0 {
            direction.iter_mut().for_each(|value| *value /= length);
        }
        let initial = self.reference_length - self.rest_length;
        let elongation = change / (length + self.reference_length) + initial;
        Deformed { direction, length, elongation }
    }

    /// The strain `ε`, the axial force `N` and the slope `N'`.
    #[inline(always)]
    fn response(&self, elongation: f64) -> (f64, f64, f64) {
        let (stiffness, rest) = (self.axial_stiffness, self.rest_length);
        let engineering = elongation / rest;
        let stretch = 1.0 + engineering;
        match self.strain {
            Strain::Engineering => (engineering, stiffness * engineering + self.prestress, stiffness / rest),
            Strain::Green => {
                let strain = engineering * (1.0 + 0.5 * engineering);
                let slope = stiffness * (3.0 * stretch * stretch - 1.0) / (2.0 * rest);
                (strain, stiffness * strain * stretch + self.prestress, slope)
            }
            Strain::Log => {
                let strain = engineering.ln_1p();
                let slope = stiffness * (1.0 - strain) / (stretch * stretch * rest);
                (strain, stiffness * strain / stretch + self.prestress, slope)
            }
        }
    }

    /// Writes `slope d dᵀ + geometric (I - d dᵀ)` between the nodes; the tangent where these are `N'` and `N/L`.
    #[inline(always)]
    fn write_parts(deformed: &Deformed, slope: f64, geometric: f64, stiffness: &mut [f64]) {
        match stiffness.len() {
            16 => Self::write_parts_in::<2>(deformed, slope, geometric, stiffness),
            _ => Self::write_parts_in::<3>(deformed, slope, geometric, stiffness),
        }
    }

    /// As `write_parts`, in a number of dimensions known to the compiler.
    #[inline(always)]
    fn write_parts_in<const DIMENSION: usize>(deformed: &Deformed, slope: f64, geometric: f64, stiffness: &mut [f64]) {
        let (upper, lower) = stiffness.split_at_mut(2 * DIMENSION * DIMENSION);
        for row in 0..DIMENSION {
            let upper = &mut upper[2 * DIMENSION * row..][..2 * DIMENSION];
            let lower = &mut lower[2 * DIMENSION * row..][..2 * DIMENSION];
            for column in 0..DIMENSION {
                let along = deformed.direction[row] * deformed.direction[column];
                let across = if row == column { 1.0 - along } else { -along };
                let value = slope * along + geometric * across;
                (upper[column], upper[DIMENSION + column]) = (value, -value);
                (lower[column], lower[DIMENSION + column]) = (-value, value);
            }
        }
    }
}

impl FiniteElement for Bar {
    fn nodes(&self) -> &[usize] {
        &self.nodes
    }

    fn is_of_relative_positions(&self) -> bool {
        true
    }

    #[inline(always)]
    fn energy(&self, displacement: &[f64]) -> f64 {
        let elongation = self.deformed(displacement).elongation;
        let (strain, _, _) = self.response(elongation);
        0.5 * self.axial_stiffness * self.rest_length * strain * strain + self.prestress * elongation
    }

    #[inline(always)]
    fn write_force(&self, displacement: &[f64], force: &mut [f64]) -> f64 {
        let deformed = self.deformed(displacement);
        let (_, axial, _) = self.response(deformed.elongation);
        let (first, second) = force.split_at_mut(force.len() / 2);
        for (end, sign) in [(first, -1.0), (second, 1.0)] {
            end.iter_mut().zip(&deformed.direction).for_each(|(force, direction)| *force = sign * (axial * direction));
        }
        axial.abs()
    }

    fn resultants(&self, displacement: &[f64]) -> Option<Resultants> {
        let (_, axial, _) = self.response(self.deformed(displacement).elongation);
        Some(Resultants::Axial(axial))
    }

    #[inline(always)]
    fn write_stiffness(&self, displacement: &[f64], stiffness: &mut [f64]) {
        let deformed = self.deformed(displacement);
        let (_, axial, slope) = self.response(deformed.elongation);
        Self::write_parts(&deformed, slope, axial / deformed.length, stiffness);
    }

    /// The axial force and its change under displacements of this size. The stiffness is bounded, so that the loss of
    /// direction of a bar that shrinks to a point does not count: there the forces are lost, which is no equilibrium.
    #[inline(always)]
    fn write_force_sizes(&self, displacement: &[f64], least: f64, sizes: &mut [f64]) {
        let deformed = self.deformed(displacement);
        let (_, axial, slope) = self.response(deformed.elongation);
        let reach = displacement.iter().fold(least, |reach: f64, value| reach.max(value.abs()));
        let stretch = (deformed.length / self.rest_length).max(1.0);
        let most = MOST_STIFFENED * self.axial_stiffness / self.rest_length * stretch * stretch;
        let stiffness = (slope.abs() + axial.abs() / deformed.length).min(most);
        sizes.fill(axial.abs() + stiffness * reach);
    }

    fn axial_stiffness(&self, _motion: &[f64]) -> f64 {
        self.axial_stiffness
    }

    /// The summand `N' d dᵀ`.
    fn stretching(&self, displacement: &[f64]) -> Vec<Stretching> {
        let deformed = self.deformed(displacement);
        let (_, _, stiffness) = self.response(deformed.elongation);
        if stiffness == 0.0 {
            return Vec::new();
        }
        let dimension = displacement.len() / 2;
        let end = |first: usize, sign: f64| {
            (0..dimension).map(move |component| (first + component, sign * deformed.direction[component]))
        };
        vec![Stretching { stiffness, along: end(0, -1.0).chain(end(dimension, 1.0)).collect() }]
    }

    /// Writes `(N/L)(I - d dᵀ)` alone.
    #[inline(always)]
    fn write_stiffness_across(&self, displacement: &[f64], stiffness: &mut [f64]) {
        let deformed = self.deformed(displacement);
        let (_, axial, _) = self.response(deformed.elongation);
        Self::write_parts(&deformed, 0.0, axial / deformed.length, stiffness);
    }

    fn stretch(&self, displacement: &[f64]) -> Option<f64> {
        Some(self.deformed(displacement).length / self.rest_length)
    }
}

/// How a bar's strain is measured; `λ = L/L0`.
#[warn(missing_docs)]
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default, Serialize, Deserialize)]
#[cfg_attr(feature = "server", derive(utoipa::ToSchema))]
#[serde(rename_all = "snake_case")]
pub enum Strain {
    /// `λ - 1`
    #[default]
    Engineering,
    /// `(λ² - 1)/2`
    Green,
    /// `ln λ`
    Log,
}
