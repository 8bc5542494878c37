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

use super::mode_system::Loading;
use super::state::{Rate, State, along};
use crate::cancel::CancelFlag;
use crate::contact::Mode;
use crate::mpec::{self, Finish, PairActivity, Problem, Settings};
use nalgebra::{DMatrix, DVector};

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
            let position = data.position(structure.dimension, &structure.reference, &base.displacement);
            if data.obstacle.gap(&position) > REACH * step {
                continue;
            }
            let traction = base.reactions[contact].tangential[0] / force;
            reach.push(InReach { contact, first: next, friction: data.friction, traction });
            next += if data.friction > 0.0 { 4 } else { 1 };
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
        self.reach.iter().map(|entry| -entry.traction * self.tangential(entry.contact, &rate.displacement)).sum()
    }

    fn tangential(&self, contact: usize, motion: &[f64]) -> f64 {
        let dimension = self.loading.structure.dimension;
        let contact = &self.loading.contacts[contact];
        let first = contact.node * dimension;
        along(&motion[first..first + dimension], &contact.obstacle.tangents(dimension)[0])
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
                x[entry.first + 1] = (reaction.tangential[0] + self.step * change.tangential[0]) / self.force;
                let slip = self.tangential(entry.contact, &rate.displacement);
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
                    (PairActivity::FirstZero, _) => Mode::Slip { direction: [1.0, 0.0] },
                    (_, PairActivity::FirstZero) => Mode::Slip { direction: [-1.0, 0.0] },
                    (PairActivity::BothZero, _) | (_, PairActivity::BothZero) if present.is_active() => present,
                    _ => Mode::Stick,
                }
            } else {
                Mode::Slip { direction: [0.0; 2] }
            };
            modes[entry.contact] = match normal {
                PairActivity::FirstZero => closed,
                PairActivity::BothZero => present,
                PairActivity::SecondZero | PairActivity::NeitherZero => Mode::Free,
            };
        }
        Named { modes }
    }

    /// Rows and directions of the contact's node: `(unknown, normal component, tangent component)`.
    fn node_of(&self, entry: &InReach) -> impl Iterator<Item = (usize, f64, f64)> {
        let structure = self.loading.structure;
        let contact = &self.loading.contacts[entry.contact];
        let (normal, tangents) = (contact.obstacle.normal(), contact.obstacle.tangents(structure.dimension));
        let first = contact.node * structure.dimension;
        (0..structure.dimension)
            .filter_map(move |k| structure.unknown_of[first + k].map(|unknown| (unknown, normal[k], tangents[0][k])))
    }
}

