//! Jumps beside exact states and beside states of paths that were followed past them.

use super::{jump, von_mises};
use crate::common::paths::{close, scene_file, trace, typed};
use arcslip::continuation::path::checkpoint::Checkpoint;
use arcslip::continuation::path::iterator::Path;
use arcslip::continuation::scene::Scene;
use arcslip::model::JobRequest;
use arcslip::model::request::{JumpMotion, JumpMotionKind, OnPathEnd, StageControl, Until};
use arcslip::resources::cancel::CancelFlag;
use arcslip::result::increment::{Increment, PointKind, Status};
use arcslip::result::stop_reason::StopReason;
use serde_json::{Value, json};
use std::f64::consts::FRAC_PI_2;

/// A built-in scene whose load only rises.
fn under_load(name: &str) -> JobRequest {
    let mut request = scene_file(name);
    request.model.stages.last_mut().expect("a stage").control = StageControl::Load;
    request
}

/// Load, strain energy and path of von Mises' truss with engineering strain, `EA = b = 1`, `h = 1/2`.
struct Truss {
    rest: f64,
}

impl Truss {
    fn new() -> Self {
        Self { rest: 1.25_f64.sqrt() }
    }

    fn load(&self, height: f64) -> f64 {
        let length = (1.0 + height * height).sqrt();
        -2.0 * (length / self.rest - 1.0) * height / length
    }

    fn strain_energy(&self, height: f64) -> f64 {
        let stretch = (1.0 + height * height).sqrt() - self.rest;
        stretch * stretch / self.rest
    }

    /// The height above the largest load, `L³ = L0`, and the load there.
    fn limit(&self) -> (f64, f64) {
        let height = (self.rest.powf(2.0 / 3.0) - 1.0).sqrt();
        (height, self.load(height))
    }

    /// The height of the far branch at a load.
    fn far(&self, load: f64) -> f64 {
        let (mut low, mut high) = (-2.0, -0.5);
        for _ in 0..200 {
            let middle = 0.5 * (low + high);
            if self.load(middle) > load { low = middle } else { high = middle }
        }
        0.5 * (low + high)
    }
}

#[test]
fn von_mises_truss_jumps_to_the_far_branch() {
    let truss = Truss::new();
    let (height, load) = truss.limit();
    let far = truss.far(load);
    for kind in [JumpMotionKind::Overdamped, JumpMotionKind::Inertial] {
        let mut request = under_load("von-mises-truss");
        request.analysis.jump_motion = Some(JumpMotion::of(kind));
        let (increments, report) = trace(&request);
        let (before, after) = jump(&increments);
        assert_eq!(before.point.kind, PointKind::SmoothLimit);
        close(before.load_factor, load, 1e-12, "limit load");
        close(after.load_factor, before.load_factor, 0.0, "the load stays");
        let heights = [before, after].map(|one| 0.5 + one.displacements["apex"][1]);
        close(heights[0], height, 1e-8, "height at the limit");
        close(heights[1], far, 1e-9, "height after the jump");
        let released = load * (height - far) - (truss.strain_energy(far) - truss.strain_energy(height));
        close(after.energy.released, released, 1e-7 * released, "energy given off");
        let later = increments.iter().skip_while(|one| one.point.kind != PointKind::Jump);
        assert!(
            later
                .min_by(|a, b| a.load_factor.total_cmp(&b.load_factor))
                .is_some_and(|one| one.point.kind == PointKind::Jump)
        );
        assert_eq!(report.stop_reason, StopReason::StagesCompleted);
    }
}

/// The state of a path that is followed to a load, past all limit points before it.
fn followed(request: &JobRequest, load: f64) -> Increment {
    let mut request = request.clone();
    let stage = request.model.stages.last_mut().expect("a stage");
    stage.control = StageControl::Path;
    // The limit load itself is touched, a hair above it is not.
    stage.until = Some(Until { load_above: Some(load * (1.0 + 1e-9)), ..Until::default() });
    request.analysis.on_path_end = OnPathEnd::Stop;
    let (increments, report) = trace(&request);
    assert_eq!(report.stop_reason, StopReason::StagesCompleted);
    increments.last().expect("an end").clone()
}

