//! Newton's method on the equations of a mode.

use crate::algebra::SystemFactorisation;
use crate::algebra::dense::matrix_sink::Sink;
use crate::mechanics::contact::vector::{self, add, dot};
use crate::mechanics::equations::closing_equation::ClosingEquation;
use crate::mechanics::equations::corrected_point::{Corrected, Failure};
use crate::mechanics::equations::{Iterate, Kind, ModeSystem, Role, mode_factorisation, rate_recovery, residual};
use crate::mechanics::problem::state::{Rate, State};
use crate::mechanics::problem::tolerances::{NEGLIGIBLE_FORCE, USUAL_DISPLACEMENT};
use crate::step::corrector::cost_counters::Work;
use crate::step::corrector::tangent;
use crate::step::corrector::tolerances::{
    ACCEPTED_RESIDUAL, ATTAINABLE_RESIDUAL, FALLEN_FORCES, FIRST_CORRECTION_RATIO, LARGEST_RELATIVE_CORRECTION,
    NEGLIGIBLE_CORRECTION, POSITION_ROUND_OFF, REUSABLE_PIVOT_RATIO, REUSE_CONTRACTION, RISING_CORRECTION_RATIO,
    ROUND_OFF_CORRECTION_RATIO, ROUND_OFF_MULTIPLE, SMALL_ERROR, WEAK_ROW_FORCE,
};
use nalgebra::DVector;

/// Largest number of Newton iterations.
const MOST_ITERATIONS: u64 = 16;
/// Number of iterations with a fresh factorisation and without a decrease of the correction at which the method gives
/// up: a convergent iteration has at most one, at its beginning.
const MOST_RISES: u64 = 2;

/// Solves the equations by Newton's method from a guess, to round-off.
///
/// `force_scale` is the largest force met so far on the path; residuals are relative to it or to the present
/// forces, whichever is larger.
pub fn correct(
    system: &ModeSystem<'_>,
    guess: State,
    closing: &dyn ClosingEquation,
    force_scale: f64,
) -> Result<Corrected, Failure> {
    correct_from(system, system.iterate(guess), closing, force_scale, &mut None, &mut Work::default())
}

/// As [`correct`], from an iterate; `serving` is a factorisation of the equations nearby, if there is one, and becomes
/// the last one.
pub(crate) fn correct_from(
    system: &ModeSystem<'_>,
    guess: Iterate,
    closing: &dyn ClosingEquation,
    force_scale: f64,
    serving: &mut Option<SystemFactorisation>,
    work: &mut Work,
) -> Result<Corrected, Failure> {
    correct_with(system, guess, closing, force_scale, None, serving, work)
}

/// As [`correct_from`]; `own` is a factorisation of exactly these equations, with any border, if there is one.
pub(crate) fn correct_with(
    system: &ModeSystem<'_>,
    guess: Iterate,
    closing: &dyn ClosingEquation,
    force_scale: f64,
    own: Option<SystemFactorisation>,
    serving: &mut Option<SystemFactorisation>,
    work: &mut Work,
) -> Result<Corrected, Failure> {
    let factorisation = FactorisationInUse::new(own, serving);
    let mut iteration = NewtonIteration::new(system, guess, closing, force_scale, factorisation);
    iteration.run(work)?;
    iteration.finish(serving)
}

/// A Newton iteration in progress.
struct NewtonIteration<'a, 'b> {
    system: &'a ModeSystem<'b>,
    closing: &'a dyn ClosingEquation,
    /// The largest force met so far on the path.
    force_scale: f64,
    iterate: Iterate,
    /// The residual of each equation; after the solve, the correction.
    values: DVector<f64>,
    force: Vec<f64>,
    change: Rate,
    iterations: u64,
    iterations_to_small: Option<u64>,
    small_by_correction: Option<u64>,
    rises: u64,
    best: Option<BestIterate>,
    /// Sizes of the last correction and the one before.
    correction: f64,
    previous_correction: f64,
    /// Whether the error that the last correction leaves is negligible, or below the rounding of each displacement.
    nothing_left: bool,
    /// Whether rows are judged by their own forces; at first all are judged by the largest force.
    row_by_row: bool,
    factorisation: FactorisationInUse,
}

