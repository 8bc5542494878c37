//! Cholesky factorisation of sparse symmetric positive definite matrices.

use crate::algebra::dense::solve_counters::count_solves;
use crate::algebra::sparse::factors::elimination_order::Symbolic;
use crate::algebra::sparse::factors::substitutions::{self, Substitutions, TOGETHER};
use crate::algebra::sparse::factors::supernodal_ldl;
use crate::algebra::sparse::factors::tolerances::BLOCKED_CHOLESKY_WORK;
use crate::resources::budget::{self, Taken};
use faer::dyn_stack::{MemBuffer, MemStack};
use faer::linalg::cholesky::llt::factor::LltRegularization;
use faer::sparse::{SparseColMat, Triplet};
use faer::{Par, Side};

/// Entries of the lower triangle, diagonal included; several at one place are added up.
pub type Triangle = Vec<(usize, usize, f64)>;

/// The factorisation of a positive definite matrix.
pub struct Definite {
    symbolic: Symbolic,
    /// Values of the factors of `L D Lᵀ`.
    values: Vec<f64>,
    /// Scale factors of rows and columns.
    scales: Vec<f64>,
    _held: Taken,
}

impl Definite {
    /// Factorises the matrix with each diagonal entry increased by the fraction `shift` (negative: a margin, so that
    /// rounding alone cannot make the matrix definite). `None` where the shifted matrix is not positive definite, or
    /// where a diagonal entry is not above `|shift|` times the sum of the magnitudes of the contributions to its row.
    pub fn new(size: usize, lower: &Triangle, shift: f64) -> Option<Self> {
        let (mut diagonal, mut sizes) = (vec![0.0; size], vec![0.0_f64; size]);
        for &(row, column, value) in lower {
            sizes[row] += value.abs();
            if row == column {
                diagonal[row] += value;
            } else {
                sizes[column] += value.abs();
            }
        }
        let is_clear =
            |(value, size): (&f64, &f64)| value.is_finite() && size.is_finite() && *value > shift.abs() * size;
        if !diagonal.iter().zip(&sizes).all(is_clear) {
            return None;
        }
        // A congruence transformation: the diagonal becomes 1 and definiteness is preserved.
        let scales: Vec<f64> = diagonal.iter().map(|value| 1.0 / value.sqrt()).collect();
        let scaled =
            lower.iter().map(|&(row, column, value)| Triplet::new(row, column, value * scales[row] * scales[column]));
        let shifts = (0..size).map(|place| Triplet::new(place, place, shift));
        let triplets: Vec<Triplet<usize, usize, f64>> = scaled.chain(shifts).collect();
        let _triplets = budget::take::<Triplet<usize, usize, f64>>(2 * triplets.len());
        budget::spend(triplets.len());
        let matrix = SparseColMat::try_new_from_triplets(size, size, &triplets).ok()?;
        let (starts, rows) = (matrix.symbolic().col_ptr(), matrix.symbolic().row_idx());
        let whole = both_triangles(starts, rows);
        let symbolic = Symbolic::new((starts, rows), (&whole.0, &whole.1), BLOCKED_CHOLESKY_WORK)?;
        let held = budget::take::<f64>(symbolic.cholesky.len_val() + symbolic.indices());
        let values = vec![0.0; symbolic.cholesky.len_val()];
        let mut definite = Self { symbolic, values, scales, _held: held };
        definite.factorise(&matrix, &whole).then_some(definite)
    }

