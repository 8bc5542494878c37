//! Step-length control by the path's turn, Newton's iterations and the energy balance of the increment.

use crate::algebra::scalar_root::find_root;
use crate::branching::bifurcation::step_end::StepEnd;
use crate::branching::directions::arrival_tangent::Incoming;
use crate::branching::directions::feasible_direction::PriorMotion;
use crate::branching::selection::selection_rule;
use crate::continuation::contact_changes::piecewise_linear;
use crate::continuation::contact_changes::prediction::{self, ForeseenChange};
use crate::continuation::contact_changes::simultaneous::may_join_at;
use crate::continuation::increment::step_attempt::{self, Sought, Tries};
use crate::continuation::increment::tolerances::{
    CREEPING_LENGTH, CREEPING_SHARE, LARGEST_CURVATURE_GROWTH, LARGEST_STEP_GROWTH, LENGTH_PAST_BEND, REJECTION_FACTOR,
    SHORT_STEP, SMALLEST_COMPLETED_SHARE, SMALLEST_STRETCH, TARGET_IMBALANCE, TARGET_ITERATIONS, TARGET_TURN,
    UNSTRESSED_MULTIPLE, WORK_ROUND_OFF,
};
use crate::continuation::increment::{mpec_increments, mpec_verification};
use crate::continuation::path_state::path_context::PathTrace;
use crate::continuation::path_state::step_factor_rounding::quantised;
use crate::continuation::path_state::tolerances::{ENERGY_ROUND_OFF, SAME_STATE};
use crate::continuation::path_state::totals::Added;
use crate::mechanics::contact::all_continue;
use crate::mechanics::equations::ModeSystem;
use crate::mechanics::equations::stage_end_criteria::End;
use crate::mechanics::problem::state::{Rate, State};
use crate::mechanics::problem::work_and_dissipation::{self, IncrementWork};
use crate::mechanics::structure::elements::COLLAPSED;
use crate::model::request::{Events, Method};
use crate::result::stop_reason::StopReason;
use crate::step::corrector::cost_counters::Work;
use crate::step::corrector::newton;
use crate::step::event_functions::EventFunction;
use crate::step::interpolation::unit;
use crate::step::mode_step::{Reached, Refused, StepStart};

/// Largest number of consecutive creeping steps: the sharpest bend, there and back, takes fewer at the turn for which a
/// step aims, and a path that takes more oscillates.
const MOST_CREEPING: u64 = 48;

/// What a step adds to the path, and how far it turns.
pub(crate) struct StepBalance {
    pub added: Added,
    /// Turn of the direction (radians), without that of contact changes within the step.
    pub turned: f64,
    /// Whether the increment's program confirmed the mode; `None` where it was not solved.
    pub mode_named: Option<bool>,
}

/// Attempts steps until the end of one is accepted.
pub(crate) fn step(trace: &mut PathTrace<'_>) -> Result<(StepEnd, StepBalance), StopReason> {
    let mut sought = sought_step(trace);
    let Some(rate) = trace.at.here.rate.take() else { return Err(StopReason::NoDirection) };
    let stepped = step_along(trace, &rate, &mut sought);
    trace.at.here.rate = Some(rate);
    stepped
}

