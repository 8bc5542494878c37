//! Parts that nothing joins, alike, with one limit point in common.

use crate::common::generators::row_of_bars;
use crate::common::paths::{close, request, trace};
use arcslip::result::increment::{Direction, Increment, PointKind, Status};
use arcslip::result::stop_reason::StopReason;
use serde_json::{Value, json};

/// Load and place of the tip of a one-bar truss with μ = 0.3 at its limit points.
const MAXIMUM: (f64, f64) = (0.273315385577258, -0.557709057534769);
const MINIMUM: (f64, f64) = (-0.113981659145257, 0.850642773875925);

/// So many one-bar trusses side by side, each pushed on its own.
fn trusses(count: usize) -> Value {
    let (mut nodes, mut supports, mut forces) = (json!({}), json!({}), json!({}));
    let (mut elements, mut contacts) = (Vec::new(), Vec::new());
    for index in 0..count {
        let (pin, tip, x) = (format!("p{index}"), format!("t{index}"), 4.0 * index as f64);
        nodes[&pin] = json!([x, 1]);
        nodes[&tip] = json!([x - 1.5, 0]);
        supports[&pin] = json!(["x", "y"]);
        elements.push(json!({"kind": "bar", "nodes": [pin, tip], "axial_stiffness": 1}));
        contacts.push(json!({"node": tip, "obstacle": "floor", "friction": 0.3}));
        forces[&tip] = json!([1, 0]);
    }
    json!({"model": {"dimension": 2, "nodes": nodes, "supports": supports, "elements": elements, "contacts": contacts,
        "obstacles": {"floor": {"kind": "plane", "point": [0, 0], "normal": [0, 1]}},
        "stages": [{"name": "push", "forces": forces}]},
        "analysis": {"arc_length": {"initial": 0.05, "max": 0.1}}})
}

fn limits(increments: &[Increment]) -> Vec<&Increment> {
    increments.iter().filter(|increment| increment.point.kind == PointKind::SmoothLimit).collect()
}

fn directions(increment: &Increment) -> &[Direction] {
    increment.directions.as_deref().unwrap_or_default()
}

/// Two, four and eight trusses are one: their limit points are those of one, at each of which every part goes on
/// or, where the load falls, stays behind.
#[test]
fn identical_parts_go_through_their_limit_point_together() {
    for count in [1, 2, 4, 8] {
        let (increments, report) = trace(&request(&trusses(count).to_string()));
        assert_eq!(report.stop_reason, StopReason::Mechanism, "{count}");
        for increment in &increments {
            let first = &increment.displacements["t0"];
            for index in 1..count {
                let other = &increment.displacements[format!("t{index}").as_str()];
                close(other[0], first[0], 1e-9, "another tip");
            }
            let x = first[0] - 1.5;
            let (length, rest) = (x.hypot(1.0), 1.5_f64.hypot(1.0));
            close(increment.load_factor, (1.0 - length / rest) * (0.3 - x) / length, 1e-10, "load");
        }
        let limits = limits(&increments);
        assert_eq!(limits.len(), 2, "{count}");
        for (limit, (load, place)) in limits.iter().zip([MAXIMUM, MINIMUM]) {
            close(limit.load_factor, load, 1e-10, "load at the limit");
            close(limit.displacements["t0"][0] - 1.5, place, 1e-8, "place of the limit");
            assert!(!limit.point.degenerate, "{count}");
        }
        let [maximum, minimum] = [directions(limits[0]), directions(limits[1])];
        // Each subset that goes on, and that in which all stay.
        assert_eq!(maximum.len(), 1 << count, "{count}");
        let mut subsets: Vec<Vec<bool>> =
            maximum.iter().map(|one| one.contacts.iter().map(|status| *status == Status::Slip).collect()).collect();
        subsets.sort();
        subsets.dedup();
        assert_eq!(subsets.len(), 1 << count, "{count}");
        // A part that goes on alone dissipates μ r_n of its speed; of k that go on together each has 1/√k of it.
        let alone = maximum.iter().find(|one| one.contacts.iter().filter(|one| **one == Status::Slip).count() == 1);
        let alone = alone.expect("a part that goes on alone").dissipation_rate;
        for one in maximum {
            let parts = one.contacts.iter().filter(|status| **status == Status::Slip).count();
            close(one.dissipation_rate, alone * (parts as f64).sqrt(), 1e-8, "dissipation");
            assert_eq!(one.taken, parts == count);
            let load_rate = if parts == 0 { -1.0 } else { 0.0 };
            close(one.load_rate, load_rate, 1e-9, "load rate");
        }
        // The load is to rise: what stays behind would be pushed on. All slip, or all stay and the load falls.
        assert_eq!(minimum.len(), 2, "{count}");
        assert!(minimum.iter().all(|one| one.taken == (one.contacts[0] == Status::Slip)), "{count}");
    }
}

