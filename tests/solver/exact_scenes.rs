//! Scenes with exact solutions: every point, every event, in both methods. Rows of snapping bars and more are among the
//! cases of `verify`, which a test of its own runs.

use crate::common::paths::{close, scene, trace};
use arcslip::model::JobRequest;
use arcslip::model::request::Method;
use arcslip::result::increment::{Increment, PointKind, Status};
use arcslip::result::stop_reason::StopReason;

const METHODS: [Method; 2] = [Method::Auto, Method::Mpec];

fn with(mut request: JobRequest, method: Method) -> JobRequest {
    request.analysis.method = method;
    request
}

fn limits(increments: &[Increment], kind: PointKind) -> Vec<&Increment> {
    increments.iter().filter(|increment| increment.point.kind == kind).collect()
}

/// The slipping branch of the one-bar truss: `s = P (μ h - x)/L`, `P = EA (1 - L/L0)`, with EA = h = 1, a = 1.5.
fn one_bar_load(friction: f64, x: f64) -> f64 {
    let (length, rest) = (x.hypot(1.0), 1.5_f64.hypot(1.0));
    (1.0 - length / rest) * (friction - x) / length
}

/// Scene, friction, and the places and loads of both limit points.
type OneBar = (&'static str, f64, [(f64, f64); 2]);

/// Limit points of that branch: zeros of `ds/dx`, from 30-digit arithmetic.
const ONE_BAR_LIMITS: [OneBar; 2] = [
    ("one-bar-truss", 0.3, [(-0.557709058500982, 0.2733153855772578), (0.8506427737191122, -0.1139816591452569)]),
    ("one-bar-truss-rough", 1.0, [(-0.3439878262095172, 0.525388017529103), (1.23899488443231, -0.01753282676883096)]),
];

#[test]
fn one_bar_truss() {
    for (name, friction, exact_limits) in ONE_BAR_LIMITS {
        for method in METHODS {
            let (increments, report) = trace(&with(scene(name), method));
            assert_eq!(report.stop_reason, StopReason::Mechanism, "{name}");
            let last = increments.last().unwrap();
            assert_eq!(last.point.kind, PointKind::End);
            close(last.displacements["tip"][0], 3.0, 1e-9, "end of the path");
            let found = limits(&increments, PointKind::SmoothLimit);
            assert_eq!(found.len(), 2, "{name}");
            for (increment, (x, s)) in found.iter().zip(exact_limits) {
                close(increment.displacements["tip"][0] - 1.5, x, 1e-8, "limit point's place");
                close(increment.load_factor, s, 1e-12, "limit point's load");
            }
            let [(rise_ends, _), (fall_ends, _)] = exact_limits;
            for increment in &increments[1..] {
                let x = increment.displacements["tip"][0] - 1.5;
                let exact = one_bar_load(friction, x);
                // At the crossing of zero the load is judged against the forces that make it up.
                let size = exact.abs().max(1e-5);
                close(increment.load_factor, exact, 1e-10 * size, "load");
                if increment.point.kind == PointKind::Regular {
                    let falling = x > rise_ends && x < fall_ends;
                    assert_eq!(increment.point.bifurcation, falling, "{name} at x = {x}");
                }
                if increment.point.bifurcation {
                    let directions = increment.directions.as_ref().expect("a bifurcation point lists directions");
                    assert!(directions.iter().any(|direction| {
                        direction.contacts == [Status::Stick] && direction.load_rate < 0.0 && !direction.taken
                    }));
                    assert_eq!(directions.iter().filter(|direction| direction.taken).count(), 1);
                }
            }
        }
    }
}

#[test]
fn klarbring() {
    for method in METHODS {
        let (increments, report) = trace(&with(scene("klarbring"), method));
        assert_eq!(report.stop_reason, StopReason::StagesCompleted);
        let held = increments.iter().find(|increment| &*increment.stage == "press" && increment.load_factor == 1.0);
        assert_eq!(held.map(|increment| increment.point.kind), Some(PointKind::End), "the load held is exactly 1");
        let corners = limits(&increments, PointKind::NonsmoothLimit);
        assert_eq!(corners.len(), 2);
        for (corner, (s, x)) in corners.iter().zip([(1.5, 0.0), (1.25, 1.25)]) {
            close(corner.load_factor, s, 1e-10, "corner's load");
            close(corner.displacements["node"][0], x, 1e-10, "corner's place");
            close(corner.displacements["node"][1], 0.0, 1e-14, "corner's height");
        }
        for increment in increments.iter().filter(|increment| &*increment.stage == "pull") {
            let (s, x, y) =
                (increment.load_factor, increment.displacements["node"][0], increment.displacements["node"][1]);
            if increment.index < corners[0].index {
                close(x, 0.0, 0.0, "stuck");
            } else if increment.index <= corners[1].index {
                close(s, 1.5 - 0.2 * x, 1e-13, "slipping");
                assert!(increment.point.bifurcation || increment.index == corners[1].index);
            } else {
                close(x, (s - 0.8) / 0.36, 1e-12 * x, "free, along");
                close(y, (0.8 * s - 1.0) / 0.36, 1e-12 * x, "free, up");
            }
        }
    }
}

/// Klarbring's node for any stiffness, friction and units: `K = [[a, -b], [-b, c]]`, pressed by `p`. Stuck to `s = μ p`;
/// slip at `u_x = x`: `r_n = p - b x`, `s = a x + μ (p - b x)`; free at `x = p/b`.
#[test]
fn klarbring_in_other_stiffnesses_and_units() {
    for (a, b, c, friction) in [(1.0, 0.8, 1.0, 1.5), (2.0, 1.5, 3.0, 1.8), (1.0, 0.9, 0.9, 4.0), (5.0, 4.0, 4.0, 1.3)]
    {
        for (length, force) in [(1.0, 1.0), (1e9, 1.0), (1e-9, 1.0), (1.0, 1e9), (1.0, 1e-9), (1e-3, 1e-6)] {
            let unit = force / length;
            let mut request = scene("klarbring");
            request.model.elements = vec![arcslip::model::request::Element::Spring {
                nodes: vec!["node".into()],
                stiffness: vec![vec![a * unit, -b * unit], vec![-b * unit, c * unit]],
                name: None,
            }];
            request.model.contacts[0].friction = friction;
            request.model.stages[0].forces.insert("node".into(), vec![0.0, -force]);
            request.model.stages[1].forces.insert("node".into(), vec![force, 0.0]);
            request.model.stages[1].until = Some(arcslip::model::request::Until {
                load_above: Some(3.0 * friction + 3.0 * a / b),
                ..Default::default()
            });
            let (increments, _) = trace(&request);
            let changes: Vec<&Increment> = increments
                .iter()
                .filter(|i| matches!(i.point.kind, PointKind::NonsmoothLimit | PointKind::ContactChange))
                .collect();
            assert_eq!(changes.len(), 2, "a {a} b {b} c {c} friction {friction} length {length} force {force}");
            close(changes[0].load_factor, friction, 1e-10, "first corner's load");
            close(changes[1].displacements["node"][0] / length, 1.0 / b, 1e-10, "second corner's place");
            close(changes[1].load_factor, a / b, 1e-10, "second corner's load");
        }
    }
}

#[test]
fn arch_type_truss() {
    for method in METHODS {
        let (increments, report) = trace(&with(scene("arch-type-truss"), method));
        assert_eq!(report.stop_reason, StopReason::StagesCompleted);
        let smooth = limits(&increments, PointKind::SmoothLimit);
        let nonsmooth = limits(&increments, PointKind::NonsmoothLimit);
        assert_eq!((smooth.len(), nonsmooth.len()), (1, 1));
        let drop = |increment: &Increment| -increment.displacements["b2"][1];
        close(drop(smooth[0]), 0.42302607, 1e-8, "crown drop at the limit point");
        close(smooth[0].load_factor, 0.0095675907, 5e-11, "load at the limit point");
        close(drop(nonsmooth[0]), 0.5, 1e-12, "crown drop at landing");
        close(nonsmooth[0].load_factor, 0.0093190033, 5e-11, "load at landing");
        for increment in &increments[1..] {
            let between = increment.index > smooth[0].index && increment.index < nonsmooth[0].index;
            if increment.point.kind == PointKind::Regular {
                assert_eq!(increment.point.bifurcation, between, "increment {}", increment.index);
            }
            if between {
                let directions = increment.directions.as_ref().expect("directions");
                assert!(directions.iter().any(|d| d.contacts[0] == Status::Stick && d.load_rate < 0.0 && !d.taken));
            }
        }
        let last = increments.last().unwrap();
        assert!(last.contacts.iter().all(|contact| contact.status == Status::Stick));
        close(last.load_factor, 0.02, 0.0, "the load at which the stage ends");
    }
}

/// Closed form, J. M. T. Thompson and G. W. Hunt's shallow-arch classic in exact rotation:
/// engineering strain `P = 2 EA (1 - cos^(2/3) α)^(3/2)`; Green strain `P = 2 EA (h/L0)³/(3√3)` at height `h/√3`.
#[test]
fn von_mises_truss() {
    use arcslip::model::request::{Element, Strain};
    for (measure, load, travel) in
        [(Strain::Engineering, 3.838374e-2, 0.222120), (Strain::Green, 3.442652e-2, 0.211325)]
    {
        let mut request = scene("von-mises-truss");
        for element in &mut request.model.elements {
            if let Element::Bar { strain, .. } = element {
                *strain = measure;
            }
        }
        let (increments, report) = trace(&request);
        assert_eq!(report.stop_reason, StopReason::StagesCompleted);
        let found = limits(&increments, PointKind::SmoothLimit);
        assert_eq!(found.len(), 2);
        close(found[0].load_factor, load, 5e-9, "maximum");
        close(-found[0].displacements["apex"][1], travel, 5e-7, "travel");
        close(found[1].load_factor, -found[0].load_factor, 1e-12, "the minimum mirrors the maximum");
        let alpha_cosine = 1.0 / 1.0_f64.hypot(0.5);
        if measure == Strain::Engineering {
            let exact = 2.0 * (1.0 - alpha_cosine.powf(2.0 / 3.0)).powf(1.5);
            close(found[0].load_factor, exact, 1e-14, "closed form");
        } else {
            let exact = 2.0 * (0.5 * alpha_cosine).powi(3) / (3.0 * 3.0_f64.sqrt());
            close(found[0].load_factor, exact, 1e-14, "closed form");
        }
        close(increments.last().unwrap().displacements["apex"][1], -1.2, 0.0, "the stage ends exactly there");
    }
}
