//! Several nodes that touch in space without reaction and begin to slip at once.

mod common;

use arcslip::path::StopReason;
use arcslip::path::increment::Status;
use common::paths::{close, request, trace};
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