/// The model that ended short of the limit.
#[test]
fn the_load_past_the_common_limit_cannot_be_reached() {
    let mut model = trusses(2);
    model["model"]["stages"][0]["until"] = json!({"load_above": 0.35});
    let (increments, _) = trace(&request(&model.to_string()));
    close(limits(&increments)[0].load_factor, MAXIMUM.0, 1e-10, "limit");
}

/// A tie of 1e-9 hardly changes the path of two, but parts their limit from the bifurcation next to it.
#[test]
fn a_tie_that_is_next_to_nothing_leads_the_same_way() {
    let mut model = trusses(2);
    let bars = model["model"]["elements"].as_array_mut().expect("elements");
    bars.push(json!({"kind": "bar", "nodes": ["t0", "t1"], "axial_stiffness": 1e-9}));
    let (increments, _) = trace(&request(&model.to_string()));
    let limits = limits(&increments);
    close(limits[0].load_factor, MAXIMUM.0, 1e-8, "limit");
    close(limits[0].displacements["t0"][0] - 1.5, MAXIMUM.1, 1e-6, "place");
}

/// Shallow trusses without contact, alike: at their limit each goes on or back, and the path with them all.
#[test]
fn parts_without_contact_go_through_together() {
    let height = 0.5_f64;
    for count in [1, 2, 3] {
        let (mut nodes, mut supports, mut forces, mut elements) = (json!({}), json!({}), json!({}), Vec::new());
        for index in 0..count {
            let [left, right, apex] = ["l", "r", "a"].map(|name| format!("{name}{index}"));
            let x = 3.0 * index as f64;
            nodes[&left] = json!([x - 1.0, 0]);
            nodes[&right] = json!([x + 1.0, 0]);
            nodes[&apex] = json!([x, height]);
            supports[&left] = json!(["x", "y"]);
            supports[&right] = json!(["x", "y"]);
            supports[&apex] = json!(["x"]);
            forces[&apex] = json!([0, -1]);
            elements.push(json!({"kind": "bar", "nodes": [left, apex], "axial_stiffness": 1}));
            elements.push(json!({"kind": "bar", "nodes": [right, apex], "axial_stiffness": 1}));
        }
        let model = json!({"model": {"dimension": 2, "nodes": nodes, "supports": supports, "elements": elements,
            "stages": [{"name": "push", "forces": forces,
                "until": {"displacement": {"node": "a0", "component": "y", "below": -1.2}}}]}});
        let (increments, report) = trace(&request(&model.to_string()));
        assert_eq!(report.stop_reason, StopReason::StagesCompleted, "{count}");
        let limits = limits(&increments);
        assert_eq!(limits.len(), 2, "{count}");
        // s = 2 (1 - L/L0) y/L is largest where L³ = L0, L² = 1 + y².
        let rest = 1.0_f64.hypot(height);
        let (length, first) = (rest.cbrt(), (rest.cbrt().powi(2) - 1.0).sqrt());
        let load = 2.0 * (1.0 / length - 1.0 / rest) * first;
        for (limit, sign) in limits.iter().zip([1.0, -1.0]) {
            close(limit.load_factor, sign * load, 1e-10, "load");
            for apex in 0..count {
                let moved = limit.displacements[format!("a{apex}").as_str()][1];
                close(height + moved, sign * first, 1e-8, "place");
            }
            if count > 1 {
                assert_eq!(directions(limit).len(), 1 << count, "{count}");
            }
        }
    }
}

/// The row of bars with ties, in which nothing is in common, has the limit points that it had.
#[test]
fn limit_points_that_are_not_common_stay_as_they_are() {
    let (increments, _) = trace(&request(&row_of_bars(2).to_string()));
    let loads: Vec<f64> = limits(&increments).iter().map(|limit| limit.load_factor).collect();
    for (load, exact) in loads.iter().zip([0.28211874, 0.08721128, -0.13090421, -0.12023872]) {
        close(*load, exact, 1e-8, "load");
    }
    assert!(loads.len() >= 4);
}
