//! Search for contacts out of reach, which do not enter the path's equations until the path comes near them.
//!
//! Over an arc length `a` a contact's gap changes by at most `a √(1 + |d|²)`, with `d` the translation of its obstacle
//! per load factor: its node moves relative to the obstacle by `Δu - d Δs`, `‖(Δu, Δs)‖ <= a`, and a gap changes by no
//! more than the relative motion (it is a signed distance). So a gap `g` cannot close within an arc length of
//! `g/√(1 + |d|²)`, and is not evaluated before. Between two bodies it is their distance, which both may shorten. A contact that could be reached within a few steps joins the others
//! and remains with them. Whether it does follows from its gap alone, not from the points at which the gap was
//! evaluated.
//!
//! A contact out of reach is free, without reaction: the equations of the other contacts are those of the whole scene.

use crate::continuation::path_state::resumable_state::Progress;
use crate::continuation::path_state::tolerances::DISTANCE_ROUND_OFF;
use crate::continuation::scene::Scene;
use crate::continuation::scene::recorded_contacts::way_to_contact;
use crate::continuation::scene::tolerances::REACH_IN_STEPS;
use crate::mechanics::contact::ContactPair;
use crate::mechanics::problem::loading::{LoadPattern, Loading};
use crate::mechanics::problem::node_contact_forces::Corner;
use std::cmp::Ordering;
use std::collections::BinaryHeap;

/// The contacts in reach, with their part of the loading.
#[derive(Debug, Clone)]
pub(crate) struct Near {
    contacts: Vec<ContactPair>,
    corners: Vec<Corner>,
    pattern: LoadPattern,
    held: LoadPattern,
    /// For each contact of the scene its place among the contacts in reach.
    places: Vec<Option<usize>>,
    /// The request's contacts that have a row in the increments: those in reach and those requested.
    rows: Vec<usize>,
}

/// The contacts out of reach, the earliest that may be reached on top.
pub(crate) type FarContacts = BinaryHeap<ContactOutOfReach>;

/// A contact out of reach.
#[derive(Debug, Clone, Copy)]
pub(crate) struct ContactOutOfReach {
    /// Arc length of the path before which the gap cannot close.
    until: f64,
    contact: usize,
}

/// The earliest contact that may be reached is the greatest.
impl Ord for ContactOutOfReach {
    fn cmp(&self, other: &Self) -> Ordering {
        other.until.total_cmp(&self.until).then(other.contact.cmp(&self.contact))
    }
}

impl PartialOrd for ContactOutOfReach {
    fn partial_cmp(&self, other: &Self) -> Option<Ordering> {
        Some(self.cmp(other))
    }
}

impl PartialEq for ContactOutOfReach {
    fn eq(&self, other: &Self) -> bool {
        self.cmp(other) == Ordering::Equal
    }
}

impl Eq for ContactOutOfReach {}

/// The loading of all contacts; it is not valid for a state's reactions.
pub(crate) fn whole<'a>(scene: &'a Scene, at: &'a Progress) -> Loading<'a> {
    Loading {
        structure: &scene.structure,
        contacts: &scene.contacts,
        corners: &scene.corners,
        pattern: &scene.stages[at.stage].pattern,
        held: &at.held,
    }
}

/// The contacts out of reach at the point `at`.
pub(crate) fn far_contacts(scene: &Scene, at: &Progress) -> FarContacts {
    let loading = whole(scene, at);
    let far = |contact: &usize| at.near.binary_search(contact).is_err();
    let waiting = |contact: usize| {
        let state = &at.here.state;
        let way = way_to_contact(scene, contact, &state.displacement, loading.gap(contact, state));
        ContactOutOfReach::at(contact, way, at.totals.arc_length)
    };
    (0..scene.contacts.len()).filter(far).map(waiting).collect()
}

impl ContactOutOfReach {
    /// A contact this way off after the path has covered an arc length `travelled`.
    fn at(contact: usize, way: f64, travelled: f64) -> Self {
        Self { until: travelled + way - DISTANCE_ROUND_OFF * (travelled + way), contact }
    }
}

impl Near {
    /// The contacts in reach at the point `at`.
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

    /// For each contact of the scene its place among the contacts in reach.
    pub fn places(&self) -> &[Option<usize>] {
        &self.places
    }

    /// The request's contacts that have a row in the increments, in the order of the request.
    pub fn rows(&self) -> &[usize] {
        &self.rows
    }
}

/// Removes from the contacts out of reach those that could close within a few steps of this arc length, and returns
/// them.
pub(crate) fn reached_within(scene: &Scene, at: &Progress, far: &mut FarContacts, step: f64) -> Vec<usize> {
    let (reach, travelled) = (REACH_IN_STEPS * step, at.totals.arc_length);
    let (mut reached, mut left) = (Vec::new(), Vec::new());
    while far.peek().is_some_and(|next| next.until <= travelled + reach) {
        let Some(ContactOutOfReach { contact, .. }) = far.pop() else { break };
        let state = &at.here.state;
        let way = way_to_contact(scene, contact, &state.displacement, whole(scene, at).gap(contact, state));
        if way <= reach {
            reached.push(contact);
        } else {
            left.push(ContactOutOfReach::at(contact, way, travelled));
        }
    }
    far.extend(left);
    reached
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::continuation::path::iterator::Path;
    use crate::model::JobRequest;
    use crate::resources::cancel::CancelFlag;
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
            if seen.last() != Some(&path.trace.at.near) {
                seen.push(path.trace.at.near.clone());
            }
            looks += path.trace.far.iter().filter(|far| far.until <= path.trace.at.totals.arc_length).count();
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
                // A checkpoint is made and resumed at every point.
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
