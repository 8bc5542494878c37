//! Whether the path passes a smooth bifurcation point within a step.
//!
//! Two quantities are monitored along the path:
//!
//! * the determinant of the equations of the mode, bordered by the path's own direction. The bordered matrix is regular
//!   at limit points, and the determinant changes sign exactly at bifurcation points with an odd number of additional
//!   null vectors (H. B. Keller, in: Applications of Bifurcation Theory, Academic Press 1977, 359). It is a by-product
//!   of the factorisation that gives the direction, and is valid for unsymmetric matrices (frictional slip) as well.
//! * the number of negative eigenvalues of the tangent reduced to the motions that the mode allows, `Zᵀ K Z` with `Z` a
//!   basis of the null space of the closed contacts' equations (Sylvester's law: any basis will do). It detects two
//!   eigenvalues that cross together, where the determinant keeps its sign. At a limit point it changes by one; the
//!   determinant distinguishes this change from that at a bifurcation.
//!
//! Contacts that touch without reaction throughout a step do not affect the path in any mode, but may block a branch:
//! the mode in which they are free is monitored as well.
//!
//! In a mode with frictional slip the eigenvalues are those of the structure with the slipping contacts stuck: two that
//! cross together are detected only where their motions do not move these contacts. In no mode are eigenvalues detected
//! that cross zero twice within one step, or that cross within the first ten-thousandth of a step from a singular start
//! (with sparse matrices the first hundredth). With slip in a plane the determinant also changes sign where the
//! direction is indeterminate (`folded_singularity`).

use crate::algebra::sparse::{Bordered, held_inertia};
use crate::algebra::{Determinant, Inertia, SystemFactorisation, determinant, inertia, null_space};
use crate::branching::bifurcation::singularity::tolerances::{ASYMMETRY, ZERO_PIVOT};
use crate::mechanics::contact::{ContactPair, Mode};
use crate::mechanics::equations::scaled_rows::scaled_rows;
use crate::mechanics::equations::tolerances::RANK_TOLERANCE;
use crate::mechanics::equations::{Kind, ModeSystem, matrix, mode_factorisation};
use crate::mechanics::problem::loading::Loading;
use crate::mechanics::problem::state::{Rate, State};
use crate::mechanics::problem::tolerances::CONTACT_TOLERANCE;
use crate::step::corrector::cost_counters::Work;
use crate::step::corrector::tangent;
use crate::step::corrector::tolerances::UNCERTAIN_PIVOT_RATIO;
use crate::step::event_functions::EventFunction;
use crate::step::mode_step::{Reached, StepStart};
use nalgebra::DMatrix;
use serde::{Deserialize, Serialize};

/// The quantities monitored along the path for bifurcations.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
pub struct Signature {
    /// Sign of the bordered determinant.
    pub determinant: f64,
    /// Negative eigenvalues of the reduced tangent; `None` where they are not counted.
    pub negative: Option<usize>,
}

/// How the signature changed over a step.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum SignatureChange {
    None,
    /// The number of negative eigenvalues rose by `net` (fell, if below 0).
    Count {
        before: usize,
        net: isize,
    },
    /// An odd number of real eigenvalues crossed zero.
    Odd,
}

/// Parts of a step after which the signature of a singular start is evaluated.
const FURTHER_ON: [f64; 3] = [1e-4, 1e-3, 1e-2];
/// The same with sparse matrices, whose pivots do not show how nearly singular they are: along a branch that leaves
/// without a load rate the eigenvalue grows with the square of the arc length, and where it is round-off so is the
/// branch.
const FURTHER_ON_SPARSE: [f64; 1] = [1e-2];

/// Whether some contact slips with friction.
fn slips(loading: Loading<'_>, modes: &[Mode]) -> bool {
    let slips = |(mode, contact): (&Mode, &ContactPair)| matches!(mode, Mode::Slip { .. }) && contact.tangents() > 0;
    modes.iter().zip(loading.contacts).any(slips)
}

/// The tangent whose negative eigenvalues are counted, reduced to the motions that the mode allows, without those of
/// contacts that slip with friction. `None` where fewer than two motions remain (the determinant suffices), and where
/// the tangent is constant.
pub fn counted_tangent(loading: Loading<'_>, modes: &[Mode], start: &State, state: &State) -> Option<DMatrix<f64>> {
    let (modes, anchor) = counted_modes(loading, modes, start, state)?;
    let system = ModeSystem::new(loading, &modes, anchor);
    let constraints = system.size() - 1 - loading.structure.unknowns();
    if constraints + 2 > loading.structure.unknowns() {
        return None;
    }
    reduced_tangent(&system, loading, state).filter(|tangent| tangent.nrows() > 1)
}

