//! A pressure that follows its surface: thick tubes and spheres, the balloon, and a strip that it bends far.

use crate::common::paths::{Traced, judged, request};
use crate::solids::meshes::{IN_PLANE, IN_SPACE, Mesh, hold, name};
use arcslip::continuation::path::iterator::Path;
use arcslip::continuation::scene::Scene;
use arcslip::resources::cancel::CancelFlag;
use arcslip::result::increment::PointKind;
use serde_json::{Value, json};
use std::f64::consts::FRAC_PI_2;

/// A quarter of a ring with radii 1 and 2, pressed from inside.
fn ring(kind: &'static str, cells: [usize; 2], material: Value, plane: &str, until: Value) -> Value {
    let mesh = Mesh::new(kind, &cells, |[along, around, _]| {
        let (radius, angle) = (1.0 + along, FRAC_PI_2 * around);
        // The axes exactly.
        let [x, y] = if around == 1.0 { [0.0, 1.0] } else { [angle.cos(), angle.sin()] };
        [radius * x, radius * y, 0.0]
    });
    let mut model = mesh.model(material, &json!({"plane": plane}));
    hold(&mut model, &mesh.side(1, false), &["y"]);
    hold(&mut model, &mesh.side(1, true), &["x"]);
    model["surfaces"] = json!({"inside": {"faces": mesh.faces(0, false)}});
    model["stages"] = json!([{"name": "blow", "pressures": {"inside": 1.0}, "until": until}]);
    json!({"model": model})
}

/// Every increment satisfies the measure of error.
fn assert_measured(traced: &Traced, what: &str) {
    for (increment, errors) in traced.increments.iter().zip(&traced.errors) {
        let (state, energy) = (errors.largest_of_state(), errors.energy);
        assert!(state < 1e-8 && energy < 1e-6, "{what}: increment {}: {errors:?}", increment.index);
    }
}

/// The node on the inner surface at the axis x.
const INNER: &str = "n0_0_0";

/// The motion of the inner surface under a small pressure, by G. Lamé: of a tube in plane strain, and of a sphere.
#[test]
fn thick_tubes_and_spheres_move_as_lame_says() {
    let (young, poisson) = (1.0, 0.3);
    let shear = young / (2.0 * (1.0 + poisson));
    // Radii a = 1, b = 2: u(a) = p a/(2G) [(1 - 2ν) a² + b²]/(b² - a²), and the like of the sphere.
    let tube = ((1.0 - 2.0 * poisson) + 4.0) / 3.0 / (2.0 * shear);
    let sphere = (2.0 * (1.0 - 2.0 * poisson) / (1.0 + poisson) + 8.0) / 7.0 / (4.0 * shear);
    for (plane, exact) in [("strain", tube), ("axisymmetric", sphere)] {
        for (kind, cells, order) in
            [("triangle3", 8, 1.6), ("quadrilateral4", 8, 1.9), ("triangle6", 8, 2.5), ("quadrilateral8", 4, 3.6)]
        {
            let errors = [cells, 2 * cells].map(|cells| {
                let material = json!({"kind": "neo_hookean", "young": young, "poisson": poisson});
                let model = ring(kind, [cells, 2 * cells], material, plane, json!({"load_above": 1e-7}));
                let traced = judged(&request(&model.to_string()));
                assert_measured(&traced, kind);
                let last = traced.increments.last().expect("an increment");
                (last.displacements[INNER][0] / (exact * last.load_factor) - 1.0).abs()
            });
            let found = (errors[0] / errors[1]).log2();
            println!("{plane} {kind}: errors {errors:?}, order {found:.2}");
            assert!(found > order, "{plane} {kind}: {errors:?}");
        }
    }
}

/// `p = [2/λ + 1/(2 λ⁴)]` at the outer radius less that at the inner one (times `G`) of an incompressible neo-Hookean
/// sphere with the radii 1 and 2; the largest by golden section.
fn largest_pressure() -> f64 {
    let of = |stretch: f64| 2.0 / stretch + 0.5 / stretch.powi(4);
    let pressure = |inner: f64| of((1.0 + (inner.powi(3) - 1.0) / 8.0).cbrt()) - of(inner);
    let (mut low, mut high) = (1.0_f64, 4.0_f64);
    for _ in 0..200 {
        let (left, right) = (high - 0.618 * (high - low), low + 0.618 * (high - low));
        if pressure(left) > pressure(right) { high = right } else { low = left }
    }
    pressure(0.5 * (low + high))
}

