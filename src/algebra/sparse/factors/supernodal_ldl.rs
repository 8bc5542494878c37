//! Supernodal `L D Lᵀ` factorisation in the library's storage format, in pieces with a budget check between them.
//!
//! A block of columns with the same rows below (a supernode) first receives the updates by the preceding blocks, one
//! panel of columns at a time, and is then factorised panel by panel (E. G. Ng, B. W. Peyton, SIAM J. Sci. Comput. 14
//! (1993) 1034, doi:10.1137/0914063: left-looking).

use crate::resources::budget;
use faer::linalg::matmul::matmul;
use faer::sparse::linalg::cholesky::supernodal::SymbolicSupernodalCholesky;
use faer::{Accum, MatMut, MatRef, Par};

/// Number of columns of a panel.
const PANEL: usize = 64;
/// Multiplications of one piece: about a tenth of a second.
const PIECE: usize = 200_000_000;

/// Calls its second argument with row and value of each entry of a matrix column, on and below the diagonal.
pub(crate) type EachBelow<'a> = &'a dyn Fn(usize, &mut dyn FnMut(usize, f64));

/// Overwrites `values` with the factors, in the layout of a supernodal symbolic factorisation. Pivots of magnitude up
/// to `zero` become `±zero`.
pub(crate) fn factorise(
    symbolic: &SymbolicSupernodalCholesky<usize>,
    values: &mut [f64],
    each_below: EachBelow<'_>,
    zero: f64,
) {
    let size = symbolic.nrows();
    let mut block_of = vec![0; size];
    for block in 0..symbolic.n_supernodes() {
        block_of[symbolic.supernode_begin()[block]..symbolic.supernode_end()[block]].fill(block);
    }
    // For each block, the completed blocks that update it next, each with the first of its rows in the block.
    let mut waiting: Vec<Vec<(usize, usize)>> = vec![Vec::new(); symbolic.n_supernodes()];
    let mut place_in_block = vec![0; size];
    let mut scratch = Scratch::default();
    values.fill(0.0);
    for block in 0..symbolic.n_supernodes() {
        let own = Block::new(symbolic, block);
        budget::spend(own.rows() * own.columns());
        own.pattern.iter().enumerate().for_each(|(row, place)| place_in_block[*place] = own.columns() + row);
        (own.begin..own.end).for_each(|place| place_in_block[place] = place - own.begin);
        let (done, rest) = values.split_at_mut(own.first);
        let target = &mut rest[..own.rows() * own.columns()];
        for column in own.begin..own.end {
            let entries = &mut target[(column - own.begin) * own.rows()..][..own.rows()];
            each_below(column, &mut |row, value| entries[place_in_block[row]] += value);
        }
        for (earlier, from) in std::mem::take(&mut waiting[block]) {
            let earlier_block = Block::new(symbolic, earlier);
            let to = from + earlier_block.pattern[from..].partition_point(|place| *place < own.end);
            let source = &done[earlier_block.first..][..earlier_block.rows() * earlier_block.columns()];
            scratch.take_from(&earlier_block, source, from..to, &place_in_block, own.rows(), target);
            if let Some(next) = earlier_block.pattern.get(to) {
                waiting[block_of[*next]].push((earlier, to));
            }
        }
        factorise_block(target, own.rows(), own.columns(), zero, &mut scratch);
        if let Some(next) = own.pattern.first() {
            waiting[block_of[*next]].push((block, 0));
        }
    }
}

/// A block of columns with the same rows below.
struct Block<'a> {
    begin: usize,
    end: usize,
    pattern: &'a [usize],
    /// Index of the first value of the block.
    first: usize,
}

impl<'a> Block<'a> {
    fn new(symbolic: &'a SymbolicSupernodalCholesky<usize>, block: usize) -> Self {
        Self {
            begin: symbolic.supernode_begin()[block],
            end: symbolic.supernode_end()[block],
            pattern: symbolic.supernode(block).pattern(),
            first: symbolic.col_ptr_for_val()[block],
        }
    }

