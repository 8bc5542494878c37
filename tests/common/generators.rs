//! Models of any size, made from their numbers.

use arcslip::model::JobRequest;
use serde_json::{Map, Value, json};

use super::paths::typed;

fn bar(a: String, b: String, stiffness: f64) -> Value {
    json!({"kind": "bar", "nodes": [a, b], "axial_stiffness": stiffness})
}

fn floor() -> Value {
    json!({"floor": {"kind": "plane", "point": [0, 0], "normal": [0, 1]}})
}

/// The row of n snapping bars (formulation, section 4), as a document.
pub fn row_of_bars(n: usize) -> Value {
    let (mut nodes, mut supports, mut forces) = (Map::new(), Map::new(), Map::new());
    let (mut elements, mut contacts) = (Vec::new(), Vec::new());
    for i in 0..n {
        let foot = 1.5 + 0.1 * i as f64 / (n - 1) as f64;
        nodes.insert(format!("pin{i}"), json!([3 * i, 1]));
        nodes.insert(format!("tip{i}"), json!([3.0 * i as f64 - foot, 0]));
        supports.insert(format!("pin{i}"), json!(["x", "y"]));
        forces.insert(format!("tip{i}"), json!([1, 0]));
        elements.push(bar(format!("pin{i}"), format!("tip{i}"), 1.0));
        contacts.push(json!({"node": format!("tip{i}"), "obstacle": "floor", "friction": 0.3}));
    }
    (1..n).for_each(|i| elements.push(bar(format!("tip{}", i - 1), format!("tip{i}"), 0.5)));
    json!({"model": {
        "name": format!("row of {n} snapping bars"), "dimension": 2, "nodes": nodes, "supports": supports,
        "elements": elements, "obstacles": floor(), "contacts": contacts,
        "stages": [{"name": "push", "forces": forces}]
    }})
}

/// The chain of n sliders, a distance 1 apart, as a document: stage "weigh" presses each block, stage "pull" pulls
/// `block0` and has no end.
pub fn slider_chain(n: usize, friction: f64, weight: f64, stiffness: f64) -> Value {
    let (mut nodes, mut weights, mut elements, mut contacts) = (Map::new(), Map::new(), Vec::new(), Vec::new());
    for i in 0..n {
        nodes.insert(format!("block{i}"), json!([-(i as f64), 0]));
        weights.insert(format!("block{i}"), json!([0, -weight]));
        contacts.push(json!({"node": format!("block{i}"), "obstacle": "floor", "friction": friction}));
    }
    for i in 1..n {
        let ends = [format!("block{}", i - 1), format!("block{i}")];
        elements.push(json!({"kind": "spring", "nodes": ends, "stiffness": [[stiffness, 0], [0, 0]]}));
    }
    json!({"model": {
        "name": format!("chain of {n} sliders"), "dimension": 2, "nodes": nodes, "elements": elements,
        "obstacles": floor(), "contacts": contacts,
        "stages": [{"name": "weigh", "forces": weights, "until": {"load_above": 1}},
                   {"name": "pull", "forces": {"block0": [1, 0]}}]
    }})
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
