//! Solution of a mathematical program with complementarity constraints, from a start to a classified point.
//!
//! 1. Warm start (or no pairs at all): the branch suggested by the start is solved; near a solution this takes two or
//!    three quadratic programs.
//! 2. Otherwise: regularised programs with `ε` falling from its first to its last value, each from the end point of the
//!    previous program. As soon as the pattern of every pair is clear, or remains unchanged, `mpec::piecewise_descent`
//!    continues and `mpec::stationarity` classifies the point.
//! 3. Without a feasible stationary point: again from the start with a hundred times larger `ε`, a bounded number of
//!    times; then, where no point was feasible, from the branches around the least infeasible point. The best point
//!    found is returned, with a status that describes it.
//!
//! The result is a local solution. Source of the sequence: S. Scholtes, SIAM J. Optim. 11 (2001),
//! doi:10.1137/S1052623499361233.

#![warn(missing_docs)]

use crate::complementarity::mpec::tolerances::{LARGEST_RELAXATION, RESTART_FACTOR};
use nalgebra::DVector;

use crate::complementarity::mpec::input_validation::check_input;
use crate::complementarity::mpec::piecewise_descent::{self, CandidatePoint};
use crate::complementarity::mpec::program::activity::{Activities, PairActivity};
use crate::complementarity::mpec::program::cone::ConeActivity;
use crate::complementarity::mpec::program::evaluation::{ProgramEvaluation, Quantity};
use crate::complementarity::mpec::program::problem::Problem;
use crate::complementarity::mpec::quadratic_program::driver::StepSolver;
use crate::complementarity::mpec::result::{ProgramInputError, ProgramSolution, SolveStatus, StationarityKind};
use crate::complementarity::mpec::settings::Settings;
use crate::complementarity::mpec::smooth_program::pair_treatment::TreatmentPattern;
use crate::complementarity::mpec::smooth_program::smooth_rows::SmoothProgramRows;
use crate::complementarity::mpec::smooth_program::sqp::{self, SqpEnd, SqpSettings};
use crate::complementarity::mpec::unboundedness;
use crate::resources::cancel::CancelFlag;

/// Largest number of values of `ε` in one descent, whatever the settings.
const LEVEL_LIMIT: usize = 200;

/// Solves `problem` from `start`.
///
/// Numerical trouble is a [`SolveStatus`], never an error.
///
/// # Errors
/// [`ProgramInputError`] for a start or bounds that do not fit the problem, or settings out of range.
pub fn solve<P: Problem + ?Sized>(
    problem: &P,
    start: &DVector<f64>,
    settings: &Settings,
    cancel: &CancelFlag,
) -> Result<ProgramSolution, ProgramInputError> {
    solve_by(problem, start, settings, cancel, |run, at| run.go(start, at))
}

/// Follows one branch from `start` to its optimum without examining others: the branch in which the given member of
/// each pair is zero (for pairs without such an entry, and for cone pairs, the member that is smaller at the start).
///
/// Where no other constraint becomes active, the branch's solution is the problem's: [`SolveStatus::PatternSettled`] or
/// [`SolveStatus::Solved`], of kind [`StationarityKind::OneBranch`] where both members of a pair are zero to rounding
/// and another branch might give descent. [`SolveStatus::Feasible`] where the branch ends earlier, at a pair that has
/// to change.
///
/// # Errors
/// [`ProgramInputError`] for a start or bounds that do not fit the problem, or settings out of range.
pub fn follow_branch<P: Problem + ?Sized>(
    problem: &P,
    start: &DVector<f64>,
    zero_members: &[PairActivity],
    settings: &Settings,
    cancel: &CancelFlag,
) -> Result<ProgramSolution, ProgramInputError> {
    solve_by(problem, start, settings, cancel, |run, at| {
        run.steps.is_elastic = false;
        let pattern = piecewise_descent::nearest_pattern(at).with_zeros(zero_members);
        let (steps, bounds) = (&mut run.steps, &run.bounds);
        let candidate = piecewise_descent::follow(problem, bounds, start, &pattern, settings, steps, cancel);
        run.accept(candidate).and_then(Over::reason)
    })
}

