//! Points of spatial slip at which the direction of the path is indeterminate.
//!
//! Slip in a plane obeys differential equations. Let `φ = μ r_n - |r_t|`, `q = dφ/ds` with the node stuck and `M = dφ`
//! along the slip, so that the slip rate `α` and the load rate obey `M α + q ṡ = 0`. Where `q` and `M` vanish together
//! any `α >= 0` and any `ṡ` satisfy it. In the terminology of fast-slow systems the point is a folded singularity (M.
//! Desroches et al., SIAM Rev. 54 (2012) 211, doi:10.1137/100791233): a folded node attracts all paths nearby, and
//! beyond it a whole family of paths leaves.
//!
//! In general it is a point at which the rate equations `A ẋ = 0` have a second solution, while the state equations
//! (without those of the slip tracks) are regular; where the state equations are singular it is a bifurcation point.
//! The sign of the bordered determinant changes at the point. Newton's method on the states finds it: with borders `ψ`,
//! `B` from the null vectors of `A` nearby, `A X + ψ g = 0`, `Bᵀ X = I` give the test functions `g`, which vanish
//! exactly where the second solution exists (W. Govaerts, *Numerical Methods for Bifurcations of Dynamical Equilibria*,
//! SIAM 2000, chapter 3). With several tracks such points form a set; the nearest point is taken.

use crate::algebra::{Factorisation, nearest_null_space, null_space_as_scaled};
use crate::branching::bifurcation::locate::tolerances::{
    ACCEPTED_VIOLATION, DIFFERENCE_STEP, FOLDED_CORRECTION, SEARCH_REACH, STATE_RANK_TOLERANCE,
};
use crate::mechanics::equations::{Iterate, Kind, ModeSystem, Role, matrix, rate_recovery, residual};
use crate::step::corrector::newton;
use crate::step::corrector::tolerances::ACCEPTED_RESIDUAL;
use crate::step::event_functions::{self, EventFunction};
use crate::step::mode_step::{Reached, StepStart};
use nalgebra::{DMatrix, DVector};

/// Newton iterations.
const MOST_ITERATIONS: usize = 20;

/// The point near a step at which the direction is indeterminate, if there is one.
pub fn locate(start: &StepStart<'_>, reached: &Reached) -> Option<Box<Reached>> {
    let system = ModeSystem::new(start.loading, start.modes, start.state);
    let tracks: Vec<usize> = system
        .roles
        .iter()
        .enumerate()
        .filter(|(_, role)| matches!(role, Role::Plane { .. }))
        .map(|(contact, _)| system.row_of(contact) + 1)
        .collect();
    let search = FoldedSingularitySearch { system, tracks };
    let iterate = search.found(search.system.iterate_of(&reached.corrected), SEARCH_REACH * reached.step)?;
    let corrected = newton::judged_as_state(&search.system, iterate, &search.tracks, start.force_scale);
    let step = corrected.state.distance(start.state);
    if corrected.residual > ACCEPTED_RESIDUAL || step > SEARCH_REACH * reached.step || step <= 0.0 {
        return None;
    }
    let mut rate = start.state.chord(&corrected.state);
    rate.scale(1.0 / step);
    // The node has reached the point in continued slip, without another event.
    let holds = |event_function: &EventFunction| {
        let value = event_function.value(start.loading, start.modes, &corrected.state, &rate);
        value >= -ACCEPTED_VIOLATION * event_function.scale(start.loading, &corrected.state, start.force_scale)
    };
    if !event_functions::of_mode(start.loading, start.modes, start.state, start.rate).iter().all(holds) {
        return None;
    }
    let error_estimate = newton::off_track(&corrected, &search.tracks);
    Some(Reached::new(corrected, rate, step, error_estimate))
}

struct FoldedSingularitySearch<'a> {
    system: ModeSystem<'a>,
    /// Rows of the tracks' equations.
    tracks: Vec<usize>,
}

