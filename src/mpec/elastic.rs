//! One step's quadratic program, by the cheapest way that works.
//!
//! 1. the linear system of the working set that the last program ended with (`mpec::active_set`);
//! 2. the interior-point method, its active set taken to round-off by the same linear system;
//! 3. the elastic program, where the constraints seem contradictory:
//!
//! ```text
//! min ½ dᵀHd + q·d + ρ Σ (p + m + t)   s.t.   e + E d = p - m,   c + C d >= -t,   v + V d + t (1, 0) ∈ K,
//!                                               lower <= d <= upper,   p, m, t >= 0
//! ```
//!
//! which always has a solution; `ρ` is raised until the violation that remains no longer falls. Source: P. E. Gill,
//! W. Murray and M. A. Saunders, *SNOPT*, SIAM Review 47 (2005), doi:10.1137/S0036144504446096, section on elastic mode.

use nalgebra::DMatrix;

use super::active_set::{self, WorkingSet};
use super::quadratic::{self, ConeRows, QuadraticFailure, QuadraticProgram, QuadraticSolution};
use super::result::Counts;
use crate::cancel::CancelFlag;

/// Changes of the working set before the interior-point method is asked.
const WORKING_SET_CHANGES: usize = 8;
/// Raises of the elastic weight, and the factor of each.
const WEIGHT_RAISES: usize = 3;
const WEIGHT_FACTOR: f64 = 100.0;
/// What is active at the start, before any multiplier is known.
const REST_MARGIN: f64 = 1e-7;

/// A step and what it leaves violated.
#[derive(Debug, Clone)]
pub struct Step {
    pub solution: QuadraticSolution,
    /// Sum of the linearised violations that no step removes; zero unless elastic.
    pub remaining_violation: f64,
    /// The working set was the one that the previous program ended with.
    pub same_working_set: bool,
}

/// Solves the programs of one sequence, keeping the working set from one to the next.
#[derive(Debug, Clone, Default)]
pub struct StepSolver {
    working_set: Option<WorkingSet>,
    pub counts: Counts,
}

impl StepSolver {
    /// Forgets the working set: the next program has other rows.
    pub fn forget(&mut self) {
        self.working_set = None;
    }

    /// Solves one program.
    ///
    /// # Errors
    /// [`QuadraticFailure::NotFinite`], [`QuadraticFailure::Cancelled`], or the elastic program's own failure.
    pub fn solve(&mut self, program: &QuadraticProgram, cancel: &CancelFlag) -> Result<Step, QuadraticFailure> {
        if cancel.is_cancelled() {
            return Err(QuadraticFailure::Cancelled);
        }
        if !program.is_well_formed() {
            return Err(QuadraticFailure::NotFinite);
        }
        self.counts.qp_solves += 1;
        let before = self.working_set.take();
        let mut set = before.clone().unwrap_or_else(|| WorkingSet::at_rest(program, REST_MARGIN));
        let mut solution = active_set::solve(program, &mut set, WORKING_SET_CHANGES);
        if solution.is_none() {
            self.counts.interior_point_solves += 1;
            match quadratic::solve_interior(program, cancel) {
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
        let same_working_set = before.as_ref() == Some(&set);
        self.working_set = Some(set);
        Ok(Step { solution, remaining_violation: 0.0, same_working_set })
    }

    fn solve_elastic(&mut self, program: &QuadraticProgram, cancel: &CancelFlag) -> Result<Step, QuadraticFailure> {
        let mut weight = 10.0 * program.gradient.amax().max(1.0);
        let mut best: Option<Step> = None;
        for raise in 0..=WEIGHT_RAISES {
            self.counts.elastic_solves += 1;
            self.counts.interior_point_solves += 1;
            let solution = match quadratic::solve_interior(&relax_rows(program, weight), cancel) {
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
            best = Some(Step { solution: first_variables(solution, n), remaining_violation, same_working_set: false });
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
    let mut hessian = DMatrix::zeros(total, total);
    hessian.view_mut((0, 0), (n, n)).copy_from(&program.hessian);
    let mut equality = DMatrix::zeros(equalities, total);
    equality.view_mut((0, 0), (equalities, n)).copy_from(&program.equality);
    for i in 0..equalities {
        equality[(i, n + i)] = -1.0;
        equality[(i, n + equalities + i)] = 1.0;
    }
    let mut inequality = DMatrix::zeros(inequalities, total);
    inequality.view_mut((0, 0), (inequalities, n)).copy_from(&program.inequality);
    for i in 0..inequalities {
        inequality[(i, n + 2 * equalities + i)] = 1.0;
    }
    // A vector that lacks `t` of lying in the cone lies there with `t` added to its first entry.
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
    use nalgebra::DVector;

    /// `min ½ x²` s.t. `x >= 1` and `x <= -1`: every x in [-1, 1] violates by 2 in sum, and the smallest x wins.
    #[test]
    fn contradictory_rows_end_elastic_with_the_least_violation() {
        let program = QuadraticProgram {
            hessian: DMatrix::identity(1, 1),
            gradient: DVector::zeros(1),
            equality: DMatrix::zeros(0, 1),
            equality_values: DVector::zeros(0),
            inequality: DMatrix::from_column_slice(2, 1, &[1.0, -1.0]),
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
            hessian: DMatrix::identity(1, 1),
            gradient: DVector::from_element(1, f64::NAN),
            equality: DMatrix::zeros(0, 1),
            equality_values: DVector::zeros(0),
            inequality: DMatrix::zeros(0, 1),
            inequality_values: DVector::zeros(0),
            lower: DVector::from_element(1, f64::NEG_INFINITY),
            upper: DVector::from_element(1, f64::INFINITY),
            cones: Vec::new(),
        };
        let cancel = CancelFlag::default();
        assert_eq!(StepSolver::default().solve(&program, &cancel).err(), Some(QuadraticFailure::NotFinite));
        assert_eq!(quadratic::solve_interior(&program, &cancel).err(), Some(QuadraticFailure::NotFinite));
    }
}