    fn columns(&self) -> usize {
        self.end - self.begin
    }

    fn rows(&self) -> usize {
        self.columns() + self.pattern.len()
    }
}

#[derive(Default)]
struct Scratch {
    /// `D Lᵀ` of a panel.
    scaled: Vec<f64>,
    product: Vec<f64>,
}

impl Scratch {
    /// `D Lᵀ` of some rows and columns of a factor.
    fn scale(&mut self, source: &[f64], rows: usize, which: std::ops::Range<usize>, columns: std::ops::Range<usize>) {
        self.scaled.clear();
        for row in which {
            let entry = |column: usize| source[column * rows + row] * source[column * rows + column];
            self.scaled.extend(columns.clone().map(entry));
        }
    }

    /// Subtracts from a block the update by an earlier block, in the rows of the earlier block's pattern from the first
    /// of `own` on; the rows `own` are columns of the updated block.
    fn take_from(
        &mut self,
        earlier: &Block<'_>,
        source: &[f64],
        own: std::ops::Range<usize>,
        place_in_block: &[usize],
        target_rows: usize,
        target: &mut [f64],
    ) {
        let (rows, columns) = (earlier.rows(), earlier.columns());
        for first in own.clone().step_by(PANEL) {
            let panel = first..own.end.min(first + PANEL);
            self.scale(source, rows, columns + panel.start..columns + panel.end, 0..columns);
            let at_once = (PIECE / (panel.len() * columns).max(1)).max(1);
            for start in (panel.start..earlier.pattern.len()).step_by(at_once) {
                let below = start..earlier.pattern.len().min(start + at_once);
                budget::spend(below.len() * panel.len() * columns);
                self.product.clear();
                self.product.resize(below.len() * panel.len(), 0.0);
                let part = MatRef::from_column_major_slice(source, rows, columns);
                matmul(
                    MatMut::from_column_major_slice_mut(&mut self.product, below.len(), panel.len()),
                    Accum::Replace,
                    part.subrows(columns + below.start, below.len()),
                    MatRef::from_column_major_slice(&self.scaled, columns, panel.len()),
                    1.0,
                    Par::Seq,
                );
                for (column, product) in panel.clone().zip(self.product.chunks_exact(below.len().max(1))) {
                    let into = &mut target[place_in_block[earlier.pattern[column]] * target_rows..][..target_rows];
                    for (row, value) in below.clone().zip(product).skip(column.saturating_sub(below.start)) {
                        into[place_in_block[earlier.pattern[row]]] -= value;
                    }
                }
            }
        }
    }
}

