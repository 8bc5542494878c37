//! The increment of Kanno and Martins as a mathematical program with complementarity constraints.
//!
//! ```text
//! max  -r_t⁽ᵏ⁾·Δu_t - ½ γ1 ‖(Δu, Δs)‖² + γ2 (u̇, ṡ)⁽ᵏ⁾·(Δu, Δs)
//! s.t. f_int(u) - s f - f_held - Σ (n r_n + t r_t) = 0,      t·Δx = a⁺ - a⁻
//!      0 <= g ⊥ r_n >= 0,   0 <= μ r_n + r_t ⊥ a⁺ >= 0,   0 <= μ r_n - r_t ⊥ a⁻ >= 0
//! ```
//!
//! (Y. Kanno, J. A. C. Martins, J. Optim. Theory Appl. 131 (2006), doi:10.1007/s10957-006-9137-4; the split of the slip
//! into two parts is the polyhedral form of the cone in 2D.) In 3D the last line's friction and the slip are
//!
//! ```text
//! t_k·Δx = a_k, k = 1, 2,       K ∋ (μ r_n, r_t)  ⊥  (λ, a) ∈ K,       K the second-order cone
//! ```
//!
//! Variables are scaled: `y = (Δu, Δs)/S`, `ρ = r/F`, `α = a/S`, with `S` the prescribed arc length and `F` the force
//! scale, so that all are of order one whatever the step.
//!
//! `γ1` follows from `S`: along a unit direction `e` with dissipation `D` per arc length the objective is
//! `(D + γ2 d·e) α - ½ γ1 α²`, largest at `α = 1` for `γ1 = D + γ2 d·e`. Where the solution leaves the expected
//! direction, `γ1` is adapted until `‖y‖` is near 1. `γ2` is a fraction of the dissipation (or 1 where there is none),
//! so that the branch does not depend on the step.
//!
//! A point that the path has reached in a mode is first checked against sufficient conditions for a solution of the
//! program (`certificate`); the program is solved where these do not decide.

pub(crate) mod certificate;
pub(crate) mod functions;
pub(crate) mod relaxation_sequence;
pub(crate) mod solution_extraction;
pub(crate) mod tangent_components;
#[cfg(test)]
mod tests;
#[cfg(test)]
mod tests_in_space;
#[cfg(test)]
mod tests_of_certificate;
#[cfg(test)]
mod tests_of_chains;
pub(crate) mod tolerances;

use crate::complementarity::mpec::{self, Finish, PairActivity, ProgramSolution, Settings, StationarityKind};
use crate::mechanics::contact::coulomb::CoulombFriction;
use crate::mechanics::contact::vector::{Vector, dot, scaled};
use crate::mechanics::contact::{Frame, Mode};
use crate::mechanics::equations::slip_integration::Start;
use crate::mechanics::problem::loading::Loading;
use crate::mechanics::problem::state::{Rate, State};
use crate::resources::cancel::CancelFlag;
use crate::step::increment_mpec::tolerances::{
    FORWARD_WEIGHT_SHARE, LOOSEST_TOLERANCE, REACH_IN_LENGTHS, ROUND_OFF_MULTIPLE, SMALLEST_DISSIPATION,
};
pub use certificate::Arrived;
use nalgebra::DVector;
pub use relaxation_sequence::{ProgramEnd, Searched};
use smallvec::SmallVec;
use tangent_components::Components;

/// Largest number of solves with `γ1` adapted.
const MOST_ADAPTATIONS: usize = 6;

/// The program of one increment.
pub struct IncrementProgram<'a> {
    loading: Loading<'a>,
    base: &'a State,
    /// The prescribed arc length.
    pub step: f64,
    /// The direction that the forward term rewards; unit arc length.
    forward: &'a Rate,
    force: f64,
    pub arc_weight: f64,
    pub forward_weight: f64,
    reach: Vec<InReach>,
    variables: usize,
    /// Bound on each displacement and on the load, over the prescribed arc length; infinite where there is none.
    most_motion: f64,
}

/// A contact of the program and its first variable: `ρ_n`, then with friction in 2D `ρ_t`, `α⁺`, `α⁻`, in 3D `ρ_t`
/// (two), `λ/S`, `α` (two).
struct InReach {
    contact: usize,
    first: usize,
    friction: CoulombFriction,
    /// Number of tangents with friction: 0, 1 (a polyhedral cone) or 2 (a circular one).
    tangents: usize,
    /// Frame at the start of the increment, along which slip is measured.
    frame: Frame,
    /// `r_t⁽ᵏ⁾/F` along the tangents; with circular cones divided by the scale of the objective.
    traction: Components,
}

impl InReach {
    fn normal(&self) -> usize {
        self.first
    }

