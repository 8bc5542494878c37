//! Solves with the factors `L D Lᵀ` for several right-hand sides together.
//!
//! The values of eight right-hand sides at one unknown lie side by side: each entry of `L`, once read, serves all
//! eight, and an unknown of a block's pattern is one cache line. In the forward substitution a column at which all are
//! zero is skipped, so that right-hand sides with few entries, as the borders of contacts have, visit only the columns
//! that depend on them (J. R. Gilbert, T. Peierls, SIAM J. Sci. Stat. Comput. 9 (1988) 862, doi:10.1137/0909058).
//!
//! By hand, since the library solves for one column after another where the factor is not in blocks, and gathers rows
//! across its columns where it is; `cargo bench --bench elimination -- solves` has the ratio.

use crate::algebra::sparse::factors::elimination_order::Symbolic;
use crate::resources::budget;
use faer::sparse::linalg::cholesky::SymbolicCholeskyRaw;
use std::ops::Range;

/// Number of right-hand sides solved for together.
const TOGETHER: usize = 8;
/// Number of columns of a block whose updates of the rows below are made in one sweep.
const SWEEP: usize = 4;

/// The values of the right-hand sides at one unknown.
type Values = [f64; TOGETHER];

/// Columns of `L` with the same rows below; on their diagonal the pivots in `D`.
struct ColumnBlock<'a> {
    columns: Range<usize>,
    below: &'a [usize],
    /// By columns, each with the rows of the block and those below.
    entries: &'a [f64],
}

/// Solves for consecutive right-hand sides, overwritten by the solutions.
pub(super) fn solve(symbolic: &Symbolic, factors: &[f64], scales: &[f64], right_hand_sides: &mut [f64]) {
    let size = scales.len();
    let order = symbolic.cholesky.perm().map(|perm| perm.arrays().0);
    let unknown = |place: usize| order.map_or(place, |order| order[place]);
    let blocks = blocks(symbolic, factors);
    let mut values: Vec<Values> = vec![[0.0; TOGETHER]; size];
    let mut sums: Vec<Values> = Vec::new();
    for right in right_hand_sides.chunks_mut(size * TOGETHER) {
        budget::spend(2 * factors.len() * right.len().div_ceil(size));
        for (place, values) in values.iter_mut().enumerate() {
            let unknown = unknown(place);
            *values = std::array::from_fn(|lane| right.get(lane * size + unknown).map_or(0.0, |v| v * scales[unknown]));
        }
        pulp::Arch::new().dispatch(Substitution { blocks: &blocks, values: &mut values, sums: &mut sums });
        for (place, values) in values.iter().enumerate() {
            let unknown = unknown(place);
            for (lane, value) in values.iter().enumerate() {
                if let Some(solution) = right.get_mut(lane * size + unknown) {
                    *solution = value * scales[unknown];
                }
            }
        }
    }
}

/// Both substitutions, by the widest instructions of the machine: the sums are the same with any.
struct Substitution<'a> {
    blocks: &'a [ColumnBlock<'a>],
    values: &'a mut [Values],
    sums: &'a mut Vec<Values>,
}

impl pulp::NullaryFnOnce for Substitution<'_> {
    type Output = ();

    // A function that is called rather than inlined would be compiled for the least of machines.
    #[inline(always)]
    fn call(self) {
        for block in self.blocks {
            block.forward(self.values, self.sums);
        }
        for block in self.blocks.iter().rev() {
            block.backward(self.values, self.sums);
        }
    }
}

