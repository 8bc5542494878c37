//! Beams in space beside exact solutions: the bend of 45 degrees, lateral buckling, turns, frames in a plane, friction.

use crate::common::paths::{Traced, judged, typed};
use arcslip::continuation::path::checkpoint::Checkpoint;
use arcslip::continuation::path::iterator::Path;
use arcslip::continuation::scene::Scene;
use arcslip::model::JobRequest;
use arcslip::resources::cancel::CancelFlag;
use arcslip::result::increment::{Increment, PointKind, Status};
use nalgebra::{Rotation3, Vector3};
use serde_json::{Value, json};
use std::f64::consts::{FRAC_PI_2, FRAC_PI_4, PI};

/// A chain of beams through places, each with as many nodes as asked for; nodes are called `n0`, `n1`, ...
fn chain(places: &[[f64; 3]], per_beam: usize, section: &Value) -> (Value, Value) {
    let nodes: serde_json::Map<String, Value> =
        places.iter().enumerate().map(|(k, place)| (format!("n{k}"), json!(place))).collect();
    let beams = (0..places.len() - 1).step_by(per_beam - 1).map(|first| {
        let names: Vec<String> = (first..first + per_beam).map(|k| format!("n{k}")).collect();
        let mut beam = section.clone();
        (beam["kind"], beam["nodes"]) = (json!("beam"), json!(names));
        beam
    });
    (Value::Object(nodes), beams.collect())
}

fn straight(count: usize, length: f64) -> Vec<[f64; 3]> {
    (0..=count).map(|k| [length * k as f64 / count as f64, 0.0, 0.0]).collect()
}

const CLAMPED: [&str; 6] = ["x", "y", "z", "rx", "ry", "rz"];

/// All increments of a request, each held to the measure.
fn traced(request: &JobRequest) -> Traced {
    let traced = judged(request);
    for (increment, errors) in traced.increments.iter().zip(&traced.errors) {
        let what = format!("increment {} of {}: {errors:?}", increment.index, traced.increments.len());
        assert!(errors.largest_of_state() <= 1e-9, "{what}");
        assert!(errors.strain_energy <= 1e-9, "{what}");
        assert!(errors.energy <= 1e-6, "{what}");
    }
    traced
}

fn last(traced: &Traced) -> &Increment {
    traced.increments.last().expect("an increment")
}

/// The bend of 45 degrees with so many beams of three nodes: the displacement of its tip at each end force.
fn bend(count: usize, loads: &[f64]) -> Vec<[f64; 3]> {
    let places: Vec<[f64; 3]> = (0..=2 * count)
        .map(|k| {
            let angle = FRAC_PI_4 * k as f64 / (2 * count) as f64;
            [100.0 * angle.sin(), 100.0 * (1.0 - angle.cos()), 0.0]
        })
        .collect();
    let section = json!({
        "axial_stiffness": 1e7, "shear_stiffness": 5e6, "bending_stiffness": [1e7 / 12.0, 1e7 / 12.0],
        "torsional_stiffness": 5e6 / 6.0, "orientation": [0, 0, 1],
    });
    let (nodes, elements) = chain(&places, 3, &section);
    let tip = format!("n{}", 2 * count);
    let mut found = Vec::new();
    for load in loads {
        let traced = traced(&typed(json!({
            "model": {
                "dimension": 3, "nodes": nodes, "elements": elements, "supports": {"n0": CLAMPED},
                "stages": [{"name": "bend", "forces": {&tip: [0, 0, load]}, "until": {"load_above": 1.0}}],
            },
            "analysis": {"max_increments": 300},
        })));
        let end = last(&traced);
        assert_eq!(end.load_factor, 1.0, "{:?}", traced.report);
        found.push([0, 1, 2].map(|k| end.displacements[&tip][k]));
    }
    found
}

/// By `models/bend_of_45_degrees.py`; the last is the published one.
const BENT: [(f64, [f64; 3]); 3] = [
    (300.0, [-11.931_555_629, -7.044_540_936, 40.191_891_670]),
    (450.0, [-18.472_120_107, -10.781_142_956, 48.502_927_344]),
    (600.0, [-23.560240, -13.604521, 53.474859]),
];

