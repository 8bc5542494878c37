//! A node against several obstacles at once in space, or guided by supports: grooves, corners, pits, all exact.

use crate::common::paths::{close, trace, typed};
use arcslip::model::JobRequest;
use arcslip::model::request::Method;
use arcslip::result::increment::{Increment, Status};
use arcslip::result::stop_reason::StopReason;
use serde_json::{Map, Value, json};

const METHODS: [Method; 2] = [Method::Auto, Method::Mpec];

/// A plane through a point, with the friction of the node against it.
struct Plane {
    point: [f64; 3],
    normal: [f64; 3],
    friction: f64,
}

fn plane(normal: [f64; 3], friction: f64) -> Plane {
    Plane { point: [0.0; 3], normal, friction }
}

/// A node at the origin on springs k = 1 before planes, with its stages.
fn before(name: &str, planes: &[Plane], stages: Value) -> JobRequest {
    let (mut obstacles, mut contacts) = (Map::new(), Vec::new());
    for (index, plane) in planes.iter().enumerate() {
        let name = format!("plane{index}");
        contacts.push(json!({"node": "node", "obstacle": name, "friction": plane.friction}));
        obstacles.insert(name, json!({"kind": "plane", "point": plane.point, "normal": plane.normal}));
    }
    typed(json!({
        "model": {
            "name": name, "dimension": 3, "nodes": {"node": [0, 0, 0]},
            "elements": [{"kind": "spring", "nodes": ["node"], "stiffness": [[1, 0, 0], [0, 1, 0], [0, 0, 1]]}],
            "obstacles": obstacles, "contacts": contacts, "stages": stages
        }
    }))
}

fn force(name: &str, force: [f64; 3], above: f64) -> Value {
    json!({"name": name, "forces": {"node": force}, "until": {"load_above": above}})
}

/// The whole path by each method, to the end of its stages.
fn each(request: &JobRequest, check: impl Fn(&[Increment])) {
    for method in METHODS {
        let mut request = request.clone();
        request.analysis.method = method;
        let (increments, report) = trace(&request);
        let name = request.model.name.as_deref().unwrap_or_default();
        let last = increments.last().map(|last| (&last.stage, last.load_factor, &last.point, &last.contacts));
        assert_eq!(report.stop_reason, StopReason::StagesCompleted, "{name} by {method:?}: {last:?}");
        check(&increments);
    }
}

fn at(increment: &Increment, exact: [f64; 3], bar: f64) {
    let what = format!("{} at s = {}", increment.stage, increment.load_factor);
    for (found, exact) in increment.displacements["node"].iter().zip(exact) {
        close(*found, exact, bar, &what);
    }
}

fn passes(increments: &[Increment], stage: &str, load: f64) {
    let is_there = |increment: &&Increment| &*increment.stage == stage && (increment.load_factor - load).abs() < 1e-10;
    let found = increments.iter().find(is_there);
    assert!(found.is_some_and(|found| found.point.event.is_some()), "a corner of the path in {stage} at s = {load}");
}

/// Two flanks, each at the angle β to the vertical, friction μ on both: pressed by 1 each has `N = 1/(2 sin β)`, and along
/// the groove the node slides at `2 μ N`. Lifted it goes on along the groove, since its friction falls, and leaves both
/// flanks at once.
#[test]
fn a_groove_slides_at_twice_the_friction_of_a_flank() {
    for (degrees, friction) in [(30.0_f64, 0.2), (45.0, 0.3), (60.0, 0.5), (80.0, 1.2)] {
        let (sine, cosine) = degrees.to_radians().sin_cos();
        let flanks = [plane([cosine, 0.0, sine], friction), plane([-cosine, 0.0, sine], friction)];
        let stages = json!([
            force("press", [0.0, 0.0, -1.0], 1.0),
            force("pull", [0.0, 1.0, 0.0], 4.0),
            force("lift", [0.0, 0.0, 1.0], 2.0)
        ]);
        each(&before(&format!("groove of {degrees}"), &flanks, stages), |increments| {
            let slides = friction / sine;
            passes(increments, "pull", slides);
            for increment in increments {
                let s = increment.load_factor;
                let pressed = match &*increment.stage {
                    "press" => 1.0,
                    "pull" => {
                        at(increment, [0.0, (s - slides).max(0.0), 0.0], 1e-11);
                        1.0
                    }
                    _ => {
                        at(increment, [0.0, 4.0 - slides * (1.0 - s).max(0.0), (s - 1.0).max(0.0)], 1e-10);
                        (1.0 - s).max(0.0)
                    }
                };
                let slips = &*increment.stage == "lift" && s < 1.0 || &*increment.stage == "pull" && s > slides + 1e-9;
                for contact in &increment.contacts {
                    if slips {
                        let normal = pressed / (2.0 * sine);
                        assert_eq!((contact.status, contact.indeterminate), (Status::Slip, false));
                        close(contact.normal_reaction, normal, 1e-11, "N");
                        let traction = contact.tangential_reaction[0].hypot(contact.tangential_reaction[1]);
                        close(traction, friction * normal, 1e-11, "μ N");
                    } else {
                        assert_eq!(contact.indeterminate, contact.status == Status::Stick);
                    }
                }
            }
        });
    }
}

