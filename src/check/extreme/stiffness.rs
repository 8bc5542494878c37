//! Stiffness ratios, contacts on soft structures, nearly coincident nodes, slender triangles.

use crate::check::verify::case::{AUTO, BOTH, Case};
use crate::check::verify::compare::{changes, moved, of_stage, relative, worse, worst};
use crate::check::verify::known::{KlarbringSolution, OneBarSolution};
use crate::check::verify::make::{displacement, load_above, plane_model};
use crate::model::request::Component;
use crate::result::increment::Increment;
use crate::result::stop_reason::StopReason;
use twofloat::TwoFloat;

pub fn cases() -> Vec<Case> {
    let mut cases = Vec::new();
    cases.extend([0, 1, 2, 3, 4, 6, 8, 9, 10, 12].map(|decades| in_series(10_f64.powi(decades))));
    cases.extend([0, 3, 6, 9, 10, 12].map(|decades| dragged(10_f64.powi(decades))));
    cases.extend([-9, -6, -3, 3, 6, 9].map(|decades| pulled_block(10_f64.powi(decades))));
    cases.extend([-12, -9, -6, 6, 9, 12].map(|decades| side_by_side(10_f64.powi(decades))));
    cases.extend([-9, -6, 6, 9].map(|decades| trusses_side_by_side(10_f64.powi(decades))));
    cases.extend([1, 3, 6, 9, 11].map(|decades| near_nodes(10_f64.powi(-decades))));
    cases.extend([1, 2, 3, 4, 5, 6].map(|decades| slender(10_f64.powi(-decades))));
    cases
}

/// Two collinear bars, EA = 1 and EA = R, pulled by s: `u_middle = s`, `u_end = s + s/R`.
fn in_series(ratio: f64) -> Case {
    let request = plane_model()
        .node("pin", &[0.0, 0.0])
        .node("middle", &[1.0, 0.0])
        .node("end", &[2.0, 0.0])
        .support("pin", &[Component::X, Component::Y])
        .support("middle", &[Component::Y])
        .support("end", &[Component::Y])
        .bar("pin", "middle", 1.0)
        .bar("middle", "end", ratio)
        .stage("pull", &[("end", [1.0, 0.0])], load_above(0.5))
        .request();
    Case::new("stiffness-ratio", format!("bars in series, 1 : {ratio:e}"), request).by(AUTO).exact(1e-10, move |path| {
        worst(path.iter().skip(1).map(|increment| {
            let s = increment.load_factor;
            worse(
                relative(moved(increment, "middle", 0), s, 0.0),
                relative(moved(increment, "end", 0), s + s / ratio, 0.0),
            )
        }))
    })
}

/// The one-bar truss, pulled through a bar of length 1 and EA = R that lies on the floor. The loads of the tip are
/// those of the one-bar truss, and the elongation of the bar is `s/R`.
fn dragged(ratio: f64) -> Case {
    let truss = OneBarSolution::with_friction(0.3);
    let mut request =
        truss.make().node("hook", &[-0.5, 0.0]).support("hook", &[Component::Y]).bar("tip", "hook", ratio);
    request.0.model.stages.clear();
    let request = request.stage("pull", &[("hook", [1.0, 0.0])], displacement("tip", Component::X, 2.9, 1.0)).request();
    // Above 1e9, the MPEC of each increment needs hundreds of quadratic programs.
    let methods = if ratio <= 1e9 { BOTH } else { AUTO };
    Case::new("stiffness-ratio", format!("one-bar truss pulled by a bar, 1 : {ratio:e}"), request).by(methods).exact(
        1e-10,
        move |path| {
            let elongations = worst(path.iter().map(|increment| {
                let elongation = moved(increment, "hook", 0) - moved(increment, "tip", 0);
                (elongation - increment.load_factor / ratio).abs()
            }));
            worse(elongations, truss.error(path))
        },
    )
}

