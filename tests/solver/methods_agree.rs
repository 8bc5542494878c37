//! `auto` and `mpec` trace the same path: the same points, events and directions, on every built-in scene.

use crate::common::paths::{request, scene, trace};
use arcslip::model::request::Method;
use arcslip::result::increment::Increment;
use serde_json::json;

#[test]
fn auto_and_mpec_agree_on_every_scene() {
    for built_in in arcslip::check::scenes::ALL {
        let mut request = scene(built_in.name);
        let (by_auto, auto_report) = trace(&request);
        request.analysis.method = Method::Mpec;
        let (by_mpec, mpec_report) = trace(&request);
        assert_eq!(by_auto.len(), by_mpec.len(), "{}", built_in.name);
        assert_eq!(auto_report.stop_reason, mpec_report.stop_reason);
        for (auto, mpec) in by_auto.iter().zip(&by_mpec) {
            let place = format!("{}, increment {}", built_in.name, auto.index);
            assert_eq!(auto.point, mpec.point, "{place}");
            assert_eq!(auto.directions, mpec.directions, "{place}");
            assert!((auto.load_factor - mpec.load_factor).abs() <= 1e-8, "{place}");
            for (a, b) in auto.displacements.values().flatten().zip(mpec.displacements.values().flatten()) {
                assert!((a - b).abs() <= 1e-8, "{place}");
            }
            assert_ne!(mpec.diagnostics.mode_named_by_mpec, Some(false), "{place}: the program names another mode");
        }
        let contacts = !request.model.contacts.is_empty();
        assert_eq!(mpec_report.mpec_solves + mpec_report.certificates > 0, contacts, "{}", built_in.name);
        let by_increment = mpec_report.qp_solves as f64 / mpec_report.increments as f64;
        println!("{}: {by_increment:.1} quadratic programs an increment", built_in.name);
    }
}

/// Two nodes of bars of unlike stiffness in space. Where the first comes to rest (s = 0.28951) it may stick while the
/// second goes on slipping, and both may stick on the way back: the rule takes the larger dissipation, whatever mode the
/// program names.
#[test]
fn the_rule_decides_where_the_program_names_no_direction() {
    let model = json!({"model": {
        "name": "two nodes on a floor", "dimension": 3,
        "nodes": {"n0": [0.07384619150335034, 0.08457430035184443, 0],
                  "n1": [0.7427815060983481, -0.12320594774198249, 0.05],
                  "p0_0": [-0.7562523351043311, 0.6727940295628709, 1.388351878568879],
                  "p0_1": [0.5633464971077655, 0.9832211339431141, 1.293770550765207],
                  "p1_0": [0.8710587033017095, -0.26405065536915484, 0.9142026252197428],
                  "p1_1": [0.3703042377489997, -0.8884858465944019, 1.3696436434587476],
                  "p1_2": [1.7141438772880884, 0.2586393543685921, 1.1042263583182457]},
        "supports": {"p0_0": ["x", "y", "z"], "p0_1": ["x", "y", "z"], "p1_0": ["x", "y", "z"], "p1_1": ["x", "y", "z"],
                     "p1_2": ["x", "y", "z"]},
        "elements": [
            {"kind": "bar", "nodes": ["p0_0", "n0"], "axial_stiffness": 1, "strain": "green"},
            {"kind": "bar", "nodes": ["p0_1", "n0"], "axial_stiffness": 1, "strain": "green"},
            {"kind": "spring", "nodes": ["n0"], "stiffness": [[0.05, 0, 0], [0, 0.05, 0], [0, 0, 0.05]]},
            {"kind": "bar", "nodes": ["p1_0", "n1"], "axial_stiffness": 1, "strain": "log"},
            {"kind": "bar", "nodes": ["p1_1", "n1"], "axial_stiffness": 1000, "strain": "log"},
            {"kind": "bar", "nodes": ["p1_2", "n1"], "axial_stiffness": 0.1, "strain": "engineering"},
            {"kind": "spring", "nodes": ["n1"], "stiffness": [[0.2, 0, 0], [0, 0.2, 0], [0, 0, 0.2]]},
            {"kind": "bar", "nodes": ["n0", "n1"], "axial_stiffness": 1}],
        "obstacles": {"o0": {"kind": "plane", "point": [0, 0, 0], "normal": [0, 0, 1]}},
        "contacts": [{"node": "n0", "obstacle": "o0", "friction": 0.3},
                     {"node": "n1", "obstacle": "o0", "friction": 0.3}],
        "stages": [
            {"name": "press", "forces": {"n0": [0, 0, -1], "n1": [0, 0, -1]}, "until": {"load_above": 0.3}},
            {"name": "s0", "forces": {"n0": [0.5, 0.3, 0], "n1": [-1, -0.1995592708888101, -0.3]}, "until": {"load_above": 0.5, "load_below": -1}}]
    }, "analysis": {"max_increments": 300}});
    let mut request = request(&model.to_string());
    let by_auto = trace(&request).0;
    request.analysis.method = Method::Mpec;
    let by_mpec = trace(&request).0;
    let point = |increment: &Increment| (increment.load_factor, increment.directions.clone());
    assert!(by_auto.iter().map(point).eq(by_mpec.iter().map(point)));
    let stops = by_mpec.iter().find(|i| i.point.event.as_deref() == Some("n0 on o0: slip to stick")).expect("it stops");
    let directions = stops.directions.as_ref().expect("directions");
    let largest = directions.iter().fold(0.0_f64, |largest, direction| largest.max(direction.dissipation_rate));
    assert!(largest > 0.2);
    assert!(directions.iter().all(|direction| direction.taken == (direction.dissipation_rate == largest)));
}