/// The modes in which the tangent is counted, and the state at which they begin.
fn counted_modes<'s>(
    loading: Loading<'_>,
    modes: &[Mode],
    start: &'s State,
    state: &'s State,
) -> Option<(Vec<Mode>, &'s State)> {
    let unknowns = loading.structure.unknowns();
    if unknowns < 2 || (loading.structure.is_linear() && !loading.contacts.iter().any(ContactPair::is_curved)) {
        return None;
    }
    // Each closed contact removes at least one motion, except where several contacts of a corner share a node.
    let closed = modes.iter().filter(|mode| mode.is_active()).count();
    if loading.corners.is_empty() && closed + 2 > unknowns {
        return None;
    }
    if !slips(loading, modes) {
        return Some((modes.to_vec(), start));
    }
    let held = |(mode, contact): (&Mode, &ContactPair)| {
        if mode.is_active() && contact.tangents() > 0 { Mode::Stick } else { *mode }
    };
    Some((modes.iter().zip(loading.contacts).map(held).collect(), state))
}

/// Negative eigenvalues of the counted tangent, by a sparse factorisation: `Some(None)` where they are not counted,
/// `None` where the count fails.
fn count_sparse(
    loading: Loading<'_>,
    modes: &[Mode],
    start: &State,
    state: &State,
    work: &mut Work,
) -> Option<Option<usize>> {
    let Some((modes, anchor)) = counted_modes(loading, modes, start, state) else { return Some(None) };
    let system = ModeSystem::new(loading, &modes, anchor);
    let unknowns = loading.structure.unknowns();
    if system.size() + 1 > 2 * unknowns {
        return Some(None);
    }
    let matrix = matrix::assemble_sparse(&system, &system.iterate(state.clone()), Kind::Rates)?;
    // Under loads that follow, and where bodies rub against each other, the signs of the pivots of a symmetric part would
    // say nothing; the sign of the determinant still does.
    if !matrix.is_symmetric() {
        return Some(None);
    }
    inertia_of_sparse(&system, &matrix, work).map(|inertia| Some(inertia.negative))
}

/// Negative eigenvalues of the tangent reduced to the motions that a mode without frictional slip allows, however few;
/// `None` where it is singular or the count fails.
pub fn negative_eigenvalues(
    loading: Loading<'_>,
    modes: &[Mode],
    start: &State,
    state: &State,
    work: &mut Work,
) -> Option<usize> {
    let system = ModeSystem::new(loading, modes, start);
    let counted = match matrix::assemble_sparse(&system, &system.iterate(state.clone()), Kind::Rates) {
        Some(matrix) => inertia_of_sparse(&system, &matrix, work),
        None => inertia(reduced_tangent(&system, loading, state)?, ZERO_PIVOT),
    };
    counted.filter(|counted| counted.zero == 0).map(|counted| counted.negative)
}

fn inertia_of_sparse(system: &ModeSystem<'_>, matrix: &Bordered, work: &mut Work) -> Option<Inertia> {
    work.factorisations += 1;
    held_inertia(matrix, mode_factorisation::holdings(system), ZERO_PIVOT)
}

fn reduced_tangent(system: &ModeSystem<'_>, loading: Loading<'_>, state: &State) -> Option<DMatrix<f64>> {
    let unknowns = loading.structure.unknowns();
    let constraints = system.size() - 1 - unknowns;
    let matrix = matrix::rate_matrix(system, state);
    let tangent = matrix.view((0, 0), (unknowns, unknowns));
    if loading.structure.has_following_loads() && (tangent - tangent.transpose()).amax() > ASYMMETRY * tangent.amax() {
        return None;
    }
    if constraints == 0 {
        return Some(tangent.into_owned());
    }
    let basis = null_space(&matrix.view((unknowns, 0), (constraints, unknowns)).into_owned(), RANK_TOLERANCE)?;
    if basis.ncols() == 0 {
        return Some(DMatrix::zeros(0, 0));
    }
    let basis = basis.qr().q();
    let reduced = basis.transpose() * (tangent * &basis);
    Some((&reduced + reduced.transpose()) * 0.5)
}

