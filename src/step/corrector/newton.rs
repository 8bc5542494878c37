//! Newton's method on the equations of a mode.

use crate::algebra::SystemFactorisation;
use crate::algebra::dense::assembly::Sink;
use crate::mechanics::contact::vector::{self, add, dot};
use crate::mechanics::equations::closing_equation::ClosingEquation;
use crate::mechanics::equations::solution::{Corrected, Failure};
use crate::mechanics::equations::{Iterate, Kind, ModeSystem, Role};
use crate::mechanics::problem::loading::USUAL;
use crate::mechanics::problem::natural_residual::NO_FORCE;
use crate::mechanics::problem::state::State;
use crate::step::corrector::cost_counters::Work;
use nalgebra::DVector;

/// Newton iterations before a step is given up.
const MOST_ITERATIONS: u64 = 16;
/// Iterations of it, each with a factorisation of its own, whose corrections are no smaller than those before: a method that
/// converges has one on its way in at the most.
const MOST_RISES: u64 = 2;
/// A correction above this part of the one before has not fallen. At a singular point each is half of it.
const RISES: f64 = 0.7;
/// The second correction over the first, at the most, of a step that may be shorter instead, where a factorisation is most of
/// the work: from farther away Newton's method need not converge (P. Deuflhard, Newton Methods for Nonlinear Problems,
/// Springer 2011, section 5.1).
const BEGINS_WELL: f64 = 0.25;
/// Relative residual that an accepted point must have.
pub const ACCEPTED_RESIDUAL: f64 = 1e-11;

/// Relative residual below which iterating on gains nothing.
const ROUND_OFF: f64 = 1e-15;
/// Arc length (dimensionless) of the next correction, as it is foreseen, below which it is not made where what is left over
/// is round-off.
const NO_CORRECTION: f64 = 4e-15;
/// Error below which Newton's method is as good as converged.
const SMALL: f64 = 1e-6;
/// Smallest pivot over the largest of a factorisation that may serve on: what is left over says little of the state where
/// it is smaller. A large structure is soft beside its elements and the pivot falls with its size: it is 8e-5 in a lattice of
/// 102,304 unknowns that touches with friction.
pub(crate) const REGULAR: f64 = 3e-5;
/// The same where the last correction is this part of that pivot at the most: so little moves it by this part of itself.
const STILL_FALLS: f64 = 1e-2;
/// Factor by which an error falls with a factorisation from elsewhere, at the least.
const SERVES_ON: f64 = 0.1;
/// Multiple of the bound on rounding within which what is left over counts as rounding.
const ROOM: f64 = 8.0;
/// Gaps and arc lengths (dimensionless) that are off by no more than this may be rounding.
const AT_PLACE: f64 = 1e-13;
/// Rows with forces below this part of the force scale are judged by their own.
const WEAK: f64 = 1e-3;
/// Corrections that fall by less than this factor are rounding themselves.
const NO_FALL: f64 = 0.25;

