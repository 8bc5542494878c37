//! A contact that can change, or the contacts of a node that change together: their velocities, and their possible
//! modes as equations and inequalities of the rate problem.

use crate::complementarity::rate_search::slip_onset_direction::Touch;
use crate::complementarity::rates::rate_problem::{Choice, Entity, Signed, Touching};
use crate::mechanics::contact::coulomb::CoulombFriction;
use crate::mechanics::contact::vector::{Vector, add, dot, scaled, size, unit};
use crate::mechanics::contact::{Frame, Mode, Reaction, Sliding};
use crate::mechanics::multi_contact::changeable_contacts::Standing;
use crate::mechanics::multi_contact::moving_planes::Carried;
use crate::mechanics::multi_contact::planar::{self, rays};
use crate::mechanics::multi_contact::rate_options;
use crate::mechanics::multi_contact::rate_options::tolerances::{BOUND_SINE, GRAZING_SPEED};
use crate::mechanics::multi_contact::spatial::ContactGroup;
use crate::mechanics::multi_contact::spatial::sliding;
use crate::mechanics::problem::loading::Loading;
use crate::mechanics::problem::node_contact_forces;
use crate::mechanics::problem::state::{Rate, State};
use crate::resources::budget::{self, Taken};
use nalgebra::DVector;

/// Contacts that change together.
pub(crate) struct Changeable {
    /// One contact, or the closed contacts of a node; while they are held, the first has the total force on the node.
    pub contacts: Vec<usize>,
    pub(crate) standing: Standing,
    frames: Vec<Frame>,
    /// Columns and directions of the node's velocities.
    pub velocities: Vec<(usize, Vector)>,
    /// The present reaction of the first contact.
    reaction: Reaction,
    /// The present force on the node.
    pub(crate) force: Vector,
    /// The closed obstacles of a node with several contacts, where it is free in space or guided.
    pub(crate) group: Option<ContactGroup>,
}

/// The outcome of an option: the modes of the contacts.
#[derive(Debug, Clone)]
pub(crate) struct OptionOutcome {
    pub modes: Vec<(usize, Mode)>,
}

impl Changeable {
    /// The contacts with their velocities at a state; `next` is the first free column.
    pub fn new(loading: Loading<'_>, state: &State, contacts: Vec<usize>, standing: Standing, next: usize) -> Self {
        let frames: Vec<Frame> = contacts.iter().map(|contact| loading.frame(*contact, state)).collect();
        let frame = &frames[0];
        let contact = &loading.contacts[contacts[0]];
        let corner = loading.corners.iter().find(|corner| corner.contacts.contains(&contacts[0]));
        let is_cornered = matches!(standing, Standing::Cornered { .. });
        let group = corner
            .filter(|corner| is_cornered && !node_contact_forces::is_in_plane(loading, corner))
            .map(|_| ContactGroup::new(loading, &contacts, state));
        let directions: Vec<Vector> = match standing {
            Standing::Settled(_) => Vec::new(),
            Standing::OnCone { direction } => vec![direction],
            Standing::Touching => {
                let tangents = frame.tangents.iter().take(contact.tangents());
                std::iter::once(frame.normal).chain(tangents.copied()).collect()
            }
            Standing::Cornered { .. } => match &group {
                Some(group) => group.free.clone(),
                None => vec![frame.normal, frame.tangents[0]],
            },
        };
        let velocities = directions.into_iter().enumerate().map(|(k, direction)| (next + k, direction)).collect();
        let force = match &group {
            Some(group) => group.force(loading, state),
            None => node_contact_forces::total_force(loading, contacts.iter().copied(), state),
        };
        let reaction = state.reactions[contacts[0]];
        Self { contacts, standing, frames, velocities, reaction, force, group }
    }

    fn carried(&self, loading: Loading<'_>, state: &State) -> Option<Carried> {
        let is_cornered = matches!(self.standing, Standing::Cornered { .. });
        if is_cornered { Carried::of(loading, &self.contacts, state) } else { None }
    }