/// The modes of a step with every contact free that touches without reaction at both of its ends; `None` where there is
/// no such contact. Free or closed, the contact does not change the path, but a branch may leave the obstacle.
pub fn loosened(start: &StepStart<'_>, reached: &Reached) -> Option<Vec<Mode>> {
    let touches = |state: &State, contact: usize| {
        let force_scale = start.force_scale.max(reached.corrected.force_scale);
        let reaction = state.reactions[contact].size();
        let is_zero =
            reaction == 0.0 || start.loading.is_no_force(contact, state, reaction, CONTACT_TOLERANCE, force_scale);
        is_zero && start.loading.gap(contact, state) <= CONTACT_TOLERANCE
    };
    let grazes = |(contact, mode): (usize, &Mode)| {
        mode.is_active() && touches(start.state, contact) && touches(&reached.corrected.state, contact)
    };
    let modes = || start.modes.iter().enumerate();
    let loosened = |(contact, mode): (usize, &Mode)| if grazes((contact, mode)) { Mode::Free } else { *mode };
    modes().any(grazes).then(|| modes().map(loosened).collect())
}

impl Signature {
    /// The signature at a point where the sign of the bordered determinant is known; `None` where the reduced tangent
    /// is singular.
    pub fn with_determinant(
        loading: Loading<'_>,
        modes: &[Mode],
        start: &State,
        state: &State,
        sign: f64,
        work: &mut Work,
    ) -> Option<Self> {
        let negative = if loading.structure.layout().is_some() {
            if !loading.structure.allows_dense() {
                return None;
            }
            count_sparse(loading, modes, start, state, work)?
        } else {
            match counted_tangent(loading, modes, start, state) {
                Some(tangent) => Some(inertia(tangent, ZERO_PIVOT)?.negative),
                None => None,
            }
        };
        Some(Self { determinant: sign, negative })
    }

    /// The signature just past a point where `eigenvalues` eigenvalues cross, from the signature before it.
    pub fn past(self, change: SignatureChange, eigenvalues: usize) -> Option<Self> {
        let turns = if eigenvalues % 2 == 1 { -1.0 } else { 1.0 };
        let negative = match (change, self.negative) {
            (SignatureChange::Count { net, .. }, Some(negative)) => {
                let by = isize::try_from(eigenvalues).ok()?;
                Some(negative.checked_add_signed(if net > 0 { by } else { -by })?)
            }
            _ => None,
        };
        Some(Self { determinant: turns * self.determinant, negative })
    }

    /// The signature at the start of a step or, where the equations are singular there, a little past it. `serving`
    /// receives the factorisation at the start.
    pub fn past_start(
        start: &StepStart<'_>,
        step: f64,
        serving: &mut Option<SystemFactorisation>,
        work: &mut Work,
    ) -> Option<Self> {
        if !start.loading.structure.allows_dense() || start.is_singular {
            // Bifurcation points are not sought, or the path leaves one.
            return None;
        }
        Self::at(start.loading, start.modes, start.state, start.rate, serving, work).or_else(|| {
            let is_sparse = start.loading.structure.layout().is_some();
            let parts: &[f64] = if is_sparse { &FURTHER_ON_SPARSE } else { &FURTHER_ON };
            parts.iter().find_map(|part| {
                let near = start.reach(part * step, work).ok()?;
                let sign = near.determinant?;
                Self::with_determinant(start.loading, start.modes, start.state, &near.corrected.state, sign, work)
            })
        })
    }

    /// The signature at a point from which a step is to start; `None` where the equations are singular.
    pub fn at(
        loading: Loading<'_>,
        modes: &[Mode],
        state: &State,
        rate: &Rate,
        serving: &mut Option<SystemFactorisation>,
        work: &mut Work,
    ) -> Option<Self> {
        let system = ModeSystem::new(loading, modes, state);
        if !loading.structure.allows_dense() {
            return None;
        }
        work.factorisations += 1;
        if loading.structure.layout().is_some() {
            let iterate = system.iterate(state.clone());
            let bordered = mode_factorisation::factorise_bordered(&system, &iterate, rate)?;
            if bordered.pivot_ratio() <= UNCERTAIN_PIVOT_RATIO {
                return None;
            }
            let sign = bordered.determinant_sign();
            *serving = tangent::may_serve(&system, bordered);
            return Self::with_determinant(loading, modes, state, state, sign, work);
        }
        let determinant = bordered_determinant(&system, loading, state, rate)?;
        if determinant.pivot_ratio <= UNCERTAIN_PIVOT_RATIO {
            return None;
        }
        Self::with_determinant(loading, modes, state, state, determinant.sign, work)
    }
}

