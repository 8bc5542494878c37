//! The quadratic program of one step, by the cheapest method that succeeds.
//!
//! 1. where the equalities leave a line, the program reduced to this line (`quadratic_program::one_dimensional`);
//! 2. the linear system of the last program's final working set (`quadratic_program::active_set`);
//! 3. the interior-point method, refined to round-off by the linear system of its active set;
//! 4. the elastic program, where the constraints seem contradictory:
//!
//! ```text
//! min ½ dᵀHd + q·d + ρ Σ (p + m + t)   s.t.   e + E d = p - m,   c + C d >= -t,   v + V d + t (1, 0) ∈ K,
//!                                               lower <= d <= upper,   p, m, t >= 0
//! ```
//!
//! which always has a solution; `ρ` is raised until the remaining violation no longer falls. Source: P. E. Gill, W.
//! Murray and M. A. Saunders, *SNOPT*, SIAM Review 47 (2005), doi:10.1137/S0036144504446096, section on elastic mode.

use crate::complementarity::mpec::quadratic_program::tolerances::{INITIAL_ACTIVITY_MARGIN, WEIGHT_FACTOR};
use nalgebra::DVector;

use crate::complementarity::mpec::program::solve_statistics::{SolverCounts, SolverIterate};
use crate::complementarity::mpec::program::sparse_rows::SparseRows;
use crate::complementarity::mpec::quadratic_program::active_set::{self, WorkingSet};
use crate::complementarity::mpec::quadratic_program::interior_point::{
    ConeRows, InteriorSolver, QuadraticFailure, QuadraticProgram, QuadraticSolution,
};
use crate::complementarity::mpec::quadratic_program::one_dimensional::{Binding, LineSolver, OneDimensionalOutcome};
use crate::resources::cancel::CancelFlag;

/// Largest number of changes of the working set before the interior-point method is used.
const WORKING_SET_CHANGES: usize = 8;
/// Largest number of increases of the elastic weight.
const WEIGHT_RAISES: usize = 3;

/// A step and its remaining violation.
#[derive(Debug, Clone)]
pub struct QuadraticStep {
    pub solution: QuadraticSolution,
    /// Sum of the linearised violations that no step removes; zero unless elastic.
    pub remaining_violation: f64,
    /// Whether the working set is the final working set of the previous program.
    pub same_working_set: bool,
}

/// A solver of the programs of one sequence, which passes the working set from each program to the next.
pub struct StepSolver {
    ended_with: Option<FinalWorkingSet>,
    line: LineSolver,
    interior: InteriorSolver,
    /// Whether rows that contradict each other on a line are relaxed.
    pub is_elastic: bool,
    /// Whether the interior-point method is used for every program.
    pub interior_only: bool,
    pub counts: SolverCounts,
    /// The last bound on products of a sequence.
    pub relaxation: Option<f64>,
    /// Stored iterates, where requested.
    pub iterates: Option<Vec<SolverIterate>>,
}

impl Default for StepSolver {
    fn default() -> Self {
        Self {
            ended_with: None,
            line: LineSolver::default(),
            interior: InteriorSolver::default(),
            is_elastic: true,
            interior_only: false,
            counts: SolverCounts::default(),
            relaxation: None,
            iterates: None,
        }
    }
}

/// The active constraints at the last program's solution.
#[derive(Debug, Clone, PartialEq)]
enum FinalWorkingSet {
    OnLine(Option<Binding>),
    With(WorkingSet),
}

impl StepSolver {
    /// Forgets the working set: the next program has other rows.
    pub fn forget(&mut self) {
        self.ended_with = None;
    }

    /// Whether constraints other than equalities are active at the last solution.
    pub fn is_bound(&self) -> bool {
        match &self.ended_with {
            Some(FinalWorkingSet::OnLine(binding)) => binding.is_some(),
            Some(FinalWorkingSet::With(set)) => !set.is_empty(),
            None => true,
        }
    }

    /// Announces the likely direction of the next steps: from the origin to `x`.
    pub fn head_for(&mut self, program: &QuadraticProgram, x: &DVector<f64>) {
        self.line.head_for(&program.hessian, x);
    }

