//! Loads on the sides of beams and bars, in the plane.

use crate::common::paths::{close, judged, typed};
use arcslip::model::JobRequest;
use serde_json::{Map, Value, json};

/// A beam of length 2 from a wall, of so many elements, or of bars between supports, with a stage.
fn row(count: usize, element: &Value, supports: Value, stage: Value) -> JobRequest {
    let name = |k: usize| format!("n{k}");
    let nodes: Map<String, Value> =
        (0..=count).map(|k| (name(k), json!([2.0 * k as f64 / count as f64, 0.0]))).collect();
    let elements: Vec<Value> = (0..count)
        .map(|k| {
            let mut element = element.clone();
            element["nodes"] = json!([name(k), name(k + 1)]);
            element
        })
        .collect();
    // Along the order of the nodes the free side is above.
    let faces: Vec<Value> = (0..count).map(|k| json!([name(k), name(k + 1)])).collect();
    typed(json!({"model": {
        "dimension": 2, "nodes": nodes, "elements": elements, "supports": supports,
        "surfaces": {"top": {"faces": faces}}, "stages": [stage],
    }}))
}

/// Under a small load of either kind the tip of a cantilever moves by `q L^4/(8 EI)`, and the more exactly the finer it is
/// divided.
#[test]
fn a_cantilever_bends_under_a_line_load() {
    let beam = json!({"kind": "beam", "axial_stiffness": 1e6, "bending_stiffness": 3.0});
    let exact = -16.0 / (8.0 * 3.0);
    for load in [json!({"tractions": {"top": [0, -1]}}), json!({"pressures": {"top": 1}})] {
        let errors = [8, 16].map(|count| {
            let mut stage = json!({"name": "bend", "until": {"load_above": 1e-4}});
            stage.as_object_mut().expect("a stage").extend(load.as_object().expect("a load").clone());
            let traced = judged(&row(count, &beam, json!({"n0": ["x", "y", "rz"]}), stage));
            let last = traced.increments.last().expect("an end");
            assert!(traced.errors.iter().all(|errors| errors.largest_of_state() < 1e-9 && errors.energy < 1e-6));
            let [_, held, _] = last.supports["n0"][..] else { panic!("three reactions") };
            close(held / last.load_factor, 2.0, 1e-6, "the reaction of the wall");
            (last.displacements[&*format!("n{count}")][1] / last.load_factor / exact - 1.0).abs()
        });
        assert!(errors[1] < 4e-3 && (errors[0] / errors[1]).log2() > 1.9, "{errors:?}");
    }
}

/// A tight line of bars between two supports that a pressure blows into a circle: the tension is the pressure times the radius.
#[test]
fn bars_under_pressure_form_a_circle() {
    let bar = json!({"kind": "bar", "axial_stiffness": 10.0, "prestress": 1.0});
    let stage = json!({"name": "blow", "pressures": {"top": -1}, "until": {"load_above": 2}});
    let blown = row(20, &bar, json!({"n0": ["x", "y"], "n20": ["x", "y"]}), stage);
    let traced = judged(&blown);
    assert!(traced.errors.iter().all(|errors| errors.largest_of_state() < 1e-9 && errors.energy < 1e-6));
    let last = traced.increments.last().expect("an end");
    close(last.load_factor, 2.0, 1e-12, "load");
    let places: Vec<[f64; 2]> = blown
        .model
        .nodes
        .iter()
        .map(|(name, place)| [0, 1].map(|k| place[k] + last.displacements[name.as_str()][k]))
        .collect();
    let radius = |k: usize| {
        let [a, b, c] = [places[k - 1], places[k], places[k + 1]];
        let side = |p: [f64; 2], q: [f64; 2]| (p[0] - q[0]).hypot(p[1] - q[1]);
        let area = 0.5 * ((b[0] - a[0]) * (c[1] - a[1]) - (b[1] - a[1]) * (c[0] - a[0])).abs();
        side(a, b) * side(b, c) * side(c, a) / (4.0 * area)
    };
    let first = radius(1);
    (2..20).for_each(|k| close(radius(k) / first, 1.0, 1e-3, "the radius"));
    let pulled = last.supports["n0"].iter().map(|part| part * part).sum::<f64>().sqrt();
    close(pulled / (2.0 * first), 1.0, 1e-2, "the tension over pressure and radius");
}