    /// The rate of dissipation when the node moves while one of the contacts, if any, slips.
    pub fn dissipation(&self, loading: Loading<'_>, modes: &[Mode], rate: &Rate, state: &State) -> f64 {
        if let Some(carried) = self.carried(loading, state) {
            return carried.dissipation(loading, modes, &self.force, state, rate);
        }
        if let Some(group) = &self.group {
            let motion = loading.relative_rate(self.contacts[0], state, rate);
            return sliding::drag_in(group, modes, &self.force) * size(&motion);
        }
        let slips = |(contact, _): &(&usize, &Frame)| matches!(modes[**contact], Mode::Slip { .. });
        let Some((contact, frame)) = self.contacts.iter().zip(&self.frames).find(slips) else { return 0.0 };
        if loading.contacts[*contact].tangents() == 0 {
            return 0.0;
        }
        let traction = add(&self.force, -dot(&self.force, &frame.normal), &frame.normal);
        -dot(&traction, &loading.relative_rate(*contact, state, rate))
    }

    /// On a curved obstacle, converts the rate of the total force into the rates of the normal and tangential
    /// reactions.
    pub fn take_reaction_apart(&self, loading: Loading<'_>, state: &State, rate: &mut Rate) {
        let frame = &self.frames[0];
        if frame.curvature.is_zero() || self.contacts.len() > 1 {
            return;
        }
        let motion = loading.relative_rate(self.contacts[0], state, rate);
        let turned = frame.normal_change(&motion);
        let across = dot(&self.reaction.tangential, &turned);
        let reaction = &mut rate.reactions[self.contacts[0]];
        reaction.normal += across;
        reaction.tangential = add(&reaction.tangential, -self.reaction.normal, &turned);
        reaction.tangential = add(&reaction.tangential, -across, &frame.normal);
    }

    /// Where a node with several contacts slides along one obstacle, assigns the rate of the total force to this
    /// contact.
    pub fn move_to_slider(&self, loading: Loading<'_>, modes: &[Mode], rate: &mut Rate, state: &State) {
        if let Some(carried) = self.carried(loading, state) {
            let whole = node_contact_forces::force(&self.frames[0], &rate.reactions[self.contacts[0]]);
            for (contact, part) in carried.rates(loading, modes, &whole, state) {
                rate.reactions[contact] = part;
            }
            return;
        }
        if let Some(group) = &self.group {
            let whole = node_contact_forces::force(&self.frames[0], &rate.reactions[self.contacts[0]]);
            let motion = loading.relative_rate(self.contacts[0], state, rate);
            let parts = sliding::rates_in(group, modes, &self.force, &whole, &motion);
            if !parts.is_empty() {
                self.contacts.iter().for_each(|contact| rate.reactions[*contact] = Reaction::default());
                parts.into_iter().for_each(|(contact, part)| rate.reactions[contact] = part);
            }
            return;
        }
        let slips = |(contact, _): &(&usize, &Frame)| matches!(modes[**contact], Mode::Slip { .. });
        let slider = self.contacts.iter().zip(&self.frames).find(slips);
        let (Some((contact, frame)), true) = (slider, self.contacts.len() > 1) else { return };
        let force = node_contact_forces::force(&self.frames[0], &rate.reactions[self.contacts[0]]);
        let normal = dot(&force, &frame.normal);
        rate.reactions[self.contacts[0]] = Reaction::default();
        let mut tangential = add(&force, -normal, &frame.normal);
        if !frame.curvature.is_zero() {
            // The normal reaction turns with the position on the obstacle.
            let motion = loading.relative_rate(*contact, state, rate);
            let pressed = dot(&self.force, &frame.normal);
            tangential = add(&tangential, -pressed, &frame.normal_change(&motion));
        }
        rate.reactions[*contact] = Reaction { normal, tangential };
    }

    /// Whether the contact touches in space, so that a slip may begin in any direction.
    pub fn may_turn(&self, loading: Loading<'_>) -> bool {
        self.standing == Standing::Touching && loading.contacts[self.contacts[0]].tangents() == 2
    }

    /// The slip of a node that touches in space and, at first order, moves along the obstacle without a reaction: a
    /// reaction may arise at second order, and friction then opposes the present motion.
    pub fn grazing_slip(&self, loading: Loading<'_>, state: &State, rate: &Rate) -> Option<Mode> {
        if !self.may_turn(loading) {
            return None;
        }
        let (normal, motion) = (self.frames[0].normal, loading.relative_rate(self.contacts[0], state, rate));
        let opening = dot(&normal, &motion);
        let along = add(&motion, -opening, &normal);
        (opening.abs() <= GRAZING_SPEED && size(&along) > GRAZING_SPEED).then(|| Mode::Slip { direction: unit(&along) })
    }

    pub fn tangents(&self) -> [Vector; 2] {
        self.frames[0].tangents
    }

