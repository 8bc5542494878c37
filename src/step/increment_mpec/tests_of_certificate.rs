//! The certificate of an increment compared with the search, and the conditions under which nothing may be certified.

use crate::complementarity::mpec::Problem;
use crate::complementarity::rate_search::tests::Random;
use crate::continuation::increment::mpec_verification;
use crate::continuation::path::iterator::Path;
use crate::continuation::scene::Scene;
use crate::result::increment::Increment;
use crate::step::corrector::cost_counters::Work;
use crate::step::increment_mpec::certificate;
use crate::step::increment_mpec::solution_extraction;
use crate::step::increment_mpec::*;
use crate::step::mode_step::{Reached, StepStart as Beginning};
use serde_json::{Map, json};

/// The start of an increment.
struct Begun {
    state: State,
    rate: Rate,
    modes: Vec<Mode>,
    force: f64,
}

impl Begun {
    fn reach(&self, loading: Loading<'_>, step: f64) -> Option<Box<Reached>> {
        let Self { state, rate, modes, force } = self;
        let start = Beginning {
            loading,
            state,
            rate,
            modes,
            drift: None,
            force_scale: *force,
            is_singular: false,
            beside: None,
        };
        start.reach(step, &mut Work::default()).ok()
    }

    /// The program of the increment; `None` where no contact is in reach.
    fn program<'a>(&'a self, loading: Loading<'a>, reached: &Reached) -> Option<IncrementProgram<'a>> {
        let ends = (&self.state, &reached.corrected.state);
        mpec_verification::program(loading, self.force, ends, &self.rate, reached.step)
    }

    /// The result of the certificate for the increment to a point; unclear where no contact is in reach.
    fn shown(&self, loading: Loading<'_>, reached: &Reached) -> ForeseenModes {
        let program = self.program(loading, reached);
        program.map_or(ForeseenModes::Unclear, |mut program| {
            certificate::solved_at(&mut program, arrived(reached), &self.modes)
        })
    }
}

fn arrived(reached: &Reached) -> Arrived<'_> {
    Arrived { state: &reached.corrected.state, rate: &reached.rate, error: reached.error_estimate }
}

/// A random number between 0 and 1.
fn part(random: &mut Random) -> f64 {
    0.5 * (1.0 + random.value())
}

