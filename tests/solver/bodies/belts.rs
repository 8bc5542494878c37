//! A belt on an elastic drum.

use super::{Sheet, faces, support, whole_path};
use crate::common::paths::request;
use arcslip::result::increment::{Increment, Status};
use serde_json::{Value, json};
use std::f64::consts::FRAC_PI_2;

const FRICTION: f64 = 0.3;
const BENDING: f64 = 1e-3;
const TAIL: usize = 4;

/// A belt of beams around a quarter of a drum of radius 1, with straight tails: tightened by a force of 1 at one end, then
/// pulled at the other.
fn belt(elements: usize, cells: usize, swapped: bool) -> Value {
    let drum = Sheet::new("d", [cells, 3], |x, y| {
        let (angle, radius) = (FRAC_PI_2 + 0.3 - (FRAC_PI_2 + 0.6) * x, 0.5 + 0.5 * y);
        [radius * angle.cos(), radius * angle.sin()]
    });
    let place = |node: usize| {
        let angle = FRAC_PI_2 * (node as f64 - TAIL as f64) / elements as f64;
        let beyond = |nodes: usize| 0.1 * nodes as f64;
        match node {
            before if before < TAIL => [1.0, -beyond(TAIL - before)],
            after if after > TAIL + elements => [-beyond(after - TAIL - elements), 1.0],
            _ => [angle.cos(), angle.sin()],
        }
    };
    let last = elements + 2 * TAIL;
    let names: Vec<String> = (0..=last).map(|node| format!("b{node}")).collect();
    let (mut nodes, mut parts) = (drum.nodes.clone(), drum.elements.clone());
    nodes.extend(names.iter().enumerate().map(|(node, name)| (name.clone(), json!(place(node)))));
    parts.extend(
        names
            .windows(2)
            .map(|ends| json!({"kind": "beam", "nodes": ends, "axial_stiffness": 1e4, "bending_stiffness": BENDING})),
    );
    let (surface, against) = if swapped { ("rim", "belt") } else { ("belt", "rim") };
    let mut model = json!({
        "name": "belt", "dimension": 2, "nodes": nodes, "elements": parts, "supports": {},
        "materials": {"matter": {"kind": "neo_hookean", "young": 100, "poisson": 0.3}},
        "surfaces": {"belt": faces(&names), "rim": faces(&drum.highest())},
        "contacts": [{"surface": surface, "against": against, "friction": FRICTION}],
        "stages": [
            {"name": "tighten", "forces": {"b0": [0, -1]}, "until": {"load_above": 1}},
            {"name": "pull", "displacements": {&names[last]: [-0.12, 0]}, "until": {"load_above": 1}},
        ],
    });
    support(&mut model, &drum.lowest(), &["x", "y"]);
    support(&mut model, &names[..1], &["x"]);
    support(&mut model, &names[last..], &["x", "y"]);
    json!({"model": model, "analysis": {
        "selection": "straightest", "arc_length": {"initial": 1, "max": 200}, "record": {"elements": "none"},
    }})
}

/// The ratio of the tensions of the tails, less what bending takes (`EI / R²`), over `exp(μ θ)` with the angle `θ` between
/// the tails as they lie, less 1.
fn error_of_capstan(increment: &Increment, end: &str) -> f64 {
    let of = |node: &str| increment.supports.iter().find(|(name, _)| &***name == node).expect("a support").1;
    let (slack, tight) = (of("b0"), of(end));
    let angle = FRAC_PI_2 - (-slack[0]).atan2(1.0).abs() - tight[1].atan2(-tight[0]).abs();
    let tensions = [1.0_f64.hypot(slack[0]), tight[0].hypot(tight[1])];
    (tensions[1] - BENDING) / (tensions[0] - BENDING) / (FRICTION * angle).exp() - 1.0
}

/// Where all that touches slips, tensions follow the formula of the capstan (Euler, Eytelwein), but for the error of the
/// meshes, while the belt goes on around the drum; either surface with the multipliers. A belt that is divided more finely
/// than the drum lies on the corners of its mesh.
#[test]
fn a_belt_slips_around_an_elastic_drum() {
    for (elements, cells, swapped, bar) in [
        (12, 16, false, 6e-3),
        (12, 16, true, 6e-3),
        (24, 16, false, 3e-2),
        (24, 16, true, 6e-3),
        (24, 32, false, 4e-3),
        (48, 24, false, 1e-2),
    ] {
        let what = format!("{elements} elements on {cells} cells, swapped {swapped}");
        let increments = whole_path(&request(&belt(elements, cells, swapped).to_string()));
        let end = format!("b{}", elements + 2 * TAIL);
        let slips = |increment: &&Increment| {
            &*increment.stage == "pull" && increment.contacts.iter().all(|contact| contact.status != Status::Stick)
        };
        let errors: Vec<f64> =
            increments.iter().filter(slips).map(|increment| error_of_capstan(increment, &end)).collect();
        let largest = errors.iter().fold(0.0_f64, |largest, error| largest.max(error.abs()));
        println!("{what}: {} increments of {} in full slip, error {largest:.1e}", errors.len(), increments.len());
        assert!(errors.len() > 50 && largest < bar, "{what}: {} increments, {largest:e}", errors.len());
    }
}
