//! What is measured of the source.

use crate::graph::{Circle, Graph, circles};
use crate::imports::{Edges, definitions};
use crate::sources::Sources;
use std::collections::{BTreeMap, BTreeSet};

pub struct Measures {
    /// Folders with files of their own, and the single files of the first level.
    pub folders: Vec<Folder>,
    /// Lines of code of all files.
    pub lines: usize,
    /// Imports between folders: from, to, the pairs of files.
    pub folder_edges: BTreeMap<(usize, usize), Vec<FileEdge>>,
    pub folder_circles: Vec<Circle>,
    pub file_circles: Vec<Circle>,
    /// Imports between files, for the edges of `file_circles`.
    pub file_edges: BTreeMap<(usize, usize), FileEdge>,
    /// Names directly below `src`.
    pub first_level: BTreeSet<String>,
    /// Names of the solver's types that are defined more than once, with the files.
    pub repeated_types: BTreeMap<String, Vec<usize>>,
    /// The solver's types whose inherent `impl` blocks stand in several files: file of the definition and name, with the files.
    pub spread_types: BTreeMap<(usize, String), BTreeSet<usize>>,
    /// Every function, the longest first.
    pub functions: Vec<Function>,
}

pub struct Folder {
    /// `src/model`, or `src/budget.rs` for a file of the first level.
    pub name: String,
    pub files: usize,
    pub test_files: usize,
    pub lines: usize,
    /// Lines with those of the sub-folders.
    pub lines_below: usize,
}

#[derive(Clone)]
pub struct FileEdge {
    pub from: usize,
    pub to: usize,
    pub names: Vec<String>,
    pub only_reexports: bool,
}

pub struct Function {
    pub name: String,
    pub file: usize,
    pub lines: usize,
}

/// The folder that a file stands in; a file of the first level is its own. The root only names the others.
fn folder_of(path: &str) -> Option<&str> {
    if path == "src/lib.rs" {
        return None;
    }
    let (folder, _) = path.rsplit_once('/').expect("a folder");
    Some(if folder == "src" { path } else { folder })
}

impl Measures {
    pub fn of(sources: &Sources, edges: &Edges) -> Self {
        let folders = folders(sources);
        let place = |file: usize| {
            let name = folder_of(&sources.files[file].path)?;
            folders.iter().position(|folder| folder.name == name)
        };
        let mut file_graph: Graph = vec![BTreeMap::new(); sources.files.len()];
        let mut folder_graph: Graph = vec![BTreeMap::new(); folders.len()];
        let mut folder_edges: BTreeMap<_, Vec<FileEdge>> = BTreeMap::new();
        let mut file_edges = BTreeMap::new();
        for (&(from, to), edge) in edges {
            let names = edge.names.iter().cloned().collect();
            let file_edge = FileEdge { from, to, names, only_reexports: edge.only_reexports() };
            file_graph[from].insert(to, edge.names.len());
            file_edges.insert((from, to), file_edge.clone());
            if let (Some(from), Some(to)) = (place(from), place(to))
                && from != to
            {
                *folder_graph[from].entry(to).or_insert(0) += edge.names.len();
                folder_edges.entry((from, to)).or_default().push(file_edge);
            }
        }
        Self {
            lines: sources.files.iter().map(|file| file.lines).sum(),
            folder_circles: circles(&folder_graph),
            file_circles: circles(&file_graph),
            folders,
            folder_edges,
            file_edges,
            first_level: first_level(sources),
            repeated_types: repeated_types(sources),
            spread_types: spread_types(sources),
            functions: functions(sources),
        }
    }

    /// Lines as a share of all, rounded up.
    pub fn percent(&self, lines: usize) -> usize {
        (100 * lines).div_ceil(self.lines.max(1))
    }
}

fn folders(sources: &Sources) -> Vec<Folder> {
    let names: BTreeSet<&str> = sources.files.iter().filter_map(|file| folder_of(&file.path)).collect();
    names
        .into_iter()
        .map(|name| {
            let own = || sources.files.iter().filter(|file| folder_of(&file.path) == Some(name));
            let inside = |path: &str| path == name || path.starts_with(&format!("{name}/"));
            Folder {
                name: name.to_owned(),
                files: own().filter(|file| !file.test).count(),
                test_files: own().filter(|file| file.test).count(),
                lines: own().map(|file| file.lines).sum(),
                lines_below: sources.files.iter().filter(|file| inside(&file.path)).map(|file| file.lines).sum(),
            }
        })
        .collect()
}

fn first_level(sources: &Sources) -> BTreeSet<String> {
    let names = sources.files.iter().filter(|file| !file.test).filter_map(|file| file.path.split('/').nth(1));
    names.map(|name| name.trim_end_matches(".rs").to_owned()).filter(|name| name != "lib").collect()
}

fn repeated_types(sources: &Sources) -> BTreeMap<String, Vec<usize>> {
    let mut defined: BTreeMap<String, Vec<usize>> = BTreeMap::new();
    for (index, file) in sources.files.iter().enumerate().filter(|(_, file)| !file.server) {
        for name in &file.types {
            defined.entry(name.clone()).or_default().push(index);
        }
    }
    defined.retain(|_, files| files.len() > 1);
    defined
}

fn spread_types(sources: &Sources) -> BTreeMap<(usize, String), BTreeSet<usize>> {
    let mut blocks: BTreeMap<(usize, String), BTreeSet<usize>> = BTreeMap::new();
    for (index, file) in sources.files.iter().enumerate().filter(|(_, file)| !file.server) {
        for (module, path) in &file.impls {
            for definition in definitions(sources, *module, path) {
                blocks.entry(definition).or_default().insert(index);
            }
        }
    }
    blocks.retain(|_, files| files.len() > 1);
    blocks
}

