//! What is measured, for readers and for programs.

use crate::LIMITS;
use crate::imports::Edges;
use crate::measures::{FileEdge, Measures};
use crate::sources::Sources;
use std::fmt::Write;

/// Functions of more lines than these are told.
const LINES_OF_A_FUNCTION: usize = 60;

pub fn text(sources: &Sources, measures: &Measures) -> String {
    let mut text = String::new();
    write_all(&mut text, sources, measures).expect("a string takes everything");
    text
}

fn write_all(text: &mut String, sources: &Sources, measures: &Measures) -> std::fmt::Result {
    write_folders(text, measures)?;
    write_folder_circles(text, sources, measures)?;
    write_file_circles(text, sources, measures)?;
    write_types(text, sources, measures)?;
    writeln!(text, "\n== functions of more than {LINES_OF_A_FUNCTION} lines ==")?;
    for function in measures.functions.iter().take_while(|function| function.lines > LINES_OF_A_FUNCTION) {
        writeln!(text, "{:>5}  {}  {}", function.lines, sources.files[function.file].path, function.name)?;
    }
    writeln!(text, "\n== names at the first level of src: {} ==", measures.first_level.len())?;
    writeln!(text, "{}", measures.first_level.iter().map(String::as_str).collect::<Vec<_>>().join(" "))?;
    writeln!(text, "\n== limits: measured, at most, aim ==")?;
    for limit in &LIMITS {
        writeln!(text, "{:>5} {:>5} {:>5}  {}", (limit.measure)(measures), limit.at_most, limit.aim, limit.what)?;
    }
    Ok(())
}

fn write_folders(text: &mut String, measures: &Measures) -> std::fmt::Result {
    writeln!(text, "== folders: files, test files, lines, lines with sub-folders, percent of {} ==", measures.lines)?;
    for folder in &measures.folders {
        writeln!(
            text,
            "{:>5} {:>5} {:>6} {:>6} {:>3} %  {}",
            folder.files,
            folder.test_files,
            folder.lines,
            folder.lines_below,
            measures.percent(folder.lines_below),
            folder.name
        )?;
    }
    Ok(())
}

fn write_folder_circles(text: &mut String, sources: &Sources, measures: &Measures) -> std::fmt::Result {
    writeln!(text, "\n== circles between folders: {} ==", measures.folder_circles.len())?;
    for circle in &measures.folder_circles {
        writeln!(text, "\n{} folders, each before most of what it imports:", circle.members.len())?;
        for &folder in &circle.members {
            let imports: Vec<&str> = circle
                .members
                .iter()
                .filter(|&&other| measures.folder_edges.contains_key(&(folder, other)))
                .map(|&other| measures.folders[other].name.as_str())
                .collect();
            writeln!(text, "  {} imports {}", measures.folders[folder].name, imports.join(", "))?;
        }
        writeln!(text, "edges against that order, which close the circle: {}", circle.closing.len())?;
        for (from, to) in &circle.closing {
            writeln!(text, "  {} -> {}", measures.folders[*from].name, measures.folders[*to].name)?;
            for edge in &measures.folder_edges[&(*from, *to)] {
                writeln!(text, "    {}", edge_text(sources, edge))?;
            }
        }
    }
    Ok(())
}

fn write_file_circles(text: &mut String, sources: &Sources, measures: &Measures) -> std::fmt::Result {
    writeln!(text, "\n== circles of files: {} ==", measures.file_circles.len())?;
    for circle in &measures.file_circles {
        writeln!(text, "\n{} files, each before most of what it imports:", circle.members.len())?;
        for &file in &circle.members {
            writeln!(text, "  {}", sources.files[file].path)?;
        }
        writeln!(text, "edges against that order, which close the circle: {}", circle.closing.len())?;
        for edge in &circle.closing {
            writeln!(text, "  {}", edge_text(sources, &measures.file_edges[edge]))?;
        }
    }
    Ok(())
}

fn write_types(text: &mut String, sources: &Sources, measures: &Measures) -> std::fmt::Result {
    let path = |file: &usize| sources.files[*file].path.as_str();
    writeln!(
        text,
        "\n== types of the solver with inherent impl blocks in several files: {} ==",
        measures.spread_types.len()
    )?;
    for ((file, name), blocks) in &measures.spread_types {
        writeln!(text, "{name} of {}: {}", path(file), blocks.iter().map(path).collect::<Vec<_>>().join(", "))?;
    }
    writeln!(text, "\n== type names that the solver defines more than once: {} ==", measures.repeated_types.len())?;
    for (name, files) in &measures.repeated_types {
        writeln!(text, "{name}: {}", files.iter().map(path).collect::<Vec<_>>().join(", "))?;
    }
    Ok(())
}

fn edge_text(sources: &Sources, edge: &FileEdge) -> String {
    let mark = if edge.only_reexports { " (only named for others)" } else { "" };
    format!("{} -> {}: {}{mark}", sources.files[edge.from].path, sources.files[edge.to].path, edge.names.join(" "))
}

/// Each import of a file by another as a line of JSON. Paths and names need no escapes.
pub fn json_lines(sources: &Sources, edges: &Edges) -> String {
    let mut lines = String::new();
    for ((from, to), edge) in edges {
        let names: Vec<String> = edge.names.iter().map(|name| format!("\"{name}\"")).collect();
        let (from, to) = (&sources.files[*from].path, &sources.files[*to].path);
        let names = names.join(",");
        let reexport = edge.only_reexports();
        lines += &format!("{{\"from\":\"{from}\",\"to\":\"{to}\",\"names\":[{names}],\"reexport\":{reexport}}}\n");
    }
    lines
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::imports::edges;

    const TEXTS: [(&str, &str); 3] = [
        ("src/lib.rs", "mod a;\nmod b;"),
        ("src/a/mod.rs", "pub use crate::b::{B, C};"),
        ("src/b/mod.rs", "pub struct B;\npub struct C;\nfn f() { crate::a::f() }"),
    ];

    #[test]
    fn circle_is_told_with_the_edge_that_closes_it() {
        let sources = Sources::parse(&TEXTS);
        let text = text(&sources, &Measures::of(&sources, &edges(&sources)));
        assert!(text.contains("src/b -> src/a\n    src/b/mod.rs -> src/a/mod.rs: f\n"), "{text}");
    }

    #[test]
    fn imports_as_lines() {
        let sources = Sources::parse(&TEXTS);
        assert_eq!(
            json_lines(&sources, &edges(&sources)),
            concat!(
                r#"{"from":"src/a/mod.rs","to":"src/b/mod.rs","names":["B","C"],"reexport":true}"#,
                "\n",
                r#"{"from":"src/b/mod.rs","to":"src/a/mod.rs","names":["f"],"reexport":false}"#,
                "\n"
            )
        );
    }
}
