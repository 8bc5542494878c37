//! The kind of stationarity of a feasible point, and a branch with descent where the point is not stationary.
//!
//! With the biactive pairs `B` at `x` (both members zero to a tolerance), projected-gradient programs
//!
//! ```text
//! min ∇f·d + ½ |d|²    s.t. the rows linearised at x, the pairs of B treated as below
//! ```
//!
//! have the solution `d = 0` exactly where first-order multipliers exist:
//!
//! * `a, b >= 0` on `B`: strong stationarity (all multipliers of `B` nonnegative);
//! * one member zero, the other nonnegative, in each of the `2^|B|` ways: stationarity of every branch (B-stationarity
//!   of the linearised program, hence of the program where the usual tangent condition holds);
//! * `a = b = 0` on `B`: weak stationarity; its multipliers' signs distinguish Mordukhovich and Clarke.
//!
//! Cone pairs: near a pair that is not biactive, the constraint is a smooth manifold, the current branch, and the above
//! remains unchanged. Where one member vanishes and the other lies on the boundary, two branches meet, and the
//! enumeration includes both: the result is stationarity of every branch, or of one branch at most. Where both members
//! vanish, infinitely many branches meet; only the two branches with one zero member and the current branch are
//! examined, and stationarity of one branch at most is claimed.
//!
//! Source: H. Scheel and S. Scholtes, *Mathematical programs with complementarity constraints: stationarity, optimality,
//! and sensitivity*, Math. Oper. Res. 25 (2000), doi:10.1287/moor.25.1.1.15213.

use crate::complementarity::mpec::tolerances::STATIONARY_LENGTH;
use nalgebra::DVector;

use crate::complementarity::mpec::program::cone::ConeActivity;
use crate::complementarity::mpec::program::evaluation::{ProgramEvaluation, Quantity};
use crate::complementarity::mpec::program::problem::Problem;
use crate::complementarity::mpec::program::sparse_rows::SparseRows;
use crate::complementarity::mpec::quadratic_program::driver::StepSolver;
use crate::complementarity::mpec::quadratic_program::interior_point::{QuadraticFailure, QuadraticProgram};
use crate::complementarity::mpec::result::StationarityKind;
use crate::complementarity::mpec::settings::Settings;
use crate::complementarity::mpec::smooth_program::cone_rows::ConeTreatment;
use crate::complementarity::mpec::smooth_program::pair_treatment::{PairTreatment, TreatmentPattern};
use crate::complementarity::mpec::smooth_program::smooth_rows::{Multipliers, SmoothProgramRows};
use crate::resources::cancel::CancelFlag;

/// Largest number of biactive pairs whose branches are enumerated, whatever the settings.
const ENUMERATION_CEILING: usize = 16;

/// The stationarity established for a point.
#[derive(Debug, Clone)]
pub struct StationarityVerdict {
    pub kind: StationarityKind,
    /// Multipliers that prove the kind, where it is proved by multipliers.
    pub multipliers: Option<Multipliers>,
    /// A branch with first-order descent.
    pub descent: Option<TreatmentPattern>,
}

/// The reason why no verdict was reached.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum NoVerdict {
    NotFinite(Quantity),
    Cancelled,
}

/// The pairs that are biactive at `at`.
pub fn biactive(at: &ProgramEvaluation, tolerance: f64) -> Vec<usize> {
    (0..at.first.len()).filter(|&i| at.first[i] <= tolerance && at.second[i] <= tolerance).collect()
}

/// Whether any pair or cone pair is biactive.
pub fn is_biactive(at: &ProgramEvaluation, tolerance: f64) -> bool {
    !biactive(at, tolerance).is_empty()
        || at.cones.pairs().any(|(a, b)| ConeActivity::of(a, b, tolerance).is_biactive())
}

/// The branches that meet at each biactive cone pair, and whether the lists are complete.
fn cone_branches(
    at: &ProgramEvaluation,
    pattern: &TreatmentPattern,
    tolerance: f64,
) -> (Vec<(usize, Vec<ConeTreatment>)>, bool) {
    let mut complete = true;
    let mut branches = Vec::new();
    for (pair, (a, b)) in at.cones.pairs().enumerate() {
        match ConeActivity::of(a, b, tolerance) {
            ConeActivity::FirstZeroSecondOnBoundary => {
                branches.push((pair, vec![ConeTreatment::FirstZero, ConeTreatment::AlongSecond]));
            }
            ConeActivity::SecondZeroFirstOnBoundary => {
                branches.push((pair, vec![ConeTreatment::SecondZero, ConeTreatment::AlongFirst]));
            }
            ConeActivity::BothZero => {
                complete = false;
                let mut treatments = vec![ConeTreatment::FirstZero, ConeTreatment::SecondZero];
                if !treatments.contains(&pattern.cones[pair]) {
                    treatments.push(pattern.cones[pair]);
                }
                branches.push((pair, treatments));
            }
            ConeActivity::FirstZero
            | ConeActivity::SecondZero
            | ConeActivity::BothOnBoundary
            | ConeActivity::NotComplementary => {}
        }
    }
    (branches, complete)
}