#[test]
fn the_arch_type_truss_lands_where_its_path_leads() {
    let (increments, _) = trace(&under_load("arch-type-truss"));
    let (before, after) = jump(&increments);
    close(before.load_factor, 0.0095675907, 1e-9, "limit load");
    assert_eq!(
        after.contacts.iter().filter(|contact| contact.gap.abs() < 1e-12).count(),
        2,
        "the crown is on the floor"
    );
    // With friction the foot remembers how it came there; without, the state is that of the path.
    let mut request = under_load("arch-type-truss");
    request.model.contacts.iter_mut().for_each(|contact| contact.friction = 0.0);
    let (increments, _) = trace(&request);
    let (before, after) = jump(&increments);
    let far = followed(&request, before.load_factor);
    let nodes = after.displacements.iter().zip(far.displacements.iter());
    for ((name, found), (_, followed)) in nodes {
        found.iter().zip(followed).for_each(|(found, followed)| close(*found, *followed, 1e-8, name));
    }
}

/// Klarbring's node leaves the floor: `K u = (1.5, -1)` with `K = [[1, -0.8], [-0.8, 1]]`.
#[test]
fn klarbrings_node_jumps_to_the_free_branch() {
    let (increments, _) = trace(&under_load("klarbring"));
    let (before, after) = jump(&increments);
    close(before.load_factor, 1.5, 1e-12, "load");
    close(after.displacements["node"][0], 0.7 / 0.36, 1e-10, "x");
    close(after.displacements["node"][1], 0.2 / 0.36, 1e-10, "y");
    assert_eq!(after.contacts[0].status, Status::Free);
    let energy = after.energy;
    close(energy.external_work, 1.5 * 0.7 / 0.36 - 0.2 / 0.36, 1e-10, "work");
    close(energy.strain, 0.5 * energy.external_work, 1e-10, "of a linear structure");
    assert!(energy.dissipated > 0.5 && energy.released > 0.1, "it slides, then lifts off: {energy:?}");
}

/// The tip of the one-bar truss passes under the pin, leaves the floor and comes to rest straight behind the pin: a bar in
/// tension bears any load. On its way it gives off what the load does and the bar does not store.
#[test]
fn the_one_bar_truss_hangs_from_its_pin() {
    let mut request = under_load("one-bar-truss");
    request.model.stages[0].until = Some(Until { load_above: Some(0.5), ..Until::default() });
    for kind in [JumpMotionKind::Overdamped, JumpMotionKind::Inertial] {
        request.analysis.jump_motion = Some(JumpMotion::of(kind));
        let (increments, report) = trace(&request);
        assert_eq!(report.stop_reason, StopReason::StagesCompleted);
        let (before, after) = jump(&increments);
        assert_eq!(before.load_factor, after.load_factor);
        let length = 3.25_f64.sqrt() * (1.0 + after.load_factor);
        close(after.displacements["tip"][0], length + 1.5, 1e-9, "x");
        close(after.displacements["tip"][1], 1.0, 1e-9, "y");
        assert_eq!(after.contacts[0].status, Status::Free);
    }
}

/// Half an arch on a rough floor, its crown pressed by a dead load.
fn arch(friction: f64) -> JobRequest {
    let count = 16;
    let mut nodes = serde_json::Map::new();
    for k in 0..=count {
        let angle = FRAC_PI_2 * f64::from(k) / f64::from(count);
        nodes.insert(format!("n{k}"), json!([angle.sin(), if k == count { 0.0 } else { angle.cos() }]));
    }
    let elements: Vec<Value> = (0..count)
        .map(|k| {
            let ends = [format!("n{k}"), format!("n{}", k + 1)];
            json!({"kind": "beam", "nodes": ends, "axial_stiffness": 1e4, "bending_stiffness": 1.0})
        })
        .collect();
    typed(json!({
        "model": {
            "dimension": 2, "nodes": nodes, "elements": elements, "supports": {"n0": ["x", "rz"]},
            "obstacles": {"floor": {"kind": "plane", "point": [0, 0], "normal": [0, 1]}},
            "contacts": [{"node": format!("n{count}"), "obstacle": "floor", "friction": friction}],
            "stages": [{
                "name": "press", "forces": {"n0": [0, -0.5]}, "control": "load", "until": {"load_above": 11}
            }],
        },
    }))
}

