//! A tube under pressure from outside, a ring of beams: it buckles, its opposite sides meet at one point, then along a
//! line.
//!
//! J. E. Flaherty, J. B. Keller, S. I. Rubinow, SIAM J. Appl. Math. 23 (1972) 446, doi:10.1137/0123047: of an inextensible
//! ring with EI = 1 and radius 1 the sides meet at the pressure 5.247 and along a line from 10.34 on; it buckles at 3
//! (M. Lévy, 1884).

use super::whole_path;
use crate::common::paths::{close, request};
use arcslip::model::JobRequest;
use arcslip::result::increment::{Increment, PointKind, Status};
use serde_json::{Map, Value, json};
use std::f64::consts::TAU;

/// A ring of so many beams, oval by a part of its radius, under a pressure up to a bound. Its upper and lower parts, inside,
/// are surfaces that may touch.
fn tube(count: usize, oval: f64, friction: f64, until: f64) -> JobRequest {
    request(&posted(count, oval, friction, until).to_string())
}

fn posted(count: usize, oval: f64, friction: f64, until: f64) -> Value {
    let name = |k: usize| format!("n{}", k % count);
    let place = |k: usize| {
        let angle = TAU * k as f64 / count as f64;
        let radius = 1.0 + oval * (2.0 * angle).cos();
        [radius * angle.cos(), radius * angle.sin()]
    };
    let nodes: Map<String, Value> = (0..count).map(|k| (name(k), json!(place(k)))).collect();
    let beam = |k: usize| json!({"kind": "beam", "nodes": [name(k), name(k + 1)], "axial_stiffness": 1e6, "bending_stiffness": 1.0});
    // Counter-clockwise the inside is on the left.
    let inside = |from: usize, to: usize| (from..to).map(|k| json!([name(k), name(k + 1)])).collect::<Vec<_>>();
    let outside: Vec<Value> = (0..count).map(|k| json!([name(k + 1), name(k)])).collect();
    let eighth = count / 8;
    json!({
        "model": {
            "dimension": 2, "nodes": nodes, "elements": (0..count).map(beam).collect::<Vec<_>>(),
            // On the axes of symmetry; the upper side may move to a side over the lower one.
            "supports": {name(0): ["y", "rz"], name(4 * eighth): ["y", "rz"], name(6 * eighth): ["x", "rz"]},
            "surfaces": {"upper": {"faces": inside(eighth, 3 * eighth)}, "lower": {"faces": inside(5 * eighth, 7 * eighth)},
                         "outside": {"faces": outside}},
            "contacts": [{"surface": "upper", "against": "lower", "friction": friction}],
            "stages": [{"name": "press", "pressures": {"outside": 1}, "until": {"load_above": until}}],
        },
        "analysis": {"arc_length": {"initial": 1, "max": 50}, "record": {"elements": "none"}},
    })
}

/// The tube with its whole inside as one surface that may touch itself, and begins after the given beam.
fn tube_in_itself(count: usize, friction: f64, until: f64, seam: usize) -> JobRequest {
    let mut posted = posted(count, 1e-5, friction, until);
    let name = |k: usize| format!("n{}", k % count);
    let faces: Vec<Value> = (seam..seam + count).map(|k| json!([name(k), name(k + 1)])).collect();
    posted["model"]["surfaces"]["inside"] = json!({"faces": faces});
    posted["model"]["contacts"] = json!([{"surface": "inside", "against": "inside", "friction": friction}]);
    request(&posted.to_string())
}

/// The limit of results whose errors fall with a power of the length of elements, each half as long as before.
fn extrapolated(coarse: f64, fine: f64, order: i32) -> f64 {
    fine + (fine - coarse) / (2.0_f64.powi(order) - 1.0)
}

