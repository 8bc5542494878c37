//! Nodes that border rows hold, eliminated where they are.
//!
//! A closed contact adds rows `C u_i + d L = g` at its node `i` and reactions `r` in the node's own equations, so that its
//! saddle point needs no border: with `Q` orthogonal, `y = Qᵀ u_i = (y_H, y_T)` and `C Q = [M, 0]`,
//!
//! ```text
//! y_H = M⁻¹ (g - d L),      R r = f_H - (K y)_H - ...,      QᵀB = [R; F]
//! ```
//!
//! Rows and columns `H` leave the symmetric matrix (a one stays on the diagonal), whose pattern remains. Without friction
//! `F = 0` and `r` follows in the end; with friction (`F != 0`) `r` stays a border, and the equations `H` are its rows.

use super::Entries;
use super::bordered::Bordered;
use nalgebra::{DMatrix, DVector};

/// Border rows that hold unknowns of one node, and the border columns with its reactions, one for each row.
#[derive(Debug, Clone)]
pub struct Holding {
    /// Unknowns of the node.
    pub unknowns: Vec<usize>,
    pub rows: Vec<usize>,
    pub columns: Vec<usize>,
}

/// One node.
pub(super) struct HeldNode {
    pub unknowns: Vec<usize>,
    /// So many of the rotated unknowns are held.
    pub held: usize,
    /// `Q`
    rotation: DMatrix<f64>,
    /// `M⁻¹`
    pub constraint: DMatrix<f64>,
    /// `R⁻¹`
    pub reaction: DMatrix<f64>,
    pub rows: Vec<usize>,
    pub columns: Vec<usize>,
    /// Its reactions stay borders.
    pub keeps: bool,
    /// Sign of the part of the determinant that is eliminated, its place apart.
    pub sign: f64,
    /// `d`: for each row, other borders and values.
    pub couplings: Vec<Entries>,
    /// Columns `H` of the rotated matrix.
    pub stiffness: Vec<Entries>,
}

/// All of them.
pub(super) struct Elimination {
    pub nodes: Vec<HeldNode>,
    /// Node and place in it of each unknown.
    place_of: Vec<Option<(usize, usize)>>,
}

/// Relative size of what counts as nothing.
const NOTHING: f64 = 1e-14;
/// A node whose held directions are nearer than this to each other is left to the borders.
const DEPENDENT: f64 = 1e-6;

impl Elimination {
    /// Eliminates; with the symmetric matrix that is left. A holding that cannot be eliminated so stays in the borders.
    pub fn new(matrix: &Bordered, holdings: &[Holding]) -> (Self, Vec<f64>) {
        let n = matrix.pattern.size();
        let mut is_reaction = vec![false; matrix.lower.len()];
        holdings.iter().flat_map(|holding| &holding.columns).for_each(|column| is_reaction[*column] = true);
        // Reactions that enter border equations stay.
        let mut enters = vec![false; matrix.lower.len()];
        for (column, _) in matrix.lower.iter().flatten() {
            if *column >= n {
                enters[*column - n] = true;
            }
        }
        let mut place_of = vec![None; n];
        let mut nodes: Vec<HeldNode> = Vec::new();
        for holding in holdings {
            let free = holding.unknowns.iter().all(|unknown| place_of[*unknown].is_none());
            if !free || holding.columns.iter().any(|column| enters[*column]) {
                continue;
            }
            let Some(node) = HeldNode::new(matrix, holding, &is_reaction) else { continue };
            for (local, unknown) in node.unknowns.iter().enumerate() {
                place_of[*unknown] = Some((nodes.len(), local));
            }
            nodes.push(node);
        }
        let mut elimination = Self { nodes, place_of };
        let mut values = matrix.values.clone();
        elimination.nodes.iter().for_each(|node| node.rotate_matrix(matrix, &mut values));
        // All columns are taken before any row is cleared: those of neighbours have entries in each other's.
        elimination.nodes.iter_mut().for_each(|node| node.take_columns(matrix, &values));
        elimination.nodes.iter().for_each(|node| node.clear(matrix, &mut values));
        (elimination, values)
    }

    /// Whether an unknown of the rotated system is held.
    pub fn is_held(&self, unknown: usize) -> bool {
        self.place_of[unknown].is_some_and(|(node, local)| local < self.nodes[node].held)
    }

    /// Entries of a row or a column over the rotated unknowns: those that are not held, and those that are.
    pub fn rotated(&self, entries: &[(usize, f64)]) -> (Entries, Entries) {
        let (mut free, mut held) = (Entries::with_capacity(entries.len()), Entries::new());
        let mut at_nodes: Vec<(usize, usize, f64)> = Vec::new();
        for (unknown, value) in entries {
            match self.place_of[*unknown] {
                None => free.push((*unknown, *value)),
                Some((node, local)) => at_nodes.push((node, local, *value)),
            }
        }
        at_nodes.sort_by_key(|(node, local, _)| (*node, *local));
        for group in at_nodes.chunk_by(|a, b| a.0 == b.0) {
            let node = &self.nodes[group[0].0];
            for (place, unknown) in node.unknowns.iter().enumerate() {
                let value: f64 = group.iter().map(|(_, local, value)| node.rotation[(*local, place)] * value).sum();
                if value != 0.0 {
                    if place < node.held { &mut held } else { &mut free }.push((*unknown, value));
                }
            }
        }
        (free, held)
    }

    /// Splits a column of the rotated matrix.
    pub fn split(&self, entries: &[(usize, f64)]) -> (Entries, Entries) {
        entries.iter().partition(|(unknown, _)| !self.is_held(*unknown))
    }

