//! Examines single combinations of options: solves for the exact line of each and finds the rays on this line.

use crate::complementarity::rate_search::branch_and_bound::{BranchAndBound, Ray};
use crate::complementarity::rate_search::tolerances::RAY_DISTANCE;
use crate::complementarity::rates::cartesian_product::{combinations, count};
use crate::complementarity::rates::ray_of_combination;
use crate::complementarity::rates::ray_of_combination::{Along, Line};
use nalgebra::DVector;

/// Largest number of combinations of options in doubt tried on one line, in addition to those suggested by violations.
const MOST_LABELS: u64 = 64;
/// Largest number of stored bases of solution sets of more than one dimension.
const MOST_PLANES: usize = 256;

/// The result of the examination of one combination.
pub(crate) enum Examined {
    /// Feasible in one sense or both.
    Rays,
    /// One line without a ray, and the entities violated in the sense with fewer violations.
    Violated(Vec<usize>),
    /// No line, or more than one.
    Nothing,
    /// Examined before.
    Before,
}

pub(crate) fn examine(search: &mut BranchAndBound<'_>, chosen: &[usize]) -> Examined {
    if !search.seen.insert(chosen.to_vec()) {
        return Examined::Before;
    }
    search.held.add::<usize>(chosen.len());
    // An elimination with complete pivoting: search of the pivot, exchange, update.
    let weights = search.problem.weights() as u64;
    search.count(weights.saturating_pow(3));
    match ray_of_combination::line(search.problem, chosen) {
        Line::Nothing => Examined::Nothing,
        Line::Along(weights) => {
            let along = ray_of_combination::forms_along(search.problem, &weights);
            let second = along.violated(chosen);
            let along = along.reversed();
            let first = along.violated(chosen);
            let is_ray = first.is_empty() || second.is_empty();
            if first.is_empty() {
                keep(search, chosen, -&weights, &along);
            }
            if second.is_empty() {
                keep(search, chosen, weights, &along.reversed());
            }
            match is_ray {
                true => Examined::Rays,
                false if first.len() < second.len() => Examined::Violated(first),
                false => Examined::Violated(second),
            }
        }
        Line::Plane(basis) => {
            search.findings.degenerate = true;
            for weights in ray_of_combination::edges(search.problem, chosen, &basis) {
                let along = ray_of_combination::forms_along(search.problem, &weights);
                keep(search, chosen, weights, &along);
            }
            if search.findings.planes.len() < MOST_PLANES {
                search.held.add::<f64>(basis.len());
                search.findings.planes.push(basis);
            }
            Examined::Nothing
        }
        Line::Still | Line::NotFinite => {
            search.findings.degenerate = true;
            Examined::Nothing
        }
    }
}

fn keep(search: &mut BranchAndBound<'_>, chosen: &[usize], weights: DVector<f64>, along: &Along<'_>) {
    let size = weights.amax();
    let is_same = |ray: &Ray| {
        (&ray.weights - &weights).amax() <= RAY_DISTANCE * size
            && ray_of_combination::forms_along(search.problem, &ray.weights).has_forces_of(along)
    };
    if !search.findings.rays.iter().any(is_same) {
        let fitting = along.fitting(chosen);
        let weak = along.is_weak(&fitting);
        // Two lists for each entity.
        search.held.add::<f64>(weights.len() + 8 * chosen.len());
        let in_doubt = along.in_doubt(chosen);
        search.findings.rays.push(Ray { weights, fitting, in_doubt, weak });
    }
}

/// Examines the combinations of the given options of each entity, which all fit one line, with held options first.
///
/// Where many options are in doubt there are too many combinations to try: the options of the violated entities are
/// changed until a combination is feasible.
pub(crate) fn examine_all(search: &mut BranchAndBound<'_>, options: &[Vec<usize>]) {
    let mut places = vec![0; options.len()];
    let mut settled = false;
    for _ in 0..MOST_LABELS as usize + options.len() {
        let chosen: Vec<usize> = options.iter().zip(&places).map(|(options, &place)| options[place]).collect();
        settled |= search.findings.rays.iter().any(|ray| ray.is_under(&chosen));
        match examine(search, &chosen) {
            Examined::Violated(violated) => {
                // A violated entity without another option refutes all combinations.
                settled |= violated.iter().any(|&entity| options[entity].len() == 1);
                if settled {
                    break;
                }
                violated.iter().for_each(|&entity| places[entity] = (places[entity] + 1) % options[entity].len());
            }
            Examined::Rays => {
                settled = true;
                break;
            }
            Examined::Nothing | Examined::Before => break,
        }
    }
    let total = count(options);
    for chosen in combinations(options, MOST_LABELS) {
        let known = search.findings.rays.iter().find(|ray| ray.is_under(&chosen));
        match known.map(|ray| -&ray.weights) {
            None => settled |= matches!(examine(search, &chosen), Examined::Rays),
            // The line is the known one; its other sense may be feasible under this combination only.
            Some(reversed) => {
                let along = ray_of_combination::forms_along(search.problem, &reversed);
                if along.violated(&chosen).is_empty() {
                    keep(search, &chosen, reversed, &along);
                }
            }
        }
    }
    if total > MOST_LABELS && !settled {
        search.findings.unexplored = search.findings.unexplored.saturating_add(total - MOST_LABELS);
    }
}
