//! Obstacles that turn: planes that tilt until a block slips, cams, drums, and what turning may not change.

use crate::common::paths::{Traced, close, judged, typed};
use crate::common::random::Numbers;
use crate::common::variants::{about_axes, in_units, turned_in_plane};
use arcslip::continuation::path::checkpoint::Checkpoint;
use arcslip::continuation::path::iterator::Path;
use arcslip::continuation::scene::Scene;
use arcslip::model::JobRequest;
use arcslip::model::request::Method;
use arcslip::resources::cancel::CancelFlag;
use arcslip::result::increment::{Increment, PointKind, Status};
use arcslip::result::stop_reason::StopReason;
use serde_json::{Value, json};

fn assert_on_measure(traced: &Traced, what: &str) {
    for (increment, errors) in traced.increments.iter().zip(&traced.errors) {
        assert!(errors.largest_of_state() <= 1e-10, "{what}, increment {}: {errors:?}", increment.index);
        assert!(errors.energy <= 1e-6 && errors.strain_energy <= 1e-10, "{what}, {}: {errors:?}", increment.index);
    }
}

fn of_stage<'a>(traced: &'a Traced, stage: &str) -> Vec<&'a Increment> {
    traced.increments.iter().filter(|increment| &*increment.stage == stage).collect()
}

/// A block of weight 1 at the pivot of a plane, on a spring of stiffness 0.1 in all directions, with friction 0.5.
fn tilting_plane(dimension: usize, axis: Option<[f64; 3]>, pivot_from: f64) -> JobRequest {
    let up = dimension - 1;
    let mut normal = vec![0.0; dimension];
    normal[up] = 1.0;
    let down: Vec<f64> = normal.iter().map(|part| -part).collect();
    let stiffness: Vec<Vec<f64>> =
        (0..dimension).map(|i| (0..dimension).map(|j| if i == j { 0.1 } else { 0.0 }).collect()).collect();
    let mut rotation = json!({"angle": 1.0, "about": vec![pivot_from; dimension]});
    let place = vec![pivot_from; dimension];
    if let Some(axis) = axis {
        rotation["axis"] = json!(axis);
    }
    typed(json!({"model": {
        "dimension": dimension,
        "nodes": {"block": place},
        "elements": [{"kind": "spring", "nodes": ["block"], "stiffness": stiffness}],
        "obstacles": {"slope": {"kind": "plane", "point": place, "normal": normal}},
        "contacts": [{"node": "block", "obstacle": "slope", "friction": 0.5}],
        "stages": [
            {"name": "weigh", "forces": {"block": down}, "until": {"load_above": 1}},
            {"name": "tilt", "obstacle_rotation": {"slope": rotation}, "until": {"load_above": 1.2}},
        ],
    }}))
}

/// The block sticks until `tan θ = μ`; from then on it is downhill by `(sin θ - μ cos θ)/k`, with `r_n = cos θ`.
#[test]
fn a_block_on_a_plane_that_tilts_slips_at_its_angle_of_friction() {
    let (friction, stiffness) = (0.5_f64, 0.1);
    for (dimension, axis) in
        [(2, None), (3, Some([0.0, -1.0, 0.0])), (3, Some([2.0, 0.0, 0.0])), (3, Some([0.6, 0.3, 0.0]))]
    {
        for method in [Method::Auto, Method::Mpec] {
            let mut request = tilting_plane(dimension, axis, 3.0);
            request.analysis.method = method;
            let traced = judged(&request);
            let what = format!("{dimension} {axis:?} {method:?}");
            assert_on_measure(&traced, &what);
            assert_eq!(traced.report.stop_reason, StopReason::StagesCompleted, "{what}");
            let tilt = of_stage(&traced, "tilt");
            let slips = tilt.iter().find(|increment| increment.point.kind == PointKind::ContactChange);
            close(slips.expect("a slip").load_factor, friction.atan(), 1e-10, &what);
            for increment in &tilt {
                let (sine, cosine) = increment.load_factor.sin_cos();
                let slid = ((sine - friction * cosine) / stiffness).max(0.0);
                let moved = increment.displacements["block"].iter().map(|part| part * part).sum::<f64>().sqrt();
                close(moved, slid, 1e-9, &what);
                close(increment.displacements["block"][dimension - 1], -slid * sine, 1e-9, &what);
                close(increment.contacts[0].normal_reaction, cosine, 1e-9, &what);
                let status = if slid > 1e-9 { Status::Slip } else { Status::Stick };
                assert_eq!(increment.contacts[0].status, status, "{what} {}", increment.load_factor);
            }
        }
    }
}

