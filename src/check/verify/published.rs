//! Built-in scenes and published problems with exact solutions.

use crate::check::scenes;
use crate::check::scenes::exact::bowl::bowl_load;
use crate::check::scenes::exact::hump::Hump;
use crate::check::scenes::exact::tractrix::Tractrix;
use crate::check::scenes::exact::turning_drag::turning_drag;
use crate::check::verify::case::{AUTO, Case};
use crate::check::verify::compare::{moved, of_stage, points, relative, worse, worst};
use crate::check::verify::known::{KlarbringSolution, OneBarSolution, VonMisesSolution};
use crate::check::verify::make::{Make, space_model};
use crate::model::request::{Component, Strain, Until};
use crate::model::{self, JobRequest};
use crate::result::increment::Increment;
use crate::result::increment::PointKind::{self, ContactChange, NonsmoothLimit, SmoothBifurcation, SmoothLimit};
use crate::result::stop_reason::StopReason;

/// Every case.
pub fn cases() -> Vec<Case> {
    let mut cases = Vec::new();
    let mut add = |name: &'static str, what: &str, with: &dyn Fn(Case) -> Case| {
        if let Some(request) = built_in(name) {
            cases.push(with(Case::new(name, what, request)));
        }
    };
    for (name, friction) in [("one-bar-truss", 0.3), ("one-bar-truss-rough", 1.0)] {
        let truss = OneBarSolution::with_friction(friction);
        add(name, "loads, limit points", &|case| {
            case.ends(StopReason::Mechanism).exact(1e-10, move |path| truss.error(path))
        });
    }
    add("klarbring", "loads, corners", &|case| case.exact(1e-10, |path| KlarbringSolution::PUBLISHED.error(path)));
    add("von-mises-truss", "loads, limit points", &|case| case.by(AUTO).exact(1e-10, von_mises));
    add("arch-type-truss", "limit point, landing", &|case| case.exact(2e-8, arch));
    add("two-snapping-bars", "eight events", &|case| case.exact(1e-7, |path| events(path, TWO_BARS)));
    add("three-snapping-bars", "six events", &|case| {
        case.ends(StopReason::Mechanism).exact(1e-7, |path| events(path, THREE_BARS))
    });
    add("four-snapping-bars", "the end", &|case| case.ends(StopReason::NoDirection).exact(1e-6, end_of_four));
    add("slider-chain", "slips one after another", &|case| case.ends(StopReason::Mechanism).exact(1e-10, sliders));
    add("hump", "loads, reactions", &|case| case.exact(1e-10, hump));
    add("bowl", "loads", &|case| case.exact(1e-10, bowl));
    add("curving-slip", "track and loads, at steps of 0.02", &|case| case.exact(1e-6, tractrix));
    add("turning-drag", "track, at steps of 0.02", &|case| case.exact(1e-5, drag));
    add("closed-loop", "places, loads, return", &|case| case.by(AUTO).ends(StopReason::Cycle).exact(1e-8, closed_loop));
    cases.push(
        Case::new("twelve-bar-truss", "four limit loads, and their mirror images", twelve_bars()).by(AUTO).exact(
            2e-6,
            |path| {
                let exact = [0.059145, -0.043884, 0.071019, -0.082531, 0.082531, -0.071019, 0.043884, -0.059146];
                in_order(points(path, SmoothLimit), &exact)
            },
        ),
    );
    cases.push(Case::new("star-dome", "first limit load, double bifurcation", star_dome()).by(AUTO).exact(1e-9, dome));
    cases
}

/// The request of a built-in scene.
fn built_in(name: &str) -> Option<JobRequest> {
    model::decode::decode(scenes::find(name)?.request.as_bytes()).ok()
}

/// The largest difference between the loads of points and the exact loads, in order; infinite if the numbers differ.
fn in_order<'a>(found: impl Iterator<Item = &'a Increment>, exact: &[f64]) -> f64 {
    let found: Vec<&Increment> = found.collect();
    if found.len() != exact.len() {
        return f64::INFINITY;
    }
    worst(found.iter().zip(exact).map(|(point, load)| (point.load_factor - load).abs()))
}

fn von_mises(path: &[Increment]) -> f64 {
    let truss = VonMisesSolution { height: 0.5 };
    let largest = truss.load(truss.height - truss.height_at_limit());
    let loads =
        path.iter().map(|increment| relative(increment.load_factor, truss.load(-moved(increment, "apex", 1)), largest));
    worse(worst(loads), in_order(points(path, SmoothLimit), &[largest, -largest]))
}

/// Drops and loads of the formulation, to the digits given there.
fn arch(path: &[Increment]) -> f64 {
    let of = |kind: PointKind, drop: f64, load: f64| {
        let mut found = points(path, kind);
        match (found.next(), found.next()) {
            (Some(point), None) => worse((-moved(point, "b2", 1) - drop).abs(), (point.load_factor - load).abs()),
            _ => f64::INFINITY,
        }
    };
    worse(of(SmoothLimit, 0.42302607, 0.0095675907), of(NonsmoothLimit, 0.5, 0.0093190033))
}

