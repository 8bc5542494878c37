//! Two elastic cylinders: Hertz's pressure, and the partial slip of Cattaneo and Mindlin.

use super::{Sheet, moved, pair, support};
use crate::common::paths::{request, trace};
use arcslip::result::increment::{ContactState, Increment, Status};
use arcslip::result::stop_reason::StopReason;
use serde_json::{Value, json};
use std::f64::consts::PI;

/// Half the width of both bodies, and their depth, in half widths of the contact.
const EXTENT: f64 = 60.0;
const RADIUS: f64 = 100.0;
const FRICTION: f64 = 0.5;
const POISSON: f64 = 0.4999;

fn graded(t: f64) -> f64 {
    EXTENT * (6.0 * t).sinh() / 6.0_f64.sinh()
}

/// A cylinder pressed onto a plane of the same matter and pushed sideways; the half width of the contact is about 1.
fn cylinders(cells: [usize; 2], swapped: bool) -> Value {
    let lower = Sheet::new("l", [2 * cells[0], cells[0]], |x, y| [graded(2.0 * x - 1.0), -graded(1.0 - y)]);
    let upper = Sheet::new("u", [2 * cells[1], cells[1]], |x, y| {
        let x = graded(2.0 * x - 1.0);
        [x, RADIUS - (RADIUS * RADIUS - x * x).sqrt() + graded(y)]
    });
    let material = json!({"kind": "linear_elastic", "young": 1, "poisson": POISSON});
    let mut model = pair(&lower, &upper, &material, FRICTION, swapped);
    support(&mut model, &lower.lowest(), &["x", "y"]);
    support(&mut model, &upper.highest(), &["x", "y"]);
    // Only what may touch.
    let near = |face: &Value| {
        let x = |node: &Value| model["nodes"][node.as_str().expect("a name")][0].as_f64().expect("a number");
        face.as_array().expect("a face").iter().all(|node| x(node).abs() < 4.0)
    };
    let mut surfaces = model["surfaces"].clone();
    for name in ["below", "above"] {
        let faces: Vec<Value> = model["surfaces"][name]["faces"].as_array().expect("faces").clone();
        surfaces[name]["faces"] = faces.into_iter().filter(near).collect();
    }
    model["surfaces"] = surfaces;
    model["stages"] = json!([
        {"name": "press", "displacements": moved(&upper.highest(), [0.0, -2.5 / RADIUS]), "until": {"load_above": 1}},
        {"name": "push", "displacements": moved(&upper.highest(), [0.6 / RADIUS, 0.0]), "until": {"load_above": 1}},
    ]);
    json!({"model": model})
}

/// Sums over the contacts of a force times a power of the place.
fn moment(model: &Value, contacts: &[ContactState], of: impl Fn(&ContactState) -> f64, power: i32) -> f64 {
    let place = |contact: &ContactState| model["model"]["nodes"][&*contact.node][0].as_f64().unwrap_or(f64::NAN);
    contacts.iter().map(|contact| of(contact) * place(contact).powi(power)).sum()
}

/// Load and half width by the second moment of Hertz's pressure, `P a²/4`.
fn contact_width(model: &Value, increment: &Increment) -> (f64, f64) {
    let press = moment(model, &increment.contacts, |contact| contact.normal_reaction, 0);
    (press, 2.0 * (moment(model, &increment.contacts, |contact| contact.normal_reaction, 2) / press).sqrt())
}

#[test]
#[ignore = "half a minute in a release build: cargo test --release --test solver hertz -- --ignored"]
fn elastic_cylinders_follow_hertz_and_cattaneo_and_mindlin() {
    let modulus = 0.5 / (1.0 - POISSON.powi(2));
    for (cells, swapped) in [([20, 24], false), ([20, 24], true)] {
        let model = cylinders(cells, swapped);
        let (increments, report) = trace(&request(&model.to_string()));
        assert_eq!(report.stop_reason, StopReason::StagesCompleted, "{report:?}");
        let pressed = increments.iter().rev().find(|increment| &*increment.stage == "press").expect("pressed");
        let (press, contact) = contact_width(&model, pressed);
        let hertz = (4.0 * press * RADIUS / (PI * modulus)).sqrt();
        let last = increments.last().expect("an end");
        let (press, half_width) = contact_width(&model, last);
        let along = |contact: &ContactState| contact.tangential_reaction[0].abs();
        let push = moment(&model, &last.contacts, along, 0);
        let share = 4.0 * moment(&model, &last.contacts, along, 2) / (FRICTION * press * half_width * half_width);
        // The second moment of the tractions is μ P (a² - c⁴/a²)/4.
        let (stick, exact) = ((1.0 - share).powf(0.25), (1.0 - push / (FRICTION * press)).sqrt());
        let sticking = last.contacts.iter().filter(|contact| contact.status == Status::Stick).count();
        println!(
            "{cells:?} cells, swapped {swapped}: {} increments, half width {contact:.5}, Hertz {hertz:.5}; Q/(μP) {:.4}, \
             stick/contact {stick:.5}, Cattaneo {exact:.5}; {sticking} nodes stick",
            increments.len(),
            push / (FRICTION * press)
        );
        assert!((contact / hertz - 1.0).abs() < 0.02, "{contact} {hertz}");
        assert!((stick / exact - 1.0).abs() < 0.02, "{stick} {exact}");
    }
}
