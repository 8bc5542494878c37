//! Contact changes of one step that are treated together.
//!
//! The places where frictionless contacts touch or lift off within a step do not affect its end, which is determined by
//! the laws at the end alone,
//!
//! ```text
//! equilibrium,    0 <= g ⊥ r_n >= 0,    ‖(Δu, Δs)‖ = S
//! ```
//!
//! and found by Newton's method in one mode after another: all contacts that violate a mode at its end are changed at
//! once (a primal-dual active set: M. Hintermüller, K. Ito, K. Kunisch, SIAM J. Optim. 13 (2002) 865,
//! doi:10.1137/S1052623401383558). In large structures one Newton iteration for each mode suffices: its
//! linearised equations give the next mode (`linear_complementarity`), until no contact violates its mode; then the
//! point is solved for, and checked again.
//!
//! This end lies on the path if the direction is unique throughout the step. Let `M` be the stiffness condensed on the
//! contacts that change, with all others unchanged. Each sign of the load rate has exactly one direction in any of
//! their modes if `M` is positive definite: see `rates`. By the additivity of inertia this is so if and only if the
//! reduced tangent has as many negative eigenvalues with all of these contacts closed as with all of them open. The
//! condition is checked at both ends of the step, with the same number at both: except for eigenvalues that cross zero
//! twice in between, as they may in any step, no limit point and no bifurcation then lies in the step in any mode that
//! the path may have had. The direction after each change then does not retrace the path, and keeps the sign of the
//! load rate. Contacts that change twice within the step are included in the check. Where the equations linearised once
//! already show a loss of uniqueness, or too large a turn, the attempt ends. Nor may the direction turn by more than in
//! any other step: where closing contacts turn it further each change ends a step. No contact slides against friction,
//! so that the work of the step equals the change of stored energy.
//!
//! An attempt may fail, usually several times in a row (an arch that rolls onto a floor leaves it at the first contact
//! point, and is stable only while one of the two contacts is closed): the next attempt is postponed by some steps, and
//! by more each time.
//!
//! All other changes end a step as usual: with friction the reactions depend on the place where a node has landed. At
//! the kinks of such a step a quantity may vanish and return unnoticed. Therefore changes are not treated together
//! where a contact with friction is closed or could close within the length of the path, nor where a displacement that
//! ends the stage could reach its bound. A frictionless contact that touches and opens again within the step is not
//! reported.

use crate::algebra::SystemFactorisation;
use crate::branching::bifurcation::singularity::test_functions::{Signature, negative_eigenvalues};
use crate::branching::bifurcation::step_end::{JoinedChanges, StepEnd};
use crate::continuation::contact_changes::linear_complementarity::{Complementary, complementary};
use crate::continuation::contact_changes::tolerances::LONGEST_PATH_RATIO;
use crate::mechanics::contact::Mode;
use crate::mechanics::contact::vector::size;
use crate::mechanics::equations::ModeSystem;
use crate::mechanics::equations::closing_equation::ArcLengthEquation;
use crate::mechanics::equations::corrected_point::Corrected;
use crate::mechanics::equations::stage_end_criteria::End;
use crate::mechanics::multi_contact::changeable_contacts::{Standing, standings};
use crate::mechanics::problem::loading::Loading;
use crate::mechanics::problem::state::{Rate, State};
use crate::step::corrector::cost_counters::Work;
use crate::step::corrector::newton;
use crate::step::corrector::single_iteration;
use crate::step::corrector::tangent;
use crate::step::event_functions::{self, EventFunction};
use crate::step::mode_step::{Reached, StepEvents, StepStart, may_turn};
use crate::step::tolerances::COINCIDENCE_TOLERANCE;
use std::collections::BTreeSet;

/// Largest number of violating contacts, relative to those of the first mode: more indicate that the modes diverge.
const MOST_RISE: usize = 2;
/// Largest number of modes tried at the end of a step.
const MOST_ROUNDS: usize = 12;

/// The modes that hold at the end of a step, and the point there.
struct EndModes {
    modes: Vec<Mode>,
    corrected: Corrected,
    /// All contacts changed in the search for the modes.
    asked: BTreeSet<usize>,
    /// Number of negative eigenvalues at the start, the same with these contacts closed and open.
    negative: usize,
}

/// The approximate end of a step if no contact changed.
#[derive(Clone, Copy)]
struct UnchangedStepEnd<'a> {
    state: &'a State,
    rate: &'a Rate,
    step: f64,
    /// Factorisation of the equations that the state satisfies to first order.
    factorisation: Option<&'a SystemFactorisation>,
}

