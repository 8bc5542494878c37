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
