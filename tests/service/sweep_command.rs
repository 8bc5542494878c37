//! `arcslip sweep`: what it takes on the command line and in a file, and what it refuses.

use serde_json::{Value, json};
use std::path::PathBuf;
use std::process::{Command, Output};

const FRICTION: &str = "/model/contacts/0/friction";

fn sweep(arguments: &[&str]) -> Output {
    Command::new(env!("CARGO_BIN_EXE_arcslip")).arg("sweep").args(arguments).output().expect("the program runs")
}

/// The table as JSON.
fn found(arguments: &[&str]) -> Value {
    let output = sweep(&[arguments, &["--format", "json"]].concat());
    assert_eq!(output.status.code(), Some(0), "{output:?}");
    serde_json::from_slice(&output.stdout).expect("JSON")
}

fn complaint(arguments: &[&str]) -> String {
    let output = sweep(arguments);
    assert_eq!(output.status.code(), Some(2), "{output:?}");
    String::from_utf8(output.stderr).expect("text")
}

fn written(folder: &tempfile::TempDir, name: &str, text: &str) -> PathBuf {
    let file = folder.path().join(name);
    std::fs::write(&file, text).expect("written");
    file
}

fn scene() -> String {
    arcslip::check::scenes::find("one-bar-truss").expect("a scene").request.to_owned()
}

#[test]
fn what_may_be_a_mistake_is_told() {
    let folder = tempfile::tempdir().expect("a folder");
    let file = written(&folder, "model.json", &scene());
    let replace = format!("{FRICTION}=0.3,30");
    let output = sweep(&[file.to_str().expect("text"), "--replace", &replace]);
    let told = String::from_utf8(output.stderr).expect("text");
    assert!(told.starts_with("warning: /sweep/replace/~1model~1contacts~10~1friction/1: "), "{told}");
}

#[test]
fn values_stand_on_the_command_line() {
    let replace = |pointer: &str, values: &str| format!("{pointer}={values}");
    let friction = replace(FRICTION, "0.3,0.5");
    let table =
        found(&["one-bar-truss", "--replace", &friction, "--replace", "/model/name=one,two", "--combine", "list"]);
    let values: Vec<&Value> = table["rows"].as_array().expect("rows").iter().map(|row| &row["values"]).collect();
    assert_eq!(values, [&json!([0.3, "one"]), &json!([0.5, "two"])]);
    assert!(table["rows"].as_array().expect("rows").iter().all(|row| row["first_limit"]["load_factor"].is_number()));
    // Arrays have commas of their own.
    let places = replace("/model/nodes/tip", "[-1.5, 0],[-1.4, 0]");
    let table = found(&["one-bar-truss", "--replace", &places]);
    assert_eq!(table["rows"][1]["values"], json!([[-1.4, 0]]));
}

#[test]
fn what_would_be_lost_is_refused_before_anything_is_traced() {
    let folder = tempfile::tempdir().expect("a folder");
    let (one, other) = (format!("{FRICTION}=0.1,0.2"), format!("{FRICTION}=0.5"));
    let said = complaint(&["one-bar-truss", "--replace", &one, "--replace", &other]);
    assert!(said.contains("given twice"), "{said}");
    let zeros = other.replace("/0/", "/00/");
    let said = complaint(&["one-bar-truss", "--replace", &one, "--replace", &zeros]);
    assert!(said.contains("none `00`"), "{said}");
    let twice = scene().replacen("\"model\"", "\"analysis\": {}, \"analysis\": {}, \"model\"", 1);
    let twice = written(&folder, "twice.json", &twice).display().to_string();
    let said = complaint(&[&twice, "--replace", &one]);
    assert!(said.contains("stands twice"), "{said}");
    for no_object in ["5", "[]", "null"] {
        let text = scene().replacen("\"model\"", &format!("\"sweep\": {no_object}, \"model\""), 1);
        let file = written(&folder, "file.json", &text).display().to_string();
        let said = complaint(&[&file, "--replace", &one]);
        assert!(said.contains("what a sweep replaces"), "{said}");
    }
    let nowhere = folder.path().join("no/table.csv").display().to_string();
    let said = complaint(&["one-bar-truss", "--replace", &one, "--out", &nowhere]);
    assert!(said.contains("--out: there is no folder"), "{said}");
    let said = complaint(&["one-bar-truss", "--replace", "/model/contacts=[],[{}]"]);
    assert!(said.contains("/model~1contacts") || said.contains("model/contacts"), "{said}");
}