struct PublishedEvent {
    kind: PointKind,
    load: f64,
    tips: &'static [f64],
}

const fn event(kind: PointKind, load: f64, tips: &'static [f64]) -> PublishedEvent {
    PublishedEvent { kind, load, tips }
}

/// Events from exhaustive enumeration (formulation, section 4).
const TWO_BARS: &[PublishedEvent] = &[
    event(SmoothLimit, 0.28211874, &[]),
    event(ContactChange, 0.25042031, &[1.31698808, 1.06627516]),
    event(SmoothLimit, 0.08721128, &[]),
    event(NonsmoothLimit, 0.09224095, &[2.23442837, 1.06627516]),
    event(ContactChange, 0.05832719, &[2.38308791, 1.38577675]),
    event(SmoothLimit, -0.13090421, &[]),
    event(NonsmoothLimit, -0.12007282, &[2.38308791, 2.42049680]),
    event(SmoothLimit, -0.12023872, &[]),
];

const THREE_BARS: &[PublishedEvent] = &[
    event(SmoothLimit, 0.28149415, &[]),
    event(ContactChange, 0.27788274, &[1.12049462, 1.00538708, 0.92552688]),
    event(ContactChange, 0.25572830, &[1.30940240, 1.03835228, 0.92552688]),
    event(ContactChange, 0.09286408, &[2.02446326, 1.03835228, 0.92552688]),
    event(NonsmoothLimit, 0.08885569, &[2.12492647, 1.03835228, 0.84049798]),
    event(ContactChange, 0.10141537, &[2.30487757, 1.03835228, 0.84049798]),
];

fn events(path: &[Increment], exact: &[PublishedEvent]) -> f64 {
    let is_event =
        |increment: &&Increment| matches!(increment.point.kind, SmoothLimit | NonsmoothLimit | ContactChange);
    let found: Vec<&Increment> = path.iter().filter(is_event).take(exact.len()).collect();
    if found.len() != exact.len() {
        return f64::INFINITY;
    }
    worst(found.iter().zip(exact).map(|(point, exact)| {
        if point.point.kind != exact.kind {
            return f64::INFINITY;
        }
        let tips = exact.tips.iter().enumerate();
        let tips = tips.map(|(tip, x)| (moved(point, &format!("tip{tip}"), 0) - x).abs());
        tips.fold((point.load_factor - exact.load).abs(), worse)
    }))
}

fn end_of_four(path: &[Increment]) -> f64 {
    let Some(end) = path.last() else { return f64::INFINITY };
    let tips = [1.912378, 1.043896, 0.916531, 0.791225];
    let tips = tips.iter().enumerate().map(|(tip, x)| (moved(end, &format!("tip{tip}"), 0) - x).abs());
    tips.fold((end.load_factor - 0.104818).abs(), worse)
}

/// Block m, counted from 0, begins to slip at `s = (m + 1) μ W`, with μ = 1/2 and W = 1.
fn sliders(path: &[Increment]) -> f64 {
    let loads: Vec<f64> = of_stage(path, "pull")
        .filter(|increment| increment.point.kind != PointKind::Regular && increment.load_factor > 0.0)
        .map(|increment| increment.load_factor)
        .collect();
    worst(
        [0.5, 1.0, 1.5, 2.0, 2.5]
            .iter()
            .map(|exact| loads.iter().map(|load| (load - exact).abs()).fold(f64::INFINITY, f64::min)),
    )
}

fn hump(path: &[Increment]) -> f64 {
    let exact = Hump::BUILT_IN;
    let start = [exact.start.sin(), exact.start.cos()];
    worst(path.iter().skip(1).map(|increment| {
        let (x, y) = (start[0] + moved(increment, "tip", 0), start[1] + moved(increment, "tip", 1));
        let angle = x.atan2(y);
        let reaction = (increment.contacts[0].normal_reaction - exact.normal_reaction(angle)).abs();
        worse(worse((x.hypot(y) - 1.0).abs(), (increment.load_factor - exact.load(angle)).abs()), reaction)
    }))
}

fn bowl(path: &[Increment]) -> f64 {
    worst(of_stage(path, "push").map(|increment| {
        let (x, height) = (moved(increment, "node", 0), 1.0 - moved(increment, "node", 1));
        if increment.load_factor <= 0.2 {
            return x.abs();
        }
        worse((x.hypot(height) - 1.0).abs(), relative(increment.load_factor, bowl_load(0.1, 0.2, x.atan2(height)), 0.0))
    }))
}

fn tractrix(path: &[Increment]) -> f64 {
    let exact = Tractrix::BUILT_IN;
    worst(path.iter().skip(1).map(|increment| {
        let (x, y) = (exact.start + moved(increment, "tip", 0), moved(increment, "tip", 1));
        worse(exact.distance(x, y), (increment.load_factor - exact.load(x, y)).abs())
    }))
}