struct StationarityTest<'a> {
    at: &'a ProgramEvaluation,
    x: &'a DVector<f64>,
    bounds: &'a (DVector<f64>, DVector<f64>),
    cancel: &'a CancelFlag,
}

impl StationarityTest<'_> {
    /// Projected gradient, its first-order decrease and the multipliers under the given treatments.
    fn project(&self, treatments: TreatmentPattern, steps: &mut StepSolver) -> Result<Option<Projection>, NoVerdict> {
        let sizes: Vec<usize> = self.at.cones.pairs().map(|(a, _)| a.len()).collect();
        let rows = SmoothProgramRows::new(self.at.equality.len(), self.at.inequality.len(), &sizes, treatments);
        let n = self.x.len();
        let program: QuadraticProgram = rows.linearise(self.at, self.x, self.bounds, SparseRows::identity(n));
        steps.forget();
        match steps.solve(&program, self.cancel) {
            Ok(step) if step.remaining_violation == 0.0 => {
                let length = if n == 0 { 0.0 } else { step.solution.step.amax() };
                Ok(Some(Projection {
                    is_zero: length <= STATIONARY_LENGTH * (1.0 + if n == 0 { 0.0 } else { self.at.gradient.amax() }),
                    objective: program.objective(&step.solution.step),
                    multipliers: rows.multipliers(self.at, &step.solution),
                }))
            }
            Err(QuadraticFailure::Cancelled) => Err(NoVerdict::Cancelled),
            Ok(_)
            | Err(
                QuadraticFailure::NotFinite
                | QuadraticFailure::SuspectedInfeasible
                | QuadraticFailure::SuspectedUnbounded
                | QuadraticFailure::Inaccurate,
            ) => Ok(None),
        }
    }
}

struct Projection {
    is_zero: bool,
    objective: f64,
    multipliers: Multipliers,
}

/// Classifies the feasible point `x` of the branch `pattern`. The multipliers of the converged branch program may
/// decide without a further program.
///
/// # Errors
/// [`NoVerdict`] where a derivative is not finite or the flag is raised.
pub fn classify<P: Problem + ?Sized>(
    problem: &P,
    x: &DVector<f64>,
    pattern: &TreatmentPattern,
    multipliers: Option<&Multipliers>,
    settings: &Settings,
    steps: &mut StepSolver,
    cancel: &CancelFlag,
) -> Result<StationarityVerdict, NoVerdict> {
    let mut at = ProgramEvaluation::new(problem);
    at.update_values(problem, x).map_err(NoVerdict::NotFinite)?;
    let both = biactive(&at, settings.biactive_tolerance);
    let signs_hold = |multipliers: &Multipliers| {
        let largest = multipliers.first.iter().chain(multipliers.second.iter()).fold(0.0_f64, |w, v| w.max(v.abs()));
        let zero = -settings.tolerance * (1.0 + largest);
        both.iter().all(|&i| multipliers.first[i] >= zero && multipliers.second[i] >= zero)
    };
    let (cones, cones_complete) = cone_branches(&at, pattern, settings.biactive_tolerance);
    if cones.is_empty() && multipliers.is_some_and(signs_hold) {
        return Ok(StationarityVerdict { kind: StationarityKind::Strong, multipliers: None, descent: None });
    }
    at.update_derivatives(problem, x).map_err(NoVerdict::NotFinite)?;
    let bounds = problem.bounds();
    let judge = StationarityTest { at: &at, x, bounds: &bounds, cancel };
    if cones.is_empty()
        && let Some(relaxed) = judge.project(with_biactive(pattern, &both, &|_| PairTreatment::BothFree), steps)?
        && relaxed.is_zero
    {
        let multipliers = Some(relaxed.multipliers);
        return Ok(StationarityVerdict { kind: StationarityKind::Strong, multipliers, descent: None });
    }

    let BranchProjections { best, stationary, all_judged } =
        project_onto_branches(&judge, pattern, &both, &cones, settings.enumeration_limit, steps)?;
    let descent = |best: Option<(f64, TreatmentPattern)>| best.map(|(_, treatments)| treatments);
    if !cones.is_empty() {
        let kind = match (all_judged && cones_complete && best.is_none(), &stationary) {
            (true, _) => StationarityKind::Branch,
            (false, Some(_)) => StationarityKind::OneBranch,
            (false, None) => StationarityKind::Unknown,
        };
        return Ok(StationarityVerdict { kind, multipliers: stationary, descent: descent(best) });
    }
    let tight = judge.project(with_biactive(pattern, &both, &|_| PairTreatment::BothZero), steps)?;
    let weak = match &tight {
        Some(projection) if projection.is_zero => sign_kind(&projection.multipliers, &both, settings.tolerance),
        Some(_) | None => StationarityKind::Unknown,
    };
    let kind = if all_judged && best.is_none() { StationarityKind::Branch } else { weak };
    let multipliers = tight.filter(|projection| projection.is_zero).map(|projection| projection.multipliers);
    Ok(StationarityVerdict { kind, multipliers, descent: descent(best) })
}