impl Problem for IncrementProgram<'_> {
    fn variables(&self) -> usize {
        self.variables
    }

    fn equalities(&self) -> usize {
        self.loading.structure.unknowns() + self.reach.iter().filter(|entry| entry.friction > 0.0).count()
    }

    fn inequalities(&self) -> usize {
        0
    }

    fn pairs(&self) -> usize {
        self.reach.iter().map(|entry| if entry.friction > 0.0 { 3 } else { 1 }).sum()
    }

    fn bounds(&self) -> (DVector<f64>, DVector<f64>) {
        let mut lower = DVector::repeat(self.variables, f64::NEG_INFINITY);
        for entry in &self.reach {
            lower[entry.first] = 0.0;
            if entry.friction > 0.0 {
                lower[entry.first + 2] = 0.0;
                lower[entry.first + 3] = 0.0;
            }
        }
        (lower, DVector::repeat(self.variables, f64::INFINITY))
    }

    fn objective(&self, x: &DVector<f64>) -> f64 {
        let structure = self.loading.structure;
        let (mut squared, mut forward) = (0.0, 0.0);
        for (unknown, freedom) in structure.freedom_of.iter().enumerate() {
            squared += x[unknown] * x[unknown];
            forward += x[unknown] * self.forward.displacement[*freedom];
        }
        let load = x[structure.unknowns()];
        squared += load * load;
        forward += load * self.forward.load;
        let slip = |entry: &InReach| entry.traction * (x[entry.first + 2] - x[entry.first + 3]);
        let dissipated: f64 = self.reach.iter().filter(|entry| entry.friction > 0.0).map(slip).sum();
        0.5 * self.arc_weight * squared - self.forward_weight * forward + dissipated
    }

    fn objective_gradient(&self, x: &DVector<f64>, gradient: &mut DVector<f64>) {
        let structure = self.loading.structure;
        gradient.fill(0.0);
        for (unknown, freedom) in structure.freedom_of.iter().enumerate() {
            gradient[unknown] =
                self.arc_weight * x[unknown] - self.forward_weight * self.forward.displacement[*freedom];
        }
        let load = structure.unknowns();
        gradient[load] = self.arc_weight * x[load] - self.forward_weight * self.forward.load;
        for entry in self.reach.iter().filter(|entry| entry.friction > 0.0) {
            gradient[entry.first + 2] = entry.traction;
            gradient[entry.first + 3] = -entry.traction;
        }
    }

    fn equality_values(&self, x: &DVector<f64>, values: &mut DVector<f64>) {
        let structure = self.loading.structure;
        let state = self.state(x);
        let mut force = vec![0.0; structure.freedoms()];
        structure.internal_force(&state.displacement, &mut force);
        for (unknown, freedom) in structure.freedom_of.iter().enumerate() {
            let load = state.load * self.loading.pattern[*freedom] + self.loading.held[*freedom];
            values[unknown] = (force[*freedom] - load) / self.force;
        }
        let mut row = structure.unknowns();
        for entry in &self.reach {
            let mut motion = 0.0;
            for (unknown, normal, tangent) in self.node_of(entry) {
                values[unknown] -= x[entry.first] * normal;
                if entry.friction > 0.0 {
                    values[unknown] -= x[entry.first + 1] * tangent;
                    motion += tangent * x[unknown];
                }
            }
            if entry.friction > 0.0 {
                values[row] = motion - x[entry.first + 2] + x[entry.first + 3];
                row += 1;
            }
        }
    }

    fn equality_jacobian(&self, x: &DVector<f64>, jacobian: &mut DMatrix<f64>) {
        let structure = self.loading.structure;
        let state = self.state(x);
        structure.add_tangent(&state.displacement, jacobian);
        let unknowns = structure.unknowns();
        jacobian.view_mut((0, 0), (unknowns, unknowns)).scale_mut(self.step / self.force);
        for (unknown, freedom) in structure.freedom_of.iter().enumerate() {
            jacobian[(unknown, unknowns)] = -self.loading.pattern[*freedom] * self.step / self.force;
        }
        let mut row = unknowns;
        for entry in &self.reach {
            for (unknown, normal, tangent) in self.node_of(entry) {
                jacobian[(unknown, entry.first)] = -normal;
                if entry.friction > 0.0 {
                    jacobian[(unknown, entry.first + 1)] = -tangent;
                    jacobian[(row, unknown)] = tangent;
                }
            }
            if entry.friction > 0.0 {
                jacobian[(row, entry.first + 2)] = -1.0;
                jacobian[(row, entry.first + 3)] = 1.0;
                row += 1;
            }
        }
    }

    fn pair_values(&self, x: &DVector<f64>, first: &mut DVector<f64>, second: &mut DVector<f64>) {
        let structure = self.loading.structure;
        let state = self.state(x);
        let mut pair = 0;
        for entry in &self.reach {
            let contact = &self.loading.contacts[entry.contact];
            let position = contact.position(structure.dimension, &structure.reference, &state.displacement);
            first[pair] = contact.obstacle.gap(&position) / self.step;
            second[pair] = x[entry.first];
            pair += 1;
            if entry.friction > 0.0 {
                let bound = entry.friction * x[entry.first];
                for (side, offset) in [(1.0, 2), (-1.0, 3)] {
                    first[pair] = (bound + side * x[entry.first + 1]) / (1.0 + entry.friction);
                    second[pair] = x[entry.first + offset];
                    pair += 1;
                }
            }
        }
    }

    fn pair_jacobians(&self, _x: &DVector<f64>, first: &mut DMatrix<f64>, second: &mut DMatrix<f64>) {
        let mut pair = 0;
        for entry in &self.reach {
            for (unknown, normal, _) in self.node_of(entry) {
                first[(pair, unknown)] = normal;
            }
            second[(pair, entry.first)] = 1.0;
            pair += 1;
            if entry.friction > 0.0 {
                for (side, offset) in [(1.0, 2), (-1.0, 3)] {
                    first[(pair, entry.first)] = entry.friction / (1.0 + entry.friction);
                    first[(pair, entry.first + 1)] = side / (1.0 + entry.friction);
                    second[(pair, entry.first + offset)] = 1.0;
                    pair += 1;
                }
            }
        }
    }

    fn quadratic_model(&self, _x: &DVector<f64>) -> Option<DMatrix<f64>> {
        let mut model = DMatrix::zeros(self.variables, self.variables);
        for unknown in 0..=self.loading.structure.unknowns() {
            model[(unknown, unknown)] = self.arc_weight;
        }
        Some(model)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::path::scene::Scene;

    /// The conditions of Karush, Kuhn and Tucker for the increment: with `r_t⁽ᵏ⁾ = 0` the step is `γ2/γ1` times the
    /// previous direction plus a combination of the gradients of the active constraints, equilibrium among them.
    fn kkt_holds(name: &str, forward: impl Fn(&Scene) -> Rate) {
        let text = crate::scenes::find(name).unwrap().request;
        let request = crate::model::decode::decode(text.as_bytes()).unwrap();
        let scene = Scene::new(&request).unwrap();
        let held = vec![0.0; scene.structure.freedoms()];
        let loading = Loading {
            structure: &scene.structure,
            contacts: &scene.contacts,
            pattern: &scene.stages[0].pattern,
            held: &held,
        };
        let base = State::at_rest(&scene.structure, scene.contacts.len());
        let mut forward = forward(&scene);
        let size = forward.size();
        forward.scale(1.0 / size);
        let mut program = IncrementProgram::new(loading, &base, &forward, 0.02, 0.05);
        program.forward_weight = 0.7;
        program.arc_weight = 1.3;
        let start = program.variables_at(&forward);
        let settings = Settings::warm();
        let solution = mpec::solve(&program, &start, &settings, &CancelFlag::default()).unwrap();
        assert!(matches!(solution.status, mpec::Status::Solved | mpec::Status::Feasible), "{:?}", solution.status);
        let x = &solution.x;
        let moved = x.rows(0, scene.structure.unknowns() + 1).norm();
        assert!(moved > 0.05, "{name}: the step must not be zero, {moved}");
        // Gradients of all active constraints, one a column.
        let mut equalities = DMatrix::zeros(program.equalities(), program.variables());
        program.equality_jacobian(x, &mut equalities);
        let mut columns: Vec<DVector<f64>> = equalities.row_iter().map(|row| row.transpose()).collect();
        let (mut first, mut second) = (DVector::zeros(program.pairs()), DVector::zeros(program.pairs()));
        program.pair_values(x, &mut first, &mut second);
        let mut first_rows = DMatrix::zeros(program.pairs(), program.variables());
        let mut second_rows = first_rows.clone();
        program.pair_jacobians(x, &mut first_rows, &mut second_rows);
        for pair in 0..program.pairs() {
            if first[pair].abs() < 1e-6 {
                columns.push(first_rows.row(pair).transpose());
            }
            if second[pair].abs() < 1e-6 {
                columns.push(second_rows.row(pair).transpose());
            }
        }
        let gradients = DMatrix::from_columns(&columns);
        // y - (γ2/γ1) d must lie in their span.
        let unknowns = scene.structure.unknowns() + 1;
        let mut step = DVector::zeros(program.variables());
        let direction = program.variables_at(&forward);
        for k in 0..unknowns {
            step[k] = x[k] - program.forward_weight / program.arc_weight * direction[k];
        }
        let fitted = gradients.clone().svd(true, true).solve(&step, 1e-12).unwrap();
        let rest = (&gradients * fitted - &step).amax();
        assert!(rest < 1e-7, "{name}: {rest:e} is left");
    }

    fn towards_the_load(scene: &Scene) -> Rate {
        let pattern = scene.stages[0].pattern.clone();
        // A guess of slip, so that the start names the branch.
        let pressed = |contact: &crate::contact::Contact| crate::contact::Reaction {
            normal: 0.4,
            tangential: [-0.4 * contact.friction, 0.0],
        };
        let reactions = scene.contacts.iter().map(pressed).collect();
        Rate { displacement: pattern, load: 0.3, reactions }
    }

    #[test]
    fn karush_kuhn_tucker_conditions_of_the_increment() {
        kkt_holds("von-mises-truss", towards_the_load);
        kkt_holds("one-bar-truss", towards_the_load);
        kkt_holds("two-snapping-bars", towards_the_load);
    }
}
