//! Slip that ends where what hangs on the slider comes to a fold.
//!
//! A toggle: bars of axial stiffness EA from pins at (0, ±h) to a node that is guided along x, from -a. With `L² = h² + x²`
//! it takes the force `F(x) = 2 EA (1/L₀ - 1/L) x`, and `F'(x) = 2 EA (1/L₀ - h²/L³)`. A slider pulls it by a bar of
//! stiffness k: `x_s = x + l + F/k` while the slider slides, at `s = F ± μ w` (towards +x, -x).
//!
//! The load is largest at `F' = 0`, that is `L³ = h² L₀`; there the path goes on. The slider's speed is `(1 + F'/k) ẋ`, so that
//! it comes to rest at `F' = -k`, `1/L³ = (1/L₀ + k/(2 EA))/h²`. With the slider stuck the toggle is at its fold there, whatever
//! the load: `F''(x) ẋ² = 0` at second order. The path goes on with the toggle at rest, the load falling from `F + μ w` to
//! `F - μ w`; then the slider slides back, and its speed is `F''/k ẋ²`, of one sign whichever way the toggle goes.

use crate::common::paths::{close, request, trace};
use crate::common::random::Numbers;
use arcslip::model::JobRequest;
use arcslip::result::increment::{Direction, Increment, PointKind, Status};
use arcslip::result::stop_reason::StopReason;
use serde_json::{Value, json};

/// A slider with a toggle on it.
#[derive(Debug, Clone, Copy)]
struct SliderToggle {
    height: f64,
    rise: f64,
    stiffness: f64,
    soft: f64,
    length: f64,
    friction: f64,
    weight: f64,
    /// Force on the toggle by that on the slider.
    push: f64,
    /// Units of length and force.
    units: [f64; 2],
    /// Quarter turns of the whole.
    turns: usize,
    /// An angle by which it is turned besides; if it is not zero the toggle is guided by nothing but its own symmetry.
    slant: f64,
    /// The first arc length.
    step: f64,
}

const PLAIN: SliderToggle = SliderToggle {
    height: 1.0,
    rise: 0.3,
    stiffness: 1.0,
    soft: 0.02 / 2.3,
    length: 2.3,
    friction: 0.3,
    weight: 0.01,
    push: 0.0,
    units: [1.0; 2],
    turns: 0,
    slant: 0.0,
    step: 0.025,
};

impl SliderToggle {
    fn rest_length(&self) -> f64 {
        self.height.hypot(self.rise)
    }

    fn force(&self, x: f64) -> f64 {
        2.0 * self.stiffness * (1.0 / self.rest_length() - 1.0 / self.height.hypot(x)) * x
    }

    /// `F'`
    fn tangent(&self, x: f64) -> f64 {
        2.0 * self.stiffness * (1.0 / self.rest_length() - self.height.powi(2) / self.height.hypot(x).powi(3))
    }

    /// Where `F' = slope`, on the side of the start.
    fn place_of(&self, slope: f64) -> f64 {
        let cube = self.height.powi(2) / (1.0 / self.rest_length() - slope / (2.0 * self.stiffness));
        -(cube.powf(2.0 / 3.0) - self.height.powi(2)).sqrt()
    }

    /// Farther than the slider goes before it comes to rest.
    fn far(&self) -> f64 {
        let fold = self.place_of(-self.soft);
        2.0 * (fold + self.rise + self.force(fold) / self.soft)
    }

    fn drag(&self) -> f64 {
        self.friction * self.weight
    }

    /// A vector in the document, of this unit.
    fn turned(&self, vector: [f64; 2], unit: f64) -> [f64; 2] {
        let [x, y] = vector.map(|part| part * unit);
        let [x, y] = [[x, y], [-y, x], [-x, -y], [y, -x]][self.turns];
        if self.slant == 0.0 {
            return [x, y];
        }
        let (sine, cosine) = self.slant.sin_cos();
        [cosine * x - sine * y, sine * x + cosine * y]
    }