/// The results of the projections onto the branches that meet at a point.
struct BranchProjections {
    /// The branch with the largest decrease of the objective, if any, with the objective reached.
    best: Option<(f64, TreatmentPattern)>,
    /// Multipliers of the first stationary branch.
    stationary: Option<Multipliers>,
    all_judged: bool,
}

/// Projects onto every branch, unless there are too many.
fn project_onto_branches(
    judge: &StationarityTest<'_>,
    pattern: &TreatmentPattern,
    both: &[usize],
    cones: &[(usize, Vec<ConeTreatment>)],
    enumeration_limit: usize,
    steps: &mut StepSolver,
) -> Result<BranchProjections, NoVerdict> {
    let mut best: Option<(f64, TreatmentPattern)> = None;
    let mut stationary: Option<Multipliers> = None;
    let choices: Vec<usize> =
        both.iter().map(|_| 2).chain(cones.iter().map(|(_, treatments)| treatments.len())).collect();
    let branches = choices.iter().try_fold(1_usize, |count, choices| count.checked_mul(*choices));
    let bound = 1 << enumeration_limit.min(ENUMERATION_CEILING);
    let branches = branches.filter(|branches| *branches <= bound);
    let mut all_judged = branches.is_some();
    if let Some(branches) = branches {
        for branch in 0..branches {
            // The branch's number has one digit per biactive pair.
            let digit = |place: usize| branch / choices[..place].iter().product::<usize>() % choices[place];
            let zero_member =
                |place: usize| if digit(place) == 0 { PairTreatment::FirstZero } else { PairTreatment::SecondZero };
            let mut treatments = with_biactive(pattern, both, &zero_member);
            for (place, (pair, of_cone)) in cones.iter().enumerate() {
                treatments.cones[*pair] = of_cone[digit(both.len() + place)];
            }
            match judge.project(treatments.clone(), steps)? {
                Some(projection) if !projection.is_zero => {
                    if best.as_ref().is_none_or(|(objective, _)| projection.objective < *objective) {
                        best = Some((projection.objective, treatments));
                    }
                }
                Some(projection) => {
                    stationary.get_or_insert(projection.multipliers);
                }
                None => all_judged = false,
            }
        }
    }
    Ok(BranchProjections { best, stationary, all_judged })
}

/// The pattern with each biactive pair treated by its index among the biactive pairs.
fn with_biactive(
    pattern: &TreatmentPattern,
    both: &[usize],
    choose: &dyn Fn(usize) -> PairTreatment,
) -> TreatmentPattern {
    let mut treatments = pattern.clone();
    for (place, &i) in both.iter().enumerate() {
        treatments.pairs[i] = choose(place);
    }
    treatments
}

/// The kind that the signs of the tightened program's multipliers prove.
fn sign_kind(multipliers: &Multipliers, both: &[usize], tolerance: f64) -> StationarityKind {
    let pairs = || both.iter().map(|&i| (multipliers.first[i], multipliers.second[i]));
    let zero = |value: f64| value.abs() <= tolerance;
    if pairs().all(|(a, b)| zero(a) || zero(b) || (a > 0.0 && b > 0.0)) {
        StationarityKind::Mordukhovich
    } else if pairs().all(|(a, b)| a * b >= -tolerance) {
        StationarityKind::Clarke
    } else {
        StationarityKind::Weak
    }
}
