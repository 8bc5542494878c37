//! What stands in a file: what it defines, imports and mentions. Test code is left out.

use crate::sources::{File, Function, Kind, Mention, Names, Sources};
use proc_macro2::{TokenStream, TokenTree};
use std::collections::{BTreeMap, BTreeSet};
use syn::spanned::Spanned;
use syn::visit::{self, Visit};
use syn::{Attribute, ImplItem, Item, Stmt, UseTree, Visibility};

/// A module that stands in a file of its own.
pub struct Declared {
    pub path: String,
    pub name: String,
    pub parent: Option<usize>,
    pub test: bool,
    pub server: bool,
}

/// Reads a file.
pub struct Reader<'a> {
    sources: &'a mut Sources,
    texts: &'a BTreeMap<String, String>,
    /// The module that is read.
    module: usize,
    file: usize,
    /// Where the files of its child modules are.
    folder: String,
    /// The type whose `impl` block is read.
    owner: Option<String>,
    within_function: bool,
    /// The modules in files of their own that were met.
    pub declared: Vec<Declared>,
    /// Lines that are built for tests only.
    pub test_lines: BTreeSet<usize>,
}

impl<'a> Reader<'a> {
    /// For the module of a file whose child modules are in `folder`.
    pub fn new(sources: &'a mut Sources, texts: &'a BTreeMap<String, String>, module: usize, folder: String) -> Self {
        let file = sources.modules[module].file;
        let (declared, test_lines) = (Vec::new(), BTreeSet::new());
        Self { sources, texts, module, file, folder, owner: None, within_function: false, declared, test_lines }
    }

    fn read(&mut self) -> &mut File {
        &mut self.sources.files[self.file]
    }

    fn mention(&mut self, path: Names, kind: Kind) {
        let mention = Mention { module: self.module, path, kind };
        self.read().mentions.push(mention);
    }

    /// Leaves out what is built for tests only; `true` if so.
    fn skips(&mut self, attributes: &[Attribute], what: &impl Spanned) -> bool {
        let skipped = for_tests(attributes);
        if skipped {
            let span = what.span();
            self.test_lines.extend(span.start().line..=span.end().line);
        }
        skipped
    }

    fn define(&mut self, name: &syn::Ident) {
        if !self.within_function {
            self.sources.modules[self.module].items.insert(name.to_string());
        }
    }

    fn define_type(&mut self, name: &syn::Ident) {
        self.define(name);
        self.read().types.push(name.to_string());
    }

    fn child(&mut self, item: &syn::ItemMod) {
        let name = item.ident.to_string();
        let folder = format!("{}/{name}", self.folder);
        if let Some((_, items)) = &item.content {
            let child = self.sources.add_module(&name, Some(self.module), self.file);
            let outside = (std::mem::replace(&mut self.module, child), std::mem::replace(&mut self.folder, folder));
            for item in items {
                self.visit_item(item);
            }
            (self.module, self.folder) = outside;
        } else {
            let path = [format!("{folder}.rs"), format!("{folder}/mod.rs")].into_iter();
            let path = path.into_iter().find(|path| self.texts.contains_key(path));
            let server = self.read().server || needs_server(&item.attrs);
            let test = self.read().test || for_tests(&item.attrs);
            let path = path.unwrap_or_else(|| panic!("no file of {folder}"));
            self.declared.push(Declared { path, name, parent: Some(self.module), test, server });
        }
    }

    fn import(&mut self, tree: &UseTree, before: &mut Names, kind: Kind) {
        match tree {
            UseTree::Path(path) => {
                before.push(path.ident.to_string());
                self.import(&path.tree, before, kind);
                before.pop();
            }
            UseTree::Name(name) => self.import_as(&name.ident, &name.ident, before, kind),
            UseTree::Rename(rename) => self.import_as(&rename.ident, &rename.rename, before, kind),
            UseTree::Glob(_) => {
                self.sources.modules[self.module].globs.push(before.clone());
                self.mention(before.clone(), Kind::Glob);
            }
            UseTree::Group(group) => group.items.iter().for_each(|tree| self.import(tree, before, kind)),
        }
    }

