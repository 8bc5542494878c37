//! The arch on a rough floor.

use arcslip::model::JobRequest;
use serde_json::{Map, Value, json};
use std::f64::consts::FRAC_PI_2;

/// Half an arch on a rough floor, of beams with three nodes.
pub fn round_arch(friction: f64) -> JobRequest {
    let count = 32;
    let mut nodes = Map::new();
    for k in 0..=count {
        let angle = FRAC_PI_2 * f64::from(k) / f64::from(count);
        nodes.insert(format!("n{k}"), json!([angle.sin(), if k == count { 0.0 } else { angle.cos() }]));
    }
    let element = |k: i32| {
        let ends = [0, 1, 2].map(|one| format!("n{}", 2 * k + one));
        json!({"kind": "beam", "nodes": ends, "axial_stiffness": 1e6, "bending_stiffness": 1.0})
    };
    let elements: Vec<Value> = (0..count / 2).map(element).collect();
    let request = json!({
        "model": {
            "dimension": 2, "nodes": nodes, "elements": elements, "supports": {"n0": ["x", "rz"]},
            "obstacles": {"floor": {"kind": "plane", "point": [0, 0], "normal": [0, 1]}},
            "contacts": [{"node": format!("n{count}"), "obstacle": "floor", "friction": friction}],
            "stages": [{
                "name": "press", "forces": {"n0": [0, -0.5]},
                "until": {"displacement": {"node": "n0", "component": "y", "below": -1}},
            }],
        },
    });
    serde_json::from_value(request).expect("a request")
}
