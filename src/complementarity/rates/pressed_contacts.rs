//! Guesses where the search was cut short: the contacts that are pressed where there is no friction.
//!
//! Hundreds of contacts may touch without force, as along a flat stretch of a beam on a floor, and few of them be pressed
//! by the load. Without tractions the slips follow from the normal velocities `ġ` and the load rate `τ`, and what is left
//! is a linear complementarity problem in the normal directions:
//!
//! ```text
//! v_t = -A_tt⁻¹ (A_tn ġ + b_t τ)
//! ṙ_n = (A_nn - A_nt A_tt⁻¹ A_tn) ġ + (b_n - A_nt A_tt⁻¹ b_t) τ,      0 <= ṙ_n ⊥ ġ >= 0
//! ```
//!
//! Lemke's method solves it (R. W. Cottle, J.-S. Pang, R. E. Stone, *The Linear Complementarity Problem*, 1992, section
//! 4.4). With friction, the pressed contacts may stick or slip either way: each combination is a guess, which is examined
//! exactly like any other.

use crate::algebra::Factorisation;
use crate::complementarity::rates::cartesian_product::combinations;
use crate::complementarity::rates::gauss_seidel::{Local, rising};
use crate::complementarity::rates::lemke::{self, LemkeTableau};
use crate::complementarity::rates::rate_problem::RateProblem;
use crate::resources::budget;
use crate::resources::cancel::CancelFlag;
use nalgebra::{DMatrix, DVector};

/// Largest number of pressed contacts whose modes are all tried, 81 combinations for each sign of the load rate.
const MOST_PRESSED: usize = 4;

/// A force, and the weight that is its velocity.
type Conjugate = (usize, usize);

/// The guesses for both signs of the load rate; none where the entities are not plain contacts, where none has friction, or
/// where many contacts are pressed or all.
pub fn guesses(problem: &RateProblem, cancel: &CancelFlag) -> Vec<Vec<usize>> {
    let locals: Option<Vec<Local>> = problem.entities.iter().map(|entity| Local::of(problem, entity)).collect();
    let (Some(locals), Some(rising)) = (locals, rising(problem)) else { return Vec::new() };
    let Some((stiffness, load)) = without_tractions(problem, &locals) else { return Vec::new() };
    let mut left = lemke::WORK;
    let mut guesses = Vec::new();
    for sign in [1.0, -1.0] {
        let constant: Vec<f64> = load.iter().map(|value| value * sign * rising).collect();
        let mut covers = lemke::covers(&constant).into_iter();
        let opens = covers.find_map(|cover| {
            let is_asked = !cancel.is_cancelled();
            is_asked.then(|| LemkeTableau::new(&stiffness, &constant, &cover).solve(&mut left)).flatten()
        });
        guesses.extend(opens.map(|opens| of_pressed(&locals, &opens)).unwrap_or_default());
    }
    guesses
}

/// The matrix of the complementarity problem and its load, with velocities scaled to unit motion and rows to unit maximum
/// norm; `None` where no contact has friction, or the slips are not determined.
fn without_tractions(problem: &RateProblem, locals: &[Local]) -> Option<(DMatrix<f64>, DVector<f64>)> {
    let normals: Vec<Conjugate> = locals.iter().map(normal_of).collect();
    let tangents: Vec<Conjugate> = locals.iter().filter_map(tangent_of).collect();
    if tangents.is_empty() {
        return None;
    }
    let (count, slips) = (normals.len(), tangents.len());
    let _held = budget::take::<f64>(2 * (count + slips) * (count + slips + 1));
    let last = problem.weights() - 1;
    let part = |rows: &[Conjugate], columns: &[Conjugate]| {
        budget::spend(rows.len() * columns.len());
        DMatrix::from_fn(rows.len(), columns.len(), |row, column| {
            let weight = columns[column].1;
            problem.forms[(rows[row].0, weight)] / problem.sizes[weight].max(f64::MIN_POSITIVE)
        })
    };
    let mut columns = normals.clone();
    columns.push((0, last));
    let by_slips = Factorisation::new(part(&tangents, &tangents))?;
    let (normal_by_slip, tangential) = (part(&normals, &tangents), part(&tangents, &columns));
    let mut forces = part(&normals, &columns);
    for (column, mut values) in forces.column_iter_mut().enumerate() {
        let mut slip = tangential.column(column).into_owned();
        if !by_slips.solve(&mut slip) {
            return None;
        }
        budget::spend(count * slips);
        values -= &normal_by_slip * slip;
    }
    for mut row in forces.row_iter_mut() {
        let size = row.amax();
        if size > 0.0 {
            row /= size;
        }
    }
    let load = forces.column(count).into_owned();
    Some((forces.remove_column(count), load))
}

fn normal_of(local: &Local) -> Conjugate {
    match *local {
        Local::Pair { force, velocity } => (force, velocity),
        Local::Touching { forms, normal, .. } => (forms.pressing, normal),
    }
}

fn tangent_of(local: &Local) -> Option<Conjugate> {
    match *local {
        Local::Pair { .. } => None,
        Local::Touching { forms, tangential, .. } => Some((forms.traction, tangential)),
    }
}

/// The combinations in which the contacts that do not open stick or slip.
fn of_pressed(locals: &[Local], opens: &[bool]) -> Vec<Vec<usize>> {
    let options: Vec<Vec<usize>> = locals
        .iter()
        .zip(opens)
        .map(|(local, opens)| match (local, opens) {
            (Local::Pair { .. }, opens) => vec![usize::from(*opens)],
            // In the order of `Entity::touching`.
            (Local::Touching { .. }, true) => vec![3],
            (Local::Touching { .. }, false) => vec![0, 1, 2],
        })
        .collect();
    let pressed = options.iter().filter(|options| options.len() > 1).count();
    if pressed > MOST_PRESSED || !opens.contains(&true) {
        Vec::new()
    } else {
        combinations(&options, u64::MAX).collect()
    }
}
