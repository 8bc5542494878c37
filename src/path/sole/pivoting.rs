//! The direction with one sign of the load rate, by block pivoting (M. M. Kostreva, Optimization 9 (1978) 13).

use super::equations::{Changing, Equations};
use crate::contact::Mode;
use crate::contact::vector::{Vector, dot, scaled};
use crate::linear_algebra::Sink;
use crate::path::corner::whole_rates;
use crate::path::directions::{Alternative, Candidate, WEAK};
use crate::path::mode_system::{Kind, ModeSystem};
use crate::path::state::Rate;

/// Rounds of block pivoting.
const MOST_ROUNDS: usize = 32;

impl Equations<'_> {
    /// A direction with this sign of the load rate, by block pivoting.
    pub fn solve(&self, sign: f64, incoming: Option<&Rate>) -> Option<Candidate> {
        let mut modes = self.held.clone();
        if incoming.is_some_and(|rate| rate.load * sign > 0.0) {
            for one in &self.changing {
                modes[one.contact] = one.direction.map_or(modes[one.contact], |direction| Mode::Slip { direction });
            }
        }
        for _ in 0..MOST_ROUNDS {
            let system = ModeSystem::new(self.loading, &modes, self.state);
            let iterate = system.iterate(self.state.clone());
            let by_load = |matrix: &mut dyn Sink| matrix.add(system.size() - 1, self.loading.structure.unknowns(), 1.0);
            let mut rate = system.tangent_by(&system.factorise(&iterate, Kind::Rates, by_load)?, &iterate)?;
            rate.scale(sign * rate.load.signum());
            let force = WEAK * rate.largest_reaction().max(f64::MIN_POSITIVE);
            let (mut next, mut weak) = (modes.clone(), Vec::new());
            let mut changed = false;
            for one in &self.changing {
                let mode = modes[one.contact];
                let (margin, tolerance, other) = self.margin(one, mode, &rate, force);
                if margin < -tolerance {
                    next[one.contact] = other;
                    changed = true;
                } else if margin <= tolerance {
                    weak.push(one.contact);
                }
            }
            if !changed {
                return Some(self.candidate(rate, modes, weak));
            }
            modes = next;
        }
        None
    }

    fn speed(&self, one: &Changing, direction: &Vector, rate: &Rate) -> f64 {
        dot(direction, &self.loading.relative_rate(one.contact, rate))
    }

    /// Whether what must not be negative in a mode is positive beyond round-off.
    pub fn is_strict(&self, one: &Changing, mode: Mode, rate: &Rate) -> bool {
        let force = WEAK * rate.largest_reaction().max(f64::MIN_POSITIVE);
        let (margin, tolerance, _) = self.margin(one, mode, rate, force);
        margin > tolerance
    }

    /// The least of what must not be negative in a mode, what of it is round-off (`force` of a force), and the mode to try
    /// where it is negative.
    fn margin(&self, one: &Changing, mode: Mode, rate: &Rate, force: f64) -> (f64, f64, Mode) {
        let (reaction, data) = (&rate.reactions[one.contact], &self.loading.contacts[one.contact]);
        let tolerance = if matches!(mode, Mode::Stick) || data.tangents() == 0 { force } else { WEAK };
        let (margin, other) = match (mode, one.direction) {
            (Mode::Stick, Some(direction)) => {
                let left = data.friction * reaction.normal + dot(&direction, &reaction.tangential);
                (left, Mode::Slip { direction })
            }
            (Mode::Slip { .. }, Some(direction)) => (self.speed(one, &direction, rate), Mode::Stick),
            (Mode::Stick, None) => {
                let traction = dot(&reaction.tangential, &one.frame.tangents[0]);
                let against = scaled(&one.frame.tangents[0], if traction > 0.0 { -1.0 } else { 1.0 });
                let other = if reaction.normal < 0.0 { Mode::Free } else { Mode::Slip { direction: against } };
                (data.friction * reaction.normal - traction.abs(), other)
            }
            (Mode::Slip { .. }, None) if data.tangents() == 0 => (reaction.normal, Mode::Free),
            (Mode::Slip { direction }, None) => {
                let speed = self.speed(one, &direction, rate);
                let other = if reaction.normal < 0.0 { Mode::Free } else { Mode::Stick };
                (speed.min(reaction.normal), other)
            }
            (Mode::Free, _) => {
                let closed = if data.tangents() > 0 { Mode::Stick } else { Mode::Slip { direction: [0.0; 3] } };
                (self.speed(one, &one.frame.normal, rate), closed)
            }
        };
        (margin, tolerance, other)
    }

    /// `weak`: the contacts that might as well be in the other mode, at first order; where they can stick they do.
    pub fn candidate(&self, rate: Rate, mut modes: Vec<Mode>, weak: Vec<usize>) -> Candidate {
        let mut in_doubt = weak.iter().peekable();
        let mut alternatives: Vec<Vec<Alternative>> = Vec::with_capacity(self.changing.len());
        for one in &self.changing {
            let mode = modes[one.contact];
            let is_weak = in_doubt.next_if_eq(&&one.contact).is_some();
            alternatives.push(match (is_weak, one.direction) {
                (true, Some(direction)) => {
                    modes[one.contact] = Mode::Stick;
                    vec![vec![(one.contact, Mode::Stick)], vec![(one.contact, Mode::Slip { direction })]]
                }
                _ => vec![vec![(one.contact, mode)]],
            });
        }
        let dissipation = self.changing.iter().map(|one| {
            let slips = matches!(modes[one.contact], Mode::Slip { .. });
            let traction = &self.state.reactions[one.contact].tangential;
            if slips { -dot(traction, &self.loading.relative_rate(one.contact, &rate)) } else { 0.0 }
        });
        let dissipation = dissipation.sum();
        let forces = whole_rates(self.loading, self.state, &rate);
        Candidate { rate, forces, modes, alternatives, weak: !weak.is_empty(), dissipation }
    }
}
