//! `arcslip study`: tables, picture, refusals.

use roxmltree::Document;
use serde_json::Value;
use std::path::Path;
use std::process::{Command, Output};

fn study(arguments: &[&str]) -> Output {
    Command::new(env!("CARGO_BIN_EXE_arcslip")).arg("study").args(arguments).output().expect("the program runs")
}

fn text(output: &Output) -> String {
    assert_eq!(output.status.code(), Some(0), "{output:?}");
    String::from_utf8(output.stdout.clone()).expect("text")
}

/// The texts of a picture, as a reader sees them.
fn texts(svg: &str) -> Vec<String> {
    let document = Document::parse(svg).expect("well-formed XML");
    let texts = document.descendants().filter(|node| node.has_tag_name(("http://www.w3.org/2000/svg", "text")));
    texts.filter_map(|node| node.text()).map(|text| text.trim().to_owned()).collect()
}

const KLARBRING: [&str; 5] = ["klarbring", "--arc-lengths", "0.2,0.1", "--repeats", "2"];

#[test]
fn the_table_comes_as_text_csv_and_json() {
    let folder = tempfile::tempdir().expect("a folder");
    let file = folder.path().join("table.json");
    let printed = text(&study(&KLARBRING));
    assert!(
        printed.contains("exact solution, Klarbring's node") && printed.contains("order of regularised"),
        "{printed}"
    );
    let csv = text(&study(&[&KLARBRING[..], &["--format", "csv"]].concat()));
    assert_eq!(csv.lines().count(), 7);
    let out = file.to_str().expect("a path");
    assert_eq!(text(&study(&[&KLARBRING[..], &["--format", "json", "--out", out]].concat())), "");
    let report: Value = serde_json::from_str(&std::fs::read_to_string(&file).expect("a file")).expect("JSON");
    assert_eq!(report["rows"].as_array().expect("rows").len(), 6);
    assert_eq!(report["reference"]["kind"], "exact");
    assert_eq!(report["rows"][0]["time"]["repeats"], 2);
}

#[test]
fn the_picture_has_a_line_a_method() {
    let folder = tempfile::tempdir().expect("a folder");
    let file = folder.path().join("picture.svg");
    let picture = file.to_str().expect("a path");
    text(&study(&[&KLARBRING[..], &["--plot", picture]].concat()));
    let svg = std::fs::read_to_string(&file).expect("a picture");
    let texts = texts(&svg);
    for wanted in ["Klarbring's node, mu = 1.5", "auto", "mpec", "regularised", "path error", "numbers: arc_length"] {
        assert_eq!(texts.iter().filter(|text| *text == wanted).count(), 1, "{wanted} in {texts:?}");
    }
    // The rungs stand at the marks of each method.
    for rung in ["0.2", "0.1"] {
        assert_eq!(texts.iter().filter(|text| *text == rung).count(), 3, "{rung} in {texts:?}");
    }
}

/// Without times the errors stand against what is varied.
#[test]
fn a_study_without_times_has_a_picture() {
    let folder = tempfile::tempdir().expect("a folder");
    let out = folder.path().join("table.txt");
    let table = ["--repeats", "0", "--plot", "-", "--out", out.to_str().expect("a path")];
    for (varied, across) in [
        (["--arc-lengths", "0.2,0.1"], "mean arc length of the increments (not all paths are timed)"),
        (["--penalties", "1e3,1e4"], "penalty (not all paths are timed)"),
    ] {
        let svg = text(&study(&[&["klarbring"], &varied[..], &table].concat()));
        let texts = texts(&svg);
        assert!(texts.iter().any(|text| text == across), "{texts:?}");
        assert!(!texts.iter().any(|text| text.contains("(s)") || text.contains("bars")), "{texts:?}");
    }
}

/// `-` is standard output for every result, one at a time.
#[test]
fn results_go_to_standard_output() {
    let printed = text(&study(&[&KLARBRING[..], &["--format", "json", "--out", "-"]].concat()));
    assert!(serde_json::from_str::<Value>(&printed).is_ok(), "{printed}");
    let both = study(&[&KLARBRING[..], &["--plot", "-"]].concat());
    assert_eq!(both.status.code(), Some(2), "{both:?}");
    assert!(String::from_utf8_lossy(&both.stderr).contains("--out and --plot"), "{both:?}");
}

/// Rungs far beyond any path's length ask for no more increments than others.
#[test]
fn arc_lengths_longer_than_the_path_are_taken() {
    let table = text(&study(&["klarbring", "--arc-lengths", "1e9,1e5", "--methods", "auto", "--repeats", "0"]));
    assert!(table.contains("stages_completed"), "{table}");
}

#[test]
fn bad_studies_are_bad_input() {
    for (arguments, complaint) in [
        (&["klarbring", "--arc-lengths", "0.1,0.2"][..], "study.arc_lengths[1]"),
        (&["klarbring", "--penalties", "1e3", "--methods", "auto"], "study.methods[0]"),
        (&["klarbring", "--repeats", "1000"], "study.repeats"),
        (&["no such scene"], "no such scene"),
    ] {
        let output = study(arguments);
        assert_eq!(output.status.code(), Some(2), "{output:?}");
        let said = String::from_utf8_lossy(&output.stderr).into_owned();
        assert!(said.contains(complaint), "{said}");
    }
}

/// Times differ from run to run; title, reference, methods, rungs, orders and what is resolved do not.
#[test]
fn the_committed_pictures_show_what_is_found() {
    let pictures = Path::new(env!("CARGO_MANIFEST_DIR")).join("src/check/scenes/pictures");
    let folder = tempfile::tempdir().expect("a folder");
    let file = folder.path().join("picture.svg");
    for (scene, arc_lengths) in [
        ("one-bar-truss", "0.1,0.05,0.02,0.01"),
        ("arch-type-truss", "0.1,0.05,0.02,0.01"),
        ("curving-slip", "0.04,0.02,0.01,0.005"),
        ("capstan", "0.1,0.05,0.02 --methods auto,regularised"),
    ] {
        let plot = file.to_str().expect("a path");
        let arguments = arc_lengths.split(' ');
        let arguments: Vec<&str> = [scene, "--arc-lengths"].into_iter().chain(arguments).collect();
        text(&study(&[&arguments[..], &["--repeats", "1", "--plot", plot]].concat()));
        let lasting = |file: &Path| -> Vec<String> {
            let mut texts = texts(&std::fs::read_to_string(file).expect("a picture"));
            // Ticks of the axes: those of the time, and of errors that are round-off.
            texts.retain(|text| !text.contains('e') || text.parse::<f64>().is_err());
            texts.sort();
            texts
        };
        let command = format!(
            "study {scene} --arc-lengths {arc_lengths} --repeats 21 --plot src/check/scenes/pictures/{scene}-study.svg"
        );
        let committed = lasting(&pictures.join(format!("{scene}-study.svg")));
        assert_eq!(committed, lasting(&file), "draw it anew: cargo run --release -- {command}");
    }
}
