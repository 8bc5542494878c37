//! Obstacles with flat faces and rounded edges: boxes in the plane and in space, triangle meshes.

use crate::common::paths::{Traced, close, judged, typed};
use crate::common::random::Numbers;
use crate::common::variants::{about_axes, in_reverse, in_units};
use arcslip::continuation::path::checkpoint::Checkpoint;
use arcslip::continuation::path::iterator::Path;
use arcslip::continuation::scene::Scene;
use arcslip::model::JobRequest;
use arcslip::model::request::Method;
use arcslip::resources::cancel::CancelFlag;
use arcslip::result::increment::{Increment, Status};
use arcslip::result::stop_reason::StopReason;
use serde_json::{Value, json};

fn assert_on_measure(traced: &Traced, what: &str) {
    assert_on_measure_of_state(traced, what);
    for (increment, errors) in traced.increments.iter().zip(&traced.errors) {
        assert!(errors.energy <= 1e-6 && errors.strain_energy <= 1e-10, "{what}, {}: {errors:?}", increment.index);
    }
}

fn diagonal(entries: &[f64]) -> Vec<Vec<f64>> {
    let row = |i: usize| (0..entries.len()).map(|j| if i == j { entries[i] } else { 0.0 }).collect();
    (0..entries.len()).map(row).collect()
}

/// A tip on a spring whose head presses it onto an obstacle below, and is then moved along the first axis: stiff enough to
/// hold the tip at every edge.
fn dragged(obstacle: &Value, place: &[f64], friction: f64, drag: f64) -> JobRequest {
    let dimension = place.len();
    let (mut down, mut along) = (vec![0.0; dimension], vec![0.0; dimension]);
    (down[dimension - 1], along[0]) = (-0.2, 1.0);
    let entries: Vec<f64> = (0..dimension).map(|k| 10.0 + k as f64).collect();
    typed(json!({
        "model": {
            "dimension": dimension,
            "nodes": {"tip": place, "head": place},
            "supports": {"head": (&["x", "y", "z"][..dimension])},
            "elements": [{"kind": "spring", "nodes": ["head", "tip"], "stiffness": diagonal(&entries)}],
            "obstacles": {"block": obstacle},
            "contacts": [{"node": "tip", "obstacle": "block", "friction": friction}],
            "stages": [
                {"name": "press", "displacements": {"head": down}, "until": {"load_above": 1}},
                {"name": "drag", "displacements": {"head": along}, "until": {"load_above": drag}},
            ],
        },
        "analysis": {"max_increments": 3000},
    }))
}

/// A box in the plane is the closed polyline around it, to the bit.
#[test]
fn a_box_in_the_plane_is_the_polyline_around_it() {
    for side in ["outside", "inside"] {
        let own = json!({"kind": "box", "center": [0.0, -1.0], "size": [4.0, 2.0], "rounding": 0.3, "side": side});
        let around = json!({"kind": "polyline", "points": [[-2.0, -2.0], [2.0, -2.0], [2.0, 0.0], [-2.0, 0.0]],
            "closed": true, "rounding": 0.3, "side": side});
        let place = if side == "outside" { [0.5, 0.1] } else { [0.5, -1.9] };
        let [one, other] = [own, around].map(|obstacle| judged(&dragged(&obstacle, &place, 0.3, 1.2)));
        assert_on_measure(&one, side);
        assert!(one.increments.len() > 10 && one.increments.iter().any(|i| i.contacts[0].status == Status::Slip));
        assert_eq!(one.report.stop_reason, other.report.stop_reason);
        assert_same(&one.increments, &other.increments, side);
    }
}

