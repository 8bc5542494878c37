//! Two elastic spheres: Hertz's pressure in space.

use super::bricks::{Brick, pair};
use super::{moved_in_space, support};
use crate::common::paths::{request, trace};
use arcslip::result::stop_reason::StopReason;
use serde_json::{Value, json};

/// Edges of both bodies, in radii of the contact, and the radius of the spheres.
const EXTENT: f64 = 30.0;
const RADIUS: f64 = 100.0;
const POISSON: f64 = 0.3;

fn graded(t: f64) -> f64 {
    EXTENT * (5.0 * t).sinh() / 5.0_f64.sinh()
}

/// A quarter of two spheres of the same matter, pressed together; the radius of the contact is about 1.
fn spheres(cells: [usize; 2]) -> Value {
    let rise = |x: f64, y: f64| RADIUS - (RADIUS * RADIUS - x * x - y * y).sqrt();
    let lower = Brick::new("l", [cells[0]; 3], false, |[x, y, z]| {
        let (x, y) = (graded(x), graded(y));
        [x, y, -rise(x, y) - graded(1.0 - z)]
    });
    let upper = Brick::new("u", [cells[1]; 3], false, |[x, y, z]| {
        let (x, y) = (graded(x), graded(y));
        [x, y, rise(x, y) + graded(z)]
    });
    let material = json!({"kind": "linear_elastic", "young": 1, "poisson": POISSON});
    let mut model = pair(&lower, &upper, &material, 0.0, false);
    for brick in [&lower, &upper] {
        support(&mut model, &brick.side(0), &["x"]);
        support(&mut model, &brick.side(1), &["y"]);
    }
    support(&mut model, &lower.layer(0), &["x", "y", "z"]);
    support(&mut model, &upper.top(), &["x", "y", "z"]);
    // Only what may touch.
    for name in ["below", "above"] {
        let place = |node: &Value, axis: usize| {
            model["nodes"][node.as_str().expect("a name")][axis].as_f64().expect("a number")
        };
        let near = |face: &&Value| {
            let nodes = face.as_array().expect("a face");
            nodes.iter().all(|node| place(node, 0).max(place(node, 1)) < 4.0)
        };
        let all = model["surfaces"][name]["faces"].as_array().expect("faces");
        let faces: Vec<Value> = all.iter().filter(near).cloned().collect();
        model["surfaces"][name]["faces"] = json!(faces);
    }
    model["stages"] = json!([{
        "name": "press", "displacements": moved_in_space(&upper.top(), [0.0, 0.0, -2.2 / RADIUS]),
        "until": {"load_above": 1},
    }]);
    json!({"model": model})
}

/// The radius of the contact by the second moment of Hertz's pressure, `2 P a²/5`, against `a³ = 3 P R/(4 E)` with half the
/// radius and half the modulus of one sphere.
#[test]
#[ignore = "half a minute in a release build: cargo test --release --test solver spheres -- --ignored"]
fn elastic_spheres_follow_hertz() {
    let modulus = 0.5 / (1.0 - POISSON * POISSON);
    for (cells, bar) in [([8, 10], 0.015), ([10, 8], 0.05)] {
        let posted = spheres(cells);
        let (increments, report) = trace(&request(&posted.to_string()));
        assert_eq!(report.stop_reason, StopReason::StagesCompleted, "{report:?}");
        let last = increments.last().expect("an end");
        let press: f64 = last.contacts.iter().map(|contact| contact.normal_reaction).sum();
        let moment = last.contacts.iter().map(|contact| {
            let place = &posted["model"]["nodes"][&*contact.node];
            let [x, y] = [0, 1].map(|axis| place[axis].as_f64().expect("a number"));
            contact.normal_reaction * (x * x + y * y)
        });
        let radius = (2.5 * moment.sum::<f64>() / press).sqrt();
        let hertz = (3.0 * 4.0 * press * 0.5 * RADIUS / (4.0 * modulus)).cbrt();
        println!("{cells:?} cells: {} increments, radius {radius:.5}, Hertz {hertz:.5}", increments.len());
        assert!((radius / hertz - 1.0).abs() <= bar, "{cells:?}: {radius} {hertz}");
    }
}
