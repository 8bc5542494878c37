//! Grazing contact, a node in a wedge, redundant contacts.

use crate::check::verify::case::Case;
use crate::check::verify::compare::{moved, of_stage, relative, worse, worst};
use crate::check::verify::known::KlarbringSolution;
use crate::check::verify::make::{displacement, load_above, plane_model};
use crate::model::request::Component;
use crate::result::increment::Status;

pub fn cases() -> Vec<Case> {
    let mut cases = Vec::new();
    cases.extend([0.0, 1e-13, 1e-12, 1e-11, 1e-9, 1e-6, 1e-4, -1e-13, -1e-12, -1e-11, -1e-9, -1e-6].map(grazing));
    for slope in [1e-6, 1e-3, 1.0, 3.0, 1e3, 1e6] {
        for friction in [0.0, 0.25] {
            cases.push(wedge(slope, friction));
        }
    }
    cases.extend([2, 3, 10].map(repeated));
    cases.extend([0.0, 1e-14, 1e-13, 1e-12, 1e-10, 1e-8, 1e-6].map(tilted));
    cases.extend([1e-14, 1e-13, 1e-12, 1e-10, 1e-8, 1e-6].map(beneath));
    cases
}

/// A node on a unit spring, pushed along x by s past a frictionless ball of radius 1 whose top is at (1, δ). For
/// `δ <= 0` the node moves straight on, `x = s`. On the ball, at the angle φ from the top, `x = 1 + sin φ` and
/// `y = δ - (1 - cos φ)`, and the sum of spring force and load is along the normal: `s = x - y tan φ`.
fn grazing(rise: f64) -> Case {
    let request = plane_model()
        .node("node", &[0.0, 0.0])
        .spring(&["node"], [[1.0, 0.0], [0.0, 1.0]])
        .ball("ball", &[1.0, rise - 1.0], 1.0)
        .contact("node", "ball", 0.0)
        .stage("push", &[("node", [1.0, 0.0])], load_above(2.0))
        .request();
    Case::new("grazing-touch", format!("a ball {rise:e} into the way"), request).exact(1e-10, move |path| {
        worst(path.iter().skip(1).map(|increment| {
            let (x, y) = (moved(increment, "node", 0), moved(increment, "node", 1));
            let (s, sine) = (increment.load_factor, moved(increment, "node", 0) - 1.0);
            if increment.contacts[0].status == Status::Free {
                return worse((x - s).abs(), y.abs());
            }
            let cosine = ((1.0 - sine) * (1.0 + sine)).sqrt();
            let height = rise - sine * sine / (1.0 + cosine);
            worse((y - height).abs(), (s - (x - height * sine / cosine)).abs())
        }))
    })
}

/// A node between two flanks of slope t with friction μ, on a spring k = 1/2, pressed by 1 and then pushed to the right
/// by s. The node sticks in the corner up to `s = (t + μ)/(1 - μ t)`, and for every s if `μ t >= 1`. Then the node
/// slips up the right flank; at the distance d, `s = (k d sqrt(1 + t²) + t + μ)/(1 - μ t)`.
fn wedge(slope: f64, friction: f64) -> Case {
    let root = slope.hypot(1.0);
    let leaves = friction * slope < 1.0;
    let held = (slope + friction) / (1.0 - friction * slope);
    let until = match (leaves, slope < 1.0) {
        (true, true) => displacement("node", Component::X, 0.5, 1.0),
        (true, false) => displacement("node", Component::Y, 0.5, 1.0),
        (false, _) => load_above(100.0),
    };
    let request = plane_model()
        .node("node", &[0.0, 0.0])
        .spring(&["node"], [[0.5, 0.0], [0.0, 0.5]])
        .plane("left", &[0.0, 0.0], &[slope, 1.0])
        .plane("right", &[0.0, 0.0], &[-slope, 1.0])
        .contact("node", "left", friction)
        .contact("node", "right", friction)
        .stage("press", &[("node", [0.0, -1.0])], load_above(1.0))
        .stage("push", &[("node", [1.0, 0.0])], until)
        .longest_step(if leaves { 0.5 * held.max(1.0) } else { 10.0 })
        .request();
    Case::new("wedge", format!("slope {slope:e}, friction {friction}"), request).exact(1e-10, move |path| {
        let size = if leaves { held.abs() } else { 1.0 };
        let mut left_it = false;
        let error = worst(of_stage(path, "push").map(|increment| {
            let (x, y) = (moved(increment, "node", 0), moved(increment, "node", 1));
            if increment.contacts[1].status == Status::Slip && increment.contacts[0].status == Status::Free {
                left_it = true;
                let distance = (x + slope * y) / root;
                let exact = (0.5 * distance * root + slope + friction) / (1.0 - friction * slope);
                return relative(increment.load_factor, exact, 1.0);
            }
            let past = if leaves { (increment.load_factor - held).max(0.0) / size.max(1.0) } else { 0.0 };
            worse(worse(x.abs(), y.abs()), past)
        }));
        if left_it == leaves { error } else { f64::INFINITY }
    })
}

/// Klarbring's node with n copies of the same contact: the sum of the reactions is the reaction of a single contact.
fn repeated(times: usize) -> Case {
    let node = KlarbringSolution::PUBLISHED;
    let request = (0..times).fold(node.make(), |make, _| make.contact("node", "floor", node.friction)).request();
    Case::new("redundant-contacts", format!("{times} of them, the same"), request)
        .exact(1e-10, move |path| node.error(path))
}

/// A second floor through the same point, tilted against the slip by ε. The tilt changes the path by a multiple of ε.
fn tilted(tilt: f64) -> Case {
    let node = KlarbringSolution { friction: 0.8, ..KlarbringSolution::PUBLISHED };
    let request = node
        .make()
        .contact("node", "floor", node.friction)
        .plane("tilted", &[0.0, 0.0], &[-tilt, 1.0])
        .contact("node", "tilted", node.friction)
        .request();
    Case::new("redundant-contacts", format!("a second floor tilted by {tilt:e}"), request)
        .exact(1e-10 + 10.0 * tilt, move |path| {
            worst(of_stage(path, "pull").map(|increment| node.error_at(increment, "node", 0..2)))
        })
}

/// A second floor at a depth ε below the first floor. The node never reaches the second floor.
fn beneath(depth: f64) -> Case {
    let node = KlarbringSolution { friction: 0.8, ..KlarbringSolution::PUBLISHED };
    let request = node
        .make()
        .contact("node", "floor", node.friction)
        .plane("beneath", &[0.0, -depth], &[0.0, 1.0])
        .contact("node", "beneath", node.friction)
        .request();
    Case::new("redundant-contacts", format!("a second floor {depth:e} beneath"), request)
        .exact(1e-10, move |path| worst(of_stage(path, "pull").map(|increment| node.error_at(increment, "node", 0..2))))
}