#[test]
fn the_bend_of_45_degrees_is_met_with_the_fourth_order() {
    let errors = [2, 4, 8].map(|count| {
        let found = bend(count, &BENT.map(|(load, _)| load));
        let off = found.iter().zip(BENT).flat_map(|(found, (_, exact))| [0, 1, 2].map(|k| (found[k] - exact[k]).abs()));
        off.fold(0.0, f64::max)
    });
    let orders = [(errors[0] / errors[1]).log2(), (errors[1] / errors[2]).log2()];
    println!("45 degree bend, 2, 4, 8 beams of three nodes: {errors:?}, orders {orders:.2?}");
    assert!(errors[2] < 2e-4 && orders.iter().all(|order| *order > 3.5), "{errors:?} {orders:?}");
}

#[test]
fn a_strip_buckles_sideways_at_the_exact_load() {
    let exact = 4.012_599_343_58;
    let errors = [4, 8].map(|count| {
        let section = json!({
            "axial_stiffness": 1e9, "bending_stiffness": [1.0, 1e7], "torsional_stiffness": 0.5, "orientation": [0, 1, 0],
        });
        let (nodes, elements) = chain(&straight(count, 1.0), 2, &section);
        let tip = format!("n{count}");
        let traced = traced(&typed(json!({
            "model": {
                "dimension": 3, "nodes": nodes, "elements": elements, "supports": {"n0": CLAMPED},
                "stages": [{"name": "bend", "forces": {&tip: [0, -1, 0]}, "until": {"load_above": 4.0}}],
            },
            "analysis": {"max_increments": 300},
        })));
        let at = traced.increments.iter().find(|increment| increment.point.kind == PointKind::SmoothBifurcation);
        let at = at.unwrap_or_else(|| panic!("no bifurcation: {:?}", traced.report));
        (at.load_factor / 0.5_f64.sqrt() / exact - 1.0).abs()
    });
    let order = (errors[0] / errors[1]).log2();
    println!("lateral buckling with 4, 8 beams: {errors:?}, order {order:.2}");
    assert!(errors[1] < 1e-4 && order > 3.5, "{errors:?} {order}");
}

/// A rod of eight beams whose far end is turned about an axis by so much, free to move.
fn turned(stages: &[[f64; 3]], more: impl Fn(&mut Value)) -> JobRequest {
    let section = json!({
        "axial_stiffness": 1e3, "bending_stiffness": [1.0, 2.0], "torsional_stiffness": 0.7, "orientation": [0, 0, 1],
    });
    let (nodes, elements) = chain(&straight(8, 1.0), 2, &section);
    let stages: Vec<Value> = stages
        .iter()
        .enumerate()
        .map(|(k, [x, y, z])| {
            json!({
                "name": format!("turn {k}"), "displacements": {"n8": [0, 0, 0, x, y, z]}, "until": {"load_above": 1.0},
            })
        })
        .collect();
    let mut request = json!({
        "model": {
            "dimension": 3, "nodes": nodes, "elements": elements, "stages": stages,
            "supports": {"n0": CLAMPED, "n8": ["rx", "ry", "rz"]},
        },
        "analysis": {"max_increments": 3000},
    });
    more(&mut request);
    typed(request)
}

#[test]
fn a_rod_is_twisted_by_many_turns() {
    // A taut rod: a slack one would leave the straight line long before.
    let turns = 10.0 * PI;
    let request = turned(&[[turns, 0.0, 0.0]], |request| {
        request["model"]["supports"]["n8"] = json!(CLAMPED);
        for element in request["model"]["elements"].as_array_mut().expect("elements") {
            element["torsional_stiffness"] = json!(1e-3);
        }
    });
    let traced = traced(&request);
    let end = last(&traced);
    assert_eq!(end.load_factor, 1.0, "{:?}", traced.report);
    assert!((end.displacements["n4"][3] - 0.5 * turns).abs() < 1e-9, "{:?}", &end.displacements["n4"]);
    assert!((end.supports["n8"][3] - 1e-3 * turns).abs() < 1e-12, "{:?}", &end.supports["n8"]);
    let ends = end.elements[3].ends.expect("the ends of a beam");
    assert!(ends.iter().all(|end| (end.torsional_moment.expect("torsion") - 1e-3 * turns).abs() < 1e-12));
}