/// A disc of radius 1 that turns about a point 0.4 beside its centre lifts a follower on a vertical guide to
/// `e sin φ + √(r² - e² cos² φ)` above the pivot.
#[test]
fn a_cam_lifts_its_follower() {
    let request = typed(json!({"model": {
        "dimension": 2,
        "nodes": {"follower": [0, 0.916515138991168]},
        "supports": {"follower": ["x"]},
        "elements": [{"kind": "spring", "nodes": ["follower"], "stiffness": [[1, 0], [0, 0.5]]}],
        "obstacles": {"cam": {"kind": "ball", "center": [0.4, 0], "radius": 1}},
        "contacts": [{"node": "follower", "obstacle": "cam"}],
        "stages": [
            {"name": "press", "forces": {"follower": [0, -1]}, "until": {"load_above": 1}},
            {"name": "turn", "obstacle_rotation": {"cam": {"angle": 1, "about": [0, 0]}}, "until": {"load_above": 20}},
        ],
    }}));
    let traced = judged(&request);
    assert_on_measure(&traced, "cam");
    assert_eq!(traced.report.stop_reason, StopReason::StagesCompleted);
    let at_start = (1.0_f64 - 0.16).sqrt();
    for increment in of_stage(&traced, "turn") {
        let (sine, cosine) = increment.load_factor.sin_cos();
        let lift = 0.4 * sine + (1.0 - (0.4 * cosine).powi(2)).sqrt() - at_start;
        close(increment.displacements["follower"][1], lift, 1e-11, "lift");
        let up = (lift + at_start - 0.4 * sine).abs();
        close(increment.contacts[0].normal_reaction, (1.0 + 0.5 * lift) / up, 1e-10, "reaction");
    }
}

/// Obstacles of all kinds and where they are once they have turned.
fn turned_obstacles() -> Vec<(usize, Value, Value)> {
    let (sine, cosine) = 0.7_f64.sin_cos();
    // About (0.3, -0.2).
    let place = |x: f64, y: f64| {
        let (x, y) = (x - 0.3, y + 0.2);
        [0.3 + cosine * x - sine * y, -0.2 + sine * x + cosine * y]
    };
    let points = [[-4.0, -1.0], [-1.0, -0.3], [1.0, -0.3], [4.0, -1.2]];
    let turned: Vec<[f64; 2]> = points.iter().map(|point| place(point[0], point[1])).collect();
    let in_space = |place: [f64; 2], z: f64| [place[0], place[1], z];
    let [first, second] = [place(0.1, -0.9), place(-0.4, -2.1)];
    vec![
        (
            2,
            json!({"kind": "plane", "point": [0.1, -0.9], "normal": [0, 1]}),
            json!({"kind": "plane", "point": first, "normal": [-sine, cosine]}),
        ),
        (
            2,
            json!({"kind": "ball", "center": [-0.4, -2.1], "radius": 1.5}),
            json!({"kind": "ball", "center": second, "radius": 1.5}),
        ),
        (2, json!({"kind": "polyline", "points": points}), json!({"kind": "polyline", "points": turned})),
        (
            3,
            json!({"kind": "cylinder", "point": [-0.4, -2.1, 0.3], "axis": [1, 0, 0], "radius": 1.5}),
            json!({"kind": "cylinder", "point": in_space(second, 0.3), "axis": [cosine, sine, 0], "radius": 1.5}),
        ),
        (
            3,
            json!({"kind": "polyline", "points": points, "section": {"origin": [0, 0, 0], "x": [1, 0, 0], "y": [0, 1, 0]}}),
            json!({"kind": "polyline", "points": points, "section": {
                "origin": in_space(place(0.0, 0.0), 0.0), "x": [cosine, sine, 0], "y": [-sine, cosine, 0]}}),
        ),
    ]
}

