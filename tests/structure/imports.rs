//! Which file imports what of which other, by the file that defines it.

use crate::sources::{Kind, Names, Sources};
use std::collections::{BTreeMap, BTreeSet};

/// What one file imports of another.
#[derive(Default)]
pub struct Edge {
    pub names: BTreeSet<String>,
    /// Those that are not only named for others by `pub use`.
    used: BTreeSet<String>,
}

impl Edge {
    /// Whether the file only passes on what it imports.
    pub fn only_reexports(&self) -> bool {
        self.used.is_empty()
    }
}

/// The edges by the files that they lead from and to.
pub type Edges = BTreeMap<(usize, usize), Edge>;

pub fn edges(sources: &Sources) -> Edges {
    let mut edges = Edges::new();
    for (from, file) in sources.files.iter().enumerate() {
        for mention in &file.mentions {
            for (to, name) in mentioned(sources, mention.module, &mention.path, mention.kind) {
                if to != from {
                    let edge = edges.entry((from, to)).or_default();
                    if mention.kind != Kind::Reexport {
                        edge.used.insert(name.clone());
                    }
                    edge.names.insert(name);
                }
            }
        }
    }
    edges
}

/// The files that define what a path means, each with the name there.
fn mentioned(sources: &Sources, module: usize, path: &Names, kind: Kind) -> Vec<(usize, String)> {
    let mut found = resolve(sources, module, path);
    // A macro by its bare name may stand in a module above.
    let mut above = sources.modules[module].parent;
    while kind == Kind::Macro
        && found.is_empty()
        && let Some(parent) = above
    {
        if sources.modules[parent].items.contains(&path[0]) {
            found.push(Found::Item { file: sources.modules[parent].file, name: path[0].clone() });
        }
        above = sources.modules[parent].parent;
    }
    found
        .into_iter()
        .filter_map(|found| match found {
            Found::Item { file, name } => Some((file, name)),
            Found::Module(module) if kind == Kind::Glob => Some((sources.modules[module].file, "*".into())),
            // The name of a module is no dependency yet: what is used of it is.
            Found::Module(_) | Found::Outside => None,
        })
        .collect()
}

/// The types that a path means.
pub fn definitions(sources: &Sources, module: usize, path: &Names) -> Vec<(usize, String)> {
    mentioned(sources, module, path, Kind::Plain)
}

#[derive(Debug, Clone, PartialEq, Eq)]
enum Found {
    Module(usize),
    Item {
        file: usize,
        name: String,
    },
    /// Of another crate.
    Outside,
}

/// Imports that are being followed: those that lead back to themselves end.
type Followed = BTreeSet<(usize, usize)>;

fn resolve(sources: &Sources, module: usize, path: &Names) -> Vec<Found> {
    follow(sources, module, path, &mut Followed::new())
}

fn follow(sources: &Sources, module: usize, path: &Names, followed: &mut Followed) -> Vec<Found> {
    let Some((first, mut rest)) = path.split_first() else { return Vec::new() };
    let mut found = match first.as_str() {
        "crate" => vec![Found::Module(0)],
        "self" => vec![Found::Module(module)],
        "super" => vec![Found::Module(sources.modules[module].parent.expect("a module above"))],
        name => look_up(sources, module, name, followed),
    };
    while let Some((name, after)) = rest.split_first() {
        // What has something below it is a module, if there is one of that name; a function is not meant.
        if found.iter().any(|found| matches!(found, Found::Module(_))) {
            found.retain(|found| matches!(found, Found::Module(_)));
        }
        found = found.into_iter().flat_map(|found| below(sources, found, name, followed)).collect();
        rest = after;
    }
    found
}

/// What `name` is below something.
fn below(sources: &Sources, found: Found, name: &str, followed: &mut Followed) -> Vec<Found> {
    let Found::Module(module) = found else { return vec![found] };
    let content = &sources.modules[module];
    if name == "super" {
        return vec![Found::Module(content.parent.expect("a module above"))];
    }
    let here = Found::Item { file: content.file, name: name.to_owned() };
    let mut found = look_up(sources, module, name, followed);
    // Of another crate by way of this module; or defined here by a macro, which is not expanded.
    found.iter_mut().filter(|found| **found == Found::Outside).for_each(|found| *found = here.clone());
    if found.is_empty() {
        found.push(here);
    }
    found
}

/// What a name means in a module: several things if a module and a function share it.
fn look_up(sources: &Sources, module: usize, name: &str, followed: &mut Followed) -> Vec<Found> {
    let content = &sources.modules[module];
    let mut found = Vec::new();
    if let Some(child) = content.children.get(name) {
        found.push(Found::Module(*child));
    }
    if content.items.contains(name) {
        found.push(Found::Item { file: content.file, name: name.to_owned() });
    }
    for (index, (alias, path)) in content.imports.iter().enumerate() {
        if alias == name && followed.insert((module, index)) {
            let mut target = follow(sources, module, path, followed);
            followed.remove(&(module, index));
            if target.is_empty() {
                target.push(Found::Outside);
            }
            target.retain(|target| !found.contains(target));
            found.extend(target);
        }
    }
    if found.is_empty() {
        for (index, path) in content.globs.iter().enumerate() {
            // Numbered after the imports that have a name.
            let index = content.imports.len() + index;
            if followed.insert((module, index)) {
                for target in follow(sources, module, path, followed) {
                    if let Found::Module(target) = target {
                        found.extend(look_up(sources, target, name, followed));
                    }
                }
                followed.remove(&(module, index));
            }
        }
    }
    found
}