#[test]
fn a_rod_rolls_up_twice() {
    let traced = traced(&turned(&[[0.0, 0.0, 4.0 * PI]], |request| {
        for element in request["model"]["elements"].as_array_mut().expect("elements") {
            element["torsional_stiffness"] = json!(5.0);
        }
    }));
    let end = last(&traced);
    assert_eq!(end.load_factor, 1.0, "{:?}", traced.report);
    for (node, turn) in [("n2", PI), ("n6", 3.0 * PI), ("n8", 4.0 * PI)] {
        assert!((end.displacements[node][5] - turn).abs() < 1e-9, "{node}: {:?}", &end.displacements[node]);
    }
    assert!((end.displacements["n8"][0] + 1.0).abs() < 1e-9 && end.displacements["n8"][1].abs() < 1e-9);
    assert!((end.supports["n8"][5] - 4.0 * PI).abs() < 1e-9, "{:?}", &end.supports["n8"]);
}

#[test]
fn a_closed_cycle_of_rotations_comes_back_to_no_stress() {
    let traced = traced(&turned(&[[1.2, 0.0, 0.0], [0.0, 0.9, 0.3], [-1.2, 0.0, 0.0], [0.0, -0.9, -0.3]], |_| {}));
    let end = last(&traced);
    assert_eq!((&*end.stage, end.load_factor), ("turn 3", 1.0), "{:?}", traced.report);
    let most = traced.increments.iter().map(|increment| increment.energy.strain).fold(0.0, f64::max);
    assert!(most > 0.5 && end.energy.strain.abs() < 1e-12, "{most} {}", end.energy.strain);
    let moved = end.displacements.values().flatten().fold(0.0_f64, |most, value| most.max(value.abs()));
    assert!(moved < 1e-9, "{moved:e}");
}

/// What a rod is pushed against.
#[derive(Clone, Copy)]
enum Shape {
    Ball,
    Cylinder,
}

/// A quarter circle out of a wall, pushed against two rough obstacles by its tip's load; everything turned about an axis.
fn on_obstacles(turn: &Rotation3<f64>, shape: Shape) -> JobRequest {
    let turned = |vector: [f64; 3]| -> [f64; 3] { (turn * Vector3::from(vector)).into() };
    let places: Vec<[f64; 3]> = (0..=12)
        .map(|k| {
            let angle = FRAC_PI_2 * f64::from(k) / 12.0;
            turned([angle.sin(), 0.4 * (1.0 - angle.cos()), 0.3 * angle.cos()])
        })
        .collect();
    let section = json!({
        "axial_stiffness": 4e3, "shear_stiffness": 2e3, "bending_stiffness": [1.0, 1.5], "torsional_stiffness": 0.8,
        "orientation": turned([0.2, 0.1, 1.0]),
    });
    let (nodes, elements) = chain(&places, 3, &section);
    let contacts: Vec<Value> = (3..=12)
        .flat_map(|k| {
            let node = format!("n{k}");
            [
                json!({"node": node, "obstacle": "floor", "friction": 0.3}),
                json!({"node": node, "obstacle": "ball", "friction": 0.2}),
            ]
        })
        .collect();
    typed(json!({
        "model": {
            "dimension": 3, "nodes": nodes, "elements": elements, "supports": {"n0": CLAMPED}, "contacts": contacts,
            "obstacles": {
                "floor": {"kind": "plane", "point": turned([0.0, 0.0, -0.1]), "normal": turned([0.0, 0.0, 1.0])},
                "ball": match shape {
                    Shape::Ball => json!({"kind": "ball", "center": turned([1.5, 1.1, 0.0]), "radius": 0.5}),
                    Shape::Cylinder => json!({"kind": "cylinder", "point": turned([1.5, 1.1, 0.0]),
                                              "axis": turned([0.5, 0.2, 2.0]), "radius": 0.5}),
                },
            },
            "stages": [
                {"name": "press", "forces": {"n12": turned([0.0, 0.0, -2.0])}, "until": {"load_above": 1.0}},
                {"name": "push", "forces": {"n12": turned([0.3, 2.0, 0.0])}, "until": {"load_above": 2.0}},
            ],
        },
        // Scales that do not depend on the axes, as the box around the nodes does.
        "analysis": {
            "max_increments": 250,
            "arc_length": {"initial": 0.02, "max": 0.05, "displacement_scale": 1.0, "load_scale": 1.0},
        },
    }))
}

