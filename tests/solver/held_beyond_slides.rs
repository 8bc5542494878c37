//! A node that slides from one plane onto another in space, where the two hold it by a force that no slide has: until they
//! hold it no more, where no motion goes on, or until the force comes back to where a slide begins. All exact.

use crate::common::paths::{close, trace, typed};
use crate::common::sum_of_cones::distance;
use crate::common::variants::in_reverse;
use arcslip::model::JobRequest;
use arcslip::result::increment::{Increment, PointKind, Status};
use arcslip::result::stop_reason::StopReason;
use serde_json::{Value, json};

/// Friction of the floor and of the wall, which leans over the floor at the angle between their normals.
const FLOOR: f64 = 1.0;
const WALL: f64 = 0.1;
const LEANS: f64 = 60.0;
/// Angle of the pull to the edge; the node meets the wall after this way.
const TOWARDS: f64 = 30.0;
const WAY: f64 = 0.2;

/// With the normals `n_f` and `n_w`, the edge `e` and the pull `d`, all of unit size.
struct Corner {
    wall: [f64; 3],
    pull: [f64; 3],
    sine: f64,
    cosine: f64,
}

fn corner() -> Corner {
    let ((sine, cosine), (across, along)) = (LEANS.to_radians().sin_cos(), TOWARDS.to_radians().sin_cos());
    Corner { wall: [-sine, 0.0, cosine], pull: [across, along, 0.0], sine, cosine }
}

impl Corner {
    /// The pull less what the springs take up at which the node is on its way along the floor.
    fn slides_on_floor(&self) -> f64 {
        FLOOR
    }

    /// The same at which `R = n_f - q d` leaves the sum of the cones: `y·R = 0` with `y` on the bounds of both duals,
    /// `y·n = sin φ`, on the side of the pull.
    fn is_let_go(&self) -> f64 {
        let sine_of = |friction: f64| friction / friction.hypot(1.0);
        let (floor, wall, c) = (sine_of(FLOOR), sine_of(WALL), self.cosine);
        let (x, z) = ((floor - c * wall) / (1.0 - c * c), (wall - c * floor) / (1.0 - c * c));
        let height = (1.0 - x * x - z * z - 2.0 * c * x * z).sqrt();
        floor / (height * self.pull[1] - z * self.pull[0] * self.sine)
    }

    /// Normal reactions at a slide along the edge: `R = N_f n_f + N_w n_w - v e`.
    fn normals(&self, q: f64) -> [f64; 2] {
        [1.0 - q * self.pull[0] * self.cosine / self.sine, q * self.pull[0] / self.sine]
    }

    /// The way along the edge under a pull; negative where no slide has begun: `q d·e - v = μ_f N_f + μ_w N_w`.
    fn way_along(&self, q: f64) -> f64 {
        let [floor, wall] = self.normals(q);
        q * self.pull[1] - FLOOR * floor - WALL * wall
    }

    /// Where that begins.
    fn slides_along(&self) -> f64 {
        FLOOR / (self.way_along(1.0) - self.way_along(0.0))
    }
}

fn request(stages: &[(&str, f64, f64)], longest: f64) -> JobRequest {
    let Corner { wall, pull, .. } = corner();
    let mut all = vec![json!({"name": "press", "forces": {"node": [0, 0, -1]}, "until": {"load_above": 1}})];
    let stage = |(name, sign, above): &(&str, f64, f64)| -> Value {
        json!({"name": name, "forces": {"node": pull.map(|part| sign * part)}, "until": {"load_above": above}})
    };
    all.extend(stages.iter().map(stage));
    typed(json!({
        "model": {
            "name": "onto a wall that leans over", "dimension": 3, "nodes": {"node": [0, 0, 0]},
            "elements": [{"kind": "spring", "nodes": ["node"], "stiffness": [[1, 0, 0], [0, 1, 0], [0, 0, 1]]}],
            "obstacles": {"floor": {"kind": "plane", "point": [0, 0, 0], "normal": [0, 0, 1]},
                          "wall": {"kind": "plane", "point": [WAY * pull[0], 0, 0], "normal": wall}},
            "contacts": [{"node": "node", "obstacle": "floor", "friction": FLOOR},
                         {"node": "node", "obstacle": "wall", "friction": WALL}],
            "stages": all
        },
        "analysis": {"arc_length": {"initial": longest, "max": longest}, "max_increments": 5000}
    }))
}

/// Steps long and short, and the other order.
fn each(stages: &[(&str, f64, f64)], check: impl Fn(&[Increment], StopReason)) {
    for longest in [0.5, 0.02, 0.003] {
        let request = request(stages, longest);
        for request in [request.clone(), in_reverse(request)] {
            let (increments, report) = trace(&request);
            check(&increments, report.stop_reason);
        }
    }
}

