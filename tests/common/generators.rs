//! Models of any size, made from their numbers: those of the library, and the capstan.

use arcslip::model::JobRequest;
// Each test binary uses its own part of these.
#[allow(unused_imports)]
pub use arcslip::check::scenes::of_any_size::row_of_bars;
#[allow(unused_imports)]
pub use arcslip::check::scenes::of_any_size::slider_chain;
use serde_json::{Map, Value, json};

use super::paths::typed;

fn bar(a: String, b: String, stiffness: f64) -> Value {
    json!({"kind": "bar", "nodes": [a, b], "axial_stiffness": stiffness})
}

/// A chain of n nodes over the upper half of a drum of radius 1, nodes `π/n` apart and `π/(2n)` from the ends of the
/// half. Stage "hold" pulls both ends down by 1; stage "pull" pulls the last node on until `node0` has risen by `rise`.
pub fn capstan(n: usize, friction: f64, axial_stiffness: f64, rise: f64) -> JobRequest {
    let spacing = std::f64::consts::PI / n as f64;
    let angle = |i: usize| (i as f64 + 0.5 - 0.5 * n as f64) * spacing;
    let nodes: Map<String, Value> =
        (0..n).map(|i| (format!("node{i}"), json!([angle(i).sin(), angle(i).cos()]))).collect();
    let elements: Vec<Value> =
        (1..n).map(|i| bar(format!("node{}", i - 1), format!("node{i}"), axial_stiffness)).collect();
    let contacts: Vec<Value> =
        (0..n).map(|i| json!({"node": format!("node{i}"), "obstacle": "drum", "friction": friction})).collect();
    let last = format!("node{}", n - 1);
    let down = json!([0, -1]);
    let hold = Map::from_iter([("node0".to_owned(), down.clone()), (last.clone(), down.clone())]);
    let pull = Map::from_iter([(last, down)]);
    typed(json!({
        "model": {
            "name": format!("capstan of {n} nodes, mu = {friction}"), "dimension": 2, "nodes": nodes,
            "elements": elements, "obstacles": {"drum": {"kind": "ball", "center": [0, 0], "radius": 1}},
            "contacts": contacts,
            "stages": [
                {"name": "hold", "forces": hold, "until": {"load_above": 1}},
                {"name": "pull", "forces": pull,
                 "until": {"displacement": {"node": "node0", "component": "y", "above": rise}}}
            ]
        },
        "analysis": {"arc_length": {"initial": 0.02, "min": 1e-9, "max": 0.1, "load_scale": 1.0}}
    }))
}