    /// Factorises the scaled matrix, given by its lower triangle; returns whether it is positive definite.
    fn factorise(&mut self, matrix: &SparseColMat<usize, f64>, whole: &(Vec<usize>, Vec<usize>)) -> bool {
        if let Some((blocks, (order, place_of))) = self.symbolic.in_pieces() {
            let each_below = |place: usize, each: &mut dyn FnMut(usize, f64)| {
                let unknown = order[place];
                for row in whole.1[whole.0[unknown]..whole.0[unknown + 1]].iter().filter(|row| place_of[**row] >= place)
                {
                    let value = matrix.get((*row).max(unknown), (*row).min(unknown));
                    value.into_iter().for_each(|value| each(place_of[*row], *value));
                }
            };
            supernodal_ldl::factorise(blocks, &mut self.values, &each_below, 0.0);
            let pivots = (0..blocks.n_supernodes()).flat_map(|block| {
                let columns = blocks.supernode_end()[block] - blocks.supernode_begin()[block];
                let rows = columns + blocks.supernode(block).pattern().len();
                (0..columns).map(move |column| blocks.col_ptr_for_val()[block] + column * (rows + 1))
            });
            return pivots.into_iter().all(|place| self.values[place] > 0.0);
        }
        let symbolic = &self.symbolic.cholesky;
        budget::spend(usize::try_from(self.symbolic.fill.multiplications).unwrap_or(usize::MAX));
        let request = symbolic.factorize_numeric_llt_scratch::<f64>(Par::Seq, Default::default());
        let Ok(mut memory) = MemBuffer::try_new(request) else { return false };
        let done = symbolic.factorize_numeric_llt(
            &mut self.values,
            matrix.as_ref(),
            Side::Lower,
            LltRegularization::default(),
            Par::Seq,
            MemStack::new(&mut memory),
            Default::default(),
        );
        // From `L Lᵀ`, so that the substitutions are those of all factors.
        done.is_ok() && {
            substitutions::divide_columns(&self.symbolic, &mut self.values);
            true
        }
    }

    /// Solves for one right-hand side, overwritten by the solution.
    pub fn solve(&self, values: &mut [f64]) {
        count_solves(1);
        budget::spend(2 * self.values.len());
        substitutions::solve(&self.symbolic, &self.values, &self.scales, values);
    }

    /// For pairs of unknowns, the entries of the inverse: of the first with itself, of both, of the second with itself.
    pub fn inverse_entries(&self, pairs: &[[usize; 2]]) -> Vec<[f64; 3]> {
        count_solves(2 * pairs.len());
        let place_of = self.symbolic.cholesky.perm().map(|order| order.arrays().1);
        let place = |unknown: usize| place_of.map_or(unknown, |place_of| place_of[unknown]);
        let substitutions = Substitutions::new(&self.symbolic, &self.values);
        let pivots: Vec<f64> = substitutions.pivots().collect();
        let mut halves = vec![[0.0; TOGETHER]; self.scales.len()];
        let mut entries = vec![[0.0; 3]; pairs.len()];
        for (pairs, entries) in pairs.chunks(TOGETHER / 2).zip(entries.chunks_mut(TOGETHER / 2)) {
            let places: Vec<usize> = pairs.iter().flatten().map(|unknown| place(*unknown)).collect();
            for (lane, (unknown, place)) in pairs.iter().flatten().zip(&places).enumerate() {
                halves[*place][lane] = self.scales[*unknown];
            }
            for place in substitutions.solve_lower_from(&places, &mut halves) {
                let half = std::mem::replace(&mut halves[place], [0.0; TOGETHER]);
                for (entries, half) in entries.iter_mut().zip(half.chunks_exact(2)) {
                    let products = [half[0] * half[0], half[0] * half[1], half[1] * half[1]];
                    entries.iter_mut().zip(products).for_each(|(sum, product)| *sum += product / pivots[place]);
                }
            }
        }
        entries
    }

    /// The direction of least stiffness, approximately, by inverse iteration with the matrix scaled to a diagonal of 1;
    /// the largest entry of the scaled vector is 1.
    pub fn softest(&self) -> Vec<f64> {
        const ROUNDS: usize = 4;
        let mut vector: Vec<f64> = (0..self.scales.len()).map(|place| 1.0 + (place % 7) as f64 / 8.0).collect();
        for _ in 0..ROUNDS {
            let scaled = |(value, scale): (&f64, &f64)| (value / scale).abs();
            let largest = vector.iter().zip(&self.scales).map(scaled).fold(f64::MIN_POSITIVE, f64::max);
            // The right-hand side of the scaled system is the scaled vector.
            vector.iter_mut().zip(&self.scales).for_each(|(value, scale)| *value /= largest * scale * scale);
            self.solve(&mut vector);
        }
        let scaled = |(value, scale): (&f64, &f64)| (value / scale).abs();
        let largest = vector.iter().zip(&self.scales).map(scaled).fold(f64::MIN_POSITIVE, f64::max);
        vector.iter_mut().for_each(|value| *value /= largest);
        vector
    }
}

