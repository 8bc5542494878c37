//! What a point turned out to be, and how the path goes on from it.

use super::at_hand::AtHand;
use super::branches;
use super::carried::Carried;
use super::common_limit;
use super::confirm::later_sign;
use super::corner;
use super::critical::Crossing;
use super::decide::{self, Before, Choice};
use super::directions::Found;
use super::going_on::directions_going_on;
use super::history;
use super::incoming::Incoming;
use super::increment::{Point, PointKind};
use super::name_event::describe_change;
use super::second_order;
use super::standing::{Standing, ZERO};
use super::state::Rate;
use super::stop::StopReason;
use super::tracer::Path;
use super::watch::Watch;
use crate::contact::{Mode, Reaction};
use crate::model::request::Method;

/// States closer than this are one.
pub(super) const SAME_STATE: f64 = 1e-9;
/// A reaction this small against the largest force so far is what the location of its zero left over.
pub(super) const ROUND_OFF: f64 = 1e-14;

/// What a point turned out to be.
pub(super) struct Arrival {
    pub point: Point,
    pub options: Vec<Choice>,
    pub taken: Option<usize>,
    pub stop: Option<StopReason>,
    pub stage_ends: bool,
    /// The program was asked for the direction taken and does not name its mode.
    pub unconfirmed: bool,
}

/// How a step came to its end.
pub(super) struct Came {
    /// The path's direction there.
    pub rate: Rate,
    /// Its arc length.
    pub step: f64,
    /// See [`Incoming`].
    pub stopped: Option<usize>,
    pub nearby: AtHand,
    /// See [`Reached`](super::advance::Reached).
    pub motions: usize,
}

