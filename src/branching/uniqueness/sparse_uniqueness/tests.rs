//! The directions listed by the sparse proof, compared with those of the condensed equations.

use crate::branching::directions::arrival_tangent::Incoming;
use crate::branching::directions::candidate::{CandidateDirection, FoundDirections};
use crate::branching::directions::condensed_rate_problem::Condensed;
use crate::branching::uniqueness::sparse_uniqueness::directions;
use crate::complementarity::rate_search::tests::Random;
use crate::continuation::path::iterator::Path;
use crate::continuation::scene::Scene;
use crate::mechanics::contact::Mode;
use crate::mechanics::equations::ModeSystem;
use crate::mechanics::multi_contact::changeable_contacts::Standing;
use crate::mechanics::problem::state::Rate;
use crate::resources::cancel::CancelFlag;
use serde_json::{Map, json};

/// A chain of blocks on a floor, joined by springs that press or lift them as they are drawn out.
fn chain(blocks: usize, coupling: f64) -> Scene {
    let (mut nodes, mut weights) = (Map::new(), Map::new());
    let (mut elements, mut contacts) = (Vec::new(), Vec::new());
    for block in 0..blocks {
        let name = format!("block{block}");
        nodes.insert(name.clone(), json!([-(block as f64), 0]));
        weights.insert(name.clone(), json!([0, -1.0 - 0.1 * (block % 3) as f64]));
        contacts.push(json!({"node": &name, "obstacle": "floor", "friction": 0.3}));
        if block > 0 {
            let stiffness = json!([[1, coupling], [coupling, 0.5]]);
            elements.push(
                json!({"kind": "spring", "nodes": [format!("block{}", block - 1), name], "stiffness": stiffness}),
            );
        }
    }
    let request = json!({
        "model": {
            "dimension": 2, "nodes": nodes, "elements": elements, "contacts": contacts,
            "obstacles": {"floor": {"kind": "plane", "point": [0, 0], "normal": [0, 1]}},
            "stages": [
                {"name": "weigh", "forces": weights, "until": {"load_above": 1}},
                {"name": "pull", "forces": {"block0": [1, 0.02]}, "until": {"contact_change": blocks}},
            ],
        },
    });
    Scene::new(&serde_json::from_value(request).expect("a request")).expect("a scene")
}

/// The directions that the proof and the condensed equations list at a point; `None` where there is no proof.
fn both(path: &Path<'_>, incoming: Option<&Rate>) -> Option<(FoundDirections, FoundDirections)> {
    let (loading, state) = (path.trace.loading(), &path.trace.at.here.state);
    let (standings, effort) = (path.trace.standings(state), path.trace.rules().effort);
    let (mut own, mut others) = (FoundDirections::default(), FoundDirections::default());
    if !directions(loading, state, &standings, incoming.map(Incoming::along), effort, &mut own) {
        return None;
    }
    let held: Vec<Mode> = standings
        .iter()
        .zip(loading.contacts)
        .map(|(standing, contact)| match standing {
            Standing::Settled(mode) => *mode,
            Standing::Touching if contact.tangents() == 0 => Mode::Slip { direction: [0.0; 3] },
            _ => Mode::Stick,
        })
        .collect();
    let system = ModeSystem::new(loading, &held, state);
    let condensed =
        Condensed::new(&system, loading, state, &standings, incoming.map(Incoming::along)).expect("a regular point");
    condensed.enumerate(&held, state, incoming, effort, &mut others);
    Some((own, others))
}

fn assert_alike(own: &FoundDirections, others: &FoundDirections, place: &str) {
    assert_eq!((own.candidates.len(), own.unexplored), (others.candidates.len(), others.unexplored), "{place}");
    for one in &own.candidates {
        let alike = |other: &&CandidateDirection| other.rate.product(&one.rate) > 1.0 - 1e-12;
        let other = others.candidates.iter().find(alike).unwrap_or_else(|| panic!("the same direction: {place}"));
        assert!((one.dissipation - other.dissipation).abs() < 1e-12, "{place}");
        assert_eq!((&one.modes, one.weak), (&other.modes, other.weak), "{place}");
        let in_doubt =
            |of: &CandidateDirection| of.alternatives.iter().filter(|all| all.len() > 1).cloned().collect::<Vec<_>>();
        assert_eq!(in_doubt(one), in_doubt(other), "{place}");
    }
}

