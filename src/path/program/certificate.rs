//! A point that the path has reached already, shown to solve the increment's program.
//!
//! Where at a feasible point one member of every pair is clearly positive, the feasible points nearby are those of one
//! contact mode, and where the equations of that mode are regular these are a curve. Along it, with
//! `τ = ‖(Δu, Δs)‖/S` for parameter and `y = (Δu, Δs)/S`, the objective is
//!
//! ```text
//! φ(τ) = ℓ·y(τ) - ½ γ1 τ²,        ℓ·v = -r_t⁽ᵏ⁾·v_t/F + γ2 d·v
//! ```
//!
//! and the point at `τ = 1` is a strict local solution where `φ'(1) = 0` and `φ''(1) < 0`. `γ1` is what is adapted until
//! the increment has the arc length sought: `φ'(1) = 0` gives it at once, `γ1 = ℓ·y'(1)`, and it has to be positive. `y'(1)`
//! is the path's direction there over its cosine with `y`; `y''(1)` is that of the cubic through both ends with their
//! directions. With the gradients of the mode's equations independent, `φ'(1) = 0` is the same as the existence of
//! multipliers, and with no pair biactive the point is strongly stationary, hence B-stationary: H. Scheel and S. Scholtes,
//! Math. Oper. Res. 25 (2000), doi:10.1287/moor.25.1.1.15213.
//!
//! The two parts of the slip of a contact that is apart are no matter: there is no force, and only their difference counts.
//!
//! Nothing is claimed where any of this fails or is not clear, where a cone is circular (there the path's rule is of higher
//! order than the program's) or where two contacts press one node (their reactions need not be unique): then the program
//! is solved.

use super::{InReach, IncrementProgram, LOOSEST, Named, frame};
use crate::contact::Mode;
use crate::contact::vector::{Vector, add};
use crate::mpec::{Activities, PairActivity, Problem, Settings};
use crate::path::state::{Rate, State};
use nalgebra::DVector;

/// Least member of a pair that is clearly positive, and how much larger it is than what the point leaves violated.
const CLEAR: f64 = 1e-9;
const LEEWAY: f64 = 10.0;
/// Least cosine between the chord of the increment and the direction at its end.
const FORWARD: f64 = 0.5;

/// A point of the path with its direction.
#[derive(Clone, Copy)]
pub struct Arrived<'s> {
    pub state: &'s State,
    /// Of unit arc length, in the mode that led there.
    pub rate: &'s Rate,
    /// Distance to the mode's curve (dimensionless).
    pub error: f64,
}