/// An obstacle that has been turned before anything touches it is the obstacle where it then is: the same states, reactions
/// and works, to the rounding of both.
#[test]
fn an_obstacle_that_was_turned_is_the_obstacle_in_its_new_place() {
    for (dimension, obstacle, turned) in turned_obstacles() {
        let stiffness: Vec<Vec<f64>> =
            (0..dimension).map(|i| (0..dimension).map(|j| if i == j { 0.5 } else { 0.0 }).collect()).collect();
        let (mut down, mut across, mut place) = (vec![0.0; dimension], vec![0.0; dimension], vec![0.1; dimension]);
        (down[1], across[0], place[1]) = (-1.5, 0.8, 0.9);
        let press = json!({"name": "press", "forces": {"tip": down}, "until": {"load_above": 1}});
        let push = json!({"name": "push", "forces": {"tip": across}, "until": {"load_above": 1}});
        let mut about = vec![0.3, -0.2];
        let mut rotation = json!({"angle": 1});
        if dimension == 3 {
            about.push(5.0);
            rotation["axis"] = json!([0, 0, 3]);
        }
        rotation["about"] = json!(about);
        let turn = json!({"name": "turn", "obstacle_rotation": {"block": rotation}, "until": {"load_above": 0.7}});
        let posted = |obstacle: &Value, stages: Vec<&Value>| {
            judged(&typed(json!({"model": {
                "dimension": dimension,
                "nodes": {"tip": place},
                "elements": [{"kind": "spring", "nodes": ["tip"], "stiffness": stiffness}],
                "obstacles": {"block": obstacle},
                "contacts": [{"node": "tip", "obstacle": "block", "friction": 0.3}],
                "stages": stages,
            }})))
        };
        let (one, other) = (posted(&obstacle, vec![&turn, &press, &push]), posted(&turned, vec![&press, &push]));
        let what = format!("{dimension} {obstacle}");
        for traced in [&one, &other] {
            assert_on_measure(traced, &what);
            assert_eq!(traced.report.stop_reason, StopReason::StagesCompleted, "{what}");
        }
        let touches = |increment: &&Increment| increment.contacts.first().is_some_and(|c| c.status != Status::Free);
        assert!(one.increments.iter().any(|increment| touches(&increment)), "{what}");
        // Slip whose direction turns has an error of the fourth order in the step, and the steps differ.
        let bar = if dimension == 3 { 1e-5 } else { 1e-8 };
        for stage in ["press", "push"] {
            let [a, b] = [&one, &other].map(|traced| (*of_stage(traced, stage).last().expect("an end")).clone());
            for (a, b) in a.displacements["tip"].iter().zip(&b.displacements["tip"]) {
                close(*a, *b, bar, &what);
            }
            for (a, b) in a.contacts[0].reaction.iter().zip(&b.contacts[0].reaction) {
                close(*a, *b, bar, &what);
            }
            close(a.energy.dissipated, b.energy.dissipated, 1e-6, &what);
        }
    }
}

