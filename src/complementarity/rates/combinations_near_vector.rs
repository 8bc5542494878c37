//! Combinations suggested by a known vector of weights, such as the incoming direction of the path.

use crate::complementarity::rates::cartesian_product::combinations;
use crate::complementarity::rates::rate_problem::{Choice, RateProblem};
use crate::complementarity::rates::tolerances::MISFIT_TIE;
use nalgebra::DVector;

/// Largest number of combinations returned.
const MOST: u64 = 64;

/// The combinations whose options fit the weights, best first; a limited number.
pub fn near(problem: &RateProblem, weights: &DVector<f64>) -> Vec<Vec<usize>> {
    let values = &problem.forms * weights;
    let largest = |force: bool| {
        let of_kind = values.iter().zip(&problem.is_force).filter(|(_, is_force)| **is_force == force);
        of_kind.fold(f64::MIN_POSITIVE, |largest, (value, _)| largest.max(value.abs()))
    };
    let sizes = [largest(false), largest(true)];
    let relative = |form: usize| values[form] / sizes[usize::from(problem.is_force[form])];
    let misfit = |choice: &Choice| {
        let zero = choice.zero.iter().map(|form| relative(*form).abs());
        let negative = choice.nonnegative.iter().map(|signed| -signed.sign * relative(signed.form));
        zero.chain(negative).fold(0.0, f64::max)
    };
    let options: Vec<Vec<usize>> = problem
        .entities
        .iter()
        .map(|entity| {
            let mut order: Vec<(f64, usize)> =
                entity.options.iter().enumerate().map(|(index, choice)| (misfit(choice), index)).collect();
            order.sort_by(|a, b| a.0.total_cmp(&b.0).then(a.1.cmp(&b.1)));
            let least = order.first().map_or(0.0, |(least, _)| *least);
            order.into_iter().filter(|(misfit, _)| *misfit <= least + MISFIT_TIE).map(|(_, index)| index).collect()
        })
        .collect();
    combinations(&options, MOST).collect()
}
