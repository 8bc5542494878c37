//! The increment of Kanno and Martins as a mathematical program with complementarity constraints.
//!
//! ```text
//! max  -r_t⁽ᵏ⁾·Δu_t - ½ γ1 ‖(Δu, Δs)‖² + γ2 (u̇, ṡ)⁽ᵏ⁾·(Δu, Δs)
//! s.t. f_int(u) - s f - f_held - Σ (n r_n + t r_t) = 0,      t·Δx = a⁺ - a⁻
//!      0 <= g ⊥ r_n >= 0,   0 <= μ r_n + r_t ⊥ a⁺ >= 0,   0 <= μ r_n - r_t ⊥ a⁻ >= 0
//! ```
//!
//! (Y. Kanno, J. A. C. Martins, J. Optim. Theory Appl. 131 (2006), doi:10.1007/s10957-006-9137-4; the split of the slip
//! into two parts is the polyhedral form of the cone in 2D.) Variables are scaled: `y = (Δu, Δs)/S`, `ρ = r/F`,
//! `α = a/S`, with `S` the arc length sought and `F` the force scale, so that all are of order one whatever the step.
//!
//! `γ1` follows from `S`: along a unit direction `e` with dissipation `D` per arc the objective is
//! `(D + γ2 d·e) α - ½ γ1 α²`, largest at `α = 1` for `γ1 = D + γ2 d·e`. Where the program leaves the direction that
//! was expected, `γ1` is adapted until `‖y‖` is near 1. `γ2` is a fraction of the dissipation (or 1 where there is
//! none), so that the branch does not depend on the step.

mod functions;
#[cfg(test)]
mod tests;

use super::loading::Loading;
use super::state::{Rate, State};
use crate::cancel::CancelFlag;
use crate::contact::Mode;
use crate::contact::vector::{Vector, dot, scaled};
use crate::mpec::{self, Finish, PairActivity, Settings};
use nalgebra::DVector;

/// Contacts whose gap is beyond this many arc lengths cannot close in the increment and are left out.
const REACH: f64 = 3.0;
/// The forward term's share of the dissipation.
const FORWARD_SHARE: f64 = 0.1;
/// Solves with `γ1` adapted before the last one is taken as it is.
const MOST_ADAPTATIONS: usize = 6;

/// One increment's program.
pub struct IncrementProgram<'a> {
    loading: Loading<'a>,
    base: &'a State,
    /// The arc length sought.
    pub step: f64,
    /// The direction that the forward term rewards; unit arc length.
    forward: &'a Rate,
    force: f64,
    pub arc_weight: f64,
    pub forward_weight: f64,
    reach: Vec<InReach>,
    variables: usize,
}

/// A contact of the program and its first variable: `ρ_n`, then with friction `ρ_t`, `α⁺`, `α⁻`.
struct InReach {
    contact: usize,
    first: usize,
    friction: f64,
    /// `r_t⁽ᵏ⁾/F`
    traction: f64,
    /// The tangent at the start of the increment, along which slip is counted.
    tangent: Vector,
}

/// What the program says of an increment.
#[derive(Debug, Clone)]
pub struct Named {
    /// The contact modes at the end of the increment.
    pub modes: Vec<Mode>,
}

/// Work of the programs solved.
#[derive(Debug, Clone, Copy, Default)]
pub struct Counts {
    pub qp_solves: u64,
    pub mpec_solves: u64,
}

impl<'a> IncrementProgram<'a> {
    /// `forward` is the direction in which the increment is to go; `γ1` is set for it.
    pub fn new(loading: Loading<'a>, base: &'a State, forward: &'a Rate, step: f64, force: f64) -> Self {
        let structure = loading.structure;
        let mut next = structure.unknowns() + 1;
        let mut reach = Vec::new();
        for (contact, data) in loading.contacts.iter().enumerate() {
            if loading.gap(contact, base) > REACH * step {
                continue;
            }
            let tangent = loading.frame(contact, base).tangents[0];
            let traction = dot(&base.reactions[contact].tangential, &tangent) / force;
            let friction = if data.tangents() > 0 { data.friction } else { 0.0 };
            reach.push(InReach { contact, first: next, friction, traction, tangent });
            next += if data.tangents() > 0 { 4 } else { 1 };
        }
        let mut program =
            Self { loading, base, step, forward, force, arc_weight: 1.0, forward_weight: 1.0, reach, variables: next };
        let dissipation = program.dissipation_along(forward);
        if dissipation > 0.0 {
            program.forward_weight = FORWARD_SHARE * dissipation;
        }
        program.arc_weight = dissipation + program.forward_weight;
        program
    }

    /// `-r_t⁽ᵏ⁾·u̇_t / F`
    fn dissipation_along(&self, rate: &Rate) -> f64 {
        self.reach.iter().map(|entry| -entry.traction * self.tangential(entry, rate)).sum()
    }

    fn tangential(&self, entry: &InReach, rate: &Rate) -> f64 {
        dot(&self.loading.relative_rate(entry.contact, rate), &entry.tangent)
    }

