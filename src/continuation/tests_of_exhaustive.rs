//! Whole paths whose last point is searched again, by plain enumeration of every contact mode.

use crate::branching::directions::arrival_tangent::Incoming;
use crate::branching::directions::condensed_rate_problem::Condensed;
use crate::complementarity::rate_search::tests::every_combination;
use crate::continuation::path::iterator::Path;
use crate::continuation::scene::Scene;
use crate::mechanics::contact::Mode;
use crate::mechanics::equations::ModeSystem;
use crate::mechanics::multi_contact::changeable_contacts::Standing;
use crate::resources::cancel::CancelFlag;
use crate::result::stop_reason::StopReason;
use serde_json::{Map, json};

/// A row of snapping bars (formulation: pins `(3i, 1)`, tips `(3i - a_i, 0)`, `a_i = 1.5 + 0.1 i/(n-1)`).
fn row(n: usize) -> Scene {
    let (mut nodes, mut supports, mut forces) = (Map::new(), Map::new(), Map::new());
    let (mut elements, mut contacts) = (Vec::new(), Vec::new());
    for i in 0..n {
        let (pin, tip, x) = (format!("pin{i}"), format!("tip{i}"), 3.0 * i as f64);
        nodes.insert(pin.clone(), json!([x, 1.0]));
        nodes.insert(tip.clone(), json!([x - 1.5 - 0.1 * i as f64 / (n - 1) as f64, 0.0]));
        supports.insert(pin.clone(), json!(["x", "y"]));
        elements.push(json!({"kind": "bar", "nodes": [&pin, &tip], "axial_stiffness": 1.0}));
        if i > 0 {
            let before = format!("tip{}", i - 1);
            elements.push(json!({"kind": "bar", "nodes": [before, &tip], "axial_stiffness": 0.5}));
        }
        contacts.push(json!({"node": &tip, "obstacle": "floor", "friction": 0.3}));
        forces.insert(tip, json!([1.0, 0.0]));
    }
    let document = json!({"model": {
        "dimension": 2, "nodes": nodes, "supports": supports, "elements": elements, "contacts": contacts,
        "obstacles": {"floor": {"kind": "plane", "point": [0, 0], "normal": [0, 1]}},
        "stages": [{"name": "push", "forces": forces}],
    }});
    let request = crate::model::decode::decode(document.to_string().as_bytes()).expect("a request");
    Scene::new(&request).expect("a scene")
}

#[test]
fn where_rows_of_bars_end_only_the_way_back_is_a_direction() {
    for n in [4, 20] {
        let scene = row(n);
        let mut path = Path::new(&scene, CancelFlag::default());
        path.by_ref().for_each(drop);
        assert_eq!(path.report().map(|report| report.stop_reason), Some(StopReason::NoDirection));
        let state = &path.trace.at.here.state;
        let incoming = path.trace.at.here.rate.as_ref().expect("the direction of the last step");
        let standings = path.trace.standings(state);
        let held: Vec<Mode> = standings
            .iter()
            .map(|standing| if let Standing::Settled(mode) = standing { *mode } else { Mode::Stick })
            .collect();
        assert!(standings.iter().any(|standing| matches!(standing, Standing::OnCone { .. })));
        let system = ModeSystem::new(path.trace.loading(), &held, state);
        let condensed =
            Condensed::new(&system, path.trace.loading(), state, &standings, Some(Incoming::along(incoming)))
                .expect("regular");
        let found = every_combination(condensed.problem());
        assert!(!found.degenerate);
        for ray in &found.rays {
            // Only the incoming step in reverse is feasible.
            assert!(condensed.combine(&ray.weights).0.product(incoming) < -1.0 + 1e-4, "n = {n}: {ray:?}");
        }
        println!("n = {n}: {} rays", found.rays.len());
    }
}