/// Solves by `search`, which starts from the function values at the start and returns the reason where it was stopped
/// early.
fn solve_by<'a, P: Problem + ?Sized>(
    problem: &'a P,
    start: &DVector<f64>,
    settings: &'a Settings,
    cancel: &'a CancelFlag,
    search: impl FnOnce(&mut SolveInProgress<'a, P>, &ProgramEvaluation) -> Option<SolveStatus>,
) -> Result<ProgramSolution, ProgramInputError> {
    let bounds = problem.bounds();
    check_input(problem, start, &bounds, settings)?;
    let mut steps = StepSolver::default();
    steps.interior_only = settings.interior_only;
    steps.iterates = settings.keep_iterates.then(Vec::new);
    let mut run =
        SolveInProgress { problem, bounds, settings, cancel, steps, best: None, seen: InfeasibleEnds::default() };
    let mut at = ProgramEvaluation::new(problem);
    let is_finite = start.iter().all(|value| value.is_finite());
    let values = if is_finite { at.update_values(problem, start) } else { Err(Quantity::Start) };
    let stopped = match values {
        Ok(()) => search(&mut run, &at),
        Err(quantity) => Some(SolveStatus::NotFinite(quantity)),
    };
    Ok(run.finish(start, stopped))
}

/// Ends that matter for the status when no point is feasible.
#[derive(Debug, Clone, Copy, Default)]
struct InfeasibleEnds {
    infeasible: bool,
    iteration_limit: bool,
    unbounded: bool,
    not_finite: Option<Quantity>,
}

/// A solve in progress.
struct SolveInProgress<'a, P: Problem + ?Sized> {
    problem: &'a P,
    bounds: (DVector<f64>, DVector<f64>),
    settings: &'a Settings,
    cancel: &'a CancelFlag,
    steps: StepSolver,
    best: Option<CandidatePoint>,
    seen: InfeasibleEnds,
}