fn functions(sources: &Sources) -> Vec<Function> {
    let mut functions: Vec<Function> = sources
        .files
        .iter()
        .enumerate()
        .flat_map(|(index, file)| file.functions.iter().map(move |function| (index, function)))
        .map(|(file, function)| Function { name: function.name.clone(), file, lines: function.lines })
        .collect();
    functions.sort_by_key(|function| std::cmp::Reverse(function.lines));
    functions
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::imports::edges;

    fn measured(texts: &[(&str, &str)]) -> (Sources, Measures) {
        let sources = Sources::parse(texts);
        let measures = Measures::of(&sources, &edges(&sources));
        (sources, measures)
    }

    /// The folders of each circle.
    fn circles(measures: &Measures) -> Vec<BTreeSet<&str>> {
        let name = |&folder: &usize| measures.folders[folder].name.as_str();
        measures.folder_circles.iter().map(|circle| circle.members.iter().map(name).collect()).collect()
    }

    #[test]
    fn folders_can_form_a_circle_without_any_of_files() {
        let (_, measures) = measured(&[
            ("src/lib.rs", "mod a;\nmod b;"),
            ("src/a/mod.rs", "pub mod up;\npub mod down;"),
            ("src/a/up.rs", "use crate::b::B;"),
            ("src/a/down.rs", "pub struct A;"),
            ("src/b/mod.rs", "use crate::a::down::A;\npub struct B(A);"),
        ]);
        assert_eq!(circles(&measures), [BTreeSet::from(["src/a", "src/b"])]);
        assert!(measures.file_circles.is_empty());
    }

    #[test]
    fn folder_and_its_sub_folder_are_two() {
        let below = "use crate::a::X;";
        let one_way = [("src/lib.rs", "mod a;"), ("src/a/mod.rs", "mod b;\npub struct X;"), ("src/a/b/mod.rs", below)];
        assert!(circles(&measured(&one_way).1).is_empty());
        let mut both_ways = one_way;
        both_ways[1].1 = "mod b;\npub struct X;\nfn f() { b::g(); }";
        assert_eq!(circles(&measured(&both_ways).1), [BTreeSet::from(["src/a", "src/a/b"])]);
    }

    #[test]
    fn file_of_the_first_level_is_on_its_own() {
        let (_, measures) = measured(&[
            ("src/lib.rs", "mod a;\nmod b;\n#[cfg(test)]\nmod tests;\npub use a::A;"),
            ("src/a.rs", "use crate::b::B;\npub struct A;"),
            ("src/b.rs", "use crate::a::A;\npub struct B;"),
            ("src/tests.rs", ""),
        ]);
        assert_eq!(circles(&measures), [BTreeSet::from(["src/a.rs", "src/b.rs"])]);
        assert_eq!(measures.file_circles.len(), 1);
        assert_eq!(measures.first_level, BTreeSet::from(["a", "b"].map(String::from)));
    }

    #[test]
    fn sizes_of_folders() {
        let (_, measures) = measured(&[
            ("src/lib.rs", "mod a;\nmod c;"),
            ("src/a/mod.rs", "mod b;\n#[cfg(test)]\nmod tests;"),
            ("src/a/tests.rs", "struct T;"),
            ("src/a/b/mod.rs", "struct B;\n\n// Words.\nstruct C;"),
            ("src/c.rs", "struct D;"),
        ]);
        let sizes: Vec<_> = measures
            .folders
            .iter()
            .map(|folder| (folder.name.as_str(), folder.files, folder.test_files, folder.lines, folder.lines_below))
            .collect();
        assert_eq!(sizes, [("src/a", 1, 1, 1, 3), ("src/a/b", 1, 0, 2, 2), ("src/c.rs", 1, 0, 1, 1)]);
        assert_eq!((measures.lines, measures.percent(3)), (6, 50));
    }

    #[test]
    fn types_of_one_name_and_types_spread_over_files() {
        let (sources, measures) = measured(&[
            ("src/lib.rs", "mod a;\nmod b;\n#[cfg(feature = \"server\")]\nmod c;"),
            ("src/a.rs", "pub struct A;\nimpl A { fn f() {} }\nimpl A { fn g() {} }\nstruct Once;\nimpl Once {}"),
            (
                "src/b.rs",
                "use crate::a::A as Other;\nimpl Other { fn h() {} }\nimpl Clone for Once {}\nenum Twice {}\nmod d { trait Twice {} }",
            ),
            ("src/c.rs", "struct Once;\nimpl crate::a::Once {}"),
        ]);
        assert_eq!(measures.repeated_types.keys().collect::<Vec<_>>(), ["Twice"]);
        let spread: Vec<_> = measures
            .spread_types
            .iter()
            .map(|((file, name), blocks)| (sources.files[*file].path.as_str(), name.as_str(), blocks.len()))
            .collect();
        assert_eq!(spread, [("src/a.rs", "A", 2)]);
    }

    #[test]
    fn lengths_of_functions() {
        let text = "fn f() {\n}\nstruct S;\nimpl S {\n    /// Words.\n    fn g(\n        &self,\n    ) {\n        let _ = 1;\n    }\n}\n";
        let (_, measures) = measured(&[("src/lib.rs", text)]);
        let told: Vec<_> = measures.functions.iter().map(|function| (function.name.as_str(), function.lines)).collect();
        assert_eq!(told, [("S::g", 5), ("f", 2)]);
    }
}