/// The factorisation that gives the corrections. Near the solution the last one is reused: its error is as small as
/// that of its iterate.
struct FactorisationInUse {
    latest: Option<SystemFactorisation>,
    /// Whether the first factorisation was of exactly these equations.
    had_own: bool,
    /// Whether `latest` is this first factorisation, not used yet.
    is_own: bool,
    /// Number of factorisations computed here.
    made: u64,
    /// Whether `latest` is reused for the present correction, although the iterate has moved.
    reused: bool,
    /// The direction along the path and the change of the event function along it, computed with `latest`, where the
    /// closing equation has no row of its own.
    along: Option<(DVector<f64>, f64)>,
}

/// The error of an iterate.
struct IterateError {
    /// Equilibrium residual over `scale`.
    residual: f64,
    /// Largest force at the iterate.
    forces: f64,
    /// The force scale of the residual.
    scale: f64,
    /// Largest residual of the other equations.
    geometric: f64,
    error: f64,
}

/// An iterate compared with the earlier ones.
struct ErrorProgress {
    best_before: Option<f64>,
    /// The smallest error so far, including this iterate's.
    least: f64,
    improved: bool,
}

impl FactorisationInUse {
    fn new(own: Option<SystemFactorisation>, serving: &mut Option<SystemFactorisation>) -> Self {
        let had_own = own.is_some();
        let latest = own.or_else(|| serving.take());
        Self { latest, had_own, is_own: had_own, made: 0, reused: false, along: None }
    }

    /// Decides whether the latest factorisation is reused for the next correction; `correction` is the size of the last
    /// one. Returns whether the factorisation was reused for the last correction.
    fn decide_reuse(&mut self, error: f64, progress: &ErrorProgress, correction: f64, row_by_row: bool) -> bool {
        let is_regular = self.latest.as_ref().is_some_and(|latest| {
            let pivot_ratio = latest.pivot_ratio();
            pivot_ratio >= REUSABLE_PIVOT_RATIO || correction <= LARGEST_RELATIVE_CORRECTION * pivot_ratio
        });
        // A factorisation left over from elsewhere has to converge faster than a fresh one would.
        let falls =
            self.had_own || self.made > 0 || progress.best_before.is_none_or(|least| error < REUSE_CONTRACTION * least);
        let serves = !self.is_own && error <= SMALL_ERROR && progress.improved && falls && !row_by_row && is_regular;
        std::mem::replace(&mut self.reused, serves)
    }
}

impl<'a, 'b> NewtonIteration<'a, 'b> {
    fn new(
        system: &'a ModeSystem<'b>,
        guess: Iterate,
        closing: &'a dyn ClosingEquation,
        force_scale: f64,
        factorisation: FactorisationInUse,
    ) -> Self {
        let mut iterate = guess;
        residual::make_consistent(system, &mut iterate);
        system.begin_iteration(&mut iterate);
        Self {
            system,
            closing,
            force_scale,
            iterate,
            values: DVector::zeros(system.size),
            force: vec![0.0; system.loading.structure.freedoms()],
            change: rate_recovery::no_rate(system),
            iterations: 0,
            iterations_to_small: None,
            small_by_correction: None,
            rises: 0,
            best: None,
            correction: f64::INFINITY,
            previous_correction: f64::INFINITY,
            nothing_left: false,
            row_by_row: false,
            factorisation,
        }
    }

    /// Iterates until the best iterate cannot be improved.
    fn run(&mut self, work: &mut Work) -> Result<(), Failure> {
        loop {
            let at = self.evaluate()?;
            let progress = self.keep_best(&at);
            let was_reused = self.factorisation.decide_reuse(at.error, &progress, self.correction, self.row_by_row);
            if self.has_settled(&at, &progress, was_reused) || self.ends_at_rounding(&at, &progress) {
                return Ok(());
            }
            if self.iterations == MOST_ITERATIONS {
                let accepted = progress.least <= ACCEPTED_RESIDUAL || self.row_by_row;
                return if accepted { Ok(()) } else { Err(Failure::NotConverged) };
            }
            let once = self.factorise_or_reuse(at.error, work);
            self.solve(once)?;
            let falls = progress.best_before.is_some_and(|least| at.error <= FIRST_CORRECTION_RATIO * least);
            self.judge_convergence(falls)?;
            self.update(work);
        }
    }