    fn request(&self) -> JobRequest {
        let [length, force] = self.units;
        let at = |x: f64, y: f64| self.turned([x, y], length);
        let by = |x: f64, y: f64| self.turned([x, y], force);
        let slider = self.length - self.rise;
        let along = ["x", "y"][self.turns % 2];
        let across = ["y", "x"][self.turns % 2];
        let bound = if self.turns < 2 { "above" } else { "below" };
        let sign = if self.turns < 2 { 1.0 } else { -1.0 };
        let mut pull = json!({"slider": by(1.0, 0.0)});
        if self.push != 0.0 {
            pull["toggle"] = json!(by(self.push, 0.0));
        }
        let mut supports = json!({"a": ["x", "y"], "b": ["x", "y"]});
        if self.slant == 0.0 {
            supports["toggle"] = json!([across]);
        }
        let far = sign * self.far() * self.slant.cos() * length;
        let stiffness = self.stiffness * force;
        let document: Value = json!({
            "model": {
                "dimension": 2,
                "nodes": {"a": at(0.0, self.height), "b": at(0.0, -self.height), "toggle": at(-self.rise, 0.0),
                    "slider": at(slider, 0.0)},
                "supports": supports,
                "elements": [
                    {"kind": "bar", "nodes": ["a", "toggle"], "axial_stiffness": stiffness},
                    {"kind": "bar", "nodes": ["b", "toggle"], "axial_stiffness": stiffness},
                    {"kind": "bar", "nodes": ["toggle", "slider"], "axial_stiffness": self.soft * self.length * force},
                ],
                "obstacles": {"floor": {"kind": "plane", "point": at(slider, 0.0), "normal": self.turned([0.0, 1.0], 1.0)}},
                "contacts": [{"node": "slider", "obstacle": "floor", "friction": self.friction}],
                "stages": [
                    {"name": "press", "forces": {"slider": by(0.0, -self.weight)}, "until": {"load_above": 1.0}},
                    {"name": "pull", "forces": pull,
                        "until": {"displacement": {"node": "slider", "component": along, bound: far}}},
                ],
            },
            "analysis": {"max_increments": 5000, "arc_length": {"initial": self.step, "max": 2.0 * self.step}},
        });
        request(&document.to_string())
    }

    /// Places of the toggle and the slider, and the load, in units of the closed form.
    fn read(&self, increment: &Increment) -> [f64; 3] {
        let along = |node: &str| {
            let moved = &increment.displacements[node];
            let back = SliderToggle { turns: (4 - self.turns) % 4, slant: -self.slant, ..*self };
            back.turned([moved[0], moved[1]], 1.0 / self.units[0])[0]
        };
        [along("toggle") - self.rise, along("slider") - self.rise + self.length, increment.load_factor]
    }
}

fn directions(increment: &Increment) -> &[Direction] {
    increment.directions.as_deref().unwrap_or_default()
}

fn pulled(increments: &[Increment]) -> Vec<&Increment> {
    increments.iter().filter(|increment| &*increment.stage == "pull").collect()
}

/// Every point against the closed form.
fn holds_to_closed_form(toggle: &SliderToggle, increments: &[&Increment]) {
    let [_, force] = toggle.units;
    let size = toggle.force(toggle.place_of(0.0)).abs() + toggle.drag();
    for increment in increments {
        let [x, slider, load] = toggle.read(increment);
        let pull = toggle.force(x) - toggle.push * load;
        close(slider, x + toggle.length + pull / toggle.soft, 1e-9 * size / toggle.soft, "the soft bar's length");
        let traction = -increment.contacts[0].tangential_reaction[0] / force;
        close(load - pull, traction, 1e-9 * size, "equilibrium of the slider");
        assert!(traction.abs() <= toggle.drag() * (1.0 + 1e-9), "{toggle:?}: {traction}");
        if increment.contacts[0].status == Status::Slip {
            close(traction.abs(), toggle.drag(), 1e-9 * toggle.drag(), "traction of a slip");
        }
    }
}

/// The end of the slip, the first after the load maximum; both where the closed form has them.
fn end_of_slip(toggle: &SliderToggle, pulled: &[&Increment]) -> usize {
    let (top, fold) = (toggle.place_of(0.0), toggle.place_of(-toggle.soft * (1.0 + toggle.push)));
    let load_at = |x: f64| (toggle.force(x) + toggle.drag()) / (1.0 + toggle.push);
    let maximum = pulled.iter().position(|one| one.point.kind == PointKind::SmoothLimit).expect("a load maximum");
    let [x, _, load] = toggle.read(pulled[maximum]);
    close(x, top, 1e-7 * toggle.height, "place of the load maximum");
    close(load, load_at(top), 1e-9 * load_at(top), "load maximum");
    let after = pulled[maximum + 1..].iter().position(|one| one.point.kind != PointKind::Regular);
    let index = maximum + 1 + after.expect("an end of the slip");
    let [x, _, load] = toggle.read(pulled[index]);
    close(x, fold, 1e-7 * toggle.height, "place of the fold");
    close(load, load_at(fold), 1e-8 * load_at(top), "load at the fold");
    index
}

/// The points at which the slider sticks past the end of a slip.
fn stuck<'a>(pulled: &[&'a Increment], index: usize) -> Vec<&'a Increment> {
    let stuck = pulled[index + 1..].iter().take_while(|one| one.contacts[0].status == Status::Stick);
    stuck.copied().collect()
}

