//! Solution of one smooth program by sequential quadratic programming.
//!
//! At `x` the quadratic program of the linearised rows (`smooth_program::relaxation`) gives the step `d`; its Hessian
//! `H` is the problem's own model or a damped secant matrix (`smooth_program::damped_bfgs`). Steps are assessed by the
//! merit function
//!
//! ```text
//! φ(x) = f(x) + ρ v(x),        v = Σ |equality rows| + Σ max(0, -inequality rows)
//! ```
//!
//! with the predicted slope `D = ∇f·d - ρ (v - v_left)`, where `v_left` is the violation that the elastic program could
//! not remove. `ρ` never falls and is raised as needed for `D <= -½ dᵀHd - ρ (v - v_left)/10`. A full step that
//! increases the merit function first receives a second-order correction (the rows re-evaluated at `x + d`), then is
//! shortened.
//!
//! Sources: R. Fletcher, S. Leyffer, D. Ralph and S. Scholtes, *Local convergence of SQP methods for mathematical
//! programs with equilibrium constraints*, SIAM J. Optim. 17 (2006), doi:10.1137/S1052623402407382; J. Nocedal and
//! S. J. Wright, *Numerical Optimization*, 2nd ed. (2006), chapter 18 (merit function, penalty rule, correction).

use crate::complementarity::mpec::smooth_program::tolerances::{
    HESSIAN_RIDGE, SMALLEST_REMOVED_SHARE, SUFFICIENT_DECREASE, UNBOUNDED_OBJECTIVE, UNBOUNDED_VARIABLE,
};
use nalgebra::DVector;

use crate::complementarity::mpec::program::evaluation::{ProgramEvaluation, Quantity};
use crate::complementarity::mpec::program::problem::Problem;
use crate::complementarity::mpec::program::solve_statistics::SolverIterate;
use crate::complementarity::mpec::program::sparse_rows::SparseRows;
use crate::complementarity::mpec::quadratic_program::driver::{QuadraticStep, StepSolver};
use crate::complementarity::mpec::quadratic_program::interior_point::{QuadraticFailure, QuadraticProgram};
use crate::complementarity::mpec::smooth_program::damped_bfgs::Secant;
use crate::complementarity::mpec::smooth_program::smooth_rows::{Multipliers, SmoothProgramRows};
use crate::resources::cancel::CancelFlag;

/// Largest number of halvings of a step.
const HALVINGS: usize = 30;

/// Settings of one sequence of quadratic programs.
#[derive(Debug, Clone, Copy)]
pub struct SqpSettings {
    pub tolerance: f64,
    pub iteration_limit: usize,
    /// Whether to end as soon as two successive programs have the same working set.
    pub stop_when_settled: bool,
}

/// The reason why a sequence ended.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum SqpEnd {
    /// A Karush-Kuhn-Tucker point.
    Converged,
    /// The working set remained unchanged (only where requested).
    Settled,
    /// No acceptable step; the point may be feasible nevertheless.
    Stalled,
    /// A stationary point of the violation, which is not zero.
    Infeasible,
    IterationLimit,
    Unbounded,
    NotFinite(Quantity),
    Cancelled,
}

/// The end point of a sequence.
#[derive(Debug, Clone)]
pub struct SqpOutcome {
    pub end: SqpEnd,
    pub x: DVector<f64>,
    /// Values at `x`; derivatives at `x` or at the previous point.
    pub at: ProgramEvaluation,
    pub multipliers: Multipliers,
}

/// A sequence in progress.
struct Sequence<'a, P: Problem + ?Sized> {
    problem: &'a P,
    rows: &'a SmoothProgramRows,
    bounds: &'a (DVector<f64>, DVector<f64>),
    cancel: &'a CancelFlag,
    x: DVector<f64>,
    at: ProgramEvaluation,
    trial_x: DVector<f64>,
    trial: ProgramEvaluation,
    penalty: f64,
}

/// Runs one sequence from `start`, which is first moved into the bounds.
pub fn solve<P: Problem + ?Sized>(
    problem: &P,
    rows: &SmoothProgramRows,
    bounds: &(DVector<f64>, DVector<f64>),
    start: &DVector<f64>,
    settings: SqpSettings,
    steps: &mut StepSolver,
    cancel: &CancelFlag,
) -> SqpOutcome {
    let evaluation = ProgramEvaluation::new(problem);
    let mut sequence = Sequence {
        problem,
        rows,
        bounds,
        cancel,
        x: clamped(start, bounds),
        trial: evaluation.clone(),
        at: evaluation,
        trial_x: start.clone(),
        penalty: 1.0,
    };
    let mut multipliers = no_multipliers(problem);
    let end = sequence.run(settings, steps, &mut multipliers);
    SqpOutcome { end, x: sequence.x, at: sequence.at, multipliers }
}

