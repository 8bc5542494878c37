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

use crate::mechanics::structure::elements::Stretching;
use serde::{Deserialize, Serialize};

#[derive(Debug, Clone)]
pub struct Bar {
    pub nodes: [usize; 2],
    /// Undeformed vector from the first node to the second; from the places as given, so that close nodes far from the
    /// origin keep their digits.
    pub reference: [f64; 3],
    /// Its length. What it has more than the rest length adds to the elongation, so that small strains lose no digits.
    pub reference_length: f64,
    pub axial_stiffness: f64,
    pub rest_length: f64,
    pub prestress: f64,
    pub strain: Strain,
}

/// How much stiffer a bar may be than undeformed, over the square of its stretch, for rounding to count: `N'` of Green strain.
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
    fn deformed(&self, dimension: usize, displacement: &[f64]) -> Deformed {
        let [from, to] = self.nodes.map(|node| &displacement[node * dimension..][..dimension]);
        match (from, to) {
            ([x0, y0], [x1, y1]) => self.deformed_by([x1 - x0, y1 - y0]),
            ([x0, y0, z0], [x1, y1, z1]) => self.deformed_by([x1 - x0, y1 - y0, z1 - z0]),
            _ => self.deformed_by([]),
        }
    }

    /// The same by the displacement of the second node less that of the first.
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

    /// `L/L0`
    pub fn stretch(&self, dimension: usize, displacement: &[f64]) -> f64 {
        self.deformed(dimension, displacement).length / self.rest_length
    }

    /// `ε`, `N` and `N'`.
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

    pub fn add_force(&self, dimension: usize, displacement: &[f64], force: &mut [f64]) -> f64 {
        let deformed = self.deformed(dimension, displacement);
        let (_, axial, _) = self.response(deformed.elongation);
        let mut add = |node: usize, sign: f64| {
            let own = force[node * dimension..(node + 1) * dimension].iter_mut();
            own.zip(&deformed.direction).for_each(|(force, direction)| *force += sign * (axial * direction));
        };
        add(self.nodes[0], -1.0);
        add(self.nodes[1], 1.0);
        axial.abs()
    }

    pub fn add_stiffness(&self, dimension: usize, displacement: &[f64], add: &mut impl FnMut(usize, usize, f64)) {
        let deformed = self.deformed(dimension, displacement);
        let (_, axial, slope) = self.response(deformed.elongation);
        self.add_parts(dimension, &deformed, slope, axial / deformed.length, add);
    }

    /// `(N/L)(I - d dᵀ)` alone.
    pub fn add_stiffness_across(
        &self,
        dimension: usize,
        displacement: &[f64],
        add: &mut impl FnMut(usize, usize, f64),
    ) {
        let deformed = self.deformed(dimension, displacement);
        let (_, axial, _) = self.response(deformed.elongation);
        self.add_parts(dimension, &deformed, 0.0, axial / deformed.length, add);
    }

    /// `N' d dᵀ`
    pub fn stretching(&self, dimension: usize, displacement: &[f64]) -> Option<Stretching> {
        let deformed = self.deformed(dimension, displacement);
        let (_, _, stiffness) = self.response(deformed.elongation);
        let end = |node: usize, sign: f64| {
            (0..dimension).map(move |component| (node * dimension + component, sign * deformed.direction[component]))
        };
        let along = end(self.nodes[0], -1.0).chain(end(self.nodes[1], 1.0)).collect();
        (stiffness != 0.0).then_some(Stretching { stiffness, along })
    }

    fn add_parts(
        &self,
        dimension: usize,
        deformed: &Deformed,
        slope: f64,
        geometric: f64,
        add: &mut impl FnMut(usize, usize, f64),
    ) {
        match dimension {
            2 => self.add_parts_in::<2>(deformed, slope, geometric, add),
            _ => self.add_parts_in::<3>(deformed, slope, geometric, add),
        }
    }

    /// The same in so many dimensions, which the compiler knows.
    fn add_parts_in<const DIMENSION: usize>(
        &self,
        deformed: &Deformed,
        slope: f64,
        geometric: f64,
        add: &mut impl FnMut(usize, usize, f64),
    ) {
        let (first, second) = (self.nodes[0] * DIMENSION, self.nodes[1] * DIMENSION);
        for row in 0..DIMENSION {
            for column in 0..DIMENSION {
                let along = deformed.direction[row] * deformed.direction[column];
                let across = if row == column { 1.0 - along } else { -along };
                let value = slope * along + geometric * across;
                add(first + row, first + column, value);
                add(second + row, second + column, value);
                add(first + row, second + column, -value);
                add(second + row, first + column, -value);
            }
        }
    }

    /// Calls `add(freedom, size)` with the axial force and what displacements of this size would make of it; not what they
    /// do to the direction of a bar that shrinks to a point: there the forces are lost, which is no equilibrium.
    pub fn each_size(&self, dimension: usize, displacement: &[f64], least: f64, add: &mut impl FnMut(usize, f64)) {
        let deformed = self.deformed(dimension, displacement);
        let (_, axial, slope) = self.response(deformed.elongation);
        let freedoms = || self.nodes.iter().flat_map(|node| node * dimension..(node + 1) * dimension);
        let reach = freedoms().fold(least, |reach: f64, freedom| reach.max(displacement[freedom].abs()));
        let stretch = (deformed.length / self.rest_length).max(1.0);
        let most = MOST_STIFFENED * self.axial_stiffness / self.rest_length * stretch * stretch;
        let stiffness = (slope.abs() + axial.abs() / deformed.length).min(most);
        freedoms().for_each(|freedom| add(freedom, axial.abs() + stiffness * reach));
    }

    pub fn energy(&self, dimension: usize, displacement: &[f64]) -> f64 {
        let elongation = self.deformed(dimension, displacement).elongation;
        let (strain, _, _) = self.response(elongation);
        0.5 * self.axial_stiffness * self.rest_length * strain * strain + self.prestress * elongation
    }
}

/// How a bar's strain is measured; `λ = L/L0`.
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

/// Stretch of a bar at which steps that do not converge are its collapse.
pub(crate) const COLLAPSED: f64 = 1e-4;