    /// Whether the rate of the reaction of a sticking contact lies within the circular cone, which linear forms do not
    /// ensure.
    pub fn is_in_cone(&self, loading: Loading<'_>, modes: &[Mode], rate: &Rate, tolerance: f64) -> bool {
        if self.group.is_some() {
            return self.margin(modes, rate).is_none_or(|margin| margin >= -tolerance);
        }
        let contact = self.contacts[0];
        let circular = loading.contacts[contact].sliding == Sliding::Plane;
        if !circular || self.standing != Standing::Touching || modes[contact] != Mode::Stick {
            return true;
        }
        let reaction = &rate.reactions[contact];
        loading.contacts[contact].friction.margin(reaction) >= -tolerance
    }

    /// The options, the sticking or closed one first, and the modes of each.
    pub fn options(&self, loading: Loading<'_>, state: &State, forms: &mut Forms<'_>) -> (Entity, Vec<OptionOutcome>) {
        let contact = self.contacts[0];
        let friction = loading.contacts[contact].friction;
        let single = |mode: Mode| OptionOutcome { modes: vec![(contact, mode)] };
        let frame = &self.frames[0];
        match (self.standing, &self.velocities[..]) {
            (Standing::OnCone { direction }, _) => {
                let along = forms.velocity(self, &direction);
                // μ ṙ_n + d·ṙ_t; the reaction turns with the position on a curved obstacle.
                let mut slack = forms.force_rate(self, &friction.slack_form(&frame.normal, &direction));
                let (column, _) = self.velocities[0];
                let curvature = frame.curvature_along(&direction);
                slack[column] -= curvature * self.reaction.normal * friction.force_direction_squared();
                let slack = forms.force(slack);
                (Entity::complementary(slack, along), vec![single(Mode::Stick), single(Mode::Slip { direction })])
            }
            (Standing::Touching, [_]) => {
                let gap = forms.velocity(self, &frame.normal);
                let pressing = forms.force_along(self, &frame.normal);
                let closed = Mode::Slip { direction: [0.0; 3] };
                (Entity::complementary(pressing, gap), vec![single(closed), single(Mode::Free)])
            }
            (Standing::Touching, [_, _]) => {
                let tangent = frame.tangents[0];
                let directions = [tangent, scaled(&tangent, -1.0)];
                let outcomes = vec![
                    single(Mode::Stick),
                    single(Mode::Slip { direction: directions[0] }),
                    single(Mode::Slip { direction: directions[1] }),
                    single(Mode::Free),
                ];
                (self.touching_on_a_line(friction, forms), outcomes)
            }
            (Standing::Touching, _) => {
                let zero: Vec<usize> =
                    self.velocities.iter().map(|(_, direction)| forms.velocity(self, direction)).collect();
                let forces: Vec<usize> =
                    self.velocities.iter().map(|(_, direction)| forms.force_along(self, direction)).collect();
                let stick =
                    Choice { zero: zero.clone(), nonnegative: vec![Signed::plus(forces[0])], implied: Vec::new() };
                let free = Choice { zero: forces, nonnegative: vec![Signed::plus(zero[0])], implied: Vec::new() };
                (Entity { options: vec![stick, free], touching: None }, vec![single(Mode::Stick), single(Mode::Free)])
            }
            (Standing::Cornered { unloaded, zero, .. }, _) if let Some(group) = &self.group => {
                rate_options::spatial::options(self, group, (loading, state), unloaded, zero, forms)
            }
            (Standing::Cornered { zero, .. }, _) if let Some(carried) = Carried::of(loading, &self.contacts, state) => {
                rate_options::moving_planes::options(&carried, loading, state, self, zero, forms)
            }
            (Standing::Cornered { facets, unloaded, .. }, _) => {
                self.options_of_corner(loading, state, facets, unloaded, forms)
            }
            (Standing::Settled(mode), _) => {
                (Entity { options: vec![Choice::default()], touching: None }, vec![single(mode)])
            }
        }
    }

    /// For an unloaded node at several obstacles in space, the slips along each rough obstacle alone while the others
    /// open.
    pub fn touches_in_group(&self, entity: usize, forms: &mut Forms<'_>) -> Vec<(usize, Touch)> {
        let (Some(group), Standing::Cornered { unloaded: true, .. }) = (&self.group, self.standing) else {
            return Vec::new();
        };
        let rough =
            (0..self.contacts.len()).filter(|place| group.free.len() == 3 && group.frictions[*place].is_rough());
        let touch = |place: usize| {
            let frame = &self.frames[place];
            let along = [frame.normal, frame.tangents[0], frame.tangents[1]];
            let others = (0..self.contacts.len()).filter(|other| *other != place);
            let touch = Touch {
                entity,
                velocities: along.map(|direction| forms.velocity(self, &direction)),
                forces: along.map(|direction| forms.force_along(self, &direction)),
                friction: group.frictions[place].coefficient,
                opening: others.map(|other| forms.velocity(self, &self.frames[other].normal)).collect(),
            };
            (self.contacts[place], touch)
        };
        rough.map(touch).collect()
    }