    fn tangential(&self, tangent: usize) -> usize {
        self.first + 1 + tangent
    }

    /// In 2D: the parts of the slip and their signs.
    fn parts(&self) -> [(usize, f64); 2] {
        [(self.first + 2, 1.0), (self.first + 3, -1.0)]
    }

    /// In 3D: the bound on the slip.
    fn bound(&self) -> usize {
        self.first + 3
    }

    /// In 3D: the slip.
    fn slip(&self, tangent: usize) -> usize {
        self.first + 4 + tangent
    }

    /// In 3D: `(μ ρ_n, ρ_t)/(1 + μ)` and `(λ, a)/S`.
    fn cone_members(&self, x: &DVector<f64>) -> ([f64; 3], [f64; 3]) {
        let of_force = [self.friction.bound(x[self.normal()]), x[self.tangential(0)], x[self.tangential(1)]];
        (
            of_force.map(|value| value / (1.0 + self.friction.coefficient)),
            [x[self.bound()], x[self.slip(0)], x[self.slip(1)]],
        )
    }
}

/// The result of the program for an increment.
#[derive(Debug, Clone)]
pub struct Named {
    /// The contact modes at the end of the increment.
    pub modes: Vec<Mode>,
    /// In 3D, where some contact has friction: the state at the end, with exactly the prescribed arc length and
    /// residuals at round-off. `None` where the semismooth method did not converge.
    #[cfg(test)]
    pub end: Option<State>,
}

impl Named {
    /// The result of modes that are known already.
    pub fn of(modes: &[Mode]) -> Self {
        Self {
            modes: modes.to_vec(),
            #[cfg(test)]
            end: None,
        }
    }
}

/// The result of following the modes of a start.
#[derive(Debug, Clone)]
pub enum ForeseenModes {
    /// A solution, with no contact about to change.
    Named(Named),
    /// Some contact changes after this fraction of the arc length.
    EndsAfter(f64),
    /// The modes hold, but a contact is so near to a change throughout that another mode may be better.
    Untold,
    /// No solution was found.
    Unclear,
}

/// Work of the programs solved.
#[derive(Debug, Clone, Copy, Default)]
pub struct ProgramCounts {
    pub qp_solves: u64,
    pub mpec_solves: u64,
    pub sqp_iterations: u64,
    /// The last bound on products that was used; `None` where the start's own branch was enough.
    pub last_relaxation: Option<f64>,
}

impl ProgramCounts {
    fn add(&mut self, solution: &ProgramSolution) {
        self.qp_solves += solution.counts.qp_solves as u64;
        self.mpec_solves += 1;
        self.sqp_iterations += solution.counts.sqp_iterations as u64;
        self.last_relaxation = solution.last_relaxation.or(self.last_relaxation);
    }
}

impl<'a> IncrementProgram<'a> {
    /// The program of an increment; `forward` is its expected direction, for which `γ1` is set.
    pub fn new(loading: Loading<'a>, base: &'a State, forward: &'a Rate, step: f64, force: f64) -> Self {
        let structure = loading.structure;
        let mut next = structure.unknowns() + 1;
        let mut reach = Vec::new();
        for (contact, data) in loading.contacts.iter().enumerate() {
            let frame = loading.frame(contact, base);
            if frame.gap.max(loading.gap(contact, base)) > REACH_IN_LENGTHS * step {
                continue;
            }
            let tangents = data.tangents();
            let friction = if tangents > 0 { data.friction } else { CoulombFriction::SMOOTH };
            let traction = tangent_components::components(&frame, &base.reactions[contact].tangential);
            let traction = traction.map(|component| component / force);
            reach.push(InReach { contact, first: next, friction, tangents, frame, traction });
            next += match tangents {
                0 => 1,
                1 => 4,
                _ => 6,
            };
        }
        let (arc_weight, forward_weight, most_motion) = (1.0, 1.0, f64::INFINITY);
        let variables = next;
        let mut program =
            Self { loading, base, step, forward, force, arc_weight, forward_weight, reach, variables, most_motion };
        let dissipation = program.dissipation_along(forward);
        if dissipation > SMALLEST_DISSIPATION {
            program.forward_weight = FORWARD_WEIGHT_SHARE * dissipation;
        }
        program.arc_weight = dissipation + program.forward_weight;
        if program.reach.iter().any(|entry| entry.tangents == 2) && program.arc_weight > 0.0 {
            program.divide_objective(program.arc_weight);
        }
        program
    }

    /// Scales the objective to the order of one, whatever the friction, so that tolerances keep their meaning.
    fn divide_objective(&mut self, scale: f64) {
        self.arc_weight /= scale;
        self.forward_weight /= scale;
        for entry in &mut self.reach {
            entry.traction.iter_mut().for_each(|component| *component /= scale);
        }
    }