/// A block in the corner of a floor (pressed by `w`) and a wall (by `h`): along their edge it goes at `μ_f w + μ_w h`.
#[test]
fn a_block_between_floor_and_wall_has_the_friction_of_both() {
    for (floor, wall, weight, push) in [(0.3, 0.2, 1.0, 0.5), (0.0, 0.4, 1.0, 2.0), (0.7, 0.0, 0.3, 1.0)] {
        let planes = [plane([0.0, 0.0, 1.0], floor), plane([1.0, 0.0, 0.0], wall)];
        let stages = json!([
            force("press", [-push, 0.0, -weight], 1.0),
            force("pull", [0.0, 1.0, 0.0], 2.0),
            force("back", [0.0, -1.0, 0.0], 3.0)
        ]);
        each(&before(&format!("floor {floor} and wall {wall}"), &planes, stages), |increments| {
            let limit = floor * weight + wall * push;
            passes(increments, "pull", limit);
            passes(increments, "back", 2.0 * limit);
            for increment in increments {
                let s = increment.load_factor;
                let along = match &*increment.stage {
                    "press" => 0.0,
                    "pull" => (s - limit).max(0.0),
                    _ => (2.0 - limit) - (s - 2.0 * limit).max(0.0),
                };
                at(increment, [0.0, along, 0.0], 1e-11);
            }
        });
    }
}

/// On a floor (pressed by 1) pushed by `(1, a)` against a wall half a unit away, both rough: the node slips straight on,
/// touches where `u = (1, a)/2` and is held there until `a s - a/2 = μ_f + μ_w (s - 1/2)`; then it slides along the wall.
/// Drawn back by `(-1, b)` it leaves the wall where that carries nothing and is dragged over the floor on a line of length
/// `μ_f` whose end goes straight on: a tractrix. With b = 0 that begins at its cusp, where the slip is slow and turns fast.
#[test]
fn from_the_floor_to_a_wall_along_it_and_off_again() {
    let (floor, wall, a) = (0.3, 0.25, 0.9);
    for (b, bar) in [(0.4_f64, 1e-6), (0.0, 1e-4)] {
        let planes =
            [plane([0.0, 0.0, 1.0], floor), Plane { point: [0.5, 0.0, 0.0], normal: [-1.0, 0.0, 0.0], friction: wall }];
        let stages = json!([
            force("press", [0.0, 0.0, -1.0], 1.0),
            force("push", [1.0, a, 0.0], 2.0),
            force("back", [-1.0, b, 0.0], 2.5)
        ]);
        let mut request = before(&format!("floor, wall and off, b = {b}"), &planes, stages);
        request.analysis.arc_length.max = 0.02;
        each(&request, |increments| {
            let size = a.hypot(1.0);
            let touches = 0.5 + floor / size;
            let slides = 0.5 + floor / (a - wall);
            passes(increments, "push", touches);
            passes(increments, "push", slides);
            passes(increments, "back", 1.5);
            let mut off = 0.0_f64;
            for increment in increments {
                let s = increment.load_factor;
                match &*increment.stage {
                    "press" => at(increment, [0.0; 3], 1e-13),
                    "push" if s <= touches => {
                        let way = (s - floor / size).max(0.0);
                        at(increment, [way, a * way, 0.0], 1e-10);
                    }
                    "push" => {
                        let along = a * s - floor - wall * (s - 0.5);
                        at(increment, [0.5, if s < slides { 0.5 * a } else { along }, 0.0], 1e-10);
                    }
                    _ if s <= 1.5 => {
                        at(increment, [0.5, 2.0 * a + b * s - floor - wall * (1.5 - s), 0.0], 1e-10);
                    }
                    _ => {
                        let speed = b.hypot(1.0);
                        let (q, begun) = ([-1.0 / speed, b / speed], (b / speed).atanh());
                        let p = [0, 1].map(|k| (f64::from(k) - begun.tanh() * q[k as usize]) * begun.cosh());
                        let t = begun + (s - 1.5) * speed / floor;
                        let end = [2.0 - s, 2.0 * a + b * s];
                        let exact = [0, 1].map(|k| end[k] - floor * (t.tanh() * q[k] + p[k] / t.cosh()));
                        at(increment, [exact[0], exact[1], 0.0], bar);
                        let found = &increment.displacements["node"];
                        off = off.max((found[0] - exact[0]).hypot(found[1] - exact[1]));
                        println!("b = {b}, s = {s}: off {off:e}, {:e}", increment.diagnostics.error_estimate);
                    }
                }
            }
        });
    }
}

