//! Whether a direction that holds only at first order is one, and under which modes: a small step tells.
//!
//! Where inequalities hold with equality, several modes fit one direction, and it is one if it holds under some of them
//! for a short way. With many such contacts (velocities that die away along a chain, many contacts that touch without
//! force) their combinations are too many to try: what a step finds violated is changed, and the step tried again, as in
//! an active set method. Only where that leads nowhere are combinations tried in turn, as many as there are up to a
//! bound.

use crate::branching::directions::candidate::CandidateDirection;
use crate::branching::directions::choice::sign_of;
use crate::complementarity::rates::combinations;
use crate::mechanics::contact::Mode;
use crate::mechanics::contact::vector::size as size_of;
use crate::mechanics::equations::ModeSystem;
use crate::mechanics::equations::closing_equation::ArcLengthEquation;
use crate::mechanics::equations::scaled_rows::scaled_rows;
use crate::mechanics::equations::solution::Corrected;
use crate::mechanics::problem::loading::Loading;
use crate::mechanics::problem::state::{Rate, State};
use crate::resources::budget::{self, Taken};
use crate::step::corrector::cost_counters::Work;
use crate::step::corrector::newton;
use crate::step::corrector::tangent;
use crate::step::event_functions::{self, Watch};
use crate::step::segment::may_turn;
use nalgebra::DVector;
use std::collections::BTreeSet;

/// Arc lengths of the steps by which a direction of first order is tried, one after another until it is clear.
const TRIAL_STEPS: [f64; 4] = [1e-6, 1e-5, 1e-4, 1e-3];
/// Quantities and slopes below this are zero at first order.
const IN_DOUBT: f64 = 1e-8;
/// Slopes of forces beyond this after a trial step have a sign, relative to the contact's own forces ...
const CLEAR: f64 = 1e-9;
/// ... but no less than their round-off relative to the largest.
const CLEAR_OF_ROUND_OFF: f64 = 5e-14;
/// The same of velocities, against the node's own: what is less leaves a gap within round-off over the whole path.
const CLEAR_OF_SPEED: f64 = 1e-13;
/// Round-off of a velocity (of unit arc length).
const STILL: f64 = 1e-14;
/// Load rates (of unit arc length) up to this are rounding where nothing else is known of it.
const NO_LOAD_RATE: f64 = 1e-12;
/// Roundings in each entry of the equations, and of their solution, for one number.
const ROUNDINGS: f64 = 8.0;
/// Load rates that differ by no more than this part of themselves are alike.
const ALIKE: f64 = 0.5;
/// How far a watched quantity may be negative after a trial step (second order in the step where it is real).
const TRIAL_TOLERANCE: f64 = 1e-11;
/// Combinations that are tried in turn.
const MOST_COMBINATIONS: u64 = 64;

