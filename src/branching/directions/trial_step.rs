//! Trial steps: a small step decides whether a direction that holds only at first order exists, and under which modes.
//!
//! Where inequalities hold with equality, several modes are compatible with one direction, and the direction exists if
//! it holds under some of them over a short arc length. With many such contacts (velocities that decay along a chain,
//! many contacts that touch without force) the combinations are too many to try. As in an active-set method, the modes
//! that a step violates are changed and the step is repeated. Only where this does not succeed are combinations tried
//! in turn, up to a bound on their number.

use crate::branching::directions::candidate::CandidateDirection;
use crate::branching::directions::feasible_direction::sign_of;
use crate::branching::directions::tolerances::{
    CLEAR_SLOPE, FIRST_ORDER_TOLERANCE, FORCE_RATE_ROUNDING, LOAD_RATE_ROUNDING, RELATIVE_SPEED_ROUNDING,
    ROUNDINGS_PER_ENTRY, SPEED_ROUNDING, STEADY_RATE_CHANGE, TRIAL_VIOLATION,
};
use crate::complementarity::rates::cartesian_product;
use crate::mechanics::contact::Mode;
use crate::mechanics::contact::vector::size as size_of;
use crate::mechanics::equations::closing_equation::ArcLengthEquation;
use crate::mechanics::equations::corrected_point::Corrected;
use crate::mechanics::equations::scaled_rows::scaled_rows;
use crate::mechanics::equations::{ModeSystem, matrix, rate_recovery};
use crate::mechanics::problem::loading::Loading;
use crate::mechanics::problem::state::{Rate, State};
use crate::mechanics::problem::tolerances::CONTACT_TOLERANCE;
use crate::resources::budget::{self, Taken};
use crate::step::corrector::cost_counters::Work;
use crate::step::corrector::newton;
use crate::step::corrector::tangent;
use crate::step::event_functions::{self, EventFunction};
use crate::step::mode_step::may_turn;
use nalgebra::DVector;
use std::collections::BTreeSet;

/// Arc lengths of the trial steps for a direction of first order, tried one after another until the outcome is clear.
const TRIAL_STEPS: [f64; 4] = [1e-6, 1e-5, 1e-4, 1e-3];
/// Largest number of combinations that are tried in turn.
const MOST_COMBINATIONS: u64 = 64;

/// Outcome of a small step along a direction that holds only at first order.
enum TrialVerdict {
    Holds(f64),
    /// With the contacts responsible, if contacts are.
    Fails(Vec<usize>),
    /// The quantities in doubt are zero to second order, too.
    Unclear(f64),
}

/// The modes under which a small step along the direction is feasible, and the load rate after that step.
pub(crate) fn confirm(
    loading: Loading<'_>,
    state: &State,
    candidate: &CandidateDirection,
    force_scale: f64,
) -> Option<(Vec<Mode>, f64)> {
    confirm_by(loading, state, candidate, force_scale, &TRIAL_STEPS)
}

/// The same by steps of other lengths.
pub(crate) fn confirm_by(
    loading: Loading<'_>,
    state: &State,
    candidate: &CandidateDirection,
    force_scale: f64,
    steps: &[f64],
) -> Option<(Vec<Mode>, f64)> {
    let trial = Trial { loading, state, candidate, force_scale, steps };
    let (mut tried, mut held) = (BTreeSet::new(), Taken::default());
    let mut places = vec![0; candidate.alternatives.len()];
    // Every contact in doubt may be changed a few times before the search gives up.
    let most = candidate.alternatives.iter().map(|alternatives| 2 * (alternatives.len() - 1)).sum::<usize>() + 1;
    for _ in 0..most {
        held.add::<usize>(places.len());
        if !tried.insert(places.clone()) {
            break;
        }
        let culprits = match trial.judge(&places) {
            Ok(confirmed) => return Some(confirmed),
            Err(culprits) => culprits,
        };
        let mut changed = false;
        for (place, alternatives) in places.iter_mut().zip(&candidate.alternatives) {
            let is_culprit = |(contact, _): &(usize, Mode)| culprits.contains(contact);
            if alternatives.len() > 1 && alternatives[*place].iter().any(is_culprit) {
                *place = (*place + 1) % alternatives.len();
                changed = true;
            }
        }
        if !changed {
            break;
        }
    }
    let mut combinations = in_order(candidate);
    combinations.retain(|places| !tried.contains(places));
    combinations.iter().find_map(|places| trial.judge(places).ok())
}

/// The sign of a load rate that is zero at first order, exactly or nearly.
pub(crate) struct LaterSign {
    /// Sign of the load rate; 0 where it has none.
    pub sign: f64,
    /// The sign is that of the load rate itself, which is small and constant along the path: close to critical friction
    /// the load falls or rises very slowly.
    pub is_steady: bool,
}