/// Factorises a block after all updates by earlier blocks.
fn factorise_block(target: &mut [f64], rows: usize, columns: usize, zero: f64, scratch: &mut Scratch) {
    for start in (0..columns).step_by(PANEL) {
        let panel = start..columns.min(start + PANEL);
        let (before, own) = target.split_at_mut(start * rows);
        let own = &mut own[..panel.len() * rows];
        for first in (0..start).step_by(PANEL) {
            let last = start.min(first + PANEL);
            scratch.scale(before, rows, panel.clone(), first..last);
            budget::spend((rows - start) * panel.len() * (last - first));
            let earlier = MatRef::from_column_major_slice(&before[first * rows..last * rows], rows, last - first);
            matmul(
                MatMut::from_column_major_slice_mut(own, rows, panel.len()).subrows_mut(start, rows - start),
                Accum::Add,
                earlier.subrows(start, rows - start),
                MatRef::from_column_major_slice(&scratch.scaled, last - first, panel.len()),
                -1.0,
                Par::Seq,
            );
        }
        budget::spend((rows - start) * panel.len() * panel.len());
        for column in 0..panel.len() {
            let (done, rest) = own.split_at_mut(column * rows);
            let entries = &mut rest[..rows];
            for earlier in done.chunks_exact(rows).enumerate() {
                let (place, earlier) = earlier;
                let factor = earlier[start + column] * earlier[start + place];
                if factor != 0.0 {
                    let below = entries[start + column..].iter_mut().zip(&earlier[start + column..]);
                    below.for_each(|(value, entry)| *value -= factor * entry);
                }
            }
            let pivot = &mut entries[start + column];
            if pivot.abs() <= zero {
                *pivot = zero.copysign(*pivot);
            }
            let inverse = 1.0 / *pivot;
            entries[start + column + 1..].iter_mut().for_each(|value| *value *= inverse);
            entries[..start + column].fill(0.0);
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::algebra::sparse::Pattern;
    use faer::dyn_stack::{MemBuffer, MemStack};
    use faer::linalg::cholesky::ldlt::factor::LdltRegularization;
    use faer::sparse::linalg::cholesky::SymbolicCholeskyRaw;

    /// An indefinite matrix on a cubic lattice: the last blocks are wider than a panel.
    #[test]
    fn the_factors_are_those_of_the_library() {
        const SIDE: usize = 11;
        let place = |x: usize, y: usize, z: usize| (x * SIDE + y) * SIDE + z;
        let mut entries = Vec::new();
        for (x, y, z) in (0..SIDE).flat_map(|x| (0..SIDE).flat_map(move |y| (0..SIDE).map(move |z| (x, y, z)))) {
            let nexts = [(x + 1, y, z), (x, y + 1, z), (x, y, z + 1)];
            let inside = nexts.into_iter().filter(|(x, y, z)| *x.max(y).max(z) < SIDE);
            entries.extend(inside.map(|(a, b, c)| (place(x, y, z), place(a, b, c))));
        }
        let pattern = Pattern::new(SIDE * SIDE * SIDE, entries).expect("a pattern");
        let SymbolicCholeskyRaw::Supernodal(blocks) = pattern.symbolic.cholesky.raw() else { panic!("by blocks") };
        let widest = (0..blocks.n_supernodes()).map(|block| Block::new(blocks, block).columns()).max();
        assert!(widest > Some(PANEL), "{widest:?}");
        let entry = |row: usize, column: usize| {
            if row == column { 6.1 - (row % 5) as f64 * 2.9 } else { -1.0 - ((row + column) % 3) as f64 / 8.0 }
        };
        let matrix: Vec<f64> = (0..pattern.size())
            .flat_map(|column| pattern.column(column).map(move |at| (at, column)))
            .map(|(at, column)| entry(pattern.rows[at], column))
            .collect();
        let symbolic = &pattern.symbolic.cholesky;
        let mut expected = vec![0.0; symbolic.len_val()];
        let request = symbolic.factorize_numeric_ldlt_scratch::<f64>(Par::Seq, Default::default());
        let mut memory = MemBuffer::new(request);
        let done = symbolic.factorize_numeric_ldlt(
            &mut expected,
            pattern.view(&matrix),
            faer::Side::Lower,
            LdltRegularization::default(),
            Par::Seq,
            MemStack::new(&mut memory),
            Default::default(),
        );
        assert!(done.is_ok());
        let (order, place_of) = symbolic.perm().expect("an order").arrays();
        let each_below = |place: usize, each: &mut dyn FnMut(usize, f64)| {
            for at in pattern.column(order[place]) {
                let row = place_of[pattern.rows[at]];
                if row >= place {
                    each(row, matrix[at]);
                }
            }
        };
        let mut found = vec![f64::NAN; expected.len()];
        factorise(blocks, &mut found, &each_below, 0.0);
        let mut compared = 0;
        for block in (0..blocks.n_supernodes()).map(|block| Block::new(blocks, block)) {
            for (column, row) in
                (0..block.columns()).flat_map(|column| (column..block.rows()).map(move |row| (column, row)))
            {
                let at = block.first + column * block.rows() + row;
                assert!((found[at] - expected[at]).abs() < 1e-9 * (1.0 + expected[at].abs()), "{row} {column}");
                compared += 1;
            }
        }
        assert!(compared > 30_000, "{compared}");
    }
}
