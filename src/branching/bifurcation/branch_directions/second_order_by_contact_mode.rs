//! Directions determined at second order, separately for each combination of contact modes.
//!
//! First order may not suffice to determine the directions that continue the path. With a direction `q` of the
//! equations `F(x) = 0` of a mode and the path `x = x₀ + q t + ½ q₂ t²`,
//!
//! ```text
//! F_x q = 0,      F_x q₂ = -F''(q, q),      q·q₂ = 0.
//! ```
//!
//! An inequality that `q` leaves at equality holds if `q₂` makes it positive, and fails if `q₂` makes it negative. A
//! step along the direction would give the same answer if it were short compared with the radius of curvature of the
//! path. Near a fold of a part attached to a sliding node the path bends so sharply that no step is short enough.
//!
//! At the fold itself the equations of the mode in which the node sticks have two null vectors, and close to the fold
//! they nearly do; where several uncoupled parts are at their folds the equations have more: see `null_plane_at_fold`.
//!
//! Used where the path would otherwise end: it takes a few factorisations for every combination of modes.

use crate::branching::bifurcation::branch_directions::null_plane_at_fold;
use crate::branching::bifurcation::branch_directions::null_plane_at_fold::{Fold, Plane};
use crate::branching::bifurcation::branch_directions::tolerances::{
    COINCIDENCE_COSINE, FIRST_ORDER_TOLERANCE, LOCATION_ERROR, RATE_CHANGE_TOLERANCE, SMALLEST_CURVATURE_RADIUS,
};
use crate::branching::bifurcation::branch_directions::{
    BranchingPoint, CachedFactorisation, MOST_MODES, Null, RADII, SingularPoint,
};
use crate::branching::directions::candidate::{CandidateDirection, is_mechanism};
use crate::branching::directions::feasible_direction::DirectionChoice;
use crate::branching::directions::trial_step::confirm_by;
use crate::complementarity::rates::cartesian_product::{combinations, count};
use crate::mechanics::contact::Mode;
use crate::mechanics::contact::vector::scaled;
use crate::mechanics::equations::{ModeSystem, mode_factorisation, null_motion_suppression, rate_recovery};
use crate::mechanics::multi_contact::changeable_contacts::Standing;
use crate::mechanics::problem::state::{Rate, State};
use crate::mechanics::problem::tolerances::CONTACT_TOLERANCE;
use crate::step::event_functions::{self, EventFunction};

/// The directions at a point that satisfy the inequalities at second order.
pub struct SecondOrderFindings {
    pub options: Vec<DirectionChoice>,
    /// Some mode has a continuum of directions even at second order, or neither second order nor a trial step decides
    /// on some direction.
    pub unclear: bool,
}

/// A direction of a mode.
struct ModeDirection {
    null: Null,
    /// `q₂`, where the direction is the only one of its mode.
    bend: Option<Rate>,
    /// The equations of the mode have more than one null vector, exactly or nearly.
    is_singular: bool,
    /// See [`DirectionChoice`].
    beside: Option<Rate>,
}

/// The outcome of testing the inequalities along a direction.
enum DirectionVerdict {
    Holds,
    Fails,
    Unclear,
}

/// Every direction of every mode of the contacts that can change; `None` where the modes are too many or of a kind for
/// which second order is not available (slip in a plane, corners, and motions that no element resists).
pub fn in_each_mode(here: SingularPoint<'_>) -> Option<SecondOrderFindings> {
    let options = modes_of_each(here)?;
    if count(&options) > MOST_MODES || !here.loading.structure.allows_dense() {
        return None;
    }
    let mut told = SecondOrderFindings { options: Vec::new(), unclear: false };
    for modes in combinations(&options, MOST_MODES) {
        let system = ModeSystem::new(here.loading, &modes, here.state);
        if system.has_tracks() {
            return None;
        }
        let point = BranchingPoint { here, modes: &modes, system, eigenvalues: None, nulls: None };
        for way in ways(&point, &mut told.unclear)? {
            if is_mechanism(here.loading, here.state, &way.null.rate) {
                return None;
            }
            tell(&point, way, &mut told);
        }
    }
    Some(told)
}

/// The modes that each contact admits.
fn modes_of_each(here: SingularPoint<'_>) -> Option<Vec<Vec<Mode>>> {
    let of_contact = |(contact, standing): (usize, &Standing)| {
        let tangents = here.loading.contacts[contact].tangents();
        match standing {
            Standing::Settled(mode) => Some(vec![*mode]),
            Standing::OnCone { direction } => Some(vec![Mode::Stick, Mode::Slip { direction: *direction }]),
            Standing::Touching if tangents == 0 => Some(vec![Mode::Slip { direction: [0.0; 3] }, Mode::Free]),
            Standing::Touching if tangents == 1 => {
                let tangent = here.loading.frame(contact, here.state).tangents[0];
                let [on, back] = [1.0, -1.0].map(|sense| Mode::Slip { direction: scaled(&tangent, sense) });
                Some(vec![Mode::Stick, on, back, Mode::Free])
            }
            Standing::Touching | Standing::Cornered { .. } => None,
        }
    };
    here.standings.iter().enumerate().map(of_contact).collect()
}

