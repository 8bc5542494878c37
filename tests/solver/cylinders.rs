//! Cylinders as obstacles in space, outside and inside, with axes of any direction.

use crate::common::paths::{Traced, close, judged, place, trace, typed};
use arcslip::check::scenes::exact::bowl::bowl_load;
use arcslip::model::JobRequest;
use arcslip::model::request::Method;
use arcslip::result::increment::{Increment, PointKind, Status};
use arcslip::result::stop_reason::StopReason;
use serde_json::json;

type Place = [f64; 3];

/// Right-handed axes of a scene: across the cylinder, up, and along its axis.
#[derive(Clone, Copy)]
struct Axes([Place; 3]);

/// Upright; with the cylinder along x; skew, as the rows of a rotation matrix by whole sevenths.
const ALL_AXES: [Axes; 3] = [
    Axes([[1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]]),
    Axes([[0.0, 1.0, 0.0], [0.0, 0.0, 1.0], [1.0, 0.0, 0.0]]),
    Axes([[2.0 / 7.0, 3.0 / 7.0, 6.0 / 7.0], [3.0 / 7.0, -6.0 / 7.0, 2.0 / 7.0], [6.0 / 7.0, 2.0 / 7.0, -3.0 / 7.0]]),
];

impl Axes {
    fn turned(&self, local: Place) -> Place {
        [0, 1, 2].map(|k| (0..3).map(|axis| local[axis] * self.0[axis][k]).sum())
    }

    fn local(&self, place: &[f64]) -> Place {
        [0, 1, 2].map(|axis| (0..3).map(|k| self.0[axis][k] * place[k]).sum())
    }
}

const STIFFNESS: f64 = 0.1;

/// A node on a spring at the bottom of a pipe of radius 1, pressed down by 1 and then pushed along a local direction up to
/// a load factor.
fn in_pipe(axes: Axes, friction: f64, push: Place, until: f64, step: f64, method: Method) -> JobRequest {
    let spring = [[STIFFNESS, 0.0, 0.0], [0.0, STIFFNESS, 0.0], [0.0, 0.0, STIFFNESS]];
    let mut request = typed(json!({
        "model": {
            "name": "node in a pipe", "dimension": 3, "nodes": {"node": [0, 0, 0]},
            "elements": [{"kind": "spring", "nodes": ["node"], "stiffness": spring}],
            "obstacles": {"pipe": {"kind": "cylinder", "point": axes.turned([0.0, 1.0, 0.7]),
                                   "axis": axes.turned([0.0, 0.0, -3.0]), "radius": 1, "side": "inside"}},
            "contacts": [{"node": "node", "obstacle": "pipe", "friction": friction}],
            "stages": [
                {"name": "press", "forces": {"node": axes.turned([0.0, -1.0, 0.0])}, "until": {"load_above": 1}},
                {"name": "push", "forces": {"node": axes.turned(push)}, "until": {"load_above": until}}
            ]
        },
        "analysis": {"max_increments": 10000,
                     "arc_length": {"initial": step, "min": 1e-9, "max": step, "displacement_scale": 1,
                                    "load_scale": 1}}
    }));
    request.analysis.method = method;
    request
}

fn pushed(increments: &[Increment]) -> impl Iterator<Item = &Increment> {
    increments.iter().filter(|increment| &*increment.stage == "push")
}

/// Across the axis a pipe is a bowl.
#[test]
fn a_node_climbs_out_of_a_pipe_as_out_of_a_bowl() {
    for (axes, method) in ALL_AXES.into_iter().flat_map(|axes| [(axes, Method::Auto), (axes, Method::Mpec)]) {
        let friction = 0.2;
        let request = in_pipe(axes, friction, [1.0, 0.0, 0.0], 2.0, 0.1, method);
        let (increments, report) = trace(&request);
        assert_eq!(report.stop_reason, StopReason::StagesCompleted);
        let mut slid = false;
        for increment in pushed(&increments).filter(|increment| increment.load_factor > friction) {
            let [across, up, along] = axes.local(&place(&request, increment, "node"));
            close(along, 0.0, 1e-10, "along the axis");
            let exact = bowl_load(STIFFNESS, friction, across.atan2(1.0 - up));
            close(increment.load_factor, exact, 1e-9, "load");
            slid |= increment.contacts[0].status == Status::Slip;
        }
        assert!(slid);
    }
}