/// On the top of a box a tip slides as on a plane: with `N = 12 · 0.1` it is `μN/10` behind the head. Beyond the edge it
/// follows the rounding until it is free at the height of the head.
#[test]
fn a_tip_slides_over_the_edge_of_a_box_in_space() {
    let obstacle = json!({"kind": "box", "center": [0, 0, -1], "size": [4, 6, 2], "rounding": 0.4});
    for friction in [0.0, 0.3] {
        for method in [Method::Auto, Method::Mpec] {
            let what = format!("friction {friction}, {method:?}");
            let mut request = dragged(&obstacle, &[0.5, 0.2, 0.1], friction, 3.0);
            request.analysis.method = method;
            let traced = judged(&request);
            assert_on_measure(&traced, &what);
            assert_eq!(traced.report.stop_reason, StopReason::StagesCompleted, "{what}");
            let behind = friction * 1.2 / 10.0;
            let mut on_face = 0;
            // The ball about the tip meets the edge 0.4 before it.
            for increment in traced.increments.iter().filter(|increment| &*increment.stage == "drag") {
                let displacement = &increment.displacements["tip"];
                if increment.contacts[0].status == Status::Slip && displacement[0] < 1.1 {
                    close(displacement[0], increment.load_factor - behind, 1e-12, &what);
                    close(displacement[2], -0.1, 1e-12, &what);
                    close(increment.contacts[0].normal_reaction, 1.2, 1e-12, &what);
                    on_face += 1;
                }
            }
            assert!(on_face > 3, "{what}");
            let last = traced.increments.last().expect("an increment");
            assert_eq!(last.contacts[0].status, Status::Free, "{what}");
            close(last.displacements["tip"][0], 3.0, 1e-9, &what);
            close(last.displacements["tip"][2], -0.2, 1e-9, &what);
        }
    }
}

/// A sphere of radius `radius` cut into triangles: an octahedron whose triangles are cut in four so many times.
fn cut_sphere(radius: f64, cuts: usize) -> (Vec<[f64; 3]>, Vec<[usize; 3]>) {
    let mut points: Vec<[f64; 3]> = Vec::new();
    for k in 0..3 {
        for sign in [radius, -radius] {
            let mut point = [0.0; 3];
            point[k] = sign;
            points.push(point);
        }
    }
    let mut triangles =
        vec![[0_usize, 2, 4], [2, 1, 4], [1, 3, 4], [3, 0, 4], [2, 0, 5], [1, 2, 5], [3, 1, 5], [0, 3, 5]];
    for _ in 0..cuts {
        let mut middles = std::collections::BTreeMap::new();
        let mut middle = |a: usize, b: usize| {
            *middles.entry([a.min(b), a.max(b)]).or_insert_with(|| {
                let sum: [f64; 3] = std::array::from_fn(|k| points[a][k] + points[b][k]);
                let size = sum.iter().map(|part| part * part).sum::<f64>().sqrt();
                points.push(sum.map(|part| part * radius / size));
                points.len() - 1
            })
        };
        let mut cut = Vec::new();
        for [a, b, c] in triangles {
            let [ab, bc, ca] = [middle(a, b), middle(b, c), middle(c, a)];
            cut.extend([[a, ab, ca], [ab, b, bc], [ca, bc, c], [ab, bc, ca]]);
        }
        triangles = cut;
    }
    (points, triangles)
}

/// A tip that is dragged over a finer and finer mesh of a ball with a rounding as long as its edges comes to the path over
/// the ball, with the square of the edge.
#[test]
fn a_mesh_of_a_ball_becomes_the_ball() {
    let end = |obstacle: &Value| {
        let traced = judged(&dragged(obstacle, &[0.1, 0.3, 2.0], 0.2, 0.4));
        assert_on_measure(&traced, "ball");
        assert_eq!(traced.report.stop_reason, StopReason::StagesCompleted);
        assert_eq!(traced.increments.last().expect("an end").contacts[0].status, Status::Slip);
        traced.increments.last().expect("an end").displacements["tip"].to_vec()
    };
    let exact = end(&json!({"kind": "ball", "center": [0, 0, 0], "radius": 2}));
    let error = |cuts: usize| {
        let (points, triangles) = cut_sphere(2.0, cuts);
        let rounding = 3.2 / f64::from(1 << cuts);
        let found =
            end(&json!({"kind": "triangle_mesh", "points": points, "triangles": triangles, "rounding": rounding}));
        found.iter().zip(&exact).map(|(a, b)| (a - b).powi(2)).sum::<f64>().sqrt()
    };
    let errors = [2, 3, 4].map(error);
    println!("{errors:?}");
    assert!(errors[2] < 0.3 * errors[1] && errors[1] < 0.4 * errors[0], "{errors:?}");
}