/// Attempts steps along the present direction until the end of one is accepted.
fn step_along(
    trace: &mut PathTrace<'_>,
    rate: &Rate,
    sought: &mut Sought,
) -> Result<(StepEnd, StepBalance), StopReason> {
    let least = trace.scene.analysis.arc_length.min;
    let mut step = sought.step();
    let mut was_shortened = false;
    let mut tries = Tries::new(&trace.at.here, std::mem::take(&mut trace.cached));
    loop {
        if trace.cancel.is_cancelled() {
            return Err(StopReason::Cancelled);
        }
        let mut work = trace.at.totals.work;
        let outcome = step_attempt::try_step(trace, rate, step, sought, &mut tries, &mut work);
        trace.at.totals.work = work;
        if let Some(joined) = tries.joined.take() {
            trace.at.waiting.note(joined);
            sought.may_join &= joined;
        }
        match outcome {
            Ok(mut end) => match weigh(trace, rate, &mut end, step, sought, was_shortened) {
                // An interrupted search says nothing about its increment.
                Ok(balance) if balance.mode_named == Some(false) && trace.cancel.is_cancelled() => {
                    return Err(StopReason::Cancelled);
                }
                Ok(balance) => return Ok((end, balance)),
                Err(factor) => {
                    step *= factor;
                    was_shortened = true;
                }
            },
            Err(Refused::AtStart(event_function)) if event_function.is_of_contact() && mode_ends_here(trace, rate) => {
                let end = StepEnd::plain(without_step(trace, event_function, rate));
                let mut balance = balance(trace, rate, &end);
                balance.mode_named = is_named_by_program(trace).then_some(true);
                return Ok((end, balance));
            }
            Err(Refused::Apart) => {
                // Each of the changes then ends a step, the first of them the present one.
                sought.ordinary = sought.ordinary.min(step);
                sought.foreseen = prediction::step_to_foreseen_change(trace, step, rate, false);
                step = sought.foreseen.map_or(step, |change| change.step);
            }
            Err(Refused::Unresolved) => {
                tries.unresolved += 1;
                step *= 0.7;
            }
            Err(refused) => {
                was_shortened = true;
                step *= match refused {
                    Refused::Turned(angle) => (0.5 * TARGET_TURN / angle).clamp(0.1, 0.5),
                    Refused::Newton(_) => 0.5,
                    Refused::AtStart(_)
                    | Refused::Unlawful
                    | Refused::Collapsed
                    | Refused::Unresolved
                    | Refused::Apart => 0.25,
                };
                if step < least {
                    return Err(match refused {
                        Refused::Unlawful => StopReason::ContactViolated,
                        Refused::Collapsed => StopReason::CollapsedBar,
                        _ => reason_of_underflow(trace),
                    });
                }
            }
        }
    }
}

/// The intended length of a step, as far as it is known before an attempt.
fn sought_step(trace: &mut PathTrace<'_>) -> Sought {
    let ordinary = trace.at.step.min(trace.scene.analysis.arc_length.max);
    // At a shorter distance from a bend the path is still turning.
    let width = trace.at.here.beside.as_ref().map_or(0.0, Rate::size);
    let ordinary = ordinary.max(LENGTH_PAST_BEND * width * width);
    let may_join = trace.at.waiting.is_over() && may_join_changes(trace);
    // Changes within an ordinary step may be several that are treated together.
    let ahead = piecewise_linear::next_event_ahead(trace);
    let joins =
        |event: &ForeseenChange| may_join && may_join_at(trace.loading(), &trace.at.here.modes, event.event_function);
    let jump = ahead.filter(|event| event.step > ordinary || !joins(event));
    trace.look_ahead(jump.map_or(ordinary, |event| event.step));
    let rate = trace.at.here.rate.as_ref().filter(|_| jump.is_none());
    let foreseen = rate.and_then(|rate| prediction::step_to_foreseen_change(trace, ordinary, rate, may_join));
    Sought { ordinary, jump, foreseen, may_join }
}

/// The energies of an increment that is accepted, with which the next step length is chosen; otherwise the factor by
/// which the step, too long for them, is to be shortened.
fn weigh(
    trace: &mut PathTrace<'_>,
    rate: &Rate,
    end: &mut StepEnd,
    step: f64,
    sought: &Sought,
    was_shortened: bool,
) -> Result<StepBalance, f64> {
    let (least, most) = (trace.scene.analysis.arc_length.min, trace.scene.analysis.arc_length.max);
    let mut balance = balance(trace, rate, end);
    let factor = next_step_factor(trace, end, &balance, step, was_shortened);
    if factor <= REJECTION_FACTOR && step * factor >= least {
        return Err(factor);
    }
    let factor = factor.min(factor_foreseen(trace, rate, end.reached.step, balance.turned, step));
    // Where the mode ends inside the step, the program verifies the next mode from there.
    if trace.scene.analysis.skips_certificate() && is_named_by_program(trace) {
        balance.mode_named = Some(mpec_increments::found_by_program(trace, rate, end));
    } else {
        balance.mode_named = is_named_by_program(trace).then(|| match &end.joined {
            None => mpec_verification::program_keeps_mode(trace, rate, &end.reached, step),
            Some(_) => mpec_verification::program_joins_changes(trace, rate, step, &end.reached.corrected.modes),
        });
    }
    if !sought.jumps(step) {
        let was_cut = sought.foreseen.is_some_and(|foreseen| foreseen.step == step) && factor >= 1.0;
        let next = if was_cut { sought.ordinary } else { step * factor };
        trace.at.step = next.clamp(least, most);
    }
    Ok(balance)
}

