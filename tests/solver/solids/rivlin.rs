//! Rivlin's cube: a body of unit size under equal dead tractions on all sides, nearly incompressible. At `T = 2 G` other
//! stretches branch off the state without any; the plate-like branch, on which two sides grow, turns at
//! `T = 1.889882 G` (R. S. Rivlin, Q. Appl. Math. 32 (1974) 265). A body of revolution keeps two stretches equal.

use crate::common::paths::request;
use crate::solids::meshes::{Mesh, hold};
use arcslip::continuation::path::iterator::Path;
use arcslip::continuation::scene::Scene;
use arcslip::resources::cancel::CancelFlag;
use arcslip::result::increment::PointKind;
use serde_json::{Value, json};

/// The node between mantle and top of one cell.
const RIM: &str = "n2_2_0";

/// A cylinder of radius and height 1; `E = 2 G (1 + ν)` for `G = 1`.
fn cylinder(poisson: f64, cells: usize) -> Value {
    let mesh = Mesh::new("quadrilateral4", &[cells, cells], |point| point);
    let mut model = mesh.model(
        json!({"kind": "neo_hookean", "young": 2.0 * (1.0 + poisson), "poisson": poisson}),
        &json!({"plane": "axisymmetric"}),
    );
    hold(&mut model, &mesh.side(0, false), &["x"]);
    hold(&mut model, &mesh.side(1, false), &["y"]);
    model["surfaces"] = json!({"mantle": {"faces": mesh.faces(0, true)}, "top": {"faces": mesh.faces(1, true)}});
    model["stages"] = json!([{"name": "pull", "tractions": {"mantle": [1, 0], "top": [0, 1]},
        "until": {"load_above": 2.5}}]);
    json!({"model": model})
}

/// The load at the bifurcation and at the limit point of the plate-like branch.
fn bifurcation_and_limit(model: &Value) -> (f64, f64) {
    let scene = Scene::new(&request(&model.to_string())).expect("a scene");
    let mut path = Path::new(&scene, CancelFlag::default());
    let point = path.by_ref().find(|increment| increment.point.bifurcation).expect("a bifurcation point");
    let directions = point.directions.as_ref().expect("directions").len();
    let checkpoint = path.checkpoint();
    // The rim of the top grows along the plate-like branch.
    let limit = (0..directions).find_map(|number| {
        let followed = Path::follow(&scene, checkpoint.clone(), number, String::new(), CancelFlag::default()).ok()?;
        let ahead: Vec<_> = followed.take_while(|increment| increment.load_factor > 1.5).take(60).collect();
        let limit = ahead.iter().position(|increment| increment.point.kind == PointKind::SmoothLimit)?;
        let rim = |place: usize| ahead[place].displacements[RIM][0];
        (rim(limit) > rim(0)).then(|| ahead[limit].load_factor)
    });
    (point.load_factor, limit.expect("a branch with a limit point"))
}

/// To the incompressible limit: values for two of Poisson's ratios, extrapolated in `1 - 2 ν`.
#[test]
fn the_plate_like_branch_off_rivlins_state_is_found_and_followed() {
    let of = |poisson: f64| bifurcation_and_limit(&cylinder(poisson, 1));
    let (coarse, fine) = (of(0.4999), of(0.49999));
    let extrapolated = |coarse: f64, fine: f64| fine + (fine - coarse) / 9.0;
    let (bifurcation, limit) = (extrapolated(coarse.0, fine.0), extrapolated(coarse.1, fine.1));
    println!("bifurcation {coarse:?}, {fine:?}: {bifurcation:.9}; limit {limit:.9}");
    assert!((bifurcation - 2.0).abs() < 1e-6, "{bifurcation}");
    assert!((limit - 1.889_882).abs() < 1e-6, "{limit}");
}
