//! Forward and backward substitution with the factors `L D Lᵀ`, for one or several right-hand sides.
//!
//! The values of the right-hand sides at one unknown lie side by side, in the elimination order: each entry of `L`, once
//! read, serves all of them, and eight values are one cache line. In the forward substitution, right-hand sides with few
//! entries, as the borders of contacts have, visit only the columns that depend on them (J. R. Gilbert, T. Peierls, SIAM
//! J. Sci. Stat. Comput. 9 (1988) 862, doi:10.1137/0909058).
//!
//! By hand, since the library has no substitution by itself, solves for one column after another where the factor is not
//! in blocks, and gathers rows across its columns where it is; `cargo bench --bench elimination -- solves` has the ratio.

use crate::algebra::sparse::factors::elimination_order::Symbolic;
use crate::resources::budget;
use faer::sparse::linalg::cholesky::SymbolicCholeskyRaw;
use std::ops::Range;

/// Number of right-hand sides solved for together.
pub(crate) const TOGETHER: usize = 8;
/// Number of columns of a block whose updates of the rows below are made in one sweep.
const SWEEP: usize = 4;

/// Columns of `L` with the same rows below; on their diagonal the pivots in `D`.
struct ColumnBlock<'a> {
    columns: Range<usize>,
    below: &'a [usize],
    /// Index of the first entry.
    start: usize,
    /// By columns, each with the rows of the block and those below.
    entries: &'a [f64],
}

/// Which of the substitutions.
#[derive(Clone, Copy)]
enum Pass<'a> {
    /// With `L`.
    Forward,
    /// With `L`, for values that are zero in all blocks but these.
    ForwardIn(&'a [usize]),
    /// With `D Lᵀ`.
    Backward,
}

/// The factors `L D Lᵀ` of the scaled matrix.
#[derive(Clone, Copy)]
pub(crate) struct Substitutions<'a> {
    symbolic: &'a Symbolic,
    factors: &'a [f64],
}

impl<'a> Substitutions<'a> {
    pub fn new(symbolic: &'a Symbolic, factors: &'a [f64]) -> Self {
        Self { symbolic, factors }
    }

    /// Solves with `L`; values in the elimination order.
    pub fn solve_lower<const N: usize>(self, values: &mut [[f64; N]]) {
        self.pass(Pass::Forward, values);
    }

    /// Solves with `D Lᵀ`; values in the elimination order.
    pub fn solve_upper<const N: usize>(self, values: &mut [[f64; N]]) {
        self.pass(Pass::Backward, values);
    }

    /// Solves with `L` for values that are zero but at `starts`; returns the places that may not be zero afterwards,
    /// ascending.
    pub fn solve_lower_from<const N: usize>(self, starts: &[usize], values: &mut [[f64; N]]) -> Vec<usize> {
        let blocks = self.reached(starts);
        self.pass(Pass::ForwardIn(&blocks), values);
        blocks.iter().flat_map(|which| self.block(*which).columns).collect()
    }

    /// The blocks that depend on unknowns at some places: those of the places, and of each the one that has its next row.
    fn reached(self, starts: &[usize]) -> Vec<usize> {
        let mut is_reached = vec![false; self.blocks()];
        for place in starts {
            let mut next = Some(*place);
            while let Some(which) = next.map(|place| self.block_of(place))
                && !std::mem::replace(&mut is_reached[which], true)
            {
                next = self.block(which).below.iter().copied().min();
            }
        }
        (0..is_reached.len()).filter(|which| is_reached[*which]).collect()
    }

    /// The block of an unknown.
    fn block_of(self, place: usize) -> usize {
        match self.symbolic.cholesky.raw() {
            SymbolicCholeskyRaw::Simplicial(_) => place,
            SymbolicCholeskyRaw::Supernodal(blocks) => blocks.supernode_end().partition_point(|end| *end <= place),
        }
    }

    fn pass<const N: usize>(self, which: Pass<'_>, values: &mut [[f64; N]]) {
        let entries = match which {
            Pass::Forward | Pass::Backward => self.factors.len(),
            Pass::ForwardIn(blocks) => blocks.iter().map(|which| self.block(*which).entries.len()).sum(),
        };
        budget::spend(entries * N);
        pulp::Arch::new().dispatch(Substitution { factors: self, which, values });
    }