    /// Evaluates the residuals and the error of the iterate.
    fn evaluate(&mut self) -> Result<IterateError, Failure> {
        let Self { system, iterate, values, force, .. } = self;
        let (largest, forces) = residual::write_residual(system, iterate, values, force);
        let scale = forces.max(self.force_scale).max(NEGLIGIBLE_FORCE);
        let residual = largest / scale;
        let last = system.size - 1;
        values[last] = self.closing.value(system, &iterate.state);
        let geometric = largest_below_equilibrium(system, values);
        let mut error = residual.max(geometric);
        if self.row_by_row {
            error = error.max(residual_of_rows(system, &iterate.state, values, scale, force));
        }
        if !error.is_finite() {
            return Err(Failure::NotConverged);
        }
        if error <= SMALL_ERROR {
            self.iterations_to_small.get_or_insert(self.iterations);
        }
        Ok(IterateError { residual, forces, scale, geometric, error })
    }

    /// Relates the residual of the best iterate to the present forces where these are far smaller.
    fn rank_by_present_forces(&mut self, at: &IterateError) {
        let Some(best) = &mut self.best else { return };
        let scale = best.force_scale.max(self.force_scale).max(NEGLIGIBLE_FORCE);
        if at.scale < FALLEN_FORCES * scale {
            best.residual *= scale / at.scale;
            best.error = best.error.max(best.residual);
            best.force_scale = at.forces;
        }
    }

    /// Keeps the iterate if it is the best so far.
    fn keep_best(&mut self, at: &IterateError) -> ErrorProgress {
        self.rank_by_present_forces(at);
        let error = at.error;
        let best_before = self.best.as_ref().map(|best| best.error);
        let improved = best_before.is_none_or(|least| error < 0.5 * least);
        match &mut self.best {
            Some(best) if error > best.error => {}
            Some(best) => {
                best.error = error;
                best.iterate.set_to(&self.iterate);
                (best.iterations, best.residual, best.force_scale) = (self.iterations, at.residual, at.forces);
                best.left_over.copy_from(&self.values);
            }
            None => self.best = Some(self.as_best(error, at.residual, at.forces)),
        }
        let least = self.best.as_ref().map_or(f64::INFINITY, |best| best.error);
        ErrorProgress { best_before, least, improved }
    }

    fn as_best(&self, error: f64, residual: f64, forces: f64) -> BestIterate {
        BestIterate {
            error,
            iterate: self.iterate.clone(),
            iterations: self.iterations,
            residual,
            left_over: self.values.clone(),
            force_scale: forces,
        }
    }

    /// Whether further iterations gain nothing. Once this holds for the largest force, rows are judged by their own
    /// forces.
    fn has_settled(&mut self, at: &IterateError, progress: &ErrorProgress, was_reused: bool) -> bool {
        let ErrorProgress { least, improved, .. } = *progress;
        let rounding = !improved && self.is_left_by_rounding(at);
        let stalled = !improved && (!was_reused || least <= ATTAINABLE_RESIDUAL || rounding);
        let settled = (least <= ATTAINABLE_RESIDUAL && (!was_reused || self.nothing_left))
            || at.error == 0.0
            || (stalled && (self.row_by_row || least <= ACCEPTED_RESIDUAL || rounding));
        if !settled || self.iterations == 0 {
            return false;
        }
        let done = self.row_by_row || self.iterations == MOST_ITERATIONS;
        let Self { system, iterate, values, force, .. } = self;
        if done || residual_of_rows(system, &iterate.state, values, at.scale, force) <= ACCEPTED_RESIDUAL {
            return true;
        }
        (self.row_by_row, self.best) = (true, None);
        false
    }

    /// Whether the whole residual is round-off. The iteration continues as far as rounding permits: a fresh
    /// factorisation would have passed the tolerance at once.
    fn is_left_by_rounding(&self, at: &IterateError) -> bool {
        let is_large = self.system.loading.structure.layout().is_some();
        let at_place = || {
            at.geometric
                <= POSITION_ROUND_OFF.max(ROUND_OFF_MULTIPLE * rounding_of_places(self.system, &self.iterate.state))
        };
        is_large
            && at_place()
            && left_by_rounding(self.system, &self.iterate.state, &self.values, at.scale) == Some(0.0)
    }