fn is_at(increment: &Increment, along_pull: f64, along_edge: f64) {
    let Corner { pull, .. } = corner();
    let exact = [along_pull * pull[0], along_pull * pull[1] + along_edge, 0.0];
    for (found, exact) in increment.displacements["node"].iter().zip(exact) {
        close(*found, exact, 1e-10, &format!("{} at s = {}", increment.stage, increment.load_factor));
    }
}

fn passes(increments: &[Increment], stage: &str, load: f64) {
    let is_there = |increment: &&Increment| &*increment.stage == stage && (increment.load_factor - load).abs() < 1e-10;
    let kinds = [PointKind::ContactChange, PointKind::NonsmoothLimit, PointKind::End];
    let found = increments.iter().find(is_there).map(|increment| &increment.point);
    assert!(found.is_some_and(|point| kinds.contains(&point.kind)), "an event in {stage} at s = {load}: {found:?}");
}

#[test]
fn it_is_held_until_no_sharing_is_left_and_ends_there() {
    let corner = corner();
    let (met, let_go) = (WAY + corner.slides_on_floor(), WAY + corner.is_let_go());
    assert!(corner.slides_along() + WAY < met && met < let_go, "{} {met} {let_go}", corner.slides_along() + WAY);
    // Independently: the cones hold the force up to there, and no farther.
    let cones = [([0.0, 0.0, 1.0], FLOOR), (corner.wall, WALL)];
    let off = |s: f64| distance(&cones, &[0, 1, 2].map(|k| f64::from(k == 2) - (s - WAY) * corner.pull[k as usize]));
    assert!(
        off(let_go - 1e-4) < 1e-9 && off(let_go + 1e-4) > 1e-6,
        "{:e} {:e}",
        off(let_go - 1e-4),
        off(let_go + 1e-4)
    );
    each(&[("pull", 1.0, 2.0)], |increments, reason| {
        assert_eq!(reason, StopReason::NoDirection);
        passes(increments, "pull", met);
        let last = increments.last().expect("an end");
        assert_eq!(last.point.kind, PointKind::End);
        close(last.load_factor, let_go, 1e-11, "the end");
        for increment in increments.iter().filter(|increment| &*increment.stage == "pull") {
            is_at(increment, (increment.load_factor - 1.0).clamp(0.0, WAY), 0.0);
            if increment.load_factor > met + 1e-9 {
                assert!(increment.contacts.iter().all(|contact| contact.status == Status::Stick));
            }
        }
    });
}

#[test]
fn back_within_what_a_slide_bears_it_slides_when_pulled_again() {
    let corner = corner();
    let held = WAY + 0.5 * (corner.slides_on_floor() + corner.is_let_go());
    let stages = [("pull", 1.0, held), ("back", -1.0, 0.5), ("again", 1.0, 0.9)];
    each(&stages, |increments, reason| {
        assert_eq!(reason, StopReason::StagesCompleted);
        passes(increments, "again", corner.slides_along() + WAY + 0.5 - held);
        for increment in increments {
            let s = increment.load_factor;
            match &*increment.stage {
                "back" => is_at(increment, WAY, 0.0),
                "again" => is_at(increment, WAY, corner.way_along(held - WAY - 0.5 + s).max(0.0)),
                _ => {}
            }
        }
    });
}

/// The same within one stage, by a node that is pulled along another way: its force passes through what a slide bears and
/// leaves it again, however long the steps are.
#[test]
fn a_force_that_only_passes_what_a_slide_bears_makes_it_slide() {
    let corner = corner();
    let held = WAY + 0.5 * (corner.slides_on_floor() + corner.is_let_go());
    // Along the edge, against the pull: q d·e falls through zero to the other side, where the node slides back.
    let back = json!({"name": "back", "forces": {"node": [0, -1, 0]}, "until": {"load_above": 2.5}});
    for longest in [1.0, 0.05] {
        let mut request = request(&[("pull", 1.0, held)], longest);
        request.model.stages.push(serde_json::from_value(back.clone()).expect("a stage"));
        for request in [request.clone(), in_reverse(request)] {
            let (increments, report) = trace(&request);
            assert_eq!(report.stop_reason, StopReason::StagesCompleted, "{:?}", increments.last());
            let q = held - WAY;
            let [floor, wall] = corner.normals(q);
            let slides = q * corner.pull[1] + FLOOR * floor + WALL * wall;
            passes(&increments, "back", slides);
            for increment in increments.iter().filter(|increment| &*increment.stage == "back") {
                is_at(increment, WAY, -(increment.load_factor - slides).max(0.0));
            }
        }
    }
}
