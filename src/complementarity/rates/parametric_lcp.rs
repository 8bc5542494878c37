//! All solutions of a linear complementarity problem with a free load rate whose matrix is a P-matrix except for one
//! pair.
//!
//! Past a limit point the structure is unstable in one direction, and `M` of
//!
//! ```text
//! a = M b + q ṡ,      0 <= a ⊥ b >= 0
//! ```
//!
//! is no longer a P-matrix. If `M` without row and column `j` is a P-matrix, all rays can still be found:
//!
//! * `b_j = 0`: for each sign of `ṡ` the other pairs have one solution, which is a ray if `a_j >= 0`;
//! * `b_j = 1`: for every `ṡ` the other pairs have one solution, a continuous, piecewise linear function of `ṡ`; the
//!   rays are the zeros of `a_j(ṡ)`, a function of one variable. Its pieces are followed from `ṡ = 0` in both
//!   directions by principal pivots (R. W. Cottle, J.-S. Pang, R. E. Stone, *The Linear Complementarity Problem*,
//!   section 4.5, doi:10.1137/1.9780898719000). Where several pairs change at one `ṡ`, the next piece solves
//!   the complementarity problem of their rates, whose matrix is a P-matrix like every principal pivot transform of a
//!   P-matrix.
//!
//! The method gives no result where no such `j` is found, or where `a_j` vanishes along a whole piece.

use crate::algebra::Factorisation;
use crate::complementarity::rates::p_matrix::{Certified, Pairs, is_p_matrix, scale, scales, solve_complementarity};
use crate::complementarity::rates::tolerances::{DIAGONAL_SHIFT, DOUBTFUL_ZERO, RELATIVE_ROUND_OFF, SMALLEST_TERM};
use crate::resources::budget;
use nalgebra::{DMatrix, DVector};

/// Largest number of pieces of one half of the function, per pair.
const MOST_PIECES: usize = 10;

/// Whether each load rate has exactly one solution, and a list that contains all solutions, at least for load rates of
/// the given signs. `None` where this is not certain.
pub(crate) fn all_solutions(matrix: DMatrix<f64>, load: DVector<f64>, signs: &[f64]) -> Option<(bool, Vec<Pairs>)> {
    match Certified::new(matrix.clone(), load.clone()) {
        Some(certified) => {
            let of_signs: Option<_> = signs.iter().map(|sign| certified.solve(*sign)).collect();
            Some((true, of_signs?))
        }
        None => Some((false, solutions(&matrix, &load)?)),
    }
}

/// Whether there are certainly two solutions in all: one with every pair slipping (`a = 0 < b`) and one with every pair
/// sticking (`b = 0 < a`).
pub fn slip_or_stick(matrix: DMatrix<f64>, load: DVector<f64>) -> bool {
    let Some((_, solutions)) = all_solutions(matrix, load, &[1.0, -1.0]) else { return false };
    let slip = |pairs: &Pairs| pairs.iter().all(|[a, b]| *a == 0.0 && *b > 0.0);
    let stick = |pairs: &Pairs| pairs.iter().all(|[a, b]| *b == 0.0 && *a > 0.0);
    solutions.len() == 2 && solutions.iter().any(slip) && solutions.iter().any(stick)
}

/// A list that contains every solution; `None` where this is not certain.
pub(crate) fn solutions(matrix: &DMatrix<f64>, load: &DVector<f64>) -> Option<Vec<Pairs>> {
    if !matrix.iter().chain(load.iter()).all(|value| value.is_finite()) {
        return None;
    }
    candidates(matrix).into_iter().find_map(|left_out| of_others(matrix, load, left_out))
}

/// Pairs without which the matrix may be a P-matrix, likely pairs first: a symmetric matrix with one negative
/// eigenvalue is definite without `j` exactly if entry `(j, j)` of its inverse is negative.
fn candidates(matrix: &DMatrix<f64>) -> Vec<usize> {
    let count = matrix.nrows();
    let negative: Vec<usize> = (0..count).filter(|&row| matrix[(row, row)] <= 0.0).collect();
    match negative[..] {
        [] => {}
        [only] => return vec![only],
        _ => return Vec::new(),
    }
    let Some(scales) = scales(matrix, |_| 0.0) else { return Vec::new() };
    let mut symmetric = matrix.clone();
    scale(&mut symmetric, &scales);
    let mut symmetric = (&symmetric + symmetric.transpose()) * 0.5;
    let size = symmetric.amax();
    (0..count).for_each(|index| symmetric[(index, index)] += DIAGONAL_SHIFT * size);
    let Some(factorisation) = Factorisation::new(symmetric) else { return Vec::new() };
    let mut diagonal = Vec::with_capacity(count);
    for index in 0..count {
        let mut unit = DVector::zeros(count);
        unit[index] = 1.0;
        if !factorisation.solve(&mut unit) {
            return Vec::new();
        }
        diagonal.push(unit[index]);
    }
    let least = (0..count).min_by(|a, b| diagonal[*a].total_cmp(&diagonal[*b]));
    let largest = (0..count).max_by(|a, b| diagonal[*a].abs().total_cmp(&diagonal[*b].abs()));
    let mut candidates: Vec<usize> = least.into_iter().chain(largest).collect();
    candidates.dedup();
    candidates
}

