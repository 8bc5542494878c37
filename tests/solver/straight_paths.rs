//! Where every element is linear one increment goes from event to event: the events are those that steps of ordinary length
//! come to, and a path that is nothing but rounding ends by name.

use arcslip::continuation::path::iterator::Path;
use arcslip::continuation::scene::Scene;
use arcslip::resources::cancel::CancelFlag;
use serde_json::{Map, Value, json};

/// A sequence of numbers in [-1, 1), the same for a seed on every machine (D. H. Lehmer's generator).
struct Numbers(u64);

impl Numbers {
    fn next(&mut self) -> f64 {
        self.0 = self.0 * 48_271 % 2_147_483_647;
        self.0 as f64 / 1_073_741_823.5 - 1.0
    }

    fn between(&mut self, least: f64, most: f64) -> f64 {
        least + (most - least) * 0.5 * (self.next() + 1.0)
    }
}

/// Blocks on springs over a floor, and beside a wall; pressed, pulled, and pulled back.
fn blocks(seed: u64) -> Value {
    let mut numbers = Numbers(seed + 1);
    let count = [1, 2, 3, 4, 24][seed as usize % 5];
    let (mut nodes, mut elements, mut contacts) = (Map::new(), Vec::new(), Vec::new());
    let mut stages = [Map::new(), Map::new(), Map::new()];
    for block in 0..count {
        let name = format!("block{block}");
        nodes.insert(name.clone(), json!([block, numbers.between(0.0, 0.2)]));
        let (along, up, across) = (numbers.between(0.5, 3.0), numbers.between(0.5, 3.0), 0.4 * numbers.next());
        elements.push(json!({"kind": "spring", "nodes": [name], "stiffness": [[along, across], [across, up]]}));
        if block > 0 {
            let tie = numbers.between(0.2, 2.0);
            let ends = [format!("block{}", block - 1), name.clone()];
            elements.push(json!({"kind": "spring", "nodes": ends, "stiffness": [[tie, 0], [0, 0.3 * tie]]}));
        }
        let friction = [0.0, 0.1, 0.3, 0.8][(seed as usize / 5 + block) % 4];
        contacts.push(json!({"node": name, "obstacle": "floor", "friction": friction}));
        if block + 1 == count {
            contacts.push(json!({"node": name, "obstacle": "wall", "friction": 0.2}));
        }
        stages[0].insert(name.clone(), json!([0.3 * numbers.next(), -numbers.between(0.5, 2.0)]));
        stages[1].insert(name.clone(), json!([numbers.between(0.2, 2.0), 0.3 * numbers.next()]));
        stages[2].insert(name, json!([-numbers.between(0.5, 3.0), numbers.between(0.0, 0.5)]));
    }
    let stage = |(name, forces): (&str, Map<String, Value>)| json!({"name": name, "forces": forces, "until": {"load_above": 1.0}});
    let stages: Vec<Value> = ["press", "pull", "back"].into_iter().zip(stages).map(stage).collect();
    json!({"model": {
        "dimension": 2, "nodes": nodes, "elements": elements, "contacts": contacts, "stages": stages,
        "obstacles": {"floor": {"kind": "plane", "point": [0, 0], "normal": [0, 1]},
                      "wall": {"kind": "plane", "point": [count as f64 - 0.7, 0], "normal": [-1, 0]}}
    }})
}

/// Stage, load, text and contacts' states of each event, and how the path ended.
fn events(mut request: Value, analysis: &Value) -> (Vec<(String, f64, String, String)>, String) {
    request["analysis"] = analysis.clone();
    let request = serde_json::from_value(request).expect("a request");
    let scene = Scene::new(&request).unwrap_or_else(|errors| panic!("{errors}"));
    let mut path = Path::new(&scene, CancelFlag::default());
    let events = path.by_ref().filter_map(|increment| {
        let statuses: Vec<_> = increment.contacts.iter().map(|contact| contact.status).collect();
        let event = increment.point.event?;
        Some((increment.stage.to_string(), increment.load_factor, event, format!("{statuses:?}")))
    });
    (events.collect(), format!("{:?}", path.report().expect("an end").stop_reason))
}

