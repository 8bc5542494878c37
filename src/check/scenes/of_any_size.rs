//! Scenes of any size, as documents without an analysis: the row of snapping bars and the chain of sliders.

use serde_json::{Map, Value, json};

/// A floor `y >= 0`.
fn floor() -> Value {
    json!({"floor": {"kind": "plane", "point": [0, 0], "normal": [0, 1]}})
}

/// `n` one-bar trusses side by side on a floor. Weaker bars, unstressed at the start, connect neighbouring tips, and a
/// force pushes every tip along the floor: pins `(3i, 1)`, tips `(3i - a_i, 0)`, `a_i = 1.5 + 0.1 i/(n - 1)`, friction
/// 0.3. The bars snap one after another. The nodes are `pin0`, `tip0`, ...; the stage "push" has no end. `n` is at
/// least 1; a single bar has `a_0 = 1.5`.
pub fn row_of_bars(n: usize) -> Value {
    let bar =
        |a: String, b: String, stiffness: f64| json!({"kind": "bar", "nodes": [a, b], "axial_stiffness": stiffness});
    let (mut nodes, mut supports, mut forces) = (Map::new(), Map::new(), Map::new());
    let (mut elements, mut contacts) = (Vec::new(), Vec::new());
    for i in 0..n {
        // The quotient would be 0/0 for a single bar.
        let foot = 1.5 + 0.1 * i as f64 / n.saturating_sub(1).max(1) as f64;
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

/// A chain of `n` blocks on a floor, a distance 1 apart, joined by springs. The stage "weigh" presses each block with
/// `weight`; the stage "pull" pulls `block0` and has no end. Block `m` begins to slip at the load
/// `(m + 1) friction weight`; block `m - 1` is then displaced by `friction weight/stiffness`. When the last block
/// slips, the whole chain slides.
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
