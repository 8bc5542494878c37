//! Detection of apparent solutions that belong to iterates tending to infinity.
//!
//! Where an infimum is not attained, the Karush-Kuhn-Tucker conditions hold ever more closely as some variable grows,
//! finally to any tolerance, although there is no solution. At a solution, a relative increase of any variable gains
//! nothing at first order: with the gradient `r` of the Lagrangian, `r_j x_j` is negligible compared with the
//! objective. Where it is not negligible, the branch is solved again with this variable fixed at ten, a hundred, a
//! thousand times its value and so on. If the optimum rises anywhere, there is a solution, near or far. If the optimum
//! falls as far as rounding allows, and at least up to a thousand times the value, there is none: the iterates are
//! unbounded. Only ratios of like quantities are used, so the result is independent of units.

use crate::complementarity::mpec::tolerances::{EXAMINED_GAIN, GROWTH_FACTOR, OBJECTIVE_ROUND_OFF};
use nalgebra::DVector;

use crate::complementarity::mpec::piecewise_descent::{self, CandidatePoint};
use crate::complementarity::mpec::program::evaluation::ProgramEvaluation;
use crate::complementarity::mpec::program::problem::Problem;
use crate::complementarity::mpec::quadratic_program::driver::StepSolver;
use crate::complementarity::mpec::result::Growth;
use crate::complementarity::mpec::settings::Settings;
use crate::complementarity::mpec::smooth_program::smooth_rows::SmoothProgramRows;
use crate::complementarity::mpec::smooth_program::sqp::{self, SqpEnd, SqpSettings};
use crate::resources::cancel::CancelFlag;

/// Number of variables examined, those with the largest gain.
const MOST_VARIABLES: usize = 3;
/// Largest number of multiples of a variable at which the branch is solved again.
const MOST_MULTIPLES: usize = 12;
/// Smallest number of multiples, each with a smaller objective, that shows unboundedness.
const FEWEST: usize = 3;

/// The variable along which the objective falls without end from an apparent solution; `None` where there is none.
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
    let mut growing: Vec<usize> = (0..x.len()).filter(|&j| gain[j] > EXAMINED_GAIN * size).collect();
    growing.sort_by(|a, b| gain[*b].total_cmp(&gain[*a]).then(a.cmp(b)));
    let pattern = piecewise_descent::nearest_pattern(&at);
    let rows = SmoothProgramRows::new(problem.equalities(), problem.inequalities(), &problem.cone_sizes(), pattern);
    let (tolerance, iteration_limit) = (settings.tolerance, settings.iteration_limit);
    let sequence = SqpSettings { tolerance, iteration_limit, stop_when_settled: false };
    growing.into_iter().take(MOST_VARIABLES).find_map(|variable| {
        let (from, mut start, mut least) = (x[variable], x.clone(), at.objective);
        let mut falls = 0;
        while falls < MOST_MULTIPLES {
            let to = GROWTH_FACTOR * start[variable];
            if !(bounds.0[variable]..=bounds.1[variable]).contains(&to) {
                return None;
            }
            let mut held = bounds.clone();
            (held.0[variable], held.1[variable]) = (to, to);
            let outcome = sqp::solve(problem, &rows, &held, &start, sequence, steps, cancel);
            let is_point = matches!(outcome.end, SqpEnd::Converged | SqpEnd::Stalled | SqpEnd::IterationLimit)
                && rows.violation(&outcome.at) <= tolerance;
            let change = outcome.at.objective - least;
            if !is_point || change.abs() <= OBJECTIVE_ROUND_OFF * size {
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

/// The first-order gain by a relative increase of each variable: `-r_j x_j`, with `r` the gradient of the Lagrangian.
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