/// In the corner of three rough planes, pressed by 1 into each: pulled off the wall the node stays, its wall carrying
/// nothing from s = 1, until the friction of floor and back is overcome.
#[test]
fn a_corner_of_three_planes_holds_until_the_friction_of_two_is_overcome() {
    for friction in [0.0, 0.3] {
        let normals = [[0.0, 0.0, 1.0], [1.0, 0.0, 0.0], [0.0, 1.0, 0.0]];
        let planes = normals.map(|normal| plane(normal, friction));
        let stages = json!([force("press", [-1.0, -1.0, -1.0], 1.0), force("pull", [1.0, 0.0, 0.0], 4.0)]);
        each(&before(&format!("box, friction {friction}"), &planes, stages), |increments| {
            let leaves = 1.0 + 2.0 * friction;
            passes(increments, "pull", leaves);
            for increment in increments.iter().filter(|increment| &*increment.stage == "pull") {
                at(increment, [(increment.load_factor - leaves).max(0.0), 0.0, 0.0], 1e-11);
            }
        });
    }
}

/// A pit of four smooth planes, pressed by 1: each carries a quarter. Pushed by (1, 0) the node leaves up a flank at
/// s = 1, `u = (s - 1)/2 (1, 0, 1)`; by (1, 1/2) along the edge of two at s = 2/3, `u = (3 s/2 - 1)/3 (1, 1, 1)`.
#[test]
fn a_pit_of_four_smooth_planes_shares_and_lets_go() {
    let flanks = [[1.0, 0.0, 1.0], [-1.0, 0.0, 1.0], [0.0, 1.0, 1.0], [0.0, -1.0, 1.0]];
    for aside in [0.0, 0.5] {
        let planes = flanks.map(|normal| plane(normal, 0.0));
        let stages = json!([force("press", [0.0, 0.0, -1.0], 1.0), force("push", [1.0, aside, 0.0], 3.0)]);
        each(&before(&format!("pit, {aside} aside"), &planes, stages), |increments| {
            let leaves = if aside == 0.0 { 1.0 } else { 2.0 / 3.0 };
            passes(increments, "push", leaves);
            for increment in increments {
                let s = increment.load_factor;
                if &*increment.stage == "press" {
                    for contact in &increment.contacts {
                        close(contact.normal_reaction, s * 2.0_f64.sqrt() / 4.0, 1e-12, "a quarter");
                        assert!(contact.indeterminate || s == 0.0);
                    }
                } else if s <= leaves {
                    at(increment, [0.0; 3], 1e-13);
                } else if aside == 0.0 {
                    at(increment, [0.5 * (s - 1.0), 0.0, 0.5 * (s - 1.0)], 1e-11);
                } else {
                    at(increment, [(1.5 * s - 1.0) / 3.0; 3], 1e-11);
                }
            }
        });
    }
}

