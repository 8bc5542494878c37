//! Bodies whose skin is one surface that may touch itself: a ring with a slit.

use super::{Sheet, support, whole_path};
use crate::common::paths::{close, request};
use arcslip::JobRequest;
use arcslip::result::increment::Status;
use serde_json::{Value, json};
use std::f64::consts::TAU;

const COLUMNS: usize = 24;
const ROWS: usize = 2;

/// How the ends of the ring may touch.
enum Touching {
    TwoSurfaces,
    /// The whole skin, listed from a face on.
    Itself(usize),
}

/// A ring with a slit, held opposite to it and turned by an angle; its ends are pressed together, and one is pushed along the
/// other.
fn slit_ring(slit: f64, friction: f64, turned: f64, touching: &Touching) -> JobRequest {
    let ring = Sheet::new("r", [COLUMNS, ROWS], |x, y| {
        let (angle, radius) = (turned + slit * (0.5 - x) + TAU * x, 1.2 - 0.2 * y);
        [radius * angle.cos(), radius * angle.sin()]
    });
    let edge = |nodes: Vec<String>| nodes.windows(2).map(|pair| json!(pair)).collect::<Vec<Value>>();
    let upper = edge((0..=ROWS).rev().map(|row| ring.name(0, row)).collect());
    let lower = edge((0..=ROWS).map(|row| ring.name(COLUMNS, row)).collect());
    let mut skin = edge(ring.lowest());
    skin.extend(lower.clone());
    skin.extend(edge(ring.highest().into_iter().rev().collect()));
    skin.extend(upper.clone());
    let contact = match touching {
        // The skin begins opposite to the slit and runs clockwise: its lower end is the later.
        Touching::TwoSurfaces => json!({"surface": "lower", "against": "upper", "friction": friction}),
        Touching::Itself(first) => {
            skin.rotate_left(*first);
            json!({"surface": "skin", "against": "skin", "friction": friction})
        }
    };
    let force = |[x, y]: [f64; 2]| {
        let (sine, cosine) = turned.sin_cos();
        json!([cosine * x - sine * y, sine * x + cosine * y])
    };
    let (above, below) = (ring.name(0, 0), ring.name(COLUMNS, 0));
    let mut model = json!({
        "dimension": 2, "nodes": ring.nodes, "elements": ring.elements, "supports": {},
        "materials": {"matter": {"kind": "neo_hookean", "young": 100, "poisson": 0.3}},
        "surfaces": {"lower": {"faces": lower}, "upper": {"faces": upper}, "skin": {"faces": skin}},
        "contacts": [contact],
        "stages": [
            {"name": "press", "forces": {above: force([0.0, -0.02]), below.clone(): force([0.0, 0.02])}, "until": {"load_above": 1}},
            {"name": "push", "forces": {below: force([0.006, 0.0])}, "until": {"load_above": 1}},
        ],
    });
    let opposite: Vec<String> = (0..=ROWS).map(|row| ring.name(COLUMNS / 2, row)).collect();
    support(&mut model, &opposite, &["x", "y"]);
    request(&json!({"model": model, "analysis": {"arc_length": {"initial": 0.05}}}).to_string())
}

#[test]
fn the_ends_of_a_slit_ring_touch() {
    for (friction, turned) in [(0.0, 1.1), (0.4, 1.1)] {
        let two = whole_path(&slit_ring(0.2, friction, 0.0, &Touching::TwoSurfaces));
        let one = whole_path(&slit_ring(0.2, friction, turned, &Touching::Itself(17)));
        assert_eq!(one.len(), two.len());
        let (last, end) = (two.last().expect("an end"), one.last().expect("an end"));
        for (node, expected) in last.displacements.iter() {
            let found = &end.displacements[node];
            let (sine, cosine) = f64::sin_cos(turned);
            let back = [cosine * found[0] + sine * found[1], cosine * found[1] - sine * found[0]];
            (0..2).for_each(|k| close(back[k], expected[k], 1e-8, node));
        }
        let closed: Vec<_> = last.contacts.iter().filter(|contact| contact.status != Status::Free).collect();
        assert!(!closed.is_empty());
        for contact in closed {
            let found = end.contacts.iter().find(|found| found.node == contact.node).expect("the contact");
            assert_eq!(found.status, contact.status);
            close(found.normal_reaction, contact.normal_reaction, 1e-8, "force");
        }
    }
}

/// A line of beams that crosses itself at the start.
#[test]
fn a_surface_that_crosses_itself_is_refused_with_where() {
    let places = [[0.0, 0.0], [2.0, 0.0], [2.0, 1.0], [1.0, 1.0], [1.0, -1.0]];
    let faces = |count: usize| (0..count).map(|k| json!([format!("n{k}"), format!("n{}", k + 1)])).collect::<Vec<_>>();
    let beams = faces(4)
        .into_iter()
        .map(|nodes| json!({"kind": "beam", "nodes": nodes, "axial_stiffness": 1, "bending_stiffness": 1}));
    let nodes: serde_json::Map<String, Value> =
        places.iter().enumerate().map(|(k, place)| (format!("n{k}"), json!(place))).collect();
    let posted = |count: usize| {
        json!({"model": {
            "dimension": 2, "nodes": nodes, "elements": beams.clone().collect::<Vec<_>>(),
            "supports": {"n0": ["x", "y", "rz"]}, "surfaces": {"left": {"faces": faces(count)}},
            "contacts": [{"surface": "left", "against": "left"}],
            "stages": [{"name": "pull", "forces": {"n4": [0, 1]}, "until": {"load_above": 0.01}}],
        }})
    };
    let read = |count: usize| arcslip::read(posted(count).to_string().as_bytes());
    let errors = read(4).expect_err("a refusal").to_string();
    for word in ["contacts[0].against", "crosses itself", "`n0` to `n1`", "`n3` to `n4`"] {
        assert!(errors.contains(word), "{errors}");
    }
    assert!(read(3).is_ok());
}
