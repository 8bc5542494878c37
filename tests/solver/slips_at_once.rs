//! Several nodes that touch in space without reaction and begin to slip at once.

use crate::common::paths::{close, request, trace, typed};
use arcslip::model::JobRequest;
use arcslip::model::request::Method;
use arcslip::result::increment::Status;
use arcslip::result::stop_reason::StopReason;
use serde_json::{Value, json};

const FRICTION: f64 = 0.3;

/// Blocks on springs of stiffness 1, pressed with 1 each and pulled, in one stage; `links` are springs between two.
fn blocks(pulls: &[[f64; 2]], links: &[(usize, usize, f64)]) -> Value {
    let name = |number: usize| format!("block{number}");
    let isotropic = |k: f64| json!([[k, 0, 0], [0, k, 0], [0, 0, k]]);
    let mut nodes = serde_json::Map::new();
    let (mut elements, mut contacts, mut forces) = (Vec::new(), Vec::new(), serde_json::Map::new());
    for (number, pull) in pulls.iter().enumerate() {
        nodes.insert(name(number), json!([number, 0, 0]));
        elements.push(json!({"kind": "spring", "nodes": [name(number)], "stiffness": isotropic(1.0)}));
        contacts.push(json!({"node": name(number), "obstacle": "floor", "friction": FRICTION}));
        forces.insert(name(number), json!([pull[0], pull[1], -1]));
    }
    for (first, second, k) in links {
        elements.push(json!({"kind": "spring", "nodes": [name(*first), name(*second)], "stiffness": isotropic(*k)}));
    }
    json!({"model": {
        "name": "blocks", "dimension": 3, "nodes": nodes, "supports": {}, "elements": elements,
        "obstacles": {"floor": {"kind": "plane", "point": [0, 0, 0], "normal": [0, 0, 1]}},
        "contacts": contacts, "stages": [{"name": "push", "forces": forces, "until": {"load_above": 1}}]
    }})
}

/// Alone a block that is pulled by `p > μ` goes along the pull, by `p - μ`: each of several that do not feel each other
/// does, and one that is pulled by less stays. Nothing else may happen, and nothing is left unexplored.
#[test]
fn blocks_that_do_not_feel_each_other() {
    let pulls = [[1.0, 0.0], [1.0, 0.2], [0.1, 0.2], [-0.3, 0.4]];
    let (increments, report) = trace(&request(&blocks(&pulls, &[]).to_string()));
    assert_eq!(report.stop_reason, StopReason::StagesCompleted);
    let start = increments[0].directions.as_ref().expect("directions");
    assert_eq!(start.len(), 2, "{start:?}");
    assert!(increments.iter().all(|i| i.point.unexplored_modes == 0 && !i.point.degenerate));
    let end = increments.last().expect("an end");
    assert_eq!(end.load_factor, 1.0);
    for (number, pull) in pulls.iter().enumerate() {
        let size = pull[0].hypot(pull[1]);
        let way = (1.0 - FRICTION / size).max(0.0);
        let u = &end.displacements[&*format!("block{number}")];
        close(u[0], way * pull[0], 1e-14, "x");
        close(u[1], way * pull[1], 1e-14, "y");
        let status = if way > 0.0 { Status::Slip } else { Status::Stick };
        assert_eq!(end.contacts[number].status, status);
    }
}

/// The circle of directions in which a block may begin to slip is searched with the effort of one search. Where this does not
/// suffice, what was found is listed and the rest counted.
#[test]
fn a_circle_that_is_not_searched_to_its_end_is_counted() {
    for (most_modes, left) in [(65_536, 0), (100, 1)] {
        let mut posted = blocks(&[[1.0, 0.2]], &[]);
        posted["model"]["elements"][0]["stiffness"] = json!([[1, 0.2, 0.1], [0.2, 2, 0.3], [0.1, 0.3, 1.5]]);
        posted["analysis"] = json!({"max_modes": most_modes});
        let (increments, report) = trace(&request(&posted.to_string()));
        assert_eq!(report.stop_reason, StopReason::StagesCompleted);
        assert_eq!(increments[0].point.unexplored_modes, left, "max_modes {most_modes}");
        assert!(increments[0].directions.as_ref().is_some_and(|directions| !directions.is_empty()));
    }
}