impl IncrementProgram<'_> {
    /// The modes at the end of an increment of the arc length sought along `forward`, where that end is shown to solve the
    /// program with `γ1` adapted to it.
    ///
    /// `forward` is the direction at the start in the mode that leads to the end, and the equations of that mode are
    /// regular at the end.
    pub fn solved_at(&mut self, end: Arrived<'_>, present: &[Mode]) -> Option<Named> {
        if self.reach.iter().any(|entry| entry.tangents == 2) || self.is_any_node_pressed_twice(end.state) {
            return None;
        }
        let x = self.variables_of(end.state);
        let activities = self.clear_activities(&x, end)?;
        self.is_strict_solution(&x, end).then(|| Named::of(&self.read(&x, &activities, present)))
    }

    /// The variables of the program at a state.
    fn variables_of(&self, state: &State) -> DVector<f64> {
        let structure = self.loading.structure;
        let mut x = DVector::zeros(self.variables);
        for (unknown, freedom) in structure.freedom_of.iter().enumerate() {
            x[unknown] = (state.displacement[*freedom] - self.base.displacement[*freedom]) / self.step;
        }
        x[structure.unknowns()] = (state.load - self.base.load) / self.step;
        for entry in &self.reach {
            let reaction = &state.reactions[entry.contact];
            x[entry.normal()] = reaction.normal / self.force;
            if entry.tangents == 1 {
                let here = self.loading.frame(entry.contact, state);
                x[entry.tangential(0)] = frame::components(&here, &reaction.tangential)[0] / self.force;
                let slip = frame::components(&entry.frame, &self.chord(entry, state))[0] / self.step;
                for (part, side) in entry.parts() {
                    x[part] = (side * slip).max(0.0);
                }
            }
        }
        x
    }

    /// The way of a contact's node against its obstacle.
    fn chord(&self, entry: &InReach, state: &State) -> Vector {
        let before = self.loading.relative(entry.contact, self.base);
        add(&self.loading.relative(entry.contact, state), -1.0, &before)
    }

    /// Which member of each pair is zero, where the variables are feasible and that is clear.
    fn clear_activities(&self, x: &DVector<f64>, end: Arrived<'_>) -> Option<Activities> {
        let mut equality = DVector::zeros(self.equalities());
        let (mut first, mut second) = (DVector::zeros(self.pairs()), DVector::zeros(self.pairs()));
        self.equality_values(x, &mut equality);
        self.pair_values(x, &mut first, &mut second);
        let smaller = first.iter().zip(second.iter()).map(|(a, b)| a.min(*b));
        let left = equality.iter().copied().chain(smaller).fold(0.0, |most: f64, value| {
            // Not `max`, which passes over what is not a number.
            if value.abs() <= most { most } else { value.abs() }
        });
        let rounding = self.rounding(x);
        let is_feasible = left <= Settings::warm().tolerance.max(rounding).min(LOOSEST);
        let error = end.error / self.step;
        let clear = CLEAR.max(LEEWAY * left.max(rounding).max(error));
        if !is_feasible || !clear.is_finite() {
            return None;
        }
        let activity = |pair: usize| match (first[pair] > clear, second[pair] > clear) {
            (true, false) => PairActivity::SecondZero,
            (false, true) => PairActivity::FirstZero,
            (false, false) => PairActivity::BothZero,
            (true, true) => PairActivity::NeitherZero,
        };
        let pairs: Vec<PairActivity> = (0..first.len()).map(activity).collect();
        let is_clear = |pair: &PairActivity| matches!(pair, PairActivity::FirstZero | PairActivity::SecondZero);
        let mut next = 0;
        for entry in &self.reach {
            let (normal, friction) = (next, next + 1..next + 1 + 2 * entry.tangents);
            next = friction.end;
            let is_apart = pairs[normal] == PairActivity::SecondZero;
            if !is_clear(&pairs[normal]) || !is_apart && !pairs[friction].iter().all(is_clear) {
                return None;
            }
        }
        Some(Activities { pairs, cones: Vec::new() })
    }

    /// Whether the objective has a strict maximum along the curve at its end, with `γ1` adapted to it.
    fn is_strict_solution(&mut self, x: &DVector<f64>, end: Arrived<'_>) -> bool {
        let load = self.loading.structure.unknowns();
        let (mut along_forward, mut along_end) = (x[load] * self.forward.load, x[load] * end.rate.load);
        for (unknown, freedom) in self.loading.structure.freedom_of.iter().enumerate() {
            along_forward += x[unknown] * self.forward.displacement[*freedom];
            along_end += x[unknown] * end.rate.displacement[*freedom];
        }
        if along_end < FORWARD {
            return false;
        }
        let linear = |rate: &Rate| self.dissipation_along(rate) + self.forward_weight * self.forward.product(rate);
        let at_start = linear(self.forward);
        let at_end = linear(end.rate) / along_end;
        let dissipated: f64 = self.reach.iter().map(|entry| self.dissipated(entry, x)).sum();
        let of_chord = dissipated + self.forward_weight * along_forward;
        // γ1 > 0, φ'' < 0, and more is gained than by staying.
        let (arc_weight, curvature) = (at_end, 2.0 * at_start + 3.0 * at_end - 6.0 * of_chord);
        let is_strict = arc_weight > 0.0 && curvature < 0.0 && of_chord > 0.5 * arc_weight;
        if is_strict {
            self.arc_weight = arc_weight;
        }
        is_strict
    }

    fn dissipated(&self, entry: &InReach, x: &DVector<f64>) -> f64 {
        if entry.tangents == 0 { 0.0 } else { -self.dissipation_of(entry, x) }
    }

    /// Whether some node is closed against two obstacles.
    fn is_any_node_pressed_twice(&self, state: &State) -> bool {
        self.loading.corners.iter().any(|corner| corner.closed(self.loading, state).len() >= 2)
    }
}
