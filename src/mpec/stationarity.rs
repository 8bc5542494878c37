//! How stationary a feasible point is, and which branch leads down from it where it is not.
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
//! * `a = b = 0` on `B`: weak stationarity; its multipliers' signs tell Mordukhovich and Clarke.
//!
//! Source: H. Scheel and S. Scholtes, *Mathematical programs with complementarity constraints: stationarity, optimality,
//! and sensitivity*, Math. Oper. Res. 25 (2000), doi:10.1287/moor.25.1.1.15213.

use nalgebra::{DMatrix, DVector};

use super::elastic::StepSolver;
use super::evaluation::{Evaluation, Quantity};
use super::problem::Problem;
use super::quadratic::{QuadraticFailure, QuadraticProgram};
use super::relaxed::{Multipliers, PairTreatment, Rows};
use super::result::StationarityKind;
use super::settings::Settings;
use crate::cancel::CancelFlag;

/// Length of a projected gradient that counts as zero, relative to `1 + ‖∇f‖∞`.
const STATIONARY_LENGTH: f64 = 1e-6;

/// Most biactive pairs whose branches are enumerated, whatever the settings ask for.
const ENUMERATION_CEILING: usize = 16;

/// What is known of a point.
#[derive(Debug, Clone)]
pub struct Verdict {
    pub kind: StationarityKind,
    /// Multipliers that prove the kind, where it is proved by multipliers.
    pub multipliers: Option<Multipliers>,
    /// A branch with first-order descent.
    pub descent: Option<Vec<PairTreatment>>,
}

/// Why no verdict was reached.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum NoVerdict {
    NotFinite(Quantity),
    Cancelled,
}

/// The pairs that are biactive at `at`.
pub fn biactive(at: &Evaluation, tolerance: f64) -> Vec<usize> {
    (0..at.first.len()).filter(|&i| at.first[i] <= tolerance && at.second[i] <= tolerance).collect()
}

struct Judge<'a> {
    at: &'a Evaluation,
    x: &'a DVector<f64>,
    bounds: &'a (DVector<f64>, DVector<f64>),
    cancel: &'a CancelFlag,
}

impl Judge<'_> {
    /// Projected gradient, its first-order decrease and the multipliers under the given treatments.
    fn project(&self, treatments: Vec<PairTreatment>, steps: &mut StepSolver) -> Result<Option<Projection>, NoVerdict> {
        let rows = Rows::new(self.at.equality.len(), self.at.inequality.len(), treatments);
        let n = self.x.len();
        let program: QuadraticProgram = rows.linearise(self.at, self.x, self.bounds, DMatrix::identity(n, n));
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

/// Classifies the feasible point `x` of the branch `pattern`. The branch program's multipliers,
/// where it converged, may settle the matter without a further program.
///
/// # Errors
/// [`NoVerdict`] where a derivative is not finite or the flag is raised.
pub fn classify<P: Problem + ?Sized>(
    problem: &P,
    x: &DVector<f64>,
    pattern: &[PairTreatment],
    multipliers: Option<&Multipliers>,
    settings: &Settings,
    steps: &mut StepSolver,
    cancel: &CancelFlag,
) -> Result<Verdict, NoVerdict> {
    let mut at = Evaluation::new(problem);
    at.update_values(problem, x).map_err(NoVerdict::NotFinite)?;
    let both = biactive(&at, settings.biactive_tolerance);
    let signs_hold = |multipliers: &Multipliers| {
        let largest = multipliers.first.iter().chain(multipliers.second.iter()).fold(0.0_f64, |w, v| w.max(v.abs()));
        let zero = -settings.tolerance * (1.0 + largest);
        both.iter().all(|&i| multipliers.first[i] >= zero && multipliers.second[i] >= zero)
    };
    if multipliers.is_some_and(signs_hold) {
        return Ok(Verdict { kind: StationarityKind::Strong, multipliers: None, descent: None });
    }
    at.update_derivatives(problem, x).map_err(NoVerdict::NotFinite)?;
    let bounds = problem.bounds();
    let judge = Judge { at: &at, x, bounds: &bounds, cancel };
    let with_biactive = |choose: &dyn Fn(usize) -> PairTreatment| {
        let mut treatments = pattern.to_vec();
        for (place, &i) in both.iter().enumerate() {
            treatments[i] = choose(place);
        }
        treatments
    };

    if let Some(relaxed) = judge.project(with_biactive(&|_| PairTreatment::BothFree), steps)?
        && relaxed.is_zero
    {
        let multipliers = Some(relaxed.multipliers);
        return Ok(Verdict { kind: StationarityKind::Strong, multipliers, descent: None });
    }

    let mut best: Option<(f64, Vec<PairTreatment>)> = None;
    let mut all_judged = both.len() <= settings.enumeration_limit.min(ENUMERATION_CEILING);
    if all_judged {
        for branch in 0..(1_usize << both.len()) {
            let zero_member = |place: usize| {
                if branch >> place & 1 == 0 { PairTreatment::FirstZero } else { PairTreatment::SecondZero }
            };
            let treatments = with_biactive(&zero_member);
            match judge.project(treatments.clone(), steps)? {
                Some(projection) if !projection.is_zero => {
                    if best.as_ref().is_none_or(|(objective, _)| projection.objective < *objective) {
                        best = Some((projection.objective, treatments));
                    }
                }
                Some(_) => {}
                None => all_judged = false,
            }
        }
    }
    let tight = judge.project(with_biactive(&|_| PairTreatment::BothZero), steps)?;
    let weak = match &tight {
        Some(projection) if projection.is_zero => sign_kind(&projection.multipliers, &both, settings.tolerance),
        Some(_) | None => StationarityKind::Unknown,
    };
    let kind = if all_judged && best.is_none() { StationarityKind::Branch } else { weak };
    let multipliers = tight.filter(|projection| projection.is_zero).map(|projection| projection.multipliers);
    Ok(Verdict { kind, multipliers, descent: best.map(|(_, treatments)| treatments) })
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
