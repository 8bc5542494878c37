//! The direction for one sign of the load rate, or of the load's power, by block pivoting over the modes of the contacts.

use crate::algebra::SystemFactorisation;
use crate::algebra::dense::matrix_sink::Sink;
use crate::branching::directions::arrival_tangent::Incoming;
use crate::branching::directions::candidate::{Alternative, CandidateDirection};
use crate::branching::directions::tolerances::WEAK_MARGIN;
use crate::branching::uniqueness::sparse_uniqueness::proof::DistinguishingQuantity;
use crate::branching::uniqueness::sparse_uniqueness::sparse_rate_equations::{ChangingContact, Equations};
use crate::complementarity::rates::block_pivoting::{self, RoundResult, Rounds};
use crate::complementarity::rates::rate_problem::velocity_scale;
use crate::complementarity::rates::tolerances::DOUBTFUL_RATE;
use crate::mechanics::contact::vector::{Vector, dot, scaled};
use crate::mechanics::contact::{Mode, Reaction, all_continue};
use crate::mechanics::equations::{Kind, ModeSystem, mode_factorisation, rate_recovery};
use crate::mechanics::problem::node_contact_forces::whole_rates;
use crate::mechanics::problem::state::Rate;
use crate::step::corrector::cached_factorisation::CachedFactorisation;

/// Where the equations have one solution for each right-hand side, the second kind of rounds finds it.
const ROUNDS: Rounds = Rounds { in_blocks: 16, one_by_one: 48 };

/// A contact whose mode only a finite step can decide.
pub(super) struct Doubt {
    contact: usize,
    /// Direction in which the contact may slip, if it is on its cone.
    direction: Option<Vector>,
    /// The nonnegative quantity of its mode is exactly zero at first order, not only nearly.
    weak: bool,
}

/// The direction with a given sign of the control, by block pivoting.
pub(super) fn solve(
    equations: &Equations<'_>,
    control: DistinguishingQuantity,
    sign: f64,
    incoming: Option<Incoming<'_>>,
) -> Option<CandidateDirection> {
    let mut first = equations.held.clone();
    if incoming.is_some_and(|incoming| value_of(equations, control, incoming.rate) * sign > 0.0) {
        for one in &equations.changing {
            first[one.contact] = one.direction.map_or(first[one.contact], |direction| Mode::Slip { direction });
        }
    }
    let examine = |modes: &Vec<Mode>| {
        let (mut rate, by) = rate_in(equations, control, sign, incoming, modes)?;
        let value = value_of(equations, control, &rate);
        if value.abs() <= WEAK_MARGIN * equations.largest_load() * rate.size()
            && control == DistinguishingQuantity::Power
        {
            return None;
        }
        rate.scale(sign * value.signum());
        let (changes, doubts) = violations(equations, modes, &rate);
        if !changes.is_empty() {
            return Some(RoundResult::Violated(changes));
        }
        let cached = by.map(|by| CachedFactorisation::of(equations.loading, by)).unwrap_or_default();
        let candidate = candidate(equations, rate, modes.clone(), doubts);
        // The modes of contacts in doubt are not those of the factorisation.
        Some(RoundResult::Solved(if candidate.weak { candidate } else { CandidateDirection { cached, ..candidate } }))
    };
    let change = |modes: &mut Vec<Mode>, changes: Vec<(usize, Mode)>| {
        changes.into_iter().for_each(|(contact, mode)| modes[contact] = mode);
        Some(())
    };
    block_pivoting::block_pivot(first, ROUNDS, examine, change)
}

/// The direction of some sign in these modes, and the factorisation with which it was found: along which nothing moves,
/// or along which the path arrives, where these modes allow it, else by the equations.
fn rate_in(
    equations: &Equations<'_>,
    control: DistinguishingQuantity,
    sign: f64,
    incoming: Option<Incoming<'_>>,
    modes: &[Mode],
) -> Option<(Rate, Option<SystemFactorisation>)> {
    match (control, incoming) {
        (DistinguishingQuantity::Load, _) if modes == equations.held && may_rest(equations) => {
            rest(equations, sign).map(|rate| (rate, None))
        }
        (_, Some(incoming)) if incoming.modes.is_some_and(|of| all_continue(of, modes)) => {
            Some((incoming.rate.clone(), None))
        }
        (DistinguishingQuantity::Power, Some(incoming)) => line(equations, modes, Some(incoming.rate)),
        _ => None,
    }
    .or_else(|| line(equations, modes, None))
}

