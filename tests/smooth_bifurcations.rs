//! Smooth bifurcations: found where closed forms put them, and nowhere else.

mod common;

use arcslip::path::increment::{Increment, PointKind};
use common::paths::{request, trace};
use serde_json::{Map, Value, json};

/// Half width and height of the tall two-bar truss.
const HALF_WIDTH: f64 = 0.3;

fn bifurcations(increments: &[Increment]) -> Vec<&Increment> {
    increments.iter().filter(|i| i.point.kind == PointKind::SmoothBifurcation).collect()
}

fn tall_truss(imperfection: f64) -> Value {
    json!({"model": {
        "name": "tall truss", "dimension": 2,
        "nodes": {"left": [-HALF_WIDTH, 0], "apex": [imperfection, 1], "right": [HALF_WIDTH, 0]},
        "supports": {"left": ["x", "y"], "right": ["x", "y"]},
        "elements": [{"kind": "bar", "nodes": ["left", "apex"], "axial_stiffness": 1},
                     {"kind": "bar", "nodes": ["apex", "right"], "axial_stiffness": 1}],
        "stages": [{"name": "load", "forces": {"apex": [0, -1]},
                    "until": {"displacement": {"node": "apex", "component": "y", "below": -2.2}}}]
    }})
}

/// A tall tripod: feet at 120 degrees on a circle of radius 0.3, apex at height 1.
fn tripod(supports_of_apex: &[&str]) -> Value {
    let (mut nodes, mut supports) = (Map::new(), Map::new());
    nodes.insert("apex".into(), json!([0, 0, 1]));
    if !supports_of_apex.is_empty() {
        supports.insert("apex".into(), json!(supports_of_apex));
    }
    let mut elements = Vec::new();
    for k in 0..3 {
        let angle = f64::from(120 * k).to_radians();
        nodes.insert(format!("foot{k}"), json!([HALF_WIDTH * angle.cos(), HALF_WIDTH * angle.sin(), 0.0]));
        supports.insert(format!("foot{k}"), json!(["x", "y", "z"]));
        elements.push(json!({"kind": "bar", "nodes": [format!("foot{k}"), "apex"], "axial_stiffness": 1}));
    }
    json!({"model": {
        "name": "tripod", "dimension": 3, "nodes": nodes, "supports": supports, "elements": elements,
        "stages": [{"name": "load", "forces": {"apex": [0, 0, -1]}, "until": {"limit_points": 1}}]
    }})
}

/// The root of a cubic near a guess, by Newton's method.
fn root(value: impl Fn(f64) -> f64, slope: impl Fn(f64) -> f64, mut x: f64) -> f64 {
    for _ in 0..50 {
        x -= value(x) / slope(x);
    }
    x
}

fn largest_residual(increments: &[Increment]) -> f64 {
    increments.iter().fold(0.0, |largest, i| i.diagnostics.residual.max(largest))
}

/// `k_xx = 0` where `L³ - L0 L² + L0 b² = 0`, and then `s = 2 y (1/L - 1/L0)`: sideways buckling before the limit point,
/// again on the falling branch, and both mirrored below.
#[test]
fn a_pitchfork_in_closed_form() {
    let (increments, _) = trace(&request(&tall_truss(0.0).to_string()));
    let found = bifurcations(&increments);
    let rest = HALF_WIDTH.hypot(1.0);
    let critical = |guess: f64| {
        root(|l| l * l * l - rest * l * l + rest * HALF_WIDTH * HALF_WIDTH, |l| 3.0 * l * l - 2.0 * rest * l, guess)
    };
    let (first, second) = (critical(0.94), critical(0.37));
    assert_eq!(found.len(), 4);
    for (point, (length, side)) in found.iter().zip([(first, 1.0), (second, 1.0), (second, -1.0), (first, -1.0)]) {
        let height = side * (length * length - HALF_WIDTH * HALF_WIDTH).sqrt();
        let load = 2.0 * height * (1.0 / length - 1.0 / rest);
        assert!((point.load_factor - load).abs() < 1e-11, "{} {load}", point.load_factor);
        assert!((1.0 + point.displacements["apex"][1] - height).abs() < 1e-10);
        assert_eq!(point.point.event.as_deref(), Some("one eigenvalue crosses zero"));
        assert!(!point.point.degenerate);
        let directions = point.directions.as_ref().expect("directions");
        assert_eq!(directions.len(), 4);
        assert!(directions[0].taken && directions[1].retrace);
        // Branches of a pitchfork leave without a load rate, and both the same way.
        assert!(directions[2..].iter().all(|d| d.load_rate.abs() < 1e-9 && !d.taken && !d.retrace));
        assert!(point.point.bifurcation);
    }
    let limits = increments.iter().filter(|i| i.point.kind == PointKind::SmoothLimit).count();
    assert_eq!(limits, 2);
    assert!(increments.iter().all(|i| i.displacements["apex"][0].abs() < 1e-9), "the path stays upright");
    assert!(largest_residual(&increments) <= 1e-11);
}

