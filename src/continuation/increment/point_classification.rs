//! Classification of a point, and the continuation of the path from it.

use crate::branching::bifurcation::locate::Crossing;
use crate::branching::bifurcation::{branch_directions, simultaneous_limit_points};
use crate::branching::directions::arrival_tangent::Incoming;
use crate::branching::directions::candidate::{FoundDirections, is_mechanism};
use crate::branching::directions::feasible_direction::{self, DirectionChoice, PriorMotion};
use crate::branching::directions::trial_step::later_sign;
use crate::branching::selection::{second_order, selection_rule};
use crate::branching::uniqueness::all_slipping::all_slipping_directions;
use crate::continuation::increment::mpec_verification;
use crate::continuation::increment::tolerances::SIMULTANEOUS_LENGTH;
use crate::continuation::path_state::event_descriptions::describe_change;
use crate::continuation::path_state::path_context::PathTrace;
use crate::continuation::path_state::tolerances::{REACTION_ROUND_OFF, SAME_STATE};
use crate::continuation::path_state::visited_states;
use crate::mechanics::contact::{Mode, Reaction};
use crate::mechanics::multi_contact::changeable_contacts::Standing;
use crate::mechanics::multi_contact::moving_planes::Carried;
use crate::mechanics::problem::node_contact_forces;
use crate::mechanics::problem::state::Rate;
use crate::mechanics::problem::tolerances::CONTACT_TOLERANCE;
use crate::model::request::Method;
use crate::result::increment::{Point, PointKind};
use crate::result::stop_reason::StopReason;
use crate::step::corrector::cached_factorisation::CachedFactorisation;
use crate::step::event_functions::EventFunction;

/// A classified point and the continuation of the path.
pub(crate) struct Arrival {
    pub point: Point,
    pub options: Vec<DirectionChoice>,
    pub taken: Option<usize>,
    pub stop: Option<StopReason>,
    pub stage_ends: bool,
    /// The program was solved for the direction taken and does not confirm its mode.
    pub unconfirmed: bool,
}

/// The end of a step as the path arrives at it.
pub(crate) struct Came {
    /// The path's direction at the end of the step.
    pub rate: Rate,
    /// Arc length of the step.
    pub step: f64,
    /// See [`Incoming`].
    pub stopped: Option<usize>,
    pub nearby: CachedFactorisation,
    /// See [`Reached`](crate::step::mode_step::Reached).
    pub motions: usize,
}

/// Classifies a point and determines the continuation of the path: along the incoming direction, unless another is
/// taken.
pub(crate) fn classify(
    trace: &mut PathTrace<'_>,
    event: Option<EventFunction>,
    crossing: Option<Crossing>,
    came: Came,
) -> Arrival {
    let arrival = arrive(trace, event, crossing, &came);
    trace.at.here.rate.get_or_insert(came.rate);
    arrival
}

fn arrive(trace: &mut PathTrace<'_>, event: Option<EventFunction>, crossing: Option<Crossing>, came: &Came) -> Arrival {
    let incoming = &came.rate;
    match event {
        None | Some(EventFunction::End(_)) if let Some(crossing) = crossing => {
            let mut work = trace.at.totals.work;
            let arrival = work.at_bifurcation(|_| smooth_bifurcation(trace, crossing, incoming, event.is_some()));
            trace.at.totals.work = work;
            arrival
        }
        None | Some(EventFunction::End(_)) => {
            let stage_ends = event.is_some();
            look_around(trace, incoming, PointKind::Regular, None, None, stage_ends)
        }
        Some(EventFunction::LoadRate { sign }) => {
            trace.at.here.load_sign = -sign;
            trace.at.counts.limit_points += 1;
            let falls = trace.scene.stages[trace.at.stage].falls();
            let what = if (sign > 0.0) != falls { "load maximum" } else { "load minimum" };
            if came.motions > 1 {
                return common_limit(trace, what, sign, came);
            }
            look_around(trace, incoming, PointKind::SmoothLimit, Some(what.to_owned()), Some(-sign), false)
        }
        Some(EventFunction::SurfaceEnd(contact)) => {
            let names = trace.names().nth(contact);
            let event = names.map(|(node, surface)| format!("{node} on {surface}: at the end of the surface"));
            let stop = Some(StopReason::SurfaceEnd);
            let point = Point::plain(PointKind::End, event);
            Arrival { point, options: Vec::new(), taken: None, stop, stage_ends: false, unconfirmed: false }
        }
        // The mode continues: the node is still held in its corner, by a force at which it may slide again.
        Some(EventFunction::Return { .. }) => look_around(trace, incoming, PointKind::Regular, None, None, false),
        Some(
            EventFunction::Gap(_)
            | EventFunction::Normal(_)
            | EventFunction::Cone { .. }
            | EventFunction::Sliding(_)
            | EventFunction::Facet { .. },
        ) => contact_change(trace, came),
        Some(EventFunction::Slide { .. } | EventFunction::Hold { .. }) => contact_change(trace, came),
    }
}

