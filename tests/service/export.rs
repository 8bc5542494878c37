//! `arcslip export`: a solved path in another format.

use std::path::Path;
use std::process::{Command, Output};

fn arcslip(folder: &Path, arguments: &[&str]) -> Output {
    Command::new(env!("CARGO_BIN_EXE_arcslip")).current_dir(folder).args(arguments).output().expect("the program runs")
}

/// The names and contents of the files in a folder.
fn files(folder: &Path) -> Vec<(String, Vec<u8>)> {
    let entries = std::fs::read_dir(folder).expect("a folder").map(|entry| entry.expect("an entry"));
    let mut files: Vec<_> = entries
        .map(|entry| {
            (entry.file_name().into_string().expect("a name"), std::fs::read(entry.path()).unwrap_or_default())
        })
        .collect();
    files.sort();
    files
}

/// The clock of a solve is the only difference between two of them, and an export has none of its own.
#[test]
fn an_export_has_the_bytes_of_the_formats_of_the_solve() {
    let folder = tempfile::tempdir().expect("a folder");
    let folder = folder.path();
    arcslip(folder, &["solve", "arch-type-truss", "--out", "path.ndjson", "--plot", "path.svg"]);
    for name in ["again.ndjson", "path.csv", "path.pvd", "path.parquet"] {
        let output = arcslip(folder, &["export", "arch-type-truss", "path.ndjson", "--out", name]);
        assert_eq!(output.status.code(), Some(0), "{name}: {output:?}");
    }
    let read = |name: &str| std::fs::read_to_string(folder.join(name)).expect(name);
    let lines = read("path.ndjson");
    assert_eq!(read("again.ndjson"), lines);
    assert_eq!(read("path.csv").lines().count(), lines.lines().count() + 1);
    assert_eq!(files(&folder.join("path")).len(), lines.lines().count());
    arcslip(folder, &["solve", "arch-type-truss", "--out", "solved.pvd"]);
    assert_eq!(files(&folder.join("path")), files(&folder.join("solved")));

    let drawn = arcslip(folder, &["export", "arch-type-truss", "path.ndjson", "--plot", "again.svg"]);
    assert_eq!((drawn.status.code(), read("again.svg")), (Some(0), read("path.svg")));
    let force = ["--plot", "-", "--against", "elements/0.axial_force"];
    let drawn = arcslip(folder, &[&["export", "arch-type-truss", "path.ndjson"], &force[..]].concat());
    assert!(String::from_utf8_lossy(&drawn.stdout).contains("elements/0.axial_force"), "{drawn:?}");
}

#[test]
fn what_cannot_be_exported_is_told_and_leaves_earlier_results() {
    let folder = tempfile::tempdir().expect("a folder");
    let folder = folder.path();
    std::fs::write(folder.join("path.ndjson"), "no increment\n").expect("a file");
    std::fs::write(folder.join("path.csv"), "earlier").expect("a file");
    let cases: [(&[&str], &str); 5] = [
        (&["bowl", "path.ndjson", "--out", "path.csv"], "path.ndjson, line 1: no increment of a path"),
        (&["bowl", "nothing.ndjson", "--out", "path.csv"], "nothing.ndjson: No such file"),
        (&["bowl", "path.ndjson", "--out", "path.xlsx"], "the extension `xlsx` names no format"),
        (&["-", "-", "--out", "path.csv"], "the model and the path cannot both be standard input"),
        (&["bowl", "path.ndjson"], "--out <FILE>"),
    ];
    for (arguments, told) in cases {
        let output = arcslip(folder, &[&["export"], arguments].concat());
        assert_eq!(output.status.code(), Some(2), "{arguments:?}");
        let message = String::from_utf8_lossy(&output.stderr).into_owned();
        assert!(message.contains(told), "{message}");
    }
    assert_eq!(std::fs::read(folder.join("path.csv")).expect("a file"), b"earlier");
    arcslip(folder, &["solve", "klarbring", "--out", "other.ndjson"]);
    let output = arcslip(folder, &["export", "arch-type-truss", "other.ndjson", "--out", "path.csv"]);
    let message = String::from_utf8_lossy(&output.stderr).into_owned();
    assert!(
        message.contains("increment 0: the model has no stage `press`: is this the path of another model?"),
        "{message}"
    );
    assert_eq!(std::fs::read(folder.join("path.csv")).expect("a file"), b"earlier");
}
