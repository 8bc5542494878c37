//! Studies that must be refused, each with its place.

use arcslip::model::{InputErrors, decode};
use arcslip::studies::error_against_time;
use serde_json::{Value, json};

fn request(study: Value) -> Value {
    let mut request: Value =
        serde_json::from_str(arcslip::check::scenes::find("arch-type-truss").expect("a scene").request).expect("JSON");
    request["study"] = study;
    request
}

fn read(request: &Value) -> Result<error_against_time::StudyPlan, InputErrors> {
    error_against_time::plan(&decode::study(request.to_string().as_bytes())?)
}

#[test]
fn a_study_with_everything_is_accepted() {
    let full = json!({"methods": ["regularised", "auto"], "arc_lengths": [0.1, 0.05], "repeats": 3,
        "reference": "self_converged", "refinement": 2});
    let plan = read(&request(full)).unwrap_or_else(|errors| panic!("{errors}"));
    assert_eq!((plan.rows, plan.runs), (4, 16));
    // Longer than the analysis' own arc length: no reason for more increments.
    read(&request(json!({"arc_lengths": [1e9, 1e5]}))).unwrap_or_else(|errors| panic!("{errors}"));
    let plan = read(&request(json!({}))).unwrap_or_else(|errors| panic!("{errors}"));
    assert_eq!((plan.rows, plan.runs), (12, 72));
    // Read from what serde writes, it is the same.
    let full = request(json!({"penalties": [1e3, 1e4], "repeats": 0}));
    let read = decode::study(full.to_string().as_bytes()).expect("a study");
    let written = serde_json::to_vec(&read).expect("JSON");
    assert_eq!(decode::study(&written).expect("the same"), read);
}

#[test]
fn an_empty_document_is_no_study() {
    let detail = decode::study(b" ").unwrap_err().to_string();
    assert!(detail.contains("a study") && !detail.contains("job"), "{detail}");
}

#[test]
fn mistakes_are_told_with_their_place() {
    let many: Vec<f64> = (1..=21).map(|k| 1.0 / f64::from(k)).collect();
    let documents = [
        (json!({"arc_length": [0.1]}), "/study/arc_length", "did you mean `arc_lengths`"),
        (json!({"arc_lengths": []}), "/study/arc_lengths", "found 0 values; 1 to 20"),
        (json!({"arc_lengths": many}), "/study/arc_lengths", "found 21 values; 1 to 20"),
        (json!({"arc_lengths": [0.1, 0.1]}), "/study/arc_lengths/1", "less is expected"),
        (json!({"arc_lengths": [0.1, -0.1]}), "/study/arc_lengths/1", "above 0"),
        (json!({"arc_lengths": [1e-12]}), "/study/arc_lengths/0", "analysis.arc_length.min"),
        (json!({"arc_lengths": ["long"]}), "/study/arc_lengths/0", "a number is expected"),
        (json!({"tolerances": [1e-4, 2e-4]}), "/study/tolerances/1", "less is expected"),
        (json!({"tolerances": [1.5]}), "/study/tolerances/0", "between 0 and 1"),
        (json!({"penalties": [1e4, 1e3]}), "/study/penalties/1", "more is expected"),
        (json!({"penalties": [1e4], "arc_lengths": [0.1]}), "/study/penalties", "a study varies one thing"),
        (json!({"penalties": [1e4], "methods": ["mpec"]}), "/study/methods/0", "`mpec` has no penalty"),
        (json!({"methods": []}), "/study/methods", "no method is given"),
        (json!({"methods": ["auto", "auto"]}), "/study/methods/1", "stands twice"),
        (json!({"methods": ["atuo"]}), "/study/methods/0", "did you mean `auto`"),
        (json!({"repeats": 102}), "/study/repeats", "at most 101"),
        (json!({"refinement": 1}), "/study/refinement", "2 to 16"),
        (json!({"reference": "exact"}), "/study/reference", "no exact solution of this model is known"),
        (json!({"reference": "true"}), "/study/reference", "is not a reference"),
        (json!({"arc_lengths": [0.1, 1e-7]}), "/analysis/max_increments", "at most 10000000 are taken"),
        (json!({"arc_lengths": [0.1, 1e-4]}), "/analysis/max_increments", "numbers are held"),
    ];
    for (study, pointer, detail) in documents {
        let errors = read(&request(study.clone())).err().unwrap_or_default();
        let named = errors.0.iter().any(|error| error.pointer == pointer && error.detail.contains(detail));
        assert!(named, "{study}: {errors}");
    }
    let mut explored = request(json!({}));
    explored["analysis"] = json!({"explore": {"depth": 1, "max_jobs": 1}});
    assert_eq!(read(&explored).unwrap_err().0[0].pointer, "/analysis/explore");
    let mut parameters = request(json!({"methods": ["auto"]}));
    parameters["analysis"] = json!({"regularised": {"tolerance": 1e-6}});
    assert_eq!(read(&parameters).unwrap_err().0[0].pointer, "/analysis/regularised");
    let mut model = request(json!({}));
    model["model"]["contacts"][0]["node"] = json!("b9");
    assert_eq!(read(&model).unwrap_err().0[0].pointer, "/model/contacts/0/node");
}