impl<P: Problem + ?Sized> Sequence<'_, P> {
    fn run(&mut self, settings: SqpSettings, steps: &mut StepSolver, multipliers: &mut Multipliers) -> SqpEnd {
        steps.forget();
        if let Err(quantity) = self.at.update_values(self.problem, &self.x) {
            return SqpEnd::NotFinite(quantity);
        }
        let mut secant = Secant::new(self.x.len());
        let mut program = match self.program(&mut secant) {
            Ok(program) => program,
            Err(quantity) => return SqpEnd::NotFinite(quantity),
        };
        steps.head_for(&program, &self.x);
        for iteration in 0..settings.iteration_limit {
            steps.counts.sqp_iterations += 1;
            let step = match steps.solve(&program, self.cancel) {
                Ok(step) => step,
                Err(QuadraticFailure::Cancelled) => return SqpEnd::Cancelled,
                Err(QuadraticFailure::NotFinite) => return SqpEnd::NotFinite(Quantity::QuadraticModel),
                Err(
                    QuadraticFailure::SuspectedInfeasible
                    | QuadraticFailure::SuspectedUnbounded
                    | QuadraticFailure::Inaccurate,
                ) if secant.reset() => {
                    secant.put_into(&mut program.hessian);
                    continue;
                }
                Err(
                    QuadraticFailure::SuspectedInfeasible
                    | QuadraticFailure::SuspectedUnbounded
                    | QuadraticFailure::Inaccurate,
                ) => return SqpEnd::Stalled,
            };
            *multipliers = self.rows.multipliers(&self.at, &step.solution);
            let violation = self.rows.violation(&self.at);
            if violation <= settings.tolerance && is_stationary(&program, &step, settings.tolerance, &self.x) {
                self.take_last_step(&step.solution.step, violation.max(1e-2 * settings.tolerance));
                return SqpEnd::Converged;
            }
            if violation > settings.tolerance
                && violation - step.remaining_violation <= SMALLEST_REMOVED_SHARE * violation
            {
                return SqpEnd::Infeasible;
            }
            let Some(length) = self.search(&program, &step, violation, steps) else {
                if self.cancel.is_cancelled() {
                    return SqpEnd::Cancelled;
                }
                if secant.reset() {
                    secant.put_into(&mut program.hessian);
                    continue;
                }
                return SqpEnd::Stalled;
            };
            std::mem::swap(&mut self.x, &mut self.trial_x);
            std::mem::swap(&mut self.at, &mut self.trial);
            self.keep_iterate(steps);
            if self.at.objective < UNBOUNDED_OBJECTIVE || self.x.amax() > UNBOUNDED_VARIABLE {
                return SqpEnd::Unbounded;
            }
            let left = self.rows.violation(&self.at);
            let quiet = left <= settings.tolerance.sqrt() || iteration > 0 && left <= 0.1 * violation;
            if settings.stop_when_settled && step.same_working_set && length == 1.0 && quiet {
                return SqpEnd::Settled;
            }
            let next = match self.program(&mut secant) {
                Ok(program) => program,
                Err(quantity) => return SqpEnd::NotFinite(quantity),
            };
            self.update_secant(&mut secant, &step, &program, &next);
            program = next;
            secant.put_into(&mut program.hessian);
        }
        SqpEnd::IterationLimit
    }

    /// Stores `x` where iterates are requested.
    fn keep_iterate(&self, steps: &mut StepSolver) {
        if let Some(iterates) = &mut steps.iterates {
            let violation = self.rows.violation(&self.at);
            let (x, objective) = (self.x.clone(), self.at.objective);
            iterates.push(SolverIterate { relaxation: self.rows.relaxation(), x, objective, violation });
        }
    }

    /// Updates the secant matrix by the change of the Lagrangian's gradient over the last step.
    fn update_secant(
        &self,
        secant: &mut Secant,
        step: &QuadraticStep,
        program: &QuadraticProgram,
        next: &QuadraticProgram,
    ) {
        if secant.is_idle() {
            return;
        }
        let change = &self.x - &self.trial_x;
        let lagrangian = |program: &QuadraticProgram| {
            &program.gradient
                - program.equality.tr_mul(&step.solution.equality_multipliers)
                - program.inequality.tr_mul(&step.solution.inequality_multipliers)
                - program.cone_force(&step.solution)
        };
        secant.update(&change, &(lagrangian(next) - lagrangian(program)));
    }

    /// The quadratic program at `x`. With the problem's own model, the secant matrix becomes idle.
    fn program(&mut self, secant: &mut Secant) -> Result<QuadraticProgram, Quantity> {
        self.at.update_derivatives(self.problem, &self.x)?;
        let n = self.x.len();
        let hessian = match self.problem.quadratic_model(&self.x) {
            Some(mut model) => {
                if (model.nrows(), model.ncols()) != (n, n) || !model.is_finite() {
                    return Err(Quantity::QuadraticModel);
                }
                secant.set_idle();
                let ridge = HESSIAN_RIDGE * model.amax().max(f64::MIN_POSITIVE);
                (0..n).for_each(|j| model[(j, j)] += ridge);
                model
            }
            None => SparseRows::identity(n),
        };
        Ok(self.rows.linearise(&self.at, &self.x, self.bounds, hessian))
    }

    /// Finds a step length with sufficient decrease; `trial` then has the new point.
    fn search(
        &mut self,
        program: &QuadraticProgram,
        step: &QuadraticStep,
        violation: f64,
        steps: &mut StepSolver,
    ) -> Option<f64> {
        let direction = &step.solution.step;
        let removed = (violation - step.remaining_violation).max(0.0);
        let slope = program.gradient.dot(direction);
        if removed > 0.0 {
            let needed = (slope + 0.5 * program.curvature(direction).max(0.0)) / (0.9 * removed);
            if needed > self.penalty && needed.is_finite() {
                self.penalty = 2.0 * needed;
            }
        }
        let predicted = slope - self.penalty * removed;
        let merit = self.at.objective + self.penalty * violation;
        let round_off = 1e-14 * (1.0 + self.at.objective.abs() + self.penalty * violation);
        if predicted >= 0.0 && direction.amax() <= 1e-14 * (1.0 + self.x.amax()) {
            return None;
        }
        let accepts = |trial: &ProgramEvaluation, rows: &SmoothProgramRows, penalty: f64, length: f64| {
            trial.objective + penalty * rows.violation(trial)
                <= merit + SUFFICIENT_DECREASE * length * predicted.min(0.0) + round_off
        };
        let mut length = 1.0;
        for _ in 0..HALVINGS {
            if self.cancel.is_cancelled() {
                return None;
            }
            let finite = self.try_point(direction, length);
            if finite && accepts(&self.trial, self.rows, self.penalty, length) {
                return Some(length);
            }
            if finite && length == 1.0 && step.remaining_violation == 0.0 {
                let mut corrected = program.clone();
                self.rows.correct(&mut corrected, &self.trial, direction);
                if let Ok(correction) = steps.solve(&corrected, self.cancel)
                    && correction.remaining_violation == 0.0
                    && correction.solution.step.amax() <= 2.0 * direction.amax()
                    && self.try_point(&correction.solution.step, 1.0)
                    && accepts(&self.trial, self.rows, self.penalty, 1.0)
                {
                    return Some(1.0);
                }
            }
            length *= 0.5;
        }
        None
    }

    /// Evaluates the functions at `x + length direction`, clamped to the bounds; false where a value is not finite.
    fn try_point(&mut self, direction: &DVector<f64>, length: f64) -> bool {
        self.trial_x.copy_from(&self.x);
        self.trial_x.axpy(length, direction, 1.0);
        self.trial_x = clamped(&self.trial_x, self.bounds);
        self.trial.update_values(self.problem, &self.trial_x).is_ok()
    }

    /// Takes the known step at a converged point, which brings a quadratically convergent sequence to round-off.
    fn take_last_step(&mut self, step: &DVector<f64>, allowed_violation: f64) {
        if self.try_point(step, 1.0) && self.rows.violation(&self.trial) <= allowed_violation {
            std::mem::swap(&mut self.x, &mut self.trial_x);
            self.at.swap_values(&mut self.trial);
        }
    }
}

