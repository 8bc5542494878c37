//! Requests and their traced paths, every increment judged.

use arcslip::cancel::CancelFlag;
use arcslip::measure::Judge;
use arcslip::model::JobRequest;
use arcslip::path::{Increment, Path, Report, Scene};

/// A built-in scene's request.
pub fn scene(name: &str) -> JobRequest {
    request(arcslip::scenes::find(name).expect("built-in scene").request)
}

/// A request from JSON text.
pub fn request(text: &str) -> JobRequest {
    arcslip::model::decode::decode(text.as_bytes()).unwrap_or_else(|errors| panic!("{errors}"))
}

/// The whole path of a request. Every increment is judged by the measure that stands apart from the solver.
pub fn trace(request: &JobRequest) -> (Vec<Increment>, Report) {
    let scene = Scene::new(request).unwrap_or_else(|errors| panic!("{errors}"));
    let mut path = Path::new(&scene, CancelFlag::default());
    let increments: Vec<Increment> = path.by_ref().collect();
    let report = path.report().expect("an ended path has a report");
    let mut judge = Judge::new(request, scene.plan().displacement_scale);
    for increment in &increments {
        let errors = judge.judge(increment);
        let name = request.model.name.as_deref().unwrap_or("unnamed");
        assert!(errors.largest_of_state() <= 1e-10, "{name}, increment {}: {errors:?}", increment.index);
        assert!(errors.strain_energy <= 1e-10, "{name}, increment {}: {errors:?}", increment.index);
        assert!(errors.energy <= 1e-6, "{name}, increment {}: {errors:?}", increment.index);
    }
    for (index, increment) in increments.iter().enumerate() {
        assert_eq!(increment.index, index as u64);
    }
    (increments, report)
}
