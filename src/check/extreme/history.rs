//! Snap-back, loading cycles, stages without load, mechanisms.

use crate::check::verify::case::{AUTO, Case, ENERGY_BAR};
use crate::check::verify::compare::{bisected, moved, points, relative, worse, worst};
use crate::check::verify::known::{OneBarSolution, VonMisesSolution};
use crate::check::verify::make::{NO_FORCES, displacement, load_above, plane_model};
use crate::model::request::Component;
use crate::result::increment::{Increment, PointKind};
use crate::result::stop_reason::StopReason;

pub fn cases() -> Vec<Case> {
    let mut cases = Vec::new();
    for part in [2.0, 1.0, 1.0 - 1e-9, 0.5, 1e-3, 1e-4, 1e-5, 1e-6] {
        cases.push(snap_back(part, true));
        cases.push(snap_back(part, false));
    }
    cases.extend([cycle(10, 100), cycle(1000, 100), breathing(10, 100), breathing(1000, 100)]);
    cases.extend(without_load());
    cases.extend(mechanisms());
    cases
}

/// The von Mises truss (h = 1/2) with a spring of stiffness k on its apex. The top of the spring is pushed down by q:
/// `q = v + P(v)/k`. At `v = h` the tangent stiffness of the truss is lowest, `dP/dv = -2 (1 - 1/L0)`. At this point q
/// has a vertical tangent for `k = 2 (1 - 1/L0)`, and q snaps back for softer springs. The path is driven by q or by
/// the force. If k is at most 1e-5 of the critical stiffness, the limit point is a cusp: q, which is 1e4 or more,
/// reverses within a radius of the order of the ratio `part` of the stiffnesses, and the path may end there with
/// `step_underflow`.
fn snap_back(part: f64, driven: bool) -> Case {
    let truss = VonMisesSolution { height: 0.5 };
    let stiffness = part * 2.0 * (1.0 - 1.0 / 0.5_f64.hypot(1.0));
    let make = truss
        .make()
        .node("top", &[0.0, 1.5])
        .support("apex", &[Component::X])
        .spring(&["top", "apex"], [[0.0, 0.0], [0.0, stiffness]])
        .longest_step(0.05 / stiffness.min(0.1))
        .shortest_step(1e-13);
    let until = VonMisesSolution::down(1.1);
    let request = if driven {
        make.support("top", &[Component::X, Component::Y]).stage("push", &NO_FORCES, until).driven("top", [0.0, -1.0])
    } else {
        make.support("top", &[Component::X]).stage("push", &[("top", [0.0, -1.0])], until)
    };
    let how = if driven { "driven by its end" } else { "under a force" };
    let name = format!("spring of {part} of the critical one, {how}");
    let case = Case::new("snap-back", name, request.request()).by(AUTO);
    let is_cusp = part <= 1e-5;
    let case = if is_cusp { case.or_ends(StopReason::StepUnderflow) } else { case };
    case.exact(1e-10, move |path| {
        let drop_of_top = |v: f64| v + truss.load(v) / stiffness;
        let far = 0.04 / stiffness + 1.0;
        let states = worst(path.iter().skip(1).map(|increment| {
            let v = -moved(increment, "apex", 1);
            let q = relative(-moved(increment, "top", 1), drop_of_top(v), far);
            let load = if driven { 0.0 } else { (increment.load_factor - truss.load(v)).abs() };
            worse(q, load)
        }));
        let slope = |v: f64| if driven { 1.0 + truss.slope(v) / stiffness } else { truss.slope(v) };
        let cells = 4000;
        let place = |cell: i32| 1.1 * f64::from(cell) / f64::from(cells);
        let limits: Vec<f64> = (0..cells)
            .filter(|cell| (slope(place(*cell)) < 0.0) != (slope(place(cell + 1)) < 0.0))
            .map(|cell| bisected(slope, place(cell), place(cell + 1)))
            .collect();
        let found: Vec<&Increment> = points(path, PointKind::SmoothLimit).collect();
        // At the critical stiffness the two limit points coincide, and q has no extremum.
        let close_to_critical = driven && (part - 1.0).abs() < 1e-6;
        let known = found.len() == limits.len() || (is_cusp && found.len() < limits.len());
        if !known && !close_to_critical {
            return f64::INFINITY;
        }
        let places = found.iter().zip(&limits).map(|(point, v)| 1e-2 * (-moved(point, "apex", 1) - v).abs());
        let places = places.fold(0.0, worse);
        worse(states, if close_to_critical { 0.0 } else { places })
    })
}

