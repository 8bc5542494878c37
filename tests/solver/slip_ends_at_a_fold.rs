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
use arcslip::path::increment::{Direction, PointKind, Status};
use arcslip::path::{Increment, StopReason};
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

    fn drag(&self) -> f64 {
        self.friction * self.weight
    }

    /// A vector in the document, of this unit.
    fn turned(&self, vector: [f64; 2], unit: f64) -> [f64; 2] {
        let [x, y] = vector.map(|part| part * unit);
        [[x, y], [-y, x], [-x, -y], [y, -x]][self.turns]
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
        let stiffness = self.stiffness * force;
        let document: Value = json!({
            "model": {
                "dimension": 2,
                "nodes": {"a": at(0.0, self.height), "b": at(0.0, -self.height), "toggle": at(-self.rise, 0.0),
                    "slider": at(slider, 0.0)},
                "supports": {"a": ["x", "y"], "b": ["x", "y"], "toggle": [across]},
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
                        "until": {"displacement": {"node": "slider", "component": along, bound: sign * 2.0 * length}}},
                ],
            },
            "analysis": {"max_increments": 600, "arc_length": {"initial": 0.025, "max": 0.05}},
        });
        request(&document.to_string())
    }

    /// Places of the toggle and the slider, and the load, in units of the closed form.
    fn read(&self, increment: &Increment) -> [f64; 3] {
        let along = |node: &str| {
            let moved = &increment.displacements[node];
            let back = SliderToggle { turns: (4 - self.turns) % 4, ..*self };
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

/// Every point against the closed form, as far as the slider has gone by the status that is given with it.
fn holds_to_closed_form(toggle: &SliderToggle, increments: &[&Increment]) {
    let [_, force] = toggle.units;
    for increment in increments {
        let [x, slider, load] = toggle.read(increment);
        let pull = toggle.force(x) - toggle.push * load;
        close(slider, x + toggle.length + pull / toggle.soft, 1e-9 / toggle.soft, "the soft bar's length");
        let traction = -increment.contacts[0].tangential_reaction[0] / force;
        close(load - pull, traction, 1e-10, "equilibrium of the slider");
        assert!(traction.abs() <= toggle.drag() + 1e-12, "{traction}");
        if increment.contacts[0].status == Status::Slip {
            close(traction.abs(), toggle.drag(), 1e-12, "traction of a slip");
        }
    }
}

/// The scene's own: the slider comes to rest at the fold, sticks while the load falls by twice the drag, and slides back.
#[test]
fn a_slip_ends_at_a_fold_and_sticks() {
    for turns in 0..4 {
        for units in [[1.0, 1.0], [1e3, 1e-6], [1e-3, 1e9]] {
            let toggle = SliderToggle { turns, units, ..PLAIN };
            ends_at_its_fold(&toggle);
        }
    }
}

fn ends_at_its_fold(toggle: &SliderToggle) {
    let (increments, report) = trace(&toggle.request());
    let pulled = pulled(&increments);
    holds_to_closed_form(toggle, &pulled);
    let (top, fold) = (toggle.place_of(0.0), toggle.place_of(-toggle.soft));
    let maximum = pulled.iter().find(|one| one.point.kind == PointKind::SmoothLimit).expect("a load maximum");
    let [x, _, load] = toggle.read(maximum);
    close(x, top, 1e-7, "place of the load maximum");
    close(load, toggle.force(top) + toggle.drag(), 1e-10, "load maximum");
    let index = pulled
        .iter()
        .position(|one| {
            one.contacts[0].status == Status::Slip
                && one.index > maximum.index
                && one.point.kind == PointKind::ContactChange
        })
        .expect("an end of the slip");
    let [x, at_rest, load] = toggle.read(pulled[index]);
    close(x, fold, 1e-7, "place of the fold");
    close(load, toggle.force(fold) + toggle.drag(), 1e-9, "load at the fold");
    let listed = directions(pulled[index]);
    assert_eq!(listed.len(), 1, "{toggle:?}: {listed:?}");
    assert_eq!((&listed[0].contacts[..], listed[0].taken), (&[Status::Stick][..], true));
    assert!(listed[0].load_rate < 0.0);
    // All stays where it is until the slider slides back.
    let stuck: Vec<_> = pulled[index + 1..].iter().take_while(|one| one.contacts[0].status == Status::Stick).collect();
    assert!(!stuck.is_empty(), "{toggle:?}: {report:?}");
    for one in &stuck {
        let [x, slider, _] = toggle.read(one);
        close(x, fold, 1e-7, "the toggle at rest");
        close(slider, at_rest, 1e-10, "the slider at rest");
    }
    let [.., load] = toggle.read(stuck[stuck.len() - 1]);
    close(load, toggle.force(fold) - toggle.drag(), 1e-9, "load at which the slider slides back");
    assert_ne!(report.stop_reason, StopReason::Degenerate);
    assert_ne!(report.stop_reason, StopReason::StepUnderflow);
}