/// Two blocks joined by a spring `c`, pulled by `(1, ±p)`: mirror images of each other. With `d` the direction of the
/// slip, `1 - μ d_x = λ d_x` and `p - μ d_y = (1 + 2 c) λ d_y`.
#[test]
fn two_blocks_joined_by_a_spring() {
    let (pull, link) = (0.6, 0.7);
    // The angle at which the two equations give the same λ: a root between the x axis and the pull's direction.
    let misfit = |angle: f64| {
        let (y, x) = angle.sin_cos();
        (1.0 - FRICTION * x) * (1.0 + 2.0 * link) * y - (pull - FRICTION * y) * x
    };
    let (mut low, mut high) = (0.0, pull.atan());
    for _ in 0..100 {
        let middle = 0.5 * (low + high);
        if misfit(middle) < 0.0 { low = middle } else { high = middle }
    }
    let way = (1.0 - FRICTION * low.cos()) / low.cos();
    let model = blocks(&[[1.0, pull], [1.0, -pull]], &[(0, 1, link)]);
    let (increments, report) = trace(&request(&model.to_string()));
    assert_eq!(report.stop_reason, StopReason::StagesCompleted);
    let end = increments.last().expect("an end");
    for (number, side) in [1.0, -1.0].into_iter().enumerate() {
        let u = &end.displacements[&*format!("block{number}")];
        close(u[0], way * low.cos(), 1e-12, "x");
        close(u[1], side * way * low.sin(), 1e-12, "y");
    }
    // They feel each other: that these are all directions is not claimed.
    assert!(increments[0].point.unexplored_modes > 0);
}

/// A chain of blocks pulled at one end: only the first ones slip, more of them than are sought one by one.
#[test]
fn a_chain_of_blocks() {
    let mut pulls = [[0.0; 2]; 12];
    pulls[0] = [2.4, 0.5];
    pulls[11] = [-0.4, 0.4];
    let links: Vec<(usize, usize, f64)> = (1..12).map(|number| (number - 1, number, 3.0)).collect();
    let (increments, report) = trace(&request(&blocks(&pulls, &links).to_string()));
    assert_eq!(report.stop_reason, StopReason::StagesCompleted);
    let end = increments.last().expect("an end");
    let slipping = end.contacts.iter().filter(|contact| contact.status == Status::Slip).count();
    assert!((3..12).contains(&slipping), "{slipping}");
    // From the first step on the motion is proportional to the load, so every slip keeps its direction.
    for contact in end.contacts.iter().filter(|contact| contact.status == Status::Slip) {
        let (traction, slip) = (&contact.tangential_reaction, &contact.slip);
        let across = traction[0] * slip[1] - traction[1] * slip[0];
        assert!(across.abs() <= 1e-11 * slip[0].hypot(slip[1]), "{contact:?}");
    }
}

/// Two nodes that touch a floor on springs along it, tied by a bar; one is pushed across the bar, and pressed at second
/// order only, by a bar to a pin straight below. `r_n = EA (1/L₀ - 1/L) h` with that bar's present length, which friction
/// follows; the other node is drawn along and never pressed.
fn pressed_by_going(method: Method, step: f64) -> JobRequest {
    let along = json!([[1, 0, 0], [0, 1, 0], [0, 0, 1]]);
    let mut request = typed(json!({"model": {
        "name": "pressed at second order", "dimension": 3,
        "nodes": {"pushed": [0, 0, 0], "drawn": [2, 0, 0], "pin": [0, 0, -1]}, "supports": {"pin": ["x", "y", "z"]},
        "elements": [
            {"kind": "spring", "nodes": ["pushed"], "stiffness": along},
            {"kind": "spring", "nodes": ["drawn"], "stiffness": along},
            {"kind": "bar", "nodes": ["pushed", "drawn"], "axial_stiffness": 1},
            {"kind": "bar", "nodes": ["pin", "pushed"], "axial_stiffness": 1},
        ],
        "obstacles": {"floor": {"kind": "plane", "point": [0, 0, 0], "normal": [0, 0, 1]}},
        "contacts": [{"node": "pushed", "obstacle": "floor", "friction": FRICTION},
                     {"node": "drawn", "obstacle": "floor", "friction": FRICTION}],
        "stages": [{"name": "push", "forces": {"pushed": [0, 1, 0]}, "until": {"load_above": 1}}]
    }}));
    request.analysis.method = method;
    (request.analysis.arc_length.initial, request.analysis.arc_length.max) = (step, step);
    request
}

#[test]
fn nodes_that_are_pressed_only_once_they_have_moved() {
    let mut ends: Vec<f64> = Vec::new();
    for (method, step) in [(Method::Mpec, 0.04), (Method::Auto, 0.04), (Method::Auto, 0.02), (Method::Auto, 0.01)] {
        let (increments, report) = trace(&pressed_by_going(method, step));
        assert_eq!(report.stop_reason, StopReason::StagesCompleted);
        assert!(increments.len() as f64 <= 3.0 + 2.0 / step, "{} increments", increments.len());
        for increment in &increments[1..] {
            let [pushed, drawn] = &increment.contacts[..] else { panic!("two contacts") };
            let u = &increment.displacements["pushed"];
            let way = u[0].hypot(u[1]);
            let pressed = 1.0 - 1.0 / way.hypot(1.0);
            close(pushed.normal_reaction, pressed, 1e-13, "reaction");
            assert_eq!((pushed.status, drawn.status), (Status::Slip, Status::Slip));
            assert_eq!(drawn.normal_reaction, 0.0);
            // Friction opposes the slip, which turns by a few degrees in all.
            let (traction, slip) = (&pushed.tangential_reaction, &pushed.slip);
            let across = traction[0] * slip[1] - traction[1] * slip[0];
            assert!(across.abs() <= step * traction[0].hypot(traction[1]) * slip[0].hypot(slip[1]), "{pushed:?}");
        }
        ends.push(increments.last().expect("an end").displacements["pushed"][1]);
    }
    close(ends[0], ends[1], 1e-10, "by the program and without");
    println!("ends {ends:?}");
    let [coarse, fine] = [1, 2].map(|at| (ends[at] - ends[3]).abs());
    assert!(coarse <= 1e-8 && fine <= 0.3 * coarse.max(1e-13), "{ends:?}");
}