/// A node on a unit spring on the floor (μ = 1/2), pressed by 1 and then pulled back and forth by forces ±1. The node
/// comes to rest at `±1/2` after each stroke. The first stroke slips by 1/2, and every further stroke slips by 1,
/// against the friction force 1/2.
fn cycle(strokes: usize, increments: usize) -> Case {
    let mut make = plane_model()
        .node("node", &[0.0, 0.0])
        .spring(&["node"], [[1.0, 0.0], [0.0, 1.0]])
        .floor()
        .contact("node", "floor", 0.5)
        .stage("press", &[("node", [0.0, -1.0])], load_above(1.0))
        .stage("forth", &[("node", [1.0, 0.0])], load_above(1.0));
    for stroke in 1..strokes - 1 {
        let sign = if stroke % 2 == 1 { -1.0 } else { 1.0 };
        make = make.stage(&format!("stroke {stroke}"), &[("node", [sign, 0.0])], load_above(2.0));
    }
    let request = make.longest_step(1.35 / increments as f64).most_increments(1_000_000).request();
    let mut case = Case::new("loading-cycle", format!("stick and slip, {strokes} strokes"), request).by(AUTO).exact(
        1e-10,
        move |path| {
            worst(ends(path).enumerate().skip(1).map(|(stroke, end)| {
                let sign = if stroke % 2 == 1 { 1.0 } else { -1.0 };
                let slid = 0.5 + (stroke - 1) as f64;
                worse((moved(end, "node", 0) - sign * 0.5).abs(), relative(end.energy.dissipated, 0.5 * slid, 0.0))
            }))
        },
    );
    case.long = strokes > 100;
    case
}

/// The von Mises truss (h = 1/2), loaded to s = 0.03 (the limit load is 0.038) and unloaded, repeatedly. After each
/// unloading the apex is back at its initial position, and the external work is recovered. The work is compared with
/// the tolerance of energies, which is wider than that of displacements.
fn breathing(strokes: usize, increments: usize) -> Case {
    let truss = VonMisesSolution { height: 0.5 };
    let mut make = truss.make();
    for stroke in 0..strokes {
        let sign = if stroke % 2 == 0 { -1.0 } else { 1.0 };
        make = make.stage(&format!("stroke {stroke}"), &[("apex", [0.0, sign])], load_above(0.03));
    }
    let request = make.longest_step(0.11 / increments as f64).most_increments(1_000_000).request();
    let mut case =
        Case::new("loading-cycle", format!("elastic, {strokes} strokes"), request).by(AUTO).exact(1e-10, move |path| {
            let most = bisected(|v| truss.load(v) - 0.03, 0.0, truss.height - truss.height_at_limit());
            worst(ends(path).enumerate().map(|(stroke, end)| {
                let exact = if stroke % 2 == 0 { -most } else { 0.0 };
                let work = if stroke % 2 == 0 { 0.0 } else { end.energy.external_work.abs() / (0.03 * most) };
                let returned = work * 1e-10 / ENERGY_BAR;
                worse((moved(end, "apex", 1) - exact).abs(), returned)
            }))
        });
    case.long = strokes > 100;
    case
}

/// The last increment of each stage.
fn ends(path: &[Increment]) -> impl Iterator<Item = &Increment> {
    let last =
        |(index, increment): &(usize, &Increment)| path.get(index + 1).is_none_or(|next| next.stage != increment.stage);
    path.iter().enumerate().filter(last).map(|(_, increment)| increment)
}

