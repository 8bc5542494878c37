//! A point of the path and the path's direction there, dimensionless.

use crate::mechanics::contact::Reaction;
use crate::mechanics::structure::Structure;
use serde::{Deserialize, Serialize};

/// Displacements over all degrees of freedom, load factor, reactions (one per contact).
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct State {
    pub displacement: Vec<f64>,
    /// What the rounding of each displacement leaves: the displacement is the sum of both. Empty where the structure is
    /// too soft for it to matter: see [`Structure::keeps_remainders`].
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub remainder: Vec<f64>,
    pub load: f64,
    /// What the rounding of the load factor leaves, where displacements have remainders: supports and obstacles move with it.
    #[serde(default, skip_serializing_if = "is_zero")]
    pub load_remainder: f64,
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
            remainder: if structure.keeps_remainders() { vec![0.0; structure.freedoms()] } else { Vec::new() },
            load: 0.0,
            load_remainder: 0.0,
            reactions: vec![Reaction::default(); contacts],
        }
    }

    /// Sets the load factor to exactly this value.
    pub fn set_load(&mut self, value: f64) {
        (self.load, self.load_remainder) = (value, 0.0);
    }

    /// The load factor, which becomes zero.
    pub fn take_load(&mut self) -> f64 {
        self.load_remainder = 0.0;
        std::mem::take(&mut self.load)
    }

    /// The load factor less that of another state, with what both keep of rounding.
    pub fn load_beyond(&self, other: &Self) -> f64 {
        (self.load - other.load) + (self.load_remainder - other.load_remainder)
    }

    /// Sets a displacement to the sum of two numbers.
    pub fn place(&mut self, freedom: usize, value: f64, change: f64) {
        let (sum, left) = sum_and_remainder(value, change);
        self.displacement[freedom] = sum;
        if let Some(remainder) = self.remainder.get_mut(freedom) {
            *remainder = left;
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
        if self.remainder.is_empty() {
            for (value, rate) in self.displacement.iter_mut().zip(&rate.displacement) {
                *value += step * rate;
            }
        } else {
            let values = self.displacement.iter_mut().zip(&mut self.remainder);
            for ((value, remainder), rate) in values.zip(&rate.displacement) {
                let (sum, left) = sum_and_remainder(*value, step * rate);
                (*value, *remainder) = sum_and_remainder(sum, left + *remainder);
            }
        }
        if self.remainder.is_empty() {
            self.load += step * rate.load;
        } else {
            let (sum, left) = sum_and_remainder(self.load, step * rate.load);
            (self.load, self.load_remainder) = sum_and_remainder(sum, left + self.load_remainder);
        }
        for (reaction, rate) in self.reactions.iter_mut().zip(&rate.reactions) {
            reaction.add(step, rate);
        }
    }

    /// Copies another state, without new memory where both are of one structure.
    pub fn set_to(&mut self, other: &Self) {
        self.displacement.clone_from(&other.displacement);
        self.remainder.clone_from(&other.remainder);
        (self.load, self.load_remainder) = (other.load, other.load_remainder);
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

fn is_zero(value: &f64) -> bool {
    *value == 0.0
}

/// The rounded sum of two numbers, and what its rounding left: together exactly the sum (D. E. Knuth, The Art of Computer
/// Programming, vol. 2, 3rd ed., section 4.2.2, theorem B).
fn sum_and_remainder(first: f64, second: f64) -> (f64, f64) {
    let sum = first + second;
    let of_second = sum - first;
    let of_first = sum - of_second;
    (sum, (first - of_first) + (second - of_second))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::mechanics::structure::element_list::ElementList;
    use crate::mechanics::structure::elements::beam::Beam;
    use crate::mechanics::structure::elements::beam::segment::SectionStiffness;

    const ELEMENTS: usize = 1_000;

    /// A beam of unit length of many elements, clamped at its start.
    fn beam_of_short_elements() -> Structure {
        let section = SectionStiffness { axial: 1e4, bending: 1.0, shear: None };
        let chord = [1.0 / ELEMENTS as f64, 0.0];
        let elements = (0..ELEMENTS).map(|place| Beam::straight([place, place + 1], chord, section));
        Structure::new(2, ELEMENTS + 1, &[(0, 0), (0, 1), (0, 2)], elements.collect::<ElementList>())
    }

    #[test]
    fn a_sum_and_its_remainder_are_exact() {
        let (sum, left) = sum_and_remainder(1.0, 2.0_f64.powi(-60));
        assert_eq!((sum, left), (1.0, 2.0_f64.powi(-60)));
        let (sum, left) = sum_and_remainder(-1e-3, 1.0 / 3.0);
        assert_eq!(((sum - 1.0 / 3.0) + 1e-3) + left, 0.0);
    }

    /// Ten thousand steps of a thousandth of the rounding of the displacement move a state that keeps remainders.
    #[test]
    fn short_steps_are_not_lost() {
        let structure = beam_of_short_elements();
        assert!(structure.keeps_remainders());
        let mut state = State::at_rest(&structure, 0);
        let mut rate = Rate { displacement: vec![0.0; structure.freedoms()], load: 0.0, reactions: Vec::new() };
        let tip = structure.translations_of(ELEMENTS).start;
        state.place(tip, 1.0, 0.0);
        rate.displacement[tip] = 1.0;
        let step = 2.0_f64.powi(-63);
        (0..10_000).for_each(|_| state.advance(&rate, step));
        assert_eq!((state.displacement[tip] - 1.0) + state.remainder[tip], 10_000.0 * step);
    }

    /// Remainders change the forces by `K r`, although they are lost in the sums `u + r`; without them the rounding of
    /// displacements would change the forces by `ε |K| |u|`.
    #[test]
    fn remainders_change_forces_by_the_stiffness() {
        let structure = beam_of_short_elements();
        let count = structure.freedoms();
        let displacement: Vec<f64> = (0..count).map(|k| if k % 3 == 1 { 0.4 + 1e-8 * k as f64 } else { 0.0 }).collect();
        let is_translation = |freedom: usize| freedom % 3 < 2;
        let remainder: Vec<f64> =
            (0..count).map(|k| if is_translation(k) { 1e-18 * (0.3 * k as f64).sin() } else { 0.0 }).collect();
        assert!(displacement.iter().zip(&remainder).all(|(u, r)| *u == 0.0 || u + r == *u));
        let (mut without, mut with) = (vec![0.0; count], vec![0.0; count]);
        structure.internal_force_beyond(&displacement, &vec![0.0; count], &mut without);
        structure.internal_force_beyond(&displacement, &remainder, &mut with);
        let mut expected = vec![0.0; count];
        structure.each_stiffness(&displacement, &mut |row, column, value| expected[row] += value * remainder[column]);
        let largest = expected.iter().fold(0.0_f64, |most, value| most.max(value.abs()));
        let rounding = structure.rounding(&displacement).into_iter().fold(0.0, f64::max);
        let off = (0..count).map(|k| (with[k] - without[k] - expected[k]).abs()).fold(0.0, f64::max);
        assert!(off < 1e-3 * largest && off < 1e-4 * rounding, "{off:e} of {largest:e}; rounding {rounding:e}");
    }
}