/// The end of a step in which contacts have changed together, from the modes `old`: no contact can change at this
/// point.
pub(crate) fn joined_changes(trace: &mut PathTrace<'_>, old: &[Mode], changes: u64, incoming: Rate) -> Arrival {
    trace.at.here.rate = Some(incoming);
    trace.at.counts.contact_changes += changes;
    let standings = trace.standings(&trace.at.here.state);
    let event = describe_change(trace.names(), old, Some(&trace.at.here.modes), &standings);
    let point = Point::plain(PointKind::ContactChange, Some(event));
    Arrival { point, options: Vec::new(), taken: None, stop: None, stage_ends: false, unconfirmed: false }
}

/// Directions at a point where the mode continues.
fn look_around(
    trace: &PathTrace<'_>,
    incoming: &Rate,
    kind: PointKind,
    event: Option<String>,
    sign: Option<f64>,
    stage_ends: bool,
) -> Arrival {
    let standings = trace.standings(&trace.at.here.state);
    let mut point = Point::plain(kind, event);
    let settled = standings.iter().all(|standing| matches!(standing, Standing::Settled(_)));
    if settled {
        return Arrival { point, options: Vec::new(), taken: None, stop: None, stage_ends, unconfirmed: false };
    }
    let rules = trace.rules();
    let (loading, here) = (trace.loading(), &trace.at.here);
    let before = PriorMotion::Incoming(Incoming::along(incoming));
    let told = if here.is_singular {
        // First order is inconclusive for parts that remain at their fold.
        let (state, force_scale) = (&here.state, rules.force_scale);
        let at = branch_directions::SingularPoint { loading, state, standings: &standings, force_scale };
        second_order::directions(at, before)
    } else {
        None
    };
    let at_once = || all_slipping_directions(loading, &here.state, &standings, &here.modes, incoming, rules);
    let (options, found) = if let Some(branch_directions::SecondOrderFindings { options, unclear }) = told {
        (options, FoundDirections { degenerate: unclear, ..FoundDirections::default() })
    } else if let Some(options) = at_once() {
        (options, FoundDirections::default())
    } else {
        selection_rule::list(loading, &here.state, &standings, before, rules)
    };
    let taken = options.iter().position(|option| option.rate.product(incoming) > 1.0 - 1e-9);
    // A load rate too small to have a sign of its own keeps its previous sign.
    let has_sign = taken.is_none_or(|taken| options[taken].load_sign != 0.0) || here.load_sign == 0.0;
    let sign = sign.or_else(|| (!has_sign).then_some(here.load_sign));
    point.bifurcation = feasible_direction::is_bifurcation(&options, taken, sign);
    point.unexplored_modes = found.unexplored;
    point.degenerate = found.degenerate || options.len() % 2 == 1 || taken.is_none();
    if let Some(taken) = taken {
        let kept = options[taken].dissipation;
        let tolerance = 1e-8 * rules.force_scale;
        point.better_direction = options.iter().any(|option| !option.retrace && option.dissipation > kept + tolerance);
    }
    // Where directions of slip have become parallel, what moves on moves without end.
    let moves_freely = kind == PointKind::Regular && !stage_ends && is_mechanism(loading, &here.state, incoming);
    let stop = moves_freely.then_some(StopReason::Mechanism);
    Arrival { point, options, taken, stop, stage_ends, unconfirmed: false }
}

