//! Contacts out of reach, which take no part in the path's equations until it comes near them.
//!
//! Over an arc length `a` a contact's gap changes by at most `a √(1 + |d|²)`, `d` the translation of its obstacle per load
//! factor: its node moves against the obstacle by `Δu - d Δs`, `‖(Δu, Δs)‖ <= a`, and a gap changes by no more than the
//! motion (it is a signed distance). So a gap `g` cannot close before the path has gone on by `g/√(1 + |d|²)`, and is not
//! looked at before then. A contact that could be reached within a few steps joins the others and stays with them. Which
//! ones do follows from their gaps alone, not from when these were looked at.
//!
//! A contact that is out of reach is free, without reaction: the equations that the others have are those of the whole.

use super::at_hand::AtHand;
use super::corner::Corner;
use super::follow::Listed;
use super::loading::{LoadPattern, Loading};
use super::plan::LeftOut;
use super::progress::{Held, Progress, Visited};
use super::scene::Scene;
use super::state::{Rate, State};
use super::tracer::Path;
use crate::contact::vector::size;
use crate::contact::{Contact, Mode, Reaction};
use crate::model::JobRequest;
use crate::model::limits::MAX_ROWS_UNASKED;
use crate::model::request::{ContactRange, Method, RecordedContacts};
use std::cmp::Ordering;
use std::collections::{BinaryHeap, HashSet};
use std::sync::Arc;

/// A contact is in reach that this many steps could close: more than the one that is taken, so that what is tried past
/// its end (the program of an increment looks three steps ahead) finds every contact it needs.
const REACH: f64 = 4.0;
/// What rounding may do to a bound.
const ROUNDING: f64 = 1e-9;

/// The contacts in reach, with the loading as it concerns them.
#[derive(Debug, Clone)]
pub(super) struct Near {
    contacts: Vec<Contact>,
    corners: Vec<Corner>,
    pattern: LoadPattern,
    held: LoadPattern,
    /// For each contact of the scene its place among those in reach.
    places: Vec<Option<usize>>,
    /// The request's contacts that have a row in the increments: those in reach and those that are asked for.
    rows: Vec<usize>,
}

/// The contacts out of reach, the one that may be reached first on top.
pub(super) type FarContacts = BinaryHeap<Far>;

/// A contact out of reach.
#[derive(Debug, Clone, Copy)]
pub(super) struct Far {
    /// Arc length of the path before which its gap cannot close.
    until: f64,
    contact: usize,
}

/// The one that may be reached first is the greatest.
impl Ord for Far {
    fn cmp(&self, other: &Self) -> Ordering {
        other.until.total_cmp(&self.until).then(other.contact.cmp(&self.contact))
    }
}

impl PartialOrd for Far {
    fn partial_cmp(&self, other: &Self) -> Option<Ordering> {
        Some(self.cmp(other))
    }
}

impl PartialEq for Far {
    fn eq(&self, other: &Self) -> bool {
        self.cmp(other) == Ordering::Equal
    }
}

impl Eq for Far {}

/// How far a contact's gap may change by unit arc length, in any stage.
fn fastest(scene: &Scene, contact: usize) -> f64 {
    let shift = scene.stages.iter().fold(0.0_f64, |most, stage| most.max(size(&stage.pattern.shifts[contact])));
    shift.hypot(1.0)
}

/// What the plan says of the contacts that are out of reach where the path begins.
pub(super) fn left_out(scene: &Scene) -> Vec<LeftOut> {
    let analysis = &scene.analysis;
    if analysis.keep_all || analysis.method == Method::Regularised {
        return Vec::new();
    }
    let reach = REACH * analysis.arc_length.initial;
    let gap = |contact: usize| scene.contacts[contact].gap(&[0.0; 3]);
    let is_far = |contact: &usize| gap(*contact) / fastest(scene, *contact) > reach;
    let far = (0..scene.contacts.len()).filter(is_far).count();
    let mut left_out = Vec::new();
    if far > 0 {
        left_out.push(LeftOut {
            what: format!("{far} of {} contacts, each until the path comes near it", scene.contacts.len()),
            why: format!("their gaps cannot close within {REACH} steps"),
        });
    }
    if let (true, Some(asked)) = (far > 0, &scene.asked_rows)
        && asked.is_empty()
    {
        left_out.push(LeftOut {
            what: "rows of contacts out of reach, each until the path comes near it".to_owned(),
            why: match analysis.record.as_ref().and_then(|record| record.contacts.as_ref()) {
                None => {
                    format!("of more than {MAX_ROWS_UNASKED} contacts, only rows in `record.contacts` are given before")
                }
                Some(_) => "`record.contacts` asks for those in reach".to_owned(),
            },
        });
    }
    left_out
}