impl<P: Problem + ?Sized> SolveInProgress<'_, P> {
    /// Runs the solve; returns the reason where it was stopped early.
    fn go(&mut self, start: &DVector<f64>, at: &ProgramEvaluation) -> Option<SolveStatus> {
        let unpaired = self.problem.pairs() == 0 && at.cones.count() == 0;
        let may_search = self.settings.warm_start && !self.settings.whole_sequence && piecewise_descent::is_clear(at);
        if (unpaired || may_search)
            && let Some(end) = self.search(start, at)
        {
            return end.reason();
        }
        if unpaired {
            return None;
        }
        let mut first_relaxation = self.settings.first_relaxation;
        for restart in 0..=self.settings.restarts {
            self.steps.counts.restarts = restart;
            if let Some(end) = self.regularise(start, first_relaxation) {
                return end.reason();
            }
            first_relaxation = (first_relaxation * RESTART_FACTOR).min(LARGEST_RELAXATION);
        }
        self.try_other_branches()
    }

    /// The last resort where no feasible point was found: the branch nearest to the least infeasible point, then the
    /// branches that differ in one pair, or all branches where there are few pairs.
    fn try_other_branches(&mut self) -> Option<SolveStatus> {
        let best = self.best.as_ref().filter(|best| !best.is_feasible(self.settings.tolerance))?;
        let x = best.x.clone();
        for pattern in piecewise_descent::patterns_around(&best.at, self.settings.enumeration_limit) {
            if let Some(over) = self.search_from(&x, pattern) {
                return over.reason();
            }
        }
        None
    }

    /// One descent of `ε`; returns an end where the solve is over.
    fn regularise(&mut self, start: &DVector<f64>, first_relaxation: f64) -> Option<Over> {
        let mut x = start.clone();
        let mut relaxation = first_relaxation;
        let mut last_searched: Option<TreatmentPattern> = None;
        let mut last_pattern: Option<TreatmentPattern> = None;
        let cone_sizes = self.problem.cone_sizes();
        let sequence = SqpSettings {
            tolerance: self.settings.tolerance,
            iteration_limit: self.settings.iteration_limit,
            stop_when_settled: false,
        };
        for _ in 0..LEVEL_LIMIT {
            self.steps.counts.relaxation_levels += 1;
            self.steps.relaxation = Some(relaxation);
            let treatments = TreatmentPattern::relaxed(self.problem.pairs(), cone_sizes.len(), relaxation);
            let rows =
                SmoothProgramRows::new(self.problem.equalities(), self.problem.inequalities(), &cone_sizes, treatments);
            let outcome = sqp::solve(self.problem, &rows, &self.bounds, &x, sequence, &mut self.steps, self.cancel);
            match outcome.end {
                SqpEnd::Cancelled => return Some(Over::Stopped(SolveStatus::Cancelled)),
                SqpEnd::NotFinite(quantity) => {
                    self.seen.not_finite = Some(quantity);
                    return None;
                }
                SqpEnd::Unbounded => self.seen.unbounded = true,
                SqpEnd::Infeasible => self.seen.infeasible = true,
                SqpEnd::IterationLimit => self.seen.iteration_limit = true,
                SqpEnd::Converged | SqpEnd::Settled | SqpEnd::Stalled => {}
            }
            x = outcome.x;
            let is_last = relaxation <= self.settings.last_relaxation;
            let pattern = piecewise_descent::nearest_pattern(&outcome.at);
            let same = last_pattern.as_ref() == Some(&pattern);
            let hopeless = outcome.end == SqpEnd::Infeasible;
            let is_certain = !self.settings.whole_sequence && (piecewise_descent::is_clear(&outcome.at) || same);
            let worth_a_search = is_certain || is_last || hopeless;
            if worth_a_search && last_searched.as_ref() != Some(&pattern) {
                if let Some(over) = self.search(&x, &outcome.at) {
                    return Some(over);
                }
                last_searched = Some(pattern.clone());
            }
            last_pattern = Some(pattern);
            // Where the rows are contradictory even with this `ε`, a smaller `ε` cannot help.
            if is_last || hopeless {
                return None;
            }
            relaxation = (relaxation * self.settings.relaxation_factor).max(self.settings.last_relaxation);
        }
        None
    }

    /// Descends from the branch nearest to `x`; returns an end where the point is final or the solve has to stop.
    fn search(&mut self, x: &DVector<f64>, at: &ProgramEvaluation) -> Option<Over> {
        self.search_from(x, piecewise_descent::nearest_pattern(at))
    }

    /// Descends from the branch `pattern`.
    fn search_from(&mut self, x: &DVector<f64>, pattern: TreatmentPattern) -> Option<Over> {
        let candidate = piecewise_descent::descend(
            self.problem,
            &self.bounds,
            x,
            pattern,
            self.settings,
            &mut self.steps,
            self.cancel,
        );
        self.accept(candidate)
    }

    /// Stores a point that is better than the best so far; returns an end where it is final or the solve has to stop.
    fn accept(&mut self, candidate: CandidatePoint) -> Option<Over> {
        let over = match candidate.end {
            SqpEnd::Cancelled => Some(Over::Stopped(SolveStatus::Cancelled)),
            SqpEnd::Infeasible => {
                self.seen.infeasible = true;
                None
            }
            SqpEnd::IterationLimit => {
                self.seen.iteration_limit = true;
                None
            }
            SqpEnd::Unbounded => {
                self.seen.unbounded = true;
                None
            }
            SqpEnd::NotFinite(quantity) => {
                self.seen.not_finite = Some(quantity);
                None
            }
            SqpEnd::Converged | SqpEnd::Settled | SqpEnd::Stalled => {
                (candidate.end == SqpEnd::Settled || candidate.is_final(self.settings.tolerance)).then_some(Over::Found)
            }
        };
        let tolerance = self.settings.tolerance;
        if matches!(over, Some(Over::Found))
            || self.best.as_ref().is_none_or(|best| is_better(&candidate, best, tolerance))
        {
            self.best = Some(candidate);
        }
        over
    }

    fn finish(mut self, start: &DVector<f64>, stopped: Option<SolveStatus>) -> ProgramSolution {
        let tolerance = self.settings.tolerance;
        let Some(candidate) = self.best.take() else {
            return empty_solution(self.problem, start, stopped.unwrap_or(self.seen.status()), self.steps);
        };
        let is_feasible = candidate.is_feasible(tolerance);
        let status = match (stopped, candidate.end) {
            (Some(status), _) => status,
            (None, SqpEnd::Settled) => SolveStatus::PatternSettled,
            (None, SqpEnd::NotFinite(quantity)) => SolveStatus::NotFinite(quantity),
            (None, SqpEnd::Unbounded) if is_feasible => SolveStatus::Unbounded,
            (
                None,
                SqpEnd::Converged
                | SqpEnd::Stalled
                | SqpEnd::Infeasible
                | SqpEnd::IterationLimit
                | SqpEnd::Unbounded
                | SqpEnd::Cancelled,
            ) => match (is_feasible, candidate.stationarity) {
                (false, _) => self.seen.status(),
                (true, StationarityKind::Unknown) => SolveStatus::Feasible,
                (true, _) if !self.settings.looks_beyond => SolveStatus::Solved,
                (true, _) => {
                    let (problem, bounds, steps) = (self.problem, &self.bounds, &mut self.steps);
                    unboundedness::without_end(problem, bounds, &candidate, self.settings, steps, self.cancel)
                        .map_or(SolveStatus::Solved, SolveStatus::UnboundedIterates)
                }
            },
        };
        let both_zero = self.settings.biactive_tolerance;
        // The point of a settled pattern is not refined: its violation sets the distance that counts as close to a
        // cone's boundary.
        let left = if status == SolveStatus::PatternSettled { 10.0 * candidate.at.largest_violation() } else { 0.0 };
        let activities = Activities::of(&candidate.at, both_zero, both_zero.max(left));
        ProgramSolution {
            status,
            objective: candidate.at.objective,
            activity: activities.pairs,
            cone_activity: activities.cones,
            stationarity: candidate.stationarity,
            largest_violation: candidate.at.largest_violation(),
            largest_product: candidate.at.largest_product(),
            multipliers: candidate.multipliers,
            x: candidate.x,
            counts: self.steps.counts,
            last_relaxation: self.steps.relaxation,
            iterates: self.steps.iterates.unwrap_or_default(),
        }
    }
}