    /// The number of blocks; single columns where the factor is not in blocks.
    #[inline(always)]
    fn blocks(self) -> usize {
        match self.symbolic.cholesky.raw() {
            SymbolicCholeskyRaw::Simplicial(columns) => columns.col_ptr().len() - 1,
            SymbolicCholeskyRaw::Supernodal(blocks) => blocks.n_supernodes(),
        }
    }

    #[inline(always)]
    fn block(self, which: usize) -> ColumnBlock<'a> {
        match self.symbolic.cholesky.raw() {
            SymbolicCholeskyRaw::Simplicial(columns) => {
                let (start, end) = (columns.col_ptr()[which], columns.col_ptr()[which + 1]);
                ColumnBlock {
                    columns: which..which + 1,
                    below: &columns.row_idx()[start + 1..end],
                    start,
                    entries: &self.factors[start..end],
                }
            }
            SymbolicCholeskyRaw::Supernodal(blocks) => {
                let columns = blocks.supernode_begin()[which]..blocks.supernode_end()[which];
                let below = blocks.supernode(which).pattern();
                let start = blocks.col_ptr_for_val()[which];
                let entries = &self.factors[start..][..columns.len() * (columns.len() + below.len())];
                ColumnBlock { columns, below, start, entries }
            }
        }
    }

    /// The pivots in `D`, in the elimination order.
    pub fn pivots(self) -> impl Iterator<Item = f64> + 'a {
        (0..self.blocks()).flat_map(move |which| {
            let block = self.block(which);
            let rows = block.rows();
            (0..block.columns.len()).map(move |column| block.entries[column * rows + column])
        })
    }
}

/// Turns the factor of `L Lᵀ` into those of `L D Lᵀ`.
pub(super) fn divide_columns(symbolic: &Symbolic, factors: &mut [f64]) {
    let layout = Substitutions::new(symbolic, factors);
    let of_block = |block: ColumnBlock<'_>| (block.start, block.columns.len(), block.rows());
    let blocks: Vec<(usize, usize, usize)> = (0..layout.blocks()).map(|which| of_block(layout.block(which))).collect();
    for (start, columns, rows) in blocks {
        for column in 0..columns {
            let entries = &mut factors[start + column * rows..][column..rows];
            let pivot = entries[0];
            entries[0] = pivot * pivot;
            entries[1..].iter_mut().for_each(|entry| *entry /= pivot);
        }
    }
}

/// Solves for consecutive right-hand sides, overwritten by the solutions.
pub(super) fn solve(symbolic: &Symbolic, factors: &[f64], scales: &[f64], right_hand_sides: &mut [f64]) {
    if right_hand_sides.len() > scales.len() {
        solve_together::<TOGETHER>(symbolic, factors, scales, right_hand_sides);
    } else {
        solve_together::<1>(symbolic, factors, scales, right_hand_sides);
    }
}