/// How the sides of a box are cut into triangles, in which order and sense these are, changes nothing but round-off.
#[test]
fn how_a_box_is_meshed_does_not_matter() {
    let own = json!({"kind": "box", "center": [0, 0, -1], "size": [4, 6, 2], "rounding": 0.4});
    let corner = |k: usize| [4.0 * (k & 1) as f64 - 2.0, 6.0 * (k >> 1 & 1) as f64 - 3.0, 2.0 * (k >> 2) as f64 - 2.0];
    // The other diagonals, from the last face to the first, seen from inside; with a point on the top.
    let faces = [[1, 3, 7, 5], [0, 4, 6, 2], [2, 6, 7, 3], [0, 1, 5, 4], [0, 2, 3, 1]];
    let mut triangles: Vec<[usize; 3]> = faces.iter().flat_map(|[a, b, c, d]| [[*b, *a, *d], [*d, *c, *b]]).collect();
    triangles.extend([[5, 4, 8], [7, 5, 8], [6, 7, 8], [4, 6, 8]]);
    let mut points: Vec<[f64; 3]> = (0..8).map(corner).collect();
    points.push([0.7, 0.1, 0.0]);
    let mesh = json!({"kind": "triangle_mesh", "points": points, "triangles": triangles, "rounding": 0.4});
    let [one, other] = [own, mesh].map(|obstacle| judged(&dragged(&obstacle, &[0.5, 2.8, 0.1], 0.3, 2.5)));
    assert_on_measure(&other, "mesh");
    assert_eq!(one.increments.len(), other.increments.len());
    for (a, b) in one.increments.iter().zip(&other.increments) {
        for (a, b) in a.displacements["tip"].iter().zip(&b.displacements["tip"]) {
            close(*a, *b, 1e-9, "meshed otherwise");
        }
    }
}

/// A bevelled wedge, a tetrahedron and a body with a step, about the origin.
fn random_obstacle(numbers: &mut Numbers) -> Value {
    match numbers.below(4) {
        0 => json!({"kind": "box", "center": numbers.vector(3, 0.2), "size": [2.4, 2.0, 1.6],
            "rounding": numbers.between(0.05, 0.8)}),
        1 => json!({"kind": "box", "center": numbers.vector(3, 0.2), "size": [2.0, 2.0, 2.0],
            "x": [1.0, numbers.between(-0.5, 0.5), 0.3], "y": [0.2, 1.0, numbers.between(-0.5, 0.5)]}),
        2 => json!({"kind": "triangle_mesh", "rounding": numbers.between(0.1, 0.4),
            "points": [[-1.6, -1.2, -0.8], [1.6, -1.2, -0.8], [0.1, 1.7, -0.8], [0.2, 0.1, 1.3]],
            "triangles": [[0, 2, 1], [0, 1, 3], [1, 2, 3], [2, 0, 3]]}),
        _ => {
            let (points, triangles) = cut_sphere(1.3, 1 + numbers.below(2));
            json!({"kind": "triangle_mesh", "rounding": numbers.between(0.1, 0.9), "points": points, "triangles": triangles})
        }
    }
}

