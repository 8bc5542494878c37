//! Random small scenes, of fixed seeds, two hundred and more in space: what must hold of every path holds of theirs.

use crate::common::paths::{Traced, judged};
use crate::common::random::{random_frame, random_scene, random_space};
use crate::common::random_curves::random_on_curve;
use crate::common::random_solids::random_solid;
use crate::common::variants::turned_in_plane;
use arcslip::continuation::scene::Scene;
use arcslip::model::JobRequest;
use arcslip::model::request::Method;
use arcslip::result::increment::{Increment, PointKind};
use arcslip::result::stop_reason::StopReason;

const SCENES: u64 = 200;
const FRAMES: u64 = 200;
const BODIES: u64 = 100;
const ON_CURVES: u64 = 120;
const SCENES_IN_SPACE: u64 = 60;
/// Scenes in space whose slips begin or end hardly pressed, or are pressed only once the node has moved, and go on.
const HARDLY_PRESSED: [u64; 22] =
    [110, 123, 131, 192, 196, 218, 233, 264, 297, 312, 313, 330, 361, 422, 479, 541, 544, 581, 690, 778, 853, 895];
/// Threads that share the scenes: each path is the same whatever runs beside it.
const THREADS: usize = 4;

fn by(request: &JobRequest, method: Method) -> Traced {
    let mut request = request.clone();
    request.analysis.method = method;
    judged(&request)
}

/// What is wrong with a path.
fn faults(traced: &Traced) -> Vec<String> {
    let mut faults = Vec::new();
    for (increment, errors) in traced.increments.iter().zip(&traced.errors) {
        let index = increment.index;
        let mut fault = |what: String| faults.push(format!("increment {index}: {what}"));
        if errors.largest_of_state() > 1e-10 {
            fault(format!("{errors:?}"));
        }
        if errors.energy > 1e-6 || errors.strain_energy > 1e-10 {
            fault(format!("energy {errors:?}"));
        }
        let point = &increment.point;
        if let Some(directions) = &increment.directions
            && directions.len() % 2 == 1
            && !point.degenerate
            && point.unexplored_modes == 0
        {
            fault(format!("{} directions", directions.len()));
        }
    }
    if traced.report.stop_reason == StopReason::StepUnderflow {
        faults.push(format!("stops: {:?}", traced.report));
    }
    faults
}

/// Where the two methods differ.
fn difference(auto: &[Increment], mpec: &[Increment]) -> Option<String> {
    if auto.len() != mpec.len() {
        return Some(format!("{} and {} increments", auto.len(), mpec.len()));
    }
    auto.iter().zip(mpec).find_map(|(a, b)| {
        let place = |what: &str| Some(format!("the paths differ at increment {}: {what}", a.index));
        if a.point.kind != b.point.kind {
            return place("kind");
        }
        if (a.load_factor - b.load_factor).abs() > 1e-8 {
            return place("load");
        }
        let moved = a.displacements.values().flatten().zip(b.displacements.values().flatten());
        moved.fold(0.0_f64, |most, (a, b)| most.max((a - b).abs())).gt(&1e-8).then(|| place("displacements"))?
    })
}

/// What a share of the scenes showed.
#[derive(Default)]
struct Seen {
    faulty: Vec<String>,
    degenerate: u64,
    contact_changes: usize,
    smooth_limits: usize,
    bifurcations: usize,
}

fn judge_share(scene: fn(u64) -> JobRequest, seeds: impl Iterator<Item = u64>) -> Seen {
    let mut seen = Seen::default();
    for seed in seeds {
        let request = scene(seed);
        // Scenes of more than this version takes are faults like any other, told with their reason.
        if let Err(errors) = Scene::new(&request) {
            seen.faulty.push(format!("{seed}: refused: {}", errors.0[0]));
            continue;
        }
        let auto = by(&request, Method::Auto);
        let mut found = faults(&auto);
        let mpec = by(&request, Method::Mpec);
        found.extend(faults(&mpec).into_iter().map(|fault| format!("mpec: {fault}")));
        found.extend(difference(&auto.increments, &mpec.increments));
        seen.degenerate += u64::from(auto.increments.iter().any(|increment| increment.point.degenerate));
        let count = |kind: PointKind| auto.increments.iter().filter(|increment| increment.point.kind == kind).count();
        seen.contact_changes += count(PointKind::ContactChange) + count(PointKind::NonsmoothLimit);
        seen.smooth_limits += count(PointKind::SmoothLimit);
        seen.bifurcations += auto.increments.iter().filter(|increment| increment.point.bifurcation).count();
        if let Some(first) = found.first() {
            seen.faulty.push(format!("{seed}: {} faults, the first: {first}", found.len()));
        }
    }
    seen
}

