//! A point of the path and the path's direction there, dimensionless.

use crate::mechanics::contact::Reaction;
use crate::mechanics::structure::Structure;
use serde::{Deserialize, Serialize};

/// Displacements over all degrees of freedom, load factor, reactions (one per contact).
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct State {
    pub displacement: Vec<f64>,
    pub load: f64,
    pub reactions: Vec<Reaction>,
}

/// Derivatives of a [`State`] by arc length; `‖(u̇, ṡ)‖ = 1`.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct Rate {
    pub displacement: Vec<f64>,
    pub load: f64,
    pub reactions: Vec<Reaction>,
}

impl State {
    pub fn at_rest(structure: &Structure, contacts: usize) -> Self {
        Self {
            displacement: vec![0.0; structure.freedoms()],
            load: 0.0,
            reactions: vec![Reaction::default(); contacts],
        }
    }

    /// The state after a straight step along a rate.
    pub fn advanced(&self, rate: &Rate, step: f64) -> Self {
        let mut state = self.clone();
        state.advance(rate, step);
        state
    }

    /// Advances the state by a straight step along a rate.
    pub fn advance(&mut self, rate: &Rate, step: f64) {
        for (value, rate) in self.displacement.iter_mut().zip(&rate.displacement) {
            *value += step * rate;
        }
        self.load += step * rate.load;
        for (reaction, rate) in self.reactions.iter_mut().zip(&rate.reactions) {
            reaction.add(step, rate);
        }
    }

    /// Copies another state, without new memory where both are of one structure.
    pub fn set_to(&mut self, other: &Self) {
        self.displacement.clone_from(&other.displacement);
        self.load = other.load;
        self.reactions.clone_from(&other.reactions);
    }

    /// The change to another state.
    pub fn chord(&self, other: &Self) -> Rate {
        let mut chord =
            Rate { displacement: other.displacement.clone(), load: other.load, reactions: other.reactions.clone() };
        chord.displacement.iter_mut().zip(&self.displacement).for_each(|(change, own)| *change -= own);
        chord.load -= self.load;
        chord.reactions.iter_mut().zip(&self.reactions).for_each(|(change, own)| change.add(-1.0, own));
        chord
    }

    /// The norm `‖(u, s)‖`.
    pub fn size(&self) -> f64 {
        dot(&self.displacement, &self.displacement).sqrt().hypot(self.load)
    }

    /// The distance `‖(Δu, Δs)‖` to another state.
    pub fn distance(&self, other: &Self) -> f64 {
        let squared: f64 = self.displacement.iter().zip(&other.displacement).map(|(a, b)| (a - b) * (a - b)).sum();
        (squared + (self.load - other.load).powi(2)).sqrt()
    }
}

impl State {
    /// Cosine of the angle between the chord to another state, at this distance, and a rate; 1 for no chord.
    pub fn cosine_of_chord(&self, other: &Self, distance: f64, rate: &Rate) -> f64 {
        let size = distance * rate.size();
        if size > 0.0 { (self.product_of_chord(other, rate) / size).clamp(-1.0, 1.0) } else { 1.0 }
    }

    /// Inner product of the chord to another state and a rate.
    pub fn product_of_chord(&self, other: &Self, rate: &Rate) -> f64 {
        other
            .displacement
            .iter()
            .zip(&self.displacement)
            .zip(&rate.displacement)
            .map(|((to, from), rate)| (to - from) * rate)
            .sum::<f64>()
            + (other.load - self.load) * rate.load
    }
}

impl Rate {
    /// The norm `‖(u̇, ṡ)‖`.
    pub fn size(&self) -> f64 {
        (dot(&self.displacement, &self.displacement) + self.load * self.load).sqrt()
    }

    /// The inner product `(u̇, ṡ)₁·(u̇, ṡ)₂`.
    pub fn product(&self, other: &Self) -> f64 {
        dot(&self.displacement, &other.displacement) + self.load * other.load
    }

    /// The angle (radians) between two rates of unit arc length.
    pub fn angle(&self, other: &Self) -> f64 {
        self.product(other).clamp(-1.0, 1.0).acos()
    }

    pub fn scale(&mut self, factor: f64) {
        self.displacement.iter_mut().for_each(|value| *value *= factor);
        self.load *= factor;
        for reaction in &mut self.reactions {
            reaction.normal *= factor;
            reaction.tangential.iter_mut().for_each(|value| *value *= factor);
        }
    }

    /// The rate scaled to unit size; `None` where the size is zero or not finite.
    pub fn normalised(mut self) -> Option<Self> {
        let size = self.size();
        if size <= 0.0 || !size.is_finite() {
            return None;
        }
        self.scale(1.0 / size);
        Some(self)
    }

    /// Adds a multiple of another rate.
    pub fn add(&mut self, other: &Self, factor: f64) {
        self.displacement.iter_mut().zip(&other.displacement).for_each(|(sum, value)| *sum += factor * value);
        self.load += factor * other.load;
        for (sum, value) in self.reactions.iter_mut().zip(&other.reactions) {
            sum.normal += factor * value.normal;
            sum.tangential.iter_mut().zip(&value.tangential).for_each(|(sum, value)| *sum += factor * value);
        }
    }

    /// Largest rate of any reaction.
    pub fn largest_reaction(&self) -> f64 {
        self.reactions.iter().fold(0.0, |largest, reaction| largest.max(reaction.size()))
    }
}

/// `a·b`
pub fn dot(a: &[f64], b: &[f64]) -> f64 {
    a.iter().zip(b).map(|(a, b)| a * b).sum()
}
