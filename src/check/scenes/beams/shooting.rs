//! Newton's method for boundary value problems that are solved by shooting, and folds of their solutions.

use nalgebra::{DMatrix, DVector};

/// Largest number of iterations.
const ITERATIONS: usize = 60;
/// Step of the differences that give the matrix of Newton's method.
const DIFFERENCE: f64 = 1e-6;
/// Step of the differences of sixth order that give the equation of a fold.
const LONG_DIFFERENCE: f64 = 0.01;
/// Newton's method has converged when a change is below this, relative to the unknowns.
const CONVERGED: f64 = 1e-12;

/// The zero of as many residuals as unknowns, from a start near it; `None` if Newton's method does not converge.
pub fn shoot(start: &[f64], residual: impl Fn(&[f64]) -> Vec<f64>) -> Option<Vec<f64>> {
    let mut at = DVector::from_column_slice(start);
    let mut converged = false;
    for _ in 0..ITERATIONS {
        let value = DVector::from_vec(residual(at.as_slice()));
        let change = jacobian(at.as_slice(), &residual).lu().solve(&value)?;
        at -= &change;
        let size = change.amax() / (1.0 + at.amax());
        if !size.is_finite() {
            return None;
        }
        // One more iteration takes away what the differences' matrix has left.
        if converged {
            return Some(at.as_slice().to_vec());
        }
        converged = size < CONVERGED;
    }
    None
}

/// The fold near a start: where a parameter, the last of the unknowns, has an extremum along the solutions of the
/// residuals, one fewer than the unknowns.
pub fn fold(start: &[f64], residual: impl Fn(&[f64]) -> Vec<f64>) -> Option<Vec<f64>> {
    let (_, free) = start.split_last()?;
    let count = free.len();
    let along_path = jacobian(start, &residual).columns(0, count).into_owned();
    let svd = along_path.svd(false, true);
    let direction = svd.v_t?.row(count - 1).transpose();
    let mut unknowns = start.to_vec();
    unknowns.extend(direction.iter());
    let extended = |unknowns: &[f64]| {
        let (point, tangent) = unknowns.split_at(count + 1);
        let mut values = residual(point);
        values.extend(derivative_along(point, tangent, &residual));
        values.push(tangent.iter().zip(direction.iter()).map(|(a, b)| a * b).sum::<f64>() - 1.0);
        values
    };
    let mut found = shoot(&unknowns, extended)?;
    found.truncate(count + 1);
    Some(found)
}

/// The derivative of the residuals along a direction of all unknowns but the last, by differences of sixth order.
fn derivative_along(point: &[f64], direction: &[f64], residual: impl Fn(&[f64]) -> Vec<f64>) -> Vec<f64> {
    let at = |step: f64| {
        let mut moved = point.to_vec();
        moved.iter_mut().zip(direction).for_each(|(value, part)| *value += step * LONG_DIFFERENCE * part);
        DVector::from_vec(residual(&moved))
    };
    let pair = |step: f64| at(step) - at(-step);
    let sum = pair(1.0) * 45.0 - pair(2.0) * 9.0 + pair(3.0);
    (sum / (60.0 * LONG_DIFFERENCE)).as_slice().to_vec()
}

fn jacobian(at: &[f64], residual: &impl Fn(&[f64]) -> Vec<f64>) -> DMatrix<f64> {
    let columns: Vec<DVector<f64>> = (0..at.len())
        .map(|k| {
            let moved = |step: f64| {
                let mut moved = at.to_vec();
                moved[k] += step;
                DVector::from_vec(residual(&moved))
            };
            let step = DIFFERENCE * (1.0 + at[k].abs());
            (moved(step) - moved(-step)) / (2.0 * step)
        })
        .collect();
    DMatrix::from_columns(&columns)
}