#[test]
fn jumps_come_to_the_events_that_steps_come_to() {
    let mut compared = 0;
    for seed in 0..160 {
        let (jumps, end) = events(blocks(seed), &json!({}));
        let (steps, other_end) = events(blocks(seed), &json!({"arc_length": {"jump": false}}));
        assert_eq!(end, other_end, "{seed}: {jumps:?}\n{steps:?}");
        assert_eq!(jumps.len(), steps.len(), "{seed}: {jumps:?}\n{steps:?}");
        for (one, other) in jumps.iter().zip(&steps) {
            assert_eq!((&one.0, &one.2, &one.3), (&other.0, &other.2, &other.3), "{seed}");
            assert!((one.1 - other.1).abs() < 1e-9, "{seed}: {one:?} {other:?}");
        }
        compared += jumps.len();
    }
    assert!(compared > 900, "{compared}");
}

/// Nothing is loaded, and an obstacle draws back from nodes that rest on others: all forces are rounding.
#[test]
fn what_is_nothing_but_rounding_comes_to_an_end() {
    let spring = |nodes: &[&str], xx: f64, xy: f64, yy: f64| json!({"kind": "spring", "nodes": nodes, "stiffness": [[xx, xy], [xy, yy]]});
    let plane = |x: f64, y: f64| json!({"kind": "plane", "point": [0, 0], "normal": [x, y]});
    let nodes = json!({"n0": [0, 0], "n1": [0, 0], "n2": [0, 0]});
    let mild = json!({
        "dimension": 2, "nodes": nodes,
        "elements": [
            spring(&["n0"], 2.0, 0.5, 1.0), spring(&["n0", "n1"], 3.0, 0.0, 1.0), spring(&["n2"], 0.5, 0.0, 2.0),
            spring(&["n0", "n2"], 2.0, -0.8, 1.0), spring(&["n0", "n2"], 1.0, -0.5, 1.0), spring(&["n0", "n1"], 1.0, -0.8, 1.0)],
        "obstacles": {"o0": plane(0.0, 1.0), "o1": plane(0.0, 1.0), "o2": plane(-0.5, 1.0)},
        "contacts": [{"node": "n2", "obstacle": "o0", "friction": 0}, {"node": "n1", "obstacle": "o1", "friction": 0.8},
                     {"node": "n0", "obstacle": "o2", "friction": 0}],
        "stages": [{"name": "s", "obstacle_motion": {"o0": [1.25, -1.5]}, "until": {"load_above": 3.0}}]
    });
    let soft = json!({
        "dimension": 2, "nodes": nodes,
        "elements": [
            spring(&["n0"], 3.0, 0.0, 1.0), spring(&["n0", "n1"], 2.0, 0.0, 0.5), spring(&["n0", "n2"], 1e-6, 5e-7, 1e-6),
            spring(&["n0"], 1.0, 0.0, 1e-4), spring(&["n1"], 0.1, 0.0, 1e-4), spring(&["n2"], 0.01, 0.0, 1e-4)],
        "obstacles": {"o2": plane(0.0, 1.0), "o3": plane(2.0, 1.0)},
        "contacts": [{"node": "n1", "obstacle": "o2", "friction": 0.3}, {"node": "n2", "obstacle": "o3", "friction": 1.5}],
        "stages": [{"name": "s", "obstacle_motion": {"o2": [-1.0, -0.5]}, "until": {"contact_change": 1}}]
    });
    for model in [mild, soft] {
        for analysis in [json!({}), json!({"arc_length": {"jump": false}}), json!({"keep_all": true})] {
            let (found, end) = events(json!({"model": model}), &analysis);
            assert!(found.iter().all(|event| event.1.is_finite()), "{found:?} {end}");
        }
    }
}
