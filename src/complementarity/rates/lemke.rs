//! Solutions of the rate problem by Lemke's complementary pivot method, where the search was cut short.
//!
//! For given velocities of the contacts and a load rate of 1 or -1, the forces are
//!
//! ```text
//! w = q + M z,      0 <= w ⊥ z >= 0
//! on the cone: (w, z) = (slack, slip)      touching: (ṙ_n, ġ), (μ ṙ_n + ṙ_t, v⁺), (μ ṙ_n - ṙ_t, v⁻),   v = v⁺ - v⁻
//! ```
//!
//! (A. Klarbring, Ing. Arch. 60 (1990) 529). A covering vector `d > 0` with its own variable `z0` gives a feasible
//! basis; the complement of the variable that left enters, until `z0` leaves (a solution) or no variable can leave (a
//! secondary ray: no solution found). Ties are broken lexicographically, so that no basis repeats (R. W. Cottle, J.-S.
//! Pang, R. E. Stone, *The Linear Complementarity Problem*, 1992, sections 4.4 and 4.9). Different covering vectors may
//! lead to different solutions. Each solution gives a combination, which is examined exactly like any other.

use crate::complementarity::rates::gauss_seidel::{Local, rising};
use crate::complementarity::rates::rate_problem::RateProblem;
use crate::complementarity::rates::tolerances::{SMALLEST_PIVOT, TIE_TOLERANCE};
use crate::resources::budget::{self, Taken};
use crate::resources::cancel::CancelFlag;
use nalgebra::DMatrix;
use std::collections::BTreeSet;

/// Largest number of covering vectors for each sign of the load rate.
const MOST_COVERS: usize = 12;
/// Largest number of pivots for each covering vector, per pair.
const MOST_PIVOTS: usize = 10;
/// Largest number of tableau entries that all pivots of one call may change; further covering vectors are not tried.
pub(super) const WORK: usize = 2_000_000_000;

/// A force, and the weight (with a sign) that is its complement.
struct Pair {
    force: usize,
    velocity: usize,
    sign: f64,
}

/// The combinations found by Lemke's method, each once; none where the entities are not plain contacts.
pub fn lemke(problem: &RateProblem, cancel: &CancelFlag) -> Vec<Vec<usize>> {
    let locals: Option<Vec<Local>> = problem.entities.iter().map(|entity| Local::of(problem, entity)).collect();
    let (Some(locals), Some(rising)) = (locals, rising(problem)) else { return Vec::new() };
    let pairs: Vec<Pair> = locals.iter().flat_map(pairs_of).collect();
    let _held = budget::take::<f64>(pairs.len() * pairs.len());
    budget::spend(pairs.len() * pairs.len());
    let (matrix, load) = coefficients(problem, &pairs);
    let mut left = WORK;
    let mut found = Vec::new();
    let mut known = BTreeSet::new();
    for sign in [1.0, -1.0] {
        let constant: Vec<f64> = load.iter().map(|value| value * sign * rising).collect();
        for cover in covers(&constant) {
            if cancel.is_cancelled() || left == 0 {
                return found;
            }
            let Some(positive) = LemkeTableau::new(&matrix, &constant, &cover).solve(&mut left) else { continue };
            let chosen = options(&locals, &positive);
            if known.insert(chosen.clone()) {
                found.push(chosen);
            }
        }
    }
    found
}

fn pairs_of(local: &Local) -> Vec<Pair> {
    match *local {
        Local::Pair { force, velocity } => vec![Pair { force, velocity, sign: 1.0 }],
        Local::Touching { forms, normal, tangential } => vec![
            Pair { force: forms.pressing, velocity: normal, sign: 1.0 },
            Pair { force: forms.cone[0], velocity: tangential, sign: 1.0 },
            Pair { force: forms.cone[1], velocity: tangential, sign: -1.0 },
        ],
    }
}

/// `M` and the coefficients of the load rate; velocities are scaled to unit motion, rows to unit maximum norm.
fn coefficients(problem: &RateProblem, pairs: &[Pair]) -> (DMatrix<f64>, Vec<f64>) {
    let last = problem.weights() - 1;
    let scale = |column: usize| 1.0 / problem.sizes[column].max(f64::MIN_POSITIVE);
    let mut matrix = DMatrix::from_fn(pairs.len(), pairs.len(), |row, column| {
        let Pair { velocity, sign, .. } = pairs[column];
        sign * problem.forms[(pairs[row].force, velocity)] * scale(velocity)
    });
    let mut load: Vec<f64> = pairs.iter().map(|pair| problem.forms[(pair.force, last)] * scale(last)).collect();
    for (mut row, load) in matrix.row_iter_mut().zip(&mut load) {
        let size = row.amax().max(load.abs());
        if size > 0.0 {
            row /= size;
            *load /= size;
        }
    }
    (matrix, load)
}

/// Positive covering vectors: uniform, by the constants, graded, and weighted towards single pairs where the load
/// violates a bound.
pub(super) fn covers(constant: &[f64]) -> Vec<Vec<f64>> {
    let count = constant.len();
    let largest = constant.iter().fold(f64::MIN_POSITIVE, |largest, value| largest.max(value.abs()));
    let mut covers = vec![
        vec![1.0; count],
        constant.iter().map(|value| 1e-3 + value.abs() / largest).collect(),
        (0..count).map(|index| 1.0 + index as f64).collect(),
        (0..count).map(|index| (count - index) as f64).collect(),
    ];
    let broken: Vec<usize> = (0..count).filter(|&index| constant[index] < 0.0).collect();
    let room = MOST_COVERS - covers.len();
    // Distributed over the pairs where there are too many.
    for place in 0..room.min(broken.len()) {
        let mut cover = vec![1.0; count];
        cover[broken[place * broken.len() / room.min(broken.len())]] = 1e3;
        covers.push(cover);
    }
    covers
}