/// The contact that touches or lifts off where a quantity is zero, if it has no friction and its node no other contact.
fn smooth(loading: Loading<'_>, event_function: EventFunction) -> Option<usize> {
    let (EventFunction::Gap(contact) | EventFunction::Normal(contact)) = event_function else { return None };
    let alone = !loading.corners.iter().any(|corner| corner.contacts.contains(&contact));
    (alone && loading.contacts[contact].tangents() == 0).then_some(contact)
}

/// Whether a contact with friction is closed, so that the path depends on its history.
fn remembers(loading: Loading<'_>, modes: &[Mode]) -> bool {
    let mut modes = modes.iter().zip(loading.contacts);
    modes.any(|(mode, contact)| mode.is_active() && contact.tangents() > 0)
}

/// Whether the change at which a quantity is zero may be treated together with others.
pub(crate) fn may_join_at(loading: Loading<'_>, modes: &[Mode], event_function: EventFunction) -> bool {
    smooth(loading, event_function).is_some() && !remembers(loading, modes)
}

/// The contacts that change in a trial step, if they are several and may be treated together.
pub(crate) fn changes_to_join(
    start: &StepStart<'_>,
    reached: &Reached,
    events: &StepEvents,
) -> Option<BTreeSet<usize>> {
    joinable(start, &events.functions, &events.passed, reached.step)
}

/// The end of a trial step that passes these contact changes, if they can be treated together.
pub(crate) fn join_changes(
    start: &StepStart<'_>,
    first: &BTreeSet<usize>,
    reached: &Reached,
    events: &StepEvents,
    work: &mut Work,
) -> Option<StepEnd> {
    join(
        start,
        first,
        UnchangedStepEnd {
            state: &reached.corrected.state,
            rate: &reached.rate,
            step: reached.step,
            factorisation: None,
        },
        &events.functions,
        work,
    )
}

/// The same for a step in which the rates predict such changes, without completing the trial step. `None` where they
/// predict none, `Some(None)` where the changes cannot be treated together.
pub(crate) fn join_foreseen(
    start: &StepStart<'_>,
    step: f64,
    ends: &[End],
    load_sign: f64,
    work: &mut Work,
) -> Option<Option<StepEnd>> {
    start.loading.structure.layout()?;
    let event_functions = start.event_functions(ends, load_sign);
    let passes = |event_function: &EventFunction| {
        let slope =
            event_function.slope(start.loading, start.modes, start.state, start.rate).filter(|slope| *slope < 0.0);
        slope.is_some_and(|slope| start.value(*event_function, start.state, start.rate) < -slope * step)
    };
    let foreseen: Vec<EventFunction> = event_functions.iter().copied().filter(passes).collect();
    joinable(start, &event_functions, &foreseen, step)?;
    let system = ModeSystem::new(start.loading, start.modes, start.state).along(start.rate);
    let closing = ArcLengthEquation { from: start.state, step };
    let (state, factorisation) =
        single_iteration::iterated_once(&system, start.state.advanced(start.rate, step), &closing, work)?;
    let rate = single_iteration::direction_about(&system, &state, &factorisation, start.rate)?;
    let negative = |event_function: &EventFunction| {
        start.value(*event_function, &state, &rate) < -event_function.zero(start.loading, &state, start.force_scale)
    };
    let passed: Vec<EventFunction> = event_functions.iter().copied().filter(negative).collect();
    let first = joinable(start, &event_functions, &passed, step)?;
    let far = UnchangedStepEnd { state: &state, rate: &rate, step, factorisation: Some(&factorisation) };
    Some(join(start, &first, far, &event_functions, work))
}

fn joinable(
    start: &StepStart<'_>,
    event_functions: &[EventFunction],
    passed: &[EventFunction],
    step: f64,
) -> Option<BTreeSet<usize>> {
    let turns = event_functions.iter().any(|event_function| matches!(event_function, EventFunction::LoadRate { .. }));
    if passed.len() < 2 || !turns || !may_join(start) || !leaves_no_trace(start, event_functions, step) {
        return None;
    }
    passed.iter().map(|event_function| smooth(start.loading, *event_function)).collect()
}