fn drag(path: &[Increment]) -> f64 {
    let turn = 0.8_f64.atan2(0.6);
    worst(of_stage(path, "across").map(|increment| {
        let exact = turning_drag(0.5, turn, increment.load_factor);
        worse((moved(increment, "block", 0) - exact[0]).abs(), (moved(increment, "block", 1) - exact[1]).abs())
    }))
}

/// Two bars with Green strain under a constant weight p = 0.018, pushed sideways (EA = 1, h = 1/2, L0² = 5/4,
/// `q = p L0³`): `x² = h² - y² - q/y`, `s = x (2 - q/y)/L0³`. The path returns to s = 0.
fn closed_loop(path: &[Increment]) -> f64 {
    let cube = 1.25_f64.powf(1.5);
    let q = 0.018 * cube;
    let states = of_stage(path, "push").map(|increment| {
        let (x, y) = (moved(increment, "apex", 0), 0.5 + moved(increment, "apex", 1));
        worse((x * x - (0.25 - y * y - q / y)).abs(), (increment.load_factor - x * (2.0 - q / y) / cube).abs())
    });
    let back = path.last().map_or(f64::INFINITY, |end| worse(end.load_factor.abs(), moved(end, "apex", 0).abs()));
    worse(worst(states), back)
}

fn limit_points(count: u64) -> Option<Until> {
    Some(Until { limit_points: Some(count), ..Until::default() })
}

const SPACE: [Component; 3] = [Component::X, Component::Y, Component::Z];

/// The 12-bar space truss (Green strain, EA = 1). The exact limit loads have the published digits.
fn twelve_bars() -> JobRequest {
    let nodes = [
        [-1.697, -1.0, 0.0],
        [0.0, -1.0, 0.0],
        [1.697, -1.0, 0.0],
        [-1.414, 0.0, 1.0],
        [0.0, 0.0, 1.0],
        [1.414, 0.0, 1.0],
        [-1.697, 1.0, 0.0],
        [0.0, 1.0, 0.0],
        [1.697, 1.0, 0.0],
    ];
    let bars = [(4, 1), (4, 7), (6, 3), (6, 9), (5, 1), (5, 2), (5, 3), (5, 4), (5, 6), (5, 7), (5, 8), (5, 9)];
    let name = |number: usize| format!("n{number}");
    let make = nodes.iter().enumerate().fold(space_model(), |make, (index, place)| make.node(&name(index + 1), place));
    let make = [1, 2, 3, 7, 8, 9].iter().fold(make, |make, number| make.support(&name(*number), &SPACE));
    let make = bars.iter().fold(make, |make, (first, second)| make.bar(&name(*first), &name(*second), 1.0));
    let forces = [("n4", [0.0, 0.0, -1.5]), ("n5", [0.0, 0.0, -1.0]), ("n6", [0.0, 0.0, -1.5])];
    make.strain(Strain::Green).stage("load", &forces, limit_points(8)).request()
}

/// The 24-bar star dome (Green strain, EA = 1).
fn star_dome() -> JobRequest {
    let place = |radius: f64, degrees: f64, z: f64| {
        [radius * degrees.to_radians().cos(), radius * degrees.to_radians().sin(), z]
    };
    let mut make: Make = space_model().node("apex", &[0.0, 0.0, 8.216]);
    for k in 0..6 {
        make = make
            .node(&format!("ring{k}"), &place(25.0, 60.0 * f64::from(k), 6.216))
            .node(&format!("base{k}"), &place(50.0, 30.0 + 60.0 * f64::from(k), 0.0))
            .support(&format!("base{k}"), &SPACE);
    }
    for k in 0..6 {
        let (ring, next, base) = (format!("ring{k}"), format!("ring{}", (k + 1) % 6), format!("base{k}"));
        make = make.bar("apex", &ring, 1.0).bar(&ring, &next, 1.0).bar(&ring, &base, 1.0).bar(&next, &base, 1.0);
    }
    make.strain(Strain::Green).stage("load", &[("apex", [0.0, 0.0, -1.0])], limit_points(4)).request()
}

/// The first limit load and drop result from the minimisation of the two-parameter symmetric problem in 20-digit
/// arithmetic, the double bifurcation from bisection on the smallest eigenvalue of the tangent stiffness (see
/// `tests/solver/published.rs`).
fn dome(path: &[Increment]) -> f64 {
    let at = |point: Option<&Increment>, load: f64, drop: f64| {
        let Some(point) = point else { return f64::INFINITY };
        worse(relative(point.load_factor, load, 0.0), relative(-moved(point, "apex", 2), drop, 0.0))
    };
    let first = points(path, SmoothLimit).next();
    let minimum = points(path, SmoothLimit).nth(1).map_or(u64::MAX, |point| point.index);
    let double = points(path, SmoothBifurcation).find(|point| point.index > minimum);
    // The drop at a limit point is known only to the digits given.
    let limit = at(first, 3.155799708e-4, 0.76855727);
    worse(0.1 * limit, at(double, 76.5387152565e-4, 9.0965011515))
}
