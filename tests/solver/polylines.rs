//! Obstacles along polylines: smooth curves through points, and polygons with rounded corners.

use crate::common::paths::{Traced, close, judged, place, scene, scene_file, trace, typed};
use arcslip::check::scenes::exact::bowl::bowl_load;
use arcslip::model::JobRequest;
use arcslip::model::request::Method;
use arcslip::result::increment::{Increment, PointKind, Status};
use arcslip::result::stop_reason::StopReason;
use arcslip::{Obstacle, Polyline, Side};
use serde_json::json;
use std::f64::consts::TAU;

const ROUNDING: f64 = 0.4;
const FRICTION: f64 = 0.3;
const STIFFNESS: [f64; 2] = [0.2, 0.1];
/// A hump between two stretches of a floor.
const CORNERS: [[f64; 2]; 6] = [[-4.0, 0.0], [-1.0, 0.0], [0.0, 1.0], [1.0, 1.0], [2.0, 0.0], [5.0, 0.0]];

/// Place and slope of the hump at a horizontal position, by the B-spline's basis functions and bisection.
fn hump(x: f64) -> ([f64; 2], f64) {
    for three in CORNERS.windows(3) {
        let unit = |from: [f64; 2], to: [f64; 2]| {
            let size = (to[0] - from[0]).hypot(to[1] - from[1]);
            [(to[0] - from[0]) / size, (to[1] - from[1]) / size]
        };
        let (before, behind) = (unit(three[0], three[1]), unit(three[1], three[2]));
        let at = |steps: f64, way: [f64; 2]| [0, 1].map(|k| three[1][k] + steps * ROUNDING * way[k]);
        let control = [at(-2.0, before), at(-1.0, before), three[1], at(1.0, behind), at(2.0, behind)];
        for four in control.windows(4) {
            let spline = |k: usize, t: f64| {
                let basis = [(1.0 - t).powi(3), 3.0 * t.powi(3) - 6.0 * t * t + 4.0, 0.0, t.powi(3)];
                let third = 6.0 - basis.iter().sum::<f64>();
                (0..4).map(|i| four[i][k] * if i == 2 { third } else { basis[i] }).sum::<f64>() / 6.0
            };
            if x < spline(0, 0.0) || x > spline(0, 1.0) {
                continue;
            }
            let (mut low, mut high) = (0.0, 1.0);
            for _ in 0..60 {
                let middle = 0.5 * (low + high);
                if spline(0, middle) < x { low = middle } else { high = middle }
            }
            let slope = |k: usize| {
                let t = low;
                let basis = [-3.0 * (1.0 - t).powi(2), 9.0 * t * t - 12.0 * t, 0.0, 3.0 * t * t];
                let third = -basis.iter().sum::<f64>();
                (0..4).map(|i| four[i][k] * if i == 2 { third } else { basis[i] }).sum::<f64>()
            };
            return ([x, spline(1, low)], slope(1) / slope(0));
        }
    }
    let edge = CORNERS.windows(2).find(|edge| x <= edge[1][0]).expect("an edge");
    let slope = (edge[1][1] - edge[0][1]) / (edge[1][0] - edge[0][0]);
    ([x, edge[0][1] + slope * (x - edge[0][0])], slope)
}

/// A node on springs, pressed with the force 1 onto the floor at (-1.8, 0), and pushed over the hump.
fn over_the_hump(method: Method) -> JobRequest {
    let points = CORNERS.map(|corner| corner.to_vec()).to_vec();
    let mut request = typed(json!({
        "model": {
            "name": "node over a hump", "dimension": 2, "nodes": {"node": [-1.8, 0]},
            "elements": [{"kind": "spring", "nodes": ["node"],
                "stiffness": [[STIFFNESS[0], 0], [0, STIFFNESS[1]]]}],
            "obstacles": {"hump": {"kind": "polyline", "points": points, "rounding": ROUNDING}},
            "contacts": [{"node": "node", "obstacle": "hump", "friction": FRICTION}],
            "stages": [
                {"name": "press", "forces": {"node": [0, -1]}, "until": {"load_above": 1}},
                {"name": "push", "forces": {"node": [1, 0]},
                    "until": {"displacement": {"node": "node", "component": "x", "above": 4.5}}}
            ]
        },
        "analysis": {"arc_length": {"initial": 0.02, "min": 1e-9, "max": 0.1, "displacement_scale": 1}}
    }));
    request.analysis.method = method;
    request
}