fn join(
    start: &StepStart<'_>,
    first: &BTreeSet<usize>,
    far: UnchangedStepEnd<'_>,
    event_functions: &[EventFunction],
    work: &mut Work,
) -> Option<StepEnd> {
    let mut serving = None;
    let EndModes { modes, corrected, asked, negative } = end_modes(start, first, far, &mut serving, work)?;
    let end = StepStart { modes: &modes, ..*start };
    let system = ModeSystem::new(start.loading, &modes, start.state);
    let closing = ArcLengthEquation { from: start.state, step: far.step };
    let reached = end.directed(system, corrected, &closing, &mut serving, work).ok()?;
    let mut restless: BTreeSet<usize> =
        (0..modes.len()).filter(|contact| modes[*contact] != start.modes[*contact]).collect();
    let changes = restless.len();
    let turns = may_turn(start.rate.product(&reached.rate)).is_err();
    if changes < 2 || turns || !nothing_else_ends(start, event_functions, &mut restless, &reached) {
        return None;
    }
    let mut same = |state: &State| negative_where_held_or_free(start, &restless, state, work) == Some(negative);
    if (!restless.is_subset(&asked) && !same(start.state)) || !same(&reached.corrected.state) {
        return None;
    }
    let analysed = start.loading.structure.allows_dense();
    let signature = reached.determinant.filter(|_| analysed);
    let signature = signature.map(|determinant| Signature { determinant, negative: Some(negative) });
    let joined = JoinedChanges { count: changes as u64, unchanged: far.rate.clone() };
    Some(StepEnd { joined: Some(joined), ..StepEnd::in_mode(reached, None, signature) })
}

/// Whether changes in a step may be treated together: not where a contact with friction is closed.
pub(crate) fn may_join(start: &StepStart<'_>) -> bool {
    start.drift.is_none() && !remembers(start.loading, start.modes)
}

/// Whether no event that depends on its place can occur within a step, where a quantity may vanish and return at the
/// kinks. The load is monotonic; no displacement exceeds the length of the path.
fn leaves_no_trace(start: &StepStart<'_>, event_functions: &[EventFunction], step: f64) -> bool {
    let length = LONGEST_PATH_RATIO * step;
    event_functions.iter().all(|event_function| {
        let value = start.value(*event_function, start.state, start.rate);
        match *event_function {
            EventFunction::LoadRate { .. } | EventFunction::End(End::Load { .. }) => true,
            EventFunction::End(_) => value > length,
            EventFunction::Gap(contact) if smooth(start.loading, *event_function).is_none() => {
                value > length * (1.0 + size(&start.loading.driven(contact, start.state)))
            }
            _ => smooth(start.loading, *event_function).is_some(),
        }
    })
}

/// The modes that hold at the end of the step, with the `last` factorisation; the present mode is violated by the
/// `first` contacts there. `None` where the direction is not unique at the start.
fn end_modes(
    start: &StepStart<'_>,
    first: &BTreeSet<usize>,
    far: UnchangedStepEnd<'_>,
    last: &mut Option<SystemFactorisation>,
    work: &mut Work,
) -> Option<EndModes> {
    let mut modes = start.modes.to_vec();
    let mut state = far.state.clone();
    // In most intermediate modes one iteration suffices to find the contacts that violate them.
    let mut roughly = start.loading.structure.layout().is_some();
    let mut wrong: Vec<usize> = first.iter().copied().collect();
    let mut asked = first.clone();
    let mut tried = BTreeSet::new();
    // Number of contacts examined together at the start, and the number of negative eigenvalues found.
    let mut counted: Option<(usize, usize)> = None;
    let mut linearised = None;
    for round in 0..MOST_ROUNDS {
        if wrong.len() > MOST_RISE * first.len() {
            return None;
        }
        let nearby = linearised.as_ref().or(far.factorisation.filter(|_| round == 0));
        if let Some(settled) = settled(start, &modes, &state, far.rate, nearby, &wrong) {
            if !settled.leaves_no_choice {
                return None;
            }
            (wrong, state) = (settled.changed, settled.state);
            may_turn(start.state.cosine_of_chord(&state, state.distance(start.state), start.rate)).ok()?;
            asked.extend(&wrong);
        }
        for contact in &wrong {
            let held = modes[*contact].is_active();
            modes[*contact] = if held { Mode::Free } else { Mode::Slip { direction: [0.0; 3] } };
        }
        if !tried.insert((roughly, modes.iter().map(|mode| mode.is_active()).collect::<Vec<bool>>())) {
            if !roughly {
                return None;
            }
            roughly = false;
        }
        let system = ModeSystem::new(start.loading, &modes, start.state).along(start.rate);
        let closing = ArcLengthEquation { from: start.state, step: far.step };
        // Each mode has its own equations.
        (*last, linearised) = (None, None);
        if roughly {
            let (next, factorisation) = single_iteration::iterated_once(&system, state, &closing, work)?;
            state = next;
            wrong = broken(start, &modes, &state, start.force_scale)?;
            asked.extend(&wrong);
            if wrong.is_empty() {
                roughly = false;
                *last = tangent::may_serve(&system, factorisation);
            } else {
                linearised = Some(factorisation);
            }
        }
        // Without uniqueness at the start the solves are useless. One iteration finds most of the contacts to be
        // examined, and uniqueness with more contacts closed or open implies it with fewer.
        if counted.is_none() {
            counted = Some((asked.len(), negative_where_held_or_free(start, &asked, start.state, work)?));
        }
        if roughly {
            continue;
        }
        let corrected =
            newton::correct_from(&system, system.iterate(state), &closing, start.force_scale, last, work).ok()?;
        let forces = start.force_scale.max(corrected.force_scale);
        wrong = broken(start, &modes, &corrected.state, forces)?;
        if wrong.is_empty() {
            let negative = match counted {
                Some((all, negative)) if all == asked.len() => negative,
                _ => negative_where_held_or_free(start, &asked, start.state, work)?,
            };
            return Some(EndModes { modes, corrected, asked, negative });
        }
        asked.extend(&wrong);
        state = corrected.state;
    }
    None
}