/// An imperfect truss has no bifurcation to find.
#[test]
fn an_imperfection_unfolds_it() {
    let (increments, _) = trace(&request(&tall_truss(0.02).to_string()));
    assert!(bifurcations(&increments).is_empty());
    assert!(increments.iter().any(|i| i.displacements["apex"][0].abs() > 0.1));
}

/// In one of its mirror planes the tripod buckles at an asymmetric point: `2 L³ - 2 L0 L² + L0 b² = 0`. The
/// second branch crosses with a load rate.
#[test]
fn an_asymmetric_point_in_closed_form() {
    let (increments, _) = trace(&request(&tripod(&["y"]).to_string()));
    let found = bifurcations(&increments);
    let load = tripod_load();
    assert_eq!(found.len(), 1);
    assert!((found[0].load_factor - load).abs() < 1e-11, "{} {load}", found[0].load_factor);
    let directions = found[0].directions.as_ref().expect("directions");
    assert_eq!(directions.len(), 4);
    let (ahead, back) = (directions[2].load_rate, directions[3].load_rate);
    assert!(ahead.abs() > 1e-3 && (ahead + back).abs() < 1e-12, "{ahead} {back}");
    assert!(found[0].point.bifurcation);
}

/// Load of the tripod at which its apex moves sideways.
fn tripod_load() -> f64 {
    let rest = HALF_WIDTH.hypot(1.0);
    let length = root(
        |l| 2.0 * l * l * l - 2.0 * rest * l * l + rest * HALF_WIDTH * HALF_WIDTH,
        |l| 6.0 * l * l - 4.0 * rest * l,
        rest,
    );
    3.0 * (length * length - HALF_WIDTH * HALF_WIDTH).sqrt() * (1.0 / length - 1.0 / rest)
}

/// Free to move in both directions the tripod has a double point at the same load: three lines of branches, one in
/// each mirror plane.
#[test]
fn a_double_point_in_closed_form() {
    let (increments, _) = trace(&request(&tripod(&[]).to_string()));
    let found = bifurcations(&increments);
    assert_eq!(found.len(), 1);
    assert!((found[0].load_factor - tripod_load()).abs() < 1e-11);
    assert_eq!(found[0].point.event.as_deref(), Some("two eigenvalues cross zero together"));
    let directions = found[0].directions.as_ref().expect("directions");
    assert_eq!(directions.len(), 8);
    assert!(!found[0].point.degenerate);
    let size = directions[2].load_rate.abs();
    assert!(size > 1e-3);
    assert_eq!(directions[2..].iter().filter(|d| d.load_rate > 0.0).count(), 3);
    assert!(directions[2..].iter().all(|d| (d.load_rate.abs() - size).abs() < 1e-3 * size));
}

/// Existing scenes: no smooth bifurcation where there is none.
#[test]
fn built_in_scenes_have_none() {
    for built_in in arcslip::scenes::ALL {
        let (increments, _) = trace(&request(built_in.request));
        assert!(bifurcations(&increments).is_empty(), "{}", built_in.name);
    }
}

/// Beside a bar that slips with friction (an unsymmetric matrix) the tall truss buckles at the load at which it does
/// alone: the determinant tells it.
#[test]
fn beside_frictional_slip() {
    let mut model = tall_truss(0.0);
    let parts = &mut model["model"];
    parts["nodes"]["pin"] = json!([5, 1]);
    parts["nodes"]["tip"] = json!([3.5, 0]);
    parts["supports"]["pin"] = json!(["x", "y"]);
    let bars = parts["elements"].as_array_mut().expect("elements");
    bars.push(json!({"kind": "bar", "nodes": ["pin", "tip"], "axial_stiffness": 1}));
    parts["obstacles"] = json!({"floor": {"kind": "plane", "point": [0, 0], "normal": [0, 1]}});
    parts["contacts"] = json!([{"node": "tip", "obstacle": "floor", "friction": 0.3}]);
    parts["stages"] =
        json!([{"name": "load", "forces": {"apex": [0, -1], "tip": [1, 0]}, "until": {"load_above": 0.25}}]);
    let (increments, _) = trace(&request(&model.to_string()));
    let alone = trace(&request(&tall_truss(0.0).to_string())).0;
    let (found, alone) = (bifurcations(&increments), bifurcations(&alone)[0].load_factor);
    assert_eq!(found.len(), 1);
    assert!((found[0].load_factor - alone).abs() < 1e-11, "{} {alone}", found[0].load_factor);
    let directions = found[0].directions.as_ref().expect("directions");
    assert!(directions[0].taken && directions[0].dissipation_rate > 0.0);
    // Unloading with the tip stuck is missing: the stuck structure is as singular here. The odd number is told.
    assert_eq!(found[0].point.degenerate, directions.len() % 2 == 1);
    let branches = directions.iter().filter(|d| d.load_rate.abs() < 1e-9).count();
    assert_eq!(branches, 2, "{directions:?}");
}
