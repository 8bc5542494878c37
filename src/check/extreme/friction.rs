//! Friction from 0 to 1e6, friction at the critical coefficient, and contacts with zero reaction at the start.

use crate::check::verify::case::Case;
use crate::check::verify::compare::{moved, worse, worst};
use crate::check::verify::known::{KlarbringSolution, OneBarSolution};
use crate::check::verify::make::{load_above, plane_model};
use crate::result::increment::Status;
use crate::result::stop_reason::StopReason;

const COEFFICIENTS: [f64; 6] = [0.0, 1e-9, 1e-3, 1.0, 1e3, 1e6];

pub fn cases() -> Vec<Case> {
    let mut cases = Vec::new();
    cases.extend(COEFFICIENTS.map(|friction| {
        let node = KlarbringSolution { friction, ..KlarbringSolution::PUBLISHED };
        let request = node.make().contact("node", "floor", friction).longest_step(1e6).request();
        Case::new("friction", format!("Klarbring's node, {friction:e}"), request)
            .exact(1e-10, move |path| node.error(path))
    }));
    cases.extend(COEFFICIENTS.map(|friction| {
        let truss = OneBarSolution::with_friction(friction);
        let request = truss.make().load_scale(friction.max(1.0)).request();
        Case::new("friction", format!("one-bar truss, {friction:e}"), request)
            .ends(StopReason::Mechanism)
            .exact(1e-10, move |path| truss.error(path))
    }));
    // The critical coefficient k_xx/|k_xy|, at which the node slips under a constant load, and values on either side.
    for (along, coupling) in [(1.5, 0.75), (1.0, 0.8), (1.0, 0.9)] {
        for off in [0.0, 1e-12, -1e-12, 1e-9, -1e-9, 1e-6, -1e-6] {
            let friction = along / coupling * (1.0 + off);
            let node = KlarbringSolution { along, coupling, across: along, friction, ..KlarbringSolution::PUBLISHED };
            let name = format!("{along} / {coupling}, off by {off:e}");
            cases.push(Case::new("critical-friction", name, node.request()).exact(1e-10, move |path| node.error(path)));
        }
    }
    cases.extend([-90.0, -80.0, -45.0, -20.0, 0.0, 45.0, 90.0, 135.0, 180.0, 200.0, 260.0].map(at_rest));
    cases
}

/// A node that starts on the floor with zero reaction, `K = [[1, -0.3], [-0.3, 1]]`, μ = 1/2, under the force
/// `s (c, d)`. The contact is free if `u = K⁻¹ (c, d) s` rises, and sticking if `|c| <= -μ d`. Otherwise the contact
/// slips with `r_n = -d s - 0.3 x` and `x = s (c ± μ d)/(1 ∓ 0.3 μ)`; the upper signs hold for slip to +x. One of the
/// three cases applies, since `0.3 μ < 1`.
fn at_rest(degrees: f64) -> Case {
    const COUPLING: f64 = 0.3;
    const FRICTION: f64 = 0.5;
    let (d, c) = degrees.to_radians().sin_cos();
    let request = plane_model()
        .node("node", &[0.0, 0.0])
        .spring(&["node"], [[1.0, -COUPLING], [-COUPLING, 1.0]])
        .floor()
        .contact("node", "floor", FRICTION)
        .stage("load", &[("node", [c, d])], load_above(1.0))
        .request();
    let determinant = 1.0 - COUPLING * COUPLING;
    let free = [(c + COUPLING * d) / determinant, (d + COUPLING * c) / determinant];
    let (rate, normal, status) = if free[1] > 0.0 {
        (free, 0.0, Status::Free)
    } else if c.abs() <= -FRICTION * d {
        ([0.0, 0.0], -d, Status::Stick)
    } else {
        let sign = c.signum();
        let x = (c + sign * FRICTION * d) / (1.0 - sign * FRICTION * COUPLING);
        ([x, 0.0], -d - COUPLING * x, Status::Slip)
    };
    Case::new("zero-reaction", format!("loaded at {degrees} degrees"), request).exact(1e-10, move |path| {
        worst(path.iter().skip(1).map(|increment| {
            let s = increment.load_factor;
            let (x, y) = (moved(increment, "node", 0), moved(increment, "node", 1));
            let contact = &increment.contacts[0];
            if contact.status != status {
                return f64::INFINITY;
            }
            let place = worse((x - s * rate[0]).abs(), (y - s * rate[1]).abs());
            worse(place, (contact.normal_reaction - s * normal).abs())
        }))
    })
}
