//! Plane beams beside exact solutions: roll-up, elastica, Lee's frame, an arch on a rough floor.

use crate::common::paths::{Traced, judged, request, typed};
use arcslip::continuation::scene::Scene;
use arcslip::model::JobRequest;
use arcslip::result::increment::{Increment, PointKind, Status};
use serde_json::{Value, json};
use std::f64::consts::{FRAC_PI_2, TAU};

/// A chain of beams through places, each with as many nodes as asked for; nodes are called `n0`, `n1`, ...
fn chain(places: &[[f64; 2]], per_beam: usize, section: &Value) -> (Value, Value) {
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

/// All increments of a request, each held to the measure.
fn traced(request: &JobRequest) -> Traced {
    let traced = judged(request);
    for (increment, errors) in traced.increments.iter().zip(&traced.errors) {
        assert!(errors.largest_of_state() <= 1e-9, "increment {}: {errors:?}", increment.index);
        assert!(errors.strain_energy <= 1e-9, "increment {}: {errors:?}", increment.index);
        assert!(errors.energy <= 1e-6, "increment {}: {errors:?}", increment.index);
    }
    traced
}

fn last(traced: &Traced) -> &Increment {
    traced.increments.last().expect("an increment")
}

#[test]
fn a_cantilever_rolls_up_into_a_circle() {
    for lengths in [&[1.0][..], &[0.25; 4], &[0.1, 0.4, 0.05, 0.45]] {
        let mut places = vec![[0.0, 0.0]];
        lengths.iter().for_each(|length| places.push([places[places.len() - 1][0] + length, 0.0]));
        let section = json!({"axial_stiffness": 1e4, "bending_stiffness": 2.0, "shear_stiffness": 4e3});
        let (nodes, elements) = chain(&places, 2, &section);
        let tip = format!("n{}", lengths.len());
        let request = typed(json!({
            "model": {
                "dimension": 2, "nodes": nodes, "elements": elements, "supports": {"n0": ["x", "y", "rz"]},
                "stages": [{"name": "roll", "moments": {&tip: TAU * 2.0}, "until": {"load_above": 1.0}}],
            },
            "analysis": {"max_increments": 3000},
        }));
        let traced = traced(&request);
        let end = last(&traced);
        assert!((end.load_factor - 1.0).abs() < 1e-12, "{}", end.load_factor);
        let [x, y, turn] = end.displacements[&tip][..] else { panic!("three components") };
        assert!((x + 1.0).abs() < 1e-9 && y.abs() < 1e-9 && (turn - TAU).abs() < 1e-9, "{x} {y} {turn}");
        let moment = end.supports["n0"][2];
        assert!((moment + 2.0 * TAU).abs() < 1e-9, "{moment}");
        let ends = end.elements[0].ends.expect("the ends of a beam");
        assert!(ends.iter().all(|end| (end.bending_moment.unwrap_or(f64::NAN) - 2.0 * TAU).abs() < 1e-9), "{ends:?}");
    }
}

/// The tip of an inextensible cantilever under a dead end force of 10 EI/L², by elliptic integrals.
const ELASTICA: [f64; 3] = [-0.5549955978, 0.8106090249, 1.430285539];

#[test]
fn a_slender_cantilever_bends_into_the_elastica() {
    for slenderness in [1e3, 1e4, 1e5, 1e6] {
        let errors = [4, 8].map(|count| {
            let places: Vec<[f64; 2]> = (0..=count).map(|k| [k as f64 / count as f64, 0.0]).collect();
            let section = json!({"axial_stiffness": slenderness * slenderness, "bending_stiffness": 1.0});
            let (nodes, elements) = chain(&places, 2, &section);
            let tip = format!("n{count}");
            let request = typed(json!({
                "model": {
                    "dimension": 2, "nodes": nodes, "elements": elements, "supports": {"n0": ["x", "y", "rz"]},
                    "stages": [{"name": "bend", "forces": {&tip: [0, 10]}, "until": {"load_above": 1.0}}],
                },
                "analysis": {"max_increments": 5000},
            }));
            let traced = judged(&request);
            let end = last(&traced);
            assert!((end.load_factor - 1.0).abs() < 1e-12, "{slenderness:e}: {} {:?}", end.load_factor, traced.report);
            println!("slenderness {slenderness:e}, {count} elements: {} increments", traced.increments.len());
            let tip = &end.displacements[&tip];
            tip.iter().zip(ELASTICA).fold(0.0_f64, |most, (found, exact)| most.max((found - exact).abs()))
        });
        let order = (errors[0] / errors[1]).log2();
        println!("slenderness {slenderness:e}: {:?}, order {order:.2}", errors.map(|error| format!("{error:.2e}")));
        assert!(errors[1] < 1e-4 && order > 3.7, "{slenderness:e}: {errors:?} {order}");
    }
}

/// The first two limit points of Lee's frame (legs of length 120), with so many elements a leg.
fn lee_frame(count: usize, section: &Value) -> [(f64, [f64; 2]); 2] {
    let at = |k: usize| 120.0 * k as f64 / count as f64;
    let places: Vec<[f64; 2]> = (0..=count).map(|k| [0.0, at(k)]).chain((1..=count).map(|k| [at(k), 120.0])).collect();
    let (nodes, elements) = chain(&places, 2, section);
    let (loaded, far) = (format!("n{}", count + count / 5), format!("n{}", 2 * count));
    let request = typed(json!({
        "model": {
            "dimension": 2, "nodes": nodes, "elements": elements, "supports": {"n0": ["x", "y"], &far: ["x", "y"]},
            "stages": [{"name": "press", "forces": {&loaded: [0, -1]}, "until": {"limit_points": 2}}],
        },
        "analysis": {"max_increments": 2000},
    }));
    let traced = traced(&request);
    let limits: Vec<&Increment> =
        traced.increments.iter().filter(|increment| increment.point.kind == PointKind::SmoothLimit).collect();
    [0, 1].map(|k| {
        let u = &limits[k].displacements[&loaded];
        (limits[k].load_factor, [u[0], u[1]])
    })
}

#[test]
fn lee_frame_snaps_at_the_published_loads() {
    // E = 720, A = 6, I = 2, shear factor 1, ν = 0.3.
    let section = json!({"axial_stiffness": 4320.0, "bending_stiffness": 1440.0, "shear_stiffness": 4320.0 / 2.6});
    let limits = [5, 10].map(|count| lee_frame(count, &section)[0]);
    let (load, [x, y]) = limits[1];
    println!("sheared: {limits:?}");
    assert!((load - 1.8547).abs() < 1e-4 && (y + 48.75).abs() < 1e-2 && (x - 26.88).abs() < 1e-2, "{load} {x} {y}");
    // Extrapolated from 20 and 40 elements a leg.
    let errors = limits.map(|(load, _)| (load - 1.854_655_874).abs());
    assert!(errors[0] > 14.0 * errors[1], "{errors:?}");
    // Nearly inextensible and without shear: loads over EI/L², displacements over L.
    let section = json!({"axial_stiffness": 1440.0e3, "bending_stiffness": 1440.0});
    let exact = [(18.5587466, [0.224057, -0.406162]), (-9.4212875, [0.751766, -0.485004])];
    for ((load, u), (exact_load, exact_u)) in lee_frame(10, &section).into_iter().zip(exact) {
        let (load, u) = (load * 120.0 * 120.0 / 1440.0, u.map(|part| part / 120.0));
        println!("inextensible: {load} {u:?}");
        assert!((load - exact_load).abs() < 5e-3, "{load} {exact_load}");
        assert!(u.iter().zip(exact_u).all(|(found, exact)| (found - exact).abs() < 1e-3), "{u:?} {exact_u:?}");
    }
}

/// Half an arch of radius 1 and half opening angle 90° with `EI = 1`: the crown guided, the foot on a rough floor.
fn arch(count: usize, friction: f64, axial_stiffness: f64, until: &Value) -> JobRequest {
    let places: Vec<[f64; 2]> = (0..=2 * count)
        .map(|k| {
            let angle = FRAC_PI_2 * k as f64 / (2 * count) as f64;
            [angle.sin(), if k == 2 * count { 0.0 } else { angle.cos() }]
        })
        .collect();
    let (nodes, elements) = chain(&places, 3, &json!({"axial_stiffness": axial_stiffness, "bending_stiffness": 1.0}));
    let foot = format!("n{}", 2 * count);
    typed(json!({
        "model": {
            "dimension": 2, "nodes": nodes, "elements": elements, "supports": {"n0": ["x", "rz"]},
            "obstacles": {"floor": {"kind": "plane", "point": [0, 0], "normal": [0, 1]}},
            "contacts": [{"node": foot, "obstacle": "floor", "friction": friction}],
            // The half carries half the load.
            "stages": [{"name": "press", "forces": {"n0": [0, -0.5]}, "until": until}],
        },
        "analysis": {"max_increments": 2000},
    }))
}

#[test]
fn friction_decides_how_an_arch_on_a_rough_floor_becomes_critical() {
    for (friction, kind) in [(0.8, PointKind::NonsmoothLimit), (1.2, PointKind::SmoothLimit)] {
        let traced = traced(&arch(10, friction, 1e6, &json!({"limit_points": 1})));
        let critical = traced
            .increments
            .iter()
            .find(|one| matches!(one.point.kind, PointKind::NonsmoothLimit | PointKind::SmoothLimit))
            .expect("a limit point");
        assert_eq!(critical.point.kind, kind, "{friction}");
        let (load, drop) = (critical.load_factor, -critical.displacements["n0"][1]);
        println!("μ = {friction}: P = {load:.8}, d = {drop:.8}");
        let exact = if friction < 1.0 { [9.3605882420, 0.5003093224] } else { [10.15034386, 0.7318513] };
        assert!((load - exact[0]).abs() < 2e-3 && (drop - exact[1]).abs() < 2e-3, "{load} {drop}");
    }
    // Below the thrust ratio 2/π the foot slides from the first load.
    let traced = traced(&arch(10, 0.5, 1e6, &json!({"load_above": 0.01})));
    assert_eq!(last(&traced).contacts[0].status, Status::Slip);
}

#[test]
fn an_arch_that_slips_lets_load_and_drop_fall_together() {
    let errors = [5, 10].map(|count| {
        let traced = traced(&arch(count, 0.8, 1e5, &json!({"limit_points": 2})));
        let slips = traced.increments.iter().find(|one| one.point.kind == PointKind::NonsmoothLimit).expect("a slip");
        let directions = slips.directions.as_ref().expect("directions");
        let falling = |status: Status| {
            directions.iter().any(|one| !one.retrace && one.load_rate < 0.0 && one.contacts[0] == status)
        };
        assert!(falling(Status::Slip), "{directions:?}");
        let least = last(&traced);
        assert_eq!(least.point.kind, PointKind::SmoothLimit);
        let found =
            [slips.load_factor, -slips.displacements["n0"][1], least.load_factor, -least.displacements["n0"][1]];
        println!("{count}: {found:.9?}");
        // The onset with this EA; the others without extension.
        let exact = [9.359963735, 0.5003093224, 1.991708124, 0.818093982];
        std::array::from_fn::<f64, 4, _>(|k| (found[k] - exact[k]).abs())
    });
    for k in 0..4 {
        assert!(errors[1][k] < 2e-3, "{errors:?}");
    }
    assert!(errors[0][0] > 10.0 * errors[1][0], "{errors:?}");
}

/// A beam hinged at both ends is a bar; one hinged to a column carries no moment there.
#[test]
fn releases_make_hinges() {
    let request = |link: Value| {
        typed(json!({
            "model": {
                "dimension": 2,
                "nodes": {"clamp": [0, 0], "top": [0, 1], "far": [1, 1.2]},
                "supports": {"clamp": ["x", "y", "rz"], "far": ["x", "y"]},
                "elements": [
                    {"kind": "beam", "nodes": ["clamp", "top"], "axial_stiffness": 1e3, "bending_stiffness": 1.0},
                    link,
                ],
                "stages": [{"name": "push", "forces": {"top": [1, 0]}, "until": {"load_above": 1.0}}],
            },
            "analysis": {},
        }))
    };
    let bar = traced(&request(json!({"kind": "bar", "nodes": ["top", "far"], "axial_stiffness": 20.0})));
    let beam = traced(&request(json!({
        "kind": "beam", "nodes": ["top", "far"], "axial_stiffness": 20.0, "bending_stiffness": 0.5,
        "releases": {"top": ["rz"], "far": ["rz"]},
    })));
    let half = traced(&request(json!({
        "kind": "beam", "nodes": ["top", "far"], "axial_stiffness": 20.0, "bending_stiffness": 0.5,
        "releases": {"top": ["rz"]},
    })));
    for other in [&beam, &half] {
        for (one, other) in last(&bar).displacements["top"].iter().zip(&last(other).displacements["top"]) {
            assert!((one - other).abs() < 1e-9, "{one} {other}");
        }
    }
}

#[test]
fn rotational_springs_and_prescribed_rotations_act() {
    let request = typed(json!({
        "model": {
            "dimension": 2,
            "nodes": {"left": [0, 0], "right": [2, 0]},
            "supports": {"left": ["x", "y", "rz"], "right": ["y"]},
            "elements": [
                {"kind": "beam", "nodes": ["left", "right"], "axial_stiffness": 1e3, "bending_stiffness": 3.0},
                {"kind": "rotational_spring", "nodes": ["right"], "stiffness": 1.5},
            ],
            "stages": [{"name": "turn", "displacements": {"left": [0, 0, 1e-4]}, "until": {"load_above": 1.0}}],
        },
        "analysis": {},
    }));
    let traced = traced(&request);
    let end = last(&traced);
    // 4 EI/L θ_r + k θ_r + 2 EI/L θ_l = 0, for small rotations.
    let expected = -3.0 / (6.0 + 1.5) * 1e-4;
    assert!((end.displacements["right"][2] - expected).abs() < 1e-9, "{:?}", &end.displacements["right"]);
    assert!((end.displacements["left"][2] - 1e-4).abs() < 1e-16);
    let moment = end.elements[1].moment.expect("the moment of a rotational spring");
    assert!((moment - 1.5 * end.displacements["right"][2]).abs() < 1e-15);
    assert!((end.supports["left"][2] - (6.0e-4 + 3.0 * expected)).abs() < 1e-9, "{:?}", end.supports);
}

#[test]
fn mistakes_in_beams_are_told() {
    let refused = |change: fn(&mut Value)| {
        let mut value = json!({
            "model": {
                "dimension": 2,
                "nodes": {"a": [0, 0], "b": [1, 0], "c": [2, 0]},
                "supports": {"a": ["x", "y", "rz"]},
                "elements": [
                    {"kind": "beam", "nodes": ["a", "b"], "axial_stiffness": 1.0, "bending_stiffness": 1.0},
                    {"kind": "bar", "nodes": ["b", "c"], "axial_stiffness": 1.0},
                ],
                "stages": [{"name": "push", "forces": {"b": [1, 0]}}],
            },
            "analysis": {},
        });
        change(&mut value);
        match arcslip::model::decode::decode(value.to_string().as_bytes()) {
            Err(errors) => errors.to_string(),
            Ok(request) => arcslip::model::check::check(&request).expect_err("a mistake").to_string(),
        }
    };
    /// A change of the request, and what the answer has to say.
    type Case<'a> = (fn(&mut Value), &'a [&'a str]);
    let cases: [Case<'_>; 8] = [
        (|all| all["model"]["supports"]["c"] = json!(["y", "rz"]), &["model.supports.c[1]", "`c` has no rotation"]),
        (|all| all["model"]["stages"][0]["moments"] = json!({"c": 1}), &["stages[0].moments.c", "has no rotation"]),
        (
            |all| all["model"]["elements"][0]["releases"] = json!({"c": ["rz"]}),
            &["elements[0].releases.c", "is no end of this beam; `a` or `b` would do"],
        ),
        (|all| all["model"]["elements"][0]["releases"] = json!({"b": ["mz"]}), &["releases.b[0]", "`rz`"]),
        (|all| all["model"]["elements"][0]["releases"] = json!({"b": ["rz", "rz"]}), &["releases.b[1]", "`rz` once"]),
        (
            |all| all["model"]["stages"][0]["displacements"] = json!({"a": [0]}),
            &["displacements.a", "found 1 numbers; 2 are expected, or 3 with the rotations"],
        ),
        (|all| all["model"]["elements"][0]["bending_stiffness"] = json!(0), &["bending_stiffness", "above 0"]),
        (|all| all["model"]["elements"][0]["nodes"] = json!(["a", "c", "b"]), &["nodes", "turns back"]),
    ];
    for (change, parts) in cases {
        let told = refused(change);
        assert!(parts.iter().all(|part| told.contains(part)), "{told}");
    }
}

/// A clamped beam that is released at its clamp turns about it: the message names the beam and the place of its hinge.
#[test]
fn a_hinge_that_makes_a_mechanism_is_named() {
    let value = json!({"model": {
        "dimension": 2, "nodes": {"clamp": [0, 0], "tip": [0.5, 0]}, "supports": {"clamp": ["x", "y", "rz"]},
        "elements": [
            {"kind": "beam", "nodes": ["clamp", "tip"], "axial_stiffness": 1.0, "bending_stiffness": 1.0,
             "releases": {"clamp": ["rz"]}},
            {"kind": "rotational_spring", "nodes": ["clamp"], "stiffness": 1.0},
        ],
        "stages": [{"name": "push", "forces": {"tip": [0, 1]}}],
    }});
    let Err(mistakes) = Scene::new(&request(&value.to_string())) else { panic!("a mechanism is refused") };
    let told = mistakes.to_string();
    for part in ["model.elements[0]", "released at \"clamp\" can turn", "leave the release out"] {
        assert!(told.contains(part), "{told}");
    }
}
