//! A shallow clamped arch of a solid that snaps onto a rough floor and is pressed flat.

use crate::common::paths::{request, trace};
use crate::solids::meshes::{Mesh, hold};
use arcslip::result::increment::{Increment, PointKind};
use arcslip::result::stop_reason::StopReason;
use serde_json::{Map, Value, json};

const SPAN: f64 = 10.0;
const RISE: f64 = 1.0;
const THICKNESS: f64 = 0.3;

/// The arch on a mesh of `along` by `across` cells, pressed on a tenth of its upper side.
fn arch(kind: &'static str, along: usize, across: usize) -> Value {
    let radius = (SPAN * SPAN / 4.0 + RISE * RISE) / (2.0 * RISE);
    let half = (SPAN / 2.0 / radius).asin();
    let mesh = Mesh::new(kind, &[along, across], |[x, y, _]| {
        let (angle, own) = (half * (2.0 * x - 1.0), radius + THICKNESS * (y - 0.5));
        [own * angle.sin(), RISE - radius + own * angle.cos(), 0.0]
    });
    let mut model =
        mesh.model(json!({"kind": "neo_hookean", "young": 1000, "poisson": 0.3}), &json!({"plane": "strain"}));
    for at_end in [false, true] {
        hold(&mut model, &mesh.side(0, at_end), &["x", "y"]);
    }
    let faces = mesh.faces(1, true);
    let faces = faces.as_array().expect("faces");
    let middle = &faces[faces.len() * 9 / 20..faces.len() * 11 / 20];
    let crown = format!("n{along}_{}_0", 2 * across);
    model["surfaces"] = json!({"crown": {"faces": middle}});
    model["obstacles"] = json!({"floor": {"kind": "plane", "point": [0, -0.8], "normal": [0, 1]}});
    let ends = [mesh.side(0, false), mesh.side(0, true)].concat();
    let contact = |node: String| json!({"node": node, "obstacle": "floor", "friction": 0.5});
    model["contacts"] = mesh.side(1, false).into_iter().filter(|node| !ends.contains(node)).map(contact).collect();
    model["stages"] = json!([{"name": "press", "tractions": {"crown": [0, -1]},
        "until": {"displacement": {"node": crown, "component": "y", "below": -1.75}}}]);
    json!({"model": model})
}

/// The same arch of shear-stiff beams in plane strain, its axis on the floor of the lower side.
fn arch_of_beams(elements: usize) -> Value {
    let (radius, modulus) = ((SPAN * SPAN / 4.0 + RISE * RISE) / (2.0 * RISE), 1e3 / (1.0 - 0.3 * 0.3));
    let half = (SPAN / 2.0 / radius).asin();
    let at = |node: usize| half * (2.0 * node as f64 / elements as f64 - 1.0);
    let place = |node: usize| [radius * at(node).sin(), RISE - radius + radius * at(node).cos()];
    let nodes: Map<String, Value> = (0..=elements).map(|node| (format!("n{node}"), json!(place(node)))).collect();
    let beam = |node: usize| {
        json!({
            "kind": "beam", "nodes": [format!("n{node}"), format!("n{}", node + 1)],
            "axial_stiffness": modulus * THICKNESS, "bending_stiffness": modulus * THICKNESS.powi(3) / 12.0,
            "shear_stiffness": 1e3 / 2.6 * THICKNESS * 5.0 / 6.0,
        })
    };
    let (beams, middle) = ((0..elements).map(beam).collect::<Vec<_>>(), elements * 9 / 20..elements * 11 / 20);
    let faces: Vec<Value> = middle.map(|node| json!([format!("n{node}"), format!("n{}", node + 1)])).collect();
    let contact = |node: usize| json!({"node": format!("n{node}"), "obstacle": "floor", "friction": 0.5});
    // The load is one of the upper side's length.
    let load = (radius + THICKNESS / 2.0) / radius;
    let held = ["x", "y", "rz"];
    json!({"model": {
        "dimension": 2, "nodes": nodes, "elements": beams, "supports": {"n0": held, format!("n{elements}"): held},
        "surfaces": {"crown": {"faces": faces}},
        "obstacles": {"floor": {"kind": "plane", "point": [0, -0.8 + THICKNESS / 2.0], "normal": [0, 1]}},
        "contacts": (1..elements).map(contact).collect::<Vec<_>>(),
        "stages": [{"name": "press", "tractions": {"crown": [0, -load]},
            "until": {"displacement": {"node": format!("n{}", elements / 2), "component": "y", "below": -1.649}}}],
    }})
}

fn loads(increments: &[Increment], kind: PointKind) -> Vec<f64> {
    increments.iter().filter(|increment| increment.point.kind == kind).map(|increment| increment.load_factor).collect()
}

#[test]
fn a_shallow_arch_snaps_onto_a_rough_floor() {
    let mut found: Vec<(Vec<f64>, f64)> = Vec::new();
    for (kind, along, across) in [("quadrilateral4", 40, 2), ("quadrilateral4", 80, 4), ("quadrilateral8", 40, 2)] {
        let (increments, report) = trace(&request(&arch(kind, along, across).to_string()));
        assert_eq!(report.stop_reason, StopReason::StagesCompleted, "{report:?}");
        let limits = loads(&increments, PointKind::SmoothLimit);
        let touch = increments
            .iter()
            .find(|increment| increment.point.kind == PointKind::ContactChange)
            .expect("the arch touches the floor")
            .load_factor;
        println!(
            "{kind} {along} x {across}: {} increments, limits {limits:?}, touches at {touch}, energy {:.1e}",
            increments.len(),
            report.largest_energy_error
        );
        assert!(report.largest_energy_error < 1e-6);
        assert_eq!(limits.len(), 2, "a maximum and a minimum");
        found.push((limits, touch));
    }
    for (limits, touch) in &found[1..] {
        assert!((touch / found[0].1 - 1.0).abs() < 0.03, "{found:?}");
        for (limit, other) in limits.iter().zip(&found[0].0) {
            assert!((limit / other - 1.0).abs() < 0.03, "{found:?}");
        }
    }
}

/// A thickness of a thirtieth of the span is within what theory of beams covers: the loads at the maximum, at the minimum
/// and just before the crown reaches the floor, beside those of the solid.
#[test]
fn the_same_arch_of_beams_bears_the_same_loads() {
    let (solid, _) = trace(&request(&arch("quadrilateral8", 40, 2).to_string()));
    let (beams, report) = trace(&request(&arch_of_beams(80).to_string()));
    assert_eq!(report.stop_reason, StopReason::StagesCompleted, "{report:?}");
    let touch = solid.iter().find(|increment| increment.point.kind == PointKind::ContactChange);
    let touches = [touch.expect("the solid touches the floor"), beams.last().expect("an increment")];
    let [of_solid, of_beams] = [&solid, &beams].map(|increments| loads(increments, PointKind::SmoothLimit));
    println!("solid {of_solid:?}, {}; beams {of_beams:?}, {}", touches[0].load_factor, touches[1].load_factor);
    assert!((of_beams[0] / of_solid[0] - 1.0).abs() < 0.015);
    assert!((of_beams[1] / of_solid[1] - 1.0).abs() < 0.002);
    assert!((touches[1].load_factor / touches[0].load_factor - 1.0).abs() < 0.01);
}
