//! A bordered system taken apart: nodes that borders hold, a factorised interior, and what is left of the borders.
//!
//! With the held unknowns `H` eliminated at their nodes (`nodal_elimination`) and `T` the rest, of `[[K, B], [C, D]]` there remains
//!
//! ```text
//! [[K_TT, B_T + K_TH S], [C_T, D + C_H S]],      S = -M⁻¹ d
//! ```
//!
//! with the motions `S` of the held unknowns by the borders that are kept; reactions that are kept (`Friction::Bordered`)
//! have the equilibrium along `H` for their rows. Its solution by the complement `D - C K⁻¹ B` is `border_schur` (mixed block
//! elimination: W. Govaerts, J. D. Pryce, IMA J. Numer. Anal. 13 (1993) 161, doi:10.1093/imanum/13.2.161). Another border
//! row changes a row of the complement and nothing else.

use crate::algebra::dense::solve_counters::count_solves;
use crate::algebra::sparse::border_schur::{BorderSchurComplement, Factor};
use crate::algebra::sparse::factors::bordered_matrix::Bordered;
use crate::algebra::sparse::factors::entries::SparseEntries;
use crate::algebra::sparse::factors::ldl::SymmetricFactor;
use crate::algebra::sparse::factors::static_pivot_lu::UnsymmetricFactor;
use crate::algebra::sparse::nodal_elimination::{Coupling, Elimination, Friction, HeldNode, Holdings, gathered, times};
use nalgebra::DMatrix;
use smallvec::SmallVec;

/// The system taken apart.
pub(super) struct Blocks {
    elimination: Elimination,
    pub reduced: BorderSchurComplement,
    unknowns: usize,
    /// Borders of the matrix asked for, and those added for what is not symmetric.
    borders: usize,
    kept_columns: Vec<usize>,
    kept_rows: Vec<ReducedRow>,
    /// For each kept column: motions of held unknowns by it, and its entries in held equations.
    shifts: Vec<SparseEntries>,
    held_parts: Vec<SparseEntries>,
    /// Sign of the determinant, that of the reduced system apart.
    sign: f64,
}

/// A row of the reduced system.
enum ReducedRow {
    /// A border row, with its entries at held unknowns.
    Border(usize, SparseEntries),
    /// The equilibrium along a held unknown.
    Equilibrium(usize),
}

/// What a right-hand side leaves at the nodes that are eliminated.
struct AtNodes {
    /// Forces, of each unknown.
    force: Vec<f64>,
    /// Motions of held unknowns.
    held: Vec<f64>,
}

/// What becomes of a border row where nodes are eliminated.
struct BorderRow {
    free: SparseEntries,
    held: SparseEntries,
    /// Its entries in the kept columns.
    corner: Vec<f64>,
}

/// Borders that remain after elimination beyond which LU of the whole is cheaper.
const MOST_BORDERS: usize = 400;

impl Blocks {
    pub fn new(matrix: &Bordered, holdings: &Holdings, friction: Friction) -> Option<Self> {
        let (unknowns, given) = (matrix.pattern.size(), matrix.lower.len());
        let symmetric = (friction == Friction::Bordered).then(|| matrix.symmetrised());
        let matrix = symmetric.as_ref().unwrap_or(matrix);
        let borders = matrix.lower.len();
        let (elimination, values) = Elimination::new(matrix, holdings, friction);
        let mut sign = if (borders - given) % 2 == 1 { -1.0 } else { 1.0 };
        let mut is_kept = vec![true; borders];
        // Of each row the held unknown whose equilibrium takes its place; none where that is eliminated, too.
        let mut equilibrium: Vec<Option<Option<usize>>> = vec![None; borders];
        for node in elimination.nodes() {
            sign *= node.sign();
            for ((row, column), unknown) in node.rows().zip(node.columns()).zip(node.held()) {
                equilibrium[row] = Some(node.keeps.then_some(unknown));
                if !node.keeps {
                    is_kept[column] = false;
                    sign *= if (row + column) % 2 == 1 { -1.0 } else { 1.0 };
                }
            }
        }
        let kept_columns: Vec<usize> = (0..borders).filter(|column| is_kept[*column]).collect();
        let count = kept_columns.len();
        if count > MOST_BORDERS {
            return None;
        }
        let shifts = shifts_of_held(&elimination, &kept_columns)?;
        let (columns, held_parts) = columns_of_rest(&elimination, &matrix.right, &kept_columns, &shifts)?;
        let (mut rows, mut kept_rows) = (Vec::with_capacity(count), Vec::with_capacity(count));
        let mut corner = DMatrix::zeros(count, count);
        for (row, held) in equilibrium.iter().enumerate() {
            let place = rows.len();
            if place == count && *held != Some(None) {
                return None;
            }
            match held {
                Some(None) => continue,
                Some(Some(unknown)) => {
                    let (mut free, mut ignored) = (SparseEntries::new(), SparseEntries::new());
                    let stiffness = elimination.stiffness_at(*unknown)?;
                    elimination.split_into(stiffness.iter().copied(), &mut free, &mut ignored);
                    rows.push(free);
                    for (column, part) in held_parts.iter().enumerate() {
                        let own = part.iter().filter(|(at, _)| at == unknown).map(|(_, value)| value);
                        corner[(place, column)] += own.sum::<f64>();
                    }
                    kept_rows.push(ReducedRow::Equilibrium(*unknown));
                }
                None => {
                    let border = border_row(&elimination, &matrix.lower[row], unknowns, &kept_columns, &shifts)?;
                    border.corner.iter().enumerate().for_each(|(column, value)| corner[(place, column)] = *value);
                    rows.push(border.free);
                    kept_rows.push(ReducedRow::Border(row, border.held));
                }
            }
        }
        if rows.len() != count {
            return None;
        }
        let factor = match friction {
            Friction::Bordered => Factor::Symmetric(SymmetricFactor::new(matrix.pattern.clone(), &values).ok()?),
            Friction::Folded => Factor::Unsymmetric(UnsymmetricFactor::new(matrix.pattern.clone(), &values)?),
        };
        let reduced = BorderSchurComplement::new(factor, unknowns, columns, rows, corner)?;
        Some(Self { elimination, reduced, unknowns, borders, kept_columns, kept_rows, shifts, held_parts, sign })
    }