    /// `use before::name as alias`.
    fn import_as(&mut self, name: &syn::Ident, alias: &syn::Ident, before: &Names, kind: Kind) {
        let mut path = before.clone();
        let mut alias = alias.to_string();
        if name != "self" {
            path.push(name.to_string());
        } else if alias == "self" {
            alias = before.last().expect("a module").clone();
        }
        self.sources.modules[self.module].imports.push((alias, path.clone()));
        self.mention(path, kind);
    }

    /// The paths among tokens that are not parsed: those of macros and attributes.
    fn tokens(&mut self, stream: TokenStream) {
        let tokens: Vec<TokenTree> = stream.into_iter().collect();
        let is = |index: usize, sign: char| matches!(tokens.get(index), Some(TokenTree::Punct(punct)) if punct.as_char() == sign);
        // Whether the token before is that sign, and not twice, as in `..`.
        let follows = |index: usize, sign| index > 0 && is(index - 1, sign) && !(index > 1 && is(index - 2, sign));
        let mut index = 0;
        while index < tokens.len() {
            match &tokens[index] {
                TokenTree::Group(group) => self.tokens(group.stream()),
                TokenTree::Ident(first) => {
                    let begin = index;
                    let mut path = vec![first.to_string()];
                    while is(index + 1, ':')
                        && is(index + 2, ':')
                        && let Some(TokenTree::Ident(next)) = tokens.get(index + 3)
                    {
                        path.push(next.to_string());
                        index += 3;
                    }
                    // Neither a field or method, nor a macro's variable, nor what goes on after `>::`.
                    let goes_on = begin > 1 && is(begin - 1, ':') && is(begin - 2, ':');
                    let variable = follows(begin, '$') && path[0] != "crate";
                    if !follows(begin, '.') && !variable && !goes_on {
                        self.mention(path, Kind::Plain);
                    }
                }
                TokenTree::Punct(_) | TokenTree::Literal(_) => {}
            }
            index += 1;
        }
    }

    fn function(&mut self, signature: &syn::Signature, block: &syn::Block) {
        let name = match &self.owner {
            Some(owner) => format!("{owner}::{}", signature.ident),
            None => signature.ident.to_string(),
        };
        let lines = block.brace_token.span.close().end().line + 1 - signature.fn_token.span.start().line;
        self.read().functions.push(Function { name, lines });
    }

    /// Visits what a function holds: its own items are not the module's.
    fn within_function(&mut self, visit: impl FnOnce(&mut Self)) {
        let outside = std::mem::replace(&mut self.within_function, true);
        visit(self);
        self.within_function = outside;
    }
}

