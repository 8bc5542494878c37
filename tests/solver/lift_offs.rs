//! Nodes that slip in space and leave their obstacle, the direction of their slip turning faster and faster.

use crate::common::paths::{trace, typed};
use arcslip::model::JobRequest;
use arcslip::result::stop_reason::StopReason;
use serde_json::{Map, Value, json};

const LEVELS: usize = 15;

/// A lattice tower of 15 levels of four nodes on four footings of a slope of 15 degrees, under its weight and then wind.
fn tower(friction: f64) -> JobRequest {
    let corners = [[1.0, 1.0], [-1.0, 1.0], [-1.0, -1.0], [1.0, -1.0]];
    let name = |level: usize, corner: usize| format!("l{level}c{}", corner % 4);
    let (mut nodes, mut elements) = (Map::new(), Vec::new());
    for level in 0..LEVELS {
        let half = 2.0 - 1.4 * level as f64 / (LEVELS - 1) as f64;
        for (corner, [x, y]) in corners.iter().enumerate() {
            nodes.insert(name(level, corner), json!([x * half, y * half, 1.5 * level as f64]));
        }
    }
    let mut bar = |first: String, last: String, stiffness: f64| {
        elements.push(json!({"kind": "bar", "nodes": [first, last], "axial_stiffness": stiffness}));
    };
    for level in 1..LEVELS {
        for corner in 0..4 {
            bar(name(level - 1, corner), name(level, corner), 2.1e5);
            bar(name(level - 1, corner), name(level, corner + 1), 5.25e4);
            bar(name(level - 1, corner + 1), name(level, corner), 5.25e4);
            bar(name(level, corner), name(level, corner + 1), 5.25e4);
        }
        bar(name(level, 0), name(level, 2), 5.25e4);
    }
    (0..4).for_each(|corner| bar(name(0, corner), name(0, corner + 1), 2.625e4));
    let slope = 15.0_f64.to_radians().tan() / 2.0_f64.sqrt();
    let footing = |(corner, [x, y]): (usize, &[f64; 2])| {
        let plane = json!({"kind": "plane", "point": [2.0 * x, 2.0 * y, 0], "normal": [-x * slope, -y * slope, 1]});
        (format!("footing{corner}"), plane)
    };
    let obstacles: Map<String, Value> = corners.iter().enumerate().map(footing).collect();
    let contact =
        |corner| json!({"node": name(0, corner), "obstacle": format!("footing{corner}"), "friction": friction});
    let on = |from: usize, force: Value| -> Map<String, Value> {
        (from..LEVELS)
            .flat_map(|level| (0..4).map(move |corner| name(level, corner)))
            .map(|name| (name, force.clone()))
            .collect()
    };
    typed(json!({
        "model": {
            "dimension": 3, "nodes": nodes, "elements": elements, "obstacles": obstacles,
            "contacts": (0..4).map(contact).collect::<Vec<Value>>(),
            "stages": [
                {"name": "weight", "forces": on(0, json!([0, 0, -2])), "until": {"load_above": 1}},
                {
                    "name": "wind", "forces": on(1, json!([1, 0.3, 0])),
                    "until": {"displacement": {"node": name(LEVELS - 1, 0), "component": "x", "above": 0.6}},
                },
            ],
        },
        "analysis": {"max_increments": 400},
    }))
}

/// The foot that leaves in the wind slips before by less than a millionth of what the tower sways.
#[test]
fn a_foot_of_a_stiff_tower_leaves_its_footing_while_it_slips() {
    for friction in [0.44, 0.49, 0.5, 0.53, 0.75] {
        let (increments, report) = trace(&tower(friction));
        assert_eq!(report.stop_reason, StopReason::StagesCompleted, "{friction}");
        assert!(
            increments.iter().any(|one| one.point.event.as_deref().is_some_and(|event| event.contains("slip to free")))
        );
        // The limit load of the wind does not depend on how the foot slips before it leaves.
        let largest =
            increments.iter().filter(|one| &*one.stage == "wind").map(|one| one.load_factor).fold(0.0, f64::max);
        println!("{friction}: {} increments, largest load {largest}", increments.len());
        assert!((largest - 0.379_73).abs() < 1e-5, "{largest}");
    }
}
