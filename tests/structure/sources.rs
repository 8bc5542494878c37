//! The source as a tree of modules, each with what it defines and imports, and as files with what they mention.

use crate::reader::{Declared, Reader};
use proc_macro2::{Delimiter, TokenStream, TokenTree};
use std::collections::{BTreeMap, BTreeSet};
use std::path::Path;
use syn::visit::Visit;

/// A path of names, such as `crate::model::Case`.
pub type Names = Vec<String>;

pub struct Sources {
    pub files: Vec<File>,
    pub modules: Vec<Module>,
}

/// A file with code that is not only for tests.
pub struct File {
    /// From the package's folder, such as `src/model/mod.rs`.
    pub path: String,
    /// For tests only; then nothing below is filled in.
    pub test: bool,
    /// Built with the `server` feature only.
    pub server: bool,
    /// Lines with code: no comments, no blank lines.
    pub lines: usize,
    pub mentions: Vec<Mention>,
    /// Names of the structs, enums, unions, traits and type aliases that are defined here.
    pub types: Vec<String>,
    /// Types that have an inherent `impl` block here: the module that it stands in, and the type's path there.
    pub impls: Vec<(usize, Names)>,
    pub functions: Vec<Function>,
}

pub struct Function {
    pub name: String,
    /// From the line of `fn` to that of the closing brace.
    pub lines: usize,
}

/// A module: a file, or a `mod` block inside one.
pub struct Module {
    pub parent: Option<usize>,
    pub file: usize,
    pub children: BTreeMap<String, usize>,
    /// Names of what is defined here, macros among them.
    pub items: BTreeSet<String>,
    /// What `use` brings in: the name here, and where it comes from.
    pub imports: Vec<(String, Names)>,
    /// What `use ...::*` brings in.
    pub globs: Vec<Names>,
}

/// A path that stands somewhere in a module.
pub struct Mention {
    pub module: usize,
    pub path: Names,
    pub kind: Kind,
}

#[derive(Clone, Copy, PartialEq, Eq)]
pub enum Kind {
    /// Named by `pub use`, for others.
    Reexport,
    /// Everything of a module or an enum, by `use ...::*`.
    Glob,
    /// A call of a macro.
    Macro,
    /// Named by `use`, or used.
    Plain,
}

impl File {
    fn new(path: String, test: bool, server: bool) -> Self {
        let (mentions, types, impls, functions) = (Vec::new(), Vec::new(), Vec::new(), Vec::new());
        Self { path, test, server, lines: 0, mentions, types, impls, functions }
    }
}

impl Sources {
    /// The library whose root is `lib.rs` in the folder `src`.
    pub fn read(src: &Path) -> Self {
        let mut texts = BTreeMap::new();
        collect(src, "src", &mut texts);
        Self::from_texts(&texts)
    }

    /// A library given as paths and texts.
    pub fn parse(texts: &[(&str, &str)]) -> Self {
        Self::from_texts(&texts.iter().map(|(path, text)| ((*path).to_owned(), (*text).to_owned())).collect())
    }

    fn from_texts(texts: &BTreeMap<String, String>) -> Self {
        let mut sources = Self { files: Vec::new(), modules: Vec::new() };
        sources.load(
            texts,
            Declared { path: "src/lib.rs".into(), name: String::new(), parent: None, test: false, server: false },
        );
        // A file that was missed would make every measure below look better than it is.
        for path in texts.keys().filter(|path| !["src/main.rs", "src/build.rs"].contains(&path.as_str())) {
            assert!(sources.files.iter().any(|file| file.path == *path), "{path} is in no module");
        }
        sources
    }

    fn load(&mut self, texts: &BTreeMap<String, String>, declared: Declared) {
        let Declared { path, name, parent, test, server } = declared;
        let text = &texts[&path];
        let stream: TokenStream = text.parse().unwrap_or_else(|error| panic!("{path}: {error}"));
        let syntax: syn::File = syn::parse2(stream.clone()).unwrap_or_else(|error| panic!("{path}: {error}"));
        let folder = path.strip_suffix(".rs").expect("a Rust file");
        let folder = folder.strip_suffix("/mod").or_else(|| folder.strip_suffix("/lib")).unwrap_or(folder).to_owned();
        let file = self.files.len();
        self.files.push(File::new(path.clone(), test, server));
        let module = self.add_module(&name, parent, file);
        let mut reader = Reader::new(self, texts, module, folder);
        reader.visit_file(&syntax);
        let Reader { declared, test_lines, .. } = reader;
        if test {
            self.files[file] = File::new(path, test, server);
        } else {
            let mut lines = BTreeSet::new();
            code_lines(stream, &mut lines);
            self.files[file].lines = lines.difference(&test_lines).count();
        }
        for child in declared {
            self.load(texts, child);
        }
    }

