//! Descent over branches: a pattern of zero members is solved as a smooth program, the result is classified, and a
//! neighbouring branch with descent, if any, is solved next.
//!
//! A branch program has no products, so it satisfies the usual constraint qualifications where the regularised program
//! with a small `ε` does not, and its solution is exactly complementary. The objective falls from branch to branch, so
//! no branch occurs twice; the number of changes is bounded nevertheless.
//!
//! Source: the piecewise programming of Z.-Q. Luo, J.-S. Pang and D. Ralph, *Mathematical Programs with Equilibrium
//! Constraints* (Cambridge University Press, 1996), doi:10.1017/CBO9780511983658.

use crate::complementarity::mpec::tolerances::{
    BIACTIVE_ROUND_OFF, CLEAR_PATTERN_RATIO, SMALLEST_DECREASE, VIOLATION_MULTIPLE,
};
use nalgebra::DVector;

use crate::complementarity::mpec::program::cone;
use crate::complementarity::mpec::program::evaluation::ProgramEvaluation;
use crate::complementarity::mpec::program::problem::Problem;
use crate::complementarity::mpec::quadratic_program::driver::StepSolver;
use crate::complementarity::mpec::result::StationarityKind;
use crate::complementarity::mpec::settings::{Finish, Settings};
use crate::complementarity::mpec::smooth_program::cone_rows::ConeTreatment;
use crate::complementarity::mpec::smooth_program::pair_treatment::{PairTreatment, TreatmentPattern};
use crate::complementarity::mpec::smooth_program::smooth_rows::{Multipliers, SmoothProgramRows};
use crate::complementarity::mpec::smooth_program::sqp::{self, SqpEnd, SqpOutcome, SqpSettings};
use crate::complementarity::mpec::stationarity::{self, NoVerdict};
use crate::resources::cancel::CancelFlag;

/// Largest number of pairs whose branches are all tried before a problem is called infeasible, whatever the settings.
const ENUMERATION_CEILING: usize = 10;
/// The end point of a search over branches or of a regularised program.
#[derive(Debug, Clone)]
pub struct CandidatePoint {
    pub end: SqpEnd,
    pub x: DVector<f64>,
    pub at: ProgramEvaluation,
    pub multipliers: Multipliers,
    pub stationarity: StationarityKind,
}

impl CandidatePoint {
    /// Largest violation, complementarity included.
    pub fn infeasibility(&self) -> f64 {
        self.at.largest_violation().max(self.at.largest_product())
    }

    pub fn is_feasible(&self, tolerance: f64) -> bool {
        self.infeasibility() <= tolerance
    }

    /// Whether no local improvement is possible.
    pub fn is_final(&self, tolerance: f64) -> bool {
        self.is_feasible(tolerance)
            && match self.stationarity {
                StationarityKind::Strong | StationarityKind::Branch => true,
                StationarityKind::Mordukhovich
                | StationarityKind::Clarke
                | StationarityKind::Weak
                | StationarityKind::OneBranch
                | StationarityKind::Unknown => self.end == SqpEnd::Settled,
            }
    }
}

/// The branch in which the smaller member of each pair is zero.
pub fn nearest_pattern(at: &ProgramEvaluation) -> TreatmentPattern {
    let pairs = at.first.iter().zip(at.second.iter());
    TreatmentPattern {
        pairs: pairs.map(|(a, b)| if a <= b { PairTreatment::FirstZero } else { PairTreatment::SecondZero }).collect(),
        cones: at.cones.pairs().map(|(a, b)| ConeTreatment::nearest(a, b)).collect(),
    }
}

