//! Cases without branching: a certificate for the whole problem or for the rest of it at a node, and signs of the load
//! rate settled by a known ray.

use crate::complementarity::rate_search::branch_and_bound::{BranchAndBound, Ray, SearchNode};
use crate::complementarity::rate_search::single_combination;
use crate::complementarity::rate_search::tolerances::SEARCH_TOLERANCE;
use crate::complementarity::rates::p_matrix::{is_monotone, options_of, reduce};
use crate::complementarity::rates::parametric_lcp::all_solutions;
use crate::complementarity::rates::rate_problem::{Entity, Signed};
use crate::resources::budget;
use nalgebra::DMatrix;

/// Applies the certificate to the whole problem; returns whether it succeeds.
pub(crate) fn certified_at_once(search: &mut BranchAndBound<'_>) -> bool {
    if !search.effort.certify {
        return false;
    }
    let Some(pairs) = search.problem.entities.iter().map(Entity::pair).collect::<Option<Vec<_>>>() else {
        return false;
    };
    let _held = budget::take::<f64>(2 * pairs.len() * search.problem.weights());
    let (a, b, load) = coordinates(search, &pairs);
    let open: Vec<usize> = (0..pairs.len()).collect();
    let chosen = vec![None; pairs.len()];
    let certified = examine_certified(search, a, b, &load, &open, &chosen, &[1.0, -1.0]);
    search.findings.certified = certified == Some(true);
    certified.is_some()
}

/// The coefficients of forces, velocities and load rate over weights scaled to unit motion.
fn coordinates(search: &BranchAndBound<'_>, pairs: &[[Signed; 2]]) -> (DMatrix<f64>, DMatrix<f64>, Vec<f64>) {
    let problem = search.problem;
    budget::spend(2 * pairs.len() * problem.weights());
    let scales: Vec<f64> = problem.sizes.iter().map(|size| 1.0 / size).collect();
    let rows = |side: usize| {
        DMatrix::from_fn(pairs.len(), scales.len(), |row, column| {
            pairs[row][side].sign * problem.forms[(pairs[row][side].form, column)] * scales[column]
        })
    };
    let load = problem.load.iter().zip(&scales).map(|(a, b)| a * b).collect();
    (rows(0), rows(1), load)
}

/// Signs of the load rate for which the problem is monotone and a known ray is therefore unique.
pub(crate) fn settled_signs(search: &BranchAndBound<'_>) -> Vec<f64> {
    let conjugates: Option<Vec<_>> = search.problem.entities.iter().map(Entity::conjugates).collect();
    let Some(conjugates) = conjugates else { return Vec::new() };
    let mut bounds = Vec::new();
    let mut next = 0;
    for (entity, pairs) in search.problem.entities.iter().zip(&conjugates) {
        bounds.extend(entity.touching.map(|_| next));
        next += pairs.len();
    }
    let _held = budget::take::<f64>(2 * next * search.problem.weights());
    let (a, b, load) = coordinates(search, &conjugates.concat());
    let Some((matrix, _)) = reduce(&a, &b, &load) else { return Vec::new() };
    if !is_monotone(&matrix, &bounds) {
        return Vec::new();
    }
    let load_of = |ray: &Ray| (&search.problem.load * &ray.weights)[0];
    let strict = |sign: f64| search.findings.rays.iter().any(|ray| !ray.weak && sign * load_of(ray) > SEARCH_TOLERANCE);
    [1.0, -1.0].into_iter().filter(|sign| strict(*sign)).collect()
}

/// Examines the combination for each given load rate, if it is certified to be unique, or else a list of combinations
/// that contains all rays. Returns whether each load rate has exactly one ray; `None` where neither is certain.
fn examine_certified(
    search: &mut BranchAndBound<'_>,
    a: DMatrix<f64>,
    b: DMatrix<f64>,
    load: &[f64],
    open: &[usize],
    chosen: &[Option<usize>],
    signs: &[f64],
) -> Option<bool> {
    let (matrix, constant) = reduce(&a, &b, load)?;
    let (is_p, solutions) = all_solutions(matrix, constant, signs)?;
    for pairs in solutions {
        let mut options: Vec<Vec<usize>> = chosen.iter().map(|choice| choice.iter().copied().collect()).collect();
        for (&entity, fitting) in open.iter().zip(options_of(&pairs)) {
            options[entity] = fitting;
        }
        single_combination::examine_all(search, &options);
    }
    Some(is_p)
}

/// Applies the certificate to the undecided entities at a node; returns whether it succeeds.
pub(crate) fn certified_below(search: &mut BranchAndBound<'_>, node: &SearchNode, open: &[usize]) -> bool {
    let dictionary = &node.dictionary;
    if !search.effort.certify
        || dictionary.is_lines_only()
        || dictionary.lines() > 0
        || dictionary.dimension() != open.len()
        || node.in_set
    {
        return false;
    }
    let pairs = open.iter().map(|&entity| search.problem.entities[entity].pair());
    let Some(pairs) = pairs.collect::<Option<Vec<_>>>() else { return false };
    let _held = budget::take::<f64>(2 * pairs.len() * (pairs.len() + 1));
    let rows = |side: usize| {
        let mut rows = DMatrix::zeros(pairs.len(), pairs.len() + 1);
        for (row, pair) in pairs.iter().enumerate() {
            rows.row_mut(row).copy_from_slice(&dictionary.coefficients(Some(pair[side].form), pair[side].sign));
        }
        rows
    };
    let load = dictionary.coefficients(None, 1.0);
    examine_certified(search, rows(0), rows(1), &load, open, &node.chosen, &[node.sign]).is_some()
}