/// The blocks of the factor in the elimination order; single columns where the factor is not in blocks.
fn blocks<'a>(symbolic: &'a Symbolic, factors: &'a [f64]) -> Vec<ColumnBlock<'a>> {
    match symbolic.cholesky.raw() {
        SymbolicCholeskyRaw::Simplicial(simplicial) => (simplicial.col_ptr().windows(2).enumerate())
            .map(|(column, ends)| ColumnBlock {
                columns: column..column + 1,
                below: &simplicial.row_idx()[ends[0] + 1..ends[1]],
                entries: &factors[ends[0]..ends[1]],
            })
            .collect(),
        SymbolicCholeskyRaw::Supernodal(blocks) => (0..blocks.n_supernodes())
            .map(|block| {
                let columns = blocks.supernode_begin()[block]..blocks.supernode_end()[block];
                let below = blocks.supernode(block).pattern();
                let first = blocks.col_ptr_for_val()[block];
                let entries = &factors[first..][..columns.len() * (columns.len() + below.len())];
                ColumnBlock { columns, below, entries }
            })
            .collect(),
    }
}

impl ColumnBlock<'_> {
    fn rows(&self) -> usize {
        self.columns.len() + self.below.len()
    }

    /// Takes what the block's unknowns contribute to the rows below from these.
    #[inline(always)]
    fn forward(&self, values: &mut [Values], sums: &mut Vec<Values>) {
        let rows = self.rows();
        let own = &mut values[self.columns.clone()];
        let mut is_zero = true;
        for column in 0..own.len() {
            let (value, entries) = (own[column], &self.entries[column * rows..][..rows]);
            if value == [0.0; TOGETHER] {
                continue;
            }
            is_zero = false;
            for (row, entry) in own.iter_mut().zip(entries).skip(column + 1) {
                take(row, *entry, &value);
            }
        }
        if is_zero || self.below.is_empty() {
            return;
        }
        if let [value] = *own {
            for (row, entry) in self.below.iter().zip(&self.entries[1..]) {
                take(&mut values[*row], *entry, &value);
            }
            return;
        }
        sums.clear();
        sums.resize(self.below.len(), [0.0; TOGETHER]);
        for (sweep, own) in own.chunks(SWEEP).enumerate() {
            self.add_sweep(sweep, own, sums);
        }
        for (row, sum) in self.below.iter().zip(sums.iter()) {
            values[*row].iter_mut().zip(sum).for_each(|(value, sum)| *value -= sum);
        }
    }

    /// Adds the products of a few columns with their values to the sums of the rows below.
    #[inline(always)]
    fn add_sweep(&self, sweep: usize, own: &[Values], sums: &mut [Values]) {
        let (rows, count) = (self.rows(), self.columns.len());
        let column = |number: usize| &self.entries[(sweep * SWEEP + number) * rows + count..][..self.below.len()];
        if let [a, b, c, d] = own {
            let entries = column(0).iter().zip(column(1)).zip(column(2)).zip(column(3));
            for (sum, (((of_a, of_b), of_c), of_d)) in sums.iter_mut().zip(entries) {
                for lane in 0..TOGETHER {
                    sum[lane] += (of_a * a[lane] + of_b * b[lane]) + (of_c * c[lane] + of_d * d[lane]);
                }
            }
            return;
        }
        for (number, value) in own.iter().enumerate() {
            for (sum, entry) in sums.iter_mut().zip(column(number)) {
                (0..TOGETHER).for_each(|lane| sum[lane] += entry * value[lane]);
            }
        }
    }

    /// Divides by the pivots and takes what the rows below contribute from the block's unknowns.
    #[inline(always)]
    fn backward(&self, values: &mut [Values], gathered: &mut Vec<Values>) {
        let (rows, count) = (self.rows(), self.columns.len());
        gathered.clear();
        gathered.extend(self.below.iter().map(|row| values[*row]));
        let own = &mut values[self.columns.clone()];
        for (sweep, own) in own.chunks_mut(SWEEP).enumerate() {
            let sums = self.sums_below(sweep, own.len(), gathered);
            for (number, (value, sum)) in own.iter_mut().zip(&sums).enumerate() {
                let column = sweep * SWEEP + number;
                let pivot = self.entries[column * rows + column];
                (0..TOGETHER).for_each(|lane| value[lane] = value[lane] / pivot - sum[lane]);
            }
        }
        for column in (0..count).rev() {
            let entries = &self.entries[column * rows..][..count];
            let (done, rest) = own.split_at_mut(column + 1);
            let value = &mut done[column];
            rest.iter().zip(&entries[column + 1..]).for_each(|(row, entry)| take(value, *entry, row));
        }
    }

    /// The sums over the rows below of a few columns.
    #[inline(always)]
    fn sums_below(&self, sweep: usize, columns: usize, gathered: &[Values]) -> [Values; SWEEP] {
        let (rows, count) = (self.rows(), self.columns.len());
        let column = |number: usize| &self.entries[(sweep * SWEEP + number) * rows + count..][..gathered.len()];
        let mut sums = [[0.0; TOGETHER]; SWEEP];
        if columns == SWEEP {
            let [a, b, c, d] = &mut sums;
            let entries = column(0).iter().zip(column(1)).zip(column(2)).zip(column(3));
            for (row, (((of_a, of_b), of_c), of_d)) in gathered.iter().zip(entries) {
                for lane in 0..TOGETHER {
                    a[lane] += of_a * row[lane];
                    b[lane] += of_b * row[lane];
                    c[lane] += of_c * row[lane];
                    d[lane] += of_d * row[lane];
                }
            }
            return sums;
        }
        for (number, sum) in sums.iter_mut().take(columns).enumerate() {
            for (row, entry) in gathered.iter().zip(column(number)) {
                (0..TOGETHER).for_each(|lane| sum[lane] += entry * row[lane]);
            }
        }
        sums
    }
}