    /// Whether the iterate is accepted because no displacements in this precision have a smaller residual: with stiff
    /// elements next to large displacements. The iterate whose correction no longer decreases is the point.
    fn ends_at_rounding(&mut self, at: &IterateError, progress: &ErrorProgress) -> bool {
        let ended = self.iterations == MOST_ITERATIONS;
        let falls_no_more = ended || self.correction >= ROUND_OFF_CORRECTION_RATIO * self.previous_correction;
        if progress.least <= ACCEPTED_RESIDUAL || self.iterations == 0 || !falls_no_more {
            return false;
        }
        let Some(residual) = left_by_rounding(self.system, &self.iterate.state, &self.values, at.scale) else {
            return false;
        };
        self.best = Some(self.as_best(residual, residual, at.forces));
        self.iterations_to_small = self.iterations_to_small.or(self.small_by_correction);
        true
    }

    /// Provides the factorisation for the next correction. Returns whether a solve without refinement suffices: few
    /// digits of a small correction count.
    fn factorise_or_reuse(&mut self, error: f64, work: &mut Work) -> bool {
        let Self { system, closing, iterate, factorisation, .. } = self;
        let once = factorisation.reused || (factorisation.is_own && error <= SMALL_ERROR);
        if !factorisation.reused && !std::mem::take(&mut factorisation.is_own) {
            let put_closing = |matrix: &mut dyn Sink| closing.write_gradient(system, &iterate.state, matrix);
            factorisation.latest = mode_factorisation::factorise(system, iterate, Kind::Increment, put_closing);
            factorisation.made += 1;
            work.factorisations += 1;
            factorisation.along = None;
        }
        once
    }

    /// Solves for the next correction.
    fn solve(&mut self, once: bool) -> Result<(), Failure> {
        let Self { system, closing, iterate, values, force, factorisation, .. } = self;
        residual::make_mixed(system, iterate, values, force);
        let last = system.size - 1;
        let left_of_place = values[last];
        if closing.has_slope_beside_row() {
            values[last] = 0.0;
        }
        let FactorisationInUse { latest, along, .. } = factorisation;
        let latest = latest.as_ref().ok_or(Failure::Singular)?;
        // The error of a reused factorisation exceeds rounding anyway.
        let solved = if once { latest.solve_once(values) } else { latest.solve(values) };
        if !solved || !bring_to_zero(system, *closing, left_of_place, iterate, latest, along, values) {
            return Err(Failure::Singular);
        }
        self.previous_correction = self.correction;
        self.correction = self.values.rows(0, self.system.loading.structure.unknowns() + 1).norm();
        Ok(())
    }

    /// Gives up where the corrections do not decrease, and predicts the error that the last one leaves. The first
    /// correction may turn directions of slip, of which displacements show nothing until the second: there the residual
    /// tells instead, whether it `falls`.
    fn judge_convergence(&mut self, falls: bool) -> Result<(), Failure> {
        let (before, correction, reused) = (self.previous_correction, self.correction, self.factorisation.reused);
        let begins =
            self.iterations == 1 && self.system.may_be_shorter && self.system.loading.structure.layout().is_some();
        let turns = self.system.has_tracks() && falls;
        if begins && !turns && !reused && correction > SMALL_ERROR && correction > FIRST_CORRECTION_RATIO * before {
            return Err(Failure::NotConverged);
        }
        if !reused && correction > SMALL_ERROR && before.is_finite() && correction > RISING_CORRECTION_RATIO * before {
            self.rises += 1;
            if self.rises == MOST_RISES {
                return Err(Failure::NotConverged);
            }
        }
        if correction <= SMALL_ERROR {
            self.small_by_correction.get_or_insert(self.iterations);
        }
        let contraction = if before.is_finite() { correction / before } else { REUSE_CONTRACTION };
        self.nothing_left = contraction <= REUSE_CONTRACTION
            && (contraction * correction <= NEGLIGIBLE_CORRECTION
                || is_rounding(self.system, &self.iterate.state, &self.values, contraction));
        Ok(())
    }

    fn update(&mut self, work: &mut Work) {
        rate_recovery::correct_by(self.system, &mut self.iterate, &self.values, &mut self.change);
        self.iterations += 1;
        work.newton_iterations += 1;
    }

