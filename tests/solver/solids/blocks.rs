//! A block on a rough plane, pressed and then pushed: all of it slips at `Q = μ N` exactly, on any mesh, and every node's
//! slip before that is an event.

use crate::common::paths::{request, trace};
use crate::solids::meshes::{Mesh, hold, name};
use arcslip::result::increment::{Increment, Status};
use arcslip::result::stop_reason::StopReason;
use serde_json::{Value, json};

const FRICTION: f64 = 0.3;
const PRESS: f64 = 0.1;

/// A block of 4 by 1 (in space by 1) under a pressure that holds, pushed by a traction on its top.
pub fn block(mesh: &Mesh, material: &Value, data: &Value) -> Value {
    let up = mesh.dimension() - 1;
    let area = 4.0;
    let mut model = mesh.model(material.clone(), data);
    model["surfaces"] = json!({"top": {"faces": mesh.faces(up, true)}});
    let along = |axis: usize, size: f64| {
        let mut vector = vec![0.0; up + 1];
        vector[axis] = size;
        vector
    };
    model["obstacles"] = json!({"floor": {"kind": "plane", "point": along(0, 0.0), "normal": along(up, 1.0)}});
    let contact = |node: String| json!({"node": node, "obstacle": "floor", "friction": FRICTION});
    model["contacts"] = mesh.side(up, false).into_iter().map(contact).collect();
    model["stages"] = json!([
        {"name": "press", "tractions": {"top": along(up, -PRESS / area)}, "until": {"load_above": 1}},
        {"name": "push", "tractions": {"top": along(0, 1.0 / area)}}
    ]);
    json!({"model": model})
}

fn sizes(point: [f64; 3]) -> [f64; 3] {
    [4.0 * point[0], point[1], point[2]]
}

/// Every change of a contact's status between increments stands at a located event.
fn changes_are_events(increments: &[Increment]) {
    for pair in increments.windows(2) {
        for (before, after) in pair[0].contacts.iter().zip(&pair[1].contacts) {
            let changed = before.status != after.status;
            assert!(
                !changed || pair[0].point.event.is_some() || pair[1].point.event.is_some(),
                "{} changes from {:?} to {:?} without an event at increment {}",
                after.node,
                before.status,
                after.status,
                pair[1].index
            );
        }
    }
}

fn follow(what: &str, model: &Value) {
    let (increments, report) = trace(&request(&model.to_string()));
    assert_eq!(report.stop_reason, StopReason::Mechanism, "{what}: {report:?}");
    let last = increments.last().expect("an end");
    assert_eq!(&*last.stage, "push");
    let error = (last.load_factor / (FRICTION * PRESS) - 1.0).abs();
    println!("{what}: {} increments, full slip at μN within {error:.1e}", increments.len());
    assert!(error < 1e-12, "{what}: full slip at {}", last.load_factor);
    let normal: f64 = last.contacts.iter().map(|contact| contact.normal_reaction).sum();
    assert!((normal / PRESS - 1.0).abs() < 1e-11, "{what}: {normal}");
    let at_limit = |contact: &&arcslip::result::increment::ContactState| contact.status != Status::Free;
    for contact in last.contacts.iter().filter(at_limit) {
        let size = contact.tangential_reaction.iter().map(|value| value * value).sum::<f64>().sqrt();
        assert!((size - FRICTION * contact.normal_reaction).abs() < 1e-9 * PRESS, "{what}: {contact:?}");
    }
    changes_are_events(&increments);
}

