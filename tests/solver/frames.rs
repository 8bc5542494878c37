//! Plane frames: the arch on a rough floor by friction, angle and extension, and how errors fall with the elements.

use crate::common::paths::{Traced, close, judge, judged, typed};
use arcslip::check::cases::cases;
use arcslip::check::scenes::beams::RoughArch;
use arcslip::continuation::path::iterator::Path;
use arcslip::continuation::scene::Scene;
use arcslip::model::JobRequest;
use arcslip::model::request::{Method, Selection};
use arcslip::resources::cancel::CancelFlag;
use arcslip::result::increment::PointKind::{NonsmoothLimit, SmoothLimit};
use arcslip::result::increment::{Direction, Increment, Status};
use arcslip::result::stop_reason::StopReason;
use serde_json::{Value, json};
use std::collections::BTreeMap;

/// The request of a model whose last stage ends so.
fn request(mut model: Value, until: Value) -> JobRequest {
    let stages = model["stages"].as_array_mut().expect("stages");
    stages.last_mut().expect("a stage")["until"] = until;
    typed(json!({"model": model, "analysis": {"max_increments": 3000}}))
}

/// A path with every increment held to the measure.
fn traced(request: &JobRequest) -> Traced {
    let traced = judged(request);
    for (increment, errors) in traced.increments.iter().zip(&traced.errors) {
        assert!(errors.largest_of_state() <= 1e-9, "increment {}: {errors:?}", increment.index);
        assert!(errors.strain_energy <= 1e-9 && errors.energy <= 1e-6, "increment {}: {errors:?}", increment.index);
    }
    traced
}

fn first_limit(traced: &Traced) -> &Increment {
    let limit = |one: &&Increment| matches!(one.point.kind, NonsmoothLimit | SmoothLimit);
    traced.increments.iter().find(limit).expect("a limit point")
}

fn drop_of(increment: &Increment) -> f64 {
    -increment.displacements["n0"][1]
}

/// Each scene of beams with its numbers of elements: the errors fall with the fourth power, or, where a stretch comes to
/// lie on a wall node by node, with the first.
#[test]
fn errors_fall_with_the_order_of_the_elements() {
    const FAMILIES: [&str; 8] = [
        "rough-arch",
        "deep-arch",
        "lee-frame",
        "roll-up",
        "dead-end-force",
        "squeezed-ring",
        "column-between-walls",
        "dragged-tip",
    ];
    let mut rows: BTreeMap<(&str, String), Vec<(f64, f64)>> = BTreeMap::new();
    for case in cases().iter().filter(|case| FAMILIES.contains(&case.family) || case.family == "snap-fit") {
        let row = case.solve(Method::Auto);
        let (what, elements) = row.case.rsplit_once(", ").expect("a number of elements");
        let elements: f64 = elements.split(' ').next().and_then(|count| count.parse().ok()).expect("a number");
        println!("{row:?}");
        rows.entry((row.family, what.to_owned())).or_default().push((elements, row.error.unwrap_or(f64::INFINITY)));
    }
    let mut slow = Vec::new();
    for ((family, what), errors) in rows {
        let orders: Vec<f64> =
            errors.windows(2).map(|pair| (pair[0].1 / pair[1].1).ln() / (pair[1].0 / pair[0].0).ln()).collect();
        println!("{family}, {what}: {errors:?}, orders {orders:.2?}");
        let expected = match family {
            "roll-up" => continue,
            "column-between-walls" if what == "line contact" => 0.8,
            _ => 3.5,
        };
        // Below some 1e-9 rounding and the tolerance of equilibrium stand in for the elements.
        let counted = errors.windows(2).zip(&orders).filter(|(pair, _)| pair[1].1 > 1e-9);
        slow.extend(counted.filter(|(_, order)| **order < expected).map(|_| format!("{family}, {what}: {orders:.2?}")));
    }
    assert!(slow.is_empty(), "{}", slow.join("\n"));
}