/// The directions of the mode, each in both senses; `None` where a direction has no motion, and where three or more
/// null vectors do not belong to uncoupled parts.
fn ways(point: &BranchingPoint<'_>, unclear: &mut bool) -> Option<Vec<ModeDirection>> {
    let nulls = null_plane_at_fold::orthonormal_nulls(point)?;
    match &nulls[..] {
        [only] => {
            let bend = bend(point, only);
            let is_sharp = bend.as_ref().is_some_and(|bend| bend.size() > 1.0 / SMALLEST_CURVATURE_RADIUS);
            let both = both(point, only, bend, false);
            match if is_sharp { null_plane_at_fold::plane(point)? } else { Plane::Continuum } {
                Plane::Fold(fold) => Some(past_bend(point, &fold, both)),
                Plane::Continuum | Plane::Roots(_) => Some(both.into()),
            }
        }
        [_, _] => Some(match null_plane_at_fold::plane(point)? {
            Plane::Continuum => {
                *unclear = true;
                Vec::new()
            }
            Plane::Roots(roots) => roots.iter().flat_map(|root| both(point, root, None, true)).collect(),
            Plane::Fold(fold) => leaving(point, &fold),
        }),
        [] => None,
        several => null_plane_at_fold::fold_of_parts(point, several.len()).map(|fold| leaving(point, &fold)),
    }
}

/// The directions that leave a fold.
fn leaving(point: &BranchingPoint<'_>, fold: &Fold) -> Vec<ModeDirection> {
    if fold.is_straight() {
        return both(point, &fold.flat, bend_at_fold(point, &fold.flat), true).into();
    }
    let Some(ahead) = fold.ahead(point) else { return Vec::new() };
    fold.arms().into_iter().map(|arm| along_arm(&ahead, arm)).collect()
}

fn both(point: &BranchingPoint<'_>, null: &Null, bend: Option<Rate>, is_singular: bool) -> [ModeDirection; 2] {
    // The bend is the same in both senses.
    [1.0, -1.0].map(|sense| ModeDirection {
        null: point.combined(std::slice::from_ref(null), &[sense]),
        bend: bend.clone(),
        is_singular,
        beside: None,
    })
}

fn along_arm(ahead: &Null, beside: Rate) -> ModeDirection {
    ModeDirection { null: ahead.clone(), bend: None, is_singular: true, beside: Some(beside) }
}

/// The feasible directions of a path that bends sharply, each continued past the bend.
fn past_bend(point: &BranchingPoint<'_>, fold: &Fold, ways: [ModeDirection; 2]) -> Vec<ModeDirection> {
    if fold.is_straight() {
        return leaving(point, fold);
    }
    let holding = ways.into_iter().filter(|way| !matches!(verdict(point, way), DirectionVerdict::Fails));
    let past = |way: ModeDirection| Some(along_arm(&fold.ahead(point)?, fold.beside(&way.null.rate)?));
    holding.filter_map(past).collect()
}

/// `q₂`
fn bend(point: &BranchingPoint<'_>, null: &Null) -> Option<Rate> {
    bend_by(point, &point.system, null)
}

/// `q₂` of the line along a fold: the part at its fold stays there and the rest of the structure bends the path.
fn bend_at_fold(point: &BranchingPoint<'_>, flat: &Null) -> Option<Rate> {
    let SingularPoint { loading, state, .. } = point.here;
    let mut system = ModeSystem::new(loading, point.modes, state);
    let bend = if null_motion_suppression::suppress_open_motions(&mut system, state, &flat.rate) {
        bend_by(point, &system, flat)
    } else {
        None
    };
    bend.filter(|bend| bend.size() > RATE_CHANGE_TOLERANCE)
}

fn bend_by(point: &BranchingPoint<'_>, system: &ModeSystem<'_>, null: &Null) -> Option<Rate> {
    let factorisation =
        mode_factorisation::factorise_bordered(system, &system.iterate(point.here.state.clone()), &null.rate)?;
    let curved = point.second_derivative(&null.rate).times(&null.values);
    let mut values = -curved.insert_row(system.size() - 1, 0.0);
    factorisation.solve(&mut values).then(|| rate_recovery::rate_from(system, point.here.state, &values))
}