/// The load on each column, and whether the column belongs to a contact on its cone.
fn loads(equations: &Equations<'_>) -> impl Iterator<Item = (f64, bool)> {
    let mut is_cone = vec![false; equations.size];
    equations.changing.iter().filter(|one| one.direction.is_some()).for_each(|one| is_cone[one.column] = true);
    equations.load().into_iter().zip(is_cone)
}

/// Whether nothing moves where all contacts stick that can.
fn may_rest(equations: &Equations<'_>) -> bool {
    loads(equations).all(|(load, is_cone)| load == 0.0 || is_cone)
}

/// The directions along which nothing moves and the load alone changes.
pub(super) fn at_rest(equations: &Equations<'_>) -> Vec<CandidateDirection> {
    let zero = WEAK_MARGIN * equations.largest_load();
    let rests = |sign: f64| {
        if !loads(equations).all(|(load, is_cone)| load.abs() <= zero || (is_cone && load * sign < 0.0)) {
            return None;
        }
        let rate = rest(equations, sign)?;
        let (changes, doubts) = violations(equations, &equations.held, &rate);
        changes.is_empty().then(|| candidate(equations, rate, equations.held.clone(), doubts))
    };
    [1.0, -1.0].into_iter().filter_map(rests).collect()
}

/// The rate without motion, at which the load on each closed contact grows with the load factor; solved for where
/// supports carry part of it.
fn rest(equations: &Equations<'_>, sign: f64) -> Option<Rate> {
    let (loading, structure) = (equations.loading, equations.loading.structure);
    // Each contact of these equations has its own node.
    let freedoms = |contact: usize| {
        loading.contacts[contact].kinematics.node().map_or(0..0, |node| structure.translations_of(node))
    };
    let mut closed = (0..equations.held.len()).filter(|contact| equations.held[*contact] != Mode::Free);
    let shares = closed.any(|contact| freedoms(contact).any(|freedom| structure.unknown_of[freedom].is_none()));
    if shares || loading.pattern.moves_boundary() {
        let (mut rate, _) = line(equations, &equations.held, None)?;
        rate.scale(sign * rate.load.signum());
        return Some(rate);
    }
    let reaction = |(contact, mode): (usize, &Mode)| {
        if *mode == Mode::Free {
            return Reaction::default();
        }
        let mut force = [0.0; 3];
        let loads = &loading.pattern.forces[freedoms(contact)];
        force.iter_mut().zip(loads).for_each(|(force, load)| *force = -sign * load);
        loading.taken_by(contact, equations.state, &force)
    };
    let reactions = equations.held.iter().enumerate().map(reaction).collect();
    Some(Rate { displacement: vec![0.0; loading.structure.freedoms()], load: sign, reactions })
}

/// Sort key in the order in which a search lists candidates: stuck where possible, the first contact varying fastest.
pub(super) fn order(equations: &Equations<'_>, candidate: &CandidateDirection) -> Vec<u8> {
    let rank = |one: &ChangingContact| match (candidate.modes[one.contact], one.direction) {
        (Mode::Stick, _) => 0,
        (Mode::Slip { direction }, None) if dot(&direction, &one.frame.tangents[0]) < 0.0 => 2,
        (Mode::Slip { .. }, _) => 1,
        (Mode::Free, _) => 3,
    };
    equations.changing.iter().rev().map(rank).collect()
}

fn value_of(equations: &Equations<'_>, control: DistinguishingQuantity, rate: &Rate) -> f64 {
    match control {
        DistinguishingQuantity::Load => rate.load,
        DistinguishingQuantity::Power => equations.power(&equations.columns_of(rate)),
    }
}

/// The direction, of either sign, that a mode allows, and the factorisation with which it was found; the equations are
/// bordered by another direction or by the load rate.
fn line(
    equations: &Equations<'_>,
    modes: &[Mode],
    border: Option<&Rate>,
) -> Option<(Rate, Option<SystemFactorisation>)> {
    let system = ModeSystem::new(equations.loading, modes, equations.state);
    let iterate = system.iterate(equations.state.clone());
    let by_load = |matrix: &mut dyn Sink| matrix.add(system.size() - 1, equations.loading.structure.unknowns(), 1.0);
    let factorisation = match border {
        Some(border) => mode_factorisation::factorise_bordered(&system, &iterate, border)?,
        None => mode_factorisation::factorise(&system, &iterate, Kind::Rates, by_load)?,
    };
    let rate = rate_recovery::tangent_by(&system, &factorisation, &iterate)?;
    Some((rate, Some(factorisation)))
}