/// A limit point shared by several motions: the path continues in its own direction, the others are listed.
fn common_limit(trace: &PathTrace<'_>, what: &str, sign: f64, came: &Came) -> Arrival {
    let (loading, here, rules) = (trace.loading(), &trace.at.here, trace.rules());
    let (incoming, state) = (&came.rate, &here.state);
    let standings = trace.standings(state);
    let at = branch_directions::SingularPoint { loading, state, standings: &standings, force_scale: rules.force_scale };
    let most = rules.effort.most_modes;
    let found = simultaneous_limit_points::directions(at, &here.modes, incoming, came.motions, most)
        .unwrap_or_else(|| branch_directions::branches(at, &here.modes, incoming, came.motions - 1, None));
    let branch_directions::Branches { mut options, mut degenerate, mut unexplored } = found;
    if !standings.iter().all(|standing| matches!(standing, Standing::Settled(_))) {
        // Directions along which the load changes at first order.
        let before = PriorMotion::Incoming(Incoming::along(incoming));
        let (others, listed) = selection_rule::list(loading, state, &standings, before, rules);
        options.extend(others.into_iter().filter(|other| feasible_direction::sign_of(other.rate.load) != 0.0));
        unexplored = unexplored.saturating_add(listed.unexplored);
    }
    options.iter_mut().for_each(|option| option.retrace = false);
    feasible_direction::mark_retrace(loading, state, &mut options, incoming);
    let taken = options.iter().position(|option| option.rate.product(incoming) > 1.0 - 1e-9);
    degenerate |= options.len() % 2 == 1 || taken.is_none();
    let kept = taken.map_or(0.0, |taken| options[taken].dissipation) + 1e-8 * rules.force_scale;
    let point = Point {
        kind: PointKind::SmoothLimit,
        bifurcation: feasible_direction::is_bifurcation(&options, taken, Some(-sign)),
        event: Some(format!("{what} of {} motions at once", came.motions)),
        better_direction: options.iter().any(|option| !option.retrace && option.dissipation > kept),
        unexplored_modes: unexplored,
        degenerate,
    };
    Arrival { point, options, taken, stop: None, stage_ends: false, unconfirmed: false }
}

/// A smooth bifurcation, where an eigenvalue crosses zero within the mode: the path continues in its own direction, the
/// branches are listed.
fn smooth_bifurcation(trace: &mut PathTrace<'_>, crossing: Crossing, incoming: &Rate, stage_ends: bool) -> Arrival {
    if crossing.eigenvalues == 0 {
        return undetermined(trace);
    }
    let rules = trace.rules();
    let standings = trace.standings(&trace.at.here.state);
    let modes = &trace.at.here.modes;
    let here = branch_directions::SingularPoint {
        loading: trace.loading(),
        state: &trace.at.here.state,
        standings: &standings,
        force_scale: rules.force_scale,
    };
    let nulls = crossing.nulls.as_deref();
    let mut found = if crossing.grazing {
        let loose: Vec<Mode> = modes
            .iter()
            .zip(&standings)
            .map(|(mode, standing)| if *standing == Standing::Touching { Mode::Free } else { *mode })
            .collect();
        let mut found = branch_directions::branches(here, &loose, incoming, crossing.eigenvalues, nulls);
        // The continuation and its reverse keep their modes.
        let own = found.options.iter_mut().filter(|option| {
            option.rate.product(incoming).abs()
                > crate::branching::bifurcation::branch_directions::tolerances::COINCIDENCE_COSINE
        });
        own.for_each(|option| option.modes.clone_from(modes));
        found
    } else {
        branch_directions::branches(here, modes, incoming, crossing.eigenvalues, nulls)
    };
    if !standings.iter().all(|standing| matches!(standing, Standing::Settled(_))) {
        // Other modes of the contacts that can change; the current mode, singular here, is covered by the branches.
        let before = PriorMotion::Incoming(Incoming::along(incoming));
        let (others, listed) = selection_rule::list(trace.loading(), &trace.at.here.state, &standings, before, rules);
        // The null vectors of loosened modes are over other unknowns.
        let nulls = nulls.filter(|_| !crossing.grazing);
        let is_singular = |nulls| branch_directions::are_singular_in_all_modes(here, modes, nulls);
        if (listed.degenerate && others.is_empty()) || nulls.is_some_and(is_singular) {
            branch_directions::in_other_modes(here, modes, nulls, &mut found);
        } else {
            let known = |other: &DirectionChoice| {
                other.modes == *modes
                    || found.options.iter().any(|one| {
                        one.rate.product(&other.rate)
                            > crate::branching::bifurcation::branch_directions::tolerances::COINCIDENCE_COSINE
                    })
            };
            let others: Vec<DirectionChoice> = others.into_iter().filter(|other| !known(other)).collect();
            found.options.extend(others);
            found.unexplored = listed.unexplored;
        }
        found.degenerate |= listed.mechanism;
    }
    let branch_directions::Branches { options, degenerate, unexplored } = found;
    let kept = options[0].dissipation + 1e-8 * rules.force_scale;
    let point = Point {
        kind: PointKind::SmoothBifurcation,
        bifurcation: feasible_direction::is_bifurcation(&options, Some(0), None),
        event: Some(match crossing.eigenvalues {
            1 => "one eigenvalue crosses zero".to_owned(),
            2 => "two eigenvalues cross zero together".to_owned(),
            count => format!("{count} eigenvalues cross zero together"),
        }),
        better_direction: options.iter().any(|option| !option.retrace && option.dissipation > kept),
        unexplored_modes: unexplored,
        degenerate: degenerate || options.len() % 2 == 1,
    };
    Arrival { point, options, taken: Some(0), stop: None, stage_ends, unconfirmed: false }
}

