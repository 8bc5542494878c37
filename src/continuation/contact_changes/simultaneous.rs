//! Contact changes of one step that are taken together.
//!
//! Contacts without friction that touch or lift off within a step leave no trace of where they did: the end of the step is
//! found from the laws at the end alone,
//!
//! ```text
//! equilibrium,    0 <= g ⊥ r_n >= 0,    ‖(Δu, Δs)‖ = S
//! ```
//!
//! by Newton's method in one mode after another: what a mode breaks at its end is changed, all of it at once (a
//! primal-dual active set: M. Hintermüller, K. Ito, K. Kunisch, SIAM J. Optim. 13 (2002) 865,
//! doi:10.1137/S1052623401383558). In large structures one iteration a mode tells that, until nothing is broken any more,
//! and from one mode to the next it is found with the equations of that iteration (`linear_complementarity`); then the point is
//! solved for, and looked at again.
//!
//! That end is the path's where nothing on the way leaves a choice. With `M` the stiffness that the contacts which
//! change feel (the others as they are), each sign of the load rate has exactly one direction in any mode of theirs if
//! `M` is positive definite: see `rates`. By the additivity of inertia it is if and only if the reduced tangent has as
//! many negative eigenvalues with all of them held as with all of them free. That is asked for at both ends of the
//! step, and the same number at both: but for eigenvalues that cross zero to and fro in between, as they may in any step,
//! no limit point and no bifurcation lies there in any mode that the path may have had. The way on from each change is then
//! not the way back, and keeps the sign of the load rate. Contacts that change there and back within the step are asked for
//! as well. Where the equations linearised once already tell of a choice, or of too great a turn, nothing more is looked at.
//! Nor may the direction turn by more than in any other step: where closing contacts turn it further each change
//! ends a step. Nothing slides against friction, so that the work of the step is taken from the energy stored.
//!
//! Where a try fails, as many in a row do as a rule (an arch that rolls onto a floor leaves it where it first touched, and
//! stands only while one of the two contacts holds it): it waits for some steps, and for longer each time.
//!
//! Everything else ends a step as it always does: friction remembers where a node has landed. On the kinks of such a step
//! a quantity may go to and fro unseen. So there is none where a contact with friction is closed or could close within the
//! length of the path, nor where a displacement that ends the stage could get there. A contact without friction that
//! touches and leaves again within the step is not named.

use crate::algebra::SystemFactorisation;
use crate::branching::bifurcation::singularity::test_functions::{Signature, negative_eigenvalues};
use crate::continuation::contact_changes::linear_complementarity::{Complementary, complementary};
use crate::mechanics::contact::Mode;
use crate::mechanics::contact::vector::size;
use crate::mechanics::equations::ModeSystem;
use crate::mechanics::equations::closing_equation::ArcLengthEquation;
use crate::mechanics::equations::solution::Corrected;
use crate::mechanics::equations::stage_criteria::End;
use crate::mechanics::multi_contact::contact_status::{Standing, standings};
use crate::mechanics::problem::loading::Loading;
use crate::mechanics::problem::state::{Rate, State};
use crate::step::corrector::cost_counters::Work;
use crate::step::corrector::newton;
use crate::step::corrector::single_iteration;
use crate::step::corrector::tangent;
use crate::step::event_functions::{self, Watch};
use crate::step::segment::{Attempt, COINCIDING, PASSED, Reached, StepStart, may_turn};
use std::collections::BTreeSet;

/// A mode that breaks so many times the contacts that the first one broke leads away from the end.
const MOST_RISE: usize = 2;
/// Modes that are tried at the end of a step.
const MOST_ROUNDS: usize = 12;

/// Length of a path with kinks over that of its chord, as it is reckoned with: not proven to be the most.
const LONGEST: f64 = 4.0;

/// The end of a step with contact changes inside.
pub(crate) struct Joined {
    pub reached: Box<Reached>,
    /// How many.
    pub changes: u64,
    pub signature: Option<Signature>,
    /// The path's direction at the step's end if no contact changed: how much it turns beside its kinks.
    pub unchanged: Rate,
}

/// The modes that hold at the end of a step, and the point there.
struct EndModes {
    modes: Vec<Mode>,
    corrected: Corrected,
    /// All contacts that were changed on the way to the modes.
    asked: BTreeSet<usize>,
    /// Negative eigenvalues at the start with those held, and as many with them free.
    negative: usize,
}