/// At the fold all stays where it is until the load has fallen by twice the drag; then the slider slides back.
fn rests_at_the_fold(toggle: &SliderToggle) {
    let (increments, report) = trace(&toggle.request());
    let pulled = pulled(&increments);
    holds_to_closed_form(toggle, &pulled);
    let index = end_of_slip(toggle, &pulled);
    let fold = toggle.place_of(-toggle.soft);
    // The other sense of the line would take the slider's force out of its cone, and whatever moves the toggle the equations.
    let listed = directions(pulled[index]);
    assert!(listed.len() < 2, "{toggle:?}: {listed:?}");
    let stuck = stuck(&pulled, index);
    assert!(!stuck.is_empty(), "{toggle:?}: {report:?}");
    let [_, at_rest, mut before] = toggle.read(pulled[index]);
    for one in &stuck {
        let [x, slider, load] = toggle.read(one);
        close(x, fold, 1e-7 * toggle.height, "the toggle at rest");
        close(slider, at_rest, 1e-10 * toggle.length, "the slider at rest");
        assert!(load < before, "{toggle:?}: the load rises to {load}");
        before = load;
    }
    close(before, toggle.force(fold) - toggle.drag(), 1e-8 * toggle.force(fold).abs(), "load at which it slides back");
    // The slider slides back whichever way the toggle goes.
    let last = stuck[stuck.len() - 1];
    let slips: Vec<f64> =
        directions(last).iter().filter(|one| one.contacts[0] == Status::Slip).map(|one| one.load_rate).collect();
    assert!(slips.len() == 2 && slips[0] * slips[1] < 0.0, "{toggle:?}: {:?}", last.directions);
    let next = pulled[index + stuck.len() + 1];
    assert_eq!(next.contacts[0].status, Status::Slip);
    assert!(toggle.read(next)[1] < at_rest);
    assert!(
        !matches!(report.stop_reason, StopReason::Degenerate | StopReason::StepUnderflow),
        "{toggle:?}: {report:?}"
    );
}

/// The same with a force on the toggle, too, that shares in the load: with one that pushes it on it goes on past its fold
/// while the slider sticks, and there are two ways to do so; with one that holds it back there is no equilibrium near by.
fn leaves_its_fold(toggle: &SliderToggle) {
    let (increments, report) = trace(&toggle.request());
    let pulled = pulled(&increments);
    holds_to_closed_form(toggle, &pulled);
    let index = end_of_slip(toggle, &pulled);
    let listed = directions(pulled[index]);
    if toggle.push < 0.0 {
        assert_eq!(report.stop_reason, StopReason::NoDirection, "{toggle:?}");
        assert_eq!(index, pulled.len() - 1, "{toggle:?}");
        assert!(listed.is_empty(), "{toggle:?}: {listed:?}");
        return;
    }
    assert!(
        !matches!(report.stop_reason, StopReason::Degenerate | StopReason::StepUnderflow),
        "{toggle:?}: {report:?}"
    );
    // On and back are not listed; where the path bends at once both are ways that leave alike.
    assert_ne!(listed.len(), 1, "{toggle:?}: {listed:?}");
    assert!(listed.iter().all(|one| one.contacts[0] == Status::Stick), "{toggle:?}: {listed:?}");
    let stuck = stuck(&pulled, index);
    let [begun, at_rest, _] = toggle.read(pulled[index]);
    let mut before = begun;
    for one in &stuck {
        let [x, slider, _] = toggle.read(one);
        assert!(x > before, "{toggle:?}: the toggle goes back to {x} from {before}");
        close(slider, at_rest, 1e-9 * toggle.length, "the slider at rest");
        before = x;
    }
    let [_, _, load] = toggle.read(stuck[stuck.len() - 1]);
    let traction = load - toggle.force(before) + toggle.push * load;
    close(traction, -toggle.drag(), 1e-8 * toggle.drag(), "the slider slides back");
}

#[test]
fn a_slip_that_ends_at_a_fold_sticks() {
    for turns in 0..4 {
        for units in [[1.0, 1.0], [1e3, 1e-6], [1e-3, 1e9]] {
            rests_at_the_fold(&SliderToggle { turns, units, ..PLAIN });
        }
    }
}

/// However little is wanting.
#[test]
fn beside_a_fold_the_path_goes_on_or_ends_for_want_of_a_direction() {
    for exponent in 1..=10 {
        for sign in [1.0, -1.0] {
            leaves_its_fold(&SliderToggle { push: sign * 10.0_f64.powi(-exponent), ..PLAIN });
        }
    }
}