/// Which contacts of the request have a row in every increment, in reach or not; `None`: all.
pub(super) fn asked_rows(request: &JobRequest) -> Option<Vec<usize>> {
    let (analysis, contacts) = (&request.analysis, &request.model.contacts);
    if analysis.keep_all || analysis.method == Method::Regularised {
        return None;
    }
    match analysis.record.as_ref().and_then(|record| record.contacts.as_ref()) {
        None if contacts.len() <= MAX_ROWS_UNASKED => None,
        Some(RecordedContacts::Range(ContactRange::All)) => None,
        None | Some(RecordedContacts::Range(ContactRange::InReach)) => Some(Vec::new()),
        Some(RecordedContacts::Named(named)) => {
            let named: HashSet<(&str, &str)> =
                named.iter().map(|one| (one.node.as_str(), one.obstacle.as_str())).collect();
            let is_named = |index: &usize| {
                let contact = &contacts[*index];
                named.contains(&(contact.node.as_str(), contact.obstacle.as_str()))
            };
            Some((0..contacts.len()).filter(is_named).collect())
        }
    }
}

/// The loading of all contacts; a state's reactions are not to be read through it.
fn whole<'a>(scene: &'a Scene, at: &'a Progress) -> Loading<'a> {
    Loading {
        structure: &scene.structure,
        contacts: &scene.contacts,
        corners: &scene.corners,
        pattern: &scene.stages[at.stage].pattern,
        held: &at.held,
    }
}

/// The contacts that `at` has out of reach.
pub(super) fn far_contacts(scene: &Scene, at: &Progress) -> FarContacts {
    let loading = whole(scene, at);
    let far = |contact: &usize| at.near.binary_search(contact).is_err();
    let waiting = |contact: usize| Far::at(scene, contact, loading.gap(contact, &at.here.state), at.totals.arc_length);
    (0..scene.contacts.len()).filter(far).map(waiting).collect()
}

impl Far {
    /// With this gap after the path has gone so far.
    fn at(scene: &Scene, contact: usize, gap: f64, travelled: f64) -> Self {
        let way = gap / fastest(scene, contact);
        Self { until: travelled + way - ROUNDING * (travelled + way), contact }
    }
}

impl Near {
    /// The contacts that `at` has in reach.
    pub fn of(scene: &Scene, at: &Progress) -> Self {
        let mut places = vec![None; scene.contacts.len()];
        for (place, contact) in at.near.iter().enumerate() {
            places[*contact] = Some(place);
        }
        let stage = &scene.stages[at.stage].pattern;
        let chosen = |pattern: &LoadPattern| LoadPattern {
            forces: pattern.forces.clone(),
            supports: pattern.supports.clone(),
            shifts: at.near.iter().map(|contact| pattern.shifts[*contact]).collect(),
        };
        let corners = scene.corners.iter().filter_map(|corner| {
            let contacts: Vec<usize> = corner.contacts.iter().filter_map(|contact| places[*contact]).collect();
            (contacts.len() > 1).then_some(Corner { contacts })
        });
        let asked: Box<dyn Fn(usize) -> bool> = match &scene.asked_rows {
            None => Box::new(|_| true),
            Some(asked) => Box::new(|row| asked.binary_search(&row).is_ok()),
        };
        let has_row = |row: &usize| asked(*row) || places[scene.reported[*row].contact].is_some();
        let rows = (0..scene.reported.len()).filter(has_row).collect();
        Self {
            contacts: at.near.iter().map(|contact| scene.contacts[*contact].clone()).collect(),
            corners: corners.collect(),
            pattern: chosen(stage),
            held: chosen(&at.held),
            places,
            rows,
        }
    }