/// A pit of four rough planes: held until the projection of the push on the edge overcomes the friction of two.
#[test]
fn a_pit_of_four_rough_planes_lets_go_along_an_edge() {
    let friction = 0.2;
    let flanks = [[1.0, 0.0, 1.0], [-1.0, 0.0, 1.0], [0.0, 1.0, 1.0], [0.0, -1.0, 1.0]];
    let planes = flanks.map(|normal| plane(normal, friction));
    let stages = json!([force("press", [0.0, 0.0, -1.0], 1.0), force("push", [1.0, 1.0, 0.0], 3.0)]);
    // R = (-s, -s, 1) = N (n₂ + n₄) - v₀, e = (1, 1, 1)/√3: |v₀| = (2 s - 1)/√3, and across it N (n₂ + n₄) = (-1, -1, 2) N/√2
    // with (-1, -1, 2)·R = 2 s + 2: N = √2 (s + 1)/3.
    let drag = 2.0 * friction * 2.0_f64.sqrt() / 3.0;
    let leaves = (1.0 / 3.0_f64.sqrt() + drag) / (2.0 / 3.0_f64.sqrt() - drag);
    each(&before("rough pit", &planes, stages), |increments| {
        passes(increments, "push", leaves);
        for increment in increments.iter().filter(|increment| &*increment.stage == "push") {
            let s = increment.load_factor;
            // The springs pull along the edge alone.
            let along = ((2.0 * s - 1.0) / 3.0_f64.sqrt() - drag * (s + 1.0)).max(0.0) / 3.0_f64.sqrt();
            at(increment, [along; 3], 1e-11);
        }
    });
}

/// A node that starts in a corner without being pressed, pushed along its edge and into both planes: it slides at once where
/// the push is beyond the friction of both, and not at all where it is within.
#[test]
fn a_first_push_along_an_edge() {
    for (push, slides) in [(0.4, false), (0.6, true)] {
        let planes = [plane([0.0, 0.0, 1.0], 0.3), plane([1.0, 0.0, 0.0], 0.2)];
        let request = before("first push", &planes, json!([force("push", [-1.0, push, -1.0], 2.0)]));
        each(&request, |increments| {
            for increment in increments {
                let along = if slides { (push - 0.5) * increment.load_factor } else { 0.0 };
                at(increment, [0.0, along, 0.0], 1e-11);
            }
        });
    }
}

/// A node that starts in a corner without being pressed, pushed onto the floor and off the wall: it slips over the floor.
#[test]
fn a_first_push_off_the_wall() {
    let planes = [plane([0.0, 0.0, 1.0], 0.3), plane([1.0, 0.0, 0.0], 0.2)];
    let request = before("first push off", &planes, json!([force("push", [0.6, 0.8, -1.0], 2.0)]));
    each(&request, |increments| {
        for increment in increments {
            let way = 0.7 * increment.load_factor;
            at(increment, [0.6 * way, 0.8 * way, 0.0], 1e-10);
        }
    });
}

/// The groove in the plane, embedded in space: its node free across, or guided so that it cannot leave the plane.
#[test]
fn a_groove_embedded_in_space_is_left_at_the_same_load() {
    let friction = 0.25;
    let half = 0.5_f64.sqrt();
    for guided in [false, true] {
        let flanks = [plane([half, 0.0, half], friction), plane([-half, 0.0, half], friction)];
        let stages = json!([force("press", [0.0, 0.0, -1.0], 1.0), force("push", [1.0, 0.0, 0.0], 4.0)]);
        let mut request = before(&format!("embedded groove, guided: {guided}"), &flanks, stages);
        if guided {
            request.model.supports = serde_json::from_value(json!({"node": ["y"]})).expect("supports");
        }
        each(&request, |increments| {
            // s (1 - μ) = 1 + μ + 2 ξ, ξ the way in x and z: see the same groove in the plane.
            let leaves = (1.0 + friction) / (1.0 - friction);
            passes(increments, "push", leaves);
            for increment in increments.iter().filter(|increment| &*increment.stage == "push") {
                let s = increment.load_factor;
                let way = (0.5 * (s * (1.0 - friction) - 1.0 - friction)).max(0.0);
                at(increment, [way, 0.0, way], 1e-10);
            }
        });
    }
}