    /// Solves one program.
    ///
    /// # Errors
    /// [`QuadraticFailure::NotFinite`], [`QuadraticFailure::Cancelled`], or the elastic program's own failure;
    /// [`QuadraticFailure::SuspectedInfeasible`] for contradictory rows on a line, unless they are relaxed.
    pub fn solve(
        &mut self,
        program: &QuadraticProgram,
        cancel: &CancelFlag,
    ) -> Result<QuadraticStep, QuadraticFailure> {
        if cancel.is_cancelled() {
            return Err(QuadraticFailure::Cancelled);
        }
        if !program.is_well_formed() {
            return Err(QuadraticFailure::NotFinite);
        }
        self.counts.qp_solves += 1;
        let before = self.ended_with.take();
        let on_line = if self.interior_only { OneDimensionalOutcome::Declined } else { self.line.solve(program) };
        match on_line {
            OneDimensionalOutcome::Solved(solution, binding) => {
                let ended = FinalWorkingSet::OnLine(binding);
                // Before the first program no constraint counts as active.
                let same_working_set = *before.as_ref().unwrap_or(&FinalWorkingSet::OnLine(None)) == ended;
                self.ended_with = Some(ended);
                return Ok(QuadraticStep { solution, remaining_violation: 0.0, same_working_set });
            }
            OneDimensionalOutcome::Contradictory if !self.is_elastic => {
                return Err(QuadraticFailure::SuspectedInfeasible);
            }
            OneDimensionalOutcome::Contradictory | OneDimensionalOutcome::Declined => {}
        }
        let mut set = match &before {
            Some(FinalWorkingSet::With(set)) => set.clone(),
            Some(FinalWorkingSet::OnLine(_)) | None => WorkingSet::at_rest(program, INITIAL_ACTIVITY_MARGIN),
        };
        let mut solution =
            if self.interior_only { None } else { active_set::solve(program, &mut set, WORKING_SET_CHANGES) };
        if solution.is_none() {
            self.counts.interior_point_solves += 1;
            match self.interior.solve(program, cancel) {
                Ok(approximate) => {
                    set = WorkingSet::of_solution(program, &approximate);
                    solution = active_set::solve(program, &mut set, WORKING_SET_CHANGES).or(Some(approximate));
                }
                Err(failure @ (QuadraticFailure::Cancelled | QuadraticFailure::NotFinite)) => return Err(failure),
                Err(
                    QuadraticFailure::SuspectedInfeasible
                    | QuadraticFailure::SuspectedUnbounded
                    | QuadraticFailure::Inaccurate,
                ) => {}
            }
        }
        let Some(solution) = solution else { return self.solve_elastic(program, cancel) };
        let ended = FinalWorkingSet::With(set);
        let same_working_set = before.as_ref() == Some(&ended);
        self.ended_with = Some(ended);
        Ok(QuadraticStep { solution, remaining_violation: 0.0, same_working_set })
    }

    fn solve_elastic(
        &mut self,
        program: &QuadraticProgram,
        cancel: &CancelFlag,
    ) -> Result<QuadraticStep, QuadraticFailure> {
        let mut weight = 10.0 * program.gradient.amax().max(1.0);
        let mut best: Option<QuadraticStep> = None;
        for raise in 0..=WEIGHT_RAISES {
            self.counts.elastic_solves += 1;
            self.counts.interior_point_solves += 1;
            let solution = match self.interior.solve(&relax_rows(program, weight), cancel) {
                Ok(solution) => solution,
                Err(failure @ QuadraticFailure::Cancelled) => return Err(failure),
                Err(failure) => return best.ok_or(failure),
            };
            let n = program.gradient.len();
            let remaining_violation: f64 = solution.step.iter().skip(n).map(|slack| slack.max(0.0)).sum();
            let in_cones = program.cones.iter().fold(0.0_f64, |worst, cone| worst.max(largest(cone.values.as_slice())));
            let scale = 1.0
                + largest(program.equality_values.as_slice())
                    .max(largest(program.inequality_values.as_slice()))
                    .max(in_cones);
            let settled = remaining_violation <= 1e-8 * scale
                || best.as_ref().is_some_and(|step| remaining_violation > 0.99 * step.remaining_violation);
            best = Some(QuadraticStep {
                solution: first_variables(solution, n),
                remaining_violation,
                same_working_set: false,
            });
            if settled && raise > 0 || remaining_violation <= 1e-8 * scale {
                break;
            }
            weight *= WEIGHT_FACTOR;
        }
        best.ok_or(QuadraticFailure::Inaccurate)
    }
}