    pub fn loading<'a>(&'a self, scene: &'a Scene) -> Loading<'a> {
        Loading {
            structure: &scene.structure,
            contacts: &self.contacts,
            corners: &self.corners,
            pattern: &self.pattern,
            held: &self.held,
        }
    }

    /// For each contact of the scene its place among those in reach.
    pub fn places(&self) -> &[Option<usize>] {
        &self.places
    }

    /// The request's contacts that have a row in the increments, in its order.
    pub fn rows(&self) -> &[usize] {
        &self.rows
    }
}

impl Path<'_> {
    /// The loading of all contacts, for what is said of those out of reach.
    pub(super) fn whole_loading(&self) -> Loading<'_> {
        whole(self.scene, &self.at)
    }

    /// Takes in every contact that could close within a few steps of this arc length.
    pub(super) fn look_ahead(&mut self, step: f64) {
        let (reach, travelled) = (REACH * step, self.at.totals.arc_length);
        let (mut reached, mut left) = (Vec::new(), Vec::new());
        while self.far.peek().is_some_and(|next| next.until <= travelled + reach) {
            let Some(Far { contact, .. }) = self.far.pop() else { break };
            let gap = self.whole_loading().gap(contact, &self.at.here.state);
            if gap / fastest(self.scene, contact) <= reach {
                reached.push(contact);
            } else {
                left.push(Far::at(self.scene, contact, gap, travelled));
            }
        }
        self.far.extend(left);
        if !reached.is_empty() {
            self.at.admit(&reached);
            self.near = Near::of(self.scene, &self.at);
            (self.at_hand, self.at.here.is_factorised) = (AtHand::default(), false);
        }
    }

    /// The loading of the running stage, after a change of stage.
    pub(super) fn load_anew(&mut self) {
        (self.at_hand, self.at.here.is_factorised) = (AtHand::default(), false);
        self.near = Near::of(self.scene, &self.at);
    }

    /// Names of the nodes and obstacles of the contacts in reach.
    pub(super) fn names(&self) -> impl Iterator<Item = &(Arc<str>, Arc<str>)> {
        self.at.near.iter().map(|contact| &self.scene.contact_names[*contact])
    }

    /// The present state, as it is remembered: a contact that is free has no reaction and is not named.
    pub(super) fn visit(&self) -> Visited {
        let State { displacement, load, reactions } = &self.at.here.state;
        let held = self.at.near.iter().zip(&self.at.here.modes).zip(reactions);
        let held = held.filter(|((_, mode), _)| mode.is_active());
        let held = held.map(|((contact, mode), reaction)| Held { contact: *contact, mode: *mode, reaction: *reaction });
        let mut all = Vec::with_capacity(self.at.near.len());
        all.extend(held);
        Visited { stage: self.at.stage, displacement: displacement.clone(), load: *load, held: all }
    }
}

fn spread(near: &[Reaction], places: &[Option<usize>]) -> Vec<Reaction> {
    places.iter().map(|place| place.map_or_else(Reaction::default, |place| near[place])).collect()
}

fn spread_modes(near: &[Mode], places: &[Option<usize>]) -> Vec<Mode> {
    places.iter().map(|place| place.map_or(Mode::Free, |place| near[place])).collect()
}

