//! What the tests of the service share: requests, and lines read back.

use serde_json::{Value, json};

/// A small valid request; `max_increments` is all that the made-up solver looks at.
pub fn request(name: &str, max_increments: u64) -> Value {
    json!({
        "model": {
            "name": name,
            "dimension": 2,
            "nodes": {"pin": [0, 1], "tip": [-1.5, 0]},
            "supports": {"pin": ["x", "y"]},
            "elements": [{"kind": "bar", "nodes": ["pin", "tip"], "axial_stiffness": 1.0}],
            "obstacles": {"floor": {"kind": "plane", "point": [0, 0], "normal": [0, 1]}},
            "contacts": [{"node": "tip", "obstacle": "floor", "friction": 0.3}],
            "stages": [{"name": "push", "forces": {"tip": [1, 0]}}]
        },
        "analysis": {"max_increments": max_increments}
    })
}

/// A built-in scene, as it is posted.
pub fn scene(name: &str) -> Value {
    serde_json::from_str(arcslip::check::scenes::find(name).expect("a scene").request).expect("JSON")
}

/// A scene in steps so short that it has about so many increments for each unit of arc length, and no more than these.
pub fn in_short_steps(name: &str, increments: u64, of_a_unit: u64) -> Value {
    let mut request = scene(name);
    let step = 1.0 / of_a_unit as f64;
    request["analysis"]["arc_length"] = json!({"initial": step, "min": 1e-3 * step, "max": step});
    request["analysis"]["max_increments"] = json!(increments);
    request
}

/// A job that keeps a worker busy until it is cancelled, and stores next to nothing.
pub fn occupation() -> Value {
    let mut request = in_short_steps("one-bar-truss", 10_000_000, 1_000_000);
    request["model"]["name"] = json!("keeps a worker busy");
    request["analysis"]["record"] = json!({"every": 1_000_000, "directions": false});
    request
}

/// A line with its one value that differs from run to run taken out, and nothing else touched.
pub fn without_elapsed(line: &str) -> String {
    let Some((before, rest)) = line.split_once("\"elapsed_s\":") else { return line.to_owned() };
    let end = rest.find([',', '}']).unwrap_or(rest.len());
    format!("{before}\"elapsed_s\":?{}", &rest[end..])
}

/// The indices of these increments.
pub fn indices<'a>(lines: impl IntoIterator<Item = &'a str>) -> Vec<u64> {
    lines
        .into_iter()
        .map(|line| {
            let increment: Value = serde_json::from_str(line).expect("an increment is JSON");
            increment["index"].as_u64().expect("an increment has an index")
        })
        .collect()
}