    /// The same with other entries in a border row that holds nothing, to the last bit; `None` where that takes more than
    /// was kept.
    pub fn with_row(mut self, row: usize, entries: &SparseEntries) -> Option<Self> {
        let is_it = |kept: &ReducedRow| matches!(kept, ReducedRow::Border(own, _) if *own == row);
        let place = self.kept_rows.iter().position(is_it)?;
        let border = border_row(&self.elimination, entries, self.unknowns, &self.kept_columns, &self.shifts)?;
        self.reduced = self.reduced.with_row(place, border.free, &border.corner)?;
        self.kept_rows[place] = ReducedRow::Border(row, border.held);
        Some(self)
    }

    /// Sign of the determinant.
    pub fn determinant_sign(&self) -> f64 {
        self.sign * self.reduced.sign()
    }

    /// Solves for so many right-hand sides one after the other, overwritten by the solutions.
    pub fn solve(&self, values: &mut [f64], count: usize) -> bool {
        count_solves(count);
        let size = values.len() / count.max(1);
        let kept = self.kept_rows.len();
        let mut motions = Vec::with_capacity(count * self.unknowns);
        let mut weights = Vec::with_capacity(count * kept);
        let mut at_nodes: SmallVec<[AtNodes; 1]> = SmallVec::with_capacity(count);
        for right in values.chunks_exact(size.max(1)) {
            at_nodes.push(self.without_nodes(right, &mut motions, &mut weights));
        }
        if !self.reduced.solve(&mut motions, &mut weights, count) {
            return false;
        }
        for (number, (solution, at_nodes)) in values.chunks_exact_mut(size.max(1)).zip(at_nodes).enumerate() {
            let motion = &mut motions[number * self.unknowns..][..self.unknowns];
            self.with_nodes(motion, &weights[number * kept..][..kept], at_nodes, solution);
        }
        true
    }

    /// A right-hand side of the reduced system, which is appended, in its two parts; and what it leaves at the nodes.
    fn without_nodes(&self, values: &[f64], motions: &mut Vec<f64>, weights: &mut Vec<f64>) -> AtNodes {
        let (upper, lower) = values.split_at(self.unknowns);
        let mut force = upper.to_vec();
        self.elimination.rotate(&mut force, false);
        self.elimination.fold(&mut force);
        let mut held = vec![0.0; self.unknowns];
        for node in self.elimination.nodes() {
            let constraint = self.elimination.matrices(node).constraint;
            let motion = times(constraint, node.held().len(), &gathered(node.rows(), lower));
            for (index, (unknown, motion)) in node.held().zip(motion.iter()).enumerate() {
                held[unknown] = *motion;
                let stiffness = self.elimination.stiffness(node, index);
                stiffness.iter().for_each(|(row, value)| force[*row] -= value * motion);
            }
        }
        let right = |row: &ReducedRow| match row {
            ReducedRow::Equilibrium(unknown) => force[*unknown],
            ReducedRow::Border(row, entries) => {
                // Rows added for what is not symmetric have nothing on the right.
                let given = lower.get(*row).copied().unwrap_or(0.0);
                given - entries.iter().map(|(unknown, value)| value * held[*unknown]).sum::<f64>()
            }
        };
        weights.extend(self.kept_rows.iter().map(right));
        let first = motions.len();
        motions.extend_from_slice(&force);
        self.elimination.nodes().iter().flat_map(HeldNode::held).for_each(|unknown| motions[first + unknown] = 0.0);
        AtNodes { force, held }
    }