/// The pattern of both triangles, by columns, from the pattern of the lower triangle.
fn both_triangles(starts: &[usize], rows: &[usize]) -> (Vec<usize>, Vec<usize>) {
    let size = starts.len().saturating_sub(1);
    let each =
        || (0..size).flat_map(|column| rows[starts[column]..starts[column + 1]].iter().map(move |row| (*row, column)));
    let mut whole = vec![0; size + 1];
    for (row, column) in each() {
        whole[column + 1] += 1;
        whole[row + 1] += usize::from(row != column);
    }
    (0..size).for_each(|column| whole[column + 1] += whole[column]);
    let (mut next, mut all) = (whole.clone(), vec![0; whole[size]]);
    let mut put = |row: usize, column: usize| {
        all[next[column]] = row;
        next[column] += 1;
    };
    for (row, column) in each() {
        put(row, column);
        if row != column {
            put(column, row);
        }
    }
    (whole, all)
}

#[cfg(test)]
mod tests {
    use super::{Definite, Triangle};

    fn is_positive_definite(size: usize, lower: &Triangle, margin: f64) -> bool {
        Definite::new(size, lower, -margin).is_some()
    }

    /// A chain of springs of stiffness 1, supported at one end by a spring of stiffness `held`.
    fn chain(size: usize, held: f64) -> Vec<(usize, usize, f64)> {
        let mut lower = vec![(0, 0, held)];
        for place in 1..size {
            lower.extend([(place - 1, place - 1, 1.0), (place, place, 1.0), (place, place - 1, -1.0)]);
        }
        lower
    }

    #[test]
    fn a_long_chain_is_definite_while_something_holds_it() {
        assert!(is_positive_definite(10_000, &chain(10_000, 1.0), 1e-12));
        assert!(!is_positive_definite(10_000, &chain(10_000, 0.0), 1e-12));
        assert!(!is_positive_definite(50, &chain(50, -1e-3), 1e-12));
        assert!(!is_positive_definite(2, &vec![(0, 0, 1.0), (1, 1, f64::NAN)], 1e-12));
        assert!(is_positive_definite(0, &Vec::new(), 1e-12));
    }

    /// A grid whose factors are in blocks, and a chain with factors in columns.
    #[test]
    fn entries_of_the_inverse_are_those_of_solutions() {
        let width = 60;
        let mut grid = Vec::new();
        for place in 0..width * width {
            grid.push((place, place, 4.0 + 1e-3 * (place % 5) as f64));
            grid.extend((place % width > 0).then(|| (place, place - 1, -1.0)));
            grid.extend((place >= width).then(|| (place, place - width, -1.0)));
        }
        for (size, lower) in [(width * width, grid), (50, chain(50, 1.0))] {
            let definite = Definite::new(size, &lower, 0.0).expect("definite");
            let pairs: Vec<[usize; 2]> = (0..7).map(|pair| [pair * 7, size - 1 - pair * pair / 2]).collect();
            for (pair, found) in pairs.iter().zip(definite.inverse_entries(&pairs)) {
                let mut solutions = [vec![0.0; size], vec![0.0; size]];
                for (solution, unknown) in solutions.iter_mut().zip(pair) {
                    solution[*unknown] = 1.0;
                    definite.solve(solution);
                    let mut rest = vec![0.0; size];
                    rest[*unknown] = 1.0;
                    for (row, column, value) in &lower {
                        rest[*row] -= value * solution[*column];
                        if row != column {
                            rest[*column] -= value * solution[*row];
                        }
                    }
                    assert!(rest.iter().all(|rest| rest.abs() < 1e-12), "{size}");
                }
                let expected = [solutions[0][pair[0]], solutions[0][pair[1]], solutions[1][pair[1]]];
                let close = |(one, other): (&f64, f64)| (one - other).abs() <= 1e-12 * expected[0].abs();
                assert!(found.iter().zip(expected).all(close), "{pair:?}: {found:?} and {expected:?}");
            }
        }
    }

    #[test]
    fn a_chain_that_nothing_holds_moves_as_one() {
        let free = Definite::new(50, &chain(50, 0.0), 1e-12).expect("definite with the shift");
        let motion = free.softest();
        assert!(motion.iter().all(|value| (value / motion[0] - 1.0).abs() < 1e-9), "{motion:?}");
        let held = Definite::new(3, &chain(3, 2.0), 0.0).expect("definite");
        let mut values = vec![0.0, 0.0, 1.0];
        held.solve(&mut values);
        assert!(values.iter().zip([0.5, 1.5, 2.5]).all(|(value, exact)| (value - exact).abs() < 1e-14), "{values:?}");
    }
}
