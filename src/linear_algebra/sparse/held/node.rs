//! One node that border rows hold.

use super::{Friction, Holding, Places};
use crate::linear_algebra::sparse::bordered::Bordered;
use nalgebra::{Matrix3, Vector3};
use std::ops::Range;

/// One node; matrices have ones on the diagonal where the node has less.
pub(in crate::linear_algebra::sparse) struct HeldNode {
    pub(super) unknowns: [usize; 3],
    pub(super) count: usize,
    /// So many of the rotated unknowns are held.
    pub(super) held: usize,
    /// Whether `Q` is not the identity.
    pub(super) turns: bool,
    /// `Q`
    pub(super) rotation: Matrix3<f64>,
    /// `M⁻¹`
    pub constraint: Matrix3<f64>,
    /// `R⁻¹`
    pub reaction: Matrix3<f64>,
    /// `F R⁻¹`, rows of `T` after those of `H`; where it is folded.
    pub(super) friction: Option<Matrix3<f64>>,
    pub(super) rows: [usize; 3],
    pub(super) columns: [usize; 3],
    /// Its reactions stay borders.
    pub keeps: bool,
    /// Sign of the part of the determinant that is eliminated, its place apart.
    pub sign: f64,
    /// `d`: for each row, other borders and values.
    pub couplings: [Vec<(usize, f64)>; 3],
    /// Its place among the others.
    pub(super) place: usize,
}

/// Relative size of what counts as nothing.
const NOTHING: f64 = 1e-14;
/// A node whose held directions are nearer than this to each other is left to the borders.
const DEPENDENT: f64 = 1e-6;

impl HeldNode {
    pub(super) fn new(matrix: &Bordered, holding: &Holding, is_reaction: &[bool], friction: Friction) -> Option<Self> {
        let n = matrix.pattern.size();
        let (count, held) = (holding.unknowns.len(), holding.rows.len());
        if held == 0 || held > count || holding.columns.len() != held || !same_columns(matrix, &holding.unknowns) {
            return None;
        }
        let unknowns = held_first(matrix, holding);
        let local = |unknown: usize| unknowns.iter().position(|own| *own == unknown);
        let (mut rows, mut columns) = (Matrix3::zeros(), Matrix3::zeros());
        let mut couplings = [const { Vec::new() }; 3];
        for (index, row) in holding.rows.iter().enumerate() {
            for (column, value) in &matrix.lower[*row] {
                if *column < n {
                    rows[(index, local(*column)?)] += value;
                } else if is_reaction[*column - n] {
                    return None;
                } else {
                    couplings[index].push((*column - n, *value));
                }
            }
        }
        for (index, column) in holding.columns.iter().enumerate() {
            for (row, value) in &matrix.right[*column] {
                columns[(local(*row)?, index)] += value;
            }
        }
        let is_first = held == count || rows.columns(held, count - held).iter().all(|value| *value == 0.0);
        let rotation = if is_first { Matrix3::identity() } else { completed(&rows, held, count)? };
        let largest = columns.amax();
        let constraint = leading(&(rows * rotation), held);
        let turned = rotation.tr_mul(&columns);
        let reaction = leading(&turned, held);
        let mut rest = turned;
        rest.rows_mut(0, held).fill(0.0);
        let rubs = rest.amax() > NOTHING * largest;
        let keeps = rubs && friction == Friction::Bordered;
        let sign_of = |block: &Matrix3<f64>| if held == 1 { block[(0, 0)] } else { block.determinant() }.signum();
        let sign = sign_of(&constraint) * if held % 2 == 1 { -1.0 } else { 1.0 };
        let sign = if keeps { sign } else { sign * sign_of(&reaction) };
        let reaction = inverse(&reaction, held)?;
        let mut own = [[usize::MAX; 3]; 3];
        for (own, given) in own.iter_mut().zip([&unknowns, &holding.rows, &holding.columns]) {
            own[..given.len()].copy_from_slice(given);
        }
        Some(Self {
            unknowns: own[0],
            count,
            held,
            turns: !is_first,
            rotation,
            constraint: inverse(&constraint, held)?,
            reaction,
            friction: (rubs && !keeps).then(|| rest * reaction),
            rows: own[1],
            columns: own[2],
            keeps,
            sign,
            couplings,
            place: 0,
        })
    }

    pub(super) fn unknowns(&self) -> &[usize] {
        &self.unknowns[..self.count]
    }

    /// Its rotated unknowns that are held.
    pub fn held(&self) -> &[usize] {
        &self.unknowns[..self.held]
    }

    pub fn rows(&self) -> &[usize] {
        &self.rows[..self.held]
    }

    pub fn columns(&self) -> &[usize] {
        &self.columns[..self.held]
    }

    pub(super) fn gather(&self, x: &[f64]) -> Vector3<f64> {
        let mut here = Vector3::zeros();
        self.unknowns().iter().enumerate().for_each(|(local, unknown)| here[local] = x[*unknown]);
        here
    }