/// `s = k_x u + (1 + k_y v) tan(φ + arctan μ)` with the slope `φ` of the hump.
fn load(x: f64) -> f64 {
    let ([_, y], slope) = hump(x);
    STIFFNESS[0] * (x + 1.8) + (1.0 + STIFFNESS[1] * y) * (slope.atan() + FRICTION.atan()).tan()
}

#[test]
fn a_node_slides_over_rounded_corners() {
    for method in [Method::Auto, Method::Mpec] {
        let request = over_the_hump(method);
        let (increments, report) = trace(&request);
        assert_eq!(report.stop_reason, StopReason::StagesCompleted);
        let pushed: Vec<_> = increments.iter().filter(|increment| &*increment.stage == "push").collect();
        assert!(pushed.len() > 40);
        for increment in &pushed {
            let at = place(&request, increment, "node");
            let what = format!("{method:?}, increment {}, x = {}", increment.index, at[0]);
            close(at[1], hump(at[0]).0[1], 1e-12, &what);
            if increment.load_factor > FRICTION * (1.0 + 1e-9) {
                close(increment.load_factor, load(at[0]), 1e-10, &what);
                assert_eq!(increment.contacts[0].status, Status::Slip, "{what}");
            }
        }
        // The load falls around both upper corners and rises between them: every turn of the load is located.
        let limits = pushed.iter().filter(|increment| increment.point.kind == PointKind::SmoothLimit);
        let limits: Vec<f64> = limits.map(|limit| place(&request, limit, "node")[0]).collect();
        let slope = |x: f64| (load(x + 1e-6) - load(x - 1e-6)) / 2e-6;
        let scanned: Vec<f64> = (0..6000).map(|step| -1.79 + 0.001 * f64::from(step)).collect();
        let turns = scanned.windows(2).filter(|x| slope(x[0]) * slope(x[1]) < 0.0);
        let turns: Vec<f64> = turns.map(|x| 0.5 * (x[0] + x[1])).collect();
        assert_eq!(limits.len(), turns.len(), "{method:?}: {limits:?} {turns:?}");
        for (limit, turn) in limits.iter().zip(turns) {
            close(*limit, turn, 1e-3, "place of the limit");
            close(slope(*limit), 0.0, 1e-5, "slope of the load at the limit");
        }
    }
}

