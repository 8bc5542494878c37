//! The options, in the rate problem, of a node in contact with several obstacles in space.

use crate::complementarity::rates::rate_problem::{Choice, Entity, Signed};
use crate::mechanics::contact::Mode;
use crate::mechanics::contact::vector::{Vector, cross, dot, scaled};
use crate::mechanics::multi_contact::rate_options::contact_options::{Changeable, Forms, OptionOutcome};
use crate::mechanics::multi_contact::spatial::sliding;
use crate::mechanics::multi_contact::spatial::{ContactGroup, Drive, Slide};
use crate::mechanics::problem::loading::Loading;
use crate::mechanics::problem::state::State;

/// The options of the node: it is held, slides along one obstacle or an edge, or leaves. The condition that the node is
/// held is no linear form: see `ContactGroup::margin_of_rate`; nor is the condition of a first slip along one rough obstacle
/// in space: see `slip_onset_direction`.
pub fn options(
    entry: &Changeable,
    group: &ContactGroup,
    (loading, state): (Loading<'_>, &State),
    unloaded: bool,
    zero: f64,
    forms: &mut Forms<'_>,
) -> (Entity, Vec<OptionOutcome>) {
    if group.is_driven {
        return driven(entry, group, (loading, state), unloaded, zero, forms);
    }
    let mut writer = Writer { entry, group, unloaded, zero, forms, options: Vec::new(), outcomes: Vec::new() };
    let held = group.free.iter().map(|direction| writer.forms.velocity(entry, direction)).collect();
    writer.option(held, Vec::new(), |_| Mode::Stick);
    let slides: Vec<(Slide, Option<Drive>)> = if unloaded {
        group.slides().into_iter().map(|slide| (slide, None)).collect()
    } else {
        group.ready(&entry.force, zero).into_iter().map(|(slide, drive)| (slide, Some(drive))).collect()
    };
    for (slide, drive) in slides {
        match (slide, drive) {
            (Slide::Edge { places, direction }, drive) => writer.edge(places, direction, drive),
            (Slide::Face { place }, _) if !group.frictions[place].is_rough() => writer.smooth_face(place, drive),
            (Slide::Face { place }, Some(drive)) => writer.face(place, &drive),
            (Slide::Face { place }, None) if group.free.len() == 2 => writer.guided_face(place),
            // The direction of this slip is unknown.
            (Slide::Face { .. }, None) => {}
        }
    }
    if unloaded {
        let apart = group.free.iter().map(|direction| writer.forms.force_along(entry, direction)).collect();
        let gaps = writer.gaps(&[]);
        writer.option(apart, gaps, |_| Mode::Free);
    }
    (Entity { options: writer.options, touching: None }, writer.outcomes)
}

/// The options of a node that is driven against its obstacles and free in one direction only: one obstacle holds the
/// node in this direction, or none does.
fn driven(
    entry: &Changeable,
    group: &ContactGroup,
    (loading, state): (Loading<'_>, &State),
    unloaded: bool,
    zero: f64,
    forms: &mut Forms<'_>,
) -> (Entity, Vec<OptionOutcome>) {
    let places = 0..group.contacts.len();
    let gap = |place: usize| {
        let (contact, normal) = (group.contacts[place], group.frames[place].normal);
        forms.motion(|rate| dot(&normal, &loading.relative_rate(contact, state, rate)))
    };
    let gaps: Vec<usize> = places.clone().map(gap).collect();
    let (mut options, mut outcomes) = (Vec::new(), Vec::new());
    let modes_with = |active: Option<usize>| {
        let mode = |place: usize| if active == Some(place) { Mode::Slip { direction: [0.0; 3] } } else { Mode::Free };
        OptionOutcome { modes: places.clone().map(|place| (group.contacts[place], mode(place))).collect() }
    };
    for place in places.clone() {
        let form = group.face_form(place);
        if !unloaded && dot(&form, &entry.force) <= zero {
            continue;
        }
        let others = places.clone().filter(|other| *other != place);
        let mut nonnegative: Vec<Signed> = others.map(|other| Signed::plus(gaps[other])).collect();
        if unloaded {
            nonnegative.push(Signed::plus(forms.force_along(entry, &form)));
        }
        options.push(Choice { zero: vec![gaps[place]], nonnegative, implied: Vec::new() });
        outcomes.push(modes_with(Some(place)));
    }
    if unloaded {
        let apart = group.free.iter().map(|direction| forms.force_along(entry, direction)).collect();
        let nonnegative = gaps.iter().map(|gap| Signed::plus(*gap)).collect();
        options.push(Choice { zero: apart, nonnegative, implied: Vec::new() });
        outcomes.push(modes_with(None));
    }
    (Entity { options, touching: None }, outcomes)
}

struct Writer<'a, 'f> {
    entry: &'a Changeable,
    group: &'a ContactGroup,
    unloaded: bool,
    zero: f64,
    forms: &'a mut Forms<'f>,
    options: Vec<Choice>,
    outcomes: Vec<OptionOutcome>,
}

impl Writer<'_, '_> {
    fn option(&mut self, zero: Vec<usize>, nonnegative: Vec<Signed>, mode: impl Fn(usize) -> Mode) {
        self.options.push(Choice { zero, nonnegative, implied: Vec::new() });
        let modes = self.group.contacts.iter().enumerate().map(|(place, contact)| (*contact, mode(place))).collect();
        self.outcomes.push(OptionOutcome { modes });
    }

    /// The conditions that all obstacles except those at the indices `but` open.
    fn gaps(&mut self, but: &[usize]) -> Vec<Signed> {
        let others = (0..self.group.contacts.len()).filter(|place| !but.contains(place));
        let normals: Vec<Vector> = others.map(|place| self.group.frames[place].normal).collect();
        normals.iter().map(|normal| Signed::plus(self.forms.velocity(self.entry, normal))).collect()
    }

    fn along(&mut self, direction: &Vector) -> usize {
        self.forms.velocity(self.entry, direction)
    }

    fn normal_of(&mut self, place: usize) -> usize {
        let normal = self.group.frames[place].normal;
        self.along(&normal)
    }

    /// Adds the form of the rate of force less the contribution of the turning of the present reactions.
    fn off(&mut self, form: &Vector, places: &[usize], direction: &Vector, normals: &[f64]) -> usize {
        let mut row = self.forms.force_rate(self.entry, form);
        for (column, motion) in &self.entry.velocities {
            let turning = sliding::turning(self.group, places, direction, normals, motion);
            row[*column] -= turning.iter().map(|turned| dot(form, turned)).sum::<f64>();
        }
        self.forms.force(row)
    }

    fn edge(&mut self, places: [usize; 2], direction: Vector, drive: Option<Drive>) {
        let normals = drive.map_or([0.0; 2], |drive| drive.normals);
        let drag = self.group.edge_drive(places, &direction);
        let zero =
            vec![self.normal_of(places[0]), self.normal_of(places[1]), self.off(&drag, &places, &direction, &normals)];
        let mut nonnegative = vec![Signed::plus(self.along(&direction))];
        for (form, normal) in self.group.edge_forms(places, &direction).iter().zip(normals) {
            if self.unloaded || normal <= self.zero {
                nonnegative.push(Signed::plus(self.forms.force_along(self.entry, form)));
            }
        }
        let frictions = self.group.frictions.clone();
        self.option(zero, nonnegative, |place| {
            let rubs = if frictions[place].is_rough() { direction } else { [0.0; 3] };
            if places.contains(&place) { Mode::Slip { direction: rubs } } else { Mode::Free }
        });
    }

    fn face(&mut self, place: usize, drive: &Drive) {
        let (group, direction) = (self.group, drive.direction);
        let friction = group.frictions[place];
        let slack = friction.slack_form(&group.face_form(place), &direction);
        let mut zero = vec![self.normal_of(place), self.off(&slack, &[place], &direction, &drive.normals[..1])];
        if group.free.len() == 3 {
            let across = cross(&group.frames[place].normal, &direction);
            zero.push(self.along(&across));
        }
        let mut nonnegative = vec![Signed::plus(self.along(&direction))];
        for form in group.turns_off(place, &direction) {
            nonnegative.push(Signed::plus(self.forms.force_along(self.entry, &form)));
        }
        self.option(zero, nonnegative, |other| if other == place { Mode::Slip { direction } } else { Mode::Free });
    }

    /// Adds the slides of an unloaded node that is guided in a plane.
    fn guided_face(&mut self, place: usize) {
        let group = self.group;
        let normal = group.face_form(place);
        for sense in [1.0, -1.0] {
            let direction = scaled(&group.frames[place].tangents[0], sense);
            let slack = group.frictions[place].slack_form(&normal, &direction);
            let zero = vec![self.normal_of(place), self.forms.force_along(self.entry, &slack)];
            let mut nonnegative = self.gaps(&[place]);
            nonnegative.push(Signed::plus(self.along(&direction)));
            nonnegative.push(Signed::plus(self.forms.force_along(self.entry, &normal)));
            self.option(zero, nonnegative, |other| if other == place { Mode::Slip { direction } } else { Mode::Free });
        }
    }

    fn smooth_face(&mut self, place: usize, drive: Option<Drive>) {
        let group = self.group;
        let normals = drive.map_or([0.0], |drive| [drive.normals[0]]);
        let tangents = group.frames[place].tangents;
        let mut zero = vec![self.normal_of(place)];
        for tangent in tangents.iter().take(group.free.len() - 1) {
            zero.push(self.off(tangent, &[place], &[0.0; 3], &normals));
        }
        let mut nonnegative = self.gaps(&[place]);
        if self.unloaded {
            nonnegative.push(Signed::plus(self.forms.force_along(self.entry, &group.face_form(place))));
        }
        let slip = Mode::Slip { direction: [0.0; 3] };
        self.option(zero, nonnegative, |other| if other == place { slip } else { Mode::Free });
    }
}