    /// The dissipation `-r_t⁽ᵏ⁾·u̇_t / F` along a rate.
    fn dissipation_along(&self, rate: &Rate) -> f64 {
        let of = |entry: &InReach| {
            let motion = self.motion(entry, rate);
            (0..entry.tangents).map(|k| -entry.traction[k] * motion[k]).sum::<f64>()
        };
        self.reach.iter().map(of).sum()
    }

    /// The dissipation term `r_t⁽ᵏ⁾·Δu_t / (F S)` of a contact in the objective.
    fn dissipation_of(&self, entry: &InReach, x: &DVector<f64>) -> f64 {
        if entry.tangents == 2 {
            return (0..2).map(|k| entry.traction[k] * x[entry.slip(k)]).sum();
        }
        let [(forward, _), (backward, _)] = entry.parts();
        entry.traction[0] * (x[forward] - x[backward])
    }

    fn motion(&self, entry: &InReach, rate: &Rate) -> Components {
        tangent_components::components(&entry.frame, &self.loading.relative_rate(entry.contact, self.base, rate))
    }

    /// The variables of the state one step along a rate, as a start.
    pub fn variables_at(&self, rate: &Rate) -> DVector<f64> {
        let structure = self.loading.structure;
        let mut x = DVector::zeros(self.variables);
        for (unknown, freedom) in structure.freedom_of.iter().enumerate() {
            x[unknown] = rate.displacement[*freedom];
        }
        x[structure.unknowns()] = rate.load;
        for entry in &self.reach {
            let (reaction, change) = (self.base.reactions[entry.contact], rate.reactions[entry.contact]);
            x[entry.normal()] = (reaction.normal + self.step * change.normal) / self.force;
            if !entry.friction.is_rough() {
                continue;
            }
            let components = |vector: &Vector| tangent_components::components(&entry.frame, vector);
            let (traction, change) = (components(&reaction.tangential), components(&change.tangential));
            for k in 0..entry.tangents {
                x[entry.tangential(k)] = (traction[k] + self.step * change[k]) / self.force;
            }
            let slip = self.motion(entry, rate);
            if entry.tangents == 2 {
                x[entry.slip(0)] = slip[0];
                x[entry.slip(1)] = slip[1];
                x[entry.bound()] = self.bound_at(entry, &x, slip);
            } else {
                for (part, side) in entry.parts() {
                    x[part] = (side * slip[0]).max(0.0);
                }
            }
        }
        x
    }

