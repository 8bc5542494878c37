//! A factorisation of the whole bordered system that says when it cannot be trusted.
//!
//! Block elimination with a symmetric matrix that may be near singular loses digits in it; here its small pivots are
//! raised and the raises are borders, so that it does not, and iterative refinement on the whole mends the rest (after W.
//! Govaerts, J. D. Pryce, IMA J. Numer. Anal. 13 (1993) 161, doi:10.1093/imanum/13.2.161: mixed block elimination). A
//! solution is accepted by its backward error (W. Oettli, W. Prager, Numer. Math. 6 (1964) 405, doi:10.1007/BF01386090);
//! where that fails, a sparse LU factorisation of the whole takes over.

use super::Entries;
use super::bordered::Bordered;
use super::held::{Elimination, Friction, Holdings};
use super::lu::WholeLu;
use super::reduced::{Factor, Reduced};
use super::symmetric::SymmetricFactor;
use super::unsymmetric::UnsymmetricFactor;
use crate::linear_algebra::Inertia;
use nalgebra::{DMatrix, DVector, Vector3};
use smallvec::smallvec;
use std::cell::OnceCell;
use std::sync::Arc;

/// See the module.
pub struct SparseFactorisation {
    matrix: Bordered,
    blocks: Option<Blocks>,
    /// Made when first needed.
    whole: OnceCell<Option<WholeLu>>,
    sign: f64,
    pivot_ratio: f64,
}

/// Backward error at which a solution is as good as rounding allows.
const GOOD: f64 = 1e-15;
/// Backward error up to which a solution is accepted.
const ACCEPTED: f64 = 1e-11;
/// Pivots of the complement above this speak for a regular matrix.
const CERTAIN: f64 = 1e-6;
/// Error of a solution of size 1 that is known, from which a matrix counts as singular.
const SINGULAR: f64 = 1e-3;
/// Refinements of one solution.
const MOST_REFINEMENTS: usize = 6;
/// Borders that remain after elimination beyond which LU of the whole is cheaper.
const MOST_BORDERS: usize = 400;

impl SparseFactorisation {
    /// Factorises; `None` when the matrix is singular to working precision or holds a number that is not finite.
    pub fn new(matrix: Bordered, holdings: &Holdings) -> Option<Self> {
        let friction = friction_of(&matrix, holdings);
        Self::with(matrix, holdings, friction)
    }

    pub(super) fn with(matrix: Bordered, holdings: &Holdings, friction: Friction) -> Option<Self> {
        if matrix.is_outside || !matrix.is_finite() {
            return None;
        }
        // A complement that is nothing but rounding says nothing.
        let blocks =
            Blocks::new(&matrix, holdings, friction).filter(|blocks| blocks.reduced.pivot_ratio > f64::EPSILON);
        let (sign, pivot_ratio) =
            blocks.as_ref().map_or((1.0, 0.0), |blocks| (blocks.sign, blocks.reduced.pivot_ratio));
        let factorisation = Self { matrix, blocks, whole: OnceCell::new(), sign, pivot_ratio };
        (pivot_ratio > CERTAIN || factorisation.finds_what_is_known()).then_some(factorisation)
    }

    /// Whether solutions that are known come out: near a singular matrix they do not, however small the residual.
    fn finds_what_is_known(&self) -> bool {
        let first = |row: usize| 1.0 + (row % 7) as f64 / 8.0;
        let second = |row: usize| if row % 3 == 1 { -1.0 } else { 1.0 - (row % 11) as f64 / 16.0 };
        let comes_out = |entry: &dyn Fn(usize) -> f64| {
            let known = DVector::from_fn(self.matrix.size(), |row, _| entry(row));
            let (mut values, mut sizes) = (DVector::zeros(known.len()), vec![0.0; known.len()]);
            self.matrix.multiply(known.as_slice(), values.as_mut_slice(), &mut sizes);
            self.solve(&mut values) && (values - known).amax() <= SINGULAR
        };
        comes_out(&first) && comes_out(&second)
    }