/// The balloon: the pressure has a largest value, a smooth limit point, and falls beyond. Extrapolated to the
/// incompressible limit.
#[test]
fn a_balloon_yields_at_its_largest_pressure() {
    let exact = largest_pressure();
    let of = |poisson: f64, cells: usize| {
        let material = json!({"kind": "neo_hookean", "young": 2.0 * (1.0 + poisson), "poisson": poisson});
        let until = json!({"displacement": {"node": INNER, "component": "x", "above": 2.0}});
        let model = ring("quadrilateral8", [cells, cells], material, "axisymmetric", until);
        let traced = judged(&request(&model.to_string()));
        assert_measured(&traced, "balloon");
        let limit = traced.increments.iter().find(|increment| increment.point.kind == PointKind::SmoothLimit);
        let limit = limit.expect("a limit point").load_factor;
        let last = traced.increments.last().expect("an increment");
        assert!(last.load_factor < limit, "{} beyond {limit}", last.load_factor);
        limit
    };
    let extrapolated = |cells: usize| {
        let (coarse, fine) = (of(0.4999, cells), of(0.49999, cells));
        fine + (fine - coarse) / 9.0
    };
    let errors = [4, 8].map(|cells| extrapolated(cells) / exact - 1.0);
    println!("largest pressure {exact:.9} G, errors {errors:?}");
    // Second order: the dilatation is constant in each element.
    let limit = (4.0 * errors[1] - errors[0]) / 3.0;
    assert!(errors[1].abs() < 5e-4 && limit.abs() < 5e-5, "{errors:?}");
}

/// The angle by which the free end of an inextensible strip turns under a load that stays across it: the load between a
/// point and the free end has the moment `p r²/2`, `r` their distance, so that `θ' = p r²/(2 EI)`; by Runge and Kutta's
/// method from the free end.
fn turned_end(load: f64) -> f64 {
    let slope = |[x, y, angle]: [f64; 3]| [angle.cos(), angle.sin(), 0.5 * load * (x * x + y * y)];
    let steps = 10_000;
    let h = 1.0 / f64::from(steps);
    let at = |from: [f64; 3], by: [f64; 3], part: f64| std::array::from_fn(|k| from[k] + part * h * by[k]);
    let mut state = [0.0; 3];
    for _ in 0..steps {
        let first = slope(state);
        let second = slope(at(state, first, 0.5));
        let third = slope(at(state, second, 0.5));
        let fourth = slope(at(state, third, 1.0));
        let mean = std::array::from_fn(|k| (first[k] + 2.0 * (second[k] + third[k]) + fourth[k]) / 6.0);
        state = at(state, mean, 1.0);
    }
    state[2]
}

/// A clamped strip bends far under a pressure on its upper side and as much suction on its lower one. Its free end makes
/// the tangent unsymmetric. What its thickness and its extension add falls with the square of the thickness.
#[test]
fn a_strip_under_pressure_bends_into_a_spiral() {
    let load = 15.0;
    let strip = |thickness: f64, cells: usize| {
        let mesh = Mesh::new("quadrilateral8", &[cells, 1], |[x, y, _]| [x, thickness * y, 0.0]);
        let material = json!({"kind": "saint_venant_kirchhoff", "young": 1.0, "poisson": 0.0});
        let mut model = mesh.model(material, &json!({"plane": "strain"}));
        hold(&mut model, &mesh.side(0, false), &["x", "y"]);
        model["surfaces"] = json!({"above": {"faces": mesh.faces(1, true)}, "below": {"faces": mesh.faces(1, false)}});
        let half = 0.5 * load * thickness.powi(3) / 12.0;
        model["stages"] = json!([{"name": "blow", "pressures": {"above": half, "below": -half},
            "until": {"load_above": 1.0}}]);
        json!({"model": model})
    };
    let exact = turned_end(load);
    let errors = [(0.04, 40), (0.02, 80)].map(|(thickness, cells)| {
        let traced = judged(&request(&strip(thickness, cells).to_string()));
        assert_measured(&traced, "strip");
        let last = traced.increments.last().expect("an increment");
        assert_eq!(last.load_factor, 1.0, "{thickness}: {:?}", traced.report);
        let moved = |row: usize| &last.displacements[name(&[2 * cells, row, 0]).as_str()];
        let (below, above) = (moved(0), moved(2));
        // The end face points from below to above.
        let angle = (above[0] - below[0]).atan2(-(thickness + above[1] - below[1]));
        let turned = std::f64::consts::PI - angle.rem_euclid(std::f64::consts::TAU);
        println!("thickness {thickness}: {} increments, turned by {turned:.6} of {exact:.6}", traced.increments.len());
        (turned.abs() / exact - 1.0).abs()
    });
    assert!(errors[1] < 3e-3 && errors[0] > 3.5 * errors[1], "{errors:?}");
}