/// Calls `look` for each increment of a path with the start of the increment.
fn each_increment(scene: &Scene, mut look: impl FnMut(Loading<'_>, &Begun, &Increment)) {
    let mut path = Path::new(scene, CancelFlag::default());
    path.next();
    loop {
        let here = &path.trace.at.here;
        let Some(rate) = here.rate.clone() else { return };
        let (state, modes, force) = (here.state.clone(), here.modes.clone(), path.trace.at.totals.force_scale);
        let begun = Begun { state, rate, modes, force };
        let Some(increment) = path.next() else { return };
        look(path.trace.loading(), &begun, &increment);
    }
}

/// A row of bars over a floor, tied to each other, some of which begin above the floor.
fn row(random: &mut Random) -> Scene {
    let bars = 1 + (3.0 * part(random)) as usize;
    let (mut nodes, mut supports, mut forces) = (Map::new(), Map::new(), Map::new());
    let (mut elements, mut contacts) = (Vec::new(), Vec::new());
    for bar in 0..bars {
        let (pin, tip) = (format!("pin{bar}"), format!("tip{bar}"));
        let place = 3.0 * bar as f64;
        let height = if part(random) < 0.3 { 0.05 * part(random) } else { 0.0 };
        nodes.insert(pin.clone(), json!([place, 1]));
        nodes.insert(tip.clone(), json!([place - 1.4 - 0.3 * part(random), height]));
        supports.insert(pin.clone(), json!(["x", "y"]));
        forces.insert(tip.clone(), json!([0.5 + part(random), -0.1 * part(random)]));
        elements.push(json!({"kind": "bar", "nodes": [pin, &tip], "axial_stiffness": 0.5 + part(random)}));
        elements.push(json!({"kind": "spring", "nodes": [&tip], "stiffness": [[0.01, 0], [0, 0.01]]}));
        if bar > 0 {
            elements.push(json!({"kind": "bar", "nodes": [format!("tip{}", bar - 1), &tip], "axial_stiffness": 0.5}));
        }
        contacts.push(json!({"node": tip, "obstacle": "floor", "friction": 0.1 + 0.6 * part(random)}));
    }
    let request = json!({
        "model": {
            "dimension": 2, "nodes": nodes, "supports": supports, "elements": elements, "contacts": contacts,
            "obstacles": {"floor": {"kind": "plane", "point": [0, 0], "normal": [0, 1]}},
            "stages": [{"name": "push", "forces": forces}],
        },
        "analysis": {"max_increments": 40},
    });
    Scene::new(&serde_json::from_value(request).expect("a request")).expect("a scene")
}

/// The full program with the adapted `γ1`, started nearby, finds no better solution and the same modes.
#[test]
fn what_is_shown_is_a_solution_that_the_search_finds() {
    let (mut random, mut shown, mut asked) = (Random::new(7), 0, 0);
    for _ in 0..12 {
        let scene = row(&mut random);
        each_increment(&scene, |loading, begun, increment| {
            let way = if increment.point.event.is_some() { 0.5 * increment.step } else { increment.step };
            let Some(reached) = begun.reach(loading, way).filter(|_| way > 1e-4) else { return };
            let Some(mut program) = begun.program(loading, &reached) else { return };
            asked += 1;
            let ForeseenModes::Named(named) = certificate::solved_at(&mut program, arrived(&reached), &begun.modes)
            else {
                return;
            };
            shown += 1;
            assert!(crate::mechanics::contact::all_continue(&named.modes, &begun.modes), "{:?}", increment.index);
            let weight = program.arc_weight;
            program.divide_objective(weight);
            let state = &reached.corrected.state;
            let frames: Vec<_> = program.reach.iter().map(|entry| loading.frame(entry.contact, state)).collect();
            let end = certificate::variables_of(&program, state, &frames);
            let mut start = end.clone();
            start.iter_mut().for_each(|value| *value *= 1.0 + 1e-3 * part(&mut random));
            let solution = mpec::solve(&program, &start, &Settings::warm(), &CancelFlag::default()).unwrap();
            assert_eq!(solution.status, mpec::SolveStatus::Solved, "increment {}", increment.index);
            // The search ends within its tolerances: its end is not better, and it is near.
            let moved = loading.structure.unknowns() + 1;
            let apart = (solution.x.rows(0, moved) - end.rows(0, moved)).amax();
            let gained = program.objective(&end) - solution.objective;
            assert!(gained < 1e-9 && apart < 5e-3, "increment {}: {gained:e}, {apart:e}", increment.index);
            let found =
                solution_extraction::named_modes(&program, solution, &begun.modes, &CancelFlag::default()).modes;
            assert!(crate::mechanics::contact::all_continue(&found, &begun.modes), "increment {}", increment.index);
        });
    }
    println!("{shown} of {asked} increments shown");
    assert!(asked > 200 && 10 * shown > 9 * asked, "{shown} of {asked}");
}

/// Past the end of a mode the certificate gives the approximate position of the end.
#[test]
fn past_the_end_of_a_mode_nothing_is_shown_but_where_it_ends() {
    let (mut changes, mut ends) = (0, 0);
    for name in ["klarbring", "arch-type-truss", "three-snapping-bars", "slider-chain"] {
        let text = crate::check::scenes::find(name).unwrap().request;
        let scene = Scene::new(&crate::model::decode::decode(text.as_bytes()).unwrap()).unwrap();
        each_increment(&scene, |loading, begun, increment| {
            let event = increment.point.event.as_deref().unwrap_or("");
            if !event.contains(" to ") || event.contains("stage") || increment.step < 1e-6 {
                return;
            }
            changes += 1;
            // A slip that has reversed on the way keeps its old sense until it has returned to zero.
            let Some(reached) = begun.reach(loading, 3.0 * increment.step) else { return };
            let ForeseenModes::EndsAfter(part) = begun.shown(loading, &reached) else { return };
            let (found, there) = (part * reached.step, increment.step);
            assert!(found > 0.4 * there && found < 1.7 * there, "{name}, {}: {found} for {there}", increment.index);
            ends += 1;
        });
    }
    println!("{ends} of {changes} ends seen");
    assert!(ends >= 5, "{ends} of {changes}");
}

/// Off equilibrium, with a wrong reaction, against the direction, with a NaN and with a large error estimate.
#[test]
fn nothing_is_shown_where_a_condition_fails() {
    let scene = row(&mut Random::new(3));
    let mut seen = 0;
    each_increment(&scene, |loading, begun, increment| {
        if increment.point.event.is_some() || seen == 10 {
            return;
        }
        let Some(reached) = begun.reach(loading, increment.step) else { return };
        let shown = |reached: &Reached| begun.shown(loading, reached);
        if !matches!(shown(&reached), ForeseenModes::Named(_)) {
            return;
        }
        seen += 1;
        let unclear = |change: &dyn Fn(&mut Reached)| {
            let mut changed = reached.clone();
            change(&mut changed);
            assert!(matches!(shown(&changed), ForeseenModes::Unclear), "increment {}", increment.index);
        };
        unclear(&|reached| reached.corrected.state.load += 1e-5);
        unclear(&|reached| reached.corrected.state.reactions[0].normal += 1e-5);
        unclear(&|reached| reached.rate.scale(-1.0));
        unclear(&|reached| reached.corrected.state.load = f64::NAN);
        unclear(&|reached| reached.error_estimate = 1.0);
    });
    assert_eq!(seen, 10);
}

/// A node that rests on a floor without force, and no force on it: neither member of its pair is positive.
#[test]
fn a_contact_that_may_do_either_is_refused() {
    let request = json!({
        "model": {
            "dimension": 2, "nodes": {"a": [0, 0], "b": [1, 0]}, "supports": {"a": ["y"]},
            "elements": [{"kind": "spring", "nodes": ["a"], "stiffness": [[1, 0], [0, 1]]},
                         {"kind": "spring", "nodes": ["b"], "stiffness": [[1, 0], [0, 1]]}],
            "obstacles": {"floor": {"kind": "plane", "point": [0, 0], "normal": [0, 1]}},
            "contacts": [{"node": "b", "obstacle": "floor", "friction": 0.3}],
            "stages": [{"name": "push", "forces": {"a": [1, 0]}}],
        },
    });
    let scene = Scene::new(&serde_json::from_value(request).expect("a request")).expect("a scene");
    let held = scene.stages[0].pattern.zeroed();
    let (structure, contacts) = (&scene.structure, &scene.contacts[..]);
    let loading =
        Loading { structure, contacts, corners: &scene.corners, pattern: &scene.stages[0].pattern, held: &held };
    let state = State::at_rest(structure, contacts.len());
    let mut rate =
        Rate { displacement: scene.stages[0].pattern.forces.clone(), load: 1.0, reactions: state.reactions.clone() };
    rate.scale(1.0 / rate.size());
    let end = state.advanced(&rate, 0.1);
    let begun = Begun { state, rate, modes: vec![Mode::Free; contacts.len()], force: 1.0 };
    let mut program = IncrementProgram::new(loading, &begun.state, &begun.rate, 0.1, 1.0);
    assert!(program.pairs() > 0);
    let end = Arrived { state: &end, rate: &begun.rate, error: 0.0 };
    assert!(matches!(certificate::solved_at(&mut program, end, &begun.modes), ForeseenModes::Unclear));
}

/// Where slip turns in a plane, and where two obstacles touch one node, the search decides.
#[test]
fn circular_cones_and_corners_are_left_to_the_search() {
    let mut asked = 0;
    for name in ["curving-slip", "groove", "doubled-floor"] {
        let built_in = crate::check::scenes::find(name).unwrap();
        let scene = Scene::new(&crate::model::decode::decode(built_in.request.as_bytes()).unwrap()).unwrap();
        each_increment(&scene, |loading, begun, increment| {
            let Some(reached) = begun.reach(loading, increment.step) else { return };
            let closed = |corner: &crate::mechanics::problem::node_contact_forces::Corner| {
                corner.closed(loading, &reached.corrected.state).len()
            };
            if scene.structure.dimension == 3 || scene.corners.iter().any(|corner| closed(corner) >= 2) {
                asked += 1;
                assert!(matches!(begun.shown(loading, &reached), ForeseenModes::Unclear));
            }
        });
    }
    assert!(asked > 0);
}
