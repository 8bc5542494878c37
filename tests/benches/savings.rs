//! What is saved by leaving contacts out of reach out: time per increment of a scene as it is, among 9,999 more contacts
//! that it never comes near, and the same with `keep_all`. Medians of whole paths, with the same points by all three. In
//! small scenes what is left among far contacts is their rows in the increments.
//!
//! `cargo bench --bench savings`

use arcslip::cancel::CancelFlag;
use arcslip::model::JobRequest;
use arcslip::model::limits::MAX_CONTACTS;
use arcslip::model::request::{Contact, Obstacle, Side};
use arcslip::path::{Path, Scene};
use serde_json::json;
use std::time::Instant;

/// Whole paths traced; the median is printed.
const REPEATS: usize = 5;
/// Increments of a path that are timed at most: with every contact kept each takes long.
const MOST_INCREMENTS: u64 = 40;

fn main() {
    println!(
        "{:<22} {:>8} {:>10} {:>12} {:>12} {:>8} {:>14} {:>8}",
        "scene", "unknowns", "increments", "alone us", "among far us", "ratio", "keep_all us", "ratio"
    );
    for name in ["one-bar-truss", "arch-type-truss", "three-snapping-bars", "curving-slip"] {
        let Some(built_in) = arcslip::scenes::find(name) else { continue };
        match arcslip::model::decode::decode(built_in.request.as_bytes()) {
            Ok(request) => compare(name, request),
            Err(errors) => panic!("{errors}"),
        }
    }
    compare("chain of 60 blocks", chain(60));
}

fn compare(name: &str, mut request: JobRequest) {
    request.analysis.max_increments = MOST_INCREMENTS;
    let (alone, increments, unknowns) = timed(&request);
    let mut among = with_far_contacts(request);
    let (saving, with_far, _) = timed(&among);
    among.analysis.keep_all = true;
    let (keeping, with_all, _) = timed(&among);
    assert!(increments == with_far && increments == with_all, "one path");
    println!(
        "{name:<22} {unknowns:>8} {increments:>10} {alone:>12.1} {saving:>12.1} {:>8.2} {keeping:>14.1} {:>8.2}",
        saving / alone,
        keeping / alone
    );
}

/// Median time per increment (microseconds), increments and unknowns.
fn timed(request: &JobRequest) -> (f64, u64, u64) {
    let scene = match Scene::new(request) {
        Ok(scene) => scene,
        Err(errors) => panic!("{errors}"),
    };
    let mut times = Vec::with_capacity(REPEATS);
    let mut increments = 0;
    for _ in 0..REPEATS {
        let began = Instant::now();
        increments = Path::new(&scene, CancelFlag::default()).count();
        times.push(began.elapsed().as_secs_f64() / increments as f64 * 1e6);
    }
    times.sort_by(f64::total_cmp);
    (times[REPEATS / 2], increments as u64, scene.plan().unknowns)
}

/// As many contacts more as are taken, of the nodes that have one.
fn with_far_contacts(mut request: JobRequest) -> JobRequest {
    let model = &mut request.model;
    let nodes: Vec<String> = model.contacts.iter().map(|contact| contact.node.clone()).collect();
    let reach = model.nodes.values().flatten().fold(1.0_f64, |most, value| most.max(value.abs()));
    for index in 0..MAX_CONTACTS - model.contacts.len() {
        let mut center = vec![1e3 * reach; model.dimension];
        center[0] += reach * index as f64;
        let name = format!("far {index}");
        if index < 100 {
            model.obstacles.insert(name.clone(), Obstacle::Ball { center, radius: reach, side: Side::Outside });
        }
        let obstacle = format!("far {}", index % 100);
        model.contacts.push(Contact { node: nodes[index % nodes.len()].clone(), obstacle, friction: 0.5 });
    }
    request
}

/// Blocks in a row on a floor, tied by springs, pressed and then pulled at one end.
fn chain(blocks: usize) -> JobRequest {
    let (mut nodes, mut weights) = (serde_json::Map::new(), serde_json::Map::new());
    let (mut elements, mut contacts) = (Vec::new(), Vec::new());
    for index in 0..blocks {
        let name = format!("block{index}");
        nodes.insert(name.clone(), json!([index, 0]));
        weights.insert(name.clone(), json!([0, -1]));
        contacts.push(json!({"node": &name, "obstacle": "floor", "friction": 0.3}));
        let before = index.checked_sub(1).map(|before| format!("block{before}"));
        let ends: Vec<&String> = before.iter().chain([&name]).collect();
        elements.push(json!({"kind": "spring", "nodes": ends, "stiffness": [[1, 0], [0, 1]]}));
    }
    let request = json!({
        "model": {
            "dimension": 2, "nodes": nodes, "elements": elements, "contacts": contacts,
            "obstacles": {"floor": {"kind": "plane", "point": [0, 0], "normal": [0, 1]}},
            "stages": [
                {"name": "press", "forces": weights, "until": {"load_above": 1}},
                {"name": "pull", "forces": {format!("block{}", blocks - 1): [1, 0]}},
            ],
        },
    });
    match serde_json::from_value(request) {
        Ok(request) => request,
        Err(error) => panic!("{error}"),
    }
}
