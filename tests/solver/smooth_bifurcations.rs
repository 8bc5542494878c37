//! Smooth bifurcations: found where closed forms put them, and nowhere else.

use crate::common::paths::{request, trace};
use arcslip::continuation::path::iterator::Path;
use arcslip::continuation::scene::Scene;
use arcslip::resources::cancel::CancelFlag;
use arcslip::result::increment::{Increment, PointKind, Status};
use serde_json::{Map, Value, json};

/// Half width and height of the tall two-bar truss.
const HALF_WIDTH: f64 = 0.3;

/// Nodes that stand beside a model: none, and so many that matrices are sparse.
const BESIDE: [usize; 2] = [0, 12];

/// A model with so many nodes beside it, on springs and tied to each other, which nothing loads.
fn beside(mut model: Value, nodes: usize) -> Value {
    let parts = &mut model["model"];
    let dimension = parts["dimension"].as_u64().expect("a dimension") as usize;
    let name = |number: usize| format!("beside{number}");
    for number in 0..nodes {
        let place = [0.05 * number as f64, 0.3, 0.1 * (number % 2) as f64];
        parts["nodes"][name(number)] = json!(place[..dimension]);
        let stiffness: Vec<Vec<f64>> = (0..dimension)
            .map(|row| (0..dimension).map(|column| f64::from(u8::from(row == column))).collect())
            .collect();
        let elements = parts["elements"].as_array_mut().expect("elements");
        elements.push(json!({"kind": "spring", "nodes": [name(number)], "stiffness": stiffness}));
        if let Some(before) = number.checked_sub(1) {
            elements.push(json!({"kind": "bar", "nodes": [name(before), name(number)], "axial_stiffness": 1}));
        }
    }
    model
}

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
    for nodes in BESIDE {
        let (increments, _) = trace(&request(&beside(tall_truss(0.0), nodes).to_string()));
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
}

/// An imperfect truss has no bifurcation to find.
#[test]
fn an_imperfection_unfolds_it() {
    for nodes in BESIDE {
        let (increments, _) = trace(&request(&beside(tall_truss(0.02), nodes).to_string()));
        assert!(bifurcations(&increments).is_empty());
        assert!(increments.iter().any(|i| i.displacements["apex"][0].abs() > 0.1));
    }
}