/// A belt of bars over a drum that turns beneath it: once all of it slides the tensions of its ends stand as those of a belt
/// that is pulled over a drum at rest, whichever way the drum turns.
#[test]
fn a_drum_that_turns_pulls_its_belt() {
    let (links, angle, friction) = (12, 1.8_f64, 0.3_f64);
    let place = |k: f64| (0.5 * std::f64::consts::PI + 0.5 * angle - angle * k / f64::from(links)).sin_cos();
    let mut nodes = serde_json::Map::new();
    let (mut elements, mut contacts) = (Vec::new(), Vec::new());
    let mut names = vec!["left".to_owned()];
    for k in 0..=links {
        let (sine, cosine) = place(f64::from(k));
        names.push(format!("n{k}"));
        nodes.insert(format!("n{k}"), json!([cosine, sine]));
        contacts.push(json!({"node": format!("n{k}"), "obstacle": "drum", "friction": friction}));
    }
    names.push("right".to_owned());
    let ((sine, cosine), half) = (place(0.0), 0.5 * angle / f64::from(links));
    // Along chords of the same length, so that the turns at the ends are those at the other nodes.
    let (along, across) = (2.0 * half.cos(), 2.0 * half.sin());
    let end = [cosine - along * sine - across * cosine, sine + along * cosine - across * sine];
    nodes.insert("left".into(), json!(end));
    nodes.insert("right".into(), json!([-end[0], end[1]]));
    for pair in names.windows(2) {
        elements.push(json!({"kind": "bar", "nodes": pair, "axial_stiffness": 1e4}));
    }
    let pull = [-0.02 * sine, 0.02 * cosine];
    for turn in [1.0, -1.0] {
        let traced = judged(&typed(json!({"model": {
            "dimension": 2, "nodes": nodes, "elements": elements, "contacts": contacts,
            "supports": {"left": ["x", "y"], "right": ["x", "y"]},
            "obstacles": {"drum": {"kind": "ball", "center": [0, 0], "radius": 1}},
            "stages": [
                {"name": "tighten", "displacements": {"left": pull, "right": [-pull[0], pull[1]]}, "until": {"load_above": 1}},
                {"name": "turn", "obstacle_rotation": {"drum": {"angle": turn}}, "until": {"load_above": 0.5}},
            ],
        }})));
        assert_on_measure(&traced, "drum");
        assert_eq!(traced.report.stop_reason, StopReason::StagesCompleted);
        let last = traced.increments.last().expect("an end");
        assert!(last.contacts.iter().all(|contact| contact.status == Status::Slip));
        let forces = |element: usize| last.elements[element].axial_force.expect("a bar");
        let (first, second) = (forces(0), forces(elements.len() - 1));
        // A polygon's nodes turn the bar by 2 h each: T₂/T₁ = ((1 + μ tan h)/(1 - μ tan h))^n; the bars stretch by 1e-2.
        let ratio = ((1.0 + friction * half.tan()) / (1.0 - friction * half.tan())).powi(links + 1);
        let found = if turn > 0.0 { second / first } else { first / second };
        println!("tensions {first} and {second}, ratio {found} for {ratio}");
        assert!((found / ratio - 1.0).abs() < 1e-3, "{found} for {ratio}");
    }
}

/// A solid on a slope that tilts about an oblique axis slides as a whole at `atan μ`, under a load that does not change: the
/// rounding of the load rate is no limit point.
#[test]
fn a_solid_that_slides_down_a_slope_has_no_limit_points() {
    let node = |place: usize| format!("n{}{}{}", place & 1, place >> 1 & 1, place >> 2);
    let at =
        |place: usize| json!([2 * (place & 1) as i32 - 1, 2 * (place >> 1 & 1) as i32 - 1, 0.5 * (place >> 2) as f64]);
    let nodes: serde_json::Map<String, Value> = (0..8).map(|place| (node(place), at(place))).collect();
    let names: Vec<String> = [0, 1, 3, 2, 4, 5, 7, 6].map(node).to_vec();
    let request = typed(json!({
        "model": {
            "dimension": 3, "nodes": nodes,
            "materials": {"rubber": {"kind": "neo_hookean", "young": 10, "poisson": 0}},
            "elements": [{"kind": "hexahedron8", "nodes": names, "material": "rubber"}],
            "surfaces": {"bottom": {"faces": [names[..4]]}},
            "obstacles": {"slope": {"kind": "plane", "point": [0, 0, 0], "normal": [0, 0, 1]}},
            "contacts": ([0, 1, 2, 3].map(|place| json!({"node": node(place), "obstacle": "slope", "friction": 0.3}))),
            "stages": [
                {"name": "weigh", "body_forces": {"rubber": [0, 0, -0.02]}, "until": {"load_above": 1}},
                {"name": "tilt", "obstacle_rotation": {"slope": {"angle": 1, "axis": [1, 0.4, 0]}}, "until": {"load_above": 1}},
            ],
        },
        "analysis": {"max_increments": 120},
    }));
    let traced = judged(&request);
    let worst = traced.errors.iter().map(|errors| errors.largest_of_state()).fold(0.0, f64::max);
    assert!(worst <= 1e-10, "{worst}");
    let energy = traced.errors.iter().map(|errors| errors.energy).fold(0.0, f64::max);
    assert!(energy <= 1e-6, "{energy}");
    let last = traced.increments.last().expect("an increment");
    close(last.load_factor, 0.3_f64.atan(), 1e-12, "full slip");
    let limits = traced.increments.iter().filter(|increment| increment.point.kind == PointKind::SmoothLimit).count();
    assert_eq!(limits, 0);
}