/// A block on the floor (μ = 1/2, pressed by 1), connected to the ground by a spring k and pulled by s through a bar of
/// EA = 1. The block sticks up to s = 1/2; then `k x = s - 1/2`. The displacement of the hook is `x + s`.
fn pulled_block(stiffness: f64) -> Case {
    let until = if stiffness < 1.0 { displacement("block", Component::X, 1.0, 1.0) } else { load_above(1.0) };
    let request = plane_model()
        .node("block", &[0.0, 0.0])
        .node("hook", &[1.0, 0.0])
        .support("hook", &[Component::Y])
        .spring(&["block"], [[stiffness, 0.0], [0.0, stiffness]])
        .bar("block", "hook", 1.0)
        .floor()
        .contact("block", "floor", 0.5)
        .stage("press", &[("block", [0.0, -1.0])], load_above(1.0))
        .stage("pull", &[("hook", [1.0, 0.0])], until)
        .request();
    Case::new("soft-structure", format!("block on a spring of {stiffness:e}"), request).exact(1e-10, move |path| {
        let states = of_stage(path, "pull").map(|increment| {
            let (x, s) = (moved(increment, "block", 0), increment.load_factor);
            worse(relative(stiffness * x, (s - 0.5).max(0.0), 1.0), relative(moved(increment, "hook", 0), x + s, 1.0))
        });
        let loads: Vec<f64> = changes(path).map(|point| relative(point.load_factor, 0.5, 0.0)).collect();
        if loads.len() == 1 { worse(worst(states), loads[0]) } else { f64::INFINITY }
    })
}

/// Klarbring's node (μ = 0.8: the load rises during slip) beside a node with R times the stiffness and the forces. Both
/// nodes have the same motion. The tolerance of each node is 1e-10 of its own forces.
fn side_by_side(ratio: f64) -> Case {
    let first = KlarbringSolution { friction: 0.8, ..KlarbringSolution::PUBLISHED };
    let second = first.in_units(1.0, ratio);
    let request = plane_model()
        .node("first", &[0.0, 0.0])
        .node("second", &[1.0, 0.0])
        .spring(&["first"], first.stiffness())
        .spring(&["second"], second.stiffness())
        .floor()
        .contact("first", "floor", first.friction)
        .contact("second", "floor", second.friction)
        .stage("press", &[("first", [0.0, -first.press]), ("second", [0.0, -second.press])], load_above(1.0))
        .stage("pull", &[("first", [first.pull, 0.0]), ("second", [second.pull, 0.0])], load_above(2.0))
        .request();
    Case::new("soft-structure", format!("two nodes, forces 1 : {ratio:e}"), request).exact(1e-10, move |path| {
        worst(of_stage(path, "pull").map(|increment| {
            worse(first.error_at(increment, "first", 0..1), second.error_at(increment, "second", 1..2))
        }))
    })
}

/// Two one-bar trusses; the second has R times the stiffness and the forces of the first. Both trusses have the same
/// motion, each by separate nonlinear equations. The stage ends before the limit point, which both trusses reach at the
/// same load.
fn trusses_side_by_side(ratio: f64) -> Case {
    let truss = OneBarSolution::with_friction(0.3);
    let mut request = truss
        .make()
        .node("other pin", &[10.0, truss.height])
        .node("other tip", &[10.0 - truss.start, 0.0])
        .support("other pin", &[Component::X, Component::Y])
        .bar("other pin", "other tip", ratio)
        .contact("other tip", "floor", truss.friction)
        .load_scale(1.0);
    request.0.model.stages.clear();
    let pull = [("tip", [1.0, 0.0]), ("other tip", [ratio, 0.0])];
    let request = request.stage("push", &pull, displacement("tip", Component::X, 0.9, 1.0)).request();
    let name = format!("two trusses, forces 1 : {ratio:e}");
    Case::new("soft-structure", name, request).by(AUTO).exact(1e-10, move |path| {
        worst(path.iter().skip(1).map(|increment| {
            let (tip, other) = (moved(increment, "tip", 0), moved(increment, "other tip", 0));
            let pressed = |contact: usize| increment.contacts[contact].normal_reaction;
            let same = worse((tip - other).abs(), (pressed(0) - pressed(1) / ratio).abs());
            worse(same, relative(increment.load_factor, truss.load(tip), 0.1))
        }))
    })
}