    /// The margin of a rate of force against sliding, for a held node in space or a guided one.
    pub fn margin(&self, modes: &[Mode], rate: &Rate) -> Option<f64> {
        let (Some(group), Standing::Cornered { unloaded, zero, .. }) = (&self.group, self.standing) else {
            return None;
        };
        let is_held = self.contacts.iter().all(|contact| modes[*contact] == Mode::Stick);
        is_held.then(|| {
            let of_contact =
                |(contact, frame): (&usize, &Frame)| node_contact_forces::force(frame, &rate.reactions[*contact]);
            let parts = self.contacts.iter().zip(&self.frames).map(of_contact);
            let whole = group.free_part(&parts.fold([0.0; 3], |sum, part| add(&sum, 1.0, &part)));
            group.margin_of_rate(&self.force, unloaded, zero, &whole)
        })
    }

    fn touching_on_a_line(&self, friction: CoulombFriction, forms: &mut Forms<'_>) -> Entity {
        let (normal, tangent) = (self.frames[0].normal, self.frames[0].tangents[0]);
        Entity::touching(Touching {
            gap: forms.velocity(self, &normal),
            along: forms.velocity(self, &tangent),
            pressing: forms.force_along(self, &normal),
            traction: forms.force_along(self, &tangent),
            cone: [
                forms.force_along(self, &friction.slack_form(&normal, &tangent)),
                forms.force_along(self, &friction.slack_form(&normal, &scaled(&tangent, -1.0))),
            ],
        })
    }

    /// The conditions under which a node with several contacts in the plane slips along one obstacle, in the sense of
    /// the tangent (1), against it (-1), or without friction (0), while the others open. `ray`: the direction of the
    /// reaction; `gaps`: the forms of the rates of all gaps.
    fn slip_in_corner(
        &self,
        place: usize,
        sense: f64,
        ray: &Vector,
        gaps: &[usize],
        unloaded: bool,
        forms: &mut Forms<'_>,
    ) -> Choice {
        let (frame, tangent) = (&self.frames[place], self.frames[place].tangents[0]);
        let across = [-ray[1], ray[0], 0.0];
        let mut off_ray = forms.force_rate(self, &across);
        if !frame.curvature.is_zero() {
            let turn = frame.curvature_along(&tangent) * dot(&self.force, ray);
            // The ray turns clockwise as the node moves along the tangent of a convex obstacle.
            for (column, direction) in &self.velocities {
                off_ray[*column] += turn * dot(direction, &tangent);
            }
        }
        let others = gaps.iter().enumerate().filter(|(other, _)| *other != place);
        let mut nonnegative: Vec<Signed> = others.map(|(_, gap)| Signed::plus(*gap)).collect();
        if sense != 0.0 {
            let along = forms.velocity(self, &tangent);
            nonnegative.push(Signed { form: along, sign: sense });
        }
        if unloaded {
            nonnegative.push(Signed::plus(forms.force_along(self, ray)));
        }
        Choice { zero: vec![gaps[place], forms.force(off_ray)], nonnegative, implied: Vec::new() }
    }