/// The same across a hump that lies askew in space: the node stays in the plane of its points.
#[test]
fn a_node_slides_over_rounded_corners_in_space() {
    // Along the floor, up, and across; the origin of the points.
    let axes = [[0.0, 1.0, 0.0], [0.6, 0.0, 0.8], [0.8, 0.0, -0.6]];
    let origin = [0.3, -0.2, 0.7];
    let lifted = |x: f64, y: f64| -> [f64; 3] { std::array::from_fn(|k| x * axes[0][k] + y * axes[1][k]) };
    let placed = |x: f64, y: f64| -> [f64; 3] { std::array::from_fn(|k| origin[k] + lifted(x, y)[k]) };
    let across = 0.15;
    let entry = |i: usize, j: usize| {
        (0..3)
            .map(|axis| [STIFFNESS[0], STIFFNESS[1], across][axis] * axes[axis][i.min(j)] * axes[axis][i.max(j)])
            .sum()
    };
    let stiffness: Vec<Vec<f64>> = (0..3).map(|i| (0..3).map(|j| entry(i, j)).collect()).collect();
    let points = CORNERS.map(|corner| corner.to_vec());
    // Only the part of `y` across `x` counts, and no length.
    let section = json!({"origin": origin, "x": lifted(2.0, 0.0), "y": lifted(1.5, 3.0)});
    for method in [Method::Auto, Method::Mpec] {
        let mut request = typed(json!({
            "model": {
                "name": "node over a hump in space", "dimension": 3, "nodes": {"node": placed(-1.8, 0.0)},
                "elements": [{"kind": "spring", "nodes": ["node"], "stiffness": stiffness}],
                "obstacles": {"hump": {"kind": "polyline", "points": points, "rounding": ROUNDING, "section": section}},
                "contacts": [{"node": "node", "obstacle": "hump", "friction": FRICTION}],
                "stages": [
                    {"name": "press", "forces": {"node": lifted(0.0, -1.0)}, "until": {"load_above": 1}},
                    {"name": "push", "forces": {"node": lifted(1.0, 0.0)},
                        "until": {"displacement": {"node": "node", "component": "y", "above": 4.5}}}
                ]
            },
            "analysis": {"arc_length": {"initial": 0.02, "min": 1e-9, "max": 0.1, "displacement_scale": 1}}
        }));
        request.analysis.method = method;
        let traced = judged(&request);
        assert_eq!(traced.report.stop_reason, StopReason::StagesCompleted);
        for (increment, errors) in traced.increments.iter().zip(&traced.errors).filter(|(i, _)| &*i.stage == "push") {
            let at = place(&request, increment, "node");
            let local =
                axes.map(|axis| axis.iter().zip(&at).zip(origin).map(|((a, x), from)| a * (x - from)).sum::<f64>());
            let what = format!("{method:?}, increment {}, x = {}", increment.index, local[0]);
            close(local[1], hump(local[0]).0[1], 1e-11, &what);
            close(local[2], 0.0, 1e-10, &what);
            if increment.load_factor > FRICTION * (1.0 + 1e-9) {
                close(increment.load_factor, load(local[0]), 1e-9, &what);
            }
            assert!(errors.largest_of_state() < 1e-10 && errors.energy < 1e-6, "{what}: {errors:?}");
        }
        let limits = traced.increments.iter().filter(|increment| increment.point.kind == PointKind::SmoothLimit);
        assert_eq!(limits.count(), 4, "{method:?}");
    }
}

fn straight(request: &JobRequest) -> JobRequest {
    let mut request = request.clone();
    for obstacle in request.model.obstacles.values_mut() {
        if let Obstacle::Plane { point, normal } = obstacle {
            let along = [normal[1], -normal[0]];
            let points = [-1.0, 0.5, 2.0].map(|s| [point[0] + s * along[0], point[1] + s * along[1]]);
            *obstacle = Obstacle::polyline(points);
        }
    }
    request
}

#[test]
fn points_on_a_line_are_a_plane() {
    for name in ["arch-type-truss", "klarbring", "rising-floor"] {
        let request = scene(name);
        let (plane, curve) = (trace(&request), trace(&straight(&request)));
        assert_eq!(plane.1.stop_reason, curve.1.stop_reason, "{name}");
        let events = |increments: &[Increment]| {
            let events = increments.iter().filter(|increment| increment.point.kind != PointKind::Regular);
            events.map(|increment| (increment.point.kind, increment.load_factor)).collect::<Vec<_>>()
        };
        let (plane, curve) = (events(&plane.0), events(&curve.0));
        assert_eq!(plane.len(), curve.len(), "{name}: {plane:?} {curve:?}");
        for (a, b) in plane.iter().zip(&curve) {
            assert_eq!(a.0, b.0, "{name}");
            close(a.1, b.1, 1e-9, name);
        }
    }
}

