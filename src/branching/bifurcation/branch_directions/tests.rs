//! Branches that are followed, and where they lead.

use crate::continuation::path::iterator::Path;
use crate::continuation::scene::Scene;
use crate::resources::cancel::CancelFlag;
use crate::result::increment::{Increment, PointKind};

const HALF_WIDTH: f64 = 0.3;

fn scene(nodes: &str, supports: &str, elements: &str, direction: &str) -> Scene {
    let text = format!(
        r#"{{"model": {{"name": "truss", "dimension": 3, "nodes": {nodes}, "supports": {supports},
            "elements": [{elements}],
            "stages": [{{"name": "load", "forces": {{"apex": {direction}}}, "until": {{"increments": 60}}}}]}}}}"#
    );
    let request = crate::model::decode::decode(text.as_bytes()).unwrap();
    Scene::new(&request).unwrap()
}

fn bar(node: &str) -> String {
    format!(r#"{{"kind": "bar", "nodes": ["{node}", "apex"], "axial_stiffness": 1}}"#)
}

fn tall_truss() -> Scene {
    scene(
        r#"{"left": [-0.3, 0, 0], "right": [0.3, 0, 0], "apex": [0, 0, 1]}"#,
        r#"{"left": ["x", "y", "z"], "right": ["x", "y", "z"], "apex": ["y"]}"#,
        &[bar("left"), bar("right")].join(","),
        "[0, 0, -1]",
    )
}

fn tripod() -> Scene {
    let root = 0.75_f64.sqrt() * HALF_WIDTH;
    scene(
        &format!(r#"{{"a": [0.3, 0, 0], "b": [-0.15, {root}, 0], "c": [-0.15, -{root}, 0], "apex": [0, 0, 1]}}"#),
        r#"{"a": ["x", "y", "z"], "b": ["x", "y", "z"], "c": ["x", "y", "z"]}"#,
        &[bar("a"), bar("b"), bar("c")].join(","),
        "[0, 0, -1]",
    )
}

/// Goes to the first smooth bifurcation, takes each direction there in turn, and follows it for some increments.
fn followed(scene: &Scene) -> Vec<Vec<Increment>> {
    let mut all = Vec::new();
    loop {
        let mut path = Path::new(scene, CancelFlag::default());
        let point = path.by_ref().find(|i| i.point.kind == PointKind::SmoothBifurcation).unwrap();
        let tangent = path.trace.at.here.rate.clone().unwrap();
        let state = &path.trace.at.here.state;
        let standings = path.trace.standings(state);
        let (loading, force_scale) = (path.trace.loading(), path.trace.rules().force_scale);
        let here = crate::branching::bifurcation::branch_directions::SingularPoint {
            loading,
            state,
            standings: &standings,
            force_scale,
        };
        let eigenvalues = if point.point.event.as_deref() == Some("one eigenvalue crosses zero") { 1 } else { 2 };
        let found = crate::branching::bifurcation::branch_directions::branches(
            here,
            &path.trace.at.here.modes,
            &tangent,
            eigenvalues,
            None,
        );
        assert_eq!(found.options.len(), point.directions.unwrap().len());
        if all.len() == found.options.len() {
            return all;
        }
        let choice = found.options[all.len()].clone();
        path.trace.at.here.rate = Some(choice.rate);
        path.trace.at.here.load_sign = choice.load_sign;
        path.trace.at.here.signature = None;
        all.push(std::iter::from_fn(|| path.next()).take(12).collect());
    }
}

/// With `S = L1 + L2` and `P = L1 L2` the bent branch of the two-bar truss is `P = L0 (S² - 4 b²)/(2 S)`,
/// `s = -z (2/L0 - S/P)`.
#[test]
fn the_branches_of_a_pitchfork_are_those_of_the_closed_form() {
    let rest = HALF_WIDTH.hypot(1.0);
    let all = followed(&tall_truss());
    assert_eq!(all.len(), 4);
    for (number, increments) in all.iter().enumerate() {
        assert_eq!(increments.len(), 12);
        for increment in increments {
            let u = &increment.displacements["apex"];
            let (x, z) = (u[0], 1.0 + u[2]);
            assert!(increment.diagnostics.residual <= 1e-11);
            if number < 2 {
                assert!(x.abs() < 1e-9, "{x}");
                continue;
            }
            let (first, second) = ((x + HALF_WIDTH).hypot(z), (x - HALF_WIDTH).hypot(z));
            let (sum, product) = (first + second, first * second);
            let exact = rest * (sum * sum - 4.0 * HALF_WIDTH * HALF_WIDTH) / (2.0 * sum);
            assert!((product - exact).abs() < 1e-9, "{product} {exact}");
            let load = -z * (2.0 / rest - sum / product);
            assert!((increment.load_factor - load).abs() < 1e-9, "{} {load}", increment.load_factor);
        }
        let last = increments.last().unwrap().displacements["apex"][0];
        if number >= 2 {
            assert!(last.abs() > 0.05, "{last}");
        }
    }
    let sideways = |number: usize| all[number].last().unwrap().displacements["apex"][0];
    assert!((sideways(2) + sideways(3)).abs() < 1e-9);
}

/// Six branches in three mirror planes: each stays in its plane.
#[test]
fn the_branches_of_a_double_point_keep_their_mirror_plane() {
    let all = followed(&tripod());
    assert_eq!(all.len(), 8);
    let mut angles = Vec::new();
    for increments in &all[2..] {
        let angle = |i: &Increment| i.displacements["apex"][1].atan2(i.displacements["apex"][0]).to_degrees();
        let first = angle(&increments[0]);
        let off = (first / 60.0).round() * 60.0 - first;
        assert!(off.abs() < 1e-5, "{first}");
        assert!(increments.iter().all(|i| i.diagnostics.residual <= 1e-11));
        let far = increments.last().unwrap();
        assert!(far.displacements["apex"][0].hypot(far.displacements["apex"][1]) > 0.02);
        angles.push((first / 60.0).round().rem_euclid(6.0) as i32);
    }
    angles.sort_unstable();
    angles.dedup();
    assert_eq!(angles.len(), 6, "{angles:?}");
}
