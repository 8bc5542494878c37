//! What is saved by leaving out what a scene does not need: each scene as it is, and with the saving switched off
//! (`keep_all`). Time is of whole judged paths, set up and serialised rows apart, the median of several taken in turn;
//! memory is the most that is allocated at once while a path is traced, its set-up included.
//!
//! `cargo bench --bench savings`

use allocation_counter::measure;
use arcslip::check::judged::JudgedPath;
use arcslip::continuation::scene::Scene;
use arcslip::model::JobRequest;
use arcslip::model::input::limits::MAX_OBSTACLES;
use arcslip::model::request::{
    Contact, ForceRange, Obstacle, Record, RecordedContacts, RecordedElements, RecordedSupports, Side,
};
use arcslip::resources::cancel::CancelFlag;
use serde_json::json;
use std::time::Instant;

/// Whole paths traced of each; the median is printed.
const REPEATS: usize = 9;
/// Contacts of which all but the scene's own are far.
const FAR: usize = 10_000;
/// Increments of a path that are timed at most among many contacts: with every contact kept each takes long.
const MOST_INCREMENTS: u64 = 40;

fn main() {
    println!(
        "{:<44} {:<30} {:>10} {:>10} {:>9} {:>10} {:>9} {:>7} {:>7} {:>7}",
        "scene",
        "what is left out",
        "increments",
        "time us",
        "memory kB",
        "kept us",
        "kept kB",
        "time",
        "memory",
        "written"
    );
    for name in ["one-bar-truss", "arch-type-truss", "three-snapping-bars", "curving-slip"] {
        among_far_contacts(name, scene(name));
    }
    among_far_contacts("chain of 20 blocks", chain(20));
    for name in ["arch-type-truss", "three-snapping-bars"] {
        compare(name, "contacts far at first; search", &scene(name), &kept(scene(name)));
    }
    for name in ["klarbring", "slider-chain"] {
        compare(name, "straight stretches; search", &scene(name), &kept(scene(name)));
    }
    compare("chain of 12 blocks", "straight stretches; search", &chain(12), &kept(chain(12)));
    for name in ["one-bar-truss", "arch-type-truss"] {
        let mut recorded = scene(name);
        let contacts = Some(RecordedContacts::Named(Vec::new()));
        recorded.analysis.record = Some(Record {
            nodes: Some(Vec::new()),
            contacts,
            elements: Some(RecordedElements::Range(ForceRange::None)),
            supports: Some(RecordedSupports::Range(ForceRange::None)),
            every: 1_000,
            directions: false,
            stability: false,
        });
        compare(name, "outputs (record)", &recorded, &scene(name));
    }
}

fn scene(name: &str) -> JobRequest {
    let built_in = arcslip::check::scenes::find(name).unwrap_or_else(|| panic!("there is no scene {name}"));
    arcslip::model::decode::decode(built_in.request.as_bytes()).unwrap_or_else(|errors| panic!("{errors}"))
}

fn kept(mut request: JobRequest) -> JobRequest {
    request.analysis.keep_all = true;
    request
}

/// The scene among far contacts beside the scene alone, then with every contact kept.
fn among_far_contacts(name: &str, mut request: JobRequest) {
    request.analysis.max_increments = MOST_INCREMENTS;
    let among = with_far_contacts(request.clone(), FAR);
    compare(&format!("{name}, and among 10,000 far"), "nothing: what far ones cost", &request, &among);
    let among = with_far_contacts(request, 200);
    compare(&format!("{name} among 200 far"), "contacts out of reach", &among, &kept(among.clone()));
}

struct Figures {
    /// Of a path (microseconds).
    time: f64,
    /// Most that is allocated at once (kB).
    memory: f64,
    increments: usize,
    /// Bytes of all rows, written out.
    written: usize,
}

/// One line: a request, and the same with something kept.
fn compare(name: &str, what: &str, saving: &JobRequest, keeping: &JobRequest) {
    let requests = [saving, keeping];
    let scenes = requests.map(|request| Scene::new(request).unwrap_or_else(|errors| panic!("{errors}")));
    let mut times = [Vec::new(), Vec::new()];
    for _ in 0..REPEATS {
        for ((request, scene), times) in requests.iter().zip(&scenes).zip(&mut times) {
            let mut path = JudgedPath::new(request, scene, CancelFlag::default());
            let began = Instant::now();
            path.by_ref().for_each(drop);
            times.push(began.elapsed().as_secs_f64() * 1e6);
        }
    }
    let figures = [0, 1].map(|side| {
        let (request, scene) = (requests[side], &scenes[side]);
        let (mut increments, mut written) = (0, 0);
        let allocated = measure(|| {
            for judged in JudgedPath::new(request, scene, CancelFlag::default()) {
                increments += 1;
                drop(judged);
            }
        });
        for judged in JudgedPath::new(request, scene, CancelFlag::default()) {
            written += arcslip::output::json_line(&judged).map_or(0, |line| line.len() + 1);
        }
        times[side].sort_by(f64::total_cmp);
        Figures { time: times[side][REPEATS / 2], memory: allocated.bytes_max as f64 / 1e3, increments, written }
    });
    let [saved, whole] = figures;
    println!(
        "{name:<44} {what:<30} {:>10} {:>10.1} {:>9.1} {:>10.1} {:>9.1} {:>7.2} {:>7.2} {:>7.2}",
        saved.increments,
        saved.time,
        saved.memory,
        whole.time,
        whole.memory,
        whole.time / saved.time,
        whole.memory / saved.memory,
        whole.written as f64 / saved.written as f64,
    );
}

/// So many contacts in all, of the nodes that have one, each with an obstacle of its own.
fn with_far_contacts(mut request: JobRequest, most: usize) -> JobRequest {
    let model = &mut request.model;
    let nodes: Vec<String> = model.contacts.iter().map(|contact| contact.node.clone()).collect();
    let reach = model.nodes.values().flatten().fold(1.0_f64, |most, value| most.max(value.abs()));
    for index in 0..most.min(MAX_OBSTACLES - model.obstacles.len()) - model.contacts.len() {
        let mut center = vec![1e3 * reach; model.dimension];
        center[0] += reach * index as f64;
        let obstacle = format!("far {index}");
        model.obstacles.insert(obstacle.clone(), Obstacle::Ball { center, radius: reach, side: Side::Outside });
        model.contacts.push(Contact::new(nodes[index % nodes.len()].clone(), obstacle, 0.5));
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
                {"name": "pull", "forces": {format!("block{}", blocks - 1): [1, 0]},
                 "until": {"load_above": 0.25 * blocks as f64}},
            ],
        },
    });
    match serde_json::from_value(request) {
        Ok(request) => request,
        Err(error) => panic!("{error}"),
    }
}
