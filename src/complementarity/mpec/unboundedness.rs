//! Whether a point that passes for a solution is a place on a way to infinity.
//!
//! Where an infimum is not attained, the conditions of Karush, Kuhn and Tucker hold better and better as some variable grows,
//! to any tolerance in the end, and nothing there is a solution. At a point that is one, growing any variable by a part of
//! itself gains nothing at first order: with the Lagrangian's gradient `r`, `r_j x_j` is nothing beside the objective. Where
//! it is more than that, the branch is solved again with that variable held at ten, a hundred, a thousand times its value and
//! so on. If the optimum rises anywhere there is a solution, near or far. If it falls as far out as it can be told, a thousand
//! times at the least, there is none: the iterates are unbounded. Only ratios of quantities to their like are used, so that
//! units do not matter.

use nalgebra::DVector;

use crate::complementarity::mpec::piecewise_descent::{self, CandidatePoint};
use crate::complementarity::mpec::program::evaluation::ProgramEvaluation;
use crate::complementarity::mpec::program::problem::Problem;
use crate::complementarity::mpec::quadratic_program::driver::StepSolver;
use crate::complementarity::mpec::result::Growth;
use crate::complementarity::mpec::settings::Settings;
use crate::complementarity::mpec::smooth_program::relaxation::SmoothProgramRows;
use crate::complementarity::mpec::smooth_program::sqp::{self, SqpEnd, SqpSettings};
use crate::resources::cancel::CancelFlag;

/// What growing a variable by itself gains, over the size of the objective, that is worth a look.
const GAINS: f64 = 1e-6;
/// Variables that are looked at, those that gain most.
const MOST_VARIABLES: usize = 3;
/// Multiples of a variable at which the branch is solved again: powers of this, so many of them at the most and at the least.
const MULTIPLE: f64 = 10.0;
const MOST_MULTIPLES: usize = 12;
const FEWEST: usize = 3;
/// Part of the size of the objective that is its rounding.
const ROUNDING: f64 = 1e-13;

/// The variable along which the objective falls on and on from a point that passes for a solution.
pub fn without_end<P: Problem + ?Sized>(
    problem: &P,
    bounds: &(DVector<f64>, DVector<f64>),
    candidate: &CandidatePoint,
    settings: &Settings,
    steps: &mut StepSolver,
    cancel: &CancelFlag,
) -> Option<Growth> {
    let x = &candidate.x;
    let mut at = ProgramEvaluation::new(problem);
    at.update_values(problem, x).ok()?;
    at.update_derivatives(problem, x).ok()?;
    let gain = gains(&at, candidate);
    let of_variables: f64 = at.gradient.iter().zip(x.iter()).map(|(slope, value)| (slope * value).abs()).sum();
    let size = at.objective.abs() + of_variables;
    let mut growing: Vec<usize> = (0..x.len()).filter(|&j| gain[j] > GAINS * size).collect();
    growing.sort_by(|a, b| gain[*b].total_cmp(&gain[*a]).then(a.cmp(b)));
    let pattern = piecewise_descent::nearest_pattern(&at);
    let rows = SmoothProgramRows::new(problem.equalities(), problem.inequalities(), &problem.cone_sizes(), pattern);
    let (tolerance, iteration_limit) = (settings.tolerance, settings.iteration_limit);
    let sequence = SqpSettings { tolerance, iteration_limit, stop_when_settled: false };
    growing.into_iter().take(MOST_VARIABLES).find_map(|variable| {
        let (from, mut start, mut least) = (x[variable], x.clone(), at.objective);
        let mut falls = 0;
        while falls < MOST_MULTIPLES {
            let to = MULTIPLE * start[variable];
            if !(bounds.0[variable]..=bounds.1[variable]).contains(&to) {
                return None;
            }
            let mut held = bounds.clone();
            (held.0[variable], held.1[variable]) = (to, to);
            let outcome = sqp::solve(problem, &rows, &held, &start, sequence, steps, cancel);
            let is_point = matches!(outcome.end, SqpEnd::Converged | SqpEnd::Stalled | SqpEnd::IterationLimit)
                && rows.violation(&outcome.at) <= tolerance;
            let change = outcome.at.objective - least;
            if !is_point || change.abs() <= ROUNDING * size {
                break;
            }
            if change > 0.0 {
                return None;
            }
            (least, start) = (outcome.at.objective, outcome.x);
            falls += 1;
        }
        (falls >= FEWEST).then(|| Growth { variable, from, to: start[variable] })
    })
}

/// What growing each variable by itself gains at first order: `-r_j x_j`, `r` the gradient of the Lagrangian.
fn gains(at: &ProgramEvaluation, candidate: &CandidatePoint) -> DVector<f64> {
    let multipliers = &candidate.multipliers;
    let mut rest = at.gradient.clone();
    rest -= at.equality_jacobian.tr_mul(&multipliers.equality);
    rest -= at.inequality_jacobian.tr_mul(&multipliers.inequality);
    rest -= at.first_jacobian.tr_mul(&multipliers.first);
    rest -= at.second_jacobian.tr_mul(&multipliers.second);
    rest -= at.cones.first_jacobian.tr_mul(&multipliers.cone_first);
    rest -= at.cones.second_jacobian.tr_mul(&multipliers.cone_second);
    rest += &multipliers.upper - &multipliers.lower;
    -rest.component_mul(&candidate.x)
}