/// What a small step says of a direction that holds only at first order.
enum TrialVerdict {
    Holds(f64),
    /// With the contacts that are to blame, if it is they.
    Fails(Vec<usize>),
    /// What is in doubt stays zero to second order, too.
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
    // Every contact in doubt may be changed a few times before it is given up.
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

/// The sign of a load rate that is zero at first order, or as good as that.
pub(crate) struct LaterSign {
    /// 0 where there is none.
    pub sign: f64,
    /// It is that of the load rate itself, which is small and the same all along: close to critical friction the load falls
    /// or rises ever so slowly.
    pub is_steady: bool,
}

/// The sign of the load rate after the shortest step along a direction in its modes after which it has one.
pub(crate) fn later_sign(
    loading: Loading<'_>,
    state: &State,
    rate: &Rate,
    modes: &[Mode],
    force_scale: f64,
) -> LaterSign {
    let is_more_than_rounding = || {
        let rounding = rounding_of_load_rate(loading, state, rate, modes).unwrap_or(f64::INFINITY);
        rate.load.abs() > rounding.min(NO_LOAD_RATE)
    };
    let mut is_steady = rate.load.abs() > NO_LOAD_RATE || rate.load != 0.0 && is_more_than_rounding();
    for step in TRIAL_STEPS {
        let Some((_, after)) = stepped(loading, state, rate, modes, step, force_scale) else {
            is_steady = false;
            continue;
        };
        if sign_of(after.load) != 0.0 {
            return LaterSign { sign: sign_of(after.load), is_steady: false };
        }
        is_steady &= (after.load - rate.load).abs() <= ALIKE * rate.load.abs();
    }
    LaterSign { sign: if is_steady { rate.load.signum() } else { 0.0 }, is_steady }
}

/// What rounding may do to the load rate of a direction, where the equations are few: entries off by `δA` put `-wᵀ δA x` into
/// it, with `A x` the last unit vector and `Aᵀ w` that of the load (N. J. Higham, *Accuracy and Stability of Numerical
/// Algorithms*, SIAM 2002, section 7.2). `A` has its rows over their sizes, so that `|δA|` is unit round-off at the most.
fn rounding_of_load_rate(loading: Loading<'_>, state: &State, rate: &Rate, modes: &[Mode]) -> Option<f64> {
    if loading.structure.layout().is_some() {
        return None;
    }
    let system = ModeSystem::new(loading, modes, state);
    let (rows, _) = scaled_rows(&system, loading, state);
    let mut matrix = rows.insert_row(system.size() - 1, 0.0);
    system.border(&mut matrix, rate);
    let (size, load) = (matrix.nrows(), loading.structure.unknowns());
    let unit = |place: usize| DVector::from_fn(size, |row, _| f64::from(u8::from(row == place)));
    let along = matrix.clone().lu().solve(&unit(size - 1))?;
    let weights = matrix.transpose().lu().solve(&unit(load))?;
    let rounding = ROUNDINGS * f64::EPSILON * weights.lp_norm(1) * along.lp_norm(1);
    rounding.is_finite().then_some(rounding)
}

/// The point a small step along a direction in these modes, with the direction there.
fn stepped(
    loading: Loading<'_>,
    state: &State,
    rate: &Rate,
    modes: &[Mode],
    step: f64,
    force_scale: f64,
) -> Option<(Corrected, Rate)> {
    let system = ModeSystem::new(loading, modes, state);
    let closing = ArcLengthEquation { from: state, step };
    let mut serving = None;
    let guess = system.iterate(state.advanced(rate, step));
    let corrected =
        newton::correct_from(&system, guess, &closing, force_scale, &mut serving, &mut Work::default()).ok()?;
    let distance = state.distance(&corrected.state);
    may_turn(state.cosine_of_chord(&corrected.state, distance, rate)).ok()?;
    let rate = match serving {
        Some(_) => tangent::tangent_and_error(&system, &corrected, rate, &mut serving, &mut 0)?.rate,
        None => system.tangent(&corrected, rate)?,
    };
    Some((corrected, rate))
}

/// The first combinations of alternatives, those with more sticking contacts first.
fn in_order(candidate: &CandidateDirection) -> Vec<Vec<usize>> {
    let places: Vec<Vec<usize>> =
        candidate.alternatives.iter().map(|alternatives| (0..alternatives.len()).collect()).collect();
    let mut all: Vec<Vec<usize>> = combinations::combinations(&places, MOST_COMBINATIONS).collect();
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
    /// Arc lengths, tried one after another until it is clear.
    steps: &'a [f64],
}

impl Trial<'_> {
    /// The modes of a combination and the load rate after a small step, or who is to blame.
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

    /// Follows only what is zero at first order: whatever else ends the mode within the step is an event to come. The
    /// step is short, so that such events come after it as a rule: where many contacts change close together, a long one
    /// would judge a motion that does not happen.
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
        for watch in event_functions::of_mode(loading, modes, state, &candidate.rate) {
            let first = watch.value(loading, modes, state, &candidate.rate);
            let tendency = watch.slope(loading, modes, state, &candidate.rate);
            let most = if watch.is_of_forces() { rates } else { 1.0 };
            if tendency.is_some_and(|slope| slope > IN_DOUBT * most)
                || watch.is_above_zero(loading, state, first, IN_DOUBT, forces)
            {
                continue;
            }
            let scale = watch.scale(loading, &corrected.state, forces);
            let size = if tendency.is_some() && watch.is_of_forces() { rates * (scale / forces) } else { 1.0 };
            if tendency.is_some_and(|slope| slope > IN_DOUBT * size) {
                continue;
            }
            let last = watch.value(loading, modes, &corrected.state, &rate) / scale;
            let grown = watch.slope(loading, modes, &corrected.state, &rate).map_or(last, |slope| slope / size);
            let clear = match watch {
                // A node on a stiff spring is slow, and its direction is as clear.
                Watch::Gap(contact) | Watch::Sliding(contact) => {
                    STILL + CLEAR_OF_SPEED * size_of(&loading.relative_rate(contact, &corrected.state, &rate))
                }
                // By the contact's own forces: along a chain close to jamming they fall by orders from node to node.
                Watch::Normal(contact) | Watch::Cone { contact, .. } => {
                    let own = candidate.rate.reactions[contact].size().max(rate.reactions[contact].size());
                    (CLEAR * own / size).max(CLEAR_OF_ROUND_OFF)
                }
                Watch::Facet { .. } | Watch::Slide { .. } | Watch::Hold { .. } | Watch::Return { .. } => CLEAR,
                Watch::LoadRate { .. } | Watch::End(_) => CLEAR,
            };
            if last < -TRIAL_TOLERANCE || grown < -clear {
                culprits.extend(contacts_of(loading, watch));
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

/// The contacts that a quantity is of.
fn contacts_of(loading: Loading<'_>, watch: Watch) -> Vec<usize> {
    match watch {
        Watch::Gap(contact) | Watch::Normal(contact) | Watch::Cone { contact, .. } | Watch::Sliding(contact) => {
            vec![contact]
        }
        Watch::Facet { corner, .. } | Watch::Slide { corner } | Watch::Hold { corner } | Watch::Return { corner } => {
            loading.corners[corner].contacts.clone()
        }
        Watch::LoadRate { .. } | Watch::End(_) => Vec::new(),
    }
}
