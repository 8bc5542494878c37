//! The construction of a constrained node from the borders of a matrix, and its effect on the matrix.

use crate::algebra::sparse::constrained_nodes::constrained_node::{
    Coupling, HeldNode, gathered, times, transposed_times,
};
use crate::algebra::sparse::constrained_nodes::nodal_constraints::{Friction, Holding, IndexList};
use crate::algebra::sparse::factors::bordered_matrix::Bordered;
use crate::algebra::sparse::nodal_elimination::tolerances::{FRICTION_ENTRY_TOLERANCE, INDEPENDENCE_TOLERANCE};
use nalgebra::{Matrix3, Vector3};
use smallvec::SmallVec;
use std::ops::Range;

/// Builds the node with index `place`; appends its matrices to `numbers` and its couplings to `coupled`. `None` where
/// the holding cannot be eliminated.
pub(super) fn from_borders(
    matrix: &Bordered,
    holding: &Holding,
    is_reaction: &[bool],
    friction: Friction,
    place: usize,
    numbers: &mut Vec<f64>,
    coupled: &mut Vec<Coupling>,
) -> Option<HeldNode> {
    let (count, held) = (holding.unknowns.len(), holding.rows.len());
    if held == 0 || held > count || holding.columns.len() != held || !same_columns(matrix, &holding.unknowns) {
        return None;
    }
    let unknowns = held_first(matrix, holding);
    let LocalBlocks { rows, columns, couplings } = local_blocks(matrix, holding, is_reaction, &unknowns, place)?;
    let is_first = held == count || rows.columns(held, count - held).iter().all(|value| *value == 0.0);
    let rotation = if is_first { Matrix3::identity() } else { completed(&rows, held, count)? };
    let largest = columns.amax();
    let (constraint, turned) = if is_first { (rows, columns) } else { (rows * rotation, rotation.tr_mul(&columns)) };
    let constraint = leading(&constraint, held);
    let reaction = leading(&turned, held);
    let mut rest = turned;
    rest.rows_mut(0, held).fill(0.0);
    let rubs = rest.amax() > FRICTION_ENTRY_TOLERANCE * largest;
    let keeps = rubs && friction == Friction::Bordered;
    let folds = rubs && !keeps;
    let sign_of = |block: &Matrix3<f64>| if held == 1 { block[(0, 0)] } else { block.determinant() }.signum();
    let sign = sign_of(&constraint) * if held % 2 == 1 { -1.0 } else { 1.0 };
    let sign = if keeps { sign } else { sign * sign_of(&reaction) };
    let reaction = inverse(&reaction, held)?;
    let constraint = inverse(&constraint, held)?;
    let mut own = [[u32::MAX; 3]; 3];
    for (own, given) in own.iter_mut().zip([&unknowns, &holding.rows, &holding.columns]) {
        for (own, given) in own.iter_mut().zip(given) {
            *own = u32::try_from(*given).ok()?;
        }
    }
    let first = u32::try_from(numbers.len()).ok()?;
    put(&constraint, 0..held, held, numbers);
    put(&reaction, 0..held, held, numbers);
    if folds {
        put(&(rest * reaction), held..count, held, numbers);
    }
    if !is_first {
        put(&rotation, 0..count, count, numbers);
    }
    coupled.extend(couplings);
    Some(HeldNode {
        unknowns: own[0],
        rows: own[1],
        columns: own[2],
        count: count as u8,
        held: held as u8,
        turns: !is_first,
        folds,
        keeps,
        sign: if sign < 0.0 { -1 } else { 1 },
        numbers: first,
        before: 0,
    })
}

/// Overwrites the matrix by `Qᵀ K Q`; the columns of one node have the same pattern.
pub(super) fn rotate_matrix(node: &HeldNode, matrix: &Bordered, numbers: &[f64], values: &mut [f64]) {
    if !node.turns {
        return;
    }
    let (rotation, count) = (node.matrices(numbers).rotation, node.count());
    for by_row in [false, true] {
        each_place(node, matrix, by_row, |places| {
            let before = gathered(places[..count].iter().copied(), values);
            let turned = transposed_times(rotation, count, &before);
            places[..count].iter().zip(turned.iter()).for_each(|(place, value)| values[*place] = *value);
        });
    }
}