/// About where a step would end if no contact changed.
#[derive(Clone, Copy)]
struct UnchangedStepEnd<'a> {
    state: &'a State,
    rate: &'a Rate,
    step: f64,
    /// Of the equations whose solution the state is at first order.
    factorisation: Option<&'a SystemFactorisation>,
}

/// The contact that touches or lifts off where a quantity is zero, if it has no friction and its node no other contact.
fn smooth(loading: Loading<'_>, watch: Watch) -> Option<usize> {
    let (Watch::Gap(contact) | Watch::Normal(contact)) = watch else { return None };
    let alone = !loading.corners.iter().any(|corner| corner.contacts.contains(&contact));
    (alone && loading.contacts[contact].tangents() == 0).then_some(contact)
}

/// Whether a contact with friction is closed.
fn remembers(loading: Loading<'_>, modes: &[Mode]) -> bool {
    let mut modes = modes.iter().zip(loading.contacts);
    modes.any(|(mode, contact)| mode.is_active() && contact.tangents() > 0)
}

/// Whether the change at which a quantity is zero may be taken together with others.
pub(crate) fn may_join_at(loading: Loading<'_>, modes: &[Mode], watch: Watch) -> bool {
    smooth(loading, watch).is_some() && !remembers(loading, modes)
}

/// The contacts that change in a step that was tried, if they are several and may be taken together.
pub(crate) fn changes_to_join(start: &StepStart<'_>, tried: &Attempt) -> Option<BTreeSet<usize>> {
    joinable(start, &tried.watches, &tried.passed, tried.reached.step)
}

/// The end of a step that was tried and passes these contact changes, if they can be taken together.
pub(crate) fn join_changes(
    start: &StepStart<'_>,
    first: &BTreeSet<usize>,
    tried: &Attempt,
    work: &mut Work,
) -> Option<Joined> {
    let Attempt { reached, watches, .. } = tried;
    join(
        start,
        first,
        UnchangedStepEnd {
            state: &reached.corrected.state,
            rate: &reached.rate,
            step: reached.step,
            factorisation: None,
        },
        watches,
        work,
    )
}

/// The same of a step in which the rates foresee such changes, which is not tried any further then. `None` where they
/// foresee none, `Some(None)` where they cannot be taken together.
pub(crate) fn join_foreseen(
    start: &StepStart<'_>,
    step: f64,
    ends: &[End],
    load_sign: f64,
    work: &mut Work,
) -> Option<Option<Joined>> {
    start.loading.structure.layout()?;
    let watches = start.watches(ends, load_sign);
    let passes = |watch: &Watch| {
        let slope = watch.slope(start.loading, start.modes, start.state, start.rate).filter(|slope| *slope < 0.0);
        slope.is_some_and(|slope| start.value(*watch, start.state, start.rate) < -slope * step)
    };
    let foreseen: Vec<Watch> = watches.iter().copied().filter(passes).collect();
    joinable(start, &watches, &foreseen, step)?;
    let system = ModeSystem::new(start.loading, start.modes, start.state);
    let closing = ArcLengthEquation { from: start.state, step };
    let (state, factorisation) =
        single_iteration::iterated_once(&system, start.state.advanced(start.rate, step), &closing, work)?;
    let rate = single_iteration::direction_about(&system, &state, &factorisation, start.rate)?;
    let negative = |watch: &Watch| {
        start.value(*watch, &state, &rate) < -PASSED * watch.scale(start.loading, &state, start.force_scale)
    };
    let passed: Vec<Watch> = watches.iter().copied().filter(negative).collect();
    let first = joinable(start, &watches, &passed, step)?;
    let far = UnchangedStepEnd { state: &state, rate: &rate, step, factorisation: Some(&factorisation) };
    Some(join(start, &first, far, &watches, work))
}

fn joinable(start: &StepStart<'_>, watches: &[Watch], passed: &[Watch], step: f64) -> Option<BTreeSet<usize>> {
    let turns = watches.iter().any(|watch| matches!(watch, Watch::LoadRate { .. }));
    if passed.len() < 2 || !turns || !may_join(start) || !leaves_no_trace(start, watches, step) {
        return None;
    }
    passed.iter().map(|watch| smooth(start.loading, *watch)).collect()
}