/// A path with a pressure goes on from a checkpoint as without a break, bit for bit.
#[test]
fn a_path_with_a_pressure_resumes_bit_by_bit() {
    let material = json!({"kind": "neo_hookean", "young": 3.0, "poisson": 0.49});
    let until = json!({"displacement": {"node": INNER, "component": "x", "above": 1.0}});
    let model = ring("quadrilateral4", [3, 4], material, "axisymmetric", until);
    let scene = Scene::new(&request(&model.to_string())).expect("a scene");
    let mut path = Path::new(&scene, CancelFlag::default());
    let begun = path.by_ref().take(5).count();
    let checkpoint = path.checkpoint();
    let whole: Vec<_> = path.collect();
    let resumed: Vec<_> = Path::resume(&scene, checkpoint, CancelFlag::default()).expect("a path").collect();
    assert!(begun == 5 && whole.len() > 5 && whole.len() == resumed.len());
    for (one, other) in whole.iter().zip(&resumed) {
        assert_eq!((one.load_factor, &one.displacements), (other.load_factor, &other.displacements));
        assert_eq!((one.energy, &one.applied_forces), (other.energy, &other.applied_forces));
    }
}

/// A pressure on all sides: the Cauchy stress is its negative, in the plane and in space, on distorted meshes.
#[test]
fn a_body_under_pressure_on_all_sides_has_that_pressure_inside() {
    let mut worst = 0.0_f64;
    for kind in IN_PLANE.into_iter().chain(IN_SPACE) {
        let in_space = IN_SPACE.contains(&kind);
        let cells: &[usize] = if in_space { &[2, 2, 2] } else { &[2, 2] };
        let mesh = Mesh::new(kind, cells, |point| point).distorted(0.15);
        let data = if in_space { json!({}) } else { json!({"plane": "strain"}) };
        let mut model = mesh.model(json!({"kind": "neo_hookean", "young": 1.0, "poisson": 0.3}), &data);
        let axes = if in_space { 3 } else { 2 };
        // Three nodes, or two, hold the body without a force.
        hold(&mut model, &["n0_0_0".to_owned()], &["x", "y", "z"][..axes]);
        hold(&mut model, &["n4_0_0".to_owned()], &["y", "z"][..axes - 1]);
        if in_space {
            hold(&mut model, &["n0_4_0".to_owned()], &["z"]);
        }
        let mut pressures = serde_json::Map::new();
        for (side, (axis, at_end)) in (0..axes).flat_map(|axis| [(axis, false), (axis, true)]).enumerate() {
            model["surfaces"][format!("s{side}")] = json!({"faces": mesh.faces(axis, at_end)});
            pressures.insert(format!("s{side}"), json!(0.1));
        }
        model["stages"] = json!([{"name": "dive", "pressures": pressures, "until": {"load_above": 4.0}}]);
        let traced = judged(&request(&json!({"model": model}).to_string()));
        assert_measured(&traced, kind);
        let last = traced.increments.last().expect("an increment");
        assert_eq!(last.load_factor, 4.0, "{kind}: {:?}", traced.report);
        for element in &last.elements {
            let stress = element.stress.as_ref().expect("a stress");
            let shears = if in_space { 3 } else { 3.min(stress.len()) };
            for (place, value) in stress.iter().enumerate() {
                let expected = if place >= shears { 0.0 } else { -0.4 };
                // Across the plane the stress is another one.
                if in_space || place != 2 {
                    worst = worst.max((value - expected).abs());
                }
            }
        }
    }
    println!("largest error of a stress {worst:.1e}");
    assert!(worst < 1e-12, "{worst:e}");
}
