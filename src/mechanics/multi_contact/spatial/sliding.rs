//! A node that slides along one of its obstacles or an edge: its reactions and their rates.

use crate::mechanics::contact::vector::{Vector, add, cross, dot, scaled, size, unit};
use crate::mechanics::contact::{Frame, Mode, Reaction};
use crate::mechanics::multi_contact::spatial::ContactGroup;
use crate::mechanics::problem::loading::Loading;
use crate::mechanics::problem::node_contact_forces::Corner;
use crate::mechanics::problem::state::State;

/// The other of the two obstacles along whose edge a node in space slides in these modes, if it slides along an edge.
pub fn beside(loading: Loading<'_>, modes: &[Mode], contact: usize) -> Option<usize> {
    if loading.structure.dimension != 3 {
        return None;
    }
    let corner = loading.corners.iter().find(|corner| corner.contacts.contains(&contact))?;
    let mut others = corner.contacts.iter().copied().filter(|other| *other != contact && modes[*other].is_active());
    match (others.next(), others.next()) {
        (Some(other), None) => Some(other),
        _ => None,
    }
}

/// The edge of two obstacles at a node, in the order of their indices.
pub struct Edge {
    /// Unit vector along the edge.
    pub direction: Vector,
    frames: [Frame; 2],
    /// Sine of the angle between the normals.
    sine: f64,
}

impl Edge {
    pub fn new(loading: Loading<'_>, mut contacts: [usize; 2], state: &State) -> Self {
        contacts.sort_unstable();
        Self::of(contacts.map(|contact| loading.frame(contact, state)))
    }

    fn of(frames: [Frame; 2]) -> Self {
        let across = cross(&frames[0].normal, &frames[1].normal);
        Self { direction: unit(&across), frames, sine: size(&across) }
    }

    /// The change of a direction along the edge with a motion of the node.
    pub fn change_along(&self, direction: &Vector, motion: &Vector) -> Vector {
        let sign = if dot(direction, &self.direction) < 0.0 { -1.0 } else { 1.0 };
        scaled(&self.change(motion), sign)
    }

    /// The change of the edge's direction with a motion of the node.
    pub fn change(&self, motion: &Vector) -> Vector {
        let [first, second] = &self.frames;
        let turned = add(
            &cross(&first.normal_change(motion), &second.normal),
            1.0,
            &cross(&first.normal, &second.normal_change(motion)),
        );
        scaled(&add(&turned, -dot(&turned, &self.direction), &self.direction), 1.0 / self.sine)
    }
}

/// The slide of a node along one obstacle or the edge of two.
struct GroupSlide {
    /// Indices of the obstacles in the [`ContactGroup`].
    places: Vec<usize>,
    /// Direction of the slide; zero without friction.
    direction: Vector,
    /// Linear forms of the force that give the normal reactions, one per obstacle.
    forms: Vec<Vector>,
}

/// The slide of the node in these modes of all contacts, if it slides.
fn slide_in(group: &ContactGroup, modes: &[Mode]) -> Option<GroupSlide> {
    let active = |place: &usize| modes[group.contacts[*place]].is_active();
    let places: Vec<usize> = (0..group.contacts.len()).filter(active).collect();
    let mut direction = [0.0; 3];
    for place in &places {
        match modes[group.contacts[*place]] {
            Mode::Slip { direction: along } if along != [0.0; 3] => direction = along,
            Mode::Slip { .. } => {}
            Mode::Free | Mode::Stick => return None,
        }
    }
    let forms = match places[..] {
        [place] => vec![group.face_form(place)],
        [first, second] if group.free.len() == 3 => {
            let edge = unit(&cross(&group.normals[first], &group.normals[second]));
            let along = if direction == [0.0; 3] { edge } else { direction };
            group.edge_forms([first, second], &along).to_vec()
        }
        _ => return None,
    };
    Some(GroupSlide { places, direction, forms })
}

/// The friction force on the node in these modes under a force.
pub fn drag_in(group: &ContactGroup, modes: &[Mode], force: &Vector) -> f64 {
    let Some(GroupSlide { places, forms, .. }) = slide_in(group, modes) else { return 0.0 };
    places.iter().zip(&forms).map(|(place, form)| group.frictions[*place].bound(dot(form, force))).sum()
}