/// The sign of the load rate after the shortest trial step along a direction in its modes after which it has a sign.
pub(crate) fn later_sign(
    loading: Loading<'_>,
    state: &State,
    rate: &Rate,
    modes: &[Mode],
    force_scale: f64,
) -> LaterSign {
    let is_more_than_rounding = || {
        let rounding = rounding_of_load_rate(loading, state, rate, modes).unwrap_or(f64::INFINITY);
        rate.load.abs() > rounding.min(LOAD_RATE_ROUNDING)
    };
    let mut is_steady = rate.load.abs() > LOAD_RATE_ROUNDING || rate.load != 0.0 && is_more_than_rounding();
    for step in TRIAL_STEPS {
        let Some((_, after)) = stepped(loading, state, rate, modes, step, force_scale) else {
            is_steady = false;
            continue;
        };
        if sign_of(after.load) != 0.0 {
            return LaterSign { sign: sign_of(after.load), is_steady: false };
        }
        is_steady &= (after.load - rate.load).abs() <= STEADY_RATE_CHANGE * rate.load.abs();
    }
    LaterSign { sign: if is_steady { rate.load.signum() } else { 0.0 }, is_steady }
}

/// Bound of the round-off in the load rate of a direction, for few equations: errors `δA` of the entries contribute
/// `-wᵀ δA x`, with `A x` the last unit vector and `Aᵀ w` that of the load (N. J. Higham, *Accuracy and Stability of
/// Numerical Algorithms*, SIAM 2002, section 7.2). The rows of `A` are scaled by their sizes, so that `|δA|` is at most
/// the unit round-off.
fn rounding_of_load_rate(loading: Loading<'_>, state: &State, rate: &Rate, modes: &[Mode]) -> Option<f64> {
    if loading.structure.layout().is_some() {
        return None;
    }
    let system = ModeSystem::new(loading, modes, state);
    let (rows, _) = scaled_rows(&system, loading, state);
    let mut matrix = rows.insert_row(system.size() - 1, 0.0);
    matrix::border(&system, &mut matrix, rate);
    let (size, load) = (matrix.nrows(), loading.structure.unknowns());
    let unit = |place: usize| DVector::from_fn(size, |row, _| f64::from(u8::from(row == place)));
    let along = matrix.clone().lu().solve(&unit(size - 1))?;
    let weights = matrix.transpose().lu().solve(&unit(load))?;
    let rounding = ROUNDINGS_PER_ENTRY * f64::EPSILON * weights.lp_norm(1) * along.lp_norm(1);
    rounding.is_finite().then_some(rounding)
}

/// The point reached by a small step along a direction in these modes, with the direction there.
pub(crate) fn stepped(
    loading: Loading<'_>,
    state: &State,
    rate: &Rate,
    modes: &[Mode],
    step: f64,
    force_scale: f64,
) -> Option<(Corrected, Rate)> {
    let system = ModeSystem::new(loading, modes, state).along(rate);
    let closing = ArcLengthEquation { from: state, step };
    let mut serving = None;
    let guess = system.iterate(state.advanced(rate, step));
    let corrected =
        newton::correct_from(&system, guess, &closing, force_scale, &mut serving, &mut Work::default()).ok()?;
    let distance = state.distance(&corrected.state);
    may_turn(state.cosine_of_chord(&corrected.state, distance, rate)).ok()?;
    let rate = match serving {
        Some(_) => tangent::tangent_and_error(&system, &corrected, rate, &mut serving, &mut 0)?.rate,
        None => rate_recovery::tangent(&system, &corrected, rate)?,
    };
    Some((corrected, rate))
}

/// The first combinations of alternatives, those with more sticking contacts first.
fn in_order(candidate: &CandidateDirection) -> Vec<Vec<usize>> {
    let places: Vec<Vec<usize>> =
        candidate.alternatives.iter().map(|alternatives| (0..alternatives.len()).collect()).collect();
    let mut all: Vec<Vec<usize>> = cartesian_product::combinations(&places, MOST_COMBINATIONS).collect();
    let sliding = |places: &Vec<usize>| {
        let modes = places.iter().zip(&candidate.alternatives).flat_map(|(&place, all)| &all[place]);
        modes.filter(|(_, mode)| *mode != Mode::Stick).count()
    };
    all.sort_by_key(sliding);
    all
}

struct Trial<'a> {
    loading: Loading<'a>,
    state: &'a State,
    candidate: &'a CandidateDirection,
    force_scale: f64,
    /// Arc lengths, tried one after another until the outcome is clear.
    steps: &'a [f64],
}