/// Without friction the push along the axis and that across it act on their own.
#[test]
fn a_node_in_a_smooth_pipe_follows_a_skew_push() {
    for axes in ALL_AXES {
        let request = in_pipe(axes, 0.0, [1.0, 0.0, -0.03], 2.0, 0.1, Method::Auto);
        let (increments, report) = trace(&request);
        assert_eq!(report.stop_reason, StopReason::StagesCompleted);
        for increment in pushed(&increments) {
            let [across, up, along] = axes.local(&place(&request, increment, "node"));
            close(along, -0.03 * increment.load_factor / STIFFNESS, 1e-10, "along the axis");
            close(increment.load_factor, bowl_load(STIFFNESS, 0.0, across.atan2(1.0 - up)), 1e-9, "load");
        }
    }
}

/// Along the axis a cylinder is a plane: a node on its top is pressed by 1 and slides when the pull exceeds μ and what the
/// spring takes.
#[test]
fn a_node_slides_along_the_top_of_a_cylinder() {
    let friction = 0.3;
    for axes in ALL_AXES {
        let mut request = in_pipe(axes, friction, [0.0, 0.0, 1.0], 0.5, 0.1, Method::Auto);
        let drum = json!({"kind": "cylinder", "point": axes.turned([0.0, -2.0, 0.0]),
                          "axis": axes.turned([0.0, 0.0, 1.0]), "radius": 2});
        request.model.obstacles["pipe"] = serde_json::from_value(drum).expect("a cylinder");
        let (increments, report) = trace(&request);
        assert_eq!(report.stop_reason, StopReason::StagesCompleted);
        let onset = pushed(&increments).find(|increment| increment.point.kind == PointKind::ContactChange);
        close(onset.expect("an onset of slip").load_factor, friction, 1e-12, "onset");
        for increment in pushed(&increments) {
            let [across, up, along] = axes.local(&place(&request, increment, "node"));
            let slid = ((increment.load_factor - friction) / STIFFNESS).max(0.0);
            for (found, exact) in [(across, 0.0), (up, 0.0), (along, slid)] {
                close(found, exact, 1e-10, "place");
            }
        }
    }
}

/// A node that slips in a pipe under a skew push: the slip has the direction of the force along the surface, and its size
/// is `μ` times the pressure. With `θ` round the axis and `z` along it, `(θ, z)' = f_t/|f_t|`, where the load follows from
/// `|f_t| = μ f_n`.
struct SkewSlip {
    friction: f64,
    push: [f64; 2],
}

impl SkewSlip {
    /// The force at a load, round the axis, along it, and into the surface.
    fn force(&self, [angle, along]: [f64; 2], load: f64) -> [f64; 3] {
        let (sine, cosine) = angle.sin_cos();
        let across = load * self.push[0] - STIFFNESS * sine;
        let down = 1.0 + STIFFNESS * (1.0 - cosine);
        let axial = load * self.push[1] - STIFFNESS * along;
        [across * cosine - down * sine, axial, across * sine + down * cosine]
    }

    /// The load at which the node slips, above the given one.
    fn load(&self, at: [f64; 2], least: f64) -> f64 {
        let excess = |load: f64| {
            let [round, axial, into] = self.force(at, load);
            round.hypot(axial) - self.friction * into
        };
        let (mut low, mut high) = (least - 1e-3, least + 0.2);
        for _ in 0..60 {
            let middle = 0.5 * (low + high);
            if excess(middle) < 0.0 { low = middle } else { high = middle }
        }
        0.5 * (low + high)
    }

    fn slope(&self, at: [f64; 2], load: &mut f64) -> [f64; 2] {
        *load = self.load(at, *load);
        let [round, axial, _] = self.force(at, *load);
        [round, axial].map(|part| part / round.hypot(axial))
    }

    /// The angle and the place along the axis where the load reaches a value, by the method of Runge and Kutta.
    fn place_at(&self, end: f64) -> [f64; 2] {
        let shifted = |at: [f64; 2], step: f64, slope: [f64; 2]| [at[0] + step * slope[0], at[1] + step * slope[1]];
        let (mut at, mut step) = ([0.0; 2], 1e-3);
        let mut load = self.load(at, self.friction / self.push[0].hypot(self.push[1]));
        while step > 1e-12 {
            let mut reached = load;
            let first = self.slope(at, &mut reached);
            let second = self.slope(shifted(at, 0.5 * step, first), &mut reached);
            let third = self.slope(shifted(at, 0.5 * step, second), &mut reached);
            let fourth = self.slope(shifted(at, step, third), &mut reached);
            let mean = [0, 1].map(|k| (first[k] + 2.0 * second[k] + 2.0 * third[k] + fourth[k]) / 6.0);
            let next = shifted(at, step, mean);
            reached = self.load(next, reached);
            if reached > end {
                step *= 0.5;
            } else {
                (at, load) = (next, reached);
            }
        }
        at
    }
}