/// An indeterminate direction: the ratio of slip and load rate is arbitrary, and a family of paths leaves.
fn undetermined(_trace: &PathTrace<'_>) -> Arrival {
    let point = Point {
        kind: PointKind::End,
        bifurcation: false,
        event: Some("direction not determined: slip and load rate are free of each other".to_owned()),
        better_direction: false,
        unexplored_modes: 0,
        degenerate: true,
    };
    let stop = Some(StopReason::Degenerate);
    Arrival { point, options: Vec::new(), taken: None, stop, stage_ends: false, unconfirmed: false }
}

/// Reactions that vanish along the incoming direction within the rounding of the event's location vanish there, too. Where a
/// stretch of a beam comes to lie on its obstacle, the reaction at its end vanishes with all of its gaps; these are of
/// second order in the distances of the nodes, and locate the point so much worse.
fn unload_together(trace: &PathTrace<'_>, incoming: &Rate, standings: &mut [Standing]) {
    let (loading, state) = (trace.loading(), &trace.at.here.state);
    for (contact, standing) in standings.iter_mut().enumerate() {
        let is_closed = match standing {
            Standing::Settled(mode) => mode.is_active(),
            Standing::OnCone { .. } => true,
            Standing::Touching | Standing::Cornered { .. } => false,
        };
        // The forces of a node between several obstacles vanish together.
        let is_alone = || !loading.corners.iter().any(|corner| corner.contacts.contains(&contact));
        let vanishes = || state.reactions[contact].normal <= -SIMULTANEOUS_LENGTH * incoming.reactions[contact].normal;
        if is_closed && vanishes() && is_alone() {
            *standing = Standing::Touching;
        }
    }
}

