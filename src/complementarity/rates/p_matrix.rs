//! A cheap sufficient test that each sign of the load rate has exactly one ray, and these rays.
//!
//! Where only complementary pairs `0 <= a ⊥ b >= 0` are undecided, and `b` and the load rate are coordinates,
//!
//! ```text
//! a = M b + q ṡ
//! ```
//!
//! is a linear complementarity problem for `ṡ = 1` and another for `ṡ = -1`. Each has exactly one solution if (and, for
//! all `q`, only if) `M` is a P-matrix (Cottle, Pang, Stone, theorem 3.3.7); for `ṡ = 0` the solution is `b = 0`, no
//! motion. `M` is a P-matrix when its symmetric part is positive definite (`bᵀ M b > 0` for the difference `b` of two
//! solutions contradicts complementarity), or when its diagonal is positive and its comparison matrix (`|M_ii|` on,
//! `-|M_ij|` off the diagonal) maps a positive vector to a positive vector (theorem 3.3.15: an H-matrix with positive
//! diagonal). Rows and columns may be scaled by positive numbers first: signs and complementarity do not change. For
//! friction, `b` are slip velocities and `a` the rates at which the tractions retreat from the cone: `M` is the
//! stiffness against slip (A. Klarbring, Ing. Arch. 60 (1990) 529). Nothing is claimed where the tests fail.
//!
//! The solution is found by block principal pivoting with a safeguard (L. F. Portugal, J. J. Júdice, L. N. Vicente,
//! Math. Comp. 63 (1994) 625, doi:10.1090/S0025-5718-1994-1250776-4; the safeguard is K. G. Murty's least-index method,
//! finite for P-matrices).

use crate::algebra::Factorisation;
use crate::complementarity::rates::tolerances::{
    DEFINITENESS_MARGIN, RELATIVE_ROUND_OFF, SMALLEST_VALUE_SCALE, VANISHING_FORM, VANISHING_VALUE,
};
use crate::resources::budget::{self, Taken};
use nalgebra::{DMatrix, DVector};

/// Rounds without progress before the least-index method takes over.
const PATIENCE: usize = 8;

/// The problem `a = M b + q ṡ` with a P-matrix `M`.
pub struct Certified {
    matrix: DMatrix<f64>,
    load: DVector<f64>,
}

/// The values `a` and `b` of each pair.
pub type Pairs = Vec<[f64; 2]>;

/// Brings rows of coefficients `(a, b, load rate)` over `k + 1` coordinates to the form `a = M b + q ṡ`; `None` where
/// `b` and the load rate are not coordinates.
pub fn reduce(a: &DMatrix<f64>, b: &DMatrix<f64>, load: &[f64]) -> Option<(DMatrix<f64>, DVector<f64>)> {
    let count = b.nrows();
    if b.ncols() != count + 1 || load.len() != count + 1 {
        return None;
    }
    let _coordinates = budget::take::<f64>((count + 1) * (count + 1));
    let mut coordinates = DMatrix::zeros(count + 1, count + 1);
    coordinates.rows_mut(0, count).copy_from(b);
    coordinates.row_mut(count).copy_from_slice(load);
    // The forms have unit size: the entries of a vanishing form are round-off.
    if coordinates.row_iter().any(|row| row.amax() <= VANISHING_FORM) {
        return None;
    }
    let factorisation = Factorisation::new(coordinates)?;
    let _held = budget::take::<f64>(2 * count * count);
    let mut product = DMatrix::zeros(count, count + 1);
    for column in 0..=count {
        budget::spend(count * count);
        let mut unit = DVector::zeros(count + 1);
        unit[column] = 1.0;
        if !factorisation.solve(&mut unit) {
            return None;
        }
        product.set_column(column, &(a * unit));
    }
    let load = product.column(count).into_owned();
    Some((product.columns(0, count).into_owned(), load))
}

impl Certified {
    /// Tests whether the matrix is a P-matrix; `None` where neither test succeeds.
    pub fn new(mut matrix: DMatrix<f64>, mut load: DVector<f64>) -> Option<Self> {
        let scales = scales(&matrix, |row| load[row].abs())?;
        scale(&mut matrix, &scales);
        load.component_mul_assign(&scales);
        is_p_matrix(&matrix).then_some(Self { matrix, load })
    }