/// The determinant of the scaled equations, bordered by a direction.
pub fn bordered_determinant(
    system: &ModeSystem<'_>,
    loading: Loading<'_>,
    state: &State,
    rate: &Rate,
) -> Option<Determinant> {
    let (matrix, _) = scaled_rows(system, loading, state);
    let mut matrix = matrix.insert_row(system.size() - 1, 0.0);
    matrix::border(system, &mut matrix, rate);
    determinant(matrix)
}

/// The sign of the bordered determinant at the end of a step, where it is certain. Next to stiff elements the pivots of
/// a factorisation of the assembled equations leave it undecided; rows scaled by their sizes decide it, as at the
/// start. Otherwise each step would begin with a signature and end without one, as if it passed a singular point, and
/// would be shortened.
pub fn sign_at_end(start: &StepStart<'_>, reached: &Reached, work: &mut Work) -> Option<f64> {
    reached.determinant.or_else(|| {
        let (loading, state) = (start.loading, &reached.corrected.state);
        if loading.structure.layout().is_some() {
            return None;
        }
        work.factorisations += 1;
        let system = ModeSystem::new(loading, &reached.corrected.modes, state);
        let determinant = bordered_determinant(&system, loading, state, &reached.rate)?;
        (determinant.pivot_ratio > UNCERTAIN_PIVOT_RATIO).then_some(determinant.sign)
    })
}

/// The signature at the end of a step, and how it changed.
pub fn compare(
    start: &StepStart<'_>,
    before: Signature,
    reached: &Reached,
    work: &mut Work,
) -> (Option<Signature>, SignatureChange) {
    let Some(sign) = sign_at_end(start, reached, work) else { return (None, SignatureChange::None) };
    let state = &reached.corrected.state;
    let Some(mut after) = Signature::with_determinant(start.loading, start.modes, start.state, state, sign, work)
    else {
        return (None, SignatureChange::None);
    };
    let odd = sign != before.determinant;
    let (Some(first), Some(last)) = (before.negative, after.negative) else {
        return (Some(after), if odd { SignatureChange::Odd } else { SignatureChange::None });
    };
    let mut net = last as isize - first as isize;
    if slips(start.loading, start.modes) {
        // The count is that of the structure with these contacts stuck. It detects two eigenvalues at once; where an
        // odd number crosses, the determinant locates the crossing.
        let change = match (odd, net) {
            (true, _) => SignatureChange::Odd,
            (false, 0) => SignatureChange::None,
            (false, _) if net % 2 == 0 => SignatureChange::Count { before: first, net },
            (false, _) => SignatureChange::None,
        };
        return (Some(after), change);
    }
    if let Some(EventFunction::LoadRate { sign }) = reached.event {
        // K u̇ = ṡ f: the eigenvalue that vanishes at the limit point changes sign with the load, times the sign of
        // f·u̇.
        let system = ModeSystem::new(start.loading, start.modes, start.state);
        let structure = start.loading.structure;
        let motion = |unknown: usize| reached.rate.displacement[structure.freedom_of[unknown]];
        let work: f64 = match matrix::assemble_sparse(&system, &system.iterate(state.clone()), Kind::Rates) {
            Some(matrix) => matrix.right_column(0).iter().map(|(unknown, value)| -value * motion(*unknown)).sum(),
            None => {
                let matrix = matrix::rate_matrix(&system, state);
                let column = matrix.column(structure.unknowns());
                (0..structure.unknowns()).map(|unknown| -column[unknown] * motion(unknown)).sum()
            }
        };
        let own = if sign * work > 0.0 { 1 } else { -1 };
        // The sign of the eigenvalue at the limit point itself is arbitrary.
        if (net % 2 != 0) != odd {
            net -= own;
        }
        after.negative = first.checked_add_signed(net + own);
    }
    let change = match (net, (net % 2 != 0) == odd) {
        (0, true) => SignatureChange::None,
        (_, true) => SignatureChange::Count { before: first, net },
        // A count at the margin of a limit point; the bordered determinant is regular there.
        (_, false) if odd => SignatureChange::Odd,
        (_, false) => SignatureChange::None,
    };
    (Some(after), change)
}