/// The contacts that change from some modes near the state that one iteration in them found, by the factorisation of
/// this iteration.
fn settled(
    start: &StepStart<'_>,
    modes: &[Mode],
    state: &State,
    rate: &Rate,
    factorisation: Option<&SystemFactorisation>,
    wrong: &[usize],
) -> Option<Complementary> {
    let broken = |state: &State| broken(start, modes, state, start.force_scale);
    let system = ModeSystem::new(start.loading, modes, start.state);
    complementary(&system, state, rate, factorisation?, wrong, broken)
}

/// The contacts whose modes do not hold at a state; `None` where some other quantity is negative.
pub(crate) fn broken(start: &StepStart<'_>, modes: &[Mode], state: &State, forces: f64) -> Option<Vec<usize>> {
    let broken =
        event_functions::of_mode(start.loading, modes, state, start.rate).into_iter().filter(|event_function| {
            let value = event_function.value(start.loading, modes, state, start.rate);
            value < -event_function.zero(start.loading, state, forces)
        });
    broken.map(|event_function| smooth(start.loading, event_function)).collect()
}

/// Whether no stage ends within the step or at its end, the load rate keeps its sign, the other contacts keep their
/// modes, and none can change at the end. Contacts that may have changed twice are added to the `restless`.
fn nothing_else_ends(
    start: &StepStart<'_>,
    event_functions: &[EventFunction],
    restless: &mut BTreeSet<usize>,
    reached: &Reached,
) -> bool {
    let state = &reached.corrected.state;
    let forces = start.force_scale.max(reached.corrected.force_scale);
    let ends = ((start.state, start.rate), (state, &reached.rate));
    for event_function in event_functions {
        let smooth = smooth(start.loading, *event_function);
        if smooth.is_some_and(|contact| restless.contains(&contact)) {
            continue;
        }
        let last = event_function.value(start.loading, start.modes, state, &reached.rate);
        let dips = |zero| event_function.dip(start.loading, start.modes, ends.0, ends.1, reached.step, zero).is_some();
        if event_function.is_above_zero(start.loading, state, last, COINCIDENCE_TOLERANCE, forces)
            && !(dips(0.0) && dips(event_function.zero(start.loading, state, forces)))
        {
            continue;
        }
        match smooth {
            Some(contact) => restless.insert(contact),
            None => return false,
        };
    }
    let settled = |standing: &Standing| matches!(standing, Standing::Settled(_));
    standings(start.loading, state, forces).iter().all(settled)
}

/// The number of negative eigenvalues of the tangent at a state, if it is the same with some contacts closed and open.
pub(crate) fn negative_where_held_or_free(
    start: &StepStart<'_>,
    contacts: &BTreeSet<usize>,
    state: &State,
    work: &mut Work,
) -> Option<usize> {
    let mut count = |mode: Mode| {
        let mut modes = start.modes.to_vec();
        contacts.iter().for_each(|contact| modes[*contact] = mode);
        negative_eigenvalues(start.loading, &modes, start.state, state, work)
    };
    let free = count(Mode::Free)?;
    // Closing contacts can only reduce the number.
    (free == 0 || count(Mode::Slip { direction: [0.0; 3] })? == free).then_some(free)
}