/// The reason to stop a path that no longer makes progress with steps of this length, if it does not. A step at the end
/// of which the contact modes change, or the stage ends, is progress, however short. A step to a limit or bifurcation
/// point, or to a point where a contact keeps its mode, is not: a smooth path has few of these within so short an arc
/// length; where signs are round-off there is no end of them.
pub(crate) fn reason_of_creep(trace: &mut PathTrace<'_>, step: f64, changes: bool) -> Option<StopReason> {
    // Scales larger than the scene's own make every step shorter by the same factor.
    let enlarged = trace.scene.stages[trace.at.stage].enlarged;
    let bar = (CREEPING_LENGTH / enlarged).min(CREEPING_SHARE * trace.scene.analysis.arc_length.max);
    let creeps = !changes && step < bar;
    trace.at.creeping = if creeps { trace.at.creeping + 1 } else { 0 };
    (trace.at.creeping >= MOST_CREEPING).then(|| reason_of_underflow(trace))
}

/// Whether some bar has become so short that the displacements no longer determine its direction.
pub(crate) fn shrinks_to_a_point(trace: &PathTrace<'_>, state: &State) -> bool {
    let structure = &*trace.structure;
    structure.smallest_stretch(&state.displacement) < SMALLEST_STRETCH
        && structure.smallest_stretch(&trace.at.here.state.displacement) >= SMALLEST_STRETCH
}

/// Whether contact changes may be treated together: not where every change is requested, or counted.
fn may_join_changes(trace: &PathTrace<'_>) -> bool {
    let analysis = &trace.scene.analysis;
    let counted = trace.scene.stages[trace.at.stage].ends.iter().any(|end| matches!(end, End::ContactChanges(_)));
    analysis.events == Events::Auto && !counted
}

/// Whether the program of each increment is solved to verify its mode.
fn is_named_by_program(trace: &PathTrace<'_>) -> bool {
    trace.scene.analysis.method == Method::Mpec && !trace.scene.contacts.is_empty()
}

/// Whether the mode cannot continue from the present point.
fn mode_ends_here(trace: &PathTrace<'_>, rate: &Rate) -> bool {
    let here = &trace.at.here;
    let standings = trace.standings(&here.state);
    let before = PriorMotion::Incoming(Incoming::along(rate));
    let decision = selection_rule::decide(trace.loading(), &here.state, &standings, before, trace.rules());
    decision.taken.is_none_or(|index| !all_continue(&decision.options[index].modes, &here.modes))
}

/// The present point again, as the place where the mode ends: two changes at one state, the second of which was not
/// detected at the point itself, are two points of the path.
fn without_step(trace: &PathTrace<'_>, event_function: EventFunction, rate: &Rate) -> Box<Reached> {
    let here = &trace.at.here;
    let system = ModeSystem::new(trace.loading(), &here.modes, &here.state);
    let mut corrected = newton::judged(&system, here.state.clone(), trace.at.totals.force_scale);
    (corrected.state, corrected.modes) = (here.state.clone(), here.modes.clone());
    let mut point = Reached::new(corrected, rate.clone(), 0.0, here.drift.as_ref().map_or(0.0, Rate::size));
    (point.drift, point.event) = (here.drift.clone(), Some(event_function));
    point
}

/// The point at which the stage began, where a step without event passes it again in the same sense.
pub(crate) fn way_back(
    trace: &PathTrace<'_>,
    start: &StepStart<'_>,
    reached: &Reached,
    work: &mut Work,
) -> Option<Box<Reached>> {
    let (origin, sense) = trace.at.begun.as_ref()?;
    // Distance of a state past the origin.
    let past = |state: &State| {
        let chord = state.displacement.iter().zip(&origin.displacement).zip(&sense.displacement);
        chord.map(|((to, from), rate)| (to - from) * rate).sum::<f64>() + (state.load - origin.load) * sense.load
    };
    let (first, last) = (past(start.state), past(&reached.corrected.state));
    let near = || start.state.distance(origin).min(reached.corrected.state.distance(origin)) <= reached.step;
    let passes = reached.event.is_none() && first < -SAME_STATE && last >= 0.0 && near();
    if !passes || reached.rate.product(sense) <= 0.0 {
        return None;
    }
    let at = |place: f64| start.reach(place, work).ok().map(|near| -past(&near.corrected.state));
    let place = find_root(at, (0.0, -first), (reached.step, -last), 1e-14)?;
    let back = start.reach(place, work).ok()?;
    let same = back.corrected.state.distance(origin) < SAME_STATE
        && back
            .corrected
            .state
            .reactions
            .iter()
            .zip(&origin.reactions)
            .all(|(a, b)| a.difference(b) < SAME_STATE * trace.at.totals.force_scale);
    same.then_some(back)
}