    /// Sign of the determinant: 1 or -1; certain only where [`Self::pivot_ratio`] is not 0.
    pub fn determinant_sign(&self) -> f64 {
        self.sign
    }

    /// Smallest pivot of the complement of the borders over the size of its terms; 0 where that was not formed.
    pub fn pivot_ratio(&self) -> f64 {
        self.pivot_ratio
    }

    /// How far pivots are from each other at the most, those of the complement with them: where this is small, stiff and
    /// soft parts may have been added up.
    pub fn spread(&self) -> f64 {
        self.blocks.as_ref().map_or(0.0, |blocks| blocks.reduced.pivot_ratio.min(blocks.reduced.factor.pivot_ratio()))
    }

    /// Solves for one right-hand side, overwritten by the solution; `false` when no accurate solution was found.
    pub fn solve(&self, right_hand_side: &mut DVector<f64>) -> bool {
        let blocks = self.blocks.as_ref();
        if let Some(solution) = blocks.and_then(|blocks| self.refined(right_hand_side, |values| blocks.solve(values))) {
            right_hand_side.copy_from(&solution);
            return true;
        }
        let Some(whole) = self.whole.get_or_init(|| WholeLu::new(&self.matrix)) else { return false };
        match self.refined(right_hand_side, |values| whole.solve(values)) {
            Some(solution) => {
                right_hand_side.copy_from(&solution);
                true
            }
            None => false,
        }
    }

    /// Solves without refinement; `false` where block elimination gives no result.
    pub fn solve_once(&self, values: &mut DVector<f64>) -> bool {
        self.blocks.as_ref().is_some_and(|blocks| blocks.solve(values.as_mut_slice()))
    }

    /// Whether another matrix has the same unknowns and as many borders.
    pub(super) fn is_like(&self, matrix: &Bordered) -> bool {
        Arc::ptr_eq(&self.matrix.pattern, &matrix.pattern) && self.matrix.lower.len() == matrix.lower.len()
    }

    pub(super) fn last_row(&self) -> Option<&Entries> {
        self.matrix.lower.last()
    }

    fn refined(&self, right: &DVector<f64>, solve: impl Fn(&mut [f64]) -> bool) -> Option<DVector<f64>> {
        let mut solution = right.clone();
        if !solve(solution.as_mut_slice()) {
            return None;
        }
        let mut best: Option<(f64, DVector<f64>)> = None;
        let (mut product, mut sizes) = (DVector::zeros(right.len()), vec![0.0; right.len()]);
        for _ in 0..MOST_REFINEMENTS {
            self.matrix.multiply(solution.as_slice(), product.as_mut_slice(), &mut sizes);
            let mut rest = right - &product;
            let error = backward_error(rest.as_slice(), right.as_slice(), &sizes);
            let halved = best.as_ref().is_none_or(|(least, _)| error < 0.5 * least);
            if best.as_ref().is_none_or(|(least, _)| error < *least) {
                best = Some((error, solution.clone()));
            }
            if error <= GOOD || !halved || !solve(rest.as_mut_slice()) {
                break;
            }
            solution += rest;
        }
        best.filter(|(error, _)| *error <= ACCEPTED).map(|(_, solution)| solution)
    }
}

/// The largest residual over the sizes of its terms.
pub(super) fn backward_error(rest: &[f64], right: &[f64], sizes: &[f64]) -> f64 {
    let largest = sizes.iter().fold(0.0_f64, |largest, size| largest.max(*size));
    let mut error = 0.0_f64;
    for ((rest, right), size) in rest.iter().zip(right).zip(sizes) {
        if !rest.is_finite() {
            return f64::INFINITY;
        }
        // A row whose terms are all but nothing is judged by the others.
        let terms = (size + right.abs()).max(f64::EPSILON * largest);
        if terms > 0.0 {
            error = error.max(rest.abs() / terms);
        }
    }
    error
}