/// Two collinear bars of EA = 1. The second bar has length d, and its end is on the floor (μ = 1/2, pressed by 1). From
/// s = 1/2 on, `u_middle = s - 1/2`, and the second bar elongates by `(s - 1/2) d`.
fn near_nodes(distance: f64) -> Case {
    let request = plane_model()
        .node("pin", &[-1.0, 0.0])
        .node("middle", &[0.0, 0.0])
        .node("end", &[distance, 0.0])
        .support("pin", &[Component::X, Component::Y])
        .support("middle", &[Component::Y])
        .bar("pin", "middle", 1.0)
        .bar("middle", "end", 1.0)
        .floor()
        .contact("end", "floor", 0.5)
        .stage("press", &[("end", [0.0, -1.0])], load_above(1.0))
        .stage("pull", &[("end", [1.0, 0.0])], load_above(1.0))
        .request();
    Case::new("near-nodes", format!("a distance {distance:e} apart"), request).exact(1e-10, move |path| {
        worst(of_stage(path, "pull").map(|increment| {
            let force = (increment.load_factor - 0.5).max(0.0);
            let (middle, end) = (moved(increment, "middle", 0), moved(increment, "end", 0));
            worse((middle - force).abs(), (end - middle - force * distance).abs())
        }))
    })
}

/// Two bars (EA = 1) from (0, ±w/2) to a tip at (1, 0) under the transverse force `w² s`. At the transverse
/// displacement v, the axial displacement u follows from `Σ N_i cos_i = 0`, and then `w² s = Σ N_i sin_i`. Both sums
/// cancel to the order `w²` and are therefore computed with twice the digits. With
/// `q_i = 2 u + u² + v² ± w v = L_i² - L0²`, the bar forces are `N_i = q_i/(L0 (L_i + L0))`.
fn slender(width: f64) -> Case {
    let request = plane_model()
        .node("upper", &[0.0, 0.5 * width])
        .node("lower", &[0.0, -0.5 * width])
        .node("tip", &[1.0, 0.0])
        .support("upper", &[Component::X, Component::Y])
        .support("lower", &[Component::X, Component::Y])
        .bar("upper", "tip", 1.0)
        .bar("lower", "tip", 1.0)
        .stage("push", &[("tip", [0.0, width * width])], displacement("tip", Component::Y, 0.1, 1.0))
        .request();
    Case::new("slender-triangle", format!("width {width:e} of its length"), request)
        .by(AUTO)
        .ends(StopReason::StagesCompleted)
        .exact(1e-10, move |path: &[Increment]| {
            let largest = 0.1_f64;
            worst(path.iter().skip(1).map(|increment| {
                let (u, s) = slender_load(width, moved(increment, "tip", 1));
                worse((moved(increment, "tip", 0) - u).abs(), relative(increment.load_factor, s, largest))
            }))
        })
}

/// `u` and `s` at a transverse displacement.
fn slender_load(width: f64, drop: f64) -> (f64, f64) {
    let (v, half) = (TwoFloat::from(drop), TwoFloat::from(0.5 * width));
    let rest = (half * half + 1.0).sqrt();
    let forces = |u: TwoFloat| {
        [half, -half].map(|half| {
            let grown = u * 2.0 + u * u + v * v + half * v * 2.0;
            let length = (rest * rest + grown).sqrt();
            let axial = grown / (rest * (length + rest));
            (axial * (u + 1.0) / length, axial * (v + half) / length)
        })
    };
    let along = |u: TwoFloat| {
        let [first, second] = forces(u);
        first.0 + second.0
    };
    // Newton's method with the constant axial stiffness of both bars; each iteration reduces the error by a factor v².
    let mut u = TwoFloat::from(0.0);
    for _ in 0..60 {
        u -= along(u) * 0.5;
    }
    let [first, second] = forces(u);
    let load = (first.1 + second.1) / (TwoFloat::from(width) * width);
    (u.into(), load.into())
}
