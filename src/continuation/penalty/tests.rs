//! Friction in space: the tip of a bar that is dragged along a floor follows a tractrix. (A spring too soft to matter
//! supports the tip sideways while no friction acts.)

use crate::continuation::penalty::RegularisedPath;
use crate::continuation::scene::Scene;
use crate::resources::cancel::CancelFlag;
use crate::result::increment::{Increment, Status};

const MODEL: &str = r#"{
    "model": {"dimension": 3,
        "nodes": {"pin": [0, 0.1, 1], "tip": [-1.4, 0, 0]}, "supports": {"pin": ["x", "y", "z"]},
        "elements": [{"kind": "bar", "nodes": ["pin", "tip"], "axial_stiffness": 1},
            {"kind": "spring", "nodes": ["tip"], "stiffness": [[0, 0, 0], [0, 1e-9, 0], [0, 0, 0]]}],
        "obstacles": {"floor": {"kind": "plane", "point": [0, 0, 0], "normal": [0, 0, 1]}},
        "contacts": [{"node": "tip", "obstacle": "floor", "friction": 0.8}],
        "stages": [{"name": "push", "forces": {"tip": [1, 0, 0]},
            "until": {"displacement": {"node": "tip", "component": "x", "above": 1}}}]},
    "analysis": {"method": "regularised", "regularised": {"normal_penalty": 1e6, "tangential_penalty": 1e6}}
}"#;

fn curving_slip(step: f64) -> Vec<Increment> {
    let mut scene = Scene::new(&crate::model::decode::decode(MODEL.as_bytes()).unwrap()).unwrap();

    scene.analysis.arc_length.initial = step;
    scene.analysis.arc_length.max = step;
    RegularisedPath::new(&scene, CancelFlag::default()).collect()
}

/// Distance in x from the tractrix `x - x0 = F(b - y) - F(b)`, `F(w) = √(c² - w²) - c arcosh(c/w)`, `c = μ h = 0.8`.
fn off_track(increment: &Increment) -> f64 {
    let (b, c) = (0.1, 0.8_f64);
    let primitive = |w: f64| (c * c - w * w).sqrt() - c * (c / w).acosh();
    let place = &increment.displacements["tip"];
    let exact = primitive(b - place[1]) - primitive(b);
    // The track runs nearly along x: its slope converts a distance in x into one in y.
    let w = b - place[1];
    (place[0] - exact).abs() * w / (c * c - w * w).sqrt()
}

#[test]
fn slip_in_space_turns_as_it_should_at_first_order_in_the_step() {
    let errors = [0.04, 0.02, 0.01].map(|step| {
        let increments = curving_slip(step);
        let last = increments.last().unwrap();
        let contact = &last.contacts[0];
        assert!((last.displacements["tip"][0] - 1.0).abs() < 1e-15 && contact.status == Status::Slip);
        let tangential = contact.tangential_reaction[0].hypot(contact.tangential_reaction[1]);
        assert!((tangential - 0.8 * contact.normal_reaction).abs() < 1e-12);
        off_track(last)
    });
    assert!(errors[2] < 0.01, "{errors:?}");
    for pair in errors.windows(2) {
        assert!((1.7..2.3).contains(&(pair[0] / pair[1])), "{errors:?}");
    }
}