/// The solutions, if the matrix without pair `left_out` is a P-matrix.
fn of_others(matrix: &DMatrix<f64>, load: &DVector<f64>, left_out: usize) -> Option<Vec<Pairs>> {
    let mut others = matrix.clone().remove_row(left_out).remove_column(left_out);
    let column = matrix.column(left_out).into_owned().remove_row(left_out);
    let by_load = load.clone().remove_row(left_out);
    let scales = scales(&others, |row| column[row].abs().max(by_load[row].abs()))?;
    scale(&mut others, &scales);
    if !is_p_matrix(&others) {
        return None;
    }
    let (column, by_load) = (column.component_mul(&scales), by_load.component_mul(&scales));
    let row = matrix.row(left_out).transpose().remove_row(left_out).component_mul(&scales);
    let mut found = Vec::new();
    let whole = |others: Pairs, own: [f64; 2]| {
        let mut pairs = others;
        for (pair, scale) in pairs.iter_mut().zip(scales.iter()) {
            // `a` was multiplied by the factor, `b` divided.
            *pair = [pair[0] / scale, pair[1] * scale];
        }
        pairs.insert(left_out, own);
        pairs
    };
    for sign in [1.0, -1.0] {
        let pairs = solve_complementarity(&others, &(&by_load * sign))?;
        let terms = || pairs.iter().zip(row.iter()).map(|([_, b], coefficient)| coefficient * b);
        let own = terms().sum::<f64>() + sign * load[left_out];
        let size = (terms().map(f64::abs).sum::<f64>() + load[left_out].abs()).max(SMALLEST_TERM * load.amax());
        if own >= -DOUBTFUL_ZERO * size {
            found.push(whole(pairs, [own, 0.0]));
        }
    }
    let own = [matrix[(left_out, left_out)], load[left_out]];
    let start = Pieces::new(&others, &column, &by_load, &row, own)?;
    for sense in [1.0, -1.0] {
        found.extend(start.clone().zeros(sense)?.into_iter().map(|pairs| whole(pairs, [0.0, 1.0])));
    }
    Some(found)
}

/// The solution of the other pairs as a function of `ṡ`: their nonzero members are `D x + c + q ṡ`, with `x` their zero
/// members. The last row is `a_j`.
#[derive(Clone)]
struct Pieces {
    /// `D | c | q`, row by row.
    table: Vec<f64>,
    count: usize,
    /// For each pair, whether `b` is the nonzero member.
    active: Vec<bool>,
    /// The largest coefficient initially.
    size: f64,
}

impl Pieces {
    /// The piece at `ṡ = 0`.
    fn new(
        matrix: &DMatrix<f64>,
        column: &DVector<f64>,
        by_load: &DVector<f64>,
        row: &DVector<f64>,
        own: [f64; 2],
    ) -> Option<Self> {
        let count = column.len();
        let mut table = Vec::with_capacity((count + 1) * (count + 2));
        for index in 0..count {
            table.extend(matrix.row(index).iter());
            table.extend([column[index], by_load[index]]);
        }
        table.extend(row.iter());
        table.extend(own);
        let size = table.iter().fold(0.0_f64, |size, value| size.max(value.abs()));
        let mut pieces = Self { table, count, active: vec![false; count], size };
        let start = solve_complementarity(matrix, column)?;
        for (index, [a, b]) in start.iter().enumerate() {
            if *b > 0.0 && *a == 0.0 {
                pieces.pivot(index)?;
            }
        }
        Some(pieces)
    }

    fn entry(&self, row: usize, column: usize) -> f64 {
        self.table[row * (self.count + 2) + column]
    }

    fn by_load(&self, row: usize) -> f64 {
        self.entry(row, self.count + 1)
    }

    /// The value of a row at a load rate, and the magnitude of its terms.
    fn value(&self, row: usize, load: f64) -> (f64, f64) {
        let (constant, linear) = (self.entry(row, self.count), self.by_load(row) * load);
        (constant + linear, constant.abs() + linear.abs() + SMALLEST_TERM * self.size * (1.0 + load.abs()))
    }

    /// Exchanges the members of a pair; `None` where the pivot is not positive.
    fn pivot(&mut self, index: usize) -> Option<()> {
        budget::spend(self.table.len());
        let width = self.count + 2;
        let (before, rest) = self.table.split_at_mut(index * width);
        let (own, after) = rest.split_at_mut(width);
        let pivot = own[index];
        if !(pivot.is_finite() && pivot > 0.0) {
            return None;
        }
        own.iter_mut().for_each(|value| *value /= -pivot);
        own[index] = 1.0 / pivot;
        for row in before.chunks_exact_mut(width).chain(after.chunks_exact_mut(width)) {
            let factor = std::mem::replace(&mut row[index], 0.0);
            if factor != 0.0 {
                row.iter_mut().zip(own.iter()).for_each(|(value, own)| *value += factor * own);
            }
        }
        self.active[index] = !self.active[index];
        Some(())
    }