#[test]
fn a_block_slips_at_coulombs_limit_on_any_mesh_in_the_plane() {
    let material = json!({"kind": "linear_elastic", "young": 100, "poisson": 0.3});
    for (kind, cells) in [("quadrilateral4", [8, 2]), ("quadrilateral4", [16, 4]), ("triangle3", [10, 3])] {
        let mesh = Mesh::new(kind, &cells, sizes);
        follow(&format!("{kind} {cells:?}"), &block(&mesh, &material, &json!({"plane": "strain"})));
    }
    for kind in ["quadrilateral8", "triangle6"] {
        let mesh = Mesh::new(kind, &[6, 2], sizes);
        follow(kind, &block(&mesh, &material, &json!({"plane": "stress"})));
    }
    let rubber = json!({"kind": "neo_hookean", "young": 2, "poisson": 0.45});
    let mesh = Mesh::new("quadrilateral4", &[8, 3], sizes);
    follow("neo-Hookean", &block(&mesh, &rubber, &json!({"plane": "strain"})));
}

/// Directions of slip become those of the load as the block moves on; then nothing resists its motion.
#[test]
fn a_block_slips_at_coulombs_limit_in_space() {
    let elastic = |poisson: f64| json!({"kind": "linear_elastic", "young": 100, "poisson": poisson});
    for cells in [[3, 1, 1], [4, 2, 2], [6, 2, 2]] {
        let mesh = Mesh::new("hexahedron8", &cells, sizes);
        follow(&format!("hexahedron8 {cells:?} without lateral strain"), &block(&mesh, &elastic(0.0), &json!({})));
    }
    for (kind, cells) in [
        ("hexahedron8", [4, 2, 2]),
        ("hexahedron8", [6, 2, 2]),
        ("tetrahedron4", [4, 1, 1]),
        ("tetrahedron10", [3, 1, 1]),
        ("hexahedron20", [2, 1, 1]),
        ("hexahedron20", [3, 1, 1]),
    ] {
        let mesh = Mesh::new(kind, &cells, sizes);
        follow(&format!("{kind} {cells:?}"), &block(&mesh, &elastic(0.3), &json!({})));
    }
    let rubber = json!({"kind": "neo_hookean", "young": 2, "poisson": 0.45});
    follow("neo-Hookean", &block(&Mesh::new("hexahedron20", &[3, 1, 1], sizes), &rubber, &json!({})));
}

