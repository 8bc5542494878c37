//! Slip in space that runs into a point at which its direction is not determined.
//!
//! A node on a floor (μ = 0.5) is held by bars to supports and to a second, free node, and pushed by `s (1, -1, -1)/2`.
//! With `φ = μ r_n - |r_t|` as a function of the node's place and `s`, slip at the rate `α` against the traction and the
//! load rate obey `M α + q ṡ = 0`, `q = ∂φ/∂s`, `M = ∂φ` along the slip. All paths near by run into the point at
//! which `q` and `M` vanish together.

use crate::common::paths::{request, trace};
use arcslip::result::increment::PointKind;
use arcslip::result::stop_reason::StopReason;
use serde_json::{Value, json};

const FRICTION: f64 = 0.5;
const START: [f64; 3] = [0.5, -0.5, 0.0];
const FREE: [f64; 3] = [1.5, 0.0, 0.0];
/// Support, axial stiffness, whether the law is the logarithmic one.
const NODE_BARS: [([f64; 3], f64, bool); 3] =
    [([1.0, 0.0, 1.0], 2.0, true), ([1.0, -1.5, 1.5], 1.0, false), ([1.0, 0.0, 0.5], 1.5, false)];
const FREE_BARS: [([f64; 3], f64, bool); 3] =
    [([1.5, 0.0, 1.0], 1.5, false), ([2.0, -0.5, 1.0], 1.5, false), ([1.5, 0.0, 1.0], 1.0, false)];

fn model(initial: f64, most: f64) -> Value {
    let mut nodes = serde_json::Map::new();
    let mut supports = serde_json::Map::new();
    nodes.insert("node".into(), json!(START));
    nodes.insert("free".into(), json!(FREE));
    let mut elements = vec![json!({"kind": "bar", "nodes": ["node", "free"], "axial_stiffness": 1})];
    for (end, bars) in [("node", NODE_BARS), ("free", FREE_BARS)] {
        for (number, (support, stiffness, logarithmic)) in bars.into_iter().enumerate() {
            let name = format!("support of {end} {number}");
            nodes.insert(name.clone(), json!(support));
            supports.insert(name.clone(), json!(["x", "y", "z"]));
            let strain = if logarithmic { "log" } else { "engineering" };
            elements.push(json!({"kind": "bar", "nodes": [name, end], "axial_stiffness": stiffness, "strain": strain}));
        }
    }
    json!({"model": {
        "name": "folded slip", "dimension": 3, "nodes": nodes, "supports": supports, "elements": elements,
        "obstacles": {"floor": {"kind": "plane", "point": [0, 0, 0], "normal": [0, 0, 1]}},
        "contacts": [{"node": "node", "obstacle": "floor", "friction": FRICTION}],
        "stages": [{"name": "push", "forces": {"node": [0.5, -0.5, -0.5]}}]},
        "analysis": {"arc_length": {"initial": initial, "max": most}, "max_increments": 600}
    })
}

/// Force of a bar on its second end, which has moved to a place.
fn pull(support: [f64; 3], stiffness: f64, logarithmic: bool, rest: f64, place: [f64; 3]) -> [f64; 3] {
    let to: [f64; 3] = std::array::from_fn(|k| support[k] - place[k]);
    let length = to.iter().map(|x| x * x).sum::<f64>().sqrt();
    let stretch = length / rest;
    let force = stiffness * if logarithmic { stretch.ln() / stretch } else { stretch - 1.0 };
    to.map(|x| force * x / length)
}

fn length(a: [f64; 3], b: [f64; 3]) -> f64 {
    (0..3).map(|k| (a[k] - b[k]).powi(2)).sum::<f64>().sqrt()
}

/// Force of all bars on a node at a place, with the other node at another.
fn force(bars: [([f64; 3], f64, bool); 3], start: [f64; 3], place: [f64; 3], other: [f64; 3]) -> [f64; 3] {
    let mut sum = pull(other, 1.0, false, length(START, FREE), place);
    for (support, stiffness, logarithmic) in bars {
        let one = pull(support, stiffness, logarithmic, length(support, start), place);
        (0..3).for_each(|k| sum[k] += one[k]);
    }
    sum
}

/// Tangential force on the node from bars and load, and `φ`; the free node in equilibrium, found from near by.
fn slack(x: f64, y: f64, load: f64, near: [f64; 3]) -> ([f64; 2], f64) {
    let node = [START[0] + x, START[1] + y, 0.0];
    let mut free = near;
    for _ in 0..40 {
        let out = force(FREE_BARS, FREE, free, node);
        let step = 1e-6;
        let slopes = nalgebra::Matrix3::from_fn(|row, column| {
            let at = |by: f64| {
                let mut place = free;
                place[column] += by;
                force(FREE_BARS, FREE, place, node)[row]
            };
            (at(step) - at(-step)) / (2.0 * step)
        });
        let correction = slopes.lu().solve(&nalgebra::Vector3::from(out)).expect("a regular matrix");
        (0..3).for_each(|k| free[k] -= correction[k]);
    }
    let total = force(NODE_BARS, START, node, free);
    let along = [total[0] + 0.5 * load, total[1] - 0.5 * load];
    let pressed = -(total[2] - 0.5 * load);
    (along, FRICTION * pressed - along[0].hypot(along[1]))
}

#[test]
fn the_point_is_found_whatever_the_step() {
    let mut ends: Vec<[f64; 3]> = Vec::new();
    for (initial, most) in [(0.02, 0.1), (0.02, 0.03), (0.005, 0.03), (0.005, 0.005)] {
        let (increments, report) = trace(&request(&model(initial, most).to_string()));
        assert_eq!(report.stop_reason, StopReason::Degenerate, "{most}");
        let end = increments.last().expect("an end");
        assert_eq!(end.point.kind, PointKind::End);
        assert!(end.point.degenerate);
        assert!(end.point.event.as_deref().is_some_and(|event| event.starts_with("direction not determined")));
        let u = &end.displacements["node"];
        let moved = &end.displacements["free"];
        let free = [FREE[0] + moved[0], FREE[1] + moved[1], FREE[2] + moved[2]];
        let at = |x: f64, y: f64, s: f64| slack(u[0] + x, u[1] + y, end.load_factor + s, free);
        let (traction, value) = at(0.0, 0.0, 0.0);
        assert!(value.abs() < 1e-12, "off the cone by {value:e}");
        // The slip goes along what the traction opposes.
        let size = traction[0].hypot(traction[1]);
        let (dx, dy) = (traction[0] / size, traction[1] / size);
        // Differences of fourth order.
        let slope = |value: &dyn Fn(f64) -> f64| {
            let h = 2e-4;
            (8.0 * (value(h) - value(-h)) - (value(2.0 * h) - value(-2.0 * h))) / (12.0 * h)
        };
        let stuck = slope(&|h| at(0.0, 0.0, h).1);
        let along = slope(&|h| at(h * dx, h * dy, 0.0).1);
        assert!(stuck.abs() < 1e-8 && along.abs() < 1e-8, "q {stuck:e}, M {along:e}");
        // Nowhere before are both small: each listed direction has a load rate that means something.
        assert!(increments.iter().rev().skip(1).all(|i| !i.point.degenerate));
        ends.push([u[0], u[1], end.load_factor]);
    }
    for end in &ends {
        assert!((0..3).all(|k| (end[k] - ends[0][k]).abs() < 1e-11), "{ends:?}");
    }
}