#[test]
fn an_arch_on_a_rough_floor_jumps_at_its_first_limit_point() {
    let request = arch(0.8);
    let (increments, report) = trace(&request);
    assert_eq!(report.stop_reason, StopReason::StagesCompleted);
    let (before, after) = jump(&increments);
    assert_eq!(before.point.kind, PointKind::NonsmoothLimit, "the foot slips");
    let far = followed(&request, before.load_factor);
    for node in ["n0", "n8", "n16"] {
        let nodes = after.displacements[node].iter().zip(&far.displacements[node]);
        nodes.for_each(|(found, followed)| close(*found, *followed, 1e-8, node));
    }
}

/// A block on a rough floor is pulled until it slides: without a wall it slides on for ever, with one it stops there.
#[test]
fn a_block_slides_to_the_wall_or_away() {
    let request = |wall: bool| {
        let mut model = json!({
            "dimension": 2, "nodes": {"block": [0, 0]},
            "elements": [{"kind": "spring", "nodes": ["block"], "stiffness": [[0, 0], [0, 1]]}],
            "obstacles": {"floor": {"kind": "plane", "point": [0, 0], "normal": [0, 1]}},
            "contacts": [{"node": "block", "obstacle": "floor", "friction": 0.5}],
            "stages": [
                {"name": "press", "forces": {"block": [0, -1]}, "until": {"load_above": 1}},
                {"name": "pull", "forces": {"block": [1, 0]}, "control": "load", "until": {"load_above": 2}},
            ],
        });
        if wall {
            model["obstacles"]["wall"] = json!({"kind": "plane", "point": [3, 0], "normal": [-1, 0]});
            model["contacts"].as_array_mut().expect("a list").push(json!({"node": "block", "obstacle": "wall"}));
        }
        typed(json!({ "model": model }))
    };
    let mut alone = request(false);
    let (increments, report) = trace(&alone);
    assert_eq!(report.stop_reason, StopReason::NoEquilibrium, "{report:?}");
    alone.analysis.jump_motion = Some(JumpMotion { compare: true, max_steps: 200, ..JumpMotion::default() });
    let sentence = trace(&alone).1.sentence;
    assert!(sentence.contains("neither does an inertial motion come to rest"), "{sentence}");
    close(increments.last().expect("an end").load_factor, 0.5, 1e-12, "load at which it slides");
    let (increments, report) = trace(&request(true));
    assert_eq!(report.stop_reason, StopReason::StagesCompleted, "{report:?}");
    let after = jump(&increments).1;
    close(after.displacements["block"][0], 3.0, 1e-9, "at the wall");
    close(after.energy.dissipated, 1.5, 1e-6, "friction along the way");
}

fn line(mut increment: Increment) -> String {
    increment.diagnostics.elapsed_s = 0.0;
    serde_json::to_string(&increment).expect("written")
}

#[test]
fn a_jump_is_resumed_bit_for_bit_at_every_row() {
    let mut request = under_load("arch-type-truss");
    request.analysis.jump_motion = Some(JumpMotion { keep_steps: true, compare: true, ..JumpMotion::default() });
    let scene = Scene::new(&request).expect("a scene");
    let whole: Vec<Increment> = Path::new(&scene, CancelFlag::default()).collect();
    assert!(whole.iter().filter(|one| one.point.kind == PointKind::Motion).count() > 20);
    let mut path = Path::new(&scene, CancelFlag::default());
    let mut resumed = Vec::new();
    while let Some(increment) = path.next() {
        resumed.push(increment);
        let text = serde_json::to_string(&path.checkpoint()).expect("written");
        let checkpoint: Checkpoint = serde_json::from_str(&text).expect("read");
        path = Path::resume(&scene, checkpoint, CancelFlag::default()).expect("a path");
    }
    assert_eq!(resumed.len(), whole.len());
    resumed.into_iter().zip(whole).for_each(|(resumed, whole)| assert_eq!(line(resumed), line(whole)));
}