/// Calls `each` with the indices of the entries of the node's columns (or rows) in each row (or column).
fn each_place(node: &HeldNode, matrix: &Bordered, by_row: bool, mut each: impl FnMut([usize; 3])) {
    let pattern = &matrix.pattern;
    let mut starts = [0; 3];
    node.unknowns().zip(&mut starts).for_each(|(unknown, start)| *start = pattern.starts[unknown]);
    for entry in 0..pattern.column(node.unknown(0)).len() {
        let mut places = [0; 3];
        for (place, start) in places.iter_mut().zip(&starts).take(node.count()) {
            let own = start + entry;
            *place = if by_row { pattern.mirrors[own] } else { own };
        }
        each(places);
    }
}

/// Appends the entries of the node's columns (or rows) `H` to `taken`, and the index of the first entry of each to
/// `starts`.
pub(super) fn take(
    node: &HeldNode,
    matrix: &Bordered,
    values: &[f64],
    by_row: bool,
    taken: &mut Vec<(usize, f64)>,
    starts: &mut Vec<u32>,
) {
    let pattern = &matrix.pattern;
    for unknown in node.held() {
        starts.push(taken.len() as u32);
        for place in pattern.column(unknown) {
            let value = values[if by_row { pattern.mirrors[place] } else { place }];
            if value != 0.0 {
                taken.push((pattern.rows[place], value));
            }
        }
    }
}

/// Subtracts `F R⁻¹` times rows `H` from rows `T`.
pub(super) fn fold(node: &HeldNode, matrix: &Bordered, numbers: &[f64], values: &mut [f64]) {
    if !node.folds {
        return;
    }
    let (friction, held, count) = (node.matrices(numbers).friction, node.held_count(), node.count());
    each_place(node, matrix, true, |places| {
        let taken = times(friction, count - held, &gathered(places[..held].iter().copied(), values));
        places[held..count].iter().zip(taken.iter()).for_each(|(place, value)| values[*place] -= value);
    });
}

/// Clears the constrained rows and columns, with 1 left on the diagonal.
pub(super) fn clear(node: &HeldNode, matrix: &Bordered, values: &mut [f64]) {
    let pattern = &matrix.pattern;
    for column in node.held() {
        for place in pattern.column(column) {
            values[pattern.mirrors[place]] = 0.0;
            values[place] = if pattern.rows[place] == column { 1.0 } else { 0.0 };
        }
    }
}

/// The entries of a node's constraint borders at its unknowns.
struct LocalBlocks {
    rows: Matrix3<f64>,
    columns: Matrix3<f64>,
    /// Entries of the constraint rows at other borders.
    couplings: SmallVec<[Coupling; 3]>,
}

fn local_blocks(
    matrix: &Bordered,
    holding: &Holding,
    is_reaction: &[bool],
    unknowns: &[usize],
    place: usize,
) -> Option<LocalBlocks> {
    let n = matrix.pattern.size();
    let local = |unknown: usize| unknowns.iter().position(|own| *own == unknown);
    let (mut rows, mut columns) = (Matrix3::zeros(), Matrix3::zeros());
    let mut couplings: SmallVec<[Coupling; 3]> = SmallVec::new();
    for (index, row) in holding.rows.iter().enumerate() {
        for (column, value) in &matrix.lower[*row] {
            if *column < n {
                rows[(index, local(*column)?)] += value;
            } else if is_reaction[*column - n] {
                return None;
            } else {
                couplings.push(Coupling { node: place, row: index, border: *column - n, value: *value });
            }
        }
    }
    for (index, column) in holding.columns.iter().enumerate() {
        for (row, value) in &matrix.right[*column] {
            columns[(local(*row)?, index)] += value;
        }
    }
    Some(LocalBlocks { rows, columns, couplings })
}