/// A contact has reached the end of its mode: lists the directions and takes one.
fn contact_change(trace: &mut PathTrace<'_>, came: &Came) -> Arrival {
    let Came { rate: incoming, step, stopped, nearby, .. } = came;
    trace.at.counts.contact_changes += 1;
    let mut standings = trace.standings(&trace.at.here.state);
    unload_together(trace, incoming, &mut standings);
    for (reaction, standing) in trace.at.here.state.reactions.iter_mut().zip(&standings) {
        // The event was located to round-off; the remainder of a reaction that is zero there is dropped.
        if *standing == Standing::Touching && reaction.size() <= REACTION_ROUND_OFF * trace.at.totals.force_scale {
            *reaction = Reaction::default();
        }
    }
    let rules = trace.rules();
    let modes = Some(&trace.at.here.modes[..]);
    let is_singular = trace.at.here.is_singular;
    let came = Incoming { rate: incoming, modes, stopped: *stopped, nearby: Some(nearby), is_singular };
    let before = PriorMotion::Incoming(came);
    let mut decision = selection_rule::decide(trace.loading(), &trace.at.here.state, &standings, before, rules);
    // Directions that redistribute a node's force come last: they begin at rest, not with the incoming motion.
    let keeps: Vec<bool> = decision.options.iter().map(|option| keeps_shares(trace, option)).collect();
    if decision.taken.is_some_and(|taken| !keeps[taken]) {
        let rises = |index: usize| !rules.load_rises || decision.options[index].load_sign >= 0.0;
        let open = |index: usize| keeps[index] && rises(index) && !decision.options[index].retrace;
        let best = selection_rule::preferred(&decision.options, incoming, rules, open);
        decision.taken = best.filter(|best| !decision.options[*best].mechanism).or(decision.taken);
    }
    let force_scale = rules.force_scale;
    // The rule decides among the directions, each of which holds over a finite step; the program reports whether it
    // confirms the mode of the direction taken.
    let confirmed = match decision.taken {
        Some(taken) if trace.scene.analysis.method == Method::Mpec && !trace.scene.analysis.skips_certificate() => {
            mpec_verification::is_confirmed_by_program(trace, &decision.options[taken], *step)
        }
        _ => true,
    };
    // By the load rates at the point: where the load turns, it falls along the reverse as it does ahead.
    let mut bifurcation = feasible_direction::is_bifurcation(&decision.options, decision.taken, None);
    if let Some(taken) = decision.taken
        && let choice = &mut decision.options[taken]
        && choice.load_sign == 0.0
    {
        let (loading, state) = (trace.loading(), &trace.at.here.state);
        let later = later_sign(loading, state, &choice.rate, &choice.modes, force_scale);
        choice.load_sign = later.sign;
        if later.is_steady {
            bifurcation = feasible_direction::is_bifurcation(&decision.options, decision.taken, None);
        }
    }
    let old_modes = trace.at.here.modes.clone();
    let old_sign = trace.at.here.load_sign;
    let mut stop = decision.stop;
    trace.take(&mut decision);
    let outgoing = decision.taken.map(|index| &decision.options[index]);
    let mut kind = PointKind::ContactChange;
    if let Some(choice) = outgoing
        && choice.load_sign * old_sign < 0.0
    {
        kind = PointKind::NonsmoothLimit;
        trace.at.counts.limit_points += 1;
    }
    if stop.is_none() && is_cycle(trace) {
        stop = Some(StopReason::Cycle);
    }
    let point = Point {
        kind,
        bifurcation,
        event: Some(describe_change(trace.names(), &old_modes, outgoing.map(|choice| &choice.modes[..]), &standings)),
        better_direction: false,
        unexplored_modes: decision.unexplored,
        degenerate: decision.degenerate,
    };
    Arrival {
        point,
        options: decision.options,
        taken: decision.taken,
        stop,
        stage_ends: false,
        unconfirmed: !confirmed,
    }
}

/// Whether a direction begins with the present reactions. Where a node is carried by planes that move against each
/// other and slips along both, equilibrium determines the reactions; another distribution of its force begins at rest.
fn keeps_shares(trace: &PathTrace<'_>, choice: &DirectionChoice) -> bool {
    let (loading, here) = (trace.loading(), &trace.at.here);
    let (state, zero) = (&here.state, CONTACT_TOLERANCE * trace.rules().force_scale);
    loading.corners.iter().filter(|corner| node_contact_forces::is_in_plane(loading, corner)).all(|corner| {
        let closed = corner.closed(loading, state);
        let slips = |contact: &usize| matches!(here.modes[*contact], Mode::Slip { .. });
        // A sticking contact pressed by another may keep its share of the force.
        let any_share = closed.iter().any(|contact| choice.modes[*contact] == Mode::Stick)
            && closed.iter().all(|contact| choice.modes[*contact].is_active());
        match Carried::of(loading, &closed, state) {
            Some(carried) if closed.iter().all(slips) && !any_share => {
                let force = node_contact_forces::total_force(loading, closed.iter().copied(), state);
                let begins = carried.reactions(loading, &choice.modes, &force, state);
                closed
                    .iter()
                    .zip(&begins)
                    .all(|(contact, begins)| begins.difference(&state.reactions[*contact]) <= zero)
            }
            _ => true,
        }
    })
}

/// Whether the path has left the same state in the same modes before; otherwise records the state.
fn is_cycle(trace: &mut PathTrace<'_>) -> bool {
    let here = trace.visit();
    let force = SAME_STATE * trace.at.totals.force_scale;
    let known = trace.at.visited.states().any(|visited| visited.is(&here, SAME_STATE, force));
    trace.at.visited.remember(here, visited_states::room(trace.scene));
    known
}