/// The contacts with a negative quantity among those that must not be, in their order, with the modes to try next; and
/// the contacts at which the quantity is zero, exactly or nearly.
fn violations(equations: &Equations<'_>, modes: &[Mode], rate: &Rate) -> (Vec<(usize, Mode)>, Vec<Doubt>) {
    let largest = rate.largest_reaction().max(f64::MIN_POSITIVE);
    let (mut changes, mut doubts) = (Vec::new(), Vec::new());
    for one in &equations.changing {
        let (margin, other) = margin(equations, one, modes[one.contact], rate, largest);
        if margin < -WEAK_MARGIN {
            changes.push((one.contact, other));
        } else if margin <= DOUBTFUL_RATE {
            doubts.push(Doubt { contact: one.contact, direction: one.direction, weak: margin <= WEAK_MARGIN });
        }
    }
    changes.sort_unstable_by_key(|(contact, _)| *contact);
    (changes, doubts)
}

/// For each contact that can change, whether the nonnegative quantity of its mode is positive beyond round-off.
pub(super) fn strict(equations: &Equations<'_>, candidate: &CandidateDirection) -> Vec<bool> {
    let rate = &candidate.rate;
    let largest = rate.largest_reaction().max(f64::MIN_POSITIVE);
    let is_strict =
        |one: &ChangingContact| margin(equations, one, candidate.modes[one.contact], rate, largest).0 > WEAK_MARGIN;
    equations.changing.iter().map(is_strict).collect()
}

/// The smallest of the nonnegative quantities of a mode, each relative to its scale, where rates of force are at most
/// `largest`, and the mode to try where it is negative.
fn margin(equations: &Equations<'_>, one: &ChangingContact, mode: Mode, rate: &Rate, largest: f64) -> (f64, Mode) {
    let (reaction, data) = (&rate.reactions[one.contact], &equations.loading.contacts[one.contact]);
    let force = |value: f64| value / largest;
    let speed = |direction: &Vector, column: usize| {
        let speed = dot(direction, &equations.loading.relative_rate(one.contact, equations.state, rate));
        speed / velocity_scale(largest / equations.stiffness(column))
    };
    match (mode, one.direction) {
        (Mode::Stick, Some(direction)) => (force(data.friction.slack(reaction, &direction)), Mode::Slip { direction }),
        (Mode::Slip { .. }, Some(direction)) => (speed(&direction, one.column), Mode::Stick),
        (Mode::Stick, None) => {
            let traction = dot(&reaction.tangential, &one.frame.tangents[0]);
            let against = scaled(&one.frame.tangents[0], if traction > 0.0 { -1.0 } else { 1.0 });
            let other = if reaction.normal < 0.0 { Mode::Free } else { Mode::Slip { direction: against } };
            (force(data.friction.bound(reaction.normal) - traction.abs()), other)
        }
        (Mode::Slip { .. }, None) if data.tangents() == 0 => (force(reaction.normal), Mode::Free),
        (Mode::Slip { direction }, None) => {
            let other = if reaction.normal < 0.0 { Mode::Free } else { Mode::Stick };
            (speed(&direction, one.column).min(force(reaction.normal)), other)
        }
        (Mode::Free, _) => {
            let closed = if data.tangents() > 0 { Mode::Stick } else { Mode::Slip { direction: [0.0; 3] } };
            // Of a touching contact the column of the tangential velocity comes first.
            (speed(&one.frame.normal, one.column + usize::from(one.direction.is_none())), closed)
        }
    }
}

/// The candidate with alternatives for the contacts that may be in another mode, exactly or nearly at first order;
/// these stick where they can.
pub(super) fn candidate(
    equations: &Equations<'_>,
    rate: Rate,
    mut modes: Vec<Mode>,
    doubts: Vec<Doubt>,
) -> CandidateDirection {
    let weak = doubts.iter().any(|doubt| doubt.weak);
    let mut alternatives: Vec<Vec<Alternative>> = Vec::with_capacity(doubts.len());
    for doubt in &doubts {
        let Some(direction) = doubt.direction else { continue };
        if doubt.weak {
            modes[doubt.contact] = Mode::Stick;
        }
        alternatives.push(vec![vec![(doubt.contact, Mode::Stick)], vec![(doubt.contact, Mode::Slip { direction })]]);
    }
    let dissipation = equations.changing.iter().map(|one| {
        let slips = matches!(modes[one.contact], Mode::Slip { .. });
        let traction = &equations.state.reactions[one.contact].tangential;
        if slips { -dot(traction, &equations.loading.relative_rate(one.contact, equations.state, &rate)) } else { 0.0 }
    });
    let dissipation = dissipation.sum();
    let forces = whole_rates(equations.loading, equations.state, &rate);
    CandidateDirection { rate, forces, modes, alternatives, weak, dissipation, cached: CachedFactorisation::default() }
}