/// The change, with a motion, of the forces of the obstacles along which the node slides, at given normal
/// reactions.
pub(crate) fn turning(
    group: &ContactGroup,
    places: &[usize],
    direction: &Vector,
    normals: &[f64],
    motion: &Vector,
) -> Vec<Vector> {
    let turned = |place: usize| group.frames[place].normal_change(motion);
    let direction_turned = match places[..] {
        [place] => scaled(&group.frames[place].normal, -dot(&turned(place), direction)),
        [first, second] => {
            let frames = [first, second].map(|place| group.frames[place]);
            Edge::of(frames).change_along(direction, motion)
        }
        _ => [0.0; 3],
    };
    let of = |(place, normal): (&usize, &f64)| {
        scaled(&group.frictions[*place].force_direction(&turned(*place), &direction_turned), *normal)
    };
    places.iter().zip(normals).map(of).collect()
}

/// The rates of the reactions of the obstacles along which the node slides, from the rate of their sum; empty where
/// the node does not slide.
pub fn rates_in(
    group: &ContactGroup,
    modes: &[Mode],
    force: &Vector,
    rate: &Vector,
    motion: &Vector,
) -> Vec<(usize, Reaction)> {
    let Some(GroupSlide { places, direction, forms }) = slide_in(group, modes) else { return Vec::new() };
    let normals: Vec<f64> = forms.iter().map(|form| dot(form, force)).collect();
    let turning = turning(group, &places, &direction, &normals, motion);
    let rest = turning.iter().fold(group.free_part(rate), |rest, turned| add(&rest, -1.0, &group.free_part(turned)));
    let growing: Vec<f64> = forms.iter().map(|form| dot(form, &rest)).collect();
    let mut parts = Vec::new();
    for (k, place) in places.iter().enumerate() {
        let normal_turned = scaled(&group.frames[*place].normal_change(motion), normals[k]);
        let tangential = add(&turning[k], -1.0, &normal_turned);
        let drag = -group.frictions[*place].bound(growing[k]);
        let tangential = add(&tangential, drag, &direction);
        parts.push((group.contacts[*place], Reaction { normal: growing[k], tangential }));
    }
    if let [(_, only)] = &mut parts[..] {
        // The component perpendicular to the direction turns the direction.
        let normal = &group.frames[places[0]].normal;
        let pressed = scaled(&group.normals[places[0]], only.normal);
        let across = add(&add(&rest, -1.0, &pressed), -dot(&rest, &direction), &direction);
        if group.frictions[places[0]].is_rough() {
            only.tangential = add(&only.tangential, 1.0, &add(&across, -dot(&across, normal), normal));
        }
    }
    parts
}

/// The reactions of the obstacles along which alone a node slides further, where they take over the reactions of
/// others; empty where there is nothing to take over.
pub fn taken_over(loading: Loading<'_>, corner: &Corner, modes: &[Mode], state: &State) -> Vec<(usize, Reaction)> {
    let group = ContactGroup::new(loading, &corner.contacts, state);
    let Some(GroupSlide { places, direction, forms }) = slide_in(&group, modes) else { return Vec::new() };
    let slides_alone = |place: usize| places.contains(&place);
    let had = |place: usize| state.reactions[corner.contacts[place]] != Reaction::default();
    let rough = places.iter().any(|place| group.frictions[*place].is_rough());
    let takes_over = (0..corner.contacts.len()).any(|place| had(place) && !slides_alone(place));
    if !takes_over && (!rough || places.len() == 1) {
        return Vec::new();
    }
    let force = group.force(loading, state);
    let mut rest = force;
    let mut parts = Vec::new();
    for (place, form) in places.iter().zip(&forms) {
        let normal = dot(form, &force);
        let tangential = group.frictions[*place].traction(normal, &direction);
        rest = add(&add(&rest, -normal, &group.normals[*place]), -1.0, &tangential);
        parts.push((*place, Reaction { normal, tangential }));
    }
    // The remainder comes from the location of the event; the sum is preserved.
    if let Some((_, part)) = parts.iter_mut().find(|(place, _)| group.frictions[*place].is_rough()) {
        part.tangential = add(&part.tangential, 1.0, &rest);
    }
    parts.into_iter().map(|(place, part)| (corner.contacts[place], part)).collect()
}
