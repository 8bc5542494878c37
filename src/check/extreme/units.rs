//! Units of length and force, magnitudes of gaps and of load patterns.

use crate::check::verify::case::Case;
use crate::check::verify::compare::{changes, moved, relative, worse, worst};
use crate::check::verify::known::{KlarbringSolution, OneBarSolution};
use crate::check::verify::make::{load_above, plane_model};
use crate::result::stop_reason::StopReason;

pub fn cases() -> Vec<Case> {
    let mut cases = Vec::new();
    for (length, force) in [
        (1e12, 1.0),
        (1e-12, 1.0),
        (1.0, 1e12),
        (1.0, 1e-12),
        (1e12, 1e12),
        (1e-12, 1e12),
        (1e12, 1e-12),
        (1e-12, 1e-12),
    ] {
        let node = KlarbringSolution::PUBLISHED.in_units(length, force);
        let name = |scene: &str| format!("{scene}, lengths {length:e}, forces {force:e}");
        cases.push(
            Case::new("units", name("Klarbring's node"), node.request()).exact(1e-10, move |path| node.error(path)),
        );
        let truss = OneBarSolution::with_friction(0.3).in_units(length, force);
        cases.push(
            Case::new("units", name("one-bar truss"), truss.make().request())
                .ends(StopReason::Mechanism)
                .exact(1e-10, move |path| truss.error(path)),
        );
    }
    for pull in [1e12, 1e-12] {
        let node = KlarbringSolution { pull, ..KlarbringSolution::PUBLISHED };
        cases.push(
            Case::new("units", format!("Klarbring's node, pattern of {pull:e}"), node.request())
                .exact(1e-10, move |path| node.error(path)),
        );
        let truss = OneBarSolution { pull, ..OneBarSolution::with_friction(0.3) };
        cases.push(
            Case::new("units", format!("one-bar truss, pattern of {pull:e}"), truss.make().request())
                .ends(StopReason::Mechanism)
                .exact(1e-10, move |path| truss.error(path)),
        );
    }
    cases.extend([-12, -10, -9, -6, -3, 0, 3, 6, 9, 12].map(|decades| gap(10_f64.powi(decades))));
    cases
}

/// A node on a unit spring at a gap g above the floor, pressed by s up to 1 + 2 g. The node lands at `s = g`; then
/// `r_n = s - g`.
fn gap(gap: f64) -> Case {
    let request = plane_model()
        .node("node", &[0.0, gap])
        .spring(&["node"], [[1.0, 0.0], [0.0, 1.0]])
        .floor()
        .contact("node", "floor", 0.5)
        .stage("press", &[("node", [0.0, -1.0])], load_above(1.0 + 2.0 * gap))
        .request();
    Case::new("gap", format!("{gap:e} of the motion under a unit load"), request).exact(1e-10, move |path| {
        let states = path.iter().map(|increment| {
            let s = increment.load_factor;
            let place = relative(moved(increment, "node", 1), -s.min(gap), 1.0);
            worse(place, relative(increment.contacts[0].normal_reaction, (s - gap).max(0.0), gap.max(1.0)))
        });
        let landings: Vec<f64> = changes(path).map(|point| relative(point.load_factor, gap, 1.0)).collect();
        // A gap within the tolerance may be closed from the start, without a contact change.
        let told = landings.len() == 1 || (landings.is_empty() && gap <= 1e-10);
        if told { worse(worst(states), landings.into_iter().fold(0.0, worse)) } else { f64::INFINITY }
    })
}
