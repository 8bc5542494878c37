//! Solves that are cancelled, or that would take too much: they end where they are, and what they gave stands.

use arcslip::algebra::solves;
use arcslip::continuation::method_dispatch::TracedPath;
use arcslip::continuation::path::iterator::Path;
use arcslip::continuation::scene::Scene;
use arcslip::model::{JobRequest, decode};
use arcslip::resources::budget::{self, Bounds, Breach, Budget};
use arcslip::resources::cancel::CancelFlag;
use arcslip::result::stop_reason::StopReason;
use serde_json::{Value, json};

fn request(document: &Value) -> JobRequest {
    decode::decode(document.to_string().as_bytes()).expect("a request")
}

/// Nodes on springs, tied to each other in a row, that touch a floor without reaction.
fn springs_on_floor(count: usize, dimension: usize, method: &str) -> JobRequest {
    let matrix = |on: f64, off: f64| -> Vec<Vec<f64>> {
        (0..dimension).map(|row| (0..dimension).map(|column| if row == column { on } else { off }).collect()).collect()
    };
    let name = |index: usize| format!("n{index}");
    let at = |x: f64| -> Vec<f64> { std::iter::once(x).chain(std::iter::repeat_n(0.0, dimension - 1)).collect() };
    let normal: Vec<f64> = (1..=dimension).map(|axis| if axis == dimension { 1.0 } else { 0.0 }).collect();
    let push = |index: usize| -> Vec<f64> {
        let sense = if index.is_multiple_of(3) { -1.0 } else { 1.0 };
        (1..=dimension)
            .map(|axis| {
                sense
                    * if axis == 1 {
                        1.0
                    } else if axis == dimension {
                        -0.1
                    } else {
                        0.2
                    }
            })
            .collect()
    };
    let ground = (0..count).map(|i| json!({"kind": "spring", "nodes": [name(i)], "stiffness": matrix(2.0, 0.3)}));
    let ties =
        (1..count).map(|i| json!({"kind": "spring", "nodes": [name(i - 1), name(i)], "stiffness": matrix(1.0, 0.1)}));
    request(&json!({
        "model": {
            "dimension": dimension,
            "nodes": (0..count).map(|i| (name(i), json!(at(i as f64)))).collect::<serde_json::Map<_, _>>(),
            "elements": ground.chain(ties).collect::<Vec<_>>(),
            "obstacles": {"floor": {"kind": "plane", "point": vec![0.0; dimension], "normal": normal}},
            "contacts": (0..count)
                .map(|i| json!({"node": name(i), "obstacle": "floor", "friction": 0.4}))
                .collect::<Vec<_>>(),
            "stages": [{
                "name": "push",
                "forces": (0..count).map(|i| (name(i), json!(push(i)))).collect::<serde_json::Map<_, _>>(),
                "until": {"load_above": 1.0}
            }]
        },
        "analysis": {"method": method, "max_increments": 100}
    }))
}

/// Bars between nodes at random, in space.
fn expander(nodes: usize, bars: usize) -> JobRequest {
    let mut seed = 11_u64;
    let mut random = move |below: usize| {
        seed = seed.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
        (seed >> 33) as usize % below
    };
    let places: serde_json::Map<String, Value> =
        (0..nodes).map(|i| (format!("n{i}"), json!([0, 1, 2].map(|_| random(1_000_000) as f64 / 1e6)))).collect();
    let elements: Vec<Value> = (0..bars)
        .map(|i| {
            let first = i % nodes;
            let second = (first + 1 + random(nodes - 1)) % nodes;
            json!({"kind": "bar", "nodes": [format!("n{first}"), format!("n{second}")], "axial_stiffness": 1.0})
        })
        .collect();
    request(&json!({
        "model": {
            "dimension": 3,
            "nodes": places,
            "supports": {"n0": ["x", "y", "z"], "n1": ["x", "y", "z"], "n2": ["x", "y", "z"]},
            "elements": elements,
            "stages": [{"name": "push", "forces": {"n9": [1, 0, 0]}, "until": {"load_above": 1.0}}]
        }
    }))
}

/// How a path ends that is cancelled where its thread looks at the flag for the time given, or before, and how many
/// increments it gave. Whatever the search was at, it goes no further.
fn ended_at_look(scene: &Scene, look: u64) -> (StopReason, u64) {
    let first = budget::looks();
    budget::cancel_at_look(first + look);
    let mut path = Path::new(scene, CancelFlag::default());
    let mut given = 0;
    while path.next().is_some() {
        given += 1;
    }
    budget::cancel_at_look(u64::MAX);
    let reason = path.report().expect("a report").stop_reason;
    if reason == StopReason::Cancelled {
        assert_eq!(budget::looks() - first, look, "it went on");
    }
    (reason, given)
}