/// The reason why steps became too short.
fn reason_of_underflow(trace: &PathTrace<'_>) -> StopReason {
    let stretch = trace.structure.smallest_stretch(&trace.at.here.state.displacement);
    if stretch < COLLAPSED { StopReason::CollapsedBar } else { StopReason::StepUnderflow }
}

/// Work, dissipation and strain energy of the increment to the end of a step.
fn balance(trace: &PathTrace<'_>, rate: &Rate, step_end: &StepEnd) -> StepBalance {
    let (reached, start) = (&step_end.reached, (&trace.at.here.state, rate));
    let end = (&reached.corrected.state, &reached.rate);
    let (loading, modes, turned) = (trace.loading(), &trace.at.here.modes, rate.angle(&reached.rate));
    let work = work_and_dissipation::work_and_dissipation(loading, modes, start, end, turned);
    let IncrementWork { external, dissipated, largest_part: largest_work, of_pattern } = work;
    let strain = trace.structure.strain_energy(&reached.corrected.state.displacement) - trace.initial_strain;
    let (step, force_scale) = (reached.step, reached.corrected.force_scale);
    let work_of_pattern = of_pattern;
    // No contact slides against friction where changes are treated together: the work equals the change of stored
    // energy. The kinks of such a step are irrelevant to the length of the next.
    let (external_work, turned) = match &step_end.joined {
        Some(joined) => (strain - trace.at.totals.energy.strain, rate.angle(&joined.unchanged)),
        None => (external, turned),
    };
    let added = Added { step, external_work, largest_work, work_of_pattern, dissipated, strain, force_scale };
    StepBalance { added, turned, mode_named: None }
}

/// Factor of the next step where the curvature of the path grows: it is predicted to grow as it did from the step
/// before to the present one (predictive control: K. Gustafsson, ACM Trans. Math. Softw. 20 (1994) 496,
/// doi:10.1145/198429.198437).
fn factor_foreseen(trace: &PathTrace<'_>, rate: &Rate, length: f64, turned: f64, tried: f64) -> f64 {
    let here = &trace.at.here;
    let before = here.before.as_ref().filter(|_| length > 0.0);
    let curvature_before = before.map(|before| unit(&before.rate).angle(rate) / -before.place);
    let Some(curvature_before) = curvature_before.filter(|curvature| *curvature > 0.0) else {
        return f64::INFINITY;
    };
    let curvature = turned / length;
    let growth = (curvature / curvature_before).min(LARGEST_CURVATURE_GROWTH);
    if growth <= 1.0 {
        return f64::INFINITY;
    }
    quantised((TARGET_TURN / (curvature * growth * tried)).max(0.2))
}