#[test]
fn kept_time_steps_lead_to_the_same_state() {
    let rows = |keep_steps: bool| {
        let mut request = under_load("klarbring");
        request.analysis.jump_motion = Some(JumpMotion { keep_steps, ..JumpMotion::default() });
        trace(&request).0
    };
    let (kept, whole) = (rows(true), rows(false));
    let (last, only) = (jump(&kept).1, jump(&whole).1);
    assert_eq!((&last.displacements, last.energy), (&only.displacements, only.energy));
}

#[test]
fn without_friction_both_motions_agree_and_with_friction_they_say_which() {
    let at_rest = |kind: JumpMotionKind, friction: f64| {
        let mut request = under_load("arch-type-truss");
        request.model.contacts.iter_mut().for_each(|contact| contact.friction = friction);
        let damping_ratio = (kind == JumpMotionKind::Inertial).then_some(3.0);
        request.analysis.jump_motion = Some(JumpMotion { damping_ratio, ..JumpMotion::of(kind) });
        let (increments, _) = trace(&request);
        let after = jump(&increments).1.clone();
        assert!(after.point.event.as_ref().expect("an event").contains("motion"));
        after
    };
    let [slow, fast] = [JumpMotionKind::Overdamped, JumpMotionKind::Inertial].map(|kind| at_rest(kind, 0.0));
    for (name, place) in slow.displacements.iter() {
        place.iter().zip(&fast.displacements[&**name]).for_each(|(slow, fast)| close(*slow, *fast, 1e-8, name));
    }
}

/// Both motions of one run: without friction they come to rest in one state; with friction and little damping each as in a
/// run of its own, and the row says how far apart.
#[test]
fn both_motions_are_compared_on_request() {
    let kinds = [JumpMotionKind::Overdamped, JumpMotionKind::Inertial];
    let at_rest = |kind: JumpMotionKind, friction: f64, damping_ratio: f64, compare: bool| {
        let mut request = under_load("arch-type-truss");
        request.model.contacts.iter_mut().for_each(|contact| contact.friction = friction);
        let damping_ratio = (kind == JumpMotionKind::Inertial).then_some(damping_ratio);
        request.analysis.jump_motion = Some(JumpMotion { compare, damping_ratio, ..JumpMotion::of(kind) });
        jump(&trace(&request).0).1.clone()
    };
    // The overdamped motion is compared with the inertial one of damping ratio 1.
    for (friction, damping, compared) in [(0.0, 1.0, &kinds[..]), (0.4, 1.0, &kinds), (0.4, 0.1, &kinds[1..])] {
        let alone = kinds.map(|kind| at_rest(kind, friction, damping, false));
        assert!(alone.iter().all(|one| one.other_motion.is_none()));
        let places = alone[0].displacements.iter().map(|(name, place)| (place, &alone[1].displacements[&**name]));
        let apart = places.map(|(a, b)| (a[0] - b[0]).hypot(a[1] - b[1])).fold(0.0, f64::max);
        for kind in compared {
            let [own, opposite] = if *kind == kinds[0] { [0, 1] } else { [1, 0] };
            let both = at_rest(*kind, friction, damping, true);
            let other = both.other_motion.as_ref().expect("asked for");
            assert_eq!(both.displacements, alone[own].displacements, "the path's own motion is the same");
            assert_eq!((other.kind, other.at_rest), (kinds[opposite], true));
            let distance = other.distance.expect("at rest");
            close(distance, apart, 1e-15, "of the runs of their own");
            close(other.released, alone[opposite].energy.released, 1e-14, "energy given off");
            let event = both.point.event.as_deref().expect("an event");
            assert!(event.contains(&format!("comes to rest {distance:.3e} away from there")), "{event}");
        }
        println!("friction {friction}, damping ratio {damping}: {apart:e} apart");
        assert!(if friction == 0.0 { apart < 1e-9 } else { damping == 1.0 || apart > 1e-5 });
    }
}