/// Whether `x` is stationary: with the program's multipliers, the Lagrangian's gradient at `x` is `-H d` and the slacks
/// of the rows are `-C d`.
fn is_stationary(program: &QuadraticProgram, step: &QuadraticStep, tolerance: f64, x: &DVector<f64>) -> bool {
    let direction = &step.solution.step;
    if x.is_empty() {
        return true;
    }
    let force = (&program.hessian * direction).amax() / (1.0 + program.gradient.amax());
    // A short step alone proves nothing far from the origin: there every step is relatively short.
    if direction.amax() <= 1e-2 * tolerance * (1.0 + x.amax()) && force <= tolerance.sqrt() {
        return true;
    }
    let work = (&program.inequality * direction).dot(&step.solution.inequality_multipliers).abs()
        + direction.dot(&step.solution.lower_multipliers).abs()
        + direction.dot(&step.solution.upper_multipliers).abs()
        + program.cone_force(&step.solution).dot(direction).abs();
    force <= tolerance && work <= tolerance
}

fn clamped(x: &DVector<f64>, bounds: &(DVector<f64>, DVector<f64>)) -> DVector<f64> {
    DVector::from_iterator(x.len(), (0..x.len()).map(|j| x[j].max(bounds.0[j]).min(bounds.1[j])))
}

/// Zero multipliers for every row.
pub fn no_multipliers<P: Problem + ?Sized>(problem: &P) -> Multipliers {
    let n = problem.variables();
    let cone_entries = problem.cone_sizes().iter().sum();
    Multipliers {
        equality: DVector::zeros(problem.equalities()),
        inequality: DVector::zeros(problem.inequalities()),
        first: DVector::zeros(problem.pairs()),
        second: DVector::zeros(problem.pairs()),
        cone_first: DVector::zeros(cone_entries),
        cone_second: DVector::zeros(cone_entries),
        lower: DVector::zeros(n),
        upper: DVector::zeros(n),
    }
}