fn judge_all(scene: fn(u64) -> JobRequest, seeds: &[u64]) -> Seen {
    let scenes = seeds.len();
    let judge = |share: usize| {
        let own: Vec<u64> = seeds.iter().skip(share).step_by(THREADS).copied().collect();
        std::thread::spawn(move || judge_share(scene, own.into_iter()))
    };
    let shares: Vec<_> = (0..THREADS).map(judge).collect();
    let mut all = Seen::default();
    for share in shares {
        let seen = share.join().expect("no panic in a scene");
        all.faulty.extend(seen.faulty);
        all.degenerate += seen.degenerate;
        all.contact_changes += seen.contact_changes;
        all.smooth_limits += seen.smooth_limits;
        all.bifurcations += seen.bifurcations;
    }
    all.faulty.sort_by_key(|fault| fault.split(':').next().and_then(|seed| seed.parse::<u64>().ok()));
    let Seen { faulty, degenerate, contact_changes, smooth_limits, bifurcations } = &all;
    println!(
        "{contact_changes} contact changes, {smooth_limits} smooth limits, {bifurcations} bifurcation points; \
         {degenerate} scenes of {scenes} report a degenerate point"
    );
    assert!(faulty.is_empty(), "{} of {scenes} scenes:\n{}", faulty.len(), faulty.join("\n"));
    all
}

#[test]
fn every_path_keeps_the_laws() {
    let seeds: Vec<u64> = (0..SCENES).collect();
    let Seen { degenerate, contact_changes, smooth_limits, bifurcations, .. } = judge_all(random_scene, &seeds);
    // Touches in space and corners end more of them than parity does.
    assert!(degenerate <= 3 * SCENES / 20, "{degenerate} scenes report a degenerate point");
    // The scenes are not idle.
    assert!(contact_changes >= 100 && smooth_limits >= 20 && bifurcations >= 50);
}

#[test]
fn every_path_on_curves_keeps_the_laws() {
    let seeds: Vec<u64> = (0..ON_CURVES).collect();
    let Seen { contact_changes, smooth_limits, .. } = judge_all(random_on_curve, &seeds);
    assert!(contact_changes >= 50 && smooth_limits >= 10);
}

#[test]
fn every_path_in_space_keeps_the_laws() {
    let seeds: Vec<u64> = (0..SCENES_IN_SPACE).chain(HARDLY_PRESSED).collect();
    let Seen { contact_changes, .. } = judge_all(random_space, &seeds);
    assert!(contact_changes >= 100);
    for seed in HARDLY_PRESSED {
        let reason = judged(&random_space(seed)).report.stop_reason;
        let goes_on = matches!(reason, StopReason::StagesCompleted | StopReason::MaxIncrements);
        assert!(goes_on, "scene {seed} in space: {reason:?}");
    }
}

#[test]
fn every_path_of_a_frame_keeps_the_laws() {
    let seeds: Vec<u64> = (0..FRAMES).collect();
    let Seen { contact_changes, smooth_limits, bifurcations, .. } = judge_all(random_frame, &seeds);
    // Beams are stiffer than bars, and fewer of them snap.
    assert!(contact_changes >= 30 && smooth_limits >= 5 && bifurcations >= 100);
}

#[test]
fn every_path_of_a_body_keeps_the_laws() {
    let seeds: Vec<u64> = (0..BODIES).collect();
    let Seen { contact_changes, .. } = judge_all(random_solid, &seeds);
    assert!(contact_changes >= 100);
}

/// A turned and moved frame has the turned path: its events at the same loads, its nodes at the turned places.
#[test]
fn frames_are_objective() {
    are_objective(random_frame, FRAMES);
}

#[test]
fn bodies_are_objective() {
    are_objective(random_solid, BODIES);
}

fn are_objective(scene: fn(u64) -> JobRequest, scenes: u64) {
    let (angle, shift) = (0.7_f64, 0.3);
    let (sine, cosine) = angle.sin_cos();
    let mut faulty = Vec::new();
    for seed in 0..scenes {
        let mut request = scene(seed);
        // The default is the diagonal of a box, which turns.
        let plan = judged(&request).plan;
        let arc_length = &mut request.analysis.arc_length;
        arc_length.displacement_scale = Some(plan.displacement_scale);
        // The stiffness along one axis differs from that along another.
        arc_length.load_scale = Some(plan.load_scales[0]);
        let (plain, other) = (judged(&request), judged(&turned_in_plane(request, angle, shift)));
        let mut back = other.increments.clone();
        for increment in &mut back {
            let turn = |place: &[f64]| {
                let mut turned = place.to_vec();
                turned[0] = cosine * place[0] + sine * place[1];
                turned[1] = cosine * place[1] - sine * place[0];
                turned
            };
            increment.displacements =
                increment.displacements.iter().map(|(node, place)| (node.to_owned(), turn(place))).collect();
        }
        faulty.extend(difference(&plain.increments, &back).map(|fault| format!("{seed}: {fault}")));
    }
    assert!(faulty.is_empty(), "{} of {scenes}:\n{}", faulty.len(), faulty.join("\n"));
}

/// The same seed, the same scene; another seed, another.
#[test]
fn seeds_fix_the_scenes() {
    assert_eq!(random_scene(7), random_scene(7));
    assert_ne!(random_scene(7), random_scene(8));
    assert!((0..SCENES).filter(|seed| random_scene(*seed).model.dimension == 3).count() > 20);
    let balls = |seed: u64| random_scene(seed).model.obstacles.len() > 1;
    assert!((0..SCENES).filter(|seed| balls(*seed)).count() > 50);
}