#[test]
fn a_rod_is_pushed_along_rough_obstacles() {
    for shape in [Shape::Ball, Shape::Cylinder] {
        let traced = traced(&on_obstacles(&Rotation3::identity(), shape));
        println!("{} increments, {:?}", traced.increments.len(), traced.report.stop_reason);
        let slipped = |increment: &Increment| increment.contacts.iter().any(|contact| contact.status == Status::Slip);
        assert!(traced.increments.iter().filter(|increment| slipped(increment)).count() > 5);
        assert!(last(&traced).energy.dissipated > 1e-3, "{:?} {:?}", last(&traced).energy, traced.report);
    }
}

#[test]
fn a_common_rotation_changes_nothing() {
    let turn = Rotation3::new(Vector3::new(0.8, -1.7, 0.6));
    // Until round-off decides about a step that is on the verge of being shortened.
    let first = |turn: &Rotation3<f64>, shape: Shape| {
        let mut request = on_obstacles(turn, shape);
        request.analysis.max_increments = 120;
        judged(&request)
    };
    for shape in [Shape::Ball, Shape::Cylinder] {
        assert_turned(&turn, &first(&Rotation3::identity(), shape), &first(&turn, shape));
    }
}

/// A path is another one, turned.
fn assert_turned(turn: &Rotation3<f64>, one: &Traced, other: &Traced) {
    assert_eq!(one.increments.len(), other.increments.len());
    for (one, other) in one.increments.iter().zip(&other.increments) {
        assert!((one.load_factor - other.load_factor).abs() < 1e-8, "{} {}", one.load_factor, other.load_factor);
        for (of_one, of_other) in one.displacements.values().zip(other.displacements.values()) {
            for first in (0..of_one.len()).step_by(3) {
                let turned = turn * Vector3::from_row_slice(&of_one[first..first + 3]);
                let off = (turned - Vector3::from_row_slice(&of_other[first..first + 3])).amax();
                assert!(off < 1e-8, "increment {}: {off:e}", one.index);
            }
        }
    }
}

/// Lee's frame, in the plane or in space.
fn lee(in_space: bool) -> JobRequest {
    let count = 5;
    let at = |k: usize| k as f64 / count as f64;
    let places: Vec<[f64; 2]> = (0..=count).map(|k| [0.0, at(k)]).chain((1..=count).map(|k| [at(k), 1.0])).collect();
    let of = |[x, y]: [f64; 2]| if in_space { json!([x, y, 0]) } else { json!([x, y]) };
    let nodes: serde_json::Map<String, Value> =
        places.iter().enumerate().map(|(k, place)| (format!("n{k}"), of(*place))).collect();
    let elements: Vec<Value> = (0..places.len() - 1)
        .map(|k| {
            let mut beam = json!({
                "kind": "beam", "nodes": [format!("n{k}"), format!("n{}", k + 1)], "axial_stiffness": 4e4, "shear_stiffness": 1e4,
            });
            if in_space {
                // Stiff against leaving the plane.
                beam["bending_stiffness"] = json!([1.0, 30.0]);
                (beam["torsional_stiffness"], beam["orientation"]) = (json!(20.0), json!([0, 0, 1]));
            } else {
                beam["bending_stiffness"] = json!(1.0);
            }
            beam
        })
        .collect();
    let held = if in_space { json!(["x", "y", "z", "rx", "ry"]) } else { json!(["x", "y"]) };
    typed(json!({
        "model": {
            "dimension": if in_space { 3 } else { 2 }, "nodes": nodes, "elements": elements,
            "supports": {"n0": held, "n10": held},
            "stages": [{"name": "press", "forces": {"n6": of([0.0, -1.0])}, "until": {"limit_points": 2}}],
        },
        "analysis": {"max_increments": 300, "arc_length": {"load_scale": 1.0}},
    }))
}