/// Published: below μ = 2/π the foot slides from the first load, up to 1.0370 slip is the first critical point, above it
/// the stuck arch's own maximum.
#[test]
fn friction_decides_the_kind_of_the_first_critical_point() {
    for (friction, kind) in [(0.8, NonsmoothLimit), (1.03, NonsmoothLimit), (1.05, SmoothLimit), (1.2, SmoothLimit)] {
        let arch = RoughArch::right(friction, 1e5);
        let traced = traced(&request(arch.model(20), json!({"limit_points": 1})));
        assert_eq!(first_limit(&traced).point.kind, kind, "μ = {friction}");
        assert_eq!(traced.increments[1].contacts[0].status, Status::Stick, "μ = {friction}");
    }
    // A foot that slides from the first load on has no critical point: the load grows, past a foot that turns back.
    let sliding = traced(&request(RoughArch::right(0.5, 1e5).model(20), json!({"load_above": 20})));
    assert_eq!(sliding.increments[1].contacts[0].status, Status::Slip);
    assert!(sliding.increments.windows(2).all(|pair| pair[1].load_factor > pair[0].load_factor));
}

/// Onset, turn of the drop and minimum without extension, from two extensible arches: to 1e-6 of the published values with
/// 80 elements, to 1e-4 with 20.
#[test]
fn the_rough_arch_has_its_published_points() {
    let exact = [9.3605882420, 0.5003093224, 1.991708124, 0.818093982, 3.721305955, 0.236073760];
    for (elements, bar) in [(20, 1e-4), (80, 1e-6)] {
        let [softer, stiffer] = [1e4, 1e5].map(|axial| {
            let arch = RoughArch::right(0.8, axial);
            let loaded = traced(&request(arch.model(elements), json!({"limit_points": 2})));
            let least = loaded.increments.last().expect("an end");
            let onset = first_limit(&loaded);
            let mut driven = arch.model(elements);
            driven["supports"]["n0"] = json!(["x", "y", "rz"]);
            driven["stages"] = json!([{"name": "press", "displacements": {"n0": [0, -1, 0]}}]);
            let driven = traced(&request(driven, json!({"limit_points": 2})));
            let turn = driven.increments.last().expect("an end");
            assert_eq!(
                [onset.point.kind, least.point.kind, turn.point.kind],
                [NonsmoothLimit, SmoothLimit, SmoothLimit]
            );
            let half = -turn.supports["n0"][1];
            [onset.load_factor, drop_of(onset), least.load_factor, drop_of(least), 2.0 * half, turn.load_factor]
        });
        for k in 0..6 {
            // The extension's part is proportional to 1/EA.
            let rigid = stiffer[k] + (stiffer[k] - softer[k]) / 9.0;
            println!("{elements} elements: {rigid:.10}, exact {:.10}, error {:.1e}", exact[k], rigid - exact[k]);
            close(rigid, exact[k], bar * exact[k].max(1.0), &format!("{elements} elements, value {k}"));
        }
    }
}

#[test]
fn extension_lowers_the_onset_of_slip() {
    for (axial, onset) in [(1e3, 9.297066994), (1e4, 9.354333575), (1e5, 9.359963735)] {
        let traced = traced(&request(RoughArch::right(0.8, axial).model(30), json!({"limit_points": 1})));
        close(first_limit(&traced).load_factor, onset, 2e-6, &format!("EA = {axial:e}"));
    }
}

/// The foot of an arch of any angle slips at the first load where friction is below the thrust ratio, and sticks where it is
/// above.
#[test]
fn the_first_slip_gives_the_thrust_ratio() {
    for step in 0..=10 {
        let half_angle = (30.0 + 15.0 * f64::from(step)) * std::f64::consts::PI / 180.0;
        let ratio = RoughArch { half_angle, friction: 0.0, axial: 1e6 }.first_thrust();
        let status = |friction: f64| {
            let arch = RoughArch { half_angle, friction, axial: 1e7 };
            let traced = traced(&request(arch.model(20), json!({"load_above": 1e-3})));
            traced.increments.last().expect("an end").contacts[0].status
        };
        println!("{:.0}°: {ratio:.6}", half_angle.to_degrees());
        assert_eq!(status(ratio.abs() - 1e-3), Status::Slip, "{half_angle}");
        assert_eq!(status(ratio.abs() + 1e-3), Status::Stick, "{half_angle}");
    }
}

/// The increments along a listed direction, held to the measure.
fn follow(request: &JobRequest, index: u64, direction: usize, most: usize) -> Option<Vec<Increment>> {
    let scene = Scene::new(request).expect("a scene");
    let mut path = Path::new(&scene, CancelFlag::default());
    let before: Vec<Increment> = path.by_ref().take(index as usize + 1).collect();
    if !path.can_be_followed(direction) {
        return None;
    }
    let path = Path::follow(&scene, path.checkpoint(), direction, "follows".to_owned(), CancelFlag::default());
    let followed: Vec<Increment> = path.unwrap_or_else(|error| panic!("{error}")).take(most).collect();
    let mut judge = judge(request, scene.plan());
    for increment in before.iter().chain(&followed) {
        let errors = judge.judge(increment);
        assert!(errors.largest_of_state() <= 1e-9 && errors.energy <= 1e-6, "{}: {errors:?}", increment.index);
    }
    Some(followed)
}