/// What a path says of itself is what its row says.
#[test]
fn responses_are_values_at_places_of_the_path() {
    let folder = tempfile::tempdir().expect("a folder");
    let mut request: Value = serde_json::from_str(&scene()).expect("JSON");
    request["sweep"] = json!({"replace": {FRICTION: [0.1, 0.3]}, "responses": {
        "limit": {"at": "first_limit"},
        "tip at limit": {"value": "tip.x", "at": "first_limit"},
        "largest": {"at": "largest_load"},
        "first slip": {"at": "first_slip"},
        "load at 1": {"at": {"value": "tip.x", "reaches": 1.0}},
        "tip at 0.1": {"value": "tip.x", "at": {"value": "load_factor", "reaches": 0.1}, "stage": "push"},
        "contact": {"value": "tip/floor.status", "at": "end"},
        "beyond": {"at": {"value": "tip.x", "reaches": 1e6}},
    }});
    let file = written(&folder, "sweep.json", &request.to_string());
    let paths = folder.path().join("paths");
    let table = found(&[file.to_str().expect("text"), "--paths", paths.to_str().expect("text")]);
    for (run, row) in table["rows"].as_array().expect("rows").iter().enumerate() {
        let path = std::fs::read_to_string(paths.join(format!("{run}.ndjson"))).expect("a path");
        let path: Vec<Value> = path.lines().map(|line| serde_json::from_str(line).expect("JSON")).collect();
        let told = |name: &str| row["responses"][name].as_f64().unwrap_or_else(|| panic!("{name}: {row}"));
        let load = |one: &Value| one["load_factor"].as_f64().expect("a number");
        let tip = |one: &Value| one["displacements"]["tip"][0].as_f64().expect("a number");
        let limit = path.iter().find(|one| one["point"]["kind"] == "smooth_limit").expect("a limit point");
        assert_eq!((told("limit"), told("tip at limit")), (load(limit), tip(limit)));
        assert_eq!(told("largest"), path.iter().map(load).fold(f64::NEG_INFINITY, f64::max));
        assert_eq!(told("first slip"), 0.0, "it slips from the start");
        // Linear between the increments before and after, so that it lies between them and near a finer path.
        let after = path.iter().position(|one| tip(one) >= 1.0).expect("reached");
        let (one, other) = (load(&path[after - 1]), load(&path[after]));
        assert!((told("load at 1") - one) * (told("load at 1") - other) <= 0.0);
        let after = path.iter().position(|one| load(one) >= 0.1).expect("reached");
        assert!(tip(&path[after - 1]) < told("tip at 0.1") && told("tip at 0.1") <= tip(&path[after]));
        assert_eq!(row["responses"]["contact"], path.last().expect("an end")["contacts"][0]["status"]);
        assert_eq!(row["responses"]["beyond"], Value::Null);
    }
    let csv = sweep(&["--format", "csv", file.to_str().expect("text")]);
    let csv = String::from_utf8(csv.stdout).expect("text");
    assert!(csv.starts_with("run,job,/model/contacts/0/friction,status,stop_reason"), "{csv}");
    assert!(
        csv.lines()
            .next()
            .expect("a header")
            .ends_with(",error,limit,tip at limit,largest,first slip,load at 1,tip at 0.1,contact,beyond")
    );
    let own = sweep(&["one-bar-truss", "--replace", &format!("{FRICTION}=0.1"), "--response", "status=tip.x@end"]);
    assert!(String::from_utf8_lossy(&own.stderr).contains("choose another"), "{own:?}");
    for (member, wrong, words) in [
        ("value", json!("tipp.x"), "did you mean `tip.x`?"),
        ("at", json!("first_limitt"), "did you mean `first_limit`?"),
        ("stage", json!("pull"), "there is no stage `pull`"),
    ] {
        let mut request = request.clone();
        request["sweep"]["responses"]["limit"][member] = wrong;
        let file = written(&folder, "wrong.json", &request.to_string());
        let told = complaint(&[file.to_str().expect("text")]);
        assert!(told.contains("sweep.responses.limit") && told.contains(words), "{told}");
    }
}

#[test]
fn a_refined_sweep_finds_where_its_response_jumps() {
    let folder = tempfile::tempdir().expect("a folder");
    let picture = folder.path().join("sweep.svg");
    // The tip reaches a load of 0.25 below some friction not at all.
    let table = found(&[
        "one-bar-truss",
        "--replace",
        &format!("{FRICTION}=0.1,0.3,0.5"),
        "--response",
        "tip=tip.x@load_factor=0.25",
        "--refine",
        "8",
        "--plot",
        picture.to_str().expect("text"),
    ]);
    let rows = table["rows"].as_array().expect("rows");
    assert_eq!(rows.len(), 11);
    let friction = |row: &Value| row["values"][0].as_f64().expect("a number");
    let reached = |row: &&Value| row["responses"]["tip"].is_number();
    let least = rows.iter().filter(reached).map(friction).fold(f64::INFINITY, f64::min);
    let largest = rows.iter().filter(|row| !reached(row)).map(friction).fold(0.0, f64::max);
    assert!(largest < least && least - largest < 0.01, "{largest} to {least}");
    let picture = std::fs::read_to_string(picture).expect("a picture");
    assert!(picture.lines().any(|line| line.trim() == "tip"));
    // Between whole numbers there is a value that is refused: what was found before stays.
    let whole = sweep(&[
        "one-bar-truss",
        "--replace",
        "/analysis/max_increments=10,21,40",
        "--refine",
        "3",
        "--format",
        "json",
    ]);
    assert_eq!(whole.status.code(), Some(0), "{whole:?}");
    let kept: Value = serde_json::from_slice(&whole.stdout).expect("JSON");
    assert_eq!(
        (kept["rows"].as_array().map(Vec::len), kept["parameters"][0]["values"].as_array().map(Vec::len)),
        (Some(3), Some(3))
    );
    assert!(String::from_utf8_lossy(&whole.stderr).contains("--refine ends after 3 runs"), "{whole:?}");
    let told = complaint(&["one-bar-truss", "--replace", &format!("{FRICTION}=0.1,0.3"), "--refine", "4000000000"]);
    assert!(told.contains("at most 100000"), "{told}");
    let two = [&format!("{FRICTION}=0.1,0.3"), "/analysis/max_modes=8,9"];
    let told = complaint(&["one-bar-truss", "--replace", two[0], "--replace", two[1], "--refine", "2"]);
    assert!(told.contains("sweep.refine: one parameter"), "{told}");
}
