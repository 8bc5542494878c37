//! `arcslip verify`: rows, JSON, picture, exit status.

use serde_json::Value;
use std::process::{Command, Output};

fn verify(arguments: &[&str]) -> Output {
    Command::new(env!("CARGO_BIN_EXE_arcslip")).arg("verify").args(arguments).output().expect("the program runs")
}

#[test]
fn one_family_as_table_json_and_picture() {
    let folder = tempfile::tempdir().expect("a folder");
    let (json, plot) = (folder.path().join("rows.json"), folder.path().join("rows.svg"));
    let files = ["--json", json.to_str().expect("a path"), "--plot", plot.to_str().expect("a path")];
    let output = verify(&[&["--scene", "klarbring"][..], &files].concat());
    assert_eq!(output.status.code(), Some(0), "{output:?}");
    let rows: Value = serde_json::from_str(&std::fs::read_to_string(&json).expect("a file")).expect("JSON");
    let rows = rows.as_array().expect("rows");
    assert!(!rows.is_empty());
    for row in rows {
        assert_eq!(row["family"], "klarbring");
        assert_eq!(row["pass"], true, "{row}");
        let (error, bar) = (row["error"].as_f64().expect("an error"), row["bar"].as_f64().expect("a bar"));
        assert!(error <= bar, "{row}");
        assert!(row["time_s"].as_f64().expect("a time") > 0.0);
    }
    let table = String::from_utf8(output.stdout).expect("text");
    assert!(table.contains(&format!("{0} of {0} pass", rows.len())), "{table}");
    let svg = std::fs::read_to_string(&plot).expect("a picture");
    roxmltree::Document::parse(&svg).expect("well-formed XML");
}

#[test]
fn a_scene_that_is_not_there_is_bad_input() {
    let output = verify(&["--scene", "klarbing"]);
    assert_eq!(output.status.code(), Some(2));
    let said = String::from_utf8(output.stderr).expect("text");
    assert!(said.contains("klarbing") && said.contains("`klarbring`"), "{said}");
}

#[test]
fn every_scene_that_there_is_is_named() {
    let output = verify(&["--scene", "nosuch"]);
    assert_eq!(output.status.code(), Some(2));
    let said = String::from_utf8(output.stderr).expect("text");
    for case in arcslip::check::cases::cases() {
        assert!(said.contains(&format!("`{}`", case.family)), "{} in {said}", case.family);
    }
}

/// Rows or picture, and nothing else; the table is beside it.
#[test]
fn results_go_to_standard_output() {
    let folder = tempfile::tempdir().expect("a folder");
    let of = |option: &str| {
        let program = Command::new(env!("CARGO_BIN_EXE_arcslip"))
            .args(["verify", "--scene", "klarbring", option, "-"])
            .current_dir(folder.path())
            .output()
            .expect("the program runs");
        assert_eq!(program.status.code(), Some(0), "{program:?}");
        assert!(String::from_utf8_lossy(&program.stderr).contains("pass"), "{program:?}");
        String::from_utf8(program.stdout).expect("text")
    };
    assert!(serde_json::from_str::<Value>(&of("--json")).expect("JSON").is_array());
    roxmltree::Document::parse(&of("--plot")).expect("well-formed XML");
    assert_eq!(std::fs::read_dir(folder.path()).expect("a folder").count(), 0);
    let both = verify(&["--scene", "klarbring", "--json", "-", "--plot", "-"]);
    assert_eq!(both.status.code(), Some(2), "{both:?}");
}