fn join(
    start: &StepStart<'_>,
    first: &BTreeSet<usize>,
    far: UnchangedStepEnd<'_>,
    watches: &[Watch],
    work: &mut Work,
) -> Option<Joined> {
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
    if changes < 2 || turns || !nothing_else_ends(start, watches, &mut restless, &reached) {
        return None;
    }
    let mut same = |state: &State| negative_where_held_or_free(start, &restless, state, work) == Some(negative);
    if (!restless.is_subset(&asked) && !same(start.state)) || !same(&reached.corrected.state) {
        return None;
    }
    let analysed = start.loading.structure.allows_dense();
    let signature = reached.determinant.filter(|_| analysed);
    let signature = signature.map(|determinant| Signature { determinant, negative: Some(negative) });
    Some(Joined { reached, changes: changes as u64, signature, unchanged: far.rate.clone() })
}

/// Whether changes in a step may be taken together: not where a contact with friction is closed.
pub(crate) fn may_join(start: &StepStart<'_>) -> bool {
    start.drift.is_none() && !remembers(start.loading, start.modes)
}

/// Whether within a step nothing can end that leaves a trace: on its kinks a quantity may go to and fro. The load goes
/// one way; no displacement goes farther than the path is long.
fn leaves_no_trace(start: &StepStart<'_>, watches: &[Watch], step: f64) -> bool {
    let length = LONGEST * step;
    watches.iter().all(|watch| {
        let value = start.value(*watch, start.state, start.rate);
        match *watch {
            Watch::LoadRate { .. } | Watch::End(End::Load { .. }) => true,
            Watch::End(_) => value > length,
            Watch::Gap(contact) if smooth(start.loading, *watch).is_none() => {
                value > length * (1.0 + size(&start.loading.pattern.shifts[contact]))
            }
            _ => smooth(start.loading, *watch).is_some(),
        }
    })
}

/// The modes that hold at the end of the step, with the `last` factorisation; the mode just now breaks the `first`
/// contacts there. `None` where the contacts leave a choice at the start.
fn end_modes(
    start: &StepStart<'_>,
    first: &BTreeSet<usize>,
    far: UnchangedStepEnd<'_>,
    last: &mut Option<SystemFactorisation>,
    work: &mut Work,
) -> Option<EndModes> {
    let mut modes = start.modes.to_vec();
    let mut state = far.state.clone();
    // In most modes on the way one iteration tells what breaks them.
    let mut roughly = start.loading.structure.layout().is_some();
    let mut wrong: Vec<usize> = first.iter().copied().collect();
    let mut asked = first.clone();
    let mut tried = BTreeSet::new();
    // Contacts that were looked at together at the start, and the negative eigenvalues found.
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
        let system = ModeSystem::new(start.loading, &modes, start.state);
        let closing = ArcLengthEquation { from: start.state, step: far.step };
        // Each mode has equations of its own.
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
        // What leaves a choice at the start is not worth the solves. One iteration tells most of what is asked besides,
        // and what holds with more contacts held or free holds with fewer.
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

/// The contacts that change from some modes at about the state that one iteration in them led to, by that factorisation.
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
    let broken = event_functions::of_mode(start.loading, modes, state, start.rate).into_iter().filter(|watch| {
        let value = watch.value(start.loading, modes, state, start.rate);
        value < -PASSED * watch.scale(start.loading, state, forces)
    });
    broken.map(|watch| smooth(start.loading, watch)).collect()
}

/// Whether no stage ends within the step or at its end, the load rate keeps its sign, the other contacts keep their
/// modes, and none can change at the end. Those that may have changed there and back join the `restless`.
fn nothing_else_ends(
    start: &StepStart<'_>,
    watches: &[Watch],
    restless: &mut BTreeSet<usize>,
    reached: &Reached,
) -> bool {
    let state = &reached.corrected.state;
    let forces = start.force_scale.max(reached.corrected.force_scale);
    let ends = ((start.state, start.rate), (state, &reached.rate));
    for watch in watches {
        let smooth = smooth(start.loading, *watch);
        if smooth.is_some_and(|contact| restless.contains(&contact)) {
            continue;
        }
        let last = watch.value(start.loading, start.modes, state, &reached.rate);
        let dips = |zero| watch.dip(start.loading, start.modes, ends.0, ends.1, reached.step, zero).is_some();
        if watch.is_above_zero(start.loading, state, last, COINCIDING, forces)
            && !(dips(0.0) && dips(PASSED * watch.scale(start.loading, state, forces)))
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

/// Negative eigenvalues of the tangent at a state with some contacts held and with them free, where these are as many.
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
    // Held they can only be fewer.
    (free == 0 || count(Mode::Slip { direction: [0.0; 3] })? == free).then_some(free)
}