/// A tall truss whose apex buckles sideways before the load maximum: it jumps there, as one with an imperfection does.
#[test]
fn a_perfect_truss_jumps_where_it_loses_its_stability() {
    let request = |aside: f64| {
        typed(json!({
            "model": {
                "dimension": 2, "nodes": {"l": [-1, 0], "top": [aside, 3], "r": [1, 0]},
                "supports": {"l": ["x", "y"], "r": ["x", "y"]},
                "elements": [
                    {"kind": "bar", "nodes": ["l", "top"], "axial_stiffness": 1},
                    {"kind": "bar", "nodes": ["top", "r"], "axial_stiffness": 1},
                ],
                "stages": [{"name": "load", "forces": {"top": [0, -1]}, "control": "load", "until": {"load_above": 0.5}}],
            },
            "analysis": {"record": {"stability": true}},
        }))
    };
    let (perfect, _) = trace(&request(0.0));
    let (before, after) = jump(&perfect);
    assert_eq!(before.point.kind, PointKind::SmoothBifurcation);
    let (imperfect, _) = trace(&request(1e-4));
    let (nearby, hanging) = jump(&imperfect);
    close(before.load_factor, nearby.load_factor, 2e-3, "load");
    close(after.displacements["top"][1], hanging.displacements["top"][1], 1e-2, "it hangs below its supports");
    assert!(after.displacements["top"][1] < -6.0);
    let stability = after.stability.expect("asked for");
    assert_eq!(stability.negative_eigenvalues, Some(0));
    // With inertia likewise: the push towards a branch is no motion of its own.
    let mut inertial = request(0.0);
    for damping_ratio in [0.1, 1.0] {
        let motion = JumpMotion { damping_ratio: Some(damping_ratio), ..JumpMotion::of(JumpMotionKind::Inertial) };
        inertial.analysis.jump_motion = Some(motion);
        let (increments, _) = trace(&inertial);
        let at_rest = jump(&increments).1;
        close(at_rest.displacements["top"][1], after.displacements["top"][1], 1e-9, "the same state");
    }
}

/// A stop at which the apex arrives in full swing, and holds all motion for a step: it is pushed off again, and comes to the
/// rest of the motion without mass, `(0.5 + y)(1/l - 1/L) = s/2`.
#[test]
fn a_structure_that_a_stop_holds_in_its_motion_is_not_at_rest_there() {
    let mut rests = Vec::new();
    for (kind, ratio) in
        [("overdamped", None), ("inertial", Some(1.0)), ("inertial", Some(0.1)), ("inertial", Some(0.02))]
    {
        for stop in [-0.60, -0.62, -0.64, -0.65, -0.68, -0.70, -0.75] {
            let stages = json!([{"name": "press", "forces": {"apex": [0, -1]}, "control": "load", "until": {"load_above": 0.039}}]);
            let mut motion = json!({"kind": kind});
            if let Some(ratio) = ratio {
                motion["damping_ratio"] = json!(ratio);
            }
            let mut request = von_mises(&stages, &json!({"jump_motion": motion}));
            request["model"]["obstacles"] = json!({"stop": {"kind": "plane", "point": [0, stop], "normal": [0, 1]}});
            request["model"]["contacts"] = json!([{"node": "apex", "obstacle": "stop", "friction": 0}]);
            let (increments, report) = trace(&typed(request));
            assert_eq!(report.stop_reason, StopReason::StagesCompleted, "{kind} {ratio:?} {stop}");
            let (_, after) = jump(&increments);
            rests.push((after.displacements["apex"][1], stop - 0.5));
        }
    }
    for (rest, stop) in &rests {
        close(*rest, f64::max(rests[5].0, *stop), 1e-8, "the state at rest");
    }
}