/// At the slip the load falls both ways: with a foot that goes on slipping, and with one that sticks, back along the path.
#[test]
fn both_falling_continuations_at_the_slip_are_listed_and_followed() {
    let request = request(RoughArch::right(0.8, 1e5).model(20), json!({"limit_points": 2}));
    let traced = traced(&request);
    let slip = first_limit(&traced);
    let directions = slip.directions.as_ref().expect("directions");
    assert_eq!(directions.len(), 2, "{directions:?}");
    assert!(directions.iter().all(|direction| direction.load_rate < 0.0), "{directions:?}");
    for (place, direction) in directions.iter().enumerate() {
        let expected = if direction.retrace { Status::Stick } else { Status::Slip };
        assert_eq!(direction.contacts, [expected]);
        let Some(followed) = follow(&request, slip.index, place, 12) else {
            assert!(direction.retrace, "{direction:?}");
            continue;
        };
        for pair in followed.windows(2) {
            assert!(pair[1].load_factor < pair[0].load_factor && pair[1].contacts[0].status == expected);
            assert!(drop_of(&pair[1]) < drop_of(&pair[0]));
        }
    }
}

/// The whole arch of a half of so many elements, both feet on the floor and free.
fn whole_arch(half: &Value, friction: f64) -> Value {
    let mut whole = half.clone();
    let nodes = half["nodes"].as_object().expect("nodes");
    let mirror = |name: &str| if name == "n0" { name.to_owned() } else { name.replace('n', "m") };
    for (name, place) in nodes.iter().skip(1) {
        whole["nodes"][mirror(name)] = json!([-place[0].as_f64().expect("x"), place[1]]);
    }
    let beams = whole["elements"].as_array_mut().expect("beams");
    for mut beam in beams.clone() {
        let names: Vec<String> = beam["nodes"]
            .as_array()
            .expect("nodes")
            .iter()
            .rev()
            .map(|name| mirror(name.as_str().expect("n")))
            .collect();
        beam["nodes"] = json!(names);
        beams.push(beam);
    }
    let foot = format!("n{}", nodes.len() - 1);
    let on_floor = |node: String| json!({"node": node, "obstacle": "floor", "friction": friction});
    whole["supports"] = json!({});
    whole["contacts"] = json!([on_floor(foot.clone()), on_floor(mirror(&foot))]);
    whole["stages"][0]["forces"]["n0"] = json!([0, -1]);
    whole
}

/// The whole arch slips at the load of its half. Its two thrusts balance, so that both feet are on their cones while either
/// or both slip: how the slip is shared is left open. The ways on which one foot slips are listed beside the way back.
/// Load and drop fall along them as those of the half do. Where both slip, the arch may move sideways freely.
#[test]
fn a_whole_arch_slips_as_its_half_does() {
    let whole = whole_arch(&RoughArch::right(0.8, 1e5).model(10), 0.8);
    let request = request(whole, json!({"limit_points": 1}));
    let traced = traced(&request);
    let slip = traced.increments.last().expect("an end");
    let onset = RoughArch::right(0.8, 1e5).onset().expect("an onset");
    assert_eq!(slip.point.kind, NonsmoothLimit);
    close(slip.load_factor, onset.load, 1e-4, "onset");
    close(drop_of(slip), onset.drop, 1e-4, "drop at the onset");
    let mut request = request;
    request.model.stages[0].until = None;
    let slip = &judged(&request).increments[slip.index as usize];
    let directions = slip.directions.clone().expect("directions");
    assert!(directions.len() == 3 && slip.point.degenerate, "{directions:?}");
    let one_slips = |direction: &Direction| direction.contacts.contains(&Status::Stick) && !direction.retrace;
    assert_eq!(directions.iter().filter(|direction| one_slips(direction)).count(), 2, "{directions:?}");
    let half = traced_half(10);
    for (place, direction) in directions.iter().enumerate().filter(|(_, direction)| one_slips(direction)) {
        assert!(direction.load_rate < 0.0 && direction.contacts.contains(&Status::Slip), "{direction:?}");
        let followed = follow(&request, slip.index, place, 12).expect("a way on");
        for pair in followed.windows(2) {
            assert!(pair[1].load_factor < pair[0].load_factor && drop_of(&pair[1]) < drop_of(&pair[0]));
        }
        // Between two points of the half.
        let end = followed.last().expect("an end");
        let (above, below) = half
            .windows(2)
            .map(|pair| (&pair[0], &pair[1]))
            .find(|(above, below)| above.load_factor >= end.load_factor && below.load_factor <= end.load_factor)
            .expect("a load of the half");
        assert!(drop_of(end) <= drop_of(above) && drop_of(end) >= drop_of(below), "{}", drop_of(end));
    }
}

