//! Block elimination of a bordered system: nodes constrained by borders, a factorised interior, and the remaining
//! borders.
//!
//! With the constrained unknowns `H` eliminated at their nodes (`nodal_elimination`) and `T` the other unknowns,
//! `[[K, B], [C, D]]` reduces to
//!
//! ```text
//! [[K_TT, B_T + K_TH S], [C_T, D + C_H S]],      S = -M⁻¹ d
//! ```
//!
//! where `S` contains the motions of the constrained unknowns per unit value of each retained border; retained
//! reactions (`Friction::Bordered`) have the equilibrium along `H` as their rows. `border_schur` solves the reduced
//! system by the complement `D - C K⁻¹ B` (mixed block elimination: W. Govaerts, J. D. Pryce, IMA J. Numer. Anal. 13
//! (1993) 161, doi:10.1093/imanum/13.2.161). A change of one border row changes one row of the complement and nothing
//! else.
//!
//! The library's sparse LU of the whole system takes 1.3 times as long with 24 unknowns and 3 borders, 13 times with
//! 1,012 and 16 borders, as its pivoting fills the factors (`cargo bench --bench elimination`, two cores, 2026-11-25).

mod border_values;

use crate::algebra::dense::solve_counters::count_solves;
use crate::algebra::sparse::border_schur::{BorderSchurComplement, Factor};
use crate::algebra::sparse::factors::bordered_matrix::Bordered;
use crate::algebra::sparse::factors::entries::SparseEntries;
use crate::algebra::sparse::factors::ldl::SymmetricFactor;
use crate::algebra::sparse::factors::static_pivot_lu::UnsymmetricFactor;
use crate::algebra::sparse::nodal_elimination::{Coupling, Elimination, Friction, HeldNode, Holdings, gathered, times};
use nalgebra::DMatrix;
use smallvec::SmallVec;

/// The system after block elimination.
pub(super) struct Blocks {
    elimination: Elimination,
    pub reduced: BorderSchurComplement,
    unknowns: usize,
    /// Number of borders: those of the given matrix and those added for unsymmetric entries.
    borders: usize,
    kept_columns: Vec<usize>,
    kept_rows: Vec<ReducedRow>,
    /// For each retained column: the motions of constrained unknowns it causes, and its entries in constrained
    /// equations.
    shifts: Vec<SparseEntries>,
    held_parts: Vec<SparseEntries>,
    /// Sign of the determinant without the factor of the reduced system.
    sign: f64,
}

/// A row of the reduced system.
enum ReducedRow {
    /// A border row, with its entries at constrained unknowns.
    Border(usize, SparseEntries),
    /// The equilibrium along a constrained unknown.
    Equilibrium(usize),
}

/// The part of a right-hand side at the eliminated nodes.
struct AtNodes {
    /// The force at each unknown.
    force: Vec<f64>,
    /// The motions of the constrained unknowns.
    held: Vec<f64>,
}

/// A border row after the elimination of nodes.
struct BorderRow {
    free: SparseEntries,
    held: SparseEntries,
    /// Entries in the retained columns.
    corner: Vec<f64>,
}

/// Number of remaining borders beyond which LU of the whole matrix is cheaper.
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
        // For each row, the constrained unknown whose equilibrium replaces the row; `Some(None)` where the equilibrium
        // is eliminated, too.
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
            Friction::Eliminated => Factor::Unsymmetric(UnsymmetricFactor::new(matrix.pattern.clone(), &values)?),
        };
        let reduced = BorderSchurComplement::new(factor, unknowns, columns, rows, corner)?;
        Some(Self { elimination, reduced, unknowns, borders, kept_columns, kept_rows, shifts, held_parts, sign })
    }

    /// Replaces the entries of a border row that constrains no node, equal to a new elimination to the last bit; `None`
    /// where this requires data that were not stored.
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

    /// Solves for `count` consecutive right-hand sides, overwritten by the solutions.
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

    /// The values at the first `given` borders, one row each, of the solutions for right-hand sides with the given
    /// entries in border rows, one column each.
    pub fn border_values(&self, given: usize, rights: &[SparseEntries]) -> Option<DMatrix<f64>> {
        count_solves(rights.len());
        border_values::border_values(self, given, rights)
    }

    /// Appends the two parts of a right-hand side of the reduced system; returns its part at the eliminated nodes.
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
                // Rows added for unsymmetric entries have a zero right-hand side.
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

    /// The solution of the whole system from the solution of the reduced system.
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
                // `motion` is zero at constrained unknowns: their contribution is in `force`.
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

/// For each retained column, the motions of the constrained unknowns it causes.
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

/// The retained columns of the borders: their entries in free equations and in constrained equations.
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
        free.extend(elimination.eliminated_friction(&held));
        for (unknown, motion) in shift {
            let moved = elimination.stiffness_at(*unknown)?.iter().map(|(row, value)| (*row, value * motion));
            elimination.split_into(moved, &mut free, &mut held);
        }
        columns.push(free);
        held_parts.push(held);
    }
    Some((columns, held_parts))
}

/// A border row in the remaining unknowns and the retained columns.
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