impl<'ast> Visit<'ast> for Reader<'_> {
    fn visit_item(&mut self, item: &'ast Item) {
        if self.skips(attributes(item), item) {
            // The file of a test module is looked up all the same, to be known as one.
            if let Item::Mod(module) = item
                && module.content.is_none()
            {
                self.child(module);
            }
            return;
        }
        match item {
            Item::Mod(module) => return self.child(module),
            Item::Use(item) => {
                let public = !matches!(item.vis, Visibility::Inherited);
                let kind = if public { Kind::Reexport } else { Kind::Plain };
                if item.leading_colon.is_none() {
                    self.import(&item.tree, &mut Names::new(), kind);
                }
                return;
            }
            Item::Struct(item) => self.define_type(&item.ident),
            Item::Enum(item) => self.define_type(&item.ident),
            Item::Union(item) => self.define_type(&item.ident),
            Item::Trait(item) => self.define_type(&item.ident),
            Item::Type(item) => self.define_type(&item.ident),
            Item::Fn(item) => self.define(&item.sig.ident),
            Item::Const(item) => self.define(&item.ident),
            Item::Static(item) => self.define(&item.ident),
            Item::Macro(item) => item.ident.iter().for_each(|name| self.define(name)),
            Item::Verbatim(tokens) => self.tokens(tokens.clone()),
            _ => {}
        }
        visit::visit_item(self, item);
    }

    fn visit_item_fn(&mut self, item: &'ast syn::ItemFn) {
        self.function(&item.sig, &item.block);
        self.within_function(|reader| visit::visit_item_fn(reader, item));
    }

    fn visit_item_impl(&mut self, item: &'ast syn::ItemImpl) {
        let path = match &*item.self_ty {
            syn::Type::Path(path) if path.qself.is_none() => names(&path.path),
            _ => Names::new(),
        };
        let owner = std::mem::replace(&mut self.owner, path.last().cloned());
        if item.trait_.is_none() {
            let module = self.module;
            self.read().impls.push((module, path));
        }
        visit::visit_item_impl(self, item);
        self.owner = owner;
    }

    fn visit_item_trait(&mut self, item: &'ast syn::ItemTrait) {
        let owner = self.owner.replace(item.ident.to_string());
        visit::visit_item_trait(self, item);
        self.owner = owner;
    }

    fn visit_impl_item(&mut self, item: &'ast ImplItem) {
        let attributes: &[Attribute] = match item {
            ImplItem::Const(item) => &item.attrs,
            ImplItem::Fn(item) => &item.attrs,
            ImplItem::Type(item) => &item.attrs,
            ImplItem::Macro(item) => &item.attrs,
            _ => &[],
        };
        if !self.skips(attributes, item) {
            visit::visit_impl_item(self, item);
        }
    }

    fn visit_impl_item_fn(&mut self, item: &'ast syn::ImplItemFn) {
        self.function(&item.sig, &item.block);
        self.within_function(|reader| visit::visit_impl_item_fn(reader, item));
    }

    fn visit_trait_item_fn(&mut self, item: &'ast syn::TraitItemFn) {
        if let Some(block) = &item.default {
            self.function(&item.sig, block);
        }
        self.within_function(|reader| visit::visit_trait_item_fn(reader, item));
    }

    fn visit_field(&mut self, field: &'ast syn::Field) {
        if !self.skips(&field.attrs, field) {
            visit::visit_field(self, field);
        }
    }

    fn visit_field_value(&mut self, field: &'ast syn::FieldValue) {
        if !self.skips(&field.attrs, field) {
            visit::visit_field_value(self, field);
        }
    }

    fn visit_stmt(&mut self, statement: &'ast Stmt) {
        let attributes: &[Attribute] = match statement {
            Stmt::Local(local) => &local.attrs,
            Stmt::Macro(call) => &call.attrs,
            Stmt::Expr(syn::Expr::Block(block), _) => &block.attrs,
            _ => &[],
        };
        if !self.skips(attributes, statement) {
            visit::visit_stmt(self, statement);
        }
    }

    fn visit_path(&mut self, path: &'ast syn::Path) {
        if path.leading_colon.is_none() {
            self.mention(names(path), Kind::Plain);
        }
        visit::visit_path(self, path);
    }

    fn visit_macro(&mut self, call: &'ast syn::Macro) {
        self.mention(names(&call.path), Kind::Macro);
        self.tokens(call.tokens.clone());
    }

    fn visit_attribute(&mut self, attribute: &'ast Attribute) {
        if let syn::Meta::List(list) = &attribute.meta {
            self.tokens(list.tokens.clone());
        }
    }

    /// `pub(in path)` imports nothing.
    fn visit_visibility(&mut self, _: &'ast Visibility) {}
}

fn names(path: &syn::Path) -> Names {
    path.segments.iter().map(|segment| segment.ident.to_string()).collect()
}

fn attributes(item: &Item) -> &[Attribute] {
    match item {
        Item::Const(item) => &item.attrs,
        Item::Enum(item) => &item.attrs,
        Item::ExternCrate(item) => &item.attrs,
        Item::Fn(item) => &item.attrs,
        Item::ForeignMod(item) => &item.attrs,
        Item::Impl(item) => &item.attrs,
        Item::Macro(item) => &item.attrs,
        Item::Mod(item) => &item.attrs,
        Item::Static(item) => &item.attrs,
        Item::Struct(item) => &item.attrs,
        Item::Trait(item) => &item.attrs,
        Item::TraitAlias(item) => &item.attrs,
        Item::Type(item) => &item.attrs,
        Item::Union(item) => &item.attrs,
        Item::Use(item) => &item.attrs,
        _ => &[],
    }
}

fn for_tests(attributes: &[Attribute]) -> bool {
    attributes.iter().any(|attribute| configured(attribute, "test") || attribute.path().is_ident("test"))
}

fn needs_server(attributes: &[Attribute]) -> bool {
    attributes.iter().any(|attribute| configured(attribute, "feature=\"server\""))
}

/// Whether that is `#[cfg(condition)]`.
fn configured(attribute: &Attribute, condition: &str) -> bool {
    matches!(&attribute.meta, syn::Meta::List(list)
        if list.path.is_ident("cfg") && list.tokens.to_string().replace(' ', "") == condition)
}