    /// The best iterate as a point. `serving` becomes the last factorisation.
    fn finish(self, serving: &mut Option<SystemFactorisation>) -> Result<Corrected, Failure> {
        let Self { system, iterations_to_small, .. } = self;
        let Some(mut best) = self.best else { return Err(Failure::NotConverged) };
        let wrong_side = !self.closing.accepts(&best.iterate.state);
        if wrong_side {
            return Err(Failure::NotConverged);
        }
        system.share(&mut best.iterate.state);
        *serving = self.factorisation.latest.and_then(|latest| tangent::may_serve(system, latest));
        Ok(Corrected {
            modes: rate_recovery::modes_at(system, &best.iterate),
            state: best.iterate.state,
            directions: best.iterate.directions,
            iterations_to_small: iterations_to_small.unwrap_or(best.iterations).min(best.iterations),
            residual: best.residual,
            left_over: best.left_over,
            force_scale: best.force_scale,
        })
    }
}

/// Where the closing equation is an event function, extends a correction along the path until the function is zero at
/// first order: its gradient, which may have entries at forces that the factorisation eliminates, need not be a row
/// (bordering: H. B. Keller, in: Applications of Bifurcation Theory, Academic Press 1977, 359). `along` is the
/// direction along the path from this factorisation. Returns `false` where the function does not change along it.
fn bring_to_zero(
    system: &ModeSystem<'_>,
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
        let rate = rate_recovery::rate_at(system, iterate, values, Kind::Increment);
        closing.slope_beside_row(system, &iterate.state, &rate)
    };
    if along.is_none() {
        let mut values = rate_recovery::bordering(system);
        if !factorisation.solve_once(&mut values) {
            return false;
        }
        *along = slope(&values).filter(|slope| slope.is_finite() && *slope != 0.0).map(|slope| (values, slope));
    }
    let (Some((way, by_way)), Some(by_correction)) = (along, slope(correction)) else { return false };
    correction.axpy((left_over - by_correction) / *by_way, way, 1.0);
    true
}

/// The largest equilibrium residual over the forces of its own row, among the rows whose forces are far below the force
/// scale. These forces are written to `sizes`.
fn residual_of_rows(
    system: &ModeSystem<'_>,
    state: &State,
    values: &DVector<f64>,
    scale: f64,
    sizes: &mut [f64],
) -> f64 {
    let structure = system.loading.structure;
    structure.force_sizes(&state.displacement, USUAL_DISPLACEMENT, sizes);
    for (freedom, size) in sizes.iter_mut().enumerate() {
        *size +=
            (state.load * system.loading.pattern.forces[freedom]).abs() + system.loading.held.forces[freedom].abs();
    }
    for (contact, reaction) in system.loading.contacts.iter().zip(&state.reactions) {
        for node in contact.kinematics.nodes() {
            sizes[structure.freedoms_of(*node)].iter_mut().for_each(|size| *size += reaction.size());
        }
    }
    let rows =
        structure.freedom_of.iter().zip(values.as_slice()).map(|(freedom, value)| (sizes[*freedom], value.abs()));
    rows.filter(|(size, _)| *size < WEAK_ROW_FORCE * scale)
        .map(|(size, value)| value / size.max(f64::EPSILON * scale))
        .fold(0.0, f64::max)
}

/// Whether a correction times a factor is below the rounding of every displacement and of the load.
fn is_rounding(system: &ModeSystem<'_>, state: &State, correction: &DVector<f64>, factor: f64) -> bool {
    let freedoms = &system.loading.structure.freedom_of;
    let values = freedoms.iter().map(|freedom| state.displacement[*freedom]).chain(std::iter::once(state.load));
    values.zip(correction.as_slice()).all(|(value, change)| (factor * change).abs() <= f64::EPSILON * value.abs())
}

