//! Scenes of any size, made from their description.

use super::paths::request;
use arcslip::model::JobRequest;
use serde_json::{Value, json};

/// `n` one-bar trusses side by side, neighbouring tips tied; every tip is pushed by the load factor.
pub fn row_of_bars(n: usize) -> JobRequest {
    let (mut nodes, mut supports) = (serde_json::Map::new(), serde_json::Map::new());
    let (mut elements, mut contacts, mut forces) = (Vec::new(), Vec::new(), serde_json::Map::new());
    for i in 0..n {
        let (pin, tip) = (format!("pin{i}"), format!("tip{i}"));
        let x = 3.0 * i as f64;
        let reach = 1.5 + 0.1 * i as f64 / (n - 1) as f64;
        nodes.insert(pin.clone(), json!([x, 1.0]));
        nodes.insert(tip.clone(), json!([x - reach, 0.0]));
        supports.insert(pin.clone(), json!(["x", "y"]));
        elements.push(json!({"kind": "bar", "nodes": [&pin, &tip], "axial_stiffness": 1.0}));
        if i > 0 {
            let before = format!("tip{}", i - 1);
            elements.push(json!({"kind": "bar", "nodes": [before, &tip], "axial_stiffness": 0.5}));
        }
        contacts.push(json!({"node": &tip, "obstacle": "floor", "friction": 0.3}));
        forces.insert(tip, json!([1.0, 0.0]));
    }
    request(
        &json!({
            "model": {
                "name": format!("row of {n} snapping bars"), "dimension": 2, "nodes": nodes, "supports": supports,
                "elements": elements,
                "obstacles": {"floor": {"kind": "plane", "point": [0, 0], "normal": [0, 1]}},
                "contacts": contacts, "stages": [{"name": "push", "forces": forces}],
            },
            "analysis": {"max_increments": 20000},
        })
        .to_string(),
    )
}

/// `n` blocks on the floor, each pressed by `weight` in the first stage and joined to the next by a spring of
/// `stiffness` along the line; the second stage pulls block 1 until the last one is about to slip.
pub fn slider_chain(n: usize, weight: f64, stiffness: f64, friction: f64) -> JobRequest {
    let mut nodes = serde_json::Map::new();
    let (mut elements, mut contacts, mut press) = (Vec::<Value>::new(), Vec::new(), serde_json::Map::new());
    for i in 0..n {
        let block = format!("block{}", i + 1);
        nodes.insert(block.clone(), json!([-(i as f64), 0.0]));
        if i > 0 {
            let before = format!("block{i}");
            elements.push(json!({
                "kind": "spring", "nodes": [before, &block], "stiffness": [[stiffness, 0.0], [0.0, 0.0]]
            }));
        }
        contacts.push(json!({"node": &block, "obstacle": "floor", "friction": friction}));
        press.insert(block, json!([0.0, -weight]));
    }
    request(
        &json!({
            "model": {
                "name": format!("chain of {n} blocks"), "dimension": 2, "nodes": nodes, "elements": elements,
                "obstacles": {"floor": {"kind": "plane", "point": [0, 0], "normal": [0, 1]}},
                "contacts": contacts,
                "stages": [
                    {"name": "press", "forces": press, "until": {"load_above": 1.0}},
                    {"name": "pull", "forces": {"block1": [1.0, 0.0]}},
                ],
            },
            "analysis": {"max_increments": 20000, "arc_length": {"max": 1000.0}},
        })
        .to_string(),
    )
}