/// In one of its mirror planes the tripod buckles at an asymmetric point: `2 L³ - 2 L0 L² + L0 b² = 0`. The
/// second branch crosses with a load rate.
#[test]
fn an_asymmetric_point_in_closed_form() {
    for nodes in BESIDE {
        let (increments, _) = trace(&request(&beside(tripod(&["y"]), nodes).to_string()));
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
    for nodes in BESIDE {
        let (increments, _) = trace(&request(&beside(tripod(&[]), nodes).to_string()));
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
}

/// Existing scenes: no smooth bifurcation where there is none.
#[test]
fn built_in_scenes_have_none() {
    for built_in in arcslip::check::scenes::ALL {
        let (increments, _) = trace(&request(built_in.request));
        assert!(bifurcations(&increments).is_empty(), "{}", built_in.name);
    }
}

/// Beside a bar that slips with friction (an unsymmetric matrix) the tall truss buckles at the load at which it does
/// alone: the determinant tells it.
#[test]
fn beside_frictional_slip() {
    for nodes in BESIDE {
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
        let (increments, _) = trace(&request(&beside(model.clone(), nodes).to_string()));
        let alone = trace(&request(&beside(tall_truss(0.0), nodes).to_string())).0;
        let (found, alone) = (bifurcations(&increments), bifurcations(&alone)[0].load_factor);
        assert_eq!(found.len(), 1);
        assert!((found[0].load_factor - alone).abs() < 1e-11, "{} {alone}", found[0].load_factor);
        let directions = found[0].directions.as_ref().expect("directions");
        assert!(directions[0].taken && directions[0].dissipation_rate > 0.0);
        // The load falls along the bent branches, at second order, and the tip sticks; it does where the path unloads.
        assert!(!found[0].point.degenerate);
        assert_eq!(directions.len(), 4, "{directions:?}");
        assert!(directions[1..].iter().all(|d| d.contacts == [Status::Stick]), "{directions:?}");
        assert_eq!(directions.iter().filter(|d| d.load_rate.abs() < 1e-9).count(), 2);
        assert_eq!(directions.iter().filter(|d| d.load_rate < -1e-3).count(), 1);
    }
}

/// Two bars of EA = 10 on top of each other, held sideways in the middle by `k`, under a load. Straight up to
/// `s = k l/2` with `l = 1 - s/10`; bent, both bars keep `l = 1/(1 + k/20)` and `s = k/2 √(l² - x²)`.
const COLUMN: f64 = 0.2;

fn column_load(k: f64) -> f64 {
    k / (2.0 + k / 10.0)
}

/// In space, held with `k` along x and `k (1 + difference)` along y.
fn column_in_space(difference: f64) -> Value {
    json!({"model": {
        "name": "column", "dimension": 3, "nodes": {"base": [0, 0, 0], "mid": [0, 0, 1], "top": [0, 0, 2]},
        "supports": {"base": ["x", "y", "z"], "top": ["x", "y"]},
        "elements": [
            {"kind": "bar", "nodes": ["base", "mid"], "axial_stiffness": 10},
            {"kind": "bar", "nodes": ["mid", "top"], "axial_stiffness": 10},
            {"kind": "spring", "nodes": ["mid"],
             "stiffness": [[COLUMN, 0, 0], [0, COLUMN * (1.0 + difference), 0], [0, 0, 0]]}],
        "stages": [{"name": "press", "forces": {"top": [0, 0, -1]}, "until": {"load_above": 0.5}}]
    }})
}

/// A column, and a block on a floor with μ = 0.3 pressed and pulled by the same load.
fn column_beside_a_block() -> Value {
    json!({"model": {
        "name": "column and block", "dimension": 2,
        "nodes": {"base": [0, 0], "mid": [0, 1], "top": [0, 2], "block": [5, 0]},
        "supports": {"base": ["x", "y"], "top": ["x"]},
        "elements": [
            {"kind": "bar", "nodes": ["base", "mid"], "axial_stiffness": 10},
            {"kind": "bar", "nodes": ["mid", "top"], "axial_stiffness": 10},
            {"kind": "spring", "nodes": ["mid"], "stiffness": [[COLUMN, 0], [0, 0]]},
            {"kind": "spring", "nodes": ["block"], "stiffness": [[1, 0], [0, 1]]}],
        "obstacles": {"floor": {"kind": "plane", "point": [0, 0], "normal": [0, 1]}},
        "contacts": [{"node": "block", "obstacle": "floor", "friction": 0.3}],
        "stages": [{"name": "press", "forces": {"top": [0, -1], "block": [1, -1]}, "until": {"load_above": 3}}]},
        "analysis": {"arc_length": {"initial": 0.02, "max": 0.1}, "max_increments": 60}
    })
}

/// Straight the block slips to `0.7 s`. Bent the load falls, so that the block stays where it is until
/// `0.7 s_c - s = 0.3 s`; then it slides back.
#[test]
fn branches_beside_a_block_that_slips() {
    for nodes in BESIDE {
        let request = request(&beside(column_beside_a_block(), nodes).to_string());
        let scene = Scene::new(&request).expect("a scene");
        let (load, length) = (column_load(COLUMN), 1.0 / (1.0 + COLUMN / 20.0));
        let mut path = Path::new(&scene, CancelFlag::default());
        let point = path.by_ref().find(|i| i.point.kind == PointKind::SmoothBifurcation).expect("a bifurcation");
        assert!((point.load_factor - load).abs() < 1e-12);
        let directions = point.directions.as_ref().expect("directions");
        assert_eq!(directions.len(), 4, "{directions:?}");
        assert!(!point.point.degenerate && point.point.bifurcation);
        let checkpoint = path.checkpoint();
        let mut sides = Vec::new();
        for (number, direction) in directions.iter().enumerate() {
            let followed = Path::follow(&scene, checkpoint.clone(), number, "followed".into(), CancelFlag::default());
            let increments: Vec<Increment> = followed.expect("a path").take_while(|i| i.load_factor > 0.0).collect();
            assert!(increments.len() > 1, "{number}");
            let bent = direction.load_rate.abs() < 1e-9;
            for increment in &increments {
                let x = increment.displacements["mid"][0];
                let straight = load.min(increment.load_factor);
                if bent {
                    let exact = 0.5 * COLUMN * (length * length - x * x).sqrt();
                    assert!((increment.load_factor - exact).abs() < 1e-11, "{x}: {} {exact}", increment.load_factor);
                } else {
                    assert!(x.abs() < 1e-9, "{x}");
                }
                let block =
                    if direction.taken { 0.7 * increment.load_factor } else { (0.7 * load).min(1.3 * straight) };
                assert!((increment.displacements["block"][0] - block).abs() < 1e-11);
            }
            let x = increments.last().expect("an end").displacements["mid"][0];
            sides.push(if x.abs() > 1e-3 { x.signum() } else { 0.0 });
        }
        assert_eq!(sides[0], 0.0);
        sides.sort_by(f64::total_cmp);
        assert_eq!(sides, [-1.0, 0.0, 0.0, 1.0]);
    }
}

/// Two points close together: each is found where its own stiffness puts it, each with a branch in its own plane.
#[test]
fn two_points_close_together() {
    for nodes in BESIDE {
        for difference in [1e-2, 1e-4, 1e-5, 1e-6, 1e-7] {
            let request = request(&beside(column_in_space(difference), nodes).to_string());
            let scene = Scene::new(&request).expect("a scene");
            let mut path = Path::new(&scene, CancelFlag::default());
            for (component, k) in [COLUMN, COLUMN * (1.0 + difference)].into_iter().enumerate() {
                let point =
                    path.by_ref().find(|i| i.point.kind == PointKind::SmoothBifurcation).expect("a bifurcation");
                assert!((point.load_factor - column_load(k)).abs() < 1e-13, "{difference}: {}", point.load_factor);
                assert_eq!(point.point.event.as_deref(), Some("one eigenvalue crosses zero"));
                let directions = point.directions.as_ref().expect("directions");
                assert_eq!((directions.len(), point.point.degenerate), (4, false));
                let branch = directions.iter().position(|d| d.load_rate.abs() < 1e-9).expect("a branch");
                let followed =
                    Path::follow(&scene, path.checkpoint(), branch, "followed".into(), CancelFlag::default());
                let last = followed.expect("a path").take(6).last().expect("an increment");
                let mid = &last.displacements["mid"];
                assert!(mid[component].abs() > 0.01, "{difference}: {mid:?}");
                assert!(mid[1 - component].abs() < 1e-4 * mid[component].abs(), "{difference}: {mid:?}");
            }
            assert!(path.all(|i| i.point.kind != PointKind::SmoothBifurcation), "{difference}");
        }
    }
}

/// Held alike in all directions, to round-off or nearly so, the column may bend in any: one point, and it says that its list
/// holds samples only.
#[test]
fn a_circle_of_branches_is_degenerate() {
    for nodes in BESIDE {
        for difference in [0.0, 1e-10, 1e-9] {
            let (increments, _) = trace(&request(&beside(column_in_space(difference), nodes).to_string()));
            let found = bifurcations(&increments);
            assert_eq!(found.len(), 1, "{difference}");
            assert!((found[0].load_factor - column_load(COLUMN)).abs() < 1e-13, "{}", found[0].load_factor);
            assert_eq!(found[0].point.event.as_deref(), Some("two eigenvalues cross zero together"));
            assert!(found[0].point.degenerate, "{difference}");
        }
    }
}

/// A wall that the column's middle touches without force changes nothing on the straight way, but only one side is
/// left to bend to.
#[test]
fn a_wall_that_is_touched_without_force() {
    for nodes in BESIDE {
        for side in [1.0, -1.0] {
            for friction in [0.0, 0.4] {
                let mut model = column_beside_a_block();
                let parts = &mut model["model"];
                parts["nodes"].as_object_mut().expect("nodes").shift_remove("block");
                parts["elements"].as_array_mut().expect("elements").pop();
                parts["obstacles"] = json!({"wall": {"kind": "plane", "point": [0, 0], "normal": [side, 0]}});
                parts["contacts"] = json!([{"node": "mid", "obstacle": "wall", "friction": friction}]);
                parts["stages"] = json!([{"name": "press", "forces": {"top": [0, -1]}, "until": {"load_above": 0.3}}]);
                let (increments, _) = trace(&request(&beside(model.clone(), nodes).to_string()));
                assert!(increments.iter().all(|i| i.displacements["mid"][0].abs() < 1e-12));
                let found = bifurcations(&increments);
                assert_eq!(found.len(), 1, "{side}, {friction}");
                assert!((found[0].load_factor - column_load(COLUMN)).abs() < 1e-12);
                let directions = found[0].directions.as_ref().expect("directions");
                let branches: Vec<_> = directions.iter().filter(|d| d.load_rate.abs() < 1e-9).collect();
                assert_eq!(branches.len(), 1, "{directions:?}");
                assert_eq!(branches[0].contacts, [Status::Free]);
                let number = directions.iter().position(|d| d.load_rate.abs() < 1e-9).expect("a branch");
                let request = request(&beside(model.clone(), nodes).to_string());
                let scene = Scene::new(&request).expect("a scene");
                let mut path = Path::new(&scene, CancelFlag::default());
                path.by_ref().find(|i| i.point.kind == PointKind::SmoothBifurcation).expect("a bifurcation");
                let followed =
                    Path::follow(&scene, path.checkpoint(), number, "followed".into(), CancelFlag::default());
                let last = followed.expect("a path").take(6).last().expect("an increment");
                let (x, length) = (last.displacements["mid"][0], 1.0 / (1.0 + COLUMN / 20.0));
                assert!(x * side > 0.01);
                let exact = 0.5 * COLUMN * (length * length - x * x).sqrt();
                assert!((last.load_factor - exact).abs() < 1e-11);
            }
        }
    }
}

/// Beside a block in space that slips along a direction of its own, the column buckles where it does alone.
#[test]
fn beside_slip_in_space() {
    for nodes in [BESIDE[0]] {
        let mut model = column_in_space(0.1);
        let parts = &mut model["model"];
        parts["nodes"]["block"] = json!([5, 0, 0]);
        parts["elements"]
            .as_array_mut()
            .expect("elements")
            .push(json!({"kind": "spring", "nodes": ["block"], "stiffness": [[1, 0, 0], [0, 2, 0], [0, 0, 1]]}));
        parts["obstacles"] = json!({"floor": {"kind": "plane", "point": [0, 0, 0], "normal": [0, 0, 1]}});
        parts["contacts"] = json!([{"node": "block", "obstacle": "floor", "friction": 0.3}]);
        parts["stages"][0]["forces"]["block"] = json!([1, 0.5, -1]);
        let (increments, _) = trace(&request(&beside(model.clone(), nodes).to_string()));
        let found = bifurcations(&increments);
        assert_eq!(found.len(), 2);
        for (point, k) in found.iter().zip([COLUMN, 1.1 * COLUMN]) {
            assert!((point.load_factor - column_load(k)).abs() < 1e-11, "{}", point.load_factor - column_load(k));
            let directions = point.directions.as_ref().expect("directions");
            assert_eq!(directions.len(), 4, "{directions:?}");
            assert!(directions[1..].iter().all(|d| d.contacts == [Status::Stick]), "{directions:?}");
        }
    }
}

/// A column of two bars held in the middle by springs of 0.1 and 0.2, and a wall that the middle touches without force.
/// It buckles off the wall at `s = k/(2 + k)` for the one and along it for the other, both within the reach of a step
/// from the first point.
#[test]
fn a_second_point_just_past_the_first() {
    for nodes in BESIDE {
        let model = json!({"model": {
            "name": "column at a wall", "dimension": 3, "nodes": {"base": [0, 0, 0], "mid": [1, 0, 0], "top": [2, 0, 0]},
            "supports": {"base": ["x", "y", "z"], "top": ["y", "z"]},
            "elements": [
                {"kind": "bar", "nodes": ["base", "mid"], "axial_stiffness": 1},
                {"kind": "bar", "nodes": ["mid", "top"], "axial_stiffness": 1},
                {"kind": "spring", "nodes": ["mid"], "stiffness": [[0, 0, 0], [0, 0.1, 0], [0, 0, 0.2]]}],
            "obstacles": {"wall": {"kind": "plane", "point": [0, 0, 0], "normal": [0, 1, 0]}},
            "contacts": [{"node": "mid", "obstacle": "wall", "friction": 0.3}],
            "stages": [{"name": "press", "forces": {"top": [-1, 0, 0]}, "until": {"load_above": 0.3}}]
        }});
        let (increments, _) = trace(&request(&beside(model.clone(), nodes).to_string()));
        let loads: Vec<f64> = bifurcations(&increments).iter().map(|point| point.load_factor).collect();
        assert_eq!(loads.len(), 2, "{loads:?}");
        for (load, k) in loads.iter().zip([0.1, 0.2]) {
            assert!((load - k / (2.0 + k)).abs() < 1e-12, "{load}");
        }
    }
}