fn solve_together<const N: usize>(symbolic: &Symbolic, factors: &[f64], scales: &[f64], right_hand_sides: &mut [f64]) {
    let size = scales.len();
    let order = symbolic.cholesky.perm().map(|perm| perm.arrays().0);
    let unknown = |place: usize| order.map_or(place, |order| order[place]);
    let substitutions = Substitutions::new(symbolic, factors);
    let mut values = vec![[0.0; N]; size];
    for right in right_hand_sides.chunks_mut(size.max(1) * N) {
        for (place, values) in values.iter_mut().enumerate() {
            let unknown = unknown(place);
            *values = std::array::from_fn(|lane| right.get(lane * size + unknown).map_or(0.0, |v| v * scales[unknown]));
        }
        substitutions.solve_lower(&mut values);
        substitutions.solve_upper(&mut values);
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

/// A substitution by the widest instructions of the machine: the sums are the same with any.
struct Substitution<'a, 'v, const N: usize> {
    factors: Substitutions<'a>,
    which: Pass<'v>,
    values: &'v mut [[f64; N]],
}

impl<const N: usize> pulp::NullaryFnOnce for Substitution<'_, '_, N> {
    type Output = ();

    #[inline(always)]
    fn call(self) {
        let mut sums = Vec::new();
        // Loops, as closures would not be compiled for the widest instructions.
        match self.which {
            Pass::Forward => {
                for which in 0..self.factors.blocks() {
                    self.factors.block(which).forward(self.values, &mut sums);
                }
            }
            Pass::ForwardIn(blocks) => {
                for which in blocks {
                    self.factors.block(*which).forward(self.values, &mut sums);
                }
            }
            Pass::Backward => {
                for which in (0..self.factors.blocks()).rev() {
                    self.factors.block(which).backward(self.values, &mut sums);
                }
            }
        }
    }
}

impl ColumnBlock<'_> {
    fn rows(&self) -> usize {
        self.columns.len() + self.below.len()
    }

    /// Takes what the block's unknowns contribute to the rows below from these.
    #[inline(always)]
    fn forward<const N: usize>(&self, values: &mut [[f64; N]], sums: &mut Vec<[f64; N]>) {
        let rows = self.rows();
        let own = &mut values[self.columns.clone()];
        let mut is_zero = true;
        for column in 0..own.len() {
            let (value, entries) = (own[column], &self.entries[column * rows..][..rows]);
            if value == [0.0; N] {
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
        sums.resize(self.below.len(), [0.0; N]);
        for (sweep, own) in own.chunks(SWEEP).enumerate() {
            self.add_sweep(sweep, own, sums);
        }
        for (row, sum) in self.below.iter().zip(sums.iter()) {
            values[*row].iter_mut().zip(sum).for_each(|(value, sum)| *value -= sum);
        }
    }

    /// Adds the products of a few columns with their values to the sums of the rows below.
    #[inline(always)]
    fn add_sweep<const N: usize>(&self, sweep: usize, own: &[[f64; N]], sums: &mut [[f64; N]]) {
        let (rows, count) = (self.rows(), self.columns.len());
        let column = |number: usize| &self.entries[(sweep * SWEEP + number) * rows + count..][..self.below.len()];
        if let [a, b, c, d] = own {
            let entries = column(0).iter().zip(column(1)).zip(column(2)).zip(column(3));
            for (sum, (((of_a, of_b), of_c), of_d)) in sums.iter_mut().zip(entries) {
                for lane in 0..N {
                    sum[lane] += (of_a * a[lane] + of_b * b[lane]) + (of_c * c[lane] + of_d * d[lane]);
                }
            }
            return;
        }
        for (number, value) in own.iter().enumerate() {
            for (sum, entry) in sums.iter_mut().zip(column(number)) {
                (0..N).for_each(|lane| sum[lane] += entry * value[lane]);
            }
        }
    }

    /// Divides by the pivots and takes what the rows below contribute from the block's unknowns.
    #[inline(always)]
    fn backward<const N: usize>(&self, values: &mut [[f64; N]], gathered: &mut Vec<[f64; N]>) {
        let (rows, count) = (self.rows(), self.columns.len());
        gathered.clear();
        gathered.extend(self.below.iter().map(|row| values[*row]));
        let own = &mut values[self.columns.clone()];
        for (sweep, own) in own.chunks_mut(SWEEP).enumerate() {
            let sums = self.sums_below(sweep, own.len(), gathered);
            for (number, (value, sum)) in own.iter_mut().zip(&sums).enumerate() {
                let column = sweep * SWEEP + number;
                let pivot = self.entries[column * rows + column];
                (0..N).for_each(|lane| value[lane] = value[lane] / pivot - sum[lane]);
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
    fn sums_below<const N: usize>(&self, sweep: usize, columns: usize, gathered: &[[f64; N]]) -> [[f64; N]; SWEEP] {
        let (rows, count) = (self.rows(), self.columns.len());
        let column = |number: usize| &self.entries[(sweep * SWEEP + number) * rows + count..][..gathered.len()];
        let mut sums = [[0.0; N]; SWEEP];
        if columns == SWEEP {
            let [a, b, c, d] = &mut sums;
            let entries = column(0).iter().zip(column(1)).zip(column(2)).zip(column(3));
            for (row, (((of_a, of_b), of_c), of_d)) in gathered.iter().zip(entries) {
                for lane in 0..N {
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
                (0..N).for_each(|lane| sum[lane] += entry * row[lane]);
            }
        }
        sums
    }
}

/// Subtracts a multiple of values.
#[inline(always)]
pub(super) fn take<const N: usize>(from: &mut [f64; N], entry: f64, value: &[f64; N]) {
    for lane in 0..N {
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
