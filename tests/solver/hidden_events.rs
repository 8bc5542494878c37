//! Events that show at neither end of a step: what goes to and fro between them is found all the same, in small structures
//! and in large ones, where many unknowns have nothing to do with it.

use arcslip::continuation::path::iterator::Path;
use arcslip::continuation::scene::Scene;
use arcslip::resources::cancel::CancelFlag;
use serde_json::{Value, json};

/// Unknowns that are on their own: bars that are pushed by nothing.
const SPECTATORS: usize = 20;

fn with_spectators(mut request: Value) -> Value {
    let model = &mut request["model"];
    for place in 0..SPECTATORS {
        let (pin, tip, x) = (format!("pin{place}"), format!("tip{place}"), 20.0 + 3.0 * place as f64);
        model["nodes"][&pin] = json!([x, 1.0]);
        model["nodes"][&tip] = json!([x - 1.5, 0.0]);
        model["supports"][&pin] = json!(["x", "y"]);
        let elements = model["elements"].as_array_mut().expect("elements");
        elements.push(json!({"kind": "bar", "nodes": [pin, tip], "axial_stiffness": 5.0}));
        elements.push(json!({"kind": "spring", "nodes": [tip], "stiffness": [[1, 0], [0, 1]]}));
    }
    request
}

/// Loads and texts of the events of a stage.
fn events(request: &Value, stage: &str) -> Vec<(f64, String)> {
    let request = serde_json::from_value(request.clone()).expect("a request");
    let scene = Scene::new(&request).unwrap_or_else(|errors| panic!("{errors}"));
    let path = Path::new(&scene, CancelFlag::default()).filter(|increment| *increment.stage == *stage);
    path.filter_map(|increment| Some((increment.load_factor, increment.point.event?))).skip(1).collect()
}

fn assert_events(request: Value, stage: &str, expected: &[(f64, &str)]) {
    for request in [request.clone(), with_spectators(request)] {
        let found = events(&request, stage);
        let same = |(found, expected): (&(f64, String), &(f64, &str))| {
            (found.0 - expected.0).abs() < 1e-8 && found.1.starts_with(expected.1)
        };
        assert!(found.len() == expected.len() && found.iter().zip(expected).all(same), "{found:?}");
    }
}

fn spring(nodes: &[&str], stiffness: [[f64; 2]; 2]) -> Value {
    json!({"kind": "spring", "nodes": nodes, "stiffness": stiffness})
}

/// A and B land on obstacles one after the other; in between C, tied to both, goes up and comes down again. Until A lands at
/// a load of 0.1 C stays where it is, then it goes by 0.08 a load.
fn vee(until: Value) -> Value {
    let (own, tie) = ([[1.0, 0.0], [0.0, 1.0]], [[0.0, 0.0], [0.0, 1.0]]);
    json!({
        "model": {
            "dimension": 2,
            "nodes": {"A": [0, 0], "B": [1, 0], "C": [2, 0], "pin": [10, 1], "tip": [8.5, 0]},
            "supports": {"A": ["x"], "B": ["x"], "C": ["x"], "pin": ["x", "y"], "tip": ["y"]},
            "elements": [
                spring(&["A"], own), spring(&["B"], own), spring(&["C"], own),
                spring(&["A", "C"], tie), spring(&["B", "C"], tie),
                {"kind": "bar", "nodes": ["pin", "tip"], "axial_stiffness": 5.0}],
            "obstacles": {"below": {"kind": "plane", "point": [0, -0.02], "normal": [0, 1]},
                          "above": {"kind": "plane", "point": [0, 0.05216], "normal": [0, -1]}},
            "contacts": [{"node": "A", "obstacle": "below", "friction": 0},
                         {"node": "B", "obstacle": "above", "friction": 0}],
            "stages": [{"name": "go", "until": until,
                        "forces": {"A": [0, -0.4], "B": [0, 1], "C": [0, -0.3], "tip": [0.05, 0]}}]},
        "analysis": {"max_increments": 200,
                     "arc_length": {"initial": 0.03, "max": 0.03, "displacement_scale": 5.0, "load_scale": 1.0}}
    })
}

#[test]
fn a_stage_ends_where_a_displacement_passes_its_bound_between_two_changes() {
    let until = json!({"load_above": 0.3, "displacement": {"node": "C", "component": "y", "above": 1.6e-4}});
    assert_events(vee(until), "go", &[(0.1, "A on below: free to slip"), (0.102, "stage \"go\" ends")]);
}

#[test]
fn a_contact_with_friction_that_lands_between_two_changes_is_seen() {
    let mut request = vee(json!({"load_above": 0.3}));
    request["model"]["supports"].as_object_mut().expect("supports").remove("C");
    request["model"]["obstacles"]["over"] = json!({"kind": "plane", "point": [0, 1.6e-4], "normal": [0, -1]});
    let contacts = request["model"]["contacts"].as_array_mut().expect("contacts");
    contacts.push(json!({"node": "C", "obstacle": "over", "friction": 0.5}));
    let found = events(&with_spectators(request.clone()), "go");
    assert!(
        found.iter().any(|(load, event)| (load - 0.102).abs() < 1e-8 && event.starts_with("C on over")),
        "{found:?}"
    );
    request["analysis"]["events"] = json!("all");
    assert_eq!(found.len(), events(&with_spectators(request), "go").len());
}

/// A grazes a ball before B lands on a wall, all of it within one step.
#[test]
fn a_contact_that_comes_and_goes_before_another_in_the_same_step_is_seen() {
    let own = [[1.0, 0.0], [0.0, 1.0]];
    let request = json!({
        "model": {
            "dimension": 2,
            "nodes": {"A": [0, 0], "B": [0, 1], "pin": [10, 1], "tip": [8.5, 0]},
            "supports": {"B": ["y"], "pin": ["x", "y"], "tip": ["y"]},
            "elements": [spring(&["A"], own), spring(&["B"], own),
                         {"kind": "bar", "nodes": ["pin", "tip"], "axial_stiffness": 5.0}],
            "obstacles": {"ball": {"kind": "ball", "center": [0.5, -0.99995], "radius": 1.0, "side": "outside"},
                          "wall": {"kind": "plane", "point": [0.518, 0], "normal": [-1, 0]}},
            "contacts": [{"node": "A", "obstacle": "ball", "friction": 0},
                         {"node": "B", "obstacle": "wall", "friction": 0}],
            "stages": [{"name": "go", "until": {"load_above": 0.7},
                        "forces": {"A": [1, 0], "B": [1, 0], "tip": [0.05, 0]}}]},
        "analysis": {"events": "all", "max_increments": 500,
                     "arc_length": {"initial": 0.1927, "max": 0.1927, "displacement_scale": 1.0, "load_scale": 1.0}}
    });
    // (x - 0.5)² + 0.99995² = 1, and where the ball pushes no more.
    let half = (1.0_f64 - 0.99995_f64.powi(2)).sqrt();
    let expected = [
        (0.5 - half, "A on ball: free to slip"),
        (0.5 + half, "A on ball: slip to free"),
        (0.518, "B on wall: free to slip"),
        (0.7, "stage \"go\" ends"),
    ];
    assert_events(request, "go", &expected);
}