    /// The solution from that of the reduced system.
    fn with_nodes(&self, motion: &mut [f64], weights: &[f64], at_nodes: AtNodes, values: &mut [f64]) {
        let AtNodes { mut force, mut held } = at_nodes;
        let (upper, lower) = values.split_at_mut(self.unknowns);
        let mut borders = vec![0.0; self.borders];
        for ((column, weight), (shift, part)) in
            self.kept_columns.iter().zip(weights).zip(self.shifts.iter().zip(&self.held_parts))
        {
            borders[*column] = *weight;
            shift.iter().for_each(|(unknown, motion)| held[*unknown] += weight * motion);
            part.iter().for_each(|(unknown, value)| force[*unknown] -= weight * value);
        }
        for node in self.elimination.nodes() {
            for (index, unknown) in node.held().enumerate() {
                // `motion` is zero at held unknowns: their part is in `force`.
                let equilibrium = self.elimination.equilibrium(node, index);
                force[unknown] -= equilibrium.iter().map(|(row, value)| value * motion[*row]).sum::<f64>();
            }
        }
        for node in self.elimination.nodes() {
            if !node.keeps {
                let reaction = self.elimination.matrices(node).reaction;
                let reactions = times(reaction, node.held().len(), &gathered(node.held(), &force));
                node.columns().zip(reactions.iter()).for_each(|(column, value)| borders[column] = *value);
            }
            node.held().for_each(|unknown| motion[unknown] = held[unknown]);
        }
        self.elimination.rotate(motion, true);
        upper.copy_from_slice(motion);
        lower.copy_from_slice(&borders[..lower.len()]);
    }
}

/// For each kept column the motions of held unknowns by it.
fn shifts_of_held(elimination: &Elimination, kept_columns: &[usize]) -> Option<Vec<SparseEntries>> {
    let mut shifts = vec![SparseEntries::new(); kept_columns.len()];
    for Coupling { node, row, border, value } in elimination.couplings() {
        let node = &elimination.nodes()[*node];
        let shift = &mut shifts[kept_columns.binary_search(border).ok()?];
        let constraint = elimination.matrices(node).constraint.chunks_exact(node.held().len()).nth(*row)?;
        shift.extend(node.held().zip(constraint).map(|(unknown, entry)| (unknown, -entry * value)));
    }
    Some(shifts)
}

/// The kept columns of the borders: their entries in the other equations and those in held ones.
fn columns_of_rest(
    elimination: &Elimination,
    right: &[SparseEntries],
    kept_columns: &[usize],
    shifts: &[SparseEntries],
) -> Option<(Vec<SparseEntries>, Vec<SparseEntries>)> {
    let count = kept_columns.len();
    let (mut columns, mut held_parts) = (Vec::with_capacity(count), Vec::with_capacity(count));
    for (column, shift) in kept_columns.iter().zip(shifts) {
        let (mut free, mut held) = elimination.rotated(&right[*column]);
        free.extend(elimination.folded(&held));
        for (unknown, motion) in shift {
            let moved = elimination.stiffness_at(*unknown)?.iter().map(|(row, value)| (*row, value * motion));
            elimination.split_into(moved, &mut free, &mut held);
        }
        columns.push(free);
        held_parts.push(held);
    }
    Some((columns, held_parts))
}

/// A border row over what is left of the unknowns and over the kept columns.
fn border_row(
    elimination: &Elimination,
    entries: &SparseEntries,
    unknowns: usize,
    kept_columns: &[usize],
    shifts: &[SparseEntries],
) -> Option<BorderRow> {
    let (inner, outer): (SparseEntries, SparseEntries) =
        entries.iter().copied().partition(|(column, _)| *column < unknowns);
    let (free, held) = elimination.rotated(&inner);
    let mut corner = vec![0.0; kept_columns.len()];
    for (column, value) in outer {
        corner[kept_columns.binary_search(&(column - unknowns)).ok()?] += value;
    }
    if shifts.iter().any(|shift| !shift.is_empty()) {
        let mut at = vec![0.0; unknowns];
        held.iter().for_each(|(unknown, value)| at[*unknown] += value);
        for (sum, shift) in corner.iter_mut().zip(shifts) {
            *sum += shift.iter().map(|(unknown, motion)| at[*unknown] * motion).sum::<f64>();
        }
    }
    Some(BorderRow { free, held, corner })
}