/// A bowl through points on a circle: its load converges to that of the round bowl with the third order, that of the
/// spline's slope.
#[test]
fn a_spline_through_a_circle_is_round() {
    let error = |count: usize| {
        let mut request = scene_file("bowl");
        let point = |k: usize| (TAU * k as f64 / count as f64).sin_cos();
        let points = (0..count).map(point).map(|(sine, cosine)| vec![sine, 1.0 - cosine]).collect();
        let bowl = Polyline { points, ..Polyline::default() }.closed(Side::Inside);
        request.model.obstacles["bowl"] = Obstacle::Polyline(bowl);
        let (increments, report) = trace(&request);
        assert_eq!(report.stop_reason, StopReason::StagesCompleted, "{count} points");
        let friction = request.model.contacts[0].friction;
        let slides = |increment: &&Increment| &*increment.stage == "push" && increment.load_factor > friction + 1e-3;
        let errors = increments.iter().filter(slides).map(|increment| {
            let at = place(&request, increment, "node");
            (increment.load_factor / bowl_load(0.1, friction, at[0].atan2(1.0 - at[1])) - 1.0).abs()
        });
        errors.fold(0.0, f64::max)
    };
    let errors = [16, 32, 64].map(error);
    println!("errors of the load with 16, 32, 64 points: {errors:?}");
    assert!(errors[1] < errors[0] / 7.0 && errors[2] < errors[1] / 7.0 && errors[2] < 1e-4, "{errors:?}");
}

#[test]
fn what_is_no_curve_is_refused() {
    let refused = |polyline: serde_json::Value, dimension: usize, member: &str, why: &str| {
        let node: Vec<f64> = vec![0.5; dimension];
        let request = json!({"model": {"dimension": dimension, "nodes": {"node": node}, "elements": [],
            "obstacles": {"wall": polyline}, "contacts": [{"node": "node", "obstacle": "wall"}],
            "stages": [{"name": "push", "forces": {"node": vec![1.0; dimension]}}]}});
        let request = arcslip::model::decode::decode(request.to_string().as_bytes()).expect("well formed");
        let errors = arcslip::model::check::check(&request).expect_err("refused").to_string();
        let found = errors.lines().any(|line| line.contains(&format!("obstacles.wall.{member}")) && line.contains(why));
        assert!(found, "{member} {why}: {errors}");
    };
    let of = |points: serde_json::Value| json!({"kind": "polyline", "points": points});
    refused(of(json!([[0, 0]])), 2, "points", "2 or more");
    refused(of(json!([[0, 0], [0, 0]])), 2, "points[1]", "coincides");
    refused(of(json!([[0, 0], [1, 0], [0, 0.001]])), 2, "points[1]", "turns back");
    refused(of(json!([[0, 0], [1, 0, 2]])), 2, "points[1]", "2 are expected");
    let with = |member: &str, value: serde_json::Value| {
        let mut polyline = of(json!([[0, 0], [1, 0], [1, 1], [0, 1]]));
        polyline[member] = value;
        polyline
    };
    refused(with("side", json!("inside")), 2, "side", "left of its direction");
    let section = |x: [f64; 3], y: [f64; 3]| with("section", json!({"origin": [0, 0, 0], "x": x, "y": y}));
    let upright = section([1.0, 0.0, 0.0], [0.0, 0.0, 1.0]);
    refused(upright, 2, "section", "leave it out");
    refused(section([0.0; 3], [0.0, 0.0, 1.0]), 3, "section.x", "the direction is zero");
    refused(section([1.0, 0.0, 0.0], [-2.0, 0.0, 0.0]), 3, "section.y", "along `x`");
    let short = with("section", json!({"origin": [0, 0], "x": [1, 0, 0], "y": [0, 1, 0]}));
    refused(short, 3, "section.origin", "3 are expected");
    refused(with("rounding", json!(0.6)), 2, "rounding", "at most 0.5");
    refused(with("rounding", json!(0)), 2, "rounding", "above 0");
    let mut eight = of(json!([[0, 0], [1, 1], [1, 0], [0, 1]]));
    (eight["closed"], eight["rounding"]) = (json!(true), json!(0.01));
    refused(eight, 2, "points", "crosses itself near");
    let many: Vec<[f64; 2]> = (0..2001).map(|k| [f64::from(k), 0.0]).collect();
    refused(of(json!(many)), 2, "points", "at most 2000");
}