fn largest(values: &[f64]) -> f64 {
    values.iter().fold(0.0, |worst, value| worst.max(value.abs()))
}

fn relax_rows(program: &QuadraticProgram, weight: f64) -> QuadraticProgram {
    let n = program.gradient.len();
    let (equalities, inequalities) = (program.equality_values.len(), program.inequality_values.len());
    let in_cones = n + 2 * equalities + inequalities;
    let total = in_cones + program.cones.len();
    let mut hessian = SparseRows::zeros(total, total);
    (0..n).for_each(|i| hessian.set_row(i, program.hessian.row(i).iter().copied()));
    let mut equality = program.equality.clone();
    equality.widen(total);
    for i in 0..equalities {
        equality[(i, n + i)] = -1.0;
        equality[(i, n + equalities + i)] = 1.0;
    }
    let mut inequality = program.inequality.clone();
    inequality.widen(total);
    for i in 0..inequalities {
        inequality[(i, n + 2 * equalities + i)] = 1.0;
    }
    // A vector outside the cone by `t` lies in the cone with `t` added to its first entry.
    let cones = program.cones.iter().enumerate().map(|(i, cone)| {
        let mut rows = cone.rows.clone().resize_horizontally(total, 0.0);
        rows[(0, in_cones + i)] = 1.0;
        ConeRows { rows, values: cone.values.clone() }
    });
    QuadraticProgram {
        cones: cones.collect(),
        hessian,
        gradient: program.gradient.clone().resize_vertically(total, weight),
        equality,
        equality_values: program.equality_values.clone(),
        inequality,
        inequality_values: program.inequality_values.clone(),
        lower: program.lower.clone().resize_vertically(total, 0.0),
        upper: program.upper.clone().resize_vertically(total, f64::INFINITY),
    }
}

fn first_variables(solution: QuadraticSolution, n: usize) -> QuadraticSolution {
    QuadraticSolution {
        step: solution.step.rows(0, n).into_owned(),
        lower_multipliers: solution.lower_multipliers.rows(0, n).into_owned(),
        upper_multipliers: solution.upper_multipliers.rows(0, n).into_owned(),
        ..solution
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::complementarity::mpec::quadratic_program::interior_point;
    use nalgebra::DMatrix;

    /// `min ½ x²` s.t. `x >= 1` and `x <= -1`: every x in [-1, 1] has a total violation of 2, and x = 0 minimises the
    /// objective.
    #[test]
    fn contradictory_rows_end_elastic_with_the_least_violation() {
        let program = QuadraticProgram {
            hessian: SparseRows::identity(1),
            gradient: DVector::zeros(1),
            equality: SparseRows::zeros(0, 1),
            equality_values: DVector::zeros(0),
            inequality: SparseRows::from(&DMatrix::from_column_slice(2, 1, &[1.0, -1.0])),
            inequality_values: DVector::from_column_slice(&[-1.0, -1.0]),
            lower: DVector::from_element(1, f64::NEG_INFINITY),
            upper: DVector::from_element(1, f64::INFINITY),
            cones: Vec::new(),
        };
        let mut steps = StepSolver::default();
        let step = steps.solve(&program, &CancelFlag::default()).expect("the elastic program has a solution");
        assert!((step.remaining_violation - 2.0).abs() < 1e-6, "{}", step.remaining_violation);
        assert!(step.solution.step[0].abs() < 1e-5, "{}", step.solution.step[0]);
        assert!(steps.counts.elastic_solves >= 1);
    }

    #[test]
    fn data_that_are_not_finite_are_named_before_any_solve() {
        let program = QuadraticProgram {
            hessian: SparseRows::identity(1),
            gradient: DVector::from_element(1, f64::NAN),
            equality: SparseRows::zeros(0, 1),
            equality_values: DVector::zeros(0),
            inequality: SparseRows::zeros(0, 1),
            inequality_values: DVector::zeros(0),
            lower: DVector::from_element(1, f64::NEG_INFINITY),
            upper: DVector::from_element(1, f64::INFINITY),
            cones: Vec::new(),
        };
        let cancel = CancelFlag::default();
        assert_eq!(StepSolver::default().solve(&program, &cancel).err(), Some(QuadraticFailure::NotFinite));
        assert_eq!(interior_point::solve_interior(&program, &cancel).err(), Some(QuadraticFailure::NotFinite));
    }
}