/// A node driven in x by its support over a floor and up a slope of 45° from x = 1/2, pressed by 1, and back.
#[test]
fn a_driven_node_goes_up_a_slope_and_back() {
    for method in METHODS {
        let mut request = typed(json!({
            "model": {
                "name": "driven up a slope", "dimension": 2, "nodes": {"node": [0, 0]}, "supports": {"node": ["x"]},
                "elements": [{"kind": "spring", "nodes": ["node"], "stiffness": [[1, 0], [0, 1]]}],
                "obstacles": {"floor": {"kind": "plane", "point": [0, 0], "normal": [0, 1]},
                              "slope": {"kind": "plane", "point": [0.5, 0], "normal": [-1, 1]}},
                "contacts": [{"node": "node", "obstacle": "floor", "friction": 0},
                             {"node": "node", "obstacle": "slope", "friction": 0}],
                "stages": [{"name": "press", "forces": {"node": [0, -1]}, "until": {"load_above": 1}},
                           {"name": "up", "displacements": {"node": [1, 0]}, "until": {"load_above": 2}},
                           {"name": "back", "displacements": {"node": [-1, 0]}, "until": {"load_above": 2}},
                           {"name": "to the corner", "displacements": {"node": [1, 0]}, "until": {"load_above": 0.5}},
                           {"name": "from the corner", "displacements": {"node": [1, 0]}, "until": {"load_above": 1}}]
            }
        }));
        request.analysis.method = method;
        let (increments, report) = trace(&request);
        assert_eq!(report.stop_reason, StopReason::StagesCompleted, "{:?}", increments.last());
        for increment in increments.iter().filter(|increment| &*increment.stage != "press") {
            let x = increment.displacements["node"][0];
            let height = (x - 0.5).max(0.0);
            close(increment.displacements["node"][1], height, 1e-11, &format!("height at {x}"));
            let carried: f64 =
                increment.contacts.iter().zip([1.0, 0.5_f64.sqrt()]).map(|(c, part)| c.normal_reaction * part).sum();
            close(carried, 1.0 + height, 1e-11, &format!("reactions at {x}"));
        }
    }
}

/// A node guided along y before a floor and a flank: what of the normals is free shares the press, `2/3` and `√2/3`.
#[test]
fn a_guided_node_before_two_obstacles() {
    for method in METHODS {
        let mut request = typed(json!({
            "model": {
                "name": "guided", "dimension": 2, "nodes": {"node": [0, 0]}, "supports": {"node": ["x"]},
                "elements": [{"kind": "spring", "nodes": ["node"], "stiffness": [[1, 0], [0, 1]]}],
                "obstacles": {"floor": {"kind": "plane", "point": [0, 0], "normal": [0, 1]},
                              "flank": {"kind": "plane", "point": [0, 0], "normal": [1, 1]}},
                "contacts": [{"node": "node", "obstacle": "floor", "friction": 0.5},
                             {"node": "node", "obstacle": "flank", "friction": 0.5}],
                "stages": [{"name": "press", "forces": {"node": [0, -1]}, "until": {"load_above": 1}},
                           {"name": "lift", "forces": {"node": [0, 1]}, "until": {"load_above": 2}}]
            }
        }));
        request.analysis.method = method;
        let (increments, report) = trace(&request);
        assert_eq!(report.stop_reason, StopReason::StagesCompleted);
        for increment in &increments {
            let lifting = &*increment.stage == "lift";
            let s = increment.load_factor;
            let pressed = if lifting { (1.0 - s).max(0.0) } else { s };
            close(increment.contacts[0].normal_reaction, pressed * 2.0 / 3.0, 1e-12, "floor");
            close(increment.contacts[1].normal_reaction, pressed * 2.0_f64.sqrt() / 3.0, 1e-12, "flank");
            close(increment.displacements["node"][1], if lifting { (s - 1.0).max(0.0) } else { 0.0 }, 1e-12, "lift");
        }
    }
}
