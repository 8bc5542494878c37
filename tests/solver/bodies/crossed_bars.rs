//! A bar across another one, pressed on it: many nodes touch at once without reaction, and slip where the bars bend.

use super::bricks::{Brick, pair};
use super::{moved_in_space, support};
use crate::common::paths::{close, judged, request};
use arcslip::result::increment::{ContactState, Increment, Status};
use arcslip::result::stop_reason::StopReason;
use serde_json::{Value, json};

/// Two bars of length 6 and of a square cross-section of side 1, a gap of 0.05 apart, held and pressed at their ends.
fn crossed(friction: f64) -> Value {
    let lower = Brick::new("l", [4, 1, 1], false, |[x, y, z]| [6.0 * x, y, z]);
    let upper = Brick::new("u", [1, 4, 1], false, |[x, y, z]| [2.5 + x, 6.0 * y - 2.5, 1.05 + z]);
    let material = json!({"kind": "neo_hookean", "young": 100, "poisson": 0.3});
    let mut model = pair(&lower, &upper, &material, friction, false);
    let ends = [lower.ends(0), upper.ends(1)];
    ends.iter().for_each(|end| support(&mut model, end, &["x", "y", "z"]));
    model["stages"] = json!([
        {"name": "press", "displacements": moved_in_space(&ends[1], [0.0, 0.0, -0.2]), "until": {"load_above": 1}},
    ]);
    json!({"model": model})
}

/// The contact of a node of the upper bar.
fn contact<'a>(increment: &'a Increment, node: &str) -> &'a ContactState {
    increment.contacts.iter().find(|contact| &*contact.node == node).expect("a contact")
}

/// Both bars bend, and the nodes of the upper one beside the edges of the lower one touch first and slip, all four alike,
/// for the bars and their load are symmetric. (With much friction there are unsymmetric paths, too.)
#[test]
fn crossed_bars_are_pressed_on_each_other() {
    for friction in [0.0, 0.1, 0.3, 0.6, 1.0] {
        let found = judged(&request(&crossed(friction).to_string()));
        let what = format!("friction {friction}");
        assert_eq!(found.report.stop_reason, StopReason::StagesCompleted, "{what}");
        for (increment, errors) in found.increments.iter().zip(&found.errors) {
            assert!(errors.largest_of_state() <= 1e-9, "{what}, increment {}: {errors:?}", increment.index);
            assert!(errors.energy <= 1e-5, "{what}, increment {}: {errors:?}", increment.index);
        }
        let last = found.increments.last().expect("an increment");
        let corners = ["u0_1_0", "u1_1_0", "u0_3_0", "u1_3_0"].map(|node| contact(last, node));
        for corner in corners {
            assert_eq!(corner.status, Status::Slip, "{what}");
            let size = corner.tangential_reaction[0].hypot(corner.tangential_reaction[1]);
            close(size, friction * corner.normal_reaction, 1e-10, &what);
            if friction < 1.0 {
                close(corner.normal_reaction, corners[0].normal_reaction, 1e-7, &what);
            }
        }
    }
}