/// Tips on springs and bars above a body that are pressed onto it; then the body moves and turns, or the tips are dragged.
fn random_request(seed: u64) -> JobRequest {
    let mut numbers = Numbers(seed);
    let obstacle = random_obstacle(&mut numbers);
    let (mut nodes, mut elements, mut contacts) = (serde_json::Map::new(), Vec::new(), Vec::new());
    let (mut press, mut push) = (serde_json::Map::new(), serde_json::Map::new());
    for tip in 0..1 + numbers.below(3) {
        let name = format!("tip{tip}");
        let mut place = numbers.vector(3, 0.5);
        place[0] += 0.9 * tip as f64 - 0.6;
        place[2] = 1.5 + numbers.between(0.0, 0.4);
        let entries = [1.5, 2.0, 2.5].map(|entry| entry * numbers.between(0.7, 1.4));
        elements.push(json!({"kind": "spring", "nodes": [name], "stiffness": diagonal(&entries)}));
        if tip > 0 {
            let ends = [format!("tip{}", tip - 1), name.clone()];
            elements.push(json!({"kind": "bar", "nodes": ends, "axial_stiffness": numbers.between(0.2, 1.0)}));
        }
        let friction = if numbers.chance(0.2) { 0.0 } else { numbers.between(0.05, 0.8) };
        contacts.push(json!({"node": name, "obstacle": "block", "friction": friction}));
        press.insert(name.clone(), json!([0.0, 0.0, -numbers.between(2.0, 4.0)]));
        push.insert(name.clone(), json!(numbers.vector(3, 2.0)));
        nodes.insert(name, json!(place));
    }
    let mut stages = vec![json!({"name": "press", "forces": press, "until": {"load_above": 1}})];
    if numbers.chance(0.5) {
        stages.push(
            json!({"name": "move", "obstacle_motion": {"block": numbers.vector(3, 0.5)}, "until": {"load_above": 1}}),
        );
    }
    if numbers.chance(0.4) {
        let turn = json!({"angle": numbers.between(-1.0, 1.0), "about": numbers.vector(3, 0.5), "axis": numbers.vector(3, 1.0)});
        stages.push(json!({"name": "turn", "obstacle_rotation": {"block": turn}, "until": {"load_above": 1}}));
    }
    stages.push(json!({"name": "push", "forces": push, "until": {"load_above": 1}}));
    typed(json!({
        "model": {"dimension": 3, "nodes": nodes, "elements": elements, "contacts": contacts,
            "obstacles": {"block": obstacle}, "stages": stages},
        "analysis": {"max_increments": 2000},
    }))
}

/// Of random scenes every increment is on the measure; other units, axes and another order give the same path; a path that
/// is put down and taken up again is the same.
#[test]
fn random_scenes_with_boxes_and_meshes() {
    let scenes = 40;
    let mut completed = 0;
    for seed in 0..scenes {
        let request = random_request(seed);
        let traced = judged(&request);
        let what = format!("seed {seed}");
        assert_on_measure(&traced, &what);
        if traced.report.stop_reason != StopReason::StagesCompleted {
            println!("{what}: {}", traced.report.sentence);
        }
        completed += u64::from(traced.report.stop_reason == StopReason::StagesCompleted);
        let last = traced.increments.last().expect("an increment");
        let axes = [[0.36, 0.48, -0.8], [-0.8, 0.6, 0.0], [0.48, 0.64, 0.6]];
        let variants = [
            (in_units(request.clone(), 1e3, 1e-4), 1e3),
            (about_axes(request.clone(), &axes, [0.4, -0.7, 1.1]), 1.0),
            (in_reverse(request.clone()), 1.0),
        ];
        for (number, (other, unit)) in variants.into_iter().enumerate() {
            let other = judged(&other);
            let end = other.increments.last().expect("an increment");
            assert_eq!(other.report.stop_reason, traced.report.stop_reason, "{what}, variant {number}");
            // Where an end follows a slip whose direction turns it has the error of the steps.
            let is_completed = traced.report.stop_reason == StopReason::StagesCompleted;
            let bar = if is_completed { 1e-5 } else { 1e-3 };
            close(end.load_factor, last.load_factor, bar, &what);
            let size = |increment: &Increment| {
                increment.displacements.values().flatten().map(|part| part * part).sum::<f64>().sqrt()
            };
            close(size(end) / unit, size(last), bar * size(last).max(1.0), &what);
        }
        resumes_as_before(&request, &traced.increments, &what);
    }
    println!("{completed} of {scenes} scenes to the end of their stages");
    assert!(completed * 10 >= scenes * 7, "{completed}");
}

