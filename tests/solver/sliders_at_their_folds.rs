//! Sliders with toggles (see `slip_ends_at_a_fold` for one alone, its force F and its fold) that nothing joins, under one load.
//!
//! Parts of the same geometry whose bars are all so many times as stiff have the forces `q F(x)`, the same places of the load
//! maximum, `F' = 0`, and of the fold, `F' = -k`. Each obeys its own closed form, at the load that they have in common.
//!
//! Alike, all slide, come to rest, stick and slide back at once. Where they slide back, each slides whichever way its toggle
//! goes: with the load falling, all on; with the load rising, each back, or stuck: `1 + 2^n` ways, the way back included.
//!
//! Else the weakest comes to its load maximum first, `q F* + μ w`, where the others come to rest with the force `q F*`, short of
//! theirs. It comes to rest itself at its fold, `q F° + μ w`. The load falls with all at rest to `q F* - μ w`, where the
//! others slide back while it stays at its fold; at `q F° - μ w` it slides back, too.

use crate::common::paths::{close, request, trace};
use arcslip::result::increment::{Direction, Increment, Status};
use arcslip::result::report::Report;
use arcslip::result::stop_reason::StopReason;
use serde_json::{Value, json};

/// Bars of the toggle and the soft bar.
const RISE: f64 = 0.3;
const LENGTH: f64 = 2.3;
const SOFT: f64 = 0.02 / LENGTH;
const DRAG: f64 = 0.3 * 0.01;

/// How many times as stiff each part is, and units of length and force.
#[derive(Debug, Clone, Copy)]
struct Sliders<'a> {
    factors: &'a [f64],
    units: [f64; 2],
}

/// `F`
fn force(x: f64) -> f64 {
    2.0 * (1.0 / RISE.hypot(1.0) - 1.0 / x.hypot(1.0)) * x
}

/// Where `F' = slope`, on the side of the start.
fn place_of(slope: f64) -> f64 {
    let cube = 1.0 / (1.0 / RISE.hypot(1.0) - 0.5 * slope);
    -(cube.powf(2.0 / 3.0) - 1.0).sqrt()
}

impl Sliders<'_> {
    fn document(&self) -> Value {
        let [length, force] = self.units;
        let (mut nodes, mut supports, mut elements, mut contacts) = (json!({}), json!({}), Vec::new(), Vec::new());
        let (mut obstacles, mut weights, mut pulls) = (json!({}), json!({}), json!({}));
        for (index, factor) in self.factors.iter().enumerate() {
            let y = 10.0 * index as f64;
            let at = |x: f64, above: f64| json!([x * length, (y + above) * length]);
            let [a, b, toggle, slider, floor] = ["a", "b", "u", "t", "f"].map(|name| format!("{name}{index}"));
            nodes[&a] = at(0.0, 1.0);
            nodes[&b] = at(0.0, -1.0);
            nodes[&toggle] = at(-RISE, 0.0);
            nodes[&slider] = at(LENGTH - RISE, 0.0);
            supports[&a] = json!(["x", "y"]);
            supports[&b] = json!(["x", "y"]);
            supports[&toggle] = json!(["y"]);
            let mut bar = |nodes: [&str; 2], stiffness: f64| {
                elements.push(json!({"kind": "bar", "nodes": nodes, "axial_stiffness": stiffness * factor * force}));
            };
            bar([&a, &toggle], 1.0);
            bar([&b, &toggle], 1.0);
            bar([&toggle, &slider], SOFT * LENGTH);
            obstacles[&floor] = json!({"kind": "plane", "point": at(LENGTH - RISE, 0.0), "normal": [0, 1]});
            contacts.push(json!({"node": slider, "obstacle": floor, "friction": 0.3}));
            weights[&slider] = json!([0, -0.01 * force]);
            pulls[&slider] = json!([force, 0]);
        }
        let far = json!({"displacement": {"node": "t0", "component": "x", "above": 2.0 * length}});
        json!({"model": {"dimension": 2, "nodes": nodes, "supports": supports, "elements": elements,
            "obstacles": obstacles, "contacts": contacts,
            "stages": [{"name": "press", "forces": weights, "until": {"load_above": 1.0}},
                {"name": "pull", "forces": pulls, "until": far}]},
            "analysis": {"max_increments": 2000, "arc_length": {"initial": 0.025, "max": 0.05}}})
    }

    /// Places of a part's toggle and slider.
    fn read(&self, increment: &Increment, part: usize) -> [f64; 2] {
        let along = |name: &str| increment.displacements[format!("{name}{part}").as_str()][0] / self.units[0];
        [along("u") - RISE, along("t") + LENGTH - RISE]
    }

    /// The path, each part of every point against its closed form.
    fn traced(&self) -> (Vec<Increment>, Report) {
        let (increments, report) = trace(&request(&self.document().to_string()));
        let pulled: Vec<Increment> = increments.into_iter().filter(|one| &*one.stage == "pull").collect();
        for increment in &pulled {
            for (part, factor) in self.factors.iter().enumerate() {
                let [x, slider] = self.read(increment, part);
                let pull = factor * force(x);
                close(slider, x + LENGTH + force(x) / SOFT, 1e-8, "the soft bar's length");
                let contact = &increment.contacts[part];
                let traction = -contact.tangential_reaction[0] / self.units[1];
                close(increment.load_factor - pull, traction, 1e-10, "equilibrium of a slider");
                assert!(traction.abs() <= DRAG * (1.0 + 1e-9), "{self:?}: {traction}");
                if contact.status == Status::Slip {
                    close(traction.abs(), DRAG, 1e-9 * DRAG, "traction of a slip");
                }
            }
        }
        (pulled, report)
    }

    /// All parts of an increment are at rest at their folds.
    fn rest_at_folds(&self, increment: &Increment, parts: &[usize]) {
        for part in parts {
            close(self.read(increment, *part)[0], place_of(-SOFT), 1e-7, "a toggle at its fold");
            assert_eq!(increment.contacts[*part].status, Status::Stick, "{self:?}");
        }
    }
}