    /// A bound on the slip that selects the start's branch: larger than the slip for a contact that stays open, smaller
    /// for a contact that is about to close, so that the contact is taken to slip.
    fn bound_at(&self, entry: &InReach, x: &DVector<f64>, slip: Components) -> f64 {
        let size = slip[0].hypot(slip[1]);
        if x[entry.normal()] > 0.0 {
            return size;
        }
        let gap = self.loading.gap(entry.contact, &self.state(x));
        if gap > 0.0 { 1.0 + size } else { 0.5 * size }
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

    /// Solves from a start and extracts the contact modes of the solution; `None` where no solution was found.
    ///
    /// `present` decides where a pair is biactive.
    pub fn name(
        &mut self,
        start: &DVector<f64>,
        present: &[Mode],
        cancel: &CancelFlag,
    ) -> (Option<Named>, ProgramCounts) {
        match self.solve(start, present, None, cancel) {
            (ForeseenModes::Named(named), counts) => (Some(named), counts),
            (ForeseenModes::EndsAfter(_) | ForeseenModes::Untold | ForeseenModes::Unclear, counts) => (None, counts),
        }
    }

    /// Solves in the branch of the modes `present` alone, to decide whether they hold for an increment of this length.
    pub fn foresee(
        &mut self,
        start: &DVector<f64>,
        present: &[Mode],
        cancel: &CancelFlag,
    ) -> (ForeseenModes, ProgramCounts) {
        let members = self.zero_members(present, start);
        self.solve(start, present, Some(&members), cancel)
    }

    fn solve(
        &mut self,
        start: &DVector<f64>,
        present: &[Mode],
        branch: Option<&[PairActivity]>,
        cancel: &CancelFlag,
    ) -> (ForeseenModes, ProgramCounts) {
        // The start is a predictor in a mode that is likely correct: where no solution lies near the start, a shorter
        // increment helps more than a longer search.
        let warm = Settings::warm();
        let settings = Settings {
            finish: Finish::PatternSettled,
            restarts: 0,
            iteration_limit: 20,
            enumeration_limit: 3,
            // The arc length bounds every increment.
            looks_beyond: false,
            tolerance: warm.tolerance.max(self.rounding(start)).min(LOOSEST_TOLERANCE),
            ..warm
        };
        let mut counts = ProgramCounts::default();
        let mut start = start.clone();
        for _ in 0..MOST_ADAPTATIONS {
            let solution = match branch {
                None => mpec::solve(self, &start, &settings, cancel),
                Some(members) => mpec::follow_branch(self, &start, members, &settings, cancel),
            };
            let Ok(solution) = solution else { break };
            counts.add(&solution);
            let size = solution.x.rows(0, self.loading.structure.unknowns() + 1).norm();
            match solution.status {
                mpec::SolveStatus::Feasible if branch.is_some() => return (ForeseenModes::EndsAfter(size), counts),
                mpec::SolveStatus::Solved
                    if solution.stationarity == StationarityKind::OneBranch && branch.is_some() =>
                {
                    return (ForeseenModes::Untold, counts);
                }
                mpec::SolveStatus::Solved | mpec::SolveStatus::PatternSettled | mpec::SolveStatus::Feasible => {}
                _ => break,
            }
            if (0.5..=2.0).contains(&size) {
                return (
                    ForeseenModes::Named(solution_extraction::named_modes(self, solution, present, cancel)),
                    counts,
                );
            }
            self.arc_weight *= size.clamp(0.02, 50.0);
            start = solution.x;
        }
        (ForeseenModes::Unclear, counts)
    }

    /// The members of the pairs that are zero in given modes.
    fn zero_members(&self, modes: &[Mode], x: &DVector<f64>) -> Vec<PairActivity> {
        let zero = |first: bool| if first { PairActivity::FirstZero } else { PairActivity::SecondZero };
        let mut members = Vec::new();
        for entry in &self.reach {
            let mode = modes[entry.contact];
            members.push(zero(mode.is_active()));
            if entry.tangents != 1 {
                continue;
            }
            let [(forward, _), (backward, _)] = entry.parts();
            // An open contact has no friction force in either sense; one part of the slip is left free to take its
            // value.
            let sliding = match mode {
                Mode::Stick => [false, false],
                Mode::Slip { direction } => {
                    let is_forward = dot(&entry.frame.tangents[0], &direction) > 0.0;
                    [is_forward, !is_forward]
                }
                Mode::Free => [x[forward] >= x[backward], x[forward] < x[backward]],
            };
            members.extend(sliding.map(zero));
        }
        members
    }

    /// The residual of equilibrium due to the rounding of displacements: next to stiff elements no program can do
    /// better.
    fn rounding(&self, x: &DVector<f64>) -> f64 {
        let rounding = self.loading.structure.rounding(&self.state(x).displacement);
        ROUND_OFF_MULTIPLE * rounding.into_iter().fold(0.0, f64::max) / self.force
    }

    /// The motion of a contact since the start over the step, along the tangents there; for a single node from the
    /// unknowns themselves, which keeps their digits.
    fn motion_at(&self, entry: &InReach, state: &State, x: &DVector<f64>) -> Components {
        let structure = self.loading.structure;
        if self.loading.contacts[entry.contact].kinematics.node().is_none() {
            let chord = self.loading.relative_motion(entry.contact, self.base, state);
            return tangent_components::components(&entry.frame, &chord).map(|part| part / self.step);
        }
        let driven = tangent_components::components(&entry.frame, &self.loading.driven(entry.contact, state));
        let mut motion = driven.map(|part| part * x[structure.unknowns()]);
        for (unknown, column) in self.columns_of(entry, state) {
            for (motion, tangent) in motion.iter_mut().zip(&entry.frame.tangents).take(entry.tangents) {
                *motion += dot(tangent, &column) * x[unknown];
            }
        }
        motion
    }

    /// The unknowns that move a contact at a state, with the motion of the contact per unknown.
    fn columns_of(&self, entry: &InReach, state: &State) -> SmallVec<[(usize, Vector); 3]> {
        let mut columns = SmallVec::new();
        self.loading.each_column(entry.contact, state, |freedom, column| {
            columns.extend(self.loading.structure.unknown_of[freedom].map(|unknown| (unknown, *column)));
        });
        columns
    }
}

impl InReach {
    /// The tangents at another position on the obstacle.
    fn tangents_at(&self, frame: &Frame) -> [Vector; 2] {
        if self.tangents < 2 || frame.curvature.is_zero() {
            return if self.tangents < 2 { frame.tangents } else { self.frame.tangents };
        }
        let normal = self.frame.normal;
        self.frame.tangents.map(|direction| Start { direction, normal }.carried_to(&frame.normal))
    }

    /// The change of one of these tangents with a motion.
    fn tangent_change(&self, frame: &Frame, tangent: &Vector, motion: &Vector) -> Vector {
        if self.tangents < 2 {
            return frame.tangent_change(motion);
        }
        scaled(&frame.normal, -dot(&frame.normal_change(motion), tangent))
    }
}