#[test]
fn a_tube_under_pressure_buckles() {
    let [coarse, fine] = [40, 80].map(|count| {
        let increments = whole_path(&tube(count, 0.0, 0.0, 3.5));
        let found = increments.iter().find(|increment| increment.point.kind == PointKind::SmoothBifurcation);
        found.expect("a bifurcation").load_factor
    });
    close(extrapolated(coarse, fine, 2), 3.0, 1e-4, "load of the bifurcation");
}

/// Without axes of symmetry the two ways to become oval vanish together. The tangent is symmetric up to the round-off of its
/// largest stiffness, and the sign of its determinant stays.
#[test]
fn a_free_tube_buckles_in_two_ways_at_once() {
    let mut request = tube(32, 0.0, 0.0, 3.3);
    request.model.contacts.clear();
    request.model.supports = serde_json::from_value(json!({"n0": ["x", "y"], "n16": ["y"]})).expect("supports");
    let increments = whole_path(&request);
    let is_one = |increment: &&Increment| increment.point.kind == PointKind::SmoothBifurcation;
    let found: Vec<&Increment> = increments.iter().filter(is_one).collect();
    let [found] = found[..] else { panic!("{} bifurcations", found.len()) };
    assert_eq!(found.point.event.as_deref(), Some("two eigenvalues cross zero together"));
    close(found.load_factor, 3.0239, 1e-3, "load of the bifurcation");
}

#[test]
fn the_opposite_sides_of_a_tube_meet() {
    let meetings = [(32, 12.5), (64, 11.5), (128, 11.0)].map(|(count, until)| {
        let increments = whole_path(&tube(count, 1e-5, 0.3, until));
        let touching =
            |increment: &Increment| increment.contacts.iter().filter(|contact| contact.status != Status::Free).count();
        let changes: Vec<f64> = increments
            .windows(2)
            .filter(|pair| touching(&pair[1]) > touching(&pair[0]))
            .map(|pair| pair[0].load_factor)
            .collect();
        println!("{count}: {changes:?}");
        assert!(changes.len() >= 2, "{count}: {changes:?}");
        // The path goes on from its event to the next increment.
        let point = increments.iter().find(|increment| increment.point.kind == PointKind::ContactChange);
        [point.expect("a contact").load_factor, changes[1]]
    });
    let [coarse, fine, finest] = meetings;
    let once = [extrapolated(coarse[0], fine[0], 2), extrapolated(fine[0], finest[0], 2)];
    close(extrapolated(once[0], once[1], 4), 5.247, 1e-3, "pressure at which a point meets a point");
    let once = [extrapolated(coarse[1], fine[1], 1), extrapolated(fine[1], finest[1], 1)];
    close(extrapolated(once[0], once[1], 2), 10.34, 0.05, "pressure from which a line touches");
}

/// The inside as one surface gives the path of its two sides as surfaces. It begins at an end of its longer axis, the first
/// one listed, so that the lower or the upper side carries the multipliers.
#[test]
fn a_tube_touches_itself() {
    let (count, until) = (32, 11.5);
    let sides = |surface: &str, against: &str| {
        let mut two = posted(count, 1e-5, 0.3, until);
        two["model"]["contacts"] = json!([{"surface": surface, "against": against, "friction": 0.3}]);
        whole_path(&request(&two.to_string()))
    };
    let meeting = |increments: &[Increment]| {
        let met = increments.iter().find(|increment| increment.point.kind == PointKind::ContactChange);
        met.expect("a contact").load_factor
    };
    let top = |increments: &[Increment]| increments.last().expect("an end").displacements["n8"].to_vec();
    let [lower, upper] = [sides("lower", "upper"), sides("upper", "lower")];
    for (seam, two) in [(30, &lower), (7, &upper)] {
        let one = whole_path(&tube_in_itself(count, 0.3, until, seam));
        println!("{seam}: {} {}, {:?} {:?}", meeting(&one), meeting(two), top(&one), top(two));
        close(meeting(&one), meeting(two), 1e-9, "pressure at which the sides meet");
        (0..2).for_each(|k| close(top(&one)[k], top(two)[k], 1e-9, "place of the top at the end"));
    }
}
