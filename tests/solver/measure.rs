//! The measure of error finds nothing in exact states and finds each thing that is wrong. Increments are written by
//! hand from exact solutions: no solver is asked.

use crate::common::paths::{scene_file, typed};
use arcslip::check::measure::{Errors, Judge};
use arcslip::check::scenes::exact::hump::Hump;
use arcslip::check::scenes::exact::tractrix::Tractrix;
use arcslip::model::JobRequest;
use arcslip::result::increment::{Increment, Status};
use serde_json::{Map, Value, json};

/// A contact's row: status, gap, normal reaction, tangential reaction, slip.
type Row<'a> = (&'a str, f64, f64, Vec<f64>, Vec<f64>);

fn increment(request: &JobRequest, stage: &str, load: f64, moved: &[(&str, Vec<f64>)], rows: &[Row<'_>]) -> Increment {
    let still = vec![0.0; request.model.dimension];
    let displacements: Map<String, Value> = request
        .model
        .nodes
        .keys()
        .map(|name| (name.clone(), json!(moved.iter().find(|(node, _)| node == name).map_or(&still, |(_, u)| u))))
        .collect();
    let contacts: Vec<Value> = request
        .model
        .contacts
        .iter()
        .zip(rows)
        .map(|(contact, (status, gap, normal, tangential, slip))| {
            json!({"node": contact.node, "obstacle": contact.obstacle, "status": status, "gap": gap,
                   "normal_reaction": normal, "tangential_reaction": tangential, "slip": slip})
        })
        .collect();
    serde_json::from_value(json!({
        "index": 0, "stage": stage, "load_factor": load, "arc_length": 0, "step": 0, "displacements": displacements,
        "contacts": contacts, "point": {"kind": "regular", "bifurcation": false, "event": null},
        "energy": {"external_work": 0, "strain": 0, "dissipated": 0},
        "diagnostics": {"elapsed_s": 0, "residual": 0, "complementarity": 0, "energy_error": 0, "error_estimate": 0,
                        "factorisations": 0, "newton_iterations": 0, "qp_solves": 0, "mpec_solves": 0}
    }))
    .expect("an increment")
}

/// The last of these increments' errors.
fn last(request: &JobRequest, increments: &[Increment]) -> Errors {
    judged(request, &stepped(increments))
}

fn judged(request: &JobRequest, increments: &[Increment]) -> Errors {
    let mut judge = Judge::new(request, 1.0, &vec![1.0; request.model.stages.len()]);
    increments.iter().map(|increment| judge.judge(increment)).last().expect("an increment")
}

/// The increments with their steps, all scales being 1: the chords in displacements and load factor.
fn stepped(increments: &[Increment]) -> Vec<Increment> {
    let mut stepped: Vec<Increment> = increments.to_vec();
    let (mut arc_length, mut load, mut stage) = (0.0, 0.0, stepped[0].stage.clone());
    let mut before: Option<Vec<f64>> = None;
    for increment in &mut stepped {
        let place: Vec<f64> = increment.displacements.values().flatten().copied().collect();
        if increment.stage != stage {
            (load, stage) = (0.0, increment.stage.clone());
        }
        let moved: f64 = match &before {
            Some(before) => place.iter().zip(before).map(|(a, b)| (a - b) * (a - b)).sum(),
            None => place.iter().map(|a| a * a).sum(),
        };
        increment.step = (moved + (increment.load_factor - load).powi(2)).sqrt();
        arc_length += increment.step;
        increment.arc_length = arc_length;
        (before, load) = (Some(place), increment.load_factor);
    }
    stepped
}

/// Sliding over the hump between two angles.
fn hump(request: &JobRequest, from: f64, to: f64) -> [Increment; 2] {
    let exact = Hump::BUILT_IN;
    let place = |angle: f64| [f64::sin(angle), f64::cos(angle)];
    let at = |angle: f64, before: f64| {
        let (here, there, start) = (place(angle), place(before), &request.model.nodes["tip"]);
        let slip = (here[0] - there[0]) * here[1] - (here[1] - there[1]) * here[0];
        let normal = exact.normal_reaction(angle);
        let row = ("slip", 0.0, normal, vec![-exact.friction * normal], vec![slip]);
        increment(request, "push", exact.load(angle), &[("tip", vec![here[0] - start[0], here[1] - start[1]])], &[row])
    };
    [at(from, exact.start), at(to, from)]
}

#[test]
fn an_exact_slide_over_a_ball_has_no_error() {
    let request = scene_file("hump");
    for (from, to) in [(-0.8, -0.5), (-0.5, 0.1), (0.1, 0.65), (0.65, 0.2)] {
        let increments = hump(&request, from, to);
        let errors = last(&request, &increments);
        // Backwards the traction would have to turn.
        if to > from {
            assert!(errors.largest_of_state() < 1e-14, "{errors:?}");
        } else {
            assert!(errors.friction > 0.1, "{errors:?}");
        }
    }
}

#[test]
fn each_fault_shows_in_its_figure() {
    let request = scene_file("hump");
    let spoiled = |spoil: &dyn Fn(&mut Increment)| {
        let mut increments = stepped(&hump(&request, -0.6, -0.4));
        spoil(&mut increments[1]);
        judged(&request, &increments)
    };
    assert!(spoiled(&|_| {}).largest_of_state() < 1e-14);
    let big = 1e-4;
    assert!(spoiled(&|i| i.load_factor += 1e-3).equilibrium > big);
    assert!(spoiled(&|i| i.contacts[0].normal_reaction += 1e-3).equilibrium > big);
    assert!(spoiled(&|i| i.contacts[0].tangential_reaction[0] -= 1e-3).cone > big);
    assert!(spoiled(&|i| i.contacts[0].tangential_reaction[0] += 1e-3).friction > big);
    assert!(spoiled(&|i| i.contacts[0].gap += 1e-3).contact > big);
    assert!(spoiled(&|i| i.contacts[0].gap += 1e-3).reported > big);
    assert!(spoiled(&|i| i.contacts[0].slip[0] += 1e-3).reported > big);
    assert!(spoiled(&|i| i.displacements["pin"][1] += 1e-3).support > big);
    assert!(spoiled(&|i| i.displacements["tip"][1] += 1e-3).reported > big);
    assert!(spoiled(&|i| i.energy.strain += 1e-3).energy > big);
    assert!(spoiled(&|i| i.energy.external_work += 1e-3).energy > big);
    assert!(spoiled(&|i| i.energy.strain += 1e-3).strain_energy > big);
    assert!(spoiled(&|i| i.step += 1e-3).arc_length > big);
    assert!(spoiled(&|i| i.arc_length += 1e-3).arc_length > big);
    assert!(spoiled(&|i| i.displacements["tip"][0] += 1e-3).arc_length > big);
    assert!(spoiled(&|i| i.contacts[0].status = Status::Stick).reported > big);
    assert!(spoiled(&|i| i.contacts[0].status = Status::Free).reported > big);
    assert!(spoiled(&|i| i.contacts[0].tangential_reaction[0] *= -1.0).friction > big);
    // What does not fit the model is an error without bound, and no panic.
    assert!(spoiled(&|i| i.contacts.clear()).equilibrium > big);
    assert_eq!(spoiled(&|i| i.contacts[0].obstacle = "another".into()).reported, f64::MAX);
    assert_eq!(spoiled(&|i| i.contacts.extend_from_within(..)).reported, f64::MAX);
    assert_eq!(spoiled(&|i| i.contacts[0].slip.clear()).reported, f64::MAX);
    assert_eq!(spoiled(&|i| i.stage = "another".into()).reported, f64::MAX);
    assert_eq!(spoiled(&|i| i.displacements.keep(|node| node == 0)).reported, f64::MAX);
    let shortened = |i: &mut Increment| {
        i.displacements = i.displacements.iter().map(|(name, values)| (name.clone(), &values[1..])).collect();
    };
    assert_eq!(spoiled(&shortened).reported, f64::MAX);
    for spoil in [
        |i: &mut Increment| i.step = f64::INFINITY,
        |i: &mut Increment| i.energy.dissipated = f64::NAN,
        |i: &mut Increment| i.contacts[0].tangential_reaction[0] = f64::NAN,
        |i: &mut Increment| i.displacements["tip"][0] = f64::NAN,
    ] {
        let errors = spoiled(&spoil);
        assert!(errors.values().contains(&f64::MAX) && errors.values().iter().all(|value| value.is_finite()));
    }
    assert!(spoiled(&|i| i.contacts[0].gap = f64::NAN).largest_of_state() == f64::MAX);
    assert!(spoiled(&|i| i.load_factor = f64::NAN).largest_of_state() == f64::MAX);
}

/// Tangents of a floor with the normal (0, 0, 1): x and y. Slip is the chord between two places of the exact track.
fn tractrix(request: &JobRequest, from: f64, to: f64) -> [Increment; 2] {
    let exact = Tractrix::BUILT_IN;
    let place = |w: f64| [exact.track(w), exact.offset - w];
    let at = |w: f64, before: f64| {
        let (here, there) = (place(w), place(before));
        let slip = vec![here[0] - there[0], here[1] - there[1]];
        let normal = exact.normal_reaction(here[0], here[1]);
        let row = ("slip", 0.0, normal, exact.traction(here[0], here[1]).to_vec(), slip);
        let moved = vec![here[0] - exact.start, here[1], 0.0];
        increment(request, "push", exact.load(here[0], here[1]), &[("tip", moved)], &[row])
    };
    [at(from, exact.offset), at(to, from)]
}

#[test]
fn a_curving_slip_is_judged_to_second_order() {
    let request = scene_file("curving-slip");
    let errors = |step: f64| last(&request, &tractrix(&request, 0.2, 0.2 + step));
    let (coarse, fine) = (errors(0.04), errors(0.02));
    for errors in [&coarse, &fine] {
        assert!(errors.largest_of_state() < 1e-14, "{errors:?}");
    }
    assert!(coarse.slip_direction < 1e-2 && coarse.slip_direction > 0.0);
    let order = (coarse.slip_direction / fine.slip_direction).log2();
    assert!((1.9..2.1).contains(&order), "{coarse:?} {fine:?}");
}

/// Backward Euler slips along the last direction only: the chord is off by a first-order angle.
#[test]
fn a_slip_of_first_order_is_told_from_one_of_second() {
    let request = scene_file("curving-slip");
    let angle = |step: f64| {
        let [first, mut second] = tractrix(&request, 0.2, 0.2 + step);
        let exact = Tractrix::BUILT_IN;
        // The same end, reached from a place that makes the chord parallel to the last direction.
        let (x, y) = (exact.track(0.2 + step), exact.offset - 0.2 - step);
        let along = exact.traction(x, y);
        let size = step / 0.25 / along[0].hypot(along[1]);
        let slip = [-along[0] * size, -along[1] * size];
        let start = &first.displacements["tip"];
        second.displacements["tip"][0] = start[0] + slip[0];
        second.displacements["tip"][1] = start[1] + slip[1];
        last(&request, &[first, second]).slip_direction
    };
    let order = (angle(0.04) / angle(0.02)).log2();
    assert!((0.8..1.2).contains(&order), "{order}");
}

#[test]
fn a_traction_along_the_slip_is_an_error() {
    let request = scene_file("curving-slip");
    let [first, mut second] = tractrix(&request, 0.2, 0.24);
    second.contacts[0].tangential_reaction.iter_mut().for_each(|value| *value = -*value);
    assert!(last(&request, &[first, second]).friction > 1e-2);
}

/// The tangent frame of a slanting plane in 3D, written out: n = (1, 2, 2)/3, the smallest component is x, so
/// t1 = (8, -2, -2)/(6 √2), t2 = n x t1 = (0, 1, -1)/√2.
#[test]
fn tangents_in_space_are_the_documented_ones() {
    let request = typed(json!({"model": {
        "dimension": 3, "nodes": {"node": [0, 0, 0]},
        "elements": [{"kind": "spring", "nodes": ["node"], "stiffness": [[1, 0, 0], [0, 1, 0], [0, 0, 1]]}],
        "obstacles": {"slope": {"kind": "plane", "point": [0, 0, 0], "normal": [1, 2, 2]}},
        "contacts": [{"node": "node", "obstacle": "slope", "friction": 1}],
        "stages": [{"name": "press", "forces": {"node": [-0.6, -1.9, -1.0]}}]
    }}));
    let half = 0.5_f64.sqrt();
    let (first, second) = ([8.0 * half / 6.0, -half / 3.0, -half / 3.0], [0.0, half, -half]);
    let force = [0.6, 1.9, 1.0];
    let along = |t: [f64; 3]| t.iter().zip(force).map(|(t, f)| t * f).sum::<f64>();
    let normal = (0.6 + 3.8 + 2.0) / 3.0;
    let row = ("stick", 0.0, normal, vec![along(first), along(second)], vec![0.0, 0.0]);
    let errors = last(&request, &[increment(&request, "press", 1.0, &[], &[row])]);
    assert!(errors.largest_of_state() < 1e-15, "{errors:?}");
}

/// A block dragged by its floor, and one whose support moves: both exact, both wrong where the motion is left out.
#[test]
fn motions_of_obstacles_and_supports_are_followed() {
    let request = scene_file("dragged-block");
    let pressed = || increment(&request, "press", 1.0, &[], &[("stick", 0.0, 1.0, vec![0.0], vec![0.0])]);
    let stuck = |u: f64| {
        increment(&request, "drag", 0.1, &[("block", vec![u, 0.0])], &[("stick", 0.0, 1.0, vec![2.0 * u], vec![0.0])])
    };
    assert!(last(&request, &[pressed(), stuck(0.1)]).largest_of_state() < 1e-15);
    assert!(last(&request, &[pressed(), stuck(0.0)]).friction > 1e-2, "left behind");
    let sliding = |slip: f64| {
        let row = ("slip", 0.0, 1.0, vec![0.3], vec![slip]);
        increment(&request, "drag", 0.4, &[("block", vec![0.15, 0.0])], &[row])
    };
    assert!(last(&request, &[pressed(), stuck(0.1), sliding(-0.25)]).largest_of_state() < 1e-15);
    assert!(last(&request, &[pressed(), stuck(0.1), sliding(0.05)]).reported > 1e-2, "slip without the floor's motion");

    let request = scene_file("lowered-pin");
    let lowered = |y: f64| {
        let normal = 1.0 / 0.9_f64.hypot(1.5) - 1.0 / 1.0_f64.hypot(1.5);
        let row = ("stick", 0.0, 0.9 * normal, vec![1.5 * normal], vec![0.0]);
        increment(&request, "lower", 0.1, &[("pin", vec![0.0, y])], &[row])
    };
    assert!(last(&request, &[lowered(-0.1)]).support == 0.0);
    assert!(last(&request, &[lowered(-0.1)]).equilibrium < 1e-13);
    assert!(last(&request, &[lowered(-0.2)]).support > 1e-2);
}

#[test]
fn a_contact_without_a_row_has_to_be_open() {
    let request = typed(json!({
        "model": {
            "dimension": 2, "nodes": {"tip": [0, 1]},
            "elements": [{"kind": "spring", "nodes": ["tip"], "stiffness": [[1, 0], [0, 1]]}],
            "obstacles": {"floor": {"kind": "plane", "point": [0, 0], "normal": [0, 1]},
                          "lid": {"kind": "plane", "point": [0, 3], "normal": [0, -1]}},
            "contacts": [{"node": "tip", "obstacle": "lid"}, {"node": "tip", "obstacle": "floor"}],
            "stages": [{"name": "press", "forces": {"tip": [0, -1]}},
                       {"name": "lower", "obstacle_motion": {"lid": [0, -1]}}],
        }
    }));
    let pressed = |load: f64| {
        let mut pressed = increment(&request, "press", load, &[("tip", vec![0.0, -load])], &[]);
        pressed.contacts.clear();
        pressed
    };
    let open = last(&request, &[pressed(0.0), pressed(0.25), pressed(0.5), pressed(0.9)]);
    assert!(open.largest_of_state() < 1e-15, "{open:?}");
    let through = last(&request, &[pressed(0.0), pressed(0.25), pressed(0.5), pressed(0.9), pressed(1.5)]);
    assert!((through.contact - 0.5).abs() < 1e-15 && through.equilibrium < 1e-15, "{through:?}");
    let lowered = |load: f64| {
        let mut lowered = increment(&request, "lower", load, &[("tip", vec![0.0, -0.5])], &[]);
        lowered.contacts.clear();
        lowered
    };
    let beside = last(&request, &[pressed(0.0), pressed(0.5), lowered(0.0), lowered(2.25)]);
    assert!(beside.contact == 0.0, "{beside:?}");
    let crushed = last(&request, &[pressed(0.0), pressed(0.5), lowered(0.0), lowered(2.25), lowered(2.75)]);
    assert!((crushed.contact - 0.25).abs() < 1e-15, "{crushed:?}");
}
