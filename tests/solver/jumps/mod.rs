//! Jumps to the next state at rest, load control, and whether states are stable.

mod critical_states;
mod cycles;
mod random_trusses;
mod remembered;
mod rough_stops;
mod snaps;
mod stability;
mod stage_ends;
mod truss_in_motion;

use crate::common::paths::typed;
use crate::common::random::Numbers;
use arcslip::model::JobRequest;
use arcslip::result::increment::{Increment, PointKind};
use serde_json::{Map, Value, json};

/// The state before a jump and the one after it.
pub fn jump(increments: &[Increment]) -> (&Increment, &Increment) {
    let place = increments.iter().position(|one| one.point.kind == PointKind::Jump).expect("a jump");
    (&increments[place - 1], &increments[place])
}

/// The request of von Mises' truss, `EA = b = 1`, `h = 1/2`, under these stages.
pub fn von_mises(stages: &Value, analysis: &Value) -> Value {
    json!({
        "model": {
            "dimension": 2, "nodes": {"left": [-1, 0], "apex": [0, 0.5], "right": [1, 0]},
            "supports": {"left": ["x", "y"], "right": ["x", "y"]},
            "elements": [
                {"kind": "bar", "nodes": ["left", "apex"], "axial_stiffness": 1},
                {"kind": "bar", "nodes": ["apex", "right"], "axial_stiffness": 1},
            ],
            "stages": stages,
        },
        "analysis": analysis,
    })
}

/// A flat truss of two to four nodes over a floor that may slant, its right end held or on a rough bed, pressed down.
pub fn flat_truss(numbers: &mut Numbers) -> JobRequest {
    let count = 2 + numbers.below(3);
    let height = numbers.between(0.2, 0.6);
    let mut nodes = Map::new();
    nodes.insert("l".into(), json!([-1, 0]));
    let names: Vec<String> = (1..=count).map(|k| format!("m{k}")).collect();
    for (k, name) in names.iter().enumerate() {
        let x = -1.0 + 2.0 * (k + 1) as f64 / (count + 1) as f64;
        let y = height * (1.0 - x * x) + numbers.between(0.0, 0.1);
        nodes.insert(name.clone(), json!([x + numbers.between(-0.05, 0.05), y]));
    }
    nodes.insert("r".into(), json!([1, 0]));
    let row: Vec<String> = nodes.keys().cloned().collect();
    let mut elements: Vec<Value> =
        row.windows(2).map(|ends| json!({"kind": "bar", "nodes": ends, "axial_stiffness": 1})).collect();
    for ends in row.windows(3) {
        let stiffness = numbers.between(0.05, 0.5);
        elements.push(json!({"kind": "bar", "nodes": [ends[0], ends[2]], "axial_stiffness": stiffness}));
    }
    let mut spring = |node: &str, x: f64, y: f64| {
        elements.push(json!({"kind": "spring", "nodes": [node], "stiffness": [[x, 0], [0, y]]}));
    };
    for name in &names {
        spring(name, numbers.between(0.001, 0.02), numbers.between(0.001, 0.02));
    }
    let friction = [0.0, 0.2, 0.5, 1.0][numbers.below(4)];
    let mut supports = json!({"l": ["x", "y"]});
    let floor =
        json!({"kind": "plane", "point": [0, -numbers.between(0.0, 0.3)], "normal": [numbers.between(-0.2, 0.2), 1]});
    let mut obstacles = json!({"floor": floor});
    let mut contacts: Vec<Value> = Vec::new();
    if numbers.chance(0.5) {
        supports["r"] = json!(["x", "y"]);
    } else {
        obstacles["bed"] = json!({"kind": "plane", "point": [0, 0], "normal": [0, 1]});
        contacts.push(json!({"node": "r", "obstacle": "bed", "friction": friction}));
        spring("r", numbers.between(0.02, 0.2), 0.0);
    }
    let mut forces = Map::new();
    for name in &names {
        contacts.push(json!({"node": name, "obstacle": "floor", "friction": friction}));
        forces.insert(name.clone(), json!([numbers.between(-0.3, 0.3), -numbers.between(0.2, 1.0)]));
    }
    typed(json!({
        "model": {
            "dimension": 2, "nodes": nodes, "supports": supports, "elements": elements, "obstacles": obstacles,
            "contacts": contacts,
            "stages": [{"name": "load", "forces": forces, "until": {"load_above": numbers.between(0.02, 0.3)}}],
        },
    }))
}