#[test]
fn the_directions_are_those_of_the_condensed_equations() {
    for coupling in [0.0, -0.05] {
        let scene = chain(20, coupling);
        let mut path = Path::new(&scene, CancelFlag::default());
        let mut compared = 0;
        while path.next().is_some() {
            let Some(incoming) = path.trace.at.here.rate.clone() else { continue };
            let Some((own, others)) = both(&path, Some(&incoming)) else { continue };
            assert_alike(&own, &others, &format!("coupling {coupling}"));
            compared += 1;
        }
        assert!(compared >= 3, "coupling {coupling}: {compared}");
    }
}

/// Past their limit point the bars of a row snap through: the load's power distinguishes the directions.
#[test]
fn past_a_limit_point_they_are_the_same_too() {
    let request = serde_json::from_value(crate::check::scenes::of_any_size::row_of_bars(20)).expect("a request");
    let scene = Scene::new(&request).expect("a scene");
    let mut path = Path::new(&scene, CancelFlag::default());
    let (mut rising, mut falling) = (0, 0);
    while path.next().is_some() {
        let Some(incoming) = path.trace.at.here.rate.clone() else { continue };
        let Some((own, others)) = both(&path, Some(&incoming)) else { continue };
        assert_eq!((own.candidates.len(), own.unexplored), (others.candidates.len(), 0));
        for one in &own.candidates {
            assert!(others.candidates.iter().any(|other| other.rate.product(&one.rate) > 1.0 - 1e-12));
        }
        if incoming.load > 0.0 {
            rising += 1;
        } else {
            falling += 1;
        }
    }
    assert!(rising > 10 && falling > 3, "{rising} {falling}");
}

/// Nodes on a floor without reactions yet, springs of all directions between them and to the ground.
#[test]
fn from_rest_they_are_those_of_every_combination() {
    let mut random = Random::new(7);
    let (mut proven, mut free) = (0, 0);
    for number in 0..150 {
        let count = 4 + number % 3;
        let stiffness = |random: &mut Random, rank: usize| {
            let mut matrix = [[0.0; 2]; 2];
            for _ in 0..rank {
                let (a, b) = (random.value(), random.value());
                matrix = [[matrix[0][0] + a * a, matrix[0][1] + a * b], [matrix[1][0] + a * b, matrix[1][1] + b * b]];
            }
            json!(matrix)
        };
        let (mut nodes, mut forces) = (Map::new(), Map::new());
        let (mut elements, mut contacts) = (Vec::new(), Vec::new());
        for node in 0..count {
            let name = format!("n{node}");
            nodes.insert(name.clone(), json!([node, 0]));
            forces.insert(name.clone(), json!([random.value(), 0.5 * random.value() - 0.3]));
            let friction = if number % 5 == 0 && node == 1 { 0.0 } else { 0.1 + 0.1 * (node % 3) as f64 };
            contacts.push(json!({"node": &name, "obstacle": "floor", "friction": friction}));
            // Some nodes are held by one spring only, so that the structure without contacts can move.
            let rank = 1 + usize::from(number % 2 == 0);
            elements.push(json!({"kind": "spring", "nodes": [&name], "stiffness": stiffness(&mut random, rank)}));
            if node > 0 {
                let ends = [format!("n{}", node - 1), name];
                elements.push(json!({"kind": "spring", "nodes": ends, "stiffness": stiffness(&mut random, 1)}));
            }
        }
        let request = json!({"model": {
            "dimension": 2, "nodes": nodes, "elements": elements, "contacts": contacts,
            "obstacles": {"floor": {"kind": "plane", "point": [0, 0], "normal": [0, 1]}},
            "stages": [{"name": "push", "forces": forces}],
        }});
        let scene = Scene::new(&serde_json::from_value(request).expect("a request")).expect("a scene");
        let mut path = Path::new(&scene, CancelFlag::default());
        path.trace.look_ahead(path.trace.at.step);
        let Some((own, others)) = both(&path, None) else { continue };
        assert_alike(&own, &others, &format!("model {number}"));
        proven += 1;
        free += usize::from(own.candidates.iter().any(|one| one.rate.load == 0.0));
    }
    assert!(proven > 30 && free > 0, "{proven} {free}");
}