/// The branch nearest to a point, then the branches around it: all branches where there are few scalar pairs (at most
/// `limit`) and no cones, otherwise those that differ in one pair.
pub fn patterns_around(at: &ProgramEvaluation, limit: usize) -> Vec<TreatmentPattern> {
    let nearest = nearest_pattern(at);
    let pairs = nearest.pairs.len();
    let flips: Vec<Vec<usize>> = if pairs <= limit.min(ENUMERATION_CEILING) && nearest.cones.is_empty() {
        let mut subsets: Vec<usize> = (0..1_usize << pairs).collect();
        subsets.sort_by_key(|subset| subset.count_ones());
        subsets.into_iter().map(|subset| (0..pairs).filter(|pair| subset >> pair & 1 == 1).collect()).collect()
    } else {
        std::iter::once(vec![]).chain((0..pairs.min(1 << ENUMERATION_CEILING)).map(|pair| vec![pair])).collect()
    };
    let flipped = |flipped: Vec<usize>| {
        let mut pattern = nearest.clone();
        for pair in flipped {
            pattern.pairs[pair] = match pattern.pairs[pair] {
                PairTreatment::FirstZero => PairTreatment::SecondZero,
                PairTreatment::SecondZero
                | PairTreatment::Product(_)
                | PairTreatment::BothFree
                | PairTreatment::BothZero => PairTreatment::FirstZero,
            };
        }
        pattern
    };
    let mut patterns: Vec<TreatmentPattern> = flips.into_iter().map(flipped).collect();
    for (pair, (a, b)) in at.cones.pairs().enumerate().take(1 << ENUMERATION_CEILING) {
        for treatment in nearest.cones[pair].others(a, b) {
            let mut pattern = nearest.clone();
            pattern.cones[pair] = treatment;
            patterns.push(pattern);
        }
    }
    patterns
}

/// True where the smaller member of every pair is small compared with the larger, and every cone pair is nearly
/// complementary.
pub fn is_clear(at: &ProgramEvaluation) -> bool {
    let largest = |v: &[f64]| v.iter().fold(0.0_f64, |largest, value| largest.max(value.abs()));
    at.first.iter().zip(at.second.iter()).all(|(a, b)| a.min(*b) <= CLEAR_PATTERN_RATIO * a.max(*b))
        && at
            .cones
            .pairs()
            .all(|(a, b)| cone::natural_residual(a, b) <= CLEAR_PATTERN_RATIO * largest(a).max(largest(b)))
}

/// Solves the branch `pattern` from `start` and follows descent into neighbouring branches. The candidate's end states
/// whether the whole solve has to stop: cancelled, or a function value that is not finite.
pub fn descend<P: Problem + ?Sized>(
    problem: &P,
    bounds: &(DVector<f64>, DVector<f64>),
    start: &DVector<f64>,
    mut pattern: TreatmentPattern,
    settings: &Settings,
    steps: &mut StepSolver,
    cancel: &CancelFlag,
) -> CandidatePoint {
    let mut stop_when_settled = settings.finish == Finish::PatternSettled;
    let cone_sizes = problem.cone_sizes();
    let mut changes_left = 2 * problem.pairs() + 3 * cone_sizes.len() + 8;
    let mut start = start.clone();
    let mut best: Option<CandidatePoint> = None;
    loop {
        steps.counts.branches += 1;
        let sequence =
            SqpSettings { tolerance: settings.tolerance, iteration_limit: settings.iteration_limit, stop_when_settled };
        let rows = SmoothProgramRows::new(problem.equalities(), problem.inequalities(), &cone_sizes, pattern.clone());
        let outcome = sqp::solve(problem, &rows, bounds, &start, sequence, steps, cancel);
        let mut candidate = CandidatePoint {
            end: outcome.end,
            x: outcome.x,
            at: outcome.at,
            multipliers: outcome.multipliers,
            stationarity: StationarityKind::Unknown,
        };
        let improves = best.as_ref().is_none_or(|best| {
            candidate.is_feasible(settings.tolerance)
                && candidate.at.objective < best.at.objective - SMALLEST_DECREASE * (1.0 + best.at.objective.abs())
        });
        let stopped = matches!(candidate.end, SqpEnd::Cancelled | SqpEnd::NotFinite(_));
        if !improves {
            return match best {
                Some(best) if !stopped => best,
                Some(_) | None => candidate,
            };
        }
        let settled_clearly = candidate.end == SqpEnd::Settled
            && !stationarity::is_biactive(&candidate.at, uncertain(&candidate.at, settings));
        if stopped || settled_clearly || candidate.end == SqpEnd::Unbounded || changes_left == 0 {
            return candidate;
        }
        if candidate.end == SqpEnd::Settled {
            // A biactive pair: the pattern is uncertain, and its classification requires a converged point.
            stop_when_settled = false;
            changes_left -= 1;
            start.copy_from(&candidate.x);
            continue;
        }
        if !candidate.is_feasible(settings.tolerance) {
            return candidate;
        }
        let descent = match judge(problem, &pattern, &mut candidate, settings, steps, cancel) {
            Ok(descent) => descent,
            Err(end) => {
                candidate.end = end;
                return candidate;
            }
        };
        let Some(next) = descent else { return candidate };
        start.copy_from(&candidate.x);
        pattern = next;
        best = Some(candidate);
        changes_left -= 1;
    }
}