impl Trial<'_> {
    /// The modes of a combination and the load rate after a small step, or the contacts responsible for its failure.
    fn judge(&self, places: &[usize]) -> Result<(Vec<Mode>, f64), Vec<usize>> {
        budget::spend(self.loading.structure.freedoms());
        let mut modes = self.candidate.modes.clone();
        for (&place, alternatives) in places.iter().zip(&self.candidate.alternatives) {
            alternatives[place].iter().for_each(|(contact, mode)| modes[*contact] = *mode);
        }
        let mut later_load = 0.0;
        for step in self.steps {
            match self.step(&modes, *step) {
                TrialVerdict::Holds(load) => return Ok((modes, load)),
                TrialVerdict::Fails(culprits) => return Err(culprits),
                TrialVerdict::Unclear(load) => later_load = load,
            }
        }
        Ok((modes, later_load))
    }

    /// Whether more than one mode of a contact is compatible with the direction.
    fn is_in_doubt(&self, contact: usize) -> bool {
        let mut in_doubt = self.candidate.alternatives.iter().filter(|alternatives| alternatives.len() > 1);
        in_doubt.any(|alternatives| alternatives.iter().flatten().any(|(one, _)| *one == contact))
    }

    /// Checks only quantities that are zero at first order: any other end of the mode within the step is a later event.
    /// The step is short, so that such events usually lie beyond it: where many contacts change close together, a long
    /// step would assess a motion that does not occur.
    fn step(&self, modes: &[Mode], step: f64) -> TrialVerdict {
        let Self { loading, state, candidate, force_scale, .. } = *self;
        let nobody = || TrialVerdict::Fails(Vec::new());
        let Some((corrected, rate)) = stepped(loading, state, &candidate.rate, modes, step, force_scale) else {
            return nobody();
        };
        let forces = force_scale.max(corrected.force_scale);
        let rates = candidate.rate.largest_reaction().max(rate.largest_reaction()).max(f64::MIN_POSITIVE);
        let mut unclear = false;
        let mut culprits = Vec::new();
        for event_function in event_functions::of_mode(loading, modes, state, &candidate.rate) {
            let first = event_function.value(loading, modes, state, &candidate.rate);
            let tendency = event_function.slope(loading, modes, state, &candidate.rate);
            let most = if event_function.is_of_forces() { rates } else { 1.0 };
            // What the standings hold settled is above zero by more than their tolerance: its end is a later event.
            let contacts = contacts_of(loading, event_function);
            let is_settled = !contacts.is_empty() && !contacts.iter().any(|contact| self.is_in_doubt(*contact));
            let zero = if is_settled { CONTACT_TOLERANCE } else { FIRST_ORDER_TOLERANCE };
            if tendency.is_some_and(|slope| slope > FIRST_ORDER_TOLERANCE * most)
                || event_function.is_above_zero(loading, state, first, zero, forces)
            {
                continue;
            }
            let scale = event_function.scale(loading, &corrected.state, forces);
            let size = if tendency.is_some() && event_function.is_of_forces() { rates * (scale / forces) } else { 1.0 };
            if tendency.is_some_and(|slope| slope > FIRST_ORDER_TOLERANCE * size) {
                continue;
            }
            let last = event_function.value(loading, modes, &corrected.state, &rate) / scale;
            let grown =
                event_function.slope(loading, modes, &corrected.state, &rate).map_or(last, |slope| slope / size);
            let clear = match event_function {
                // A node on a stiff spring moves slowly, but its direction is just as clear.
                EventFunction::Gap(contact) | EventFunction::Sliding(contact) => {
                    SPEED_ROUNDING
                        + RELATIVE_SPEED_ROUNDING * size_of(&loading.relative_rate(contact, &corrected.state, &rate))
                }
                // Relative to the contact's own forces: along a chain close to jamming they decrease by orders of
                // magnitude between nodes.
                EventFunction::Normal(contact) | EventFunction::Cone { contact, .. } => {
                    let own = candidate.rate.reactions[contact].size().max(rate.reactions[contact].size());
                    (CLEAR_SLOPE * own / size).max(FORCE_RATE_ROUNDING)
                }
                EventFunction::Facet { .. }
                | EventFunction::Slide { .. }
                | EventFunction::Hold { .. }
                | EventFunction::Return { .. } => CLEAR_SLOPE,
                EventFunction::LoadRate { .. } | EventFunction::SurfaceEnd(_) | EventFunction::End(_) => CLEAR_SLOPE,
            };
            // What is below zero at the start already, within the tolerance of a point, is no fault of the direction, nor is
            // what rounding leaves in the forces of stiff elements.
            let begun = if tendency.is_some() { (first / scale).min(0.0) } else { 0.0 };
            let permitted = TRIAL_VIOLATION.max(event_function.zero(loading, &corrected.state, forces) / scale);
            if last < begun - permitted || grown < -clear {
                culprits.extend(contacts);
            }
            unclear |= grown <= clear;
        }
        if !culprits.is_empty() {
            TrialVerdict::Fails(culprits)
        } else if unclear {
            TrialVerdict::Unclear(rate.load)
        } else {
            TrialVerdict::Holds(rate.load)
        }
    }
}

/// The contacts to which a watched quantity belongs.
fn contacts_of(loading: Loading<'_>, event_function: EventFunction) -> Vec<usize> {
    match event_function {
        EventFunction::Gap(contact)
        | EventFunction::Normal(contact)
        | EventFunction::Cone { contact, .. }
        | EventFunction::Sliding(contact) => {
            vec![contact]
        }
        EventFunction::Facet { corner, .. }
        | EventFunction::Slide { corner }
        | EventFunction::Hold { corner }
        | EventFunction::Return { corner } => loading.corners[corner].contacts.clone(),
        EventFunction::LoadRate { .. } | EventFunction::SurfaceEnd(_) | EventFunction::End(_) => Vec::new(),
    }
}