    /// The zeros of the last row on one side of `ṡ = 0`; `None` where the row vanishes along a piece or accuracy is
    /// lost.
    fn zeros(mut self, sense: f64) -> Option<Vec<Pairs>> {
        let last = self.count;
        let mut found = Vec::new();
        let mut load = 0.0;
        let mut changing: Option<usize> = None;
        for _ in 0..MOST_PIECES * (self.count + 5) {
            budget::spend(self.count);
            self.turn_into(load, sense, changing)?;
            let next = self.next(load, sense);
            let (here, size) = self.value(last, load);
            let is_zero = |value: f64, size: f64| value.abs() <= DOUBTFUL_ZERO * size;
            let root = -self.entry(last, self.count) / self.by_load(last);
            match next {
                Some((_, end)) => {
                    let (there, other) = self.value(last, end);
                    match (is_zero(here, size), is_zero(there, other)) {
                        (true, true) if (end - load).abs() > DOUBTFUL_ZERO * (1.0 + load.abs()) => return None,
                        (true, _) => found.push(self.pairs(load)),
                        (false, true) => found.push(self.pairs(end)),
                        (false, false) if here * there < 0.0 => found.push(self.pairs(root)),
                        (false, false) => {}
                    }
                }
                None if is_zero(here, size) && self.by_load(last).abs() <= RELATIVE_ROUND_OFF * self.size => {
                    return None;
                }
                None if is_zero(here, size) => found.push(self.pairs(load)),
                None if here * sense * self.by_load(last) < 0.0 => found.push(self.pairs(root)),
                None => {}
            }
            match next {
                Some((index, end)) => (changing, load) = (Some(index), end),
                None => return Some(found),
            }
        }
        None
    }

    /// Pivots such that no value that is zero at `load` becomes negative beyond it.
    fn turn_into(&mut self, load: f64, sense: f64, changing: Option<usize>) -> Option<()> {
        let at_zero: Vec<usize> = (0..self.count)
            .filter(|&row| {
                let (value, size) = self.value(row, load);
                changing == Some(row) || value <= RELATIVE_ROUND_OFF * size
            })
            .collect();
        if at_zero.iter().all(|&row| sense * self.by_load(row) >= 0.0) {
            return Some(());
        }
        let block =
            DMatrix::from_fn(at_zero.len(), at_zero.len(), |row, column| self.entry(at_zero[row], at_zero[column]));
        let rates = DVector::from_fn(at_zero.len(), |row, _| sense * self.by_load(at_zero[row]));
        for (index, [a, b]) in solve_complementarity(&block, &rates)?.iter().enumerate() {
            if *b > 0.0 && *a == 0.0 {
                self.pivot(at_zero[index])?;
            }
        }
        Some(())
    }

    /// The next pair with a member that becomes zero, and the load rate at this zero.
    fn next(&self, load: f64, sense: f64) -> Option<(usize, f64)> {
        let mut best: Option<(f64, usize)> = None;
        for row in 0..self.count {
            let rate = sense * self.by_load(row);
            if rate >= 0.0 {
                continue;
            }
            let (value, size) = self.value(row, load);
            // `turn_into` has made zero values nondecreasing; the remainder is round-off.
            if value <= RELATIVE_ROUND_OFF * size {
                continue;
            }
            let way = value / -rate;
            if best.is_none_or(|(least, _)| way < least) {
                best = Some((way, row));
            }
        }
        best.map(|(way, row)| (row, load + sense * way)).filter(|(_, end)| end.is_finite())
    }

    fn pairs(&self, load: f64) -> Pairs {
        let pair = |index: usize| {
            let value = self.value(index, load).0.max(0.0);
            if self.active[index] { [0.0, value] } else { [value, 0.0] }
        };
        (0..self.count).map(pair).collect()
    }
}

#[cfg(test)]
mod tests {
    use super::solutions;
    use nalgebra::{DMatrix, DVector};

    /// Two pairs, of which the load moves only the first: sticking of both is a solution, whatever the rounding of the
    /// second pair's zero.
    #[test]
    fn rounding_hides_no_solution() {
        let matrix = DMatrix::from_row_slice(2, 2, &[2.25, -5.25, -5.25, 9.75]);
        for rounding in [0.0, 2e-16, -2e-16] {
            let load = DVector::from_vec(vec![-1.0, rounding]);
            let found = solutions(&matrix, &load).expect("solutions");
            let stick = found.iter().filter(|pairs| pairs[0][0] > 0.5 && pairs.iter().all(|[_, b]| b.abs() < 1e-9));
            assert_eq!(stick.count(), 1, "{rounding}: {found:?}");
            let slip = found.iter().filter(|pairs| pairs.iter().all(|[a, b]| *a == 0.0 && *b > 0.0));
            assert_eq!(slip.count(), 1, "{rounding}: {found:?}");
        }
    }
}