fn resumes_as_before(request: &JobRequest, increments: &[Increment], what: &str) {
    let scene = Scene::new(request).expect("a scene");
    let mut path = Path::new(&scene, CancelFlag::default());
    let half = increments.len() / 2;
    path.by_ref().take(half).for_each(drop);
    let text = serde_json::to_string(&path.checkpoint()).expect("written");
    let stored: Checkpoint = serde_json::from_str(&text).expect("read");
    let resumed = Path::resume(&scene, stored, CancelFlag::default()).expect("resumed");
    let again: Vec<Increment> = resumed.collect();
    assert_same(&again, &increments[half..], what);
}

fn assert_same(one: &[Increment], other: &[Increment], what: &str) {
    assert_eq!(one.len(), other.len(), "{what}");
    for (a, b) in one.iter().zip(other) {
        assert_eq!(
            (a.load_factor, &a.displacements, &a.contacts),
            (b.load_factor, &b.displacements, &b.contacts),
            "{what}"
        );
    }
}

/// A tip posted on the face of a turned box, held by a spring and a bar straight out of it and pressed on, stays where it is:
/// displacements and works are round-off of the box's coordinates, which says nothing about the steps.
#[test]
fn a_tip_posted_on_the_face_of_a_turned_box_stays_there() {
    for turn in 0..24 {
        let (sine, cosine) = (0.3 + 0.7 * f64::from(turn)).sin_cos();
        let rounding = 0.02 + 0.04 * f64::from(turn);
        let in_space = turn % 3 == 0;
        let (along, out) = if in_space {
            (vec![cosine, sine, 0.0], vec![-0.6 * sine, 0.6 * cosine, 0.8])
        } else {
            (vec![cosine, sine], vec![-sine, cosine])
        };
        let dimension = out.len();
        let center = vec![0.37 * f64::from(turn); dimension];
        let moved = |by: f64| -> Vec<f64> { center.iter().zip(&out).map(|(center, out)| center + by * out).collect() };
        let mut own =
            json!({"kind": "box", "center": center, "size": vec![2.0; dimension], "rounding": rounding, "x": along});
        if in_space {
            own["y"] = json!(out);
        }
        let force: Vec<f64> = out.iter().map(|part| -0.7 * part).collect();
        let traced = judged(&typed(json!({
            "model": {
                "dimension": dimension,
                "nodes": {"tip": moved(1.0), "head": moved(2.5)},
                "supports": {"head": (&["x", "y", "z"][..dimension])},
                "elements": [
                    {"kind": "spring", "nodes": ["tip"], "stiffness": diagonal(&vec![1.0; dimension])},
                    {"kind": "bar", "nodes": ["head", "tip"], "axial_stiffness": 5},
                ],
                "obstacles": {"block": own},
                "contacts": [{"node": "tip", "obstacle": "block"}],
                "stages": [{"name": "press", "forces": {"tip": force}, "until": {"load_above": 1}}],
            },
            "analysis": {"max_increments": 200},
        })));
        let what = format!("turn {turn}");
        assert_on_measure_of_state(&traced, &what);
        assert_eq!(traced.report.stop_reason, StopReason::StagesCompleted, "{what}");
        let last = traced.increments.last().expect("an increment");
        close(last.contacts[0].normal_reaction, 0.7, 1e-12, &what);
        assert!(last.displacements["tip"].iter().all(|part| part.abs() < 1e-13), "{what}: {:?}", last.displacements);
    }
}

fn assert_on_measure_of_state(traced: &Traced, what: &str) {
    for (increment, errors) in traced.increments.iter().zip(&traced.errors) {
        assert!(errors.largest_of_state() <= 1e-10, "{what}, increment {}: {errors:?}", increment.index);
    }
}

/// A box in the plane may be rounded by half of its shortest side, whatever its axes.
#[test]
fn a_box_in_the_plane_may_be_rounded_all_over() {
    for turn in 0..60 {
        let (sine, cosine) = (0.04 * f64::from(turn)).sin_cos();
        let own =
            json!({"kind": "box", "center": [0.3, -1.0], "size": [1.026, 1.7], "rounding": 0.513, "x": [cosine, sine]});
        let traced = judged(&dragged(&own, &[0.3, 0.3], 0.2, 0.2));
        assert_eq!(traced.report.stop_reason, StopReason::StagesCompleted, "{turn}");
    }
}
