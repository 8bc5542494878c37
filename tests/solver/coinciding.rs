//! A contact that reaches the end of its mode at a point which is something else already: the change has a row of its
//! own, however close the two lie.

use crate::common::paths::{close, request, scene, trace};
use arcslip::continuation::path::iterator::Path;
use arcslip::continuation::scene::Scene;
use arcslip::model::request::Method;
use arcslip::resources::cancel::CancelFlag;
use arcslip::result::increment::{Increment, PointKind};
use arcslip::result::stop_reason::StopReason;
use serde_json::{Value, json};

/// Two structures side by side under one load: a post that buckles sideways, and a block that is dragged over the floor
/// against a spring and held by the friction of its weight.
fn post_and_block(weight: f64) -> Value {
    json!({"model": {
        "name": "post and block", "dimension": 2,
        "nodes": {"foot": [0, 0], "top": [0, 1], "block": [3, 0]}, "supports": {"foot": ["x", "y"]},
        "elements": [
            {"kind": "bar", "nodes": ["foot", "top"], "axial_stiffness": 1},
            {"kind": "spring", "nodes": ["top"], "stiffness": [[0.1, 0], [0, 0]]},
            {"kind": "spring", "nodes": ["block"], "stiffness": [[1, 0], [0, 1]]}
        ],
        "obstacles": {"floor": {"kind": "plane", "point": [0, 0], "normal": [0, 1]}},
        "contacts": [{"node": "block", "obstacle": "floor", "friction": 0.5}],
        "stages": [
            {"name": "press", "forces": {"block": [0, -weight]}, "until": {"load_above": 1}},
            {"name": "push", "forces": {"top": [0, -1], "block": [1, 0]}, "until": {"load_above": 0.12}}
        ]
    }})
}

/// The block's change has a row, whether the path goes on from there or, where the two cannot be told apart, ends.
#[test]
fn a_block_that_slips_just_where_the_post_buckles() {
    let (increments, _) = trace(&request(&post_and_block(1.0).to_string()));
    let buckling =
        increments.iter().find(|i| i.point.kind == PointKind::SmoothBifurcation).expect("buckling").load_factor;
    let mut at_once = 0;
    for exponent in -16..=-8 {
        for side in [-4.0, -1.0, 0.0, 1.0, 4.0] {
            let apart = side * 10.0_f64.powi(exponent);
            let (increments, report) = trace(&request(&post_and_block(2.0 * (buckling + apart)).to_string()));
            let told: Vec<&Increment> = increments
                .iter()
                .filter(|i| i.point.event.as_deref().is_some_and(|event| event.starts_with("block on floor")))
                .collect();
            assert_eq!(told.len(), 1, "{apart:e}: {report:?}");
            close(told[0].load_factor, buckling + apart, 1e-12, "load of the change");
            let ends = told[0].point.kind == PointKind::End;
            assert_eq!(ends, report.stop_reason != StopReason::StagesCompleted, "{apart:e}: {report:?}");
            assert!(!ends || told[0].point.degenerate, "{apart:e}");
            at_once += usize::from(told[0].step == 0.0);
        }
    }
    assert!(at_once > 0, "some fall together with the buckling");
}

/// Klarbring's node, put down in the corner as it came there, still stuck: the corner is a row of its own, with the
/// directions listed and nothing moved, and the path goes on as it does from the corner itself.
#[test]
fn a_mode_that_ends_where_a_step_starts_is_a_row() {
    for method in [Method::Auto, Method::Mpec] {
        let mut request = scene("klarbring");
        request.analysis.method = method;
        let scene = Scene::new(&request).expect("a scene");
        let mut path = Path::new(&scene, CancelFlag::default());
        let corner = path.find(|increment| increment.point.kind == PointKind::NonsmoothLimit).expect("a corner");
        let mut put_down = serde_json::to_value(path.checkpoint()).expect("written");
        let whole: Vec<Increment> = path.collect();
        let mut path = Path::new(&scene, CancelFlag::default());
        path.nth(corner.index as usize - 1).expect("the point before");
        let before = serde_json::to_value(path.checkpoint()).expect("written");
        for part in ["modes", "rate", "load_sign"] {
            put_down["at"]["here"][part] = before["at"]["here"][part].clone();
        }
        for part in ["counts", "visited"] {
            put_down["at"][part] = before["at"][part].clone();
        }
        let checkpoint = serde_json::from_value(put_down).expect("read");
        let rest: Vec<Increment> = Path::resume(&scene, checkpoint, CancelFlag::default()).expect("resumed").collect();
        let row = &rest[0];
        assert_eq!((row.index, row.step, row.arc_length), (corner.index + 1, 0.0, corner.arc_length));
        assert_eq!((&row.point, &row.directions), (&corner.point, &corner.directions));
        assert_eq!((row.load_factor, row.energy), (corner.load_factor, corner.energy));
        assert_eq!(row.displacements, corner.displacements);
        assert!(row.diagnostics.residual < 1e-14);
        assert_eq!(rest.len(), whole.len() + 1);
        for (found, expected) in rest[1..].iter().zip(&whole) {
            close(found.load_factor, expected.load_factor, 1e-12, "load");
            assert_eq!(found.point.kind, expected.point.kind);
        }
    }
}

/// Nodes on springs of their own over smooth floors whose heights differ by about what counts as no gap: some of them touch
/// where the first does, others by a hair later. All land, and press as each does alone.
#[test]
fn nodes_that_land_almost_at_once() {
    let mut least_apart = f64::INFINITY;
    for count in [4, 6, 12, 30] {
        for seed in 0..8_u64 {
            let names: Vec<String> = (0..count).map(|index| format!("node{index}")).collect();
            let mut model = json!({
                "name": "nodes over floors of almost one height", "dimension": 2, "nodes": {}, "elements": [],
                "obstacles": {}, "contacts": [],
                "stages": [{"name": "press", "forces": {}, "until": {"load_above": 0.5}}]
            });
            for (index, name) in names.iter().enumerate() {
                let lower = ((7919 * (index as u64 + 1) * (seed + 3)) % 1000) as f64 * 1e-13;
                let x = index as f64;
                model["nodes"][name] = json!([x, 0]);
                model["obstacles"][format!("floor{index}")] =
                    json!({"kind": "plane", "point": [x, -0.1 - lower], "normal": [0, 1]});
                model["stages"][0]["forces"][name] = json!([0, -1]);
            }
            let springs =
                names.iter().map(|name| json!({"kind": "spring", "nodes": [name], "stiffness": [[1, 0], [0, 1]]}));
            model["elements"] = springs.collect();
            let contacts = names.iter().enumerate();
            model["contacts"] = contacts
                .map(|(index, name)| json!({"node": name, "obstacle": format!("floor{index}"), "friction": 0}))
                .collect();
            for events in ["auto", "all"] {
                let (increments, report) =
                    trace(&request(&json!({"model": model, "analysis": {"events": events}}).to_string()));
                assert_eq!(report.stop_reason, StopReason::StagesCompleted, "{count} nodes, {seed}: {report:?}");
                let last = increments.last().expect("an increment");
                for contact in &last.contacts {
                    close(contact.normal_reaction, 0.4, 1e-9, "what each presses with");
                    assert!(contact.gap.abs() < 1e-9, "{contact:?}");
                }
                let steps = increments.iter().skip(1).map(|increment| increment.step);
                least_apart = steps.fold(least_apart, f64::min);
            }
        }
    }
    assert!(least_apart < 1e-9, "some land later than others by a hair: {least_apart:e}");
}