#[test]
fn a_frame_in_a_plane_is_the_plane_frame() {
    let (plane, space) = (traced(&lee(false)), traced(&lee(true)));
    let limits = |traced: &Traced| -> Vec<(f64, Vec<f64>)> {
        let at = traced.increments.iter().filter(|increment| increment.point.kind == PointKind::SmoothLimit);
        at.map(|increment| (increment.load_factor, increment.displacements["n6"].to_vec())).collect()
    };
    let (plane, space) = (limits(&plane), limits(&space));
    assert_eq!((plane.len(), space.len()), (2, 2));
    for ((load, u), (in_space, v)) in plane.iter().zip(&space) {
        assert!((load / in_space - 1.0).abs() < 1e-10, "{load} {in_space}");
        for (one, other) in [(u[0], v[0]), (u[1], v[1]), (u[2], v[5])] {
            assert!((one - other).abs() < 1e-7, "{u:?} {v:?}");
        }
        assert!(v[2].abs() < 1e-10 && v[3].abs() < 1e-10 && v[4].abs() < 1e-10);
    }
}

#[test]
fn a_path_taken_up_again_is_the_same_to_the_bit() {
    let mut request = on_obstacles(&Rotation3::identity(), Shape::Ball);
    request.analysis.max_increments = 60;
    let scene = Scene::new(&request).expect("a scene");
    let line = |mut increment: Increment| {
        increment.diagnostics.elapsed_s = 0.0;
        serde_json::to_string(&increment).expect("written")
    };
    let whole: Vec<String> = Path::new(&scene, CancelFlag::default()).map(line).collect();
    for cut in [1, 4, whole.len() / 2] {
        let mut path = Path::new(&scene, CancelFlag::default());
        let mut all: Vec<String> = path.by_ref().take(cut).map(line).collect();
        let text = serde_json::to_string(&path.checkpoint()).expect("written");
        let read: Checkpoint = serde_json::from_str(&text).expect("read");
        all.extend(Path::resume(&scene, read, CancelFlag::default()).expect("resumed").map(line));
        assert!(all == whole, "cut after {cut} of {}", whole.len());
    }
}

#[test]
fn mistakes_are_told() {
    let good = json!({
        "kind": "beam", "nodes": ["a", "b"], "axial_stiffness": 1.0, "bending_stiffness": [1.0, 2.0],
        "torsional_stiffness": 1.0, "orientation": [0, 1, 0],
    });
    let told = |dimension: usize, change: &dyn Fn(&mut Value)| {
        let mut element = good.clone();
        change(&mut element);
        let mut request = json!({
            "model": {
                "dimension": 3, "nodes": {"a": [0, 0, 0], "b": [1, 0, 0]}, "supports": {"a": CLAMPED}, "elements": [element],
                "stages": [{"name": "bend", "forces": {"b": [0, 0, 1]}, "until": {"load_above": 1.0}}],
            },
        });
        if dimension == 2 {
            request["model"]["dimension"] = json!(2);
            request["model"]["nodes"] = json!({"a": [0, 0], "b": [1, 0]});
            request["model"]["supports"] = json!({"a": ["x", "y", "rz"]});
            request["model"]["stages"][0]["forces"] = json!({"b": [0, 1]});
        }
        match arcslip::model::decode::decode(request.to_string().as_bytes()).and_then(|request| Scene::new(&request)) {
            Ok(_) => String::new(),
            Err(errors) => errors.to_string(),
        }
    };
    assert_eq!(told(3, &|_| ()), "");
    let without = |name: &'static str| move |beam: &mut Value| drop(beam.as_object_mut().expect("a beam").remove(name));
    for (found, expected) in [
        (told(3, &without("torsional_stiffness")), "`torsional_stiffness` is missing"),
        (told(3, &without("orientation")), "`orientation` is missing"),
        (told(3, &|beam| beam["orientation"] = json!([2, 0, 0])), "parallel to the beam"),
        (told(3, &|beam| beam["bending_stiffness"] = json!(1.0)), "in space two are expected"),
        (told(3, &|beam| beam["bending_stiffness"] = json!([1.0])), "two in space"),
        (told(3, &|beam| beam["bending_stiffness"] = json!([1.0, -1.0])), "bending_stiffness[1]: found -1.0"),
        (told(2, &|_| ()), "in the plane one is expected"),
        (told(2, &|beam| beam["bending_stiffness"] = json!(1.0)), "a beam in the plane is not twisted"),
    ] {
        assert!(found.contains(expected), "{expected}: {found}");
    }
}