    /// The unique solution for a load rate.
    pub fn solve(&self, load_rate: f64) -> Option<Pairs> {
        let constant = &self.load * load_rate;
        solve_complementarity(&self.matrix, &constant)
    }
}

/// Whether `a = M b + q ṡ` is monotone with bounds of friction that do not depend on `b`: symmetric part positive
/// semidefinite to round-off, and no entry in the rows of pressing forces that bound friction.
///
/// For a given `ṡ` the contacts' rate problem is then a monotone variational inequality on a fixed polyhedron, and its
/// solutions form a convex set (D. Kinderlehrer and G. Stampacchia, *An Introduction to Variational Inequalities*,
/// 1980, chapter III): an isolated solution, with every inequality strict and regular equations, is unique.
pub fn is_monotone(matrix: &DMatrix<f64>, bounds: &[usize]) -> bool {
    let size = matrix.amax();
    if !size.is_finite() || bounds.iter().any(|&row| matrix.row(row).amax() > RELATIVE_ROUND_OFF * size) {
        return false;
    }
    let mut symmetric = (matrix + matrix.transpose()) * 0.5;
    for index in 0..symmetric.nrows() {
        symmetric[(index, index)] += RELATIVE_ROUND_OFF * size;
    }
    size == 0.0 || has_cholesky(&symmetric, 0.0)
}

/// Scale factors of rows and columns that make every diagonal entry 1: a congruence, which preserves definiteness.
/// `None` where a diagonal entry does not exceed the round-off of its row, or of the further terms `beside` it.
pub(crate) fn scales(matrix: &DMatrix<f64>, beside: impl Fn(usize) -> f64) -> Option<DVector<f64>> {
    let mut sizes = vec![0.0_f64; matrix.nrows()];
    for column in matrix.column_iter() {
        sizes.iter_mut().zip(column.iter()).for_each(|(size, value)| *size = size.max(value.abs()));
    }
    let is_positive = |(row, size): (usize, &f64)| {
        let diagonal = matrix[(row, row)];
        diagonal.is_finite()
            && diagonal > 0.0
            && diagonal > DEFINITENESS_MARGIN * size
            && diagonal > RELATIVE_ROUND_OFF * beside(row)
    };
    let all = sizes.iter().enumerate().all(is_positive);
    all.then(|| matrix.diagonal().map(|diagonal| 1.0 / diagonal.sqrt()))
}

pub(crate) fn scale(matrix: &mut DMatrix<f64>, scales: &DVector<f64>) {
    for (mut column, scale) in matrix.column_iter_mut().zip(scales.iter()) {
        column.iter_mut().zip(scales.iter()).for_each(|(value, own)| *value *= own * scale);
    }
}

/// Whether one of the tests succeeds for a matrix whose diagonal is 1.
pub(crate) fn is_p_matrix(matrix: &DMatrix<f64>) -> bool {
    is_positive_definite(matrix) || is_dominant(matrix)
}

/// Whether the symmetric part of any square matrix is positive definite, beyond round-off.
pub fn is_definite(mut matrix: DMatrix<f64>) -> bool {
    let Some(scales) = scales(&matrix, |_| 0.0) else { return false };
    scale(&mut matrix, &scales);
    is_positive_definite(&matrix)
}

/// Whether the symmetric part is positive definite, with a margin: by a Cholesky factorisation within the profile, so
/// that a matrix with a narrow band costs no more than its band (A. Jennings, Comput. J. 9 (1966) 281,
/// doi:10.1093/comjnl/9.3.281).
fn is_positive_definite(matrix: &DMatrix<f64>) -> bool {
    let size = matrix.amax();
    size.is_finite() && has_cholesky(matrix, DEFINITENESS_MARGIN * size)
}

/// Whether the Cholesky factorisation of the symmetric part exists with `margin` subtracted from every pivot.
fn has_cholesky(matrix: &DMatrix<f64>, margin: f64) -> bool {
    let count = matrix.nrows();
    let mut held = Taken::default();
    let mut factor: Vec<f64> = Vec::with_capacity(count);
    // First column of each row, and its place in the factor.
    let mut rows: Vec<(usize, usize)> = Vec::with_capacity(count);
    let entry = |row: usize, column: usize| 0.5 * (matrix[(row, column)] + matrix[(column, row)]);
    for row in 0..count {
        let first = (0..row).find(|&column| entry(row, column) != 0.0).unwrap_or(row);
        let start = factor.len();
        held.add::<f64>(row + 1 - first);
        budget::spend((row + 1 - first) * (row + 1 - first) / 2);
        rows.push((first, start));
        for column in first..=row {
            let (other, place) = rows[column];
            let from = first.max(other);
            let own = &factor[start + from - first..start + column - first];
            let before = if column == row { own } else { &factor[place + from - other..place + column - other] };
            let sum: f64 = own.iter().zip(before).map(|(a, b)| a * b).sum();
            let value = entry(row, column) - sum;
            if column < row {
                let pivot = factor[place + column - other];
                factor.push(value / pivot);
            } else if value > margin {
                factor.push((value - margin).sqrt());
            } else {
                return false;
            }
        }
    }
    true
}

