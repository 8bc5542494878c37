//! Scenes of plane beams with more and more elements: each error falls at the order that the elements claim.

use crate::check::scenes::beams::{
    ArchPoint, BeamSection, ColumnBetweenWalls, DeadForce, DeepArch, DraggedTip, LeeFrame, RoughArch, SnapFit,
    SqueezedRing, roll_up,
};
use crate::check::verify::case::{AUTO, BOTH, Case};
use crate::check::verify::compare::{changes, moved, of_stage, points, relative, worse, worst};
use crate::model::JobRequest;
use crate::result::increment::PointKind::{NonsmoothLimit, SmoothLimit};
use crate::result::increment::{ContactState, Increment, Status};
use serde_json::{Value, json};

/// EA R²/EI: a slenderness of 100.
const AXIAL: f64 = 1e4;

/// Every case. The bars are twice the errors that the order of the elements leaves from the coarsest mesh's.
pub fn cases() -> Vec<Case> {
    [arches(), frames(), pressed(), sliding()].into_iter().flatten().flatten().collect()
}

/// A scene with a number of elements, its last stage ending so.
struct Mesh {
    family: &'static str,
    elements: usize,
    model: Value,
    until: Option<Value>,
    /// Bar of the coarsest mesh, its number of elements, and the order with which the bars fall.
    bar: (f64, usize, i32),
}

impl Mesh {
    /// The case with an error; `None` if the model is none, which the tests of this file exclude.
    fn case(self, what: &str, error: impl Fn(&[Increment]) -> f64 + Send + Sync + 'static) -> Option<Case> {
        let Self { family, elements, mut model, until, bar: (bar, coarsest, order) } = self;
        if let (Some(until), Some(stages)) = (until, model["stages"].as_array_mut()) {
            stages.last_mut()?["until"] = until;
        }
        let analysis = json!({"max_increments": 5000});
        let request: JobRequest = serde_json::from_value(json!({"model": model, "analysis": analysis})).ok()?;
        let bar = bar * (coarsest as f64 / elements as f64).powi(order);
        let with_contacts = !request.model.contacts.is_empty();
        // The program of an increment is dense, and without contact it is Newton's method.
        let methods = if with_contacts && elements == coarsest { BOTH } else { AUTO };
        let what = format!("{what}, {elements} element{}", if elements == 1 { "" } else { "s" });
        Some(Case::new(family, what, request).by(methods).exact(bar, error))
    }
}

fn limit_points(count: u64) -> Option<Value> {
    Some(json!({"limit_points": count}))
}

fn load_above(bound: f64) -> Option<Value> {
    Some(json!({"load_above": bound}))
}

/// Error of an arch's point, of its load and its drop.
fn of_arch(found: Option<ArchPoint>, exact: Option<ArchPoint>) -> f64 {
    let (Some(found), Some(exact)) = (found, exact) else { return f64::INFINITY };
    worse(relative(found.load, exact.load, 0.0), relative(found.drop, exact.drop, 0.0))
}