#[test]
fn random_sliders_with_toggles() {
    let mut numbers = Numbers(24);
    let mut tried = 0;
    while tried < 200 {
        let exponent = -(2.0 + numbers.between(0.0, 6.0)).floor();
        let push = match numbers.below(3) {
            0 => 0.0,
            1 => 10.0_f64.powf(exponent),
            _ => -(10.0_f64.powf(exponent)),
        };
        let unit = |numbers: &mut Numbers| 10.0_f64.powi(numbers.below(13) as i32 - 6);
        let toggle = SliderToggle {
            height: numbers.between(0.5, 2.0),
            rise: numbers.between(0.1, 0.6),
            stiffness: numbers.between(0.2, 5.0),
            soft: numbers.between(0.002, 0.2),
            length: numbers.between(1.5, 3.0),
            friction: numbers.between(0.1, 1.0),
            weight: numbers.between(0.002, 0.05),
            push,
            units: [unit(&mut numbers), unit(&mut numbers)],
            turns: numbers.below(4),
            ..PLAIN
        };
        // Soft enough for the slider to come to rest, and well so.
        if toggle.tangent(0.0) > -1.5 * toggle.soft {
            continue;
        }
        tried += 1;
        if push == 0.0 { rests_at_the_fold(&toggle) } else { leaves_its_fold(&toggle) }
    }
}

/// Where it slides back both ways dissipate as good as nothing, and along neither does anything move as it did: while the slider
/// stuck nothing moved but by rounding. It is the load that goes on falling as it did, in whatever units, axes and steps.
#[test]
fn the_slider_slides_back_as_the_load_goes_on_falling() {
    let shallow = SliderToggle {
        height: 5.0,
        rise: 0.99,
        stiffness: 4.55,
        soft: 0.0035,
        length: 2.777,
        friction: 0.46,
        weight: 9.743e-4,
        ..PLAIN
    };
    for slant in [0.0, 0.3, 0.7, 1.1] {
        for step in [0.01, 0.02, 0.025, 0.04] {
            for units in [[1.0, 1.0], [1e3, 1e-6], [1e-2, 1e2]] {
                let toggle = SliderToggle { slant, step, units, ..shallow };
                let (increments, _) = trace(&toggle.request());
                let pulled = pulled(&increments);
                let fold = toggle.place_of(-toggle.soft);
                let rests =
                    |one: &&&Increment| one.contacts[0].status == Status::Stick && one.index > pulled[0].index + 20;
                let at_rest = pulled.iter().find(rests).expect("a slider at rest").index;
                let slides = |one: &&&Increment| one.index > at_rest && one.contacts[0].status == Status::Slip;
                let after = pulled.iter().position(|one| slides(&one)).expect("a slider that slides back");
                let [x, _, load] = toggle.read(pulled[after - 1]);
                close(x, fold, 1e-6 * toggle.height, "the toggle at rest");
                close(load, toggle.force(fold) - toggle.drag(), 1e-8, "load at which it slides back");
                let listed = directions(pulled[after - 1]);
                let slips: Vec<&Direction> = listed.iter().filter(|one| one.contacts[0] == Status::Slip).collect();
                assert_eq!(slips.len(), 2, "{toggle:?}: {listed:?}");
                assert!(slips.iter().all(|one| one.taken == (one.load_rate < 0.0)), "{toggle:?}: {listed:?}");
            }
        }
    }
}

/// Of two nodes that a bar joins one has left its floor and hangs on a spring and the bar; the other slides until that is at its
/// fold. While it sticks nothing moves: its reaction takes what the load (-0.716, -0.31) leaves, until it is on the other side
/// of its cone.
#[test]
fn what_hangs_on_a_slider_may_have_more_than_one_motion() {
    let (increments, report) = trace(&request(include_str!("models/two-sliders-one-at-a-fold.json")));
    let is_end_of_slip = |one: &&Increment| one.point.event.as_deref() == Some("f1 on o1: slip to stick");
    let end = increments.iter().find(is_end_of_slip).expect("an end of the slip");
    let at_rest = &increments[end.index as usize + 1..];
    let held = at_rest.iter().take_while(|one| one.contacts[1].status == Status::Stick);
    let last = held.last().expect("a slider that sticks");
    for node in ["f0", "f1"] {
        for (here, there) in last.displacements[node].iter().zip(&end.displacements[node]) {
            close(*here, *there, 1e-9, "a node at rest");
        }
    }
    let contact = &end.contacts[1];
    let (normal, traction) = (contact.normal_reaction, contact.tangential_reaction[0]);
    let by_load = (traction + 0.595 * normal) / (0.716 + 0.595 * 0.31);
    close(last.load_factor, end.load_factor - by_load, 1e-9, "load at which it slides back");
    assert_eq!(increments[last.index as usize + 1].contacts[1].status, Status::Slip);
    assert_eq!(report.stop_reason, StopReason::CollapsedBar);
}
