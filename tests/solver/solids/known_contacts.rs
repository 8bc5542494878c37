//! Contact of solids with rigid obstacles against published tables and closed forms.

use crate::common::paths::{request, trace};
use crate::solids::meshes::{Mesh, hold, name};
use arcslip::result::increment::{ContactState, Increment, Status};
use arcslip::result::stop_reason::StopReason;
use serde_json::{Value, json};
use std::f64::consts::PI;

/// Code_Aster's SSNV128: a plate of 40 mm on a rigid plane with μ = 1, pressed from above and from the side `x = 0`. The
/// displacements of the contact line are published to 5 % (manual v6.04.128).
#[test]
fn a_plate_on_a_rough_plane_moves_as_published() {
    let side = 0.04;
    let mesh = Mesh::new("quadrilateral4", &[32, 32], |[x, y, _]| [side * x, side * y, 0.0]);
    let mut model =
        mesh.model(json!({"kind": "linear_elastic", "young": 1.3e11, "poisson": 0.2}), &json!({"plane": "strain"}));
    hold(&mut model, &mesh.side(0, true), &["x"]);
    model["surfaces"] = json!({"top": {"faces": mesh.faces(1, true)}, "left": {"faces": mesh.faces(0, false)}});
    model["obstacles"] = json!({"plane": {"kind": "plane", "point": [0, 0], "normal": [0, 1]}});
    let contact = |node: String| json!({"node": node, "obstacle": "plane", "friction": 1});
    model["contacts"] = mesh.side(1, false).into_iter().map(contact).collect();
    model["stages"] = json!([{"name": "press", "tractions": {"top": [0, -5e7], "left": [15e7, 0]},
        "until": {"load_above": 1}}]);
    let (increments, report) = trace(&request(&json!({"model": model}).to_string()));
    assert_eq!(report.stop_reason, StopReason::StagesCompleted, "{report:?}");
    let last = increments.last().expect("an end");
    // Every 1.25 mm is a node.
    let published = [(0, 2.86e-5), (1, 2.72e-5), (4, 2.28e-5), (6, 1.98e-5), (9, 1.50e-5)];
    for (place, along) in published {
        let found = last.displacements[&*name(&[2 * place, 0, 0])][0];
        println!("x = {:5.2} mm: {:.3e} m, published {along:.2e}", 1.25 * place as f64, found);
        assert!((found / along - 1.0).abs() < 0.05, "{place}: {found}");
    }
}

/// Half the width of the block under the cylinder, and its depth, in half widths of the contact.
const EXTENT: f64 = 60.0;
const RADIUS: f64 = 100.0;
const FRICTION: f64 = 0.5;
const POISSON: f64 = 0.4999;

/// A rigid cylinder pressed into an elastic block and pushed sideways; incompressible, so that normal and tangential
/// tractions do not act on each other. The half width of the contact is about 1.
fn cylinder_on_block(cells: usize) -> Value {
    let graded = |t: f64| EXTENT * (6.0 * t).sinh() / 6.0_f64.sinh();
    let mesh =
        Mesh::new("quadrilateral4", &[2 * cells, cells], |[x, y, _]| [graded(2.0 * x - 1.0), -graded(1.0 - y), 0.0]);
    let mut model =
        mesh.model(json!({"kind": "linear_elastic", "young": 1, "poisson": POISSON}), &json!({"plane": "strain"}));
    hold(&mut model, &mesh.side(1, false), &["x", "y"]);
    model["obstacles"] = json!({"cylinder": {"kind": "ball", "center": [0, RADIUS], "radius": RADIUS}});
    let near = |node: &String| model["nodes"][node][0].as_f64().is_some_and(|x| x.abs() < 2.0);
    let contact = |node: String| json!({"node": node, "obstacle": "cylinder", "friction": FRICTION});
    model["contacts"] = mesh.side(1, true).into_iter().filter(near).map(contact).collect();
    model["stages"] = json!([
        {"name": "press", "obstacle_motion": {"cylinder": [0, -2.5 / RADIUS]}, "until": {"load_above": 1}},
        {"name": "push", "obstacle_motion": {"cylinder": [0.6 / RADIUS, 0]}, "until": {"load_above": 1}}
    ]);
    json!({"model": model})
}