/// Where the residual of each equation is within the rounding of the state's numbers, returns the largest equilibrium
/// residual beyond this rounding, over the force scale.
fn left_by_rounding(system: &ModeSystem<'_>, state: &State, values: &DVector<f64>, scale: f64) -> Option<f64> {
    let structure = system.loading.structure;
    let rounding = structure.rounding(&state.displacement);
    let mut residual = 0.0_f64;
    for (unknown, freedom) in structure.freedom_of.iter().enumerate() {
        residual = residual.max((values[unknown].abs() - ROUND_OFF_MULTIPLE * rounding[*freedom]) / scale);
    }
    let geometric = largest_below_equilibrium(system, values);
    let within = geometric <= ACCEPTED_RESIDUAL + ROUND_OFF_MULTIPLE * rounding_of_places(system, state);
    (residual <= ACCEPTED_RESIDUAL && within).then_some(residual)
}

/// A state as a point without correction, with its residual. Slips in planes have the directions that oppose their
/// tractions.
pub fn judged(system: &ModeSystem<'_>, state: State, force_scale: f64) -> Corrected {
    let mut iterate = system.iterate(state);
    for (contact, role) in system.roles.iter().enumerate() {
        if let Role::Plane { .. } = role {
            let normal = system.loading.frame(contact, &iterate.state).normal;
            let traction = iterate.state.reactions[contact].tangential;
            let traction = add(&traction, -dot(&traction, &normal), &normal);
            iterate.directions[contact] = vector::direction_of(&traction, &iterate.directions[contact]);
        }
    }
    judged_as_state(system, iterate, &[], force_scale)
}

/// As [`judged`]; `None` where the residual is larger than that of an accepted point by more than the rounding of the state's
/// numbers. The residual is then that beyond the rounding.
pub(crate) fn accepted(system: &ModeSystem<'_>, state: State, force_scale: f64) -> Option<Corrected> {
    let mut corrected = judged(system, state, force_scale);
    if corrected.residual > ACCEPTED_RESIDUAL {
        let scale = corrected.force_scale.max(force_scale).max(NEGLIGIBLE_FORCE);
        corrected.residual = left_by_rounding(system, &corrected.state, &corrected.left_over, scale)?;
    }
    Some(corrected)
}

/// As [`judged`], for an iterate and without the equations in some rows.
pub(crate) fn judged_as_state(
    system: &ModeSystem<'_>,
    mut iterate: Iterate,
    without: &[usize],
    force_scale: f64,
) -> Corrected {
    residual::make_consistent(system, &mut iterate);
    let mut left_over = DVector::zeros(system.size);
    let mut force = vec![0.0; system.loading.structure.freedoms()];
    let (largest, forces) = residual::write_residual(system, &iterate, &mut left_over, &mut force);
    let geometric = (system.loading.structure.unknowns()..left_over.len())
        .filter(|row| !without.contains(row))
        .fold(0.0_f64, |largest, row| largest.max(left_over[row].abs()));
    let residual = (largest / forces.max(force_scale).max(NEGLIGIBLE_FORCE)).max(geometric);
    system.share(&mut iterate.state);
    Corrected {
        modes: rate_recovery::modes_at(system, &iterate),
        state: iterate.state,
        directions: iterate.directions,
        iterations_to_small: 0,
        residual,
        left_over,
        force_scale: forces,
    }
}

/// The largest deviation of the chords of slips in planes from the rule of their tracks, in these rows.
pub(crate) fn off_track(corrected: &Corrected, rows: &[usize]) -> f64 {
    rows.iter().fold(0.0, |largest, row| largest.max(corrected.left_over[*row].abs()))
}

/// The rounding of positions: that of the largest displacement, of the load, or of the coordinates that a closed contact
/// depends on.
fn rounding_of_places(system: &ModeSystem<'_>, state: &State) -> f64 {
    let reach = state.displacement.iter().fold(state.load.abs(), |reach, value| reach.max(value.abs()));
    let closed = system.roles.iter().zip(system.loading.contacts).filter(|(role, _)| !matches!(role, Role::Free));
    closed.map(|(_, contact)| contact.rounding()).fold(f64::EPSILON * reach, f64::max)
}

/// The largest residual of the equations other than equilibrium.
fn largest_below_equilibrium(system: &ModeSystem<'_>, values: &DVector<f64>) -> f64 {
    values.as_slice()[system.loading.structure.unknowns()..].iter().fold(0.0_f64, |m, v| m.max(v.abs()))
}

/// The best iterate so far, with its error and residual.
struct BestIterate {
    error: f64,
    iterate: Iterate,
    iterations: u64,
    residual: f64,
    left_over: DVector<f64>,
    force_scale: f64,
}