/// A stage without load is refused, at any position, and the error points to the stage or to its forces.
fn without_load() -> Vec<Case> {
    let make = || {
        plane_model()
            .node("node", &[0.0, 0.0])
            .spring(&["node"], [[1.0, 0.0], [0.0, 1.0]])
            .floor()
            .contact("node", "floor", 0.5)
            .stage("press", &[("node", [0.0, -1.0])], load_above(1.0))
    };
    let zero = make().stage("nothing", &[("node", [0.0, 0.0])], load_above(1.0)).request();
    let empty = make().stage("nothing", &NO_FORCES, load_above(1.0)).request();
    vec![
        Case::new("stage-without-load", "a force of zero", zero).refused("/model/stages/1/forces"),
        Case::new("stage-without-load", "no force", empty).refused("/model/stages/1"),
    ]
}

/// Paths that end, or cannot start, because a motion meets no resistance.
fn mechanisms() -> Vec<Case> {
    // No element resists an upward motion: a force against the press of 1 lifts the node off the floor at s = 1.
    let lifted = plane_model()
        .node("node", &[0.0, 0.0])
        .spring(&["node"], [[1.0, 0.0], [0.0, 0.0]])
        .floor()
        .contact("node", "floor", 0.5)
        .stage("press", &[("node", [0.0, -1.0])], load_above(1.0))
        .stage("lift", &[("node", [0.0, 1.0])], load_above(2.0))
        .request();
    let lifted = Case::new("mechanism", "a node lifted off the floor", lifted)
        .ends(StopReason::Mechanism)
        .exact(1e-10, |path| path.last().map_or(f64::INFINITY, |end| (end.load_factor - 1.0).abs()));
    // Along x only friction resists: the block slides at s = μ = 1/2.
    let pushed = plane_model()
        .node("node", &[0.0, 0.0])
        .spring(&["node"], [[0.0, 0.0], [0.0, 1.0]])
        .floor()
        .contact("node", "floor", 0.5)
        .stage("press", &[("node", [0.0, -1.0])], load_above(1.0))
        .stage("push", &[("node", [1.0, 0.0])], load_above(2.0))
        .request();
    let pushed = Case::new("mechanism", "a block that nothing but friction holds", pushed)
        .ends(StopReason::Mechanism)
        .exact(1e-10, |path| path.last().map_or(f64::INFINITY, |end| (end.load_factor - 0.5).abs()));
    // A square of bars without a diagonal.
    let square = plane_model()
        .node("a", &[0.0, 0.0])
        .node("b", &[1.0, 0.0])
        .node("c", &[1.0, 1.0])
        .node("d", &[0.0, 1.0])
        .support("a", &[Component::X, Component::Y])
        .support("b", &[Component::X, Component::Y])
        .bar("b", "c", 1.0)
        .bar("c", "d", 1.0)
        .bar("d", "a", 1.0)
        .stage("push", &[("c", [1.0, 0.0])], load_above(1.0))
        .request();
    let square = Case::new("mechanism", "a square of bars", square).refused("/model/nodes/c");
    // At x = +a the bar of the one-bar truss is unstressed again, and its tip is free.
    let truss = OneBarSolution::with_friction(0.3);
    let unloaded = Case::new("mechanism", "a bar that is unstressed again", truss.make().request())
        .ends(StopReason::Mechanism)
        .exact(1e-9, move |path| path.last().map_or(f64::INFINITY, |end| (moved(end, "tip", 0) - 3.0).abs()));
    // Two collinear bars under a transverse force, P = 2 v (1 - 1/L): stiff only to second order. To first order the
    // structure is a mechanism, so the request is refused.
    let line = plane_model()
        .node("left", &[-1.0, 0.0])
        .node("middle", &[0.0, 0.0])
        .node("right", &[1.0, 0.0])
        .support("left", &[Component::X, Component::Y])
        .support("right", &[Component::X, Component::Y])
        .bar("left", "middle", 1.0)
        .bar("middle", "right", 1.0)
        .stage("push", &[("middle", [0.0, 1.0])], displacement("middle", Component::Y, 0.5, 1.0))
        .request();
    let line = Case::new("mechanism", "two bars on a line", line).refused("/model/nodes/middle");
    vec![lifted, pushed, square, unloaded, line]
}