/// The same node alone, pushed straight: in the plane and at any angle in space the load is
/// `s = k x + EA x (1/L₀ - 1/L) + μ r_n`.
#[test]
fn a_node_that_is_pressed_only_once_it_has_moved() {
    let spring = |dimension: usize| -> Vec<Vec<f64>> {
        (0..dimension).map(|i| (0..dimension).map(|j| f64::from(u8::from(i == j))).collect()).collect()
    };
    for method in [Method::Auto, Method::Mpec] {
        for angle in [None, Some(0.0_f64), Some(0.7), Some(-2.0)] {
            let dimension = if angle.is_some() { 3 } else { 2 };
            let placed = |along: f64, up: f64| match angle {
                None => vec![along, up],
                Some(angle) => vec![along * angle.cos(), along * angle.sin(), up],
            };
            let components = &["x", "y", "z"][..dimension];
            let mut request = typed(json!({"model": {
                "name": "pressed at second order", "dimension": dimension,
                "nodes": {"node": placed(0.0, 0.0), "pin": placed(0.0, -1.0)}, "supports": {"pin": components},
                "elements": [
                    {"kind": "spring", "nodes": ["node"], "stiffness": spring(dimension)},
                    {"kind": "bar", "nodes": ["pin", "node"], "axial_stiffness": 1},
                ],
                "obstacles": {"floor": {"kind": "plane", "point": placed(0.0, 0.0), "normal": placed(0.0, 1.0)}},
                "contacts": [{"node": "node", "obstacle": "floor", "friction": FRICTION}],
                "stages": [{"name": "push", "forces": {"node": placed(1.0, 0.0)}, "until": {"load_above": 1}}]
            }}));
            request.analysis.method = method;
            let (increments, report) = trace(&request);
            assert_eq!(report.stop_reason, StopReason::StagesCompleted, "{angle:?}");
            for increment in &increments[1..] {
                let u = &increment.displacements["node"];
                let way = u.iter().map(|value| value * value).sum::<f64>().sqrt();
                let pressed = 1.0 - 1.0 / way.hypot(1.0);
                close(increment.load_factor, way + way * pressed + FRICTION * pressed, 1e-12, "load");
                close(increment.contacts[0].normal_reaction, pressed, 1e-13, "reaction");
                assert_eq!(increment.contacts[0].status, Status::Slip);
            }
        }
    }
}

/// A node that goes along the floor and is never pressed slips, in the plane as in space.
#[test]
fn a_node_that_goes_along_without_reaction_slips() {
    for dimension in [2, 3] {
        let spring: Vec<Vec<f64>> =
            (0..dimension).map(|i| (0..dimension).map(|j| f64::from(u8::from(i == j))).collect()).collect();
        let vector = |along: f64, up: f64| {
            let mut vector = vec![0.0; dimension];
            (vector[0], vector[dimension - 1]) = (along, up);
            vector
        };
        let (increments, report) = trace(&typed(json!({"model": {
            "name": "never pressed", "dimension": dimension, "nodes": {"node": vector(0.0, 0.0)},
            "elements": [{"kind": "spring", "nodes": ["node"], "stiffness": spring}],
            "obstacles": {"floor": {"kind": "plane", "point": vector(0.0, 0.0), "normal": vector(0.0, 1.0)}},
            "contacts": [{"node": "node", "obstacle": "floor", "friction": FRICTION}],
            "stages": [{"name": "push", "forces": {"node": vector(1.0, 0.0)}, "until": {"load_above": 1}}]
        }})));
        assert_eq!(report.stop_reason, StopReason::StagesCompleted);
        for increment in &increments[1..] {
            let contact = &increment.contacts[0];
            assert_eq!((contact.status, contact.normal_reaction), (Status::Slip, 0.0), "dimension {dimension}");
            assert!(contact.slip[0] > 0.0);
            close(increment.displacements["node"][0], increment.load_factor, 1e-14, "x");
        }
    }
}