/// Adds a direction that holds and is not in the list yet.
fn tell(point: &BranchingPoint<'_>, way: ModeDirection, told: &mut SecondOrderFindings) {
    let SingularPoint { loading, state, force_scale, .. } = point.here;
    let rate = &way.null.rate;
    let forces = rate.largest_reaction().max(f64::MIN_POSITIVE);
    let is_known = |known: &DirectionChoice| {
        let mut pairs = known.rate.reactions.iter().zip(&rate.reactions);
        known.rate.product(rate) > COINCIDENCE_COSINE
            && known.beside == way.beside
            && pairs.all(|(one, other)| one.difference(other) <= FIRST_ORDER_TOLERANCE * forces)
    };
    let later = way.bend.as_ref().map_or(0.0, |bend| bend.load / bend.size().max(f64::MIN_POSITIVE));
    let confirmed = match verdict(point, &way) {
        DirectionVerdict::Fails => return,
        _ if told.options.iter().any(is_known) => return,
        DirectionVerdict::Holds => Some((point.modes.to_vec(), later)),
        DirectionVerdict::Unclear => {
            let candidate = CandidateDirection {
                rate: rate.clone(),
                forces: Vec::new(),
                modes: point.modes.to_vec(),
                alternatives: Vec::new(),
                weak: true,
                dissipation: 0.0,
                cached: CachedFactorisation::default(),
            };
            let tried = |radius: &f64| confirm_by(loading, state, &candidate, force_scale, &[*radius]);
            RADII.iter().find_map(tried)
        }
    };
    let Some((modes, later)) = confirmed else {
        told.unclear = true;
        return;
    };
    let choice = point.choice(way.null.rate, modes, Some(later), false);
    told.options.push(DirectionChoice { is_singular: way.is_singular, beside: way.beside, ..choice });
}

/// Whether the inequalities of the mode hold along a direction.
fn verdict(point: &BranchingPoint<'_>, way: &ModeDirection) -> DirectionVerdict {
    let SingularPoint { loading, state, force_scale, .. } = point.here;
    let rate = &way.null.rate;
    let bent = way.bend.as_ref().map(|bend| Bent::new(point, rate, bend));
    let mut verdict = DirectionVerdict::Holds;
    for event_function in event_functions::of_mode(loading, point.modes, state, rate) {
        let value = event_function.value(loading, point.modes, state, rate);
        let slope = event_function.slope(loading, point.modes, state, rate);
        if slope.is_some() && event_function.is_above_zero(loading, state, value, CONTACT_TOLERANCE, force_scale) {
            continue;
        }
        let size = if event_function.is_of_forces() { rate.largest_reaction().max(f64::MIN_POSITIVE) } else { 1.0 };
        let first = slope.unwrap_or(value) / size;
        let second = bent.as_ref().map(|bent| bent.change(point, event_function) / size);
        let doubt = FIRST_ORDER_TOLERANCE + second.map_or(0.0, |second| LOCATION_ERROR * second.abs());
        let rising = if first.abs() > doubt { first } else { second.unwrap_or(0.0) };
        if rising < 0.0 {
            return DirectionVerdict::Fails;
        }
        if rising == 0.0 {
            verdict = DirectionVerdict::Unclear;
        }
    }
    verdict
}

/// The path at a short arc length along a direction, to second order.
struct Bent {
    way: f64,
    state: State,
    rate: Rate,
    before: Rate,
    /// The largest change of a rate; `motion` for displacements, `force` for reactions.
    motion: f64,
    force: f64,
}

impl Bent {
    /// Arc length at which terms of second order are evaluated, relative to the path's radius of curvature.
    const WAY: f64 = 1e-4;

    fn new(point: &BranchingPoint<'_>, rate: &Rate, bend: &Rate) -> Self {
        let way = Self::WAY / bend.size().max(1.0);
        let mut ahead = rate.clone();
        ahead.add(bend, way);
        let mut middle = rate.clone();
        middle.add(bend, 0.5 * way);
        Self {
            way,
            state: point.here.state.advanced(&middle, way),
            rate: ahead,
            before: rate.clone(),
            motion: bend.size(),
            force: bend.largest_reaction(),
        }
    }

    /// The derivative with respect to arc length of a watched quantity's slope, or of its value where it has no slope;
    /// 0 where it is round-off.
    fn change(&self, point: &BranchingPoint<'_>, event_function: EventFunction) -> f64 {
        let SingularPoint { loading, state, .. } = point.here;
        let at = |state, rate| {
            let slope = event_function.slope(loading, point.modes, state, rate);
            slope.unwrap_or_else(|| event_function.value(loading, point.modes, state, rate))
        };
        let change = (at(&self.state, &self.rate) - at(state, &self.before)) / self.way;
        let largest = if event_function.is_of_forces() { self.force } else { self.motion };
        if change.abs() <= RATE_CHANGE_TOLERANCE * largest { 0.0 } else { change }
    }
}