    /// `Qᵀ K Q`; columns of one node have one pattern.
    pub(super) fn rotate_matrix(&self, matrix: &Bordered, values: &mut [f64]) {
        if !self.turns {
            return;
        }
        let count = self.count;
        for by_row in [false, true] {
            self.each_place(matrix, by_row, |places| {
                let mut before = [0.0; 3];
                (0..count).for_each(|local| before[local] = values[places[local]]);
                for local in 0..count {
                    values[places[local]] = (0..count).map(|other| self.rotation[(other, local)] * before[other]).sum();
                }
            });
        }
    }

    /// Calls with the places of the entries that the node's columns (or rows) have in each row (or column).
    fn each_place(&self, matrix: &Bordered, by_row: bool, mut each: impl FnMut([usize; 3])) {
        let pattern = &matrix.pattern;
        let mut starts = [0; 3];
        self.unknowns().iter().enumerate().for_each(|(local, unknown)| starts[local] = pattern.starts[*unknown]);
        for entry in 0..pattern.column(self.unknowns[0]).len() {
            let mut places = [0; 3];
            for local in 0..self.count {
                let place = starts[local] + entry;
                places[local] = if by_row { pattern.mirrors[place] } else { place };
            }
            each(places);
        }
    }

    /// The entries of its columns (or rows) `H`, added to those taken before, with where they are.
    pub(super) fn take(
        &self,
        matrix: &Bordered,
        values: &[f64],
        by_row: bool,
        taken: &mut Vec<(usize, f64)>,
    ) -> [Range<usize>; 3] {
        let pattern = &matrix.pattern;
        let mut at = [const { 0..0 }; 3];
        for (range, unknown) in at.iter_mut().zip(self.held()) {
            let value = |place: usize| values[if by_row { pattern.mirrors[place] } else { place }];
            let entry = |place: usize| (pattern.rows[place], value(place));
            let start = taken.len();
            taken.extend(pattern.column(*unknown).map(entry).filter(|(_, value)| *value != 0.0));
            *range = start..taken.len();
        }
        at
    }

    /// Rows `T` less `F R⁻¹` times rows `H`.
    pub(super) fn fold(&self, matrix: &Bordered, values: &mut [f64]) {
        let Some(friction) = &self.friction else { return };
        self.each_place(matrix, true, |places| {
            for other in self.held..self.count {
                let taken: f64 = (0..self.held).map(|held| friction[(other, held)] * values[places[held]]).sum();
                values[places[other]] -= taken;
            }
        });
    }

    /// Leaves a one on the diagonal in the held rows and columns.
    pub(super) fn clear(&self, matrix: &Bordered, values: &mut [f64]) {
        let pattern = &matrix.pattern;
        for column in self.held() {
            for place in pattern.column(*column) {
                values[pattern.mirrors[place]] = 0.0;
                values[place] = if pattern.rows[place] == *column { 1.0 } else { 0.0 };
            }
        }
    }
}

/// The node's unknowns, those first that are held where border rows hold as many as they name.
fn held_first(matrix: &Bordered, holding: &Holding) -> Places {
    let is_named = |unknown: &usize| {
        let names = |row: &usize| matrix.lower[*row].iter().any(|(column, value)| column == unknown && *value != 0.0);
        holding.rows.iter().any(names)
    };
    let (named, others): (Places, Places) = holding.unknowns.iter().copied().partition(is_named);
    if named.len() == holding.rows.len() { named.into_iter().chain(others).collect() } else { holding.unknowns.clone() }
}

/// Whether columns have entries in the same rows.
fn same_columns(matrix: &Bordered, unknowns: &[usize]) -> bool {
    let rows = |unknown: usize| &matrix.pattern.rows[matrix.pattern.column(unknown)];
    unknowns.len() <= 3 && unknowns.iter().all(|unknown| rows(*unknown) == rows(unknowns[0]))
}

/// The leading block, with ones on the rest of the diagonal.
fn leading(matrix: &Matrix3<f64>, size: usize) -> Matrix3<f64> {
    Matrix3::from_fn(|row, column| match (row < size, column < size) {
        (true, true) => matrix[(row, column)],
        _ => f64::from(row == column),
    })
}

/// The inverse of a leading block that [`leading`] made.
fn inverse(matrix: &Matrix3<f64>, size: usize) -> Option<Matrix3<f64>> {
    if size == 1 {
        let own = 1.0 / matrix[(0, 0)];
        let mut inverse = Matrix3::identity();
        inverse[(0, 0)] = own;
        return own.is_finite().then_some(inverse);
    }
    let largest = matrix.view((0, 0), (size, size)).amax();
    let inverse = matrix.try_inverse()?;
    let own = inverse.view((0, 0), (size, size)).amax();
    (inverse.iter().all(|value| value.is_finite()) && own * largest * DEPENDENT < 1.0).then_some(inverse)
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
        if own.norm() <= DEPENDENT * size || size == 0.0 {
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