/// Whether the comparison matrix maps some positive vector to a positive vector.
fn is_dominant(matrix: &DMatrix<f64>) -> bool {
    let mut comparison = matrix.map(|value| -value.abs());
    comparison.fill_diagonal(0.0);
    comparison += DMatrix::from_diagonal(&matrix.diagonal().map(f64::abs));
    let Some(factorisation) = Factorisation::new(comparison.clone()) else { return false };
    let mut vector = DVector::from_element(matrix.nrows(), 1.0);
    if !factorisation.solve(&mut vector) || vector.iter().any(|value| *value <= 0.0) {
        return false;
    }
    (comparison * vector).iter().all(|value| *value > 0.5)
}

/// Solves `a = M b + q`, `0 <= a ⊥ b >= 0` by block principal pivoting; `None` where the iteration does not end.
pub fn solve_complementarity(matrix: &DMatrix<f64>, constant: &DVector<f64>) -> Option<Pairs> {
    let count = constant.len();
    let mut active = vec![false; count];
    let mut fewest = count + 1;
    let mut patience = PATIENCE;
    for _ in 0..20 * (count + 5) {
        budget::spend(count * count);
        let pairs = basic_solution(matrix, constant, &active)?;
        let size = pairs.iter().fold(0.0_f64, |size, [_, b]| size.max(b.abs()));
        let force = pairs.iter().fold(constant.amax(), |size, [a, _]| size.max(a.abs()));
        let wrong: Vec<usize> = (0..count)
            .filter(|&index| {
                let [a, b] = pairs[index];
                if active[index] { b < -1e-12 * size } else { a < -1e-12 * force }
            })
            .collect();
        if wrong.is_empty() {
            return Some(pairs);
        }
        if wrong.len() < fewest {
            fewest = wrong.len();
            patience = PATIENCE;
        } else {
            patience = patience.saturating_sub(1);
        }
        if patience > 0 {
            wrong.iter().for_each(|&index| active[index] = !active[index]);
        } else if let Some(&last) = wrong.last() {
            active[last] = !active[last];
        }
    }
    None
}

fn basic_solution(matrix: &DMatrix<f64>, constant: &DVector<f64>, active: &[bool]) -> Option<Pairs> {
    let chosen: Vec<usize> = (0..active.len()).filter(|&index| active[index]).collect();
    let mut b = DVector::zeros(active.len());
    if !chosen.is_empty() {
        let block = matrix.select_rows(&chosen).select_columns(&chosen);
        let mut values = DVector::from_iterator(chosen.len(), chosen.iter().map(|&index| -constant[index]));
        if !Factorisation::new(block)?.solve(&mut values) {
            return None;
        }
        chosen.iter().zip(values.iter()).for_each(|(&index, value)| b[index] = *value);
    }
    let a = matrix * &b + constant;
    Some((0..active.len()).map(|index| if active[index] { [0.0, b[index]] } else { [a[index], 0.0] }).collect())
}

/// The options of each pair that hold at a solution: the first (`b = 0`), the second (`a = 0`), or both.
pub fn options_of(pairs: &Pairs) -> Vec<Vec<usize>> {
    let largest = pairs
        .iter()
        .fold([SMALLEST_VALUE_SCALE; 2], |size, pair| [size[0].max(pair[0].abs()), size[1].max(pair[1].abs())]);
    pairs
        .iter()
        .map(|pair| {
            let zero = [pair[0].abs() <= VANISHING_VALUE * largest[0], pair[1].abs() <= VANISHING_VALUE * largest[1]];
            match zero {
                [true, true] => vec![0, 1],
                [true, false] => vec![1],
                [false, _] => vec![0],
            }
        })
        .collect()
}