    /// The variables of a state on the way, for a start.
    pub fn variables_at(&self, rate: &Rate) -> DVector<f64> {
        let structure = self.loading.structure;
        let mut x = DVector::zeros(self.variables);
        for (unknown, freedom) in structure.freedom_of.iter().enumerate() {
            x[unknown] = rate.displacement[*freedom];
        }
        x[structure.unknowns()] = rate.load;
        for entry in &self.reach {
            let (reaction, change) = (self.base.reactions[entry.contact], rate.reactions[entry.contact]);
            x[entry.first] = (reaction.normal + self.step * change.normal) / self.force;
            if entry.friction > 0.0 {
                x[entry.first + 1] = (dot(&reaction.tangential, &entry.tangent)
                    + self.step * dot(&change.tangential, &entry.tangent))
                    / self.force;
                let slip = self.tangential(entry, rate);
                x[entry.first + 2] = slip.max(0.0);
                x[entry.first + 3] = (-slip).max(0.0);
            }
        }
        x
    }

    fn state(&self, x: &DVector<f64>) -> State {
        let structure = self.loading.structure;
        let mut state = self.base.clone();
        for (unknown, freedom) in structure.freedom_of.iter().enumerate() {
            state.displacement[*freedom] += self.step * x[unknown];
        }
        state.load += self.step * x[structure.unknowns()];
        self.loading.place_supports(&mut state);
        state
    }

    /// Solves from a start and reads the contact modes off the solution; `None` where no solution was found.
    ///
    /// `present` decides where a pair is biactive.
    pub fn name(&mut self, start: &DVector<f64>, present: &[Mode], cancel: &CancelFlag) -> (Option<Named>, Counts) {
        // The start is a predictor in a mode that is likely right: where no solution lies near it, a shorter increment
        // helps more than a longer search.
        let settings = Settings {
            finish: Finish::PatternSettled,
            restarts: 0,
            iteration_limit: 20,
            enumeration_limit: 3,
            ..Settings::warm()
        };
        let mut counts = Counts::default();
        let mut start = start.clone();
        for _ in 0..MOST_ADAPTATIONS {
            let Ok(solution) = mpec::solve(self, &start, &settings, cancel) else { return (None, counts) };
            counts.qp_solves += solution.counts.qp_solves as u64;
            counts.mpec_solves += 1;
            let usable =
                matches!(solution.status, mpec::Status::Solved | mpec::Status::PatternSettled | mpec::Status::Feasible);
            if !usable {
                return (None, counts);
            }
            let size = solution.x.rows(0, self.loading.structure.unknowns() + 1).norm();
            if (0.5..=2.0).contains(&size) {
                return (Some(self.read(&solution.activity, present)), counts);
            }
            self.arc_weight *= size.clamp(0.02, 50.0);
            start = solution.x;
        }
        (None, counts)
    }

    fn read(&self, activity: &[PairActivity], present: &[Mode]) -> Named {
        let mut modes = vec![Mode::Free; self.loading.contacts.len()];
        let mut pairs = activity.iter().copied();
        let mut next = || pairs.next().unwrap_or(PairActivity::NeitherZero);
        for entry in &self.reach {
            let present = present[entry.contact];
            let normal = next();
            let closed = if entry.friction > 0.0 {
                match (next(), next()) {
                    (PairActivity::FirstZero, _) => Mode::Slip { direction: entry.tangent },
                    (_, PairActivity::FirstZero) => Mode::Slip { direction: scaled(&entry.tangent, -1.0) },
                    (PairActivity::BothZero, _) | (_, PairActivity::BothZero) if present.is_active() => present,
                    _ => Mode::Stick,
                }
            } else {
                Mode::Slip { direction: [0.0; 3] }
            };
            modes[entry.contact] = match normal {
                PairActivity::FirstZero => closed,
                PairActivity::BothZero => present,
                PairActivity::SecondZero | PairActivity::NeitherZero => Mode::Free,
            };
        }
        Named { modes }
    }

    /// Unknowns of the contact's node with their components.
    fn node_of(&self, entry: &InReach) -> impl Iterator<Item = (usize, usize)> {
        let structure = self.loading.structure;
        let first = self.loading.contacts[entry.contact].node * structure.dimension;
        (0..structure.dimension).filter_map(move |k| structure.unknown_of[first + k].map(|unknown| (unknown, k)))
    }

    /// How fast a contact's node moves against its obstacle with the load factor alone: by what drives the supports and
    /// the obstacle.
    fn driven(&self, entry: &InReach) -> Vector {
        let structure = self.loading.structure;
        let first = self.loading.contacts[entry.contact].node * structure.dimension;
        let mut motion = scaled(&self.loading.pattern.shifts[entry.contact], -1.0);
        for k in 0..structure.dimension {
            if structure.unknown_of[first + k].is_none() {
                motion[k] += self.loading.support_rate(first + k);
            }
        }
        motion
    }
}