/// A rigid ball pressed into an elastic block about the axis; the radius of the contact is about 1. By the second moment of
/// Hertz's tractions, `2 P a²/5`, it is `a³ = 3 P R (1 - ν²)/(4 E)`.
#[test]
fn a_rigid_ball_on_a_block_follows_hertz() {
    let (cells, poisson) = (40, 0.3_f64);
    let graded = |t: f64| EXTENT * (6.0 * t).sinh() / 6.0_f64.sinh();
    let mesh = Mesh::new("quadrilateral4", &[cells, cells], |[x, y, _]| [graded(x), -graded(1.0 - y), 0.0]);
    let mut model = mesh
        .model(json!({"kind": "linear_elastic", "young": 1, "poisson": poisson}), &json!({"plane": "axisymmetric"}));
    hold(&mut model, &mesh.side(0, false), &["x"]);
    hold(&mut model, &mesh.side(1, false), &["x", "y"]);
    model["obstacles"] = json!({"ball": {"kind": "ball", "center": [0, RADIUS], "radius": RADIUS}});
    let near = |node: &String| model["nodes"][node][0].as_f64().is_some_and(|x| x < 2.0);
    let contact = |node: String| json!({"node": node, "obstacle": "ball"});
    model["contacts"] = mesh.side(1, true).into_iter().filter(near).map(contact).collect();
    model["stages"] = json!([{"name": "press", "obstacle_motion": {"ball": [0, -1.0 / RADIUS]},
        "until": {"load_above": 1}}]);
    let model = json!({"model": model});
    let (increments, report) = trace(&request(&model.to_string()));
    assert_eq!(report.stop_reason, StopReason::StagesCompleted, "{report:?}");
    let contacts = &increments.last().expect("an end").contacts;
    let press = moment(&model, contacts, |contact| contact.normal_reaction, 0);
    let found = (2.5 * moment(&model, contacts, |contact| contact.normal_reaction, 2) / press).sqrt();
    let hertz = (0.75 * press * RADIUS * (1.0 - poisson * poisson)).cbrt();
    println!("{cells} cells: P {press:.6}, radius {found:.5}, Hertz {hertz:.5}");
    assert!((found / hertz - 1.0).abs() < 0.01, "{found} {hertz}");
}

/// A rigid ball on a quarter of a block in space: the error of the contact's radius by Hertz's second moment.
fn error_in_space(kind: &'static str, cells: usize, extent: f64) -> f64 {
    let (poisson, grading) = (0.3_f64, 3.5_f64);
    let graded = |t: f64| extent * (grading * t).sinh() / grading.sinh();
    let mesh = Mesh::new(kind, &[cells; 3], |[x, y, z]| [graded(x), graded(y), -graded(1.0 - z)]);
    let mut model = mesh.model(json!({"kind": "linear_elastic", "young": 1, "poisson": poisson}), &json!({}));
    hold(&mut model, &mesh.side(0, false), &["x"]);
    hold(&mut model, &mesh.side(1, false), &["y"]);
    hold(&mut model, &mesh.side(2, false), &["x", "y", "z"]);
    model["obstacles"] = json!({"ball": {"kind": "ball", "center": [0, 0, RADIUS], "radius": RADIUS}});
    let place = |node: &str| [0, 1].map(|axis| model["nodes"][node][axis].as_f64().unwrap_or(f64::NAN));
    let squared = |node: &str| place(node).iter().map(|value| value * value).sum::<f64>();
    // A force past the middle of an edge has shares of the nodes there.
    let second_moment = |node: &str| {
        let [x, y] = [1, 2].map(|part| node[1..].split('_').nth(part - 1).map_or(0, |n| n.parse().unwrap_or(0_usize)));
        if kind == "hexahedron8" || (x % 2 == 0 && y % 2 == 0) {
            return squared(node);
        }
        let end = |side: usize| squared(&name(&[x + side * (x % 2), y + side * (y % 2), 2 * cells]));
        let [a, b] = [squared(&name(&[x - x % 2, y - y % 2, 2 * cells])), end(1)];
        (5.0 * squared(node) - a - b) / 3.0
    };
    let contact = |node: &String| json!({"node": node, "obstacle": "ball"});
    let near: Vec<String> = mesh.side(2, true).into_iter().filter(|node| squared(node) < 4.0).collect();
    let contacts: Vec<Value> = near.iter().map(contact).collect();
    let mut model = model.clone();
    model["contacts"] = contacts.into();
    model["stages"] = json!([{"name": "press", "obstacle_motion": {"ball": [0, 0, -1.0 / RADIUS]},
        "until": {"load_above": 1}}]);
    let (increments, report) = trace(&request(&json!({"model": model}).to_string()));
    assert_eq!(report.stop_reason, StopReason::StagesCompleted, "{kind}: {report:?}");
    let contacts = &increments.last().expect("an end").contacts;
    let press: f64 = contacts.iter().map(|contact| contact.normal_reaction).sum();
    let second: f64 = contacts.iter().map(|contact| contact.normal_reaction * second_moment(&contact.node)).sum();
    let (found, hertz) = ((2.5 * second / press).sqrt(), (3.0 * press * RADIUS * (1.0 - poisson * poisson)).cbrt());
    let closed = contacts.iter().filter(|contact| contact.normal_reaction > 0.0).count();
    println!("{kind}, {cells} cells: {closed} closed, radius {found:.5}, Hertz {hertz:.5}");
    found / hertz - 1.0
}

