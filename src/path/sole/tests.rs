//! What the sparse certificate lists against the condensed equations.

use super::directions;
use crate::cancel::CancelFlag;
use crate::contact::Mode;
use crate::path::condensed::Condensed;
use crate::path::directions::{Candidate, Found};
use crate::path::mode_system::ModeSystem;
use crate::path::standing::Standing;
use crate::path::{Path, Scene};
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

#[test]
fn the_directions_are_those_of_the_condensed_equations() {
    for coupling in [0.0, -0.05] {
        let scene = chain(20, coupling);
        let mut path = Path::new(&scene, CancelFlag::default());
        let mut compared = 0;
        while path.next().is_some() {
            let (loading, state) = (path.loading(), &path.at.here.state);
            let (standings, effort) = (path.standings(state), path.rules().effort);
            let Some(incoming) = &path.at.here.rate else { continue };
            let (mut own, mut others) = (Found::default(), Found::default());
            if !directions(loading, state, &standings, Some(incoming), effort, &mut own) {
                continue;
            }
            let held: Vec<Mode> = standings
                .iter()
                .map(|standing| match standing {
                    Standing::Settled(mode) => *mode,
                    _ => Mode::Stick,
                })
                .collect();
            let system = ModeSystem::new(loading, &held, state);
            let condensed =
                Condensed::new(&system, loading, state, &standings, Some(incoming)).expect("a regular point");
            condensed.enumerate(&held, state, Some(incoming), effort, &mut others);
            assert_eq!((own.candidates.len(), own.unexplored), (others.candidates.len(), 0));
            for one in &own.candidates {
                let alike = |other: &&Candidate| other.rate.product(&one.rate) > 1.0 - 1e-12;
                let other = others.candidates.iter().find(alike).expect("the same direction");
                assert_eq!((&one.modes, one.weak), (&other.modes, other.weak), "coupling {coupling}");
                assert!((one.dissipation - other.dissipation).abs() < 1e-12);
                assert_eq!(one.alternatives, other.alternatives);
            }
            compared += 1;
        }
        assert!(compared >= 3, "coupling {coupling}: {compared}");
    }
}