/// Both feet are on their cones from the start, and any share of the slip would do: of that family the edges are listed, on
/// which one foot sticks, whatever the round-off of a mesh adds. The path takes one of them, along which load and drop are
/// those of the half.
#[test]
fn feet_that_slip_from_the_start_share_their_slip_in_any_mesh() {
    for elements in [3, 5, 6, 7, 9, 11, 13, 20] {
        for friction in [0.2, 0.4] {
            let half = RoughArch::right(friction, 1e4).model(elements);
            let until = || json!({"load_above": 0.8});
            let expected = traced(&request(half.clone(), until()));
            let found = judged(&request(whole_arch(&half, friction), until()));
            assert_eq!(found.report.stop_reason, StopReason::StagesCompleted, "{elements} {friction}");
            let start = found.increments[0].directions.as_deref().expect("directions");
            let loaded = start.iter().filter(|direction| direction.load_rate > 1e-6);
            assert!(loaded.clone().all(|direction| direction.contacts.contains(&Status::Stick)), "{start:?}");
            assert_eq!(loaded.count(), 2, "{elements} {friction}");
            let [own, other] = [&found, &expected].map(|path| path.increments.last().expect("an end"));
            close(drop_of(own), drop_of(other), 1e-8, "drop");
        }
    }
}

/// A clamped beam is laid flat on a rough floor, pushed along it, and lifted at its end. While it is lifted the nodes that
/// still lie hardly move along the floor: many are on their cones without slip to first order, and some so close to it that
/// they reach it within the next step. A path goes on in any mesh.
#[test]
fn a_beam_that_is_lifted_off_a_rough_floor_finds_its_way_in_any_mesh() {
    for elements in [36, 38, 40, 44] {
        let nodes: BTreeMap<String, Value> =
            (0..=elements).map(|k| (format!("n{k}"), json!([2.0 * k as f64 / elements as f64, 0.02]))).collect();
        let beam = |k: usize| {
            let ends = [format!("n{k}"), format!("n{}", k + 1)];
            json!({"kind": "beam", "nodes": ends, "axial_stiffness": 1e4, "bending_stiffness": 1.0})
        };
        let weights: BTreeMap<String, Value> =
            (1..=elements).map(|k| (format!("n{k}"), json!([0, -20.0 / elements as f64]))).collect();
        let on_floor = |k: usize| json!({"node": format!("n{k}"), "obstacle": "floor", "friction": 0.3});
        let last = format!("n{elements}");
        let at_end = |force: [f64; 2]| BTreeMap::from([(last.clone(), json!(force))]);
        let model = json!({
            "dimension": 2, "nodes": nodes, "supports": {"n0": ["x", "y", "rz"]},
            "elements": (0..elements).map(beam).collect::<Vec<_>>(),
            "obstacles": {"floor": {"kind": "plane", "point": [0, 0], "normal": [0, 1]}},
            "contacts": (1..=elements).map(on_floor).collect::<Vec<_>>(),
            "stages": [
                {"name": "lay", "forces": weights, "until": {"load_above": 1}},
                {"name": "push", "forces": at_end([-1.0, 0.0]), "until": {"load_above": 2}},
                {"name": "lift", "forces": at_end([0.0, 1.0])}
            ]
        });
        let until = json!({"displacement": {"node": last, "component": "y", "above": 0.5}});
        let mut request = request(model, until);
        request.analysis.selection = Selection::Straightest;
        assert_eq!(traced(&request).report.stop_reason, StopReason::StagesCompleted, "{elements}");
    }
}

/// The falling part of the half arch.
fn traced_half(elements: usize) -> Vec<Increment> {
    let traced = traced(&request(RoughArch::right(0.8, 1e5).model(elements), json!({"limit_points": 2})));
    let slip = first_limit(&traced).index as usize;
    traced.increments[slip..].to_vec()
}