fn arches() -> Vec<Option<Case>> {
    let mut cases = Vec::new();
    let arch = RoughArch::right(0.8, AXIAL);
    for elements in [5, 10, 20, 40] {
        let mesh = |model: Value, bar: f64| Mesh {
            family: "rough-arch",
            elements,
            model,
            until: limit_points(2),
            bar: (bar, 5, 4),
        };
        cases.push(mesh(arch.model(elements), 2e-4).case("onset, load minimum", move |path| {
            let at = |point: &Increment| ArchPoint { load: point.load_factor, drop: -moved(point, "n0", 1) };
            let onset = of_arch(points(path, NonsmoothLimit).next().map(at), arch.onset());
            worse(onset, of_arch(points(path, SmoothLimit).next().map(at), arch.minimum()))
        }));
        let mut driven = arch.model(elements);
        driven["supports"]["n0"] = json!(["x", "y", "rz"]);
        driven["stages"] = json!([{"name": "press", "displacements": {"n0": [0, -1, 0]}}]);
        cases.push(mesh(driven, 2e-4).case("turn of the drop", move |path| {
            let at = |point: &Increment| {
                let force = point.supports.get("n0").and_then(|force| force.get(1)).copied();
                ArchPoint { load: -2.0 * force.unwrap_or(f64::NAN), drop: point.load_factor }
            };
            let onset = of_arch(points(path, NonsmoothLimit).next().map(at), arch.onset());
            let turn = points(path, SmoothLimit).next().map(at);
            let exact = arch.turn_of_drop();
            // An extremum's place is less precise than its value.
            let (Some(turn), Some(exact)) = (turn, exact) else { return f64::INFINITY };
            worse(onset, worse(relative(turn.drop, exact.drop, 0.0), relative(turn.load, exact.load, 0.0)))
        }));
    }
    for elements in [5, 10, 20] {
        let deep = DeepArch { axial: AXIAL };
        let mesh = Mesh {
            family: "deep-arch",
            elements: 4 * elements,
            model: deep.model(elements),
            until: limit_points(1),
            bar: (1.3e-3, 20, 4),
        };
        cases.push(mesh.case("first limit point", move |path| {
            let crown = DeepArch::crown(elements);
            let at = |point: &Increment| ArchPoint { load: point.load_factor, drop: -moved(point, &crown, 1) };
            of_arch(points(path, SmoothLimit).next().map(at), deep.maximum())
        }));
    }
    cases
}

fn frames() -> Vec<Option<Case>> {
    let mut cases = Vec::new();
    for elements in [5, 10, 20, 40] {
        let mesh = Mesh {
            family: "lee-frame",
            elements: 2 * elements,
            model: LeeFrame::PUBLISHED.model(elements),
            until: limit_points(2),
            bar: (3e-3, 10, 4),
        };
        cases.push(mesh.case("two limit points", move |path| {
            let Some(exact) = LeeFrame::PUBLISHED.limits() else { return f64::INFINITY };
            let found: Vec<&Increment> = points(path, SmoothLimit).collect();
            if found.len() != exact.len() {
                return f64::INFINITY;
            }
            worst(found.into_iter().zip(exact).map(|(point, exact)| {
                let place =
                    [0, 1].map(|k| (moved(point, &LeeFrame::loaded(elements), k) - exact.displacement[k]).abs());
                worse(relative(point.load_factor, exact.load, 0.0), worse(place[0], place[1]))
            }))
        }));
    }
    for elements in [1, 10] {
        let mesh = Mesh { family: "roll-up", elements, model: roll_up(elements), until: None, bar: (1e-9, 1, 0) };
        cases.push(mesh.case("the circle", move |path| {
            let tip = format!("n{elements}");
            worst(path.iter().skip(1).map(|point| {
                let angle = std::f64::consts::TAU * point.load_factor;
                let (sine, cosine) = angle.sin_cos();
                let exact = [sine / angle - 1.0, (1.0 - cosine) / angle, angle];
                worst((0..3).map(|k| (moved(point, &tip, k) - exact[k]).abs()))
            }))
        }));
    }
    for (what, section) in [
        ("slender", BeamSection::slender(1e6)),
        ("with shear", BeamSection { axial: 1e2, bending: 1.0, shear_flexibility: 1.0 / 40.0 }),
    ] {
        for elements in [4, 8, 16] {
            let cantilever = DeadForce { section, force: 10.0 };
            let model = cantilever.model(elements);
            let mesh = Mesh { family: "dead-end-force", elements, model, until: None, bar: (1.6e-3, 4, 4) };
            cases.push(mesh.case(&format!("tip, {what}"), move |path| {
                let (Some(end), Some(exact)) = (path.last(), cantilever.tip()) else { return f64::INFINITY };
                worst((0..3).map(|k| (moved(end, &format!("n{elements}"), k) - exact[k]).abs()))
            }));
        }
    }
    cases
}

/// Sum of the normal reactions of an obstacle.
fn pressed_on(increment: &Increment, obstacle: &str) -> f64 {
    let on = |contact: &&ContactState| &*contact.obstacle == obstacle;
    increment.contacts.iter().filter(on).map(|contact| contact.normal_reaction).sum()
}