/// Solids with even and with quadratic faces.
#[test]
fn a_rigid_ball_on_solids_in_space_follows_hertz() {
    for (kind, cells) in [("hexahedron8", 12), ("hexahedron20", 6), ("tetrahedron10", 6)] {
        let error = error_in_space(kind, cells, 8.0);
        assert!(error.abs() < 0.015, "{kind}: {error}");
    }
}

#[test]
#[ignore = "a minute in a release build: cargo test --release --test solver known_contacts -- --ignored"]
fn a_rigid_ball_on_finely_divided_solids_in_space_follows_hertz() {
    for (kind, cells) in [("hexahedron8", 16), ("hexahedron20", 8), ("tetrahedron10", 8)] {
        let error = error_in_space(kind, cells, 12.0);
        assert!(error.abs() < 0.01, "{kind}: {error}");
    }
}

/// Sums over the contacts of a force times a power of the place.
fn moment(model: &Value, contacts: &[ContactState], of: impl Fn(&ContactState) -> f64, power: i32) -> f64 {
    let place = |contact: &ContactState| model["model"]["nodes"][&*contact.node][0].as_f64().unwrap_or(f64::NAN);
    contacts.iter().map(|contact| of(contact) * place(contact).powi(power)).sum()
}

/// Half widths of contact and of stick by the second moments of the tractions of Hertz, `P a²/4`, and of Cattaneo and
/// Mindlin, `μ P (a² - c⁴/a²)/4`, with the loads.
struct Widths {
    press: f64,
    contact: f64,
    push: f64,
    stick: f64,
}

fn widths(model: &Value, increment: &Increment) -> Widths {
    let press = moment(model, &increment.contacts, |contact| contact.normal_reaction, 0);
    let contact = 2.0 * (moment(model, &increment.contacts, |contact| contact.normal_reaction, 2) / press).sqrt();
    let along = |contact: &ContactState| -contact.tangential_reaction[0];
    let push = moment(model, &increment.contacts, along, 0);
    let share = 4.0 * moment(model, &increment.contacts, along, 2) / (FRICTION * press * contact * contact);
    Widths { press, contact, push, stick: contact * (1.0 - share).powf(0.25) }
}

#[test]
fn a_rigid_cylinder_on_a_block_follows_hertz_and_cattaneo_and_mindlin() {
    let modulus = 1.0 / (1.0 - POISSON.powi(2));
    let cells = 24;
    let model = cylinder_on_block(cells);
    let (increments, report) = trace(&request(&model.to_string()));
    assert_eq!(report.stop_reason, StopReason::StagesCompleted, "{report:?}");
    let pressed = increments.iter().rev().find(|increment| &*increment.stage == "press").expect("pressed");
    let Widths { press, contact, .. } = widths(&model, pressed);
    let hertz = (4.0 * press * RADIUS / (PI * modulus)).sqrt();
    let last = increments.last().expect("an end");
    let pushed = widths(&model, last);
    let ratio = pushed.push / (FRICTION * pushed.press);
    let stick = (1.0 - ratio).sqrt();
    let sticking = last.contacts.iter().filter(|contact| contact.status == Status::Stick).count();
    println!(
        "{cells} cells: P {press:.6} then {:.6}, {} increments, half width {contact:.5}, Hertz {hertz:.5}; Q/(μP) {ratio:.4}, stick/contact \
         {:.5}, Cattaneo {stick:.5}; {sticking} nodes stick",
        pushed.press,
        increments.len(),
        pushed.stick / pushed.contact
    );
    let bar = 0.01;
    assert!((contact / hertz - 1.0).abs() < bar, "{contact} {hertz}");
    assert!((pushed.stick / pushed.contact / stick - 1.0).abs() < bar, "{stick}");
}
