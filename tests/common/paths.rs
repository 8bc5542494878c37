//! Requests and their traced paths, every increment judged.

use arcslip::check::measure::{Errors, Judge};
use arcslip::continuation::path::iterator::Path;
use arcslip::continuation::scene::Scene;
use arcslip::model::JobRequest;
use arcslip::resources::cancel::CancelFlag;
use arcslip::result::increment::Increment;
use arcslip::result::plan::Plan;
use arcslip::result::report::Report;
use serde_json::Value;

/// A built-in scene's request.
pub fn scene(name: &str) -> JobRequest {
    request(arcslip::check::scenes::find(name).expect("built-in scene").request)
}

/// A request from JSON text.
pub fn request(text: &str) -> JobRequest {
    arcslip::model::decode::decode(text.as_bytes()).unwrap_or_else(|errors| panic!("{errors}"))
}

/// A request from a JSON value, by its types alone.
pub fn typed(value: Value) -> JobRequest {
    serde_json::from_value(value).unwrap_or_else(|error| panic!("{error}"))
}

/// The request of a scene's file, by its types alone.
pub fn scene_file(name: &str) -> JobRequest {
    let file = format!("{}/src/check/scenes/{name}.json", env!("CARGO_MANIFEST_DIR"));
    let text = std::fs::read_to_string(&file).unwrap_or_else(|error| panic!("{file}: {error}"));
    serde_json::from_str(&text).unwrap_or_else(|error| panic!("{file}: {error}"))
}

/// A whole path and what the measure says of each increment.
pub struct Traced {
    pub increments: Vec<Increment>,
    pub errors: Vec<Errors>,
    pub report: Report,
    pub plan: Plan,
}

/// The whole path of a request, judged by the measure that stands apart from the solver; nothing is asserted of it.
pub fn judged(request: &JobRequest) -> Traced {
    let scene = Scene::new(request).unwrap_or_else(|errors| panic!("{errors}"));
    let mut path = Path::new(&scene, CancelFlag::default());
    let increments: Vec<Increment> = path.by_ref().collect();
    let report = path.report().expect("an ended path has a report");
    let plan = scene.plan().clone();
    let mut judge = judge(request, &plan);
    let errors = increments.iter().map(|increment| judge.judge(increment)).collect();
    Traced { increments, errors, report, plan }
}

/// A judge of the request's paths.
pub fn judge(request: &JobRequest, plan: &Plan) -> Judge {
    Judge::new(request, plan.displacement_scale, &plan.load_scales)
}

/// The whole path of a request, every increment held to the bars.
pub fn trace(request: &JobRequest) -> (Vec<Increment>, Report) {
    let Traced { increments, errors, report, .. } = judged(request);
    for (increment, errors) in increments.iter().zip(errors) {
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

/// The place of a node along an increment.
pub fn place(request: &JobRequest, increment: &Increment, node: &str) -> Vec<f64> {
    request.model.nodes[node].iter().zip(&increment.displacements[node]).map(|(x, u)| x + u).collect()
}

/// `found` within `bar` of `exact`.
pub fn close(found: f64, exact: f64, bar: f64, what: &str) {
    assert!((found - exact).abs() <= bar, "{what}: found {found:e}, exact {exact:e}, bar {bar:e}");
}