    pub fn add_module(&mut self, name: &str, parent: Option<usize>, file: usize) -> usize {
        let module = self.modules.len();
        self.modules.push(Module {
            parent,
            file,
            children: BTreeMap::new(),
            items: BTreeSet::new(),
            imports: Vec::new(),
            globs: Vec::new(),
        });
        if let Some(parent) = parent {
            self.modules[parent].children.insert(name.to_owned(), module);
        }
        module
    }
}

fn collect(folder: &Path, name: &str, texts: &mut BTreeMap<String, String>) {
    for entry in std::fs::read_dir(folder).expect("a folder of sources") {
        let path = entry.expect("an entry").path();
        let name = format!("{name}/{}", path.file_name().expect("a name").to_string_lossy());
        if path.is_dir() {
            collect(&path, &name, texts);
        } else if name.ends_with(".rs") {
            texts.insert(name, std::fs::read_to_string(&path).expect("a text"));
        }
    }
}

/// Adds the lines on which code stands; documentation is none.
fn code_lines(stream: TokenStream, lines: &mut BTreeSet<usize>) {
    let mut tokens = stream.into_iter().peekable();
    while let Some(token) = tokens.next() {
        let mark = matches!(&token, TokenTree::Punct(punct) if punct.as_char() == '#');
        if mark && matches!(tokens.peek(), Some(TokenTree::Punct(punct)) if punct.as_char() == '!') {
            tokens.next();
        }
        if mark && matches!(tokens.peek(), Some(TokenTree::Group(group)) if documents(group)) {
            tokens.next();
            continue;
        }
        match token {
            TokenTree::Group(group) => {
                if group.delimiter() != Delimiter::None {
                    lines.insert(group.span_open().start().line);
                    lines.insert(group.span_close().end().line);
                }
                code_lines(group.stream(), lines);
            }
            other => lines.extend(other.span().start().line..=other.span().end().line),
        }
    }
}

fn documents(group: &proc_macro2::Group) -> bool {
    group.delimiter() == Delimiter::Bracket
        && matches!(group.stream().into_iter().next(), Some(TokenTree::Ident(name)) if name == "doc")
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn test_code_is_skipped() {
        let sources = Sources::parse(&[
            (
                "src/lib.rs",
                "//! Words.\nmod a;\n#[cfg(test)]\nmod checks;\n#[cfg(test)]\nuse a::OnlyInTests;\n\n/// Words.\nfn f() {}\n\
                 #[cfg(test)]\nmod tests {\n    use super::a::A;\n    struct A;\n    fn g() {}\n}\n",
            ),
            (
                "src/a.rs",
                "struct S { x: f64,\n #[cfg(test)]\n y: crate::Hidden }\nimpl S {\n #[cfg(test)]\n fn t() {}\n}\n",
            ),
            ("src/checks/mod.rs", "mod deeper;\nstruct B;\n"),
            ("src/checks/deeper.rs", "struct C;\n"),
        ]);
        let file = |path: &str| sources.files.iter().find(|file| file.path == path).expect("a file");
        let lib = file("src/lib.rs");
        assert!(lib.mentions.is_empty() && lib.types.is_empty());
        assert_eq!(lib.functions.iter().map(|function| function.name.as_str()).collect::<Vec<_>>(), ["f"]);
        // `mod a;` and `fn f() {}`.
        assert_eq!(lib.lines, 2);
        let a = file("src/a.rs");
        assert!(a.functions.is_empty());
        assert!(a.mentions.iter().all(|mention| mention.path[0] != "crate"));
        assert!(file("src/checks/mod.rs").test && file("src/checks/deeper.rs").test);
        assert!(file("src/checks/deeper.rs").types.is_empty());
    }

    #[test]
    fn what_the_server_feature_builds_is_told() {
        let sources = Sources::parse(&[
            ("src/lib.rs", "mod a;\n#[cfg(feature = \"server\")]\nmod b;\n"),
            ("src/a.rs", ""),
            ("src/b/mod.rs", "mod c;"),
            ("src/b/c.rs", ""),
        ]);
        let server: Vec<_> = sources.files.iter().map(|file| (file.path.as_str(), file.server)).collect();
        let expected = [("src/lib.rs", false), ("src/a.rs", false), ("src/b/mod.rs", true), ("src/b/c.rs", true)];
        assert_eq!(server, expected);
    }

    #[test]
    #[should_panic(expected = "src/lost.rs is in no module")]
    fn no_file_is_missed() {
        Sources::parse(&[("src/lib.rs", ""), ("src/lost.rs", "")]);
    }
}