    /// `Qᵀ x` or `Q x` at every node.
    pub fn rotate(&self, x: &mut [f64], back: bool) {
        for node in &self.nodes {
            let here = DVector::from_iterator(node.unknowns.len(), node.unknowns.iter().map(|unknown| x[*unknown]));
            let turned = if back { &node.rotation * here } else { node.rotation.tr_mul(&here) };
            node.unknowns.iter().zip(turned.iter()).for_each(|(unknown, value)| x[*unknown] = *value);
        }
    }
}

impl HeldNode {
    fn new(matrix: &Bordered, holding: &Holding, is_reaction: &[bool]) -> Option<Self> {
        let n = matrix.pattern.size();
        let (count, held) = (holding.unknowns.len(), holding.rows.len());
        if held == 0 || held > count || holding.columns.len() != held || !same_columns(matrix, &holding.unknowns) {
            return None;
        }
        let local = |unknown: usize| holding.unknowns.iter().position(|own| *own == unknown);
        let (mut rows, mut columns) = (DMatrix::zeros(held, count), DMatrix::zeros(count, held));
        let mut couplings = vec![Entries::new(); held];
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
        let rotation = if held == count { DMatrix::identity(count, count) } else { completed(&rows)? };
        let constraint = (&rows * &rotation).columns(0, held).into_owned();
        let turned = rotation.tr_mul(&columns);
        let reaction = turned.rows(0, held).into_owned();
        let friction = turned.rows(held, count - held).amax();
        let sign = constraint.determinant().signum() * if held % 2 == 1 { -1.0 } else { 1.0 };
        let keeps = friction > NOTHING * columns.amax();
        let sign = if keeps { sign } else { sign * reaction.determinant().signum() };
        Some(Self {
            unknowns: holding.unknowns.clone(),
            held,
            rotation,
            constraint: inverse(&constraint)?,
            reaction: inverse(&reaction)?,
            rows: holding.rows.clone(),
            columns: holding.columns.clone(),
            keeps,
            sign,
            couplings,
            stiffness: Vec::new(),
        })
    }

    /// `Qᵀ K Q`; columns of one node have one pattern.
    fn rotate_matrix(&self, matrix: &Bordered, values: &mut [f64]) {
        if self.held == self.unknowns.len() {
            return;
        }
        let count = self.unknowns.len();
        let starts: Vec<usize> = self.unknowns.iter().map(|unknown| matrix.pattern.starts[*unknown]).collect();
        let entries = matrix.pattern.column(self.unknowns[0]).len();
        for by_row in [false, true] {
            for entry in 0..entries {
                let place = |local: usize| {
                    let place = starts[local] + entry;
                    if by_row { matrix.pattern.mirrors[place] } else { place }
                };
                let mut before = [0.0; 3];
                (0..count).for_each(|local| before[local] = values[place(local)]);
                for local in 0..count {
                    values[place(local)] = (0..count).map(|other| self.rotation[(other, local)] * before[other]).sum();
                }
            }
        }
    }

    fn take_columns(&mut self, matrix: &Bordered, values: &[f64]) {
        let pattern = &matrix.pattern;
        let entry = |place: usize| (values[place] != 0.0).then_some((pattern.rows[place], values[place]));
        let column = |unknown: &usize| pattern.column(*unknown).filter_map(entry).collect();
        self.stiffness = self.unknowns[..self.held].iter().map(column).collect();
    }

    /// Leaves a one on the diagonal in the held rows and columns.
    fn clear(&self, matrix: &Bordered, values: &mut [f64]) {
        let pattern = &matrix.pattern;
        for column in &self.unknowns[..self.held] {
            for place in pattern.column(*column) {
                values[pattern.mirrors[place]] = 0.0;
                values[place] = if pattern.rows[place] == *column { 1.0 } else { 0.0 };
            }
        }
    }
}

/// Whether columns have entries in the same rows.
fn same_columns(matrix: &Bordered, unknowns: &[usize]) -> bool {
    let rows = |unknown: usize| &matrix.pattern.rows[matrix.pattern.column(unknown)];
    unknowns.len() <= 3 && unknowns.iter().all(|unknown| rows(*unknown) == rows(unknowns[0]))
}

fn inverse(matrix: &DMatrix<f64>) -> Option<DMatrix<f64>> {
    let largest = matrix.amax();
    let inverse = matrix.clone().try_inverse()?;
    (inverse.iter().all(|value| value.is_finite()) && inverse.amax() * largest * DEPENDENT < 1.0).then_some(inverse)
}

/// An orthogonal matrix whose first columns span the rows.
fn completed(rows: &DMatrix<f64>) -> Option<DMatrix<f64>> {
    let count = rows.ncols();
    let mut basis: Vec<DVector<f64>> = Vec::with_capacity(count);
    let rest = |basis: &[DVector<f64>], vector: &DVector<f64>| {
        let mut rest = vector.clone();
        for _ in 0..2 {
            basis.iter().for_each(|known| rest -= known * known.dot(&rest));
        }
        rest
    };
    for row in rows.row_iter() {
        let row = row.transpose();
        let (own, size) = (rest(&basis, &row), row.norm());
        if own.norm() <= DEPENDENT * size || size == 0.0 {
            return None;
        }
        basis.push(own.normalize());
    }
    while basis.len() < count {
        let units = (0..count).map(|place| rest(&basis, &DVector::from_fn(count, |row, _| f64::from(row == place))));
        let longest = units.reduce(|best, other| if other.norm() > best.norm() { other } else { best })?;
        basis.push(longest.normalize());
    }
    Some(DMatrix::from_columns(&basis))
}