#[inline(always)]
fn take(from: &mut Values, entry: f64, value: &Values) {
    for lane in 0..TOGETHER {
        from[lane] -= entry * value[lane];
    }
}

#[cfg(test)]
mod tests {
    use crate::algebra::sparse::Pattern;
    use crate::algebra::sparse::factors::ldl::SymmetricFactor;
    use std::sync::Arc;

    /// Strips of nodes joined to their neighbours: of width 1 the factor has single columns, of width 30 blocks of many.
    #[test]
    fn right_hand_sides_together_have_the_solutions_that_each_has() {
        for (width, length) in [(1, 40), (3, 25), (30, 40)] {
            let place = |x: usize, y: usize| x * width + y;
            let mut entries = Vec::new();
            for (x, y) in (0..length).flat_map(|x| (0..width).map(move |y| (x, y))) {
                let nexts = [(x + 1, y), (x, y + 1), (x + 1, y + 1)];
                let inside = nexts.into_iter().filter(|(x, y)| *x < length && *y < width);
                entries.extend(inside.map(|(a, b)| (place(x, y), place(a, b))));
            }
            let size = width * length;
            let pattern = Arc::new(Pattern::new(size, entries).expect("a pattern"));
            let mut values = vec![0.0; pattern.entries()];
            for column in 0..size {
                for at in pattern.column(column) {
                    let is_own = pattern.rows[at] == column;
                    // Some pivots are negative.
                    values[at] = if is_own { 6.5 - (column % 5) as f64 * 2.9 } else { -1.0 };
                }
            }
            let factor = SymmetricFactor::new(pattern, &values).expect("a factor");
            for count in [2, 8, 19] {
                let right = |at: usize| if at % 7 < 2 { (at % 11) as f64 - 4.0 } else { 0.0 };
                let mut together: Vec<f64> = (0..size * count).map(right).collect();
                let mut apart = together.clone();
                assert!(factor.solve(&mut together, count));
                assert!(apart.chunks_exact_mut(size).all(|one| factor.solve(one, 1)));
                let largest = apart.iter().fold(0.0_f64, |most, value| most.max(value.abs()));
                assert!(largest > 0.1);
                let off = apart.iter().zip(&together).fold(0.0_f64, |most, (a, b)| most.max((a - b).abs()));
                assert!(off <= 1e-10 * largest, "{width} {count}: {off} of {largest}");
            }
        }
    }
}