/// An even pressure reaches a plane through all contacts of quadratic faces, each with its share of the area: of a triangle
/// 2/15 at corners and 1/5 at middles, of a rectangle 1/20 and 1/5. The strain is even, on distorted meshes.
#[test]
fn quadratic_faces_carry_an_even_pressure_in_space() {
    for (kind, cells) in [("tetrahedron10", [3, 2, 2]), ("hexahedron20", [3, 2, 2])] {
        for (slope, friction) in [(0.0, 0.0), (0.3, 0.0), (0.0, 0.4)] {
            // The floor and all of the block turned about the y axis.
            let turned = |[x, y, z]: [f64; 3]| {
                let (sine, cosine) = f64::sin_cos(slope);
                [cosine * x + sine * z, y, cosine * z - sine * x]
            };
            let mesh = Mesh::new(kind, &cells, |[x, y, z]| turned([3.0 * x, 2.0 * y, z])).distorted(0.1);
            let poisson = if friction > 0.0 { 0.0 } else { 0.3 };
            let mut model = mesh.model(json!({"kind": "linear_elastic", "young": 100, "poisson": poisson}), &json!({}));
            model["surfaces"] = json!({"top": {"faces": mesh.faces(2, true)}});
            let up = turned([0.0, 0.0, 1.0]);
            model["obstacles"] = json!({"floor": {"kind": "plane", "point": [0, 0, 0], "normal": up}});
            let floor = mesh.side(2, false);
            let contact = |node: &String| json!({"node": node, "obstacle": "floor", "friction": friction});
            model["contacts"] = floor.iter().map(contact).collect();
            if friction == 0.0 {
                // What the floor leaves free, without a force.
                hold(&mut model, &[name(&[0, 0, 0])], &["x", "y"]);
                hold(&mut model, &[name(&[6, 0, 0])], &["y"]);
            }
            let press = 0.06_f64;
            let traction = up.map(|part| -press * part);
            model["stages"] = json!([{"name": "press", "tractions": {"top": traction}, "until": {"load_above": 1}}]);
            let what = format!("{kind}, slope {slope}, friction {friction}");
            let (increments, report) = trace(&request(&json!({"model": model}).to_string()));
            assert_eq!(report.stop_reason, StopReason::StagesCompleted, "{what}: {report:?}");
            let last = increments.last().expect("an end");
            let mut least = f64::INFINITY;
            for contact in &last.contacts {
                least = least.min(contact.normal_reaction);
                assert!(contact.gap.abs() < 1e-13, "{what}: {contact:?}");
            }
            let sum: f64 = last.contacts.iter().map(|contact| contact.normal_reaction).sum();
            println!("{what}: {} contacts, the least force {least:.2e}", last.contacts.len());
            assert!((sum / (6.0 * press) - 1.0).abs() < 1e-12 && least > 0.0, "{what}: {sum} {least}");
            if slope == 0.0 {
                let corner = last.contacts.iter().find(|contact| *contact.node == *name(&[0, 0, 0])).expect("a corner");
                let share = if kind == "hexahedron20" { 1.0 / 20.0 } else { 2.0 / 15.0 };
                let middle = last.contacts.iter().find(|contact| *contact.node == *name(&[3, 0, 0])).expect("a middle");
                let of_middle = if kind == "hexahedron20" { 1.0 / 5.0 } else { 0.5 / 5.0 };
                for (contact, share) in [(corner, share), (middle, of_middle)] {
                    let force = share * press;
                    assert!((contact.normal_reaction / force - 1.0).abs() < 1e-11, "{what}: {contact:?} {force}");
                }
            }
            for stress in last.elements.iter().filter_map(|element| element.stress.as_ref()) {
                let mut sum = 0.0;
                for (row, column, value) in [
                    (0, 0, stress[0]),
                    (1, 1, stress[1]),
                    (2, 2, stress[2]),
                    (0, 1, 2.0 * stress[3]),
                    (1, 2, 2.0 * stress[4]),
                    (0, 2, 2.0 * stress[5]),
                ] {
                    sum += value * up[row] * up[column];
                }
                assert!((sum / press + 1.0).abs() < 1e-11, "{what}: {stress:?}");
            }
        }
    }
}

/// Between its slips the path of a cube is smooth: were steps refused because directions of slip turn within them, it would
/// take 128 increments.
#[test]
fn steps_are_long_where_directions_of_slip_turn() {
    let mesh = Mesh::new("hexahedron8", &[2, 2, 2], |point| point);
    let mut model = mesh.model(json!({"kind": "neo_hookean", "young": 1e3, "poisson": 0.3}), &json!({}));
    let top = mesh.side(2, true);
    let moved = |by: [f64; 3]| top.iter().map(|node| (node.clone(), json!(by))).collect::<serde_json::Map<_, _>>();
    model["supports"] = top.iter().map(|node| (node.clone(), json!(["x", "y", "z"]))).collect();
    model["obstacles"] = json!({"floor": {"kind": "plane", "point": [0, 0, 0], "normal": [0, 0, 1]}});
    let contact = |node: String| json!({"node": node, "obstacle": "floor", "friction": 0.5});
    model["contacts"] = mesh.side(2, false).into_iter().map(contact).collect();
    model["stages"] = json!([
        {"name": "press", "displacements": moved([0.0, 0.0, -0.02]), "until": {"load_above": 1}},
        {"name": "push", "displacements": moved([0.06, 0.0, 0.0]), "until": {"load_above": 1}}
    ]);
    let (increments, report) = trace(&request(&json!({"model": model}).to_string()));
    assert_eq!(report.stop_reason, StopReason::StagesCompleted, "{report:?}");
    let slips = |increment: &Increment| increment.contacts.iter().any(|contact| contact.status == Status::Slip);
    assert!(increments.iter().any(slips));
    assert!(increments.len() < 40, "{}", increments.len());
}