impl Path<'_> {
    /// What kind of point this is, and how the path goes on: along the direction in which it came, if no other is taken.
    pub(super) fn classify(&mut self, event: Option<Watch>, crossing: Option<Crossing>, came: Came) -> Arrival {
        let arrival = self.arrive(event, crossing, &came);
        self.at.here.rate.get_or_insert(came.rate);
        arrival
    }

    fn arrive(&mut self, event: Option<Watch>, crossing: Option<Crossing>, came: &Came) -> Arrival {
        let incoming = &came.rate;
        match event {
            None | Some(Watch::End(_)) if let Some(crossing) = crossing => {
                let mut work = self.at.totals.work;
                let arrival = work.at_bifurcation(|_| self.smooth_bifurcation(crossing, incoming, event.is_some()));
                self.at.totals.work = work;
                arrival
            }
            None | Some(Watch::End(_)) => {
                let stage_ends = event.is_some();
                self.look_around(incoming, PointKind::Regular, None, None, stage_ends)
            }
            Some(Watch::LoadRate { sign }) => {
                self.at.here.load_sign = -sign;
                self.at.counts.limit_points += 1;
                let what = if sign > 0.0 { "load maximum" } else { "load minimum" };
                if came.motions > 1 {
                    return self.common_limit(what, sign, came);
                }
                self.look_around(incoming, PointKind::SmoothLimit, Some(what.to_owned()), Some(-sign), false)
            }
            // The mode goes on: the node is still held, by a force that a slide may have again.
            Some(Watch::Return { .. }) => self.look_around(incoming, PointKind::Regular, None, None, false),
            Some(Watch::Gap(_) | Watch::Normal(_) | Watch::Cone { .. } | Watch::Sliding(_) | Watch::Facet { .. }) => {
                self.contact_change(came)
            }
            Some(Watch::Slide { .. } | Watch::Hold { .. }) => self.contact_change(came),
        }
    }

    /// The end of a step in which contacts have changed together, from the modes `old`: none of them can change here.
    pub(super) fn joined_changes(&mut self, old: &[Mode], changes: u64, incoming: Rate) -> Arrival {
        self.at.here.rate = Some(incoming);
        self.at.counts.contact_changes += changes;
        let standings = self.standings(&self.at.here.state);
        let event = describe_change(self.names(), old, Some(&self.at.here.modes), &standings);
        let point = Point::plain(PointKind::ContactChange, Some(event));
        Arrival { point, options: Vec::new(), taken: None, stop: None, stage_ends: false, unconfirmed: false }
    }

    /// Directions at a point where the mode goes on.
    fn look_around(
        &self,
        incoming: &Rate,
        kind: PointKind,
        event: Option<String>,
        sign: Option<f64>,
        stage_ends: bool,
    ) -> Arrival {
        let standings = self.standings(&self.at.here.state);
        let mut point = Point::plain(kind, event);
        let settled = standings.iter().all(|standing| matches!(standing, Standing::Settled(_)));
        if settled {
            return Arrival { point, options: Vec::new(), taken: None, stop: None, stage_ends, unconfirmed: false };
        }
        let rules = self.rules();
        let (loading, here) = (self.loading(), &self.at.here);
        let before = Before::Incoming(Incoming::along(incoming));
        let told = if here.is_singular {
            // First order says nothing of what stays at its fold.
            let (state, force_scale) = (&here.state, rules.force_scale);
            let at = branches::Here { loading, state, standings: &standings, force_scale };
            second_order::directions(at, before)
        } else {
            None
        };
        let at_once = || directions_going_on(loading, &here.state, &standings, &here.modes, incoming, rules);
        let (options, found) = if let Some(branches::Told { options, unclear }) = told {
            (options, Found { degenerate: unclear, ..Found::default() })
        } else if let Some(options) = at_once() {
            (options, Found::default())
        } else {
            decide::list(loading, &here.state, &standings, before, rules)
        };
        let taken = options.iter().position(|option| option.rate.product(incoming) > 1.0 - 1e-9);
        // A load rate too small to tell by itself keeps the sign that it has had.
        let has_sign = taken.is_none_or(|taken| options[taken].load_sign != 0.0) || here.load_sign == 0.0;
        let sign = sign.or_else(|| (!has_sign).then_some(here.load_sign));
        point.bifurcation = decide::is_bifurcation(&options, taken, sign);
        point.unexplored_modes = found.unexplored;
        point.degenerate = found.degenerate || options.len() % 2 == 1 || taken.is_none();
        if let Some(taken) = taken {
            let kept = options[taken].dissipation;
            let tolerance = 1e-8 * rules.force_scale;
            point.better_direction =
                options.iter().any(|option| !option.retrace && option.dissipation > kept + tolerance);
        }
        Arrival { point, options, taken, stop: None, stage_ends, unconfirmed: false }
    }

    /// A limit point that several motions have in common: the path goes on in its own direction, the others are listed.
    fn common_limit(&self, what: &str, sign: f64, came: &Came) -> Arrival {
        let (loading, here, rules) = (self.loading(), &self.at.here, self.rules());
        let (incoming, state) = (&came.rate, &here.state);
        let standings = self.standings(state);
        let at = branches::Here { loading, state, standings: &standings, force_scale: rules.force_scale };
        let most = rules.effort.most_modes;
        let found = common_limit::directions(at, &here.modes, incoming, came.motions, most)
            .unwrap_or_else(|| branches::branches(at, &here.modes, incoming, came.motions - 1, None));
        let branches::Branches { mut options, mut degenerate, mut unexplored } = found;
        if !standings.iter().all(|standing| matches!(standing, Standing::Settled(_))) {
            // Those along which the load changes at first order.
            let before = Before::Incoming(Incoming::along(incoming));
            let (others, listed) = decide::list(loading, state, &standings, before, rules);
            options.extend(others.into_iter().filter(|other| decide::sign_of(other.rate.load) != 0.0));
            unexplored = unexplored.saturating_add(listed.unexplored);
        }
        options.iter_mut().for_each(|option| option.retrace = false);
        decide::mark_retrace(loading, state, &mut options, incoming);
        let taken = options.iter().position(|option| option.rate.product(incoming) > 1.0 - 1e-9);
        degenerate |= options.len() % 2 == 1 || taken.is_none();
        let kept = taken.map_or(0.0, |taken| options[taken].dissipation) + 1e-8 * rules.force_scale;
        let point = Point {
            kind: PointKind::SmoothLimit,
            bifurcation: decide::is_bifurcation(&options, taken, Some(-sign)),
            event: Some(format!("{what} of {} motions at once", came.motions)),
            better_direction: options.iter().any(|option| !option.retrace && option.dissipation > kept),
            unexplored_modes: unexplored,
            degenerate,
        };
        Arrival { point, options, taken, stop: None, stage_ends: false, unconfirmed: false }
    }

    /// An eigenvalue crosses zero within the mode: the path goes on in its own direction, the branches are listed.
    fn smooth_bifurcation(&mut self, crossing: Crossing, incoming: &Rate, stage_ends: bool) -> Arrival {
        if crossing.eigenvalues == 0 {
            return self.undetermined();
        }
        let rules = self.rules();
        let standings = self.standings(&self.at.here.state);
        let modes = &self.at.here.modes;
        let here = branches::Here {
            loading: self.loading(),
            state: &self.at.here.state,
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
            let mut found = branches::branches(here, &loose, incoming, crossing.eigenvalues, nulls);
            // The way on and the way back as they were.
            let own = found.options.iter_mut().filter(|option| option.rate.product(incoming).abs() > branches::SAME);
            own.for_each(|option| option.modes.clone_from(modes));
            found
        } else {
            branches::branches(here, modes, incoming, crossing.eigenvalues, nulls)
        };
        if !standings.iter().all(|standing| matches!(standing, Standing::Settled(_))) {
            // Other modes of the contacts that can change; in the current mode, singular here, the branches are it.
            let before = Before::Incoming(Incoming::along(incoming));
            let (others, listed) = decide::list(self.loading(), &self.at.here.state, &standings, before, rules);
            // Those of looser modes are over other unknowns.
            let nulls = nulls.filter(|_| !crossing.grazing);
            let is_singular = |nulls| branches::are_singular_in_all_modes(here, modes, nulls);
            if (listed.degenerate && others.is_empty()) || nulls.is_some_and(is_singular) {
                branches::in_other_modes(here, modes, nulls, &mut found);
            } else {
                let known = |other: &Choice| {
                    other.modes == *modes
                        || found.options.iter().any(|one| one.rate.product(&other.rate) > branches::SAME)
                };
                let others: Vec<Choice> = others.into_iter().filter(|other| !known(other)).collect();
                found.options.extend(others);
                found.unexplored = listed.unexplored;
            }
            found.degenerate |= listed.mechanism;
        }
        let branches::Branches { options, degenerate, unexplored } = found;
        let kept = options[0].dissipation + 1e-8 * rules.force_scale;
        let point = Point {
            kind: PointKind::SmoothBifurcation,
            bifurcation: decide::is_bifurcation(&options, Some(0), None),
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

    /// The slip and the load may go on at any rates, each against the other: a family of paths leaves.
    fn undetermined(&self) -> Arrival {
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

    /// A contact has reached the end of its mode: list the directions and take one.
    fn contact_change(&mut self, came: &Came) -> Arrival {
        let Came { rate: incoming, step, stopped, nearby, .. } = came;
        self.at.counts.contact_changes += 1;
        let standings = self.standings(&self.at.here.state);
        for (reaction, standing) in self.at.here.state.reactions.iter_mut().zip(&standings) {
            // The event was located to round-off; the rest of a reaction that is zero there is dropped.
            if *standing == Standing::Touching && reaction.size() <= ROUND_OFF * self.at.totals.force_scale {
                *reaction = Reaction::default();
            }
        }
        let rules = self.rules();
        let modes = Some(&self.at.here.modes[..]);
        let is_singular = self.at.here.is_singular;
        let came = Incoming { rate: incoming, modes, stopped: *stopped, nearby: Some(nearby), is_singular };
        let before = Before::Incoming(came);
        let mut decision = decide::decide(self.loading(), &self.at.here.state, &standings, before, rules);
        // Ways that share a node's force anew come last: they begin with a rest, not with the motion that led here.
        let keeps: Vec<bool> = decision.options.iter().map(|option| self.keeps_shares(option)).collect();
        if decision.taken.is_some_and(|taken| !keeps[taken]) {
            let open = |index: usize| keeps[index] && !decision.options[index].retrace;
            let best = decide::preferred(&decision.options, incoming, rules, open);
            decision.taken = best.filter(|best| !decision.options[*best].mechanism).or(decision.taken);
        }
        let force_scale = rules.force_scale;
        // The rule decides among the directions, each of which holds over a finite step; the program says whether it names
        // the mode of the one taken.
        let confirmed = match decision.taken {
            Some(taken) if self.scene.analysis.method == Method::Mpec && !self.scene.analysis.skips_certificate() => {
                self.is_confirmed_by_program(&decision.options[taken], *step)
            }
            _ => true,
        };
        // By the load rates here: of a load that turns, the way back falls as the way on does.
        let mut bifurcation = decide::is_bifurcation(&decision.options, decision.taken, None);
        if let Some(taken) = decision.taken
            && let choice = &mut decision.options[taken]
            && choice.load_sign == 0.0
        {
            let (loading, state) = (self.loading(), &self.at.here.state);
            let later = later_sign(loading, state, &choice.rate, &choice.modes, force_scale);
            choice.load_sign = later.sign;
            if later.is_steady {
                bifurcation = decide::is_bifurcation(&decision.options, decision.taken, None);
            }
        }
        let old_modes = self.at.here.modes.clone();
        let old_sign = self.at.here.load_sign;
        let mut stop = decision.stop;
        self.take(&mut decision);
        let outgoing = decision.taken.map(|index| &decision.options[index]);
        let mut kind = PointKind::ContactChange;
        if let Some(choice) = outgoing
            && choice.load_sign * old_sign < 0.0
        {
            kind = PointKind::NonsmoothLimit;
            self.at.counts.limit_points += 1;
        }
        if stop.is_none() && self.is_cycle() {
            stop = Some(StopReason::Cycle);
        }
        let point = Point {
            kind,
            bifurcation,
            event: Some(describe_change(
                self.names(),
                &old_modes,
                outgoing.map(|choice| &choice.modes[..]),
                &standings,
            )),
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

    /// Whether a direction begins with the reactions that are. Where a node is carried by planes that move against each
    /// other and slips along both, equilibrium gives them; another way to share its force begins with a rest.
    fn keeps_shares(&self, choice: &Choice) -> bool {
        let (loading, here) = (self.loading(), &self.at.here);
        let (state, zero) = (&here.state, ZERO * self.rules().force_scale);
        loading.corners.iter().filter(|corner| corner::is_in_plane(loading, corner)).all(|corner| {
            let closed = corner.closed(loading, state);
            let slips = |contact: &usize| matches!(here.modes[*contact], Mode::Slip { .. });
            // What sticks while another presses the node may bear what it did.
            let any_share = closed.iter().any(|contact| choice.modes[*contact] == Mode::Stick)
                && closed.iter().all(|contact| choice.modes[*contact].is_active());
            match Carried::of(loading, &closed, state) {
                Some(carried) if closed.iter().all(slips) && !any_share => {
                    let force = corner::total_force(loading, closed.iter().copied(), state);
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

    /// Whether the path has left this very state in these modes before; remembers it if not.
    fn is_cycle(&mut self) -> bool {
        let here = self.visit();
        let force = SAME_STATE * self.at.totals.force_scale;
        let known = self.at.visited.states().any(|visited| visited.is(&here, SAME_STATE, force));
        self.at.visited.remember(here, history::room(self.scene));
        known
    }
}