impl ModeSystem<'_> {
    /// Newton's method from a guess, to round-off.
    ///
    /// `force_scale` is the largest force met so far on the path; residuals are relative to it or to the present
    /// forces, whichever is larger.
    pub fn correct(&self, guess: State, closing: &dyn ClosingEquation, force_scale: f64) -> Result<Corrected, Failure> {
        self.correct_from(self.iterate(guess), closing, force_scale, &mut None, &mut Work::default())
    }

    /// `serving` is a factorisation of the equations nearby, if there is one, and becomes the last one.
    pub(crate) fn correct_from(
        &self,
        guess: Iterate,
        closing: &dyn ClosingEquation,
        force_scale: f64,
        serving: &mut Option<SystemFactorisation>,
        work: &mut Work,
    ) -> Result<Corrected, Failure> {
        self.correct_with(guess, closing, force_scale, None, serving, work)
    }

    /// The same; `own` is a factorisation of these very equations, with whatever border, if there is one.
    pub(crate) fn correct_with(
        &self,
        guess: Iterate,
        closing: &dyn ClosingEquation,
        force_scale: f64,
        own: Option<SystemFactorisation>,
        serving: &mut Option<SystemFactorisation>,
        work: &mut Work,
    ) -> Result<Corrected, Failure> {
        let mut iterate = guess;
        self.make_consistent(&mut iterate);
        let mut values = DVector::zeros(self.size);
        let mut force = vec![0.0; self.loading.structure.freedoms()];
        let mut change = self.no_rate();
        let mut iterations = 0;
        let mut iterations_to_small = None;
        let mut rises = 0;
        let mut best: Option<(f64, Iterate, Figures)> = None;
        // Sizes of the last correction and the one before.
        let (mut correction, mut before) = (f64::INFINITY, f64::INFINITY);
        let mut small_by_correction = None;
        // What the last correction left is as good as none, or below the rounding of each displacement.
        let mut nothing_left = false;
        // Rows are judged by the largest force first, and each by its own once that is done.
        let mut row_by_row = false;
        // Near the solution the last factorisation serves on: what it is off by is as small as the error was.
        let has_own = own.is_some();
        let mut is_own = has_own;
        let mut last_factorisation = own.or_else(|| serving.take());
        let (mut factorisations, mut reused) = (0, false);
        // With the last factorisation, where the place is no equation of its own.
        let mut along = None;
        loop {
            let (largest, forces) = self.residual(&iterate, &mut values, &mut force);
            let scale = forces.max(force_scale).max(NO_FORCE);
            let residual = largest / scale;
            let last = self.size - 1;
            values[last] = closing.value(self, &iterate.state);
            let geometric =
                values.as_slice()[self.loading.structure.unknowns()..].iter().fold(0.0_f64, |m, v| m.max(v.abs()));
            let mut error = residual.max(geometric);
            if row_by_row {
                error = error.max(self.residual_of_rows(&iterate.state, &values, scale, &mut force));
            }
            if !error.is_finite() {
                return Err(Failure::NotConverged);
            }
            if error <= SMALL {
                iterations_to_small.get_or_insert(iterations);
            }
            let best_before = best.as_ref().map(|(least, ..)| *least);
            let improved = best.as_ref().is_none_or(|(least, ..)| error < 0.5 * least);
            match &mut best {
                Some((least, ..)) if error > *least => {}
                Some((least, known, figures)) => {
                    *least = error;
                    known.set_to(&iterate);
                    (figures.iterations, figures.residual, figures.force_scale) = (iterations, residual, forces);
                    figures.left_over.copy_from(&values);
                }
                None => {
                    let figures = Figures { iterations, residual, left_over: values.clone(), force_scale: forces };
                    best = Some((error, iterate.clone(), figures));
                }
            }
            let least = best.as_ref().map_or(f64::INFINITY, |(least, ..)| *least);
            let is_regular = last_factorisation.as_ref().is_some_and(|last| {
                let pivot_ratio = last.pivot_ratio();
                pivot_ratio >= REGULAR || correction <= STILL_FALLS * pivot_ratio
            });
            // One from elsewhere has to do better than what it would save.
            let falls = has_own || factorisations > 0 || best_before.is_none_or(|least| error < SERVES_ON * least);
            let serves = !is_own && error <= SMALL && improved && falls && !row_by_row && is_regular;
            let was_reused = std::mem::replace(&mut reused, serves);
            // It goes on as far as rounding lets it: a fresh one would have gone beyond the bar at once.
            let is_rounding = || {
                let is_large = self.loading.structure.layout().is_some();
                let at_place = || geometric <= AT_PLACE.max(ROOM * f64::EPSILON * reach(&iterate.state));
                is_large && at_place() && self.left_by_rounding(&iterate.state, &values, scale) == Some(0.0)
            };
            let rounding = !improved && is_rounding();
            let stalled = !improved && (!was_reused || least <= ROUND_OFF || rounding);
            let settled = (least <= ROUND_OFF && (!was_reused || nothing_left))
                || error == 0.0
                || (stalled && (row_by_row || least <= ACCEPTED_RESIDUAL || rounding));
            if settled && iterations > 0 {
                let done = row_by_row || iterations == MOST_ITERATIONS;
                if done || self.residual_of_rows(&iterate.state, &values, scale, &mut force) <= ACCEPTED_RESIDUAL {
                    break;
                }
                (row_by_row, best) = (true, None);
            }
            let ended = iterations == MOST_ITERATIONS;
            if least > ACCEPTED_RESIDUAL && iterations > 0 && (ended || correction >= NO_FALL * before) {
                // Stiff elements next to large displacements: no displacements in this precision leave less. The point
                // is the one whose correction no longer falls.
                if let Some(residual) = self.left_by_rounding(&iterate.state, &values, scale) {
                    let figures = Figures { iterations, residual, left_over: values.clone(), force_scale: forces };
                    best = Some((residual, iterate, figures));
                    iterations_to_small = iterations_to_small.or(small_by_correction);
                    break;
                }
            }
            if ended {
                if least <= ACCEPTED_RESIDUAL || row_by_row {
                    break;
                }
                return Err(Failure::NotConverged);
            }
            let put_closing = |matrix: &mut dyn Sink| closing.write_gradient(self, &iterate.state, matrix);
            // Of a small correction few digits count.
            let once = reused || (is_own && error <= SMALL);
            if !reused && !std::mem::take(&mut is_own) {
                last_factorisation = self.factorise(&iterate, Kind::Increment, put_closing);
                factorisations += 1;
                work.factorisations += 1;
                along = None;
            }
            let left_of_place = values[last];
            if closing.has_slope_beside_row() {
                values[last] = 0.0;
            }
            let factorisation = last_factorisation.as_ref().ok_or(Failure::Singular)?;
            // What one from elsewhere leaves over is more than rounding anyway.
            let solved = if once { factorisation.solve_once(&mut values) } else { factorisation.solve(&mut values) };
            if !solved || !self.bring_to_zero(closing, left_of_place, &iterate, factorisation, &mut along, &mut values)
            {
                return Err(Failure::Singular);
            }
            (before, correction) = (correction, values.rows(0, self.loading.structure.unknowns() + 1).norm());
            let begins = iterations == 1 && self.may_be_shorter && self.loading.structure.layout().is_some();
            if begins && !reused && correction > SMALL && correction > BEGINS_WELL * before {
                return Err(Failure::NotConverged);
            }
            if !reused && correction > SMALL && before.is_finite() && correction > RISES * before {
                rises += 1;
                if rises == MOST_RISES {
                    return Err(Failure::NotConverged);
                }
            }
            if correction <= SMALL {
                small_by_correction.get_or_insert(iterations);
            }
            let contraction = if before.is_finite() { correction / before } else { SERVES_ON };
            nothing_left = contraction <= SERVES_ON
                && (contraction * correction <= NO_CORRECTION
                    || self.is_rounding(&iterate.state, &values, contraction));
            self.correct_by(&mut iterate, &values, &mut change);
            iterations += 1;
            work.newton_iterations += 1;
        }
        let Some((_, mut iterate, figures)) = best else { return Err(Failure::NotConverged) };
        let wrong_side = !closing.accepts(&iterate.state);
        if wrong_side {
            return Err(Failure::NotConverged);
        }
        self.share(&mut iterate.state);
        *serving = last_factorisation.and_then(|last| self.may_serve(last));
        Ok(Corrected {
            modes: self.modes_at(&iterate),
            state: iterate.state,
            directions: iterate.directions,
            iterations_to_small: iterations_to_small.unwrap_or(figures.iterations).min(figures.iterations),
            residual: figures.residual,
            left_over: figures.left_over,
            force_scale: figures.force_scale,
        })
    }

    /// Where the place is a zero, a correction goes on along the path until the quantity is zero at first order: its
    /// gradient, which may have entries at forces that the factorisation eliminates, need not be a row (bordering: H. B.
    /// Keller, in: Applications of Bifurcation Theory, Academic Press 1977, 359). `along` is the way with this factorisation.
    /// `false` where the quantity does not change along it.
    fn bring_to_zero(
        &self,
        closing: &dyn ClosingEquation,
        left_over: f64,
        iterate: &Iterate,
        factorisation: &SystemFactorisation,
        along: &mut Option<(DVector<f64>, f64)>,
        correction: &mut DVector<f64>,
    ) -> bool {
        if !closing.has_slope_beside_row() {
            return true;
        }
        let slope = |values: &DVector<f64>| {
            let rate = self.rate_at(iterate, values, Kind::Increment);
            closing.slope_beside_row(self, &iterate.state, &rate)
        };
        if along.is_none() {
            let mut values = self.bordering();
            if !factorisation.solve_once(&mut values) {
                return false;
            }
            *along = slope(&values).filter(|slope| slope.is_finite() && *slope != 0.0).map(|slope| (values, slope));
        }
        let (Some((way, by_way)), Some(by_correction)) = (along, slope(correction)) else { return false };
        correction.axpy((left_over - by_correction) / *by_way, way, 1.0);
        true
    }

    /// The largest equilibrium residual over the forces of its own row, of the rows where these are far below the force
    /// scale. `sizes` becomes those forces.
    fn residual_of_rows(&self, state: &State, values: &DVector<f64>, scale: f64, sizes: &mut [f64]) -> f64 {
        let structure = self.loading.structure;
        structure.force_sizes(&state.displacement, USUAL, sizes);
        for (freedom, size) in sizes.iter_mut().enumerate() {
            *size +=
                (state.load * self.loading.pattern.forces[freedom]).abs() + self.loading.held.forces[freedom].abs();
        }
        for (contact, reaction) in self.loading.contacts.iter().zip(&state.reactions) {
            for node in contact.kinematics.nodes() {
                sizes[structure.freedoms_of(*node)].iter_mut().for_each(|size| *size += reaction.size());
            }
        }
        let rows =
            structure.freedom_of.iter().zip(values.as_slice()).map(|(freedom, value)| (sizes[*freedom], value.abs()));
        rows.filter(|(size, _)| *size < WEAK * scale)
            .map(|(size, value)| value / size.max(f64::EPSILON * scale))
            .fold(0.0, f64::max)
    }

    /// Whether a correction times a factor is below the rounding of every displacement and of the load.
    fn is_rounding(&self, state: &State, correction: &DVector<f64>, factor: f64) -> bool {
        let freedoms = &self.loading.structure.freedom_of;
        let values = freedoms.iter().map(|freedom| state.displacement[*freedom]).chain(std::iter::once(state.load));
        values.zip(correction.as_slice()).all(|(value, change)| (factor * change).abs() <= f64::EPSILON * value.abs())
    }

    /// Whether what is left over of each equation is within the rounding of the state's numbers; then the largest
    /// equilibrium residual beyond it, over the force scale.
    fn left_by_rounding(&self, state: &State, values: &DVector<f64>, scale: f64) -> Option<f64> {
        let structure = self.loading.structure;
        let rounding = structure.rounding(&state.displacement);
        let mut residual = 0.0_f64;
        for (unknown, freedom) in structure.freedom_of.iter().enumerate() {
            residual = residual.max((values[unknown].abs() - ROOM * rounding[*freedom]) / scale);
        }
        let reach = reach(state);
        let geometric = values.as_slice()[structure.unknowns()..].iter().fold(0.0_f64, |m, v| m.max(v.abs()));
        let within = geometric <= ACCEPTED_RESIDUAL + ROOM * f64::EPSILON * reach;
        (residual <= ACCEPTED_RESIDUAL && within).then_some(residual)
    }

    /// A point as it is, with its residual. Slips in planes have the directions that their tractions oppose.
    pub fn judged(&self, state: State, force_scale: f64) -> Corrected {
        let mut iterate = self.iterate(state);
        for (contact, role) in self.roles.iter().enumerate() {
            if let Role::Plane { .. } = role {
                let normal = self.loading.frame(contact, &iterate.state).normal;
                let traction = iterate.state.reactions[contact].tangential;
                let traction = add(&traction, -dot(&traction, &normal), &normal);
                iterate.directions[contact] = vector::direction_of(&traction, &iterate.directions[contact]);
            }
        }
        self.judged_as_state(iterate, &[], force_scale)
    }

    /// The same of an iterate, without the equations in some rows.
    pub(crate) fn judged_as_state(&self, mut iterate: Iterate, without: &[usize], force_scale: f64) -> Corrected {
        self.make_consistent(&mut iterate);
        let mut left_over = DVector::zeros(self.size);
        let mut force = vec![0.0; self.loading.structure.freedoms()];
        let (largest, forces) = self.residual(&iterate, &mut left_over, &mut force);
        let geometric = (self.loading.structure.unknowns()..left_over.len())
            .filter(|row| !without.contains(row))
            .fold(0.0_f64, |largest, row| largest.max(left_over[row].abs()));
        let residual = (largest / forces.max(force_scale).max(NO_FORCE)).max(geometric);
        self.share(&mut iterate.state);
        Corrected {
            modes: self.modes_at(&iterate),
            state: iterate.state,
            directions: iterate.directions,
            iterations_to_small: 0,
            residual,
            left_over,
            force_scale: forces,
        }
    }
}

impl ModeSystem<'_> {
    /// How far the chords of slips in planes are from where their directions would have them, in these rows.
    pub(crate) fn off_track(&self, corrected: &Corrected, rows: &[usize]) -> f64 {
        rows.iter().fold(0.0, |largest, row| largest.max(corrected.left_over[*row].abs()))
    }
}

/// The largest displacement, or the load: what the rounding of places is relative to.
fn reach(state: &State) -> f64 {
    state.displacement.iter().fold(state.load.abs(), |reach, value| reach.max(value.abs()))
}

/// What Newton's method says of its best iterate.
struct Figures {
    iterations: u64,
    residual: f64,
    left_over: DVector<f64>,
    force_scale: f64,
}