/// At the start of a stage, wherever the search for its directions has come to.
#[test]
fn searches_end_where_they_are_cancelled() {
    for (count, dimension, method) in [(40, 3, "auto"), (120, 3, "auto"), (5_000, 2, "auto"), (60, 3, "mpec")] {
        let scene = Scene::new(&springs_on_floor(count, dimension, method)).expect("a scene");
        let name = format!("{count} in {dimension} dimensions by {method}");
        for look in [1, 2, 3, 10, 30, 100, 300, 1_000] {
            let (reason, given) = ended_at_look(&scene, look);
            assert_eq!(reason, StopReason::Cancelled, "{name} at look {look}");
            assert!(given <= look, "{name} at look {look}: {given}");
        }
    }
    // Between two looks there is no more work than takes some tenths of a second.
    assert!(budget::largest_piece() <= 1_000_000_000, "{} multiplications in one piece", budget::largest_piece());
}

/// The other method factorises dense matrices, column by column.
#[test]
fn dense_factorisations_end_where_they_are_cancelled() {
    let scene = Scene::new(&springs_on_floor(250, 3, "regularised")).expect("a scene");
    let mut path = TracedPath::new(&scene, CancelFlag::default());
    let first = budget::looks();
    budget::cancel_at_look(first + 400);
    assert!(path.next().is_none());
    budget::cancel_at_look(u64::MAX);
    assert_eq!((path.report().expect("a report").stop_reason, budget::looks() - first), (StopReason::Cancelled, 400));
}

/// Set beforehand, the flag leaves nothing to be solved.
#[test]
fn a_flag_that_is_set_costs_nothing() {
    let scene = Scene::new(&springs_on_floor(300, 3, "auto")).expect("a scene");
    let cancel = CancelFlag::default();
    cancel.cancel();
    let before = solves();
    let mut path = Path::new(&scene, cancel);
    assert!(path.next().is_none());
    assert_eq!(solves(), before);
    assert_eq!(path.report().expect("a report").stop_reason, StopReason::Cancelled);
}

#[test]
fn a_check_is_cancelled_where_it_is() {
    let cancel = CancelFlag::default();
    cancel.cancel();
    let request = springs_on_floor(50, 3, "auto");
    let checked = Budget::new(cancel, Bounds::default()).during(|| Scene::new(&request).is_ok());
    assert_eq!(checked, Err(Breach::Cancelled));
}

/// The search is worth so much: with less memory it ends there, with both numbers; with more it goes on.
#[test]
fn a_search_that_would_hold_too_much_ends_with_both_numbers() {
    let request = springs_on_floor(150, 3, "auto");
    let run = |memory: u64| {
        let budget = Budget::new(CancelFlag::default(), Bounds { memory, ..Bounds::default() });
        budget.during(|| {
            let scene = Scene::new(&request).expect("a scene");
            let mut path = Path::new(&scene, CancelFlag::default());
            while path.next().is_some() {}
            path.report().expect("a report")
        })
    };
    let report = run(3_000_000).expect("the path itself says so");
    assert_eq!(report.stop_reason, StopReason::MemoryLimit);
    assert!(report.sentence.contains("at most 3000000 are allowed"), "{}", report.sentence);
    // The same number of bytes each time.
    assert_eq!(run(3_000_000).expect("as before").sentence, report.sentence);
}

/// Of a graph without small separators the factors are nearly full. What they would be is known, and nothing of their size is
/// taken: the bound itself is far less than they would need.
#[test]
fn bars_at_random_are_refused_with_both_numbers() {
    let request = expander(1_500, 9_000);
    let refused = |bounds: Bounds| {
        let checked = Budget::new(CancelFlag::default(), bounds).during(|| Scene::new(&request).map(|_| ()));
        checked.expect("no breach beyond the scene").expect_err("refused").to_string()
    };
    let entries = refused(Bounds { factor_entries: 300_000, memory: 60_000_000, ..Bounds::default() });
    assert!(entries.contains("model.elements") && entries.contains("at most 300000 are allowed"), "{entries}");
    let work = refused(Bounds { factor_work: 20_000_000, memory: 60_000_000, ..Bounds::default() });
    assert!(work.contains("multiplications") && work.contains("at most 20000000 are allowed"), "{work}");
    let memory = refused(Bounds { memory: 20_000_000, ..Bounds::default() });
    assert!(memory.contains("bytes; at most 20000000 are allowed"), "{memory}");
}