    /// The options of a node with several contacts in the plane: the node is held, slides along one of its obstacles
    /// while the others open, or leaves them all.
    fn options_of_corner(
        &self,
        loading: Loading<'_>,
        state: &State,
        facets: [bool; 2],
        unloaded: bool,
        forms: &mut Forms<'_>,
    ) -> (Entity, Vec<OptionOutcome>) {
        let inward = planar::sector(loading, &self.contacts, |_| Mode::Stick, state).inward;
        let gaps: Vec<usize> = self.frames.iter().map(|frame| forms.velocity(self, &frame.normal)).collect();
        let outcome = |slipping: Option<(usize, Vector)>, others: Mode| OptionOutcome {
            modes: self
                .contacts
                .iter()
                .map(|contact| match slipping {
                    Some((slipping, direction)) if slipping == *contact => (*contact, Mode::Slip { direction }),
                    _ => (*contact, others),
                })
                .collect(),
        };
        let bounds = inward.iter().flatten().zip(facets).filter(|(_, active)| *active);
        let held = Choice {
            zero: self.velocities.iter().map(|(_, direction)| forms.velocity(self, direction)).collect(),
            nonnegative: bounds.map(|(inward, _)| Signed::plus(forms.force_along(self, inward))).collect(),
            implied: Vec::new(),
        };
        let mut options = vec![held];
        let mut outcomes = vec![outcome(None, Mode::Stick)];
        for (place, (contact, frame)) in self.contacts.iter().zip(&self.frames).enumerate() {
            let friction = loading.contacts[*contact].friction;
            let tangent = frame.tangents[0];
            let senses: &[f64] = if friction.is_rough() { &[1.0, -1.0] } else { &[0.0] };
            for &sense in senses {
                let ray = unit(&rays(frame, friction)[usize::from(sense < 0.0)]);
                let on_bound = inward
                    .iter()
                    .flatten()
                    .zip(facets)
                    .any(|(inward, active)| active && dot(inward, &ray).abs() <= BOUND_SINE);
                // The opposite ray on the bound of a half-plane belongs to another contact.
                let on_ray = on_bound && dot(&ray, &self.force) > 0.0;
                if unloaded || on_ray {
                    options.push(self.slip_in_corner(place, sense, &ray, &gaps, unloaded, forms));
                    outcomes.push(outcome(Some((*contact, scaled(&tangent, sense))), Mode::Free));
                }
            }
        }
        if unloaded {
            let zero = self.velocities.iter().map(|(_, direction)| forms.force_along(self, direction)).collect();
            let nonnegative = gaps.iter().map(|gap| Signed::plus(*gap)).collect();
            options.push(Choice { zero, nonnegative, implied: Vec::new() });
            outcomes.push(outcome(None, Mode::Free));
        }
        (Entity { options, touching: None }, outcomes)
    }
}

/// The linear forms of the rate problem, collected as they are created.
pub(crate) struct Forms<'a> {
    /// The rate of each weight, one per column. Where no contacts form a group, displacements may be missing.
    pub columns: &'a [Rate],
    /// The normal in which the reaction of the first contact of a group is resolved.
    pub normals: &'a dyn Fn(usize) -> Vector,
    pub rows: Vec<DVector<f64>>,
    pub is_force: Vec<bool>,
    /// The memory that the rows take.
    pub held: Taken,
}

impl Forms<'_> {
    /// Adds the form of a velocity or of the load rate; returns its index.
    pub(crate) fn motion(&mut self, of: impl Fn(&Rate) -> f64) -> usize {
        budget::spend(self.columns.len());
        self.held.add::<f64>(self.columns.len());
        let row = DVector::from_iterator(self.columns.len(), self.columns.iter().map(of));
        self.rows.push(row);
        self.is_force.push(false);
        self.rows.len() - 1
    }

    /// Adds the form of the velocity of the node along a direction; returns its index.
    pub(crate) fn velocity(&mut self, entry: &Changeable, direction: &Vector) -> usize {
        self.held.add::<f64>(self.columns.len());
        let mut row = DVector::zeros(self.columns.len());
        for (column, velocity) in &entry.velocities {
            row[*column] = dot(velocity, direction);
        }
        self.rows.push(row);
        self.is_force.push(false);
        self.rows.len() - 1
    }

    /// The row of the rate of the total force on the node along a direction.
    pub(crate) fn force_rate(&self, entry: &Changeable, direction: &Vector) -> DVector<f64> {
        // The reactions of each column lie elsewhere in memory: for many columns and rows this takes long.
        budget::spend(self.columns.len());
        let contact = entry.contacts[0];
        let normal = (self.normals)(contact);
        let along = |rate: &Rate| {
            let reaction = &rate.reactions[contact];
            reaction.normal * dot(&normal, direction) + dot(&reaction.tangential, direction)
        };
        DVector::from_iterator(self.columns.len(), self.columns.iter().map(along))
    }

    pub(crate) fn force_along(&mut self, entry: &Changeable, direction: &Vector) -> usize {
        let rate = self.force_rate(entry, direction);
        self.force(rate)
    }

    pub(crate) fn force(&mut self, rate: DVector<f64>) -> usize {
        self.held.add::<f64>(self.columns.len());
        self.rows.push(rate);
        self.is_force.push(true);
        self.rows.len() - 1
    }
}