#[cfg(test)]
mod tests {
    use super::*;

    /// The edges as `from -> to: names`.
    fn told(texts: &[(&str, &str)]) -> Vec<String> {
        let sources = Sources::parse(texts);
        let path = |file: usize| sources.files[file].path.trim_start_matches("src/");
        edges(&sources)
            .iter()
            .map(|((from, to), edge)| {
                let names = edge.names.iter().map(String::as_str).collect::<Vec<_>>().join(" ");
                let mark = if edge.only_reexports() { " (for others)" } else { "" };
                format!("{} -> {}: {names}{mark}", path(*from), path(*to))
            })
            .collect()
    }

    #[test]
    fn reexport_leads_to_the_definition() {
        let edges = told(&[
            ("src/lib.rs", "mod a;\nmod b;"),
            ("src/a/mod.rs", "mod deep;\npub use deep::{Deep as Renamed, Other};\npub struct Here;"),
            ("src/a/deep.rs", "pub struct Deep;\npub struct Other;"),
            ("src/b.rs", "use crate::a::{self, Here, Renamed};\nfn f(_: Renamed, _: Here) -> a::Other { loop {} }"),
        ]);
        let expected = [
            "a/mod.rs -> a/deep.rs: Deep Other (for others)",
            "b.rs -> a/mod.rs: Here",
            "b.rs -> a/deep.rs: Deep Other",
        ];
        assert_eq!(BTreeSet::from_iter(edges), BTreeSet::from(expected.map(String::from)));
    }

    #[test]
    fn declaring_a_module_or_naming_it_is_no_import() {
        let texts = [("src/lib.rs", "mod a;\nmod b;"), ("src/a.rs", "pub fn f() {}"), ("src/b.rs", "use crate::a;")];
        assert_eq!(told(&texts), Vec::<String>::new());
    }

    #[test]
    fn paths_in_bodies_types_and_macros_count() {
        let edges = told(&[
            ("src/lib.rs", "mod a;\nmod b;\nmod c;\nmod d;\nmod e;\nmod g;"),
            ("src/a.rs", "pub fn f() -> f64 { 0.0 }"),
            ("src/b.rs", "fn g() { super::a::f(); }"),
            ("src/c.rs", "fn g() { println!(\"{}\", crate::a::f() + x.f); }"),
            ("src/d.rs", "struct S { field: Option<crate::b::T> }"),
            ("src/e.rs", "use std::fmt::Debug;\nfn g() { fn h() { use super::d::S; } }"),
            ("src/g.rs", "fn f(c: f64) -> f64 { c.max(0.0) }"),
        ]);
        assert_eq!(edges, ["b.rs -> a.rs: f", "c.rs -> a.rs: f", "d.rs -> b.rs: T", "e.rs -> d.rs: S"]);
    }

    #[test]
    fn module_and_function_of_one_name() {
        let edges = told(&[
            ("src/lib.rs", "mod a;\nmod b;\nmod c;"),
            ("src/a/mod.rs", "pub mod bound;\npub use bound::bound;"),
            ("src/a/bound.rs", "pub fn bound() {}\npub fn other() {}"),
            ("src/b.rs", "use crate::a::bound;\nfn f() { bound::other(); }"),
            ("src/c.rs", "fn f() { crate::a::bound(); }"),
        ]);
        let expected = [
            "a/mod.rs -> a/bound.rs: bound (for others)",
            "b.rs -> a/bound.rs: bound other",
            "c.rs -> a/bound.rs: bound",
        ];
        assert_eq!(BTreeSet::from_iter(edges), BTreeSet::from(expected.map(String::from)));
    }

    #[test]
    fn what_a_child_uses_of_its_parent() {
        let edges = told(&[
            ("src/lib.rs", "mod a;"),
            ("src/a/mod.rs", "mod b;\nmod c;\nuse c::C;\nuse std::sync::Arc;\nmacro_rules! m { () => {}; }\nstruct A;"),
            ("src/a/b.rs", "use super::{A, C};\nfn f() { m!(); }"),
            ("src/a/c.rs", "use super::Arc;\npub struct C;"),
        ]);
        let expected =
            ["a/mod.rs -> a/c.rs: C", "a/b.rs -> a/mod.rs: A m", "a/b.rs -> a/c.rs: C", "a/c.rs -> a/mod.rs: Arc"];
        assert_eq!(BTreeSet::from_iter(edges), BTreeSet::from(expected.map(String::from)));
    }

    #[test]
    fn names_by_a_glob() {
        let edges = told(&[
            ("src/lib.rs", "mod a;\nmod b;"),
            ("src/a/mod.rs", "mod c;\npub use c::*;"),
            ("src/a/c.rs", "pub enum C { D }"),
            ("src/b.rs", "fn f() -> crate::a::C { use crate::a::C::*; D }"),
        ]);
        assert_eq!(edges, ["a/mod.rs -> a/c.rs: *", "b.rs -> a/c.rs: C"]);
    }

    #[test]
    fn imports_that_lead_to_themselves_end() {
        let texts = [
            ("src/lib.rs", "mod a;\nmod b;"),
            ("src/a.rs", "pub use crate::b::X;"),
            ("src/b.rs", "pub use crate::a::X;"),
        ];
        assert_eq!(told(&texts), ["a.rs -> b.rs: X (for others)", "b.rs -> a.rs: X (for others)"]);
    }
}