impl Progress {
    /// Numbers the contacts in reach anew, some more among them, which are free.
    fn admit(&mut self, contacts: &[usize]) {
        let before = self.near.clone();
        self.near.extend(contacts);
        self.near.sort_unstable();
        let old: Vec<Option<usize>> = self.near.iter().map(|contact| before.binary_search(contact).ok()).collect();
        let reactions = |values: &mut Vec<Reaction>| *values = spread(values, &old);
        let modes = |values: &mut Vec<Mode>| *values = spread_modes(values, &old);
        let rate = |rate: &mut Rate| reactions(&mut rate.reactions);
        let listed = |listed: &mut Listed| {
            for option in &mut listed.options {
                rate(&mut option.rate);
                modes(&mut option.modes);
            }
            listed.arriving.iter_mut().for_each(|arriving| modes(&mut arriving.modes));
        };
        let state = |state: &mut State| reactions(&mut state.reactions);
        state(&mut self.here.state);
        modes(&mut self.here.modes);
        self.here.rate.iter_mut().for_each(rate);
        self.here.drift.iter_mut().for_each(rate);
        if let Some(before) = &mut self.here.before {
            state(&mut before.state);
            rate(&mut before.rate);
        }
        if let Some((begun, direction)) = &mut self.begun {
            state(begun);
            rate(direction);
        }
        self.listed.iter_mut().for_each(listed);
        self.followed.iter_mut().for_each(|followed| listed(&mut followed.listed));
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::cancel::CancelFlag;
    use crate::model::JobRequest;
    use serde_json::{Value, json};

    /// A node on springs over a floor, drawn towards a wall, with walls much farther away.
    fn request(far: usize, keep_all: bool) -> JobRequest {
        let mut obstacles = json!({
            "floor": {"kind": "plane", "point": [0, 0], "normal": [0, 1]},
            "wall": {"kind": "plane", "point": [2, 0], "normal": [-1, 0]},
        });
        let contact = |name: &str| json!({"node": "tip", "obstacle": name, "friction": 0.3});
        let mut contacts: Vec<Value> = Vec::new();
        for index in 0..far {
            let name = format!("far{index}");
            obstacles[&name] = json!({"kind": "ball", "center": [10 + index, 50], "radius": 5});
            contacts.push(contact(&name));
        }
        contacts.extend([contact("floor"), contact("wall")]);
        serde_json::from_value(json!({
            "model": {
                "dimension": 2, "nodes": {"tip": [0, 0]},
                "elements": [{"kind": "spring", "nodes": ["tip"], "stiffness": [[1, 0.2], [0.2, 1]]}],
                "obstacles": obstacles, "contacts": contacts,
                "stages": [
                    {"name": "press", "forces": {"tip": [0, -1]}, "until": {"load_above": 1}},
                    {"name": "pull", "forces": {"tip": [1, 0]}, "until": {"load_above": 4}},
                    {"name": "slide", "obstacle_motion": {"wall": [-1, 0]}, "until": {"load_above": 1}},
                ],
            },
            "analysis": {"keep_all": keep_all, "arc_length": {"jump": false}},
        }))
        .expect("a request")
    }

    #[test]
    fn only_what_can_be_reached_is_in_the_equations() {
        let request = request(500, false);
        let scene = Scene::new(&request).expect("a scene");
        assert!(scene.plan().left_out.iter().any(|left| left.what.starts_with("501 of 502 contacts")));
        let mut path = Path::new(&scene, CancelFlag::default());
        let mut seen = Vec::new();
        let mut looks = 0;
        while path.next().is_some() {
            if seen.last() != Some(&path.at.near) {
                seen.push(path.at.near.clone());
            }
            looks += path.far.iter().filter(|far| far.until <= path.at.totals.arc_length).count();
        }
        assert_eq!(seen, [vec![500], vec![500, 501]], "the floor, then the wall too");
        assert_eq!(looks, 0, "no far contact was looked at again");
    }

    #[test]
    fn with_and_without_far_contacts_it_is_one_path_and_can_be_taken_up_anywhere() {
        let rows = |far: usize, keep_all: bool| {
            let scene = Scene::new(&request(far, keep_all)).expect("a scene");
            let mut path = Path::new(&scene, CancelFlag::default());
            let mut rows = Vec::new();
            while let Some(row) = path.next() {
                rows.push(row);
                // Put down and taken up at every point.
                path = Path::resume(&scene, path.checkpoint(), CancelFlag::default()).expect("a path");
            }
            rows
        };
        let none = rows(0, true);
        assert!(none.len() > 10 && none.iter().any(|row| row.contacts[1].normal_reaction > 0.0));
        for others in [rows(0, false), rows(30, false), rows(30, true)] {
            assert_eq!(others.len(), none.len());
            for (other, row) in others.iter().zip(&none) {
                let far = other.contacts.len() - 2;
                assert_eq!((other.load_factor, &other.displacements), (row.load_factor, &row.displacements));
                assert_eq!((&other.contacts[far..], &other.point), (&row.contacts[..], &row.point));
                assert!(other.contacts[..far].iter().all(|contact| contact.gap > 1.0));
            }
        }
    }
}
