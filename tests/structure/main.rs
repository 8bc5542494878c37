//! The structure of the source, read from its text: which files import which, in which folders they stand, how long they
//! and their functions are.
//!
//! The tests below hold the measured structure to [`LIMITS`]. `cargo test --test structure -- --nocapture` shows all that
//! is measured; with `ARCSLIP_STRUCTURE=FILE` each import of a file by another becomes a line of JSON in that file.

mod graph;
mod imports;
mod measures;
mod reader;
mod report;
mod sources;

use measures::Measures;
use sources::Sources;
use std::path::Path;

/// A bound on one measure.
pub struct Limit {
    /// What is counted.
    pub what: &'static str,
    pub measure: fn(&Measures) -> usize,
    /// What the measure shall come down to.
    pub aim: usize,
    /// What it may be today.
    pub at_most: usize,
    /// Why it is bounded.
    pub why: &'static str,
}

/// The bounds that the source is held to.
///
/// `at_most` is an upper bound that only goes down: it holds what was measured when the source did not yet meet the aim.
/// Whoever improves a measure lowers it here, until it is the aim.
pub const LIMITS: [Limit; 8] = [
    Limit {
        what: "folders in circles of imports",
        measure: |measures| measures.folder_circles.iter().map(|circle| circle.members.len()).sum(),
        aim: 0,
        at_most: 0,
        why: "A folder can be read, tested and replaced alone only if what it imports does not import it. \
              This holds for a folder and its own sub-folder, too.",
    },
    Limit {
        what: "files in the largest circle of imports",
        measure: |measures| measures.file_circles.iter().map(|circle| circle.members.len()).max().unwrap_or(0),
        aim: 5,
        at_most: 5,
        why: "Files that import each other have to be read together; five are about what a reader keeps in mind.",
    },
    Limit {
        what: "files in a folder",
        measure: |measures| measures.folders.iter().map(|folder| folder.files).max().unwrap_or(0),
        aim: 14,
        at_most: 14,
        why: "A folder is one concept; with more than about a dozen files it holds several.",
    },
    Limit {
        what: "percent of the code in a folder with its sub-folders",
        measure: |measures| {
            measures.folders.iter().map(|folder| measures.percent(folder.lines_below)).max().unwrap_or(0)
        },
        aim: 25,
        at_most: 25,
        why: "Where one folder holds most of the code, the folders say little about it.",
    },
    Limit {
        what: "names at the first level of src",
        measure: |measures| measures.first_level.len(),
        aim: 12,
        at_most: 14,
        why: "The first level is the table of contents; some ten names are read at a glance.",
    },
    Limit {
        what: "type names that the solver defines more than once",
        measure: |measures| measures.repeated_types.len(),
        aim: 0,
        at_most: 0,
        why: "A name stands for one concept, so that a reader can look it up.",
    },
    Limit {
        what: "types of the solver with inherent impl blocks in several files",
        measure: |measures| measures.spread_types.len(),
        aim: 0,
        at_most: 0,
        why: "Methods in other files are dependencies that no import shows: each file can reach every field.",
    },
    Limit {
        what: "lines of the longest function",
        measure: |measures| measures.functions.iter().map(|function| function.lines).max().unwrap_or(0),
        aim: 80,
        at_most: 80,
        why: "A function that does not fit on a screen does several things.",
    },
];

/// What exceeds its bound, in words.
fn exceeded(limits: &[Limit], measures: &Measures) -> Vec<String> {
    limits
        .iter()
        .filter(|limit| (limit.measure)(measures) > limit.at_most)
        .map(|limit| format!("{}: {}, at most {}. {}", limit.what, (limit.measure)(measures), limit.at_most, limit.why))
        .collect()
}

#[test]
fn source_keeps_its_structure() {
    let sources = Sources::read(&Path::new(env!("CARGO_MANIFEST_DIR")).join("src"));
    let edges = imports::edges(&sources);
    let measures = Measures::of(&sources, &edges);
    print!("{}", report::text(&sources, &measures));
    if let Some(file) = std::env::var_os("ARCSLIP_STRUCTURE") {
        std::fs::write(file, report::json_lines(&sources, &edges)).expect("a file to write");
    }
    let exceeded = exceeded(&LIMITS, &measures);
    assert!(exceeded.is_empty(), "\n{}", exceeded.join("\n"));
}

/// The rooms at the first level of `src`, each after all that it may import.
const ROOMS: [&str; 14] = [
    "resources",
    "algebra",
    "complementarity",
    "mechanics",
    "result",
    "step",
    "branching",
    "model",
    "continuation",
    "check",
    "output",
    "studies",
    "service",
    "command",
];

#[test]
fn rooms_import_only_rooms_above_them() {
    let sources = Sources::read(&Path::new(env!("CARGO_MANIFEST_DIR")).join("src"));
    // `lib.rs` and `main.rs` stand in no room.
    let floor = |file: usize| {
        let room = sources.files[file].path.split('/').nth(1).unwrap_or_default();
        ROOMS.iter().position(|other| *other == room)
    };
    let rises = |edge: &&(usize, usize)| floor(edge.0).zip(floor(edge.1)).is_some_and(|(from, to)| to > from);
    let edges = imports::edges(&sources);
    let told = |edge: &(usize, usize)| format!("{} -> {}", sources.files[edge.0].path, sources.files[edge.1].path);
    let wrong: Vec<String> = edges.keys().filter(rises).map(told).collect();
    assert!(wrong.is_empty(), "\n{}", wrong.join("\n"));
    let strange = |file: &&sources::File| {
        file.path.matches('/').count() > 1 && {
            let room = file.path.split('/').nth(1).unwrap_or_default();
            !ROOMS.contains(&room)
        }
    };
    let strange: Vec<&str> = sources.files.iter().filter(strange).map(|file| file.path.as_str()).collect();
    assert!(strange.is_empty(), "in no room that is listed: {}", strange.join(", "));
}

#[test]
fn limits_come_down_to_their_aims() {
    for limit in &LIMITS {
        assert!(limit.at_most >= limit.aim, "{}: lower the aim, too", limit.what);
    }
}

#[test]
fn worse_than_the_limit_is_told() {
    let limit = |at_most| Limit {
        what: "lines",
        measure: |measures| measures.functions.iter().map(|function| function.lines).max().unwrap_or(0),
        aim: 0,
        at_most,
        why: "Why.",
    };
    let sources = Sources::parse(&[("src/lib.rs", "fn long() {\n    let _ = 1;\n}\n")]);
    let measures = Measures::of(&sources, &imports::edges(&sources));
    assert_eq!(exceeded(&[limit(3)], &measures), Vec::<String>::new());
    assert_eq!(exceeded(&[limit(2)], &measures), ["lines: 3, at most 2. Why."]);
}