/// Two obstacles in one place that turn alike share their reaction; as one obstacle they give the same path.
#[test]
fn coincident_obstacles_that_turn_alike_are_one() {
    for friction in [0.0, 0.5] {
        let mut request = tilting_plane(2, None, 0.0);
        request.model.contacts[0].friction = friction;
        request.model.stages[1].obstacle_rotation["slope"].about = Some(vec![0.0, -1.0]);
        let single = judged(&request);
        let mut twins = request.clone();
        let slope = twins.model.obstacles["slope"].clone();
        twins.model.obstacles.insert("twin".to_owned(), slope);
        let contact =
            arcslip::model::request::Contact { obstacle: "twin".to_owned(), ..twins.model.contacts[0].clone() };
        twins.model.contacts.push(contact);
        let rotation = twins.model.stages[1].obstacle_rotation["slope"].clone();
        twins.model.stages[1].obstacle_rotation.insert("twin".to_owned(), rotation);
        let twins = judged(&twins);
        assert_on_measure(&twins, "twins");
        assert_eq!(twins.report.stop_reason, StopReason::StagesCompleted);
        assert_eq!(single.increments.len(), twins.increments.len());
        for (one, both) in single.increments.iter().zip(&twins.increments) {
            assert_eq!(one.displacements, both.displacements);
            let sum = both.contacts.iter().map(|contact| contact.normal_reaction).sum::<f64>();
            close(sum, one.contacts[0].normal_reaction, 1e-12, "reactions");
        }
    }
}

/// Tips on springs and bars before an obstacle of any kind, pressed onto it, which then turns about any point or axis and
/// may move, and pushed.
fn random_request(seed: u64) -> JobRequest {
    let mut numbers = Numbers(seed);
    let dimension = if seed.is_multiple_of(3) { 3 } else { 2 };
    let up = dimension - 1;
    let mut normal = numbers.vector(dimension, 0.2);
    normal[up] = 1.0;
    let points = [[-4.0, -0.5], [-1.0, 0.0], [1.0, 0.0], [3.0, 0.4], [5.0, 0.2]];
    let mut center = numbers.vector(dimension, 0.3);
    center[up] = -2.0;
    let obstacle = match (numbers.below(4), dimension) {
        (0, _) => json!({"kind": "plane", "point": vec![0.0; dimension], "normal": normal}),
        (1, 3) => json!({"kind": "cylinder", "point": center, "axis": [1, 0.2, 0], "radius": 2}),
        (1 | 2, _) => json!({"kind": "ball", "center": center, "radius": 2}),
        (_, 3) => json!({"kind": "polyline", "points": points,
            "section": {"origin": [0, 0, 0], "x": [1, 0.1, 0], "y": [0, 0, 1]}}),
        _ => json!({"kind": "polyline", "points": points}),
    };
    let (mut nodes, mut elements, mut contacts) = (serde_json::Map::new(), Vec::new(), Vec::new());
    let (mut press, mut push) = (serde_json::Map::new(), serde_json::Map::new());
    for tip in 0..1 + numbers.below(3) {
        let name = format!("tip{tip}");
        let mut place = numbers.vector(dimension, 0.2);
        place[0] += 1.5 * tip as f64 - 1.0;
        place[up] = 0.4 + numbers.between(0.0, 0.6);
        let stiffness: Vec<Vec<f64>> = (0..dimension)
            .map(|i| (0..dimension).map(|j| if i == j { 0.3 + 0.2 * i as f64 } else { 0.0 }).collect())
            .collect();
        elements.push(json!({"kind": "spring", "nodes": [name], "stiffness": stiffness}));
        if tip > 0 {
            let ends = [format!("tip{}", tip - 1), name.clone()];
            elements.push(json!({"kind": "bar", "nodes": ends, "axial_stiffness": numbers.between(0.2, 1.0)}));
        }
        contacts.push(json!({"node": name, "obstacle": "block", "friction": numbers.between(0.05, 1.2)}));
        let mut force = vec![0.0; dimension];
        force[up] = -numbers.between(0.6, 1.5);
        press.insert(name.clone(), json!(force));
        push.insert(name.clone(), json!(numbers.vector(dimension, 0.5)));
        nodes.insert(name, json!(place));
    }
    let mut rotation = json!({"angle": numbers.between(-1.5, 1.5), "about": numbers.vector(dimension, 2.0)});
    if dimension == 3 {
        rotation["axis"] = json!(numbers.vector(3, 1.0));
    }
    let mut turn = json!({"name": "turn", "obstacle_rotation": {"block": rotation}, "until": {"load_above": 1}});
    if numbers.chance(0.4) {
        turn["obstacle_motion"] = json!({"block": numbers.vector(dimension, 0.3)});
    }
    typed(json!({
        "model": {
            "dimension": dimension, "nodes": nodes, "elements": elements, "contacts": contacts,
            "obstacles": {"block": obstacle},
            "stages": [
                {"name": "press", "forces": press, "until": {"load_above": 1}},
                turn,
                {"name": "push", "forces": push, "until": {"load_above": 1}},
            ],
        },
        "analysis": {"max_increments": 2000},
    }))
}