/// Magnitude up to which both members of a pair at a settled point may be zero: the remaining violation indicates how
/// far they may still change.
fn uncertain(at: &ProgramEvaluation, settings: &Settings) -> f64 {
    settings.biactive_tolerance.max(VIOLATION_MULTIPLE * at.largest_violation())
}

/// Solves the branch `pattern` from `start` without changing to another branch. The candidate is settled or stationary
/// where only the rows of the branch are active: strongly, or in one branch where both members of a pair are zero and
/// another branch might give descent. Its kind is unknown where another row is active.
pub fn follow<P: Problem + ?Sized>(
    problem: &P,
    bounds: &(DVector<f64>, DVector<f64>),
    start: &DVector<f64>,
    pattern: &TreatmentPattern,
    settings: &Settings,
    steps: &mut StepSolver,
    cancel: &CancelFlag,
) -> CandidatePoint {
    let rows =
        SmoothProgramRows::new(problem.equalities(), problem.inequalities(), &problem.cone_sizes(), pattern.clone());
    let (tolerance, iteration_limit) = (settings.tolerance, settings.iteration_limit);
    let mut start = start.clone();
    let mut stop_when_settled = settings.finish == Finish::PatternSettled;
    loop {
        steps.counts.branches += 1;
        let sequence = SqpSettings { tolerance, iteration_limit, stop_when_settled };
        let outcome = sqp::solve(problem, &rows, bounds, &start, sequence, steps, cancel);
        let is_unclear = steps.is_bound() || stationarity::is_biactive(&outcome.at, uncertain(&outcome.at, settings));
        if outcome.end == SqpEnd::Settled && is_unclear {
            start = outcome.x;
            stop_when_settled = false;
            continue;
        }
        let pairs = outcome.multipliers.first.iter().zip(outcome.multipliers.second.iter());
        let least = -tolerance * (1.0 + outcome.at.gradient.iter().fold(0.0_f64, |most, entry| most.max(entry.abs())));
        let members = outcome.at.first.iter().zip(outcome.at.second.iter());
        let may_leave = pairs
            .zip(members)
            .any(|((of_first, of_second), (a, b))| a.max(*b) <= BIACTIVE_ROUND_OFF && of_first.min(*of_second) < least);
        let stationarity = match (outcome.end == SqpEnd::Converged && !steps.is_bound(), may_leave) {
            (true, false) => StationarityKind::Strong,
            (true, true) => StationarityKind::OneBranch,
            (false, _) => StationarityKind::Unknown,
        };
        let SqpOutcome { end, x, at, multipliers } = outcome;
        return CandidatePoint { end, x, at, multipliers, stationarity };
    }
}

/// Classifies a converged point; returns the branch with descent from it, if any.
fn judge<P: Problem + ?Sized>(
    problem: &P,
    pattern: &TreatmentPattern,
    candidate: &mut CandidatePoint,
    settings: &Settings,
    steps: &mut StepSolver,
    cancel: &CancelFlag,
) -> Result<Option<TreatmentPattern>, SqpEnd> {
    let converged = candidate.end == SqpEnd::Converged;
    let verdict = stationarity::classify(
        problem,
        &candidate.x,
        pattern,
        converged.then_some(&candidate.multipliers),
        settings,
        steps,
        cancel,
    )
    .map_err(|reason| match reason {
        NoVerdict::Cancelled => SqpEnd::Cancelled,
        NoVerdict::NotFinite(quantity) => SqpEnd::NotFinite(quantity),
    })?;
    candidate.stationarity = verdict.kind;
    if let Some(multipliers) = verdict.multipliers {
        candidate.multipliers = multipliers;
    }
    Ok(verdict.descent)
}