/// A node without friction, guided or not, is driven up a step under a force that presses it down: far more energy passes
/// from the drive to the force than the spring holds at first, and steps do not shrink for it.
#[test]
fn a_guided_node_is_driven_up_a_step() {
    let request = typed(json!({"model": {
        "name": "cam", "dimension": 2, "nodes": {"node": [0.5, 0]}, "supports": {"node": ["x"]},
        "elements": [{"kind": "spring", "nodes": ["node"], "stiffness": [[0, 0], [0, 1]]}],
        "obstacles": {"step": {"kind": "polyline", "points": [[-5, 0], [1, 0], [2, 1], [3, 1]], "rounding": 0.4}},
        "contacts": [{"node": "node", "obstacle": "step"}],
        "stages": [
            {"name": "press", "forces": {"node": [0, -1]}, "until": {"load_above": 1}},
            {"name": "drive", "displacements": {"node": [1, 0]}, "until": {"load_above": 2}}
        ]
    }}));
    // The energy balance is relative to the energy stored, of which there is next to none at first.
    let Traced { increments, errors, report, .. } = judged(&request);
    assert_eq!(report.stop_reason, StopReason::StagesCompleted);
    assert!(increments.len() < 300, "{}", increments.len());
    errors.iter().for_each(|errors| assert!(errors.largest_of_state() <= 1e-10, "{errors:?}"));
    assert!(errors.last().expect("an end").energy <= 1e-6);
    close(increments.last().expect("an end").displacements["node"][1], 1.0, 1e-12, "height of the step");
}

/// A body thinner than a step's motion is not passed through, whether a polyline or a ball.
#[test]
fn a_node_does_not_jump_through_a_thin_obstacle() {
    let bar =
        json!({"kind": "polyline", "points": [[-3, 0], [3, 0], [3, -1], [-3, -1]], "rounding": 0.2, "closed": true});
    let ball = json!({"kind": "ball", "center": [0, -0.5], "radius": 0.5});
    for obstacle in [bar, ball] {
        let request = typed(json!({"model": {
            "name": "thin obstacle", "dimension": 2, "nodes": {"node": [0, 5]},
            "elements": [{"kind": "spring", "nodes": ["node"], "stiffness": [[1, 0], [0, 1]]}],
            "obstacles": {"thin": obstacle}, "contacts": [{"node": "node", "obstacle": "thin"}],
            "stages": [{"name": "press", "forces": {"node": [0, -1]}, "until": {"load_above": 20}}]
        }}));
        let (increments, report) = trace(&request);
        assert_eq!(report.stop_reason, StopReason::StagesCompleted);
        let touch = increments.iter().find(|increment| increment.point.kind == PointKind::ContactChange);
        close(touch.expect("a touch").load_factor, 5.0, 1e-10, "load of the touch");
        close(increments.last().expect("an end").contacts[0].normal_reaction, 15.0, 1e-10, "reaction at the end");
    }
}

/// Corners that take up whole edges, in a scale of length that does not divide them: what the check accepts, the solver has.
#[test]
fn rounding_may_take_up_the_edges() {
    for height in [0.3, 0.7, 1.1, 1.3] {
        let request = typed(json!({"model": {
            "name": "round block", "dimension": 2, "nodes": {"node": [0.5, 1.0 + height], "pin": [3.7, 1.9]},
            "supports": {"pin": ["x", "y"]},
            "elements": [{"kind": "spring", "nodes": ["node"], "stiffness": [[1, 0], [0, 1]]},
                {"kind": "bar", "nodes": ["pin", "node"], "axial_stiffness": 0.1}],
            "obstacles": {"block": {"kind": "polyline", "points": [[0, 0], [1, 0], [1, 1], [0, 1]], "closed": true,
                "rounding": 0.5}},
            "contacts": [{"node": "node", "obstacle": "block", "friction": 0.3}],
            "stages": [{"name": "press", "forces": {"node": [0, -1]}, "until": {"load_above": 3}}]
        }}));
        let (_, report) = trace(&request);
        assert_eq!(report.stop_reason, StopReason::StagesCompleted, "{height}");
    }
}