/// Of random scenes every increment is on the measure, other units and axes give the same path, and a path that is put down
/// and taken up again is the same.
#[test]
fn random_scenes_with_an_obstacle_that_turns() {
    let scenes = 90;
    let mut completed = 0;
    for seed in 0..scenes {
        let request = random_request(seed);
        let traced = judged(&request);
        let what = format!("seed {seed}");
        assert_on_measure(&traced, &what);
        assert_ne!(traced.report.stop_reason, StopReason::StepUnderflow, "{what}");
        if traced.report.stop_reason != StopReason::StagesCompleted {
            println!("{what}: {}", traced.report.sentence);
        }
        completed += u64::from(traced.report.stop_reason == StopReason::StagesCompleted);
        let last = traced.increments.last().expect("an increment");
        let axes = [[0.36, 0.48, -0.8], [-0.8, 0.6, 0.0], [0.48, 0.64, 0.6]];
        let turned = match request.model.dimension {
            2 => turned_in_plane(request.clone(), 0.6, 0.5),
            _ => about_axes(request.clone(), &axes, [0.4, -0.7, 1.1]),
        };
        for (other, unit) in [(in_units(request.clone(), 1e3, 1e-4), 1e3), (turned, 1.0)] {
            let other = judged(&other);
            let end = other.increments.last().expect("an increment");
            assert_eq!(other.report.stop_reason, traced.report.stop_reason, "{what}");
            close(end.load_factor, last.load_factor, 1e-6, &what);
            let size = |increment: &Increment| {
                increment.displacements.values().flatten().map(|part| part * part).sum::<f64>().sqrt()
            };
            close(size(end) / unit, size(last), 1e-6 * size(last).max(1.0), &what);
        }
        let scene = Scene::new(&request).expect("a scene");
        let mut path = Path::new(&scene, CancelFlag::default());
        let half = traced.increments.len() / 2;
        path.by_ref().take(half).for_each(drop);
        let text = serde_json::to_string(&path.checkpoint()).expect("written");
        let stored: Checkpoint = serde_json::from_str(&text).expect("read");
        let resumed = Path::resume(&scene, stored, CancelFlag::default()).expect("resumed");
        let again: Vec<Increment> = resumed.collect();
        assert_eq!(again.len(), traced.increments.len() - half, "{what}");
        for (a, b) in again.iter().zip(&traced.increments[half..]) {
            assert_eq!(a.displacements, b.displacements, "{what}");
            assert_eq!(a.contacts, b.contacts, "{what}");
        }
    }
    println!("{completed} of {scenes} to the end");
    assert!(completed * 10 >= scenes * 9, "{completed} of {scenes}");
}