/// The node's unknowns, constrained unknowns first where the border rows involve as many unknowns as there are rows.
fn held_first(matrix: &Bordered, holding: &Holding) -> IndexList {
    if holding.rows.len() == holding.unknowns.len() {
        return holding.unknowns.clone();
    }
    let is_named = |unknown: &usize| {
        let names = |row: &usize| matrix.lower[*row].iter().any(|(column, value)| column == unknown && *value != 0.0);
        holding.rows.iter().any(names)
    };
    let mut named = [false; 3];
    holding.unknowns.iter().zip(&mut named).for_each(|(unknown, named)| *named = is_named(unknown));
    let mut first = holding.unknowns.clone();
    if named.iter().filter(|named| **named).count() == holding.rows.len() {
        first.clear();
        for is_first in [true, false] {
            let wanted = holding.unknowns.iter().zip(&named).filter(|(_, named)| **named == is_first);
            wanted.for_each(|(unknown, _)| first.push(*unknown));
        }
    }
    first
}

/// Whether columns have entries in the same rows.
fn same_columns(matrix: &Bordered, unknowns: &[usize]) -> bool {
    let rows = |unknown: usize| &matrix.pattern.rows[matrix.pattern.column(unknown)];
    unknowns.len() <= 3 && unknowns.iter().all(|unknown| rows(*unknown) == rows(unknowns[0]))
}

/// The leading block, with 1 on the rest of the diagonal.
fn leading(matrix: &Matrix3<f64>, size: usize) -> Matrix3<f64> {
    Matrix3::from_fn(|row, column| match (row < size, column < size) {
        (true, true) => matrix[(row, column)],
        _ => f64::from(row == column),
    })
}

/// Appends the given rows of the first columns of a matrix, by columns.
fn put(matrix: &Matrix3<f64>, rows: Range<usize>, columns: usize, numbers: &mut Vec<f64>) {
    for column in 0..columns {
        rows.clone().for_each(|row| numbers.push(matrix[(row, column)]));
    }
}

/// The inverse of a leading block from [`leading`]; `None` where the block is nearly singular.
fn inverse(matrix: &Matrix3<f64>, size: usize) -> Option<Matrix3<f64>> {
    if size == 1 {
        let own = 1.0 / matrix[(0, 0)];
        let mut inverse = Matrix3::identity();
        inverse[(0, 0)] = own;
        return own.is_finite().then_some(inverse);
    }
    let largest_of = |matrix: &Matrix3<f64>| {
        let entries = (0..size).flat_map(|row| (0..size).map(move |column| (row, column)));
        entries.fold(0.0_f64, |largest, place| largest.max(matrix[place].abs()))
    };
    let largest = largest_of(matrix);
    let inverse = matrix.try_inverse()?;
    let own = largest_of(&inverse);
    (inverse.iter().all(|value| value.is_finite()) && own * largest * INDEPENDENCE_TOLERANCE < 1.0).then_some(inverse)
}

/// An orthogonal matrix whose first columns span the rows.
fn completed(rows: &Matrix3<f64>, held: usize, count: usize) -> Option<Matrix3<f64>> {
    let mut basis = Matrix3::identity();
    let rest = |basis: &Matrix3<f64>, known: usize, vector: Vector3<f64>| {
        let mut rest = vector;
        for _ in 0..2 {
            for column in 0..known {
                let own = basis.column(column);
                rest -= own * own.dot(&rest);
            }
        }
        rest
    };
    for row in 0..held {
        let row_vector: Vector3<f64> = rows.row(row).transpose();
        let (own, size) = (rest(&basis, row, row_vector), row_vector.norm());
        if own.norm() <= INDEPENDENCE_TOLERANCE * size || size == 0.0 {
            return None;
        }
        basis.set_column(row, &own.normalize());
    }
    for known in held..count {
        let unit = |place: usize| Vector3::from_fn(|row, _| f64::from(row == place));
        let units = (0..count).map(|place| rest(&basis, known, unit(place)));
        let longest = units.reduce(|best, other| if other.norm() > best.norm() { other } else { best })?;
        basis.set_column(known, &longest.normalize());
    }
    Some(basis)
}