/// The system taken apart.
struct Blocks {
    elimination: Elimination,
    reduced: Reduced,
    unknowns: usize,
    /// Borders of the matrix asked for, and those added for what is not symmetric.
    borders: usize,
    kept_columns: Vec<usize>,
    kept_rows: Vec<Row>,
    /// For each kept column: motions of held unknowns by it, and its entries in held equations.
    shifts: Vec<Entries>,
    held_parts: Vec<Entries>,
    sign: f64,
}

/// A row of the reduced system.
enum Row {
    /// A border row, with its entries at held unknowns.
    Border(usize, Entries),
    /// The equilibrium along a held unknown.
    Equilibrium(usize),
}

impl Blocks {
    fn new(matrix: &Bordered, holdings: &Holdings, friction: Friction) -> Option<Self> {
        let (unknowns, given) = (matrix.pattern.size(), matrix.lower.len());
        let symmetric = (friction == Friction::Bordered).then(|| symmetrised(matrix));
        let matrix = symmetric.as_ref().unwrap_or(matrix);
        let borders = matrix.lower.len();
        let (elimination, values) = Elimination::new(matrix, holdings, friction);
        let mut sign = if (borders - given) % 2 == 1 { -1.0 } else { 1.0 };
        let mut is_kept = vec![true; borders];
        let mut equilibrium: Vec<Option<Option<usize>>> = vec![None; borders];
        let mut shifts = vec![Entries::new(); borders];
        let mut stiffness_of = vec![None; unknowns];
        for node in elimination.nodes() {
            sign *= node.sign;
            for (index, (row, column)) in node.rows().iter().zip(node.columns()).enumerate() {
                equilibrium[*row] = Some(node.keeps.then_some(node.held()[index]));
                if !node.keeps {
                    is_kept[*column] = false;
                    sign *= if (row + column) % 2 == 1 { -1.0 } else { 1.0 };
                }
                stiffness_of[node.held()[index]] = Some(elimination.stiffness(node, index));
                for (border, value) in &node.couplings[index] {
                    for (held, unknown) in node.held().iter().enumerate() {
                        shifts[*border].push((*unknown, -node.constraint[(held, index)] * value));
                    }
                }
            }
        }
        let kept_columns: Vec<usize> = (0..borders).filter(|column| is_kept[*column]).collect();
        if kept_columns.len() > MOST_BORDERS {
            return None;
        }
        let mut index_of = vec![usize::MAX; borders];
        kept_columns.iter().enumerate().for_each(|(index, column)| index_of[*column] = index);
        let count = kept_columns.len();
        let (mut columns, mut held_parts, mut kept_shifts) = (Vec::new(), Vec::new(), Vec::new());
        for column in &kept_columns {
            let (mut free, mut held) = elimination.rotated(&matrix.right[*column]);
            free.extend(elimination.folded(&held));
            for (unknown, motion) in &shifts[*column] {
                let moved = stiffness_of[*unknown]?.iter().map(|(row, value)| (*row, value * motion));
                let (to_free, to_held) = elimination.split(&moved.collect::<Entries>());
                free.extend(to_free);
                held.extend(to_held);
            }
            columns.push(free);
            held_parts.push(held);
            kept_shifts.push(std::mem::take(&mut shifts[*column]));
        }
        let (mut rows, mut kept_rows) = (Vec::new(), Vec::new());
        let mut corner = DMatrix::zeros(count, count);
        let mut scratch = vec![0.0; unknowns];
        for (row, held) in equilibrium.iter().enumerate() {
            let place = rows.len();
            match held {
                Some(None) => continue,
                Some(Some(unknown)) => {
                    let (free, _) = elimination.split(stiffness_of[*unknown]?);
                    rows.push(free);
                    for (column, part) in held_parts.iter().enumerate() {
                        let own = part.iter().filter(|(at, _)| at == unknown).map(|(_, value)| value);
                        corner[(place, column)] += own.sum::<f64>();
                    }
                    kept_rows.push(Row::Equilibrium(*unknown));
                }
                None => {
                    let (inner, outer): (Entries, Entries) =
                        matrix.lower[row].iter().copied().partition(|(column, _)| *column < unknowns);
                    let (free, held) = elimination.rotated(&inner);
                    for (column, value) in outer {
                        *corner.get_mut((place, *index_of.get(column - unknowns)?))? += value;
                    }
                    held.iter().for_each(|(unknown, value)| scratch[*unknown] += value);
                    for (column, shift) in kept_shifts.iter().enumerate() {
                        corner[(place, column)] +=
                            shift.iter().map(|(unknown, motion)| scratch[*unknown] * motion).sum::<f64>();
                    }
                    held.iter().for_each(|(unknown, _)| scratch[*unknown] = 0.0);
                    rows.push(free);
                    kept_rows.push(Row::Border(row, held));
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
        let reduced = Reduced::new(factor, unknowns, columns, rows, corner)?;
        let sign = sign * reduced.sign;
        let shifts = kept_shifts;
        Some(Self { elimination, reduced, unknowns, borders, kept_columns, kept_rows, shifts, held_parts, sign })
    }

    fn solve(&self, values: &mut [f64]) -> bool {
        let (upper, lower) = values.split_at_mut(self.unknowns);
        let mut force = upper.to_vec();
        self.elimination.rotate(&mut force, false);
        self.elimination.fold(&mut force);
        let mut held = vec![0.0; self.unknowns];
        for node in self.elimination.nodes() {
            let motion = node.constraint * gathered(node.rows(), lower);
            for (index, (unknown, motion)) in node.held().iter().zip(motion.iter()).enumerate() {
                held[*unknown] = *motion;
                let stiffness = self.elimination.stiffness(node, index);
                stiffness.iter().for_each(|(row, value)| force[*row] -= value * motion);
            }
        }
        let right = |row: &Row| match row {
            Row::Equilibrium(unknown) => force[*unknown],
            Row::Border(row, entries) => {
                // Rows added for what is not symmetric have nothing on the right.
                let given = lower.get(*row).copied().unwrap_or(0.0);
                given - entries.iter().map(|(unknown, value)| value * held[*unknown]).sum::<f64>()
            }
        };
        let mut weights: Vec<f64> = self.kept_rows.iter().map(right).collect();
        let mut motion = force.clone();
        self.elimination.nodes().iter().flat_map(|node| node.held()).for_each(|unknown| motion[*unknown] = 0.0);
        if !self.reduced.solve(&mut motion, &mut weights) {
            return false;
        }
        let mut borders = vec![0.0; self.borders];
        for ((column, weight), (shift, part)) in
            self.kept_columns.iter().zip(&weights).zip(self.shifts.iter().zip(&self.held_parts))
        {
            borders[*column] = *weight;
            shift.iter().for_each(|(unknown, motion)| held[*unknown] += weight * motion);
            part.iter().for_each(|(unknown, value)| force[*unknown] -= weight * value);
        }
        for node in self.elimination.nodes() {
            for (index, unknown) in node.held().iter().enumerate() {
                // `motion` is zero at held unknowns: their part is in `force`.
                let equilibrium = self.elimination.equilibrium(node, index);
                force[*unknown] -= equilibrium.iter().map(|(row, value)| value * motion[*row]).sum::<f64>();
            }
        }
        for node in self.elimination.nodes() {
            if !node.keeps {
                let reactions = node.reaction * gathered(node.held(), &force);
                node.columns().iter().zip(reactions.iter()).for_each(|(column, value)| borders[*column] = *value);
            }
            node.held().iter().for_each(|unknown| motion[*unknown] = held[*unknown]);
        }
        self.elimination.rotate(&mut motion, true);
        upper.copy_from_slice(&motion);
        lower.copy_from_slice(&borders[..lower.len()]);
        true
    }
}

/// Values at up to three places, zero after them.
fn gathered(places: &[usize], values: &[f64]) -> Vector3<f64> {
    let mut gathered = Vector3::zeros();
    places.iter().enumerate().for_each(|(index, place)| gathered[index] = values[*place]);
    gathered
}

/// Multiplications that a factorisation without symmetry may take where nothing speaks against it.
const LITTLE: u64 = 1_000_000;
/// A multiplication in it takes so many times one of the symmetric factorisation and its solves, which go by blocks.
const SLOWER: u64 = 4;

/// What is cheaper: borders for what is not symmetric, a solve each, or a factorisation without symmetry.
fn friction_of(matrix: &Bordered, holdings: &Holdings) -> Friction {
    let pattern = &matrix.pattern;
    let entries = pattern.factor_entries() as u64;
    let rubs = |(row, column): &(&usize, &usize)| {
        let row = &matrix.lower[**row];
        matrix.right[**column].iter().any(|(unknown, value)| !row.contains(&(*unknown, -value)))
    };
    let pairs = holdings.iter().flat_map(|holding| holding.rows.iter().zip(&holding.columns));
    let solves = pairs.filter(rubs).count() as u64;
    // The work is at least the entries squared over the unknowns: it need not be counted where that is already too much.
    let least = entries.saturating_mul(entries) / (pattern.size() as u64).max(1);
    let most = LITTLE.max(entries.saturating_mul(2 * solves) / SLOWER);
    if least <= most && pattern.fill().work <= most { Friction::Folded } else { Friction::Bordered }
}

/// The matrix with a symmetric `K`: a row `a` that it has more becomes a border `[[K, e], [a, -1]]`.
fn symmetrised(matrix: &Bordered) -> Bordered {
    let mut whole = matrix.clone();
    let mut extra: Vec<(usize, Entries)> = Vec::new();
    let mut touched: Vec<(usize, usize)> =
        matrix.touched.iter().filter(|(row, column)| row > column).copied().collect();
    touched.extend(matrix.touched.iter().filter(|(row, column)| row < column).map(|(row, column)| (*column, *row)));
    touched.sort_unstable();
    touched.dedup();
    let borders = matrix.lower.len();
    for (row, column) in touched {
        let (Some(below), Some(above)) = (matrix.pattern.place(row, column), matrix.pattern.place(column, row)) else {
            continue;
        };
        let difference = matrix.values[below] - matrix.values[above];
        let size = matrix.values[below].abs().max(matrix.values[above].abs());
        if difference.abs() <= 4.0 * f64::EPSILON * size {
            continue;
        }
        // The triangle above is the rule.
        whole.values[below] = matrix.values[above];
        match extra.iter_mut().find(|(known, _)| *known == row) {
            Some((_, entries)) => entries.push((column, difference)),
            None => extra.push((row, smallvec![(column, difference)])),
        }
    }
    for (index, (row, mut entries)) in extra.into_iter().enumerate() {
        let border = matrix.pattern.size() + borders + index;
        entries.push((border, -1.0));
        whole.right.push(smallvec![(row, 1.0)]);
        whole.lower.push(entries);
    }
    whole
}

/// Numbers of eigenvalues by sign of `Zᵀ K Z`, `Z` the motions that the holdings allow. `None` where the count is not
/// possible: `K` is not symmetric, or a holding could not be eliminated.
pub fn held_inertia(matrix: &Bordered, holdings: &Holdings, tolerance: f64) -> Option<Inertia> {
    if matrix.is_outside || symmetrised(matrix).lower.len() != matrix.lower.len() {
        return None;
    }
    let (elimination, values) = Elimination::new(matrix, holdings, Friction::Bordered);
    if elimination.nodes().len() != holdings.iter().len() {
        return None;
    }
    let held: usize = elimination.nodes().iter().map(|node| node.held().len()).sum();
    let mut inertia = SymmetricFactor::new(matrix.pattern.clone(), &values).ok()?.inertia(tolerance)?;
    inertia.positive = inertia.positive.checked_sub(held)?;
    Some(inertia)
}