fn pressed() -> Vec<Option<Case>> {
    let mut cases = Vec::new();
    for friction in [0.0, 0.3, 1.0] {
        for elements in [8, 16] {
            let ring = SqueezedRing { friction, axial: AXIAL };
            let model = ring.model(elements);
            let mesh = Mesh { family: "squeezed-ring", elements, model, until: load_above(0.55), bar: (6e-5, 8, 4) };
            cases.push(mesh.case(&format!("force, friction {friction}"), move |path| {
                worst(path.iter().skip(1).map(|point| {
                    let exact = ring.force(point.load_factor).unwrap_or(f64::NAN);
                    worse(
                        relative(pressed_on(point, "floor"), exact, 0.0),
                        relative(pressed_on(point, "ceiling"), exact, 0.0),
                    )
                }))
            }));
        }
    }
    let column = ColumnBetweenWalls { gap: 0.01, axial: 1e6 };
    for elements in [8, 16, 32] {
        let mesh = |until: f64, bar: (f64, usize, i32)| Mesh {
            family: "column-between-walls",
            elements,
            model: column.model(elements),
            until: load_above(until),
            bar,
        };
        cases.push(mesh(10.0, (7e-4, 8, 4)).case("wall's force", move |path| {
            let Some(end) = path.last() else { return f64::INFINITY };
            let exact = column.wall_force(ColumnBetweenWalls::load(end.load_factor)).unwrap_or(f64::NAN);
            relative(pressed_on(end, "right"), exact.abs(), 0.0)
        }));
        // Nodes touch one after another: the load is that of a stretch of one element.
        cases.push(mesh(40.0, (0.4, 8, 1)).case("line contact", move |path| {
            let of_load: Vec<Increment> = of_stage(path, "load").cloned().collect();
            let found = changes(&of_load).next().map_or(f64::NAN, |point| ColumnBetweenWalls::load(point.load_factor));
            relative(found, column.line_contact().unwrap_or(f64::NAN), 0.0)
        }));
    }
    cases
}

fn sliding() -> Vec<Option<Case>> {
    let mut cases = Vec::new();
    let dragged = DraggedTip { slant: 1.0, friction: 0.4, rise: 0.1, axial: AXIAL };
    for elements in [4, 8, 16] {
        let model = dragged.model(elements);
        let mesh = Mesh { family: "dragged-tip", elements, model, until: None, bar: (1.2e-4, 4, 4) };
        cases.push(mesh.case("raised, dragged", move |path| {
            let tip = format!("n{elements}");
            worst([("rise", -1.0), ("drag", 1.0)].into_iter().map(|(stage, sign)| {
                let (Some(end), Some(exact)) = (of_stage(path, stage).last(), dragged.slipping(sign)) else {
                    return f64::INFINITY;
                };
                let place = worst((0..2).map(|k| (moved(end, &tip, k) - exact.displacement[k]).abs()));
                worse(place, relative(end.contacts[0].normal_reaction, exact.reaction, 0.0))
            }))
        }));
    }
    let hook = SnapFit { friction: 0.2, axial: AXIAL };
    for elements in [10, 20, 40] {
        let model = hook.model(elements);
        let mesh = Mesh { family: "snap-fit", elements, model, until: None, bar: (2e-7, 10, 4) };
        cases.push(mesh.case("while the hook slides", move |path| {
            let tip = SnapFit::tip(elements);
            let slides: Vec<&Increment> =
                path.iter().filter(|point| point.contacts[0].status == Status::Slip).collect();
            // Some points of them: each takes a continuation of its own.
            worst(slides.iter().step_by(slides.len().div_ceil(8).max(1)).map(|point| {
                let angle = SnapFit::angle([moved(point, &tip, 0), moved(point, &tip, 1)]);
                let Some((travel, reaction)) = hook.sliding(angle) else { return f64::INFINITY };
                let force = (point.contacts[0].normal_reaction - reaction).abs() / reaction.abs().max(1.0);
                worse((point.load_factor - travel).abs(), force)
            }))
        }));
    }
    cases
}

#[cfg(test)]
mod tests {
    /// Every scene is a request.
    #[test]
    fn no_case_is_lost() {
        let made = [super::arches(), super::frames(), super::pressed(), super::sliding()];
        assert!(made.iter().flatten().all(Option::is_some));
    }
}