impl FoldedSingularitySearch<'_> {
    fn found(&self, guess: Iterate, reach: f64) -> Option<Iterate> {
        let origin = guess.state.clone();
        let mut iterate = self.projected(guess)?;
        let (psi, borders) = self.borders(&iterate)?;
        let mut smallest = f64::INFINITY;
        for _ in 0..MOST_ITERATIONS {
            let (states, _) = self.equations(&iterate)?;
            let ways = nearest_null_space(states, self.tracks.len() + 1)?;
            let here = self.tests(&iterate, &psi, &borders)?;
            let mut slopes = DMatrix::zeros(2, ways.ncols());
            for (column, way) in ways.column_iter().enumerate() {
                let moved = |by: f64| {
                    let values = way * -by;
                    self.tests(&rate_recovery::corrected_by(&self.system, iterate.clone(), &values), &psi, &borders)
                };
                slopes.set_column(
                    column,
                    &((moved(DIFFERENCE_STEP)? - moved(-DIFFERENCE_STEP)?) / (2.0 * DIFFERENCE_STEP)),
                );
            }
            let weights = slopes.svd(true, true).solve(&here, f64::EPSILON).ok()?;
            let correction = &ways * weights;
            let size = correction.amax();
            if !size.is_finite() || size > reach.max(0.1) {
                return None;
            }
            iterate = self.projected(rate_recovery::corrected_by(&self.system, iterate, &correction))?;
            if iterate.state.distance(&origin) > 2.0 * reach {
                return None;
            }
            if size <= FOLDED_CORRECTION && size >= 0.25 * smallest || size <= 1e-3 * FOLDED_CORRECTION {
                let (states, _) = self.equations(&iterate)?;
                let regular = null_space_as_scaled(states, STATE_RANK_TOLERANCE)?.ncols() == self.tracks.len() + 1;
                return regular.then_some(iterate);
            }
            smallest = smallest.min(size);
        }
        None
    }

    /// The state equations without those of the tracks, rows of unit size, and their residual.
    fn equations(&self, iterate: &Iterate) -> Option<(DMatrix<f64>, DVector<f64>)> {
        let last = self.system.size() - 1;
        let mut values = DVector::zeros(self.system.size());
        let mut force = vec![0.0; self.system.loading.structure.freedoms()];
        residual::write_residual(&self.system, iterate, &mut values, &mut force);
        let rows: Vec<usize> = (0..last).filter(|row| !self.tracks.contains(row)).collect();
        let mut matrix = matrix::assemble_dense(&self.system, iterate, Kind::Increment).select_rows(&rows);
        let mut values = values.select_rows(&rows);
        for (mut row, value) in matrix.row_iter_mut().zip(values.iter_mut()) {
            let size = row.amax();
            if !(size.is_finite() && size > 0.0) {
                return None;
            }
            row /= size;
            *value /= size;
        }
        Some((matrix, values))
    }

    /// The state closest to the given one that satisfies the equations.
    fn projected(&self, mut iterate: Iterate) -> Option<Iterate> {
        residual::make_consistent(&self.system, &mut iterate);
        let mut least = f64::INFINITY;
        for _ in 0..MOST_ITERATIONS {
            let (matrix, values) = self.equations(&iterate)?;
            let size = values.amax();
            if !size.is_finite() {
                return None;
            }
            if size >= 0.5 * least && size <= ACCEPTED_RESIDUAL {
                return Some(iterate);
            }
            least = least.min(size);
            let correction = matrix.svd(true, true).solve(&values, f64::EPSILON).ok()?;
            iterate = rate_recovery::corrected_by(&self.system, iterate, &correction);
        }
        None
    }

    /// The rate equations, rows of unit size.
    fn rates(&self, iterate: &Iterate) -> Option<DMatrix<f64>> {
        let mut matrix =
            matrix::assemble_dense(&self.system, iterate, Kind::Rates).rows(0, self.system.size() - 1).into_owned();
        for mut row in matrix.row_iter_mut() {
            let size = row.amax();
            if !(size.is_finite() && size > 0.0) {
                return None;
            }
            row /= size;
        }
        Some(matrix)
    }

    fn borders(&self, iterate: &Iterate) -> Option<(DMatrix<f64>, DMatrix<f64>)> {
        let matrix = self.rates(iterate)?;
        Some((nearest_null_space(matrix.transpose(), 1)?, nearest_null_space(matrix, 2)?))
    }

    /// `g`
    fn tests(&self, iterate: &Iterate, psi: &DMatrix<f64>, borders: &DMatrix<f64>) -> Option<DVector<f64>> {
        let matrix = self.rates(iterate)?;
        let (rows, columns) = matrix.shape();
        let mut bordered = DMatrix::zeros(rows + 2, columns + 1);
        bordered.view_mut((0, 0), (rows, columns)).copy_from(&matrix);
        bordered.view_mut((0, columns), (rows, 1)).copy_from(psi);
        bordered.view_mut((rows, 0), (2, columns)).copy_from(&borders.transpose());
        let factorisation = Factorisation::new(bordered)?;
        let mut tests = DVector::zeros(2);
        for number in 0..2 {
            let mut values = DVector::zeros(rows + 2);
            values[rows + number] = 1.0;
            if !factorisation.solve(&mut values) {
                return None;
            }
            tests[number] = values[columns];
        }
        Some(tests)
    }
}