/// The option of each entity, from which of its velocities are basic.
fn options(locals: &[Local], positive: &[bool]) -> Vec<usize> {
    let mut next = 0;
    let mut take = || {
        next += 1;
        positive[next - 1]
    };
    locals
        .iter()
        .map(|local| match local {
            Local::Pair { .. } => usize::from(take()),
            Local::Touching { .. } => match (take(), take(), take()) {
                (false, false, false) => 0,
                (false, true, false) => 1,
                (false, false, true) => 2,
                (true, ..) | (_, true, true) => 3,
            },
        })
        .collect()
}

/// The tableau `[w | z | z0 | q]`, one row per basic variable; the columns of `w` hold the inverse of the basis.
pub(super) struct LemkeTableau {
    rows: DMatrix<f64>,
    basic: Vec<usize>,
    _held: Taken,
}

impl LemkeTableau {
    pub fn new(matrix: &DMatrix<f64>, constant: &[f64], cover: &[f64]) -> Self {
        let count = constant.len();
        let held = budget::take::<f64>(count * (2 * count + 2));
        budget::spend(count * count);
        let mut rows = DMatrix::zeros(count, 2 * count + 2);
        for row in 0..count {
            rows[(row, row)] = 1.0;
            for column in 0..count {
                rows[(row, count + column)] = -matrix[(row, column)];
            }
            rows[(row, 2 * count)] = -cover[row];
            rows[(row, 2 * count + 1)] = constant[row];
        }
        Self { rows, basic: (0..count).collect(), _held: held }
    }

    /// Which `z` are basic at the solution; `None` on a secondary ray, or where the bound on pivots is reached.
    pub fn solve(mut self, left: &mut usize) -> Option<Vec<bool>> {
        let count = self.basic.len();
        let artificial = 2 * count;
        let answer = |basic: &[usize]| (0..count).map(|index| basic.contains(&(count + index))).collect();
        // `z0` enters in the row that requires the largest `z0`: afterwards no basic variable is negative.
        let first = (0..count)
            .filter(|&row| self.constant(row) < 0.0)
            .reduce(|best, row| if self.needs_more(row, best) { row } else { best });
        let Some(first) = first else { return Some(answer(&self.basic)) };
        let complement = |variable: usize| if variable < count { variable + count } else { variable - count };
        let mut entering = complement(self.pivot(first, artificial));
        for _ in 0..MOST_PIVOTS * (count + 1) {
            *left = left.saturating_sub(self.rows.len());
            budget::spend(2 * self.rows.len());
            // A pivot may overflow; the two columns decide which variable leaves.
            let decides = [entering, 2 * count + 1].map(|column| self.rows.column(column).sum().is_finite());
            if *left == 0 || decides != [true; 2] {
                return None;
            }
            let row = self.leaving(entering)?;
            let left_out = self.pivot(row, entering);
            if left_out == artificial {
                return Some(answer(&self.basic));
            }
            entering = complement(left_out);
        }
        None
    }

    fn constant(&self, row: usize) -> f64 {
        self.rows[(row, 2 * self.basic.len() + 1)]
    }

    /// Whether a row needs a larger `z0` than another to be feasible.
    fn needs_more(&self, row: usize, other: usize) -> bool {
        let artificial = 2 * self.basic.len();
        let ratio = |row: usize| self.constant(row) / self.rows[(row, artificial)];
        ratio(row) > ratio(other)
    }

    /// The row whose variable leaves: the smallest ratio, ties broken lexicographically by the rows of the inverse; of
    /// several in a tie, `z0` leaves first.
    fn leaving(&self, entering: usize) -> Option<usize> {
        let count = self.basic.len();
        let size = (0..count).fold(0.0_f64, |size, row| size.max(self.rows[(row, entering)].abs()));
        let mut best: Option<usize> = None;
        for row in (0..count).filter(|&row| self.rows[(row, entering)] > SMALLEST_PIVOT * size.max(1.0)) {
            best = Some(match best {
                Some(known) if !self.comes_before(row, known, entering) => known,
                Some(_) | None => row,
            });
        }
        best
    }

    fn comes_before(&self, row: usize, other: usize, entering: usize) -> bool {
        let count = self.basic.len();
        let ratio = |row: usize, column: usize| self.rows[(row, column)] / self.rows[(row, entering)];
        let compare = |column: usize| {
            let (one, two) = (ratio(row, column), ratio(other, column));
            ((one - two).abs() > TIE_TOLERANCE * one.abs().max(two.abs()).max(SMALLEST_PIVOT)).then_some(one < two)
        };
        if let Some(before) = compare(2 * count + 1) {
            return before;
        }
        if self.basic[row] == 2 * count || self.basic[other] == 2 * count {
            return self.basic[row] == 2 * count;
        }
        (0..count).find_map(compare).unwrap_or(false)
    }

    /// Makes a column basic in a row; returns the variable that leaves.
    fn pivot(&mut self, row: usize, column: usize) -> usize {
        let inverse = 1.0 / self.rows[(row, column)];
        self.rows.row_mut(row).scale_mut(inverse);
        let pivot_row = self.rows.row(row).into_owned();
        let factors = self.rows.column(column).into_owned();
        for (index, mut values) in self.rows.column_iter_mut().enumerate() {
            let pivot = pivot_row[index];
            if pivot != 0.0 {
                for (other, value) in values.iter_mut().enumerate() {
                    if other != row {
                        *value -= factors[other] * pivot;
                    }
                }
            }
        }
        std::mem::replace(&mut self.basic[row], column)
    }
}
