//! Two hundred random small scenes, of fixed seeds: what must hold of every path holds of theirs.

mod common;

use arcslip::model::JobRequest;
use arcslip::model::request::Method;
use arcslip::path::{Increment, Scene, StopReason};
use common::paths::{Traced, judged};
use common::random::random_scene;

const SCENES: u64 = 200;
/// Threads that share the scenes: each path is the same whatever runs beside it.
const THREADS: u64 = 4;

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
        let place = |what: &str| Some(format!("auto and mpec differ at increment {}: {what}", a.index));
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

fn judge_share(share: u64) -> (Vec<String>, u64) {
    let (mut faulty, mut degenerate) = (Vec::new(), 0);
    for seed in (0..SCENES).filter(|seed| seed % THREADS == share) {
        let request = random_scene(seed);
        // Scenes of more than this version takes are faults like any other, told with their reason.
        if let Err(errors) = Scene::new(&request) {
            faulty.push(format!("{seed}: refused: {}", errors.0[0]));
            continue;
        }
        let auto = by(&request, Method::Auto);
        let mut found = faults(&auto);
        let mpec = by(&request, Method::Mpec);
        found.extend(faults(&mpec).into_iter().map(|fault| format!("mpec: {fault}")));
        found.extend(difference(&auto.increments, &mpec.increments));
        degenerate += u64::from(auto.increments.iter().any(|increment| increment.point.degenerate));
        if let Some(first) = found.first() {
            faulty.push(format!("{seed}: {} faults, the first: {first}", found.len()));
        }
    }
    (faulty, degenerate)
}

#[test]
fn every_path_keeps_the_laws() {
    let shares: Vec<_> = (0..THREADS).map(|share| std::thread::spawn(move || judge_share(share))).collect();
    let (mut faulty, mut degenerate) = (Vec::new(), 0);
    for share in shares {
        let (found, count) = share.join().expect("no panic in a scene");
        faulty.extend(found);
        degenerate += count;
    }
    faulty.sort_by_key(|fault| fault.split(':').next().and_then(|seed| seed.parse::<u64>().ok()));
    println!("{degenerate} of {SCENES} scenes report a degenerate point");
    assert!(faulty.is_empty(), "{} of {SCENES} scenes:\n{}", faulty.len(), faulty.join("\n"));
    assert!(degenerate <= SCENES / 20, "{degenerate} scenes report a degenerate point");
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