#[test]
fn a_slip_in_a_pipe_under_a_skew_push_converges_to_that_of_another_integration() {
    let exact = SkewSlip { friction: 0.2, push: [1.0, 0.3] };
    let end = 0.8;
    let [angle, along] = exact.place_at(end);
    assert!(angle > 0.3 && along > 0.1, "angle {angle}, along {along}");
    for (axes, method) in [(ALL_AXES[0], Method::Auto), (ALL_AXES[2], Method::Auto), (ALL_AXES[2], Method::Mpec)] {
        let errors = [0.025, 0.0125, 0.00625, 0.003125].map(|step| {
            let request = in_pipe(axes, 0.2, [1.0, 0.0, 0.3], end, step, method);
            let traced: Traced = judged(&request);
            assert_eq!(traced.report.stop_reason, StopReason::StagesCompleted);
            let last = traced.increments.last().expect("an end");
            close(last.load_factor, end, 1e-12, "load");
            let [across, up, axial] = axes.local(&place(&request, last, "node"));
            (across.atan2(1.0 - up) - angle).hypot(axial - along)
        });
        println!("{errors:?}");
        assert!(errors[3] < 1e-6, "{errors:?}");
        for pair in errors.windows(2).filter(|pair| pair[1] > 1e-9) {
            assert!((pair[0] / pair[1]).log2() > 1.8, "{errors:?}");
        }
    }
}

/// A node on a stiff bar and a soft spring swings onto a cylinder. It slips on landing, and sticks with much
/// friction; between 0.22 and 0.29 friction and the inclined bar leave no quasi-static way on. Near the lower bound the
/// motion that belongs to a direction of slip turns by a right angle within a small part of a circle.
#[test]
fn a_node_that_lands_near_critical_friction_finds_its_slip() {
    for friction in [0.19, 0.199, 0.2, 0.21, 0.3, 0.8] {
        let request = typed(json!({"model": {
            "dimension": 3,
            "nodes": {"n0": [0.1, -0.33, 0], "n1": [0.82, -0.087, 0], "n2": [1.96, -0.389, 0.11], "n3": [2.98, 0.26, 0],
                "top": [1.5, 0, 2]},
            "supports": {"top": ["x", "y", "z"]},
            "elements": [
                {"kind": "bar", "nodes": ["n0", "top"], "axial_stiffness": 100},
                {"kind": "bar", "nodes": ["n1", "top"], "axial_stiffness": 100},
                {"kind": "bar", "nodes": ["n2", "top"], "axial_stiffness": 100},
                {"kind": "bar", "nodes": ["n3", "top"], "axial_stiffness": 100},
                {"kind": "bar", "nodes": ["n0", "n1"], "axial_stiffness": 10},
                {"kind": "bar", "nodes": ["n1", "n2"], "axial_stiffness": 1},
                {"kind": "bar", "nodes": ["n2", "n3"], "axial_stiffness": 10},
                {"kind": "spring", "nodes": ["n0"], "stiffness": [[0.1, 0, 0], [0, 0.1, 0], [0, 0, 0.1]]},
                {"kind": "spring", "nodes": ["n1"], "stiffness": [[0.1, 0, 0], [0, 0.1, 0], [0, 0, 0.1]]},
                {"kind": "spring", "nodes": ["n2"], "stiffness": [[3, 0, 0], [0, 3, 0], [0, 0, 3]]},
                {"kind": "spring", "nodes": ["n3"], "stiffness": [[0.1, 0, 0], [0, 0.1, 0], [0, 0, 0.1]]}],
            "obstacles": {
                "drum": {"kind": "cylinder", "point": [1.5, 0, -2], "axis": [0.23567258424211496, 1, 0], "radius": 2}},
            "contacts": [{"node": "n0", "obstacle": "drum", "friction": friction}],
            "stages": [{"name": "load", "until": {"load_above": 1}, "forces": {
                "n0": [0, 0, -0.5], "n1": [0, 0, -0.5], "n2": [0, 0, -0.5], "n3": [0, 0, -0.2]}}],
        }}));
        let traced = judged(&request);
        assert_eq!(traced.report.stop_reason, StopReason::StagesCompleted, "friction {friction}");
        let off = traced.errors.iter().filter(|errors| errors.largest_of_state() > 1e-10).count();
        assert_eq!(off, 0, "friction {friction}");
        let landing = traced.increments.iter().position(|increment| increment.point.kind == PointKind::ContactChange);
        let after = &traced.increments[landing.expect("a landing") + 1];
        let expected = if friction < 0.5 { Status::Slip } else { Status::Stick };
        assert_eq!(after.contacts[0].status, expected, "friction {friction}");
    }
}