/// Factor of the next step by the path's turn, Newton's iterations and the energy balance.
fn next_step_factor(
    trace: &PathTrace<'_>,
    end: &StepEnd,
    balance: &StepBalance,
    tried: f64,
    was_shortened: bool,
) -> f64 {
    let (reached, added) = (&end.reached, &balance.added);
    let done = (reached.step / tried).clamp(0.1, 1.0);
    let turn = balance.turned / done;
    let by_turn = TARGET_TURN / turn.max(1e-3 * TARGET_TURN);
    let by_work = TARGET_ITERATIONS / reached.corrected.iterations_to_small.max(1) as f64;
    let imbalance = (added.external_work - added.dissipated - (added.strain - trace.at.totals.energy.strain)).abs();
    // Where hardly any energy is stored, the effect of round-off in the displacements and in the gaps on the work says
    // nothing about the step.
    let modes = trace.at.here.modes.iter().zip(trace.loading().contacts).filter(|(mode, _)| mode.is_active());
    let of_gaps = modes.map(|(_, contact)| contact.rounding()).fold(0.0, f64::max);
    let rounding =
        trace.at.totals.force_scale.max(reached.corrected.force_scale) * (WORK_ROUND_OFF * reached.step + of_gaps);
    let imbalance = if imbalance <= rounding { 0.0 } else { imbalance };
    let floor =
        (ENERGY_ROUND_OFF * trace.at.totals.force_scale.max(reached.corrected.force_scale)).max(f64::MIN_POSITIVE);
    // Forces that move against each other may exchange far more energy than the structure stores, as where a node is
    // driven along an obstacle onto which a force presses it: the error is that of the energy exchanged.
    let exchanged = added.external_work.abs().max(added.largest_work);
    let size = trace.at.totals.largest_energy.max(exchanged).max(added.strain.abs()).max(floor);
    // Next to stiff elements round-off limits the accuracy of the forces: the energy stored in soft elements alone may
    // be smaller than its effect, whatever the step. A short step is therefore not shortened any further.
    let by_stiffness = || {
        let of_forces = trace.structure.rounding(&reached.corrected.state.displacement);
        reached.step * of_forces.iter().fold(0.0_f64, |most, value| value.max(most))
    };
    let is_too_large = imbalance > TARGET_IMBALANCE * size;
    let is_none = is_too_large && reached.step <= SHORT_STEP && imbalance <= by_stiffness();
    let imbalance = if is_none { TARGET_IMBALANCE * size } else { imbalance };
    let forces = trace.at.totals.force_scale.max(reached.corrected.force_scale);
    let none = UNSTRESSED_MULTIPLE * trace.structure.largest_rounding(&reached.corrected.state.displacement);
    let imbalance = if forces <= none { 0.0 } else { imbalance };
    // The balance of one increment has an error of fifth order in its arc length.
    let by_energy = (TARGET_IMBALANCE / (imbalance / size).max(1e-3 * TARGET_IMBALANCE)).powf(0.2);
    // A step cut short by an event says little about a longer one in the mode that follows. After a step that was too
    // long the next is not lengthened either (E. Hairer, S. P. Nørsett, G. Wanner, Solving Ordinary Differential
    // Equations I, Springer 1993, section II.4).
    let most = if done < SMALLEST_COMPLETED_SHARE || was_shortened { 1.0 } else { LARGEST_STEP_GROWTH };
    quantised(by_turn.min(by_work).min(by_energy).clamp(0.2, most))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::check::scenes;
    use crate::continuation::path_state::resumable_state::Progress;
    use crate::continuation::scene::Scene;
    use crate::model::request::ArcLength;
    use crate::resources::cancel::CancelFlag;

    fn scene(change: impl Fn(&mut ArcLength)) -> Scene {
        let built_in = scenes::find("one-bar-truss").expect("a scene");
        let mut request = crate::model::decode::decode(built_in.request.as_bytes()).expect("a request");
        change(&mut request.analysis.arc_length);
        Scene::new(&request).expect("a scene")
    }

    /// The number of steps of a length, up to a hundred, after which the path is given up.
    fn given_up_after(scene: &Scene, step: f64) -> Option<u64> {
        let mut trace = PathTrace::at(scene, Progress::new(scene), 0.0, CancelFlag::default());
        (1..=100).find(|_| reason_of_creep(&mut trace, step, false).is_some())
    }

    #[test]
    fn steps_that_change_nothing_end_the_path_within_fifty() {
        let plain = scene(|_| {});
        assert_eq!(given_up_after(&plain, 2e-9), Some(MOST_CREEPING));
        const { assert!(MOST_CREEPING < 50) };
        assert_eq!(given_up_after(&plain, 1e-7), None);
        // Steps no shorter than requested, or shorter only because of larger scales, do not creep.
        let short = |arc_length: &mut ArcLength| {
            (arc_length.min, arc_length.initial, arc_length.max) = (1e-10, 1e-8, 1e-8);
        };
        assert_eq!(given_up_after(&scene(short), 5e-9), None);
        assert_eq!(given_up_after(&scene(|arc_length| arc_length.displacement_scale = Some(1e8)), 2e-9), None);
        assert_eq!(given_up_after(&scene(|arc_length| arc_length.load_scale = Some(1e8)), 2e-9), None);
    }

    #[test]
    fn a_contact_change_is_progress() {
        let scene = scene(|_| {});
        let mut trace = PathTrace::at(&scene, Progress::new(&scene), 0.0, CancelFlag::default());
        for step in 1..=1000 {
            assert_eq!(reason_of_creep(&mut trace, 1e-9, step % 40 == 0), None);
        }
    }
}