/// The reason why a solve is over.
enum Over {
    Found,
    Stopped(SolveStatus),
}

impl Over {
    fn reason(self) -> Option<SolveStatus> {
        match self {
            Self::Found => None,
            Self::Stopped(status) => Some(status),
        }
    }
}

impl InfeasibleEnds {
    fn status(self) -> SolveStatus {
        if let Some(quantity) = self.not_finite {
            SolveStatus::NotFinite(quantity)
        } else if self.infeasible {
            SolveStatus::Infeasible
        } else if self.iteration_limit {
            SolveStatus::IterationLimit
        } else if self.unbounded {
            SolveStatus::Unbounded
        } else {
            SolveStatus::NoProgress
        }
    }
}

fn is_better(candidate: &CandidatePoint, best: &CandidatePoint, tolerance: f64) -> bool {
    match (candidate.is_feasible(tolerance), best.is_feasible(tolerance)) {
        (true, false) => true,
        (false, true) => false,
        (true, true) => candidate.at.objective < best.at.objective,
        (false, false) => candidate.infeasibility() < best.infeasibility(),
    }
}

/// The start itself, where no better point was computed.
fn empty_solution<P: Problem + ?Sized>(
    problem: &P,
    start: &DVector<f64>,
    status: SolveStatus,
    steps: StepSolver,
) -> ProgramSolution {
    ProgramSolution {
        status,
        x: start.clone(),
        objective: f64::NAN,
        multipliers: sqp::no_multipliers(problem),
        activity: vec![PairActivity::NeitherZero; problem.pairs()],
        cone_activity: vec![ConeActivity::NotComplementary; problem.cone_sizes().len()],
        stationarity: StationarityKind::Unknown,
        largest_violation: f64::INFINITY,
        largest_product: f64::INFINITY,
        counts: steps.counts,
        last_relaxation: steps.relaxation,
        iterates: steps.iterates.unwrap_or_default(),
    }
}