fn directions(increment: &Increment) -> &[Direction] {
    increment.directions.as_deref().unwrap_or_default()
}

/// The points with an event after the slip has begun.
fn events(increments: &[Increment]) -> Vec<&Increment> {
    increments.iter().skip(1).filter(|increment| increment.point.event.is_some()).collect()
}

#[test]
fn parts_that_are_alike_rest_at_their_folds_together() {
    for count in 1..=4 {
        for units in [[1.0, 1.0], [1e3, 1e-6]] {
            let sliders = Sliders { factors: &vec![1.0; count], units };
            let (increments, report) = sliders.traced();
            let events = events(&increments);
            let (top, fold) = (force(place_of(0.0)), force(place_of(-SOFT)));
            for (event, load) in
                events.iter().zip([DRAG, top + DRAG, fold + DRAG, fold - DRAG, -fold - DRAG, -fold + DRAG])
            {
                close(event.load_factor, load, 1e-10, "load of an event");
            }
            let all: Vec<usize> = (0..count).collect();
            for increment in &increments {
                if (events[2].index + 1..=events[3].index).contains(&increment.index) {
                    sliders.rest_at_folds(increment, &all);
                }
            }
            let listed = directions(events[3]);
            assert_eq!(listed.len(), 1 + (1 << count), "{sliders:?}: {listed:?}");
            let falls: Vec<&Direction> = listed.iter().filter(|one| one.load_rate < 0.0).collect();
            assert!(falls.len() == 1 && falls[0].taken, "{sliders:?}: {listed:?}");
            assert!(falls[0].contacts.iter().all(|status| *status == Status::Slip), "{sliders:?}: {listed:?}");
            assert_eq!(report.stop_reason, StopReason::Cycle, "{sliders:?}");
        }
    }
}

#[test]
fn a_part_at_its_fold_does_not_stop_the_others() {
    for factors in [&[1.0, 1.001][..], &[1.0, 1.1], &[1.001, 1.0], &[1.0, 1.001, 1.01]] {
        for units in [[1.0, 1.0], [1e3, 1e-6]] {
            let sliders = Sliders { factors, units };
            let weakest = (0..factors.len()).find(|part| factors[*part] == 1.0).expect("the weakest");
            let others: Vec<usize> = (0..factors.len()).filter(|part| *part != weakest).collect();
            let (increments, report) = sliders.traced();
            let events = events(&increments);
            let (top, fold) = (force(place_of(0.0)), force(place_of(-SOFT)));
            for (event, load) in events.iter().zip([DRAG, top + DRAG, fold + DRAG, top - DRAG, fold - DRAG]) {
                close(event.load_factor, load, 1e-10, "load of an event");
            }
            let between = |from: usize, to: usize| {
                let range = events[from].index + 1..=events[to].index;
                increments.iter().filter(move |increment| range.contains(&increment.index))
            };
            for increment in between(2, 4) {
                sliders.rest_at_folds(increment, &[weakest]);
            }
            for increment in between(3, 4) {
                assert!(others.iter().all(|part| increment.contacts[*part].status == Status::Slip), "{sliders:?}");
                assert!(!increment.point.degenerate || increment.index == events[4].index, "{sliders:?}");
            }
            assert_eq!(report.stop_reason, StopReason::Cycle, "{sliders:?}");
        }
    }
}
