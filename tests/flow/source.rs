//! The modules of a Rust crate, read from its source: their order, the names that each defines, and the paths that each
//! uses.

use std::collections::HashSet;
use std::path::{Path, PathBuf};

use proc_macro2::{TokenStream, TokenTree};
use syn::visit::{self, Visit};
use syn::{Attribute, Item, Meta, UseTree, Visibility};

/// A function that returns the text of the file at a path, if there is one.
pub type Source<'a> = &'a dyn Fn(&Path) -> Option<String>;

/// A module of a crate, without its tests.
#[derive(Debug, Default)]
pub struct Module {
    /// Path in the crate, such as `crate::render::mesh`.
    pub path: String,
    /// Its source file, which an inline module shares with its parent.
    pub file: PathBuf,
    /// Index of the module that declares it; the crate's root has none.
    pub parent: Option<usize>,
    /// Names and indices of its modules, in the order of their declarations.
    pub children: Vec<(String, usize)>,
    /// Names of the functions, types, traits, constants and macros that it defines.
    pub items: HashSet<String>,
    /// Names that `use` brings into it, each with its full path.
    pub imports: Vec<(String, Vec<String>)>,
    /// Paths before `::*`.
    pub globs: Vec<Vec<String>>,
    /// Every path in its code, macros and attributes.
    pub uses: Vec<Use>,
}

/// A path as the code has it. If it begins with `::`, the first segment is empty.
#[derive(Debug)]
pub struct Use {
    pub path: Vec<String>,
    pub place: Place,
}

/// The place of a path in the code.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Place {
    /// In a private `use` declaration.
    Import,
    /// In a `use` declaration that other modules can use too.
    ReExport,
    /// Anywhere else.
    Code,
}

/// Reads the crate whose root is the file `root`; the first module is the root.
pub fn read(root: &Path, source: Source<'_>) -> Vec<Module> {
    let folder = root.parent().expect("a file lies in a folder").to_path_buf();
    let module = Module { path: "crate".into(), file: root.into(), ..Module::default() };
    let mut reader = Reader { source, modules: vec![module], module: 0, folder, blocks: 0 };
    reader.read_file(root);
    reader.modules
}

struct Reader<'a> {
    source: Source<'a>,
    modules: Vec<Module>,
    /// Index of the module that is being read.
    module: usize,
    /// Folder of the files of that module's own modules.
    folder: PathBuf,
    /// Number of blocks of code around the current place; items in a block are not visible outside.
    blocks: usize,
}

impl Reader<'_> {
    fn here(&mut self) -> &mut Module {
        &mut self.modules[self.module]
    }

    fn read_file(&mut self, file: &Path) {
        let text = (self.source)(file).unwrap_or_else(|| panic!("{} is missing", file.display()));
        let syntax = syn::parse_file(&text).unwrap_or_else(|error| panic!("{}: {error}", file.display()));
        self.visit_file(&syntax);
    }

    fn read_module(&mut self, declaration: &syn::ItemMod) {
        let name = declaration.ident.to_string();
        if name == "tests" || name.ends_with("_tests") {
            return;
        }
        let inner = self.folder.join(&name);
        let beside = self.folder.join(format!("{name}.rs"));
        let file = match &declaration.content {
            Some(_) => self.here().file.clone(),
            None if (self.source)(&beside).is_some() => beside,
            None => inner.join("mod.rs"),
        };
        let child = self.modules.len();
        let path = format!("{}::{name}", self.here().path);
        self.here().children.push((name, child));
        self.modules.push(Module { path, file: file.clone(), parent: Some(self.module), ..Module::default() });

        let outer = (self.module, std::mem::replace(&mut self.folder, inner));
        self.module = child;
        match &declaration.content {
            Some((_, items)) => items.iter().for_each(|item| self.visit_item(item)),
            None => self.read_file(&file),
        }
        (self.module, self.folder) = outer;
    }

    fn read_use(&mut self, declaration: &syn::ItemUse) {
        let start = if declaration.leading_colon.is_some() { vec![String::new()] } else { Vec::new() };
        let place = match declaration.vis {
            Visibility::Inherited => Place::Import,
            _ => Place::ReExport,
        };
        self.read_use_tree(start, &declaration.tree, place);
    }

    fn read_use_tree(&mut self, mut path: Vec<String>, tree: &UseTree, place: Place) {
        let name = match tree {
            UseTree::Path(part) => {
                path.push(part.ident.to_string());
                return self.read_use_tree(path, &part.tree, place);
            }
            UseTree::Group(group) => {
                return group.items.iter().for_each(|tree| self.read_use_tree(path.clone(), tree, place));
            }
            UseTree::Glob(_) => {
                self.here().globs.push(path.clone());
                return self.here().uses.push(Use { path, place });
            }
            UseTree::Name(part) => {
                if part.ident != "self" {
                    path.push(part.ident.to_string());
                }
                path.last().cloned().unwrap_or_default()
            }
            UseTree::Rename(part) => {
                if part.ident != "self" {
                    path.push(part.ident.to_string());
                }
                part.rename.to_string()
            }
        };
        self.here().imports.push((name, path.clone()));
        self.here().uses.push(Use { path, place });
    }

    /// Reads the paths in the tokens of a macro or an attribute, each after `prefix`.
    fn read_tokens(&mut self, tokens: TokenStream, prefix: &[String]) {
        let tokens: Vec<TokenTree> = tokens.into_iter().collect();
        let is = |at: usize, wanted: char| matches!(tokens.get(at), Some(TokenTree::Punct(p)) if p.as_char() == wanted);
        let before = |at: usize, back: usize, wanted: char| at.checked_sub(back).is_some_and(|at| is(at, wanted));
        let mut at = 0;
        while let Some(token) = tokens.get(at) {
            let start = at;
            at += 1;
            let first = match token {
                TokenTree::Group(group) => {
                    self.read_tokens(group.stream(), &[]);
                    continue;
                }
                TokenTree::Ident(ident) => ident.to_string(),
                _ => continue,
            };
            let is_field = before(start, 1, '.') && !before(start, 2, '.');
            let is_metavariable = before(start, 1, '$') && first != "crate";
            let goes_on = before(start, 1, ':') && before(start, 2, ':');
            if is_field || is_metavariable || goes_on || before(start, 1, '\'') {
                continue;
            }
            let mut path = prefix.to_vec();
            path.push(first);
            while is(at, ':') && is(at + 1, ':') {
                match tokens.get(at + 2) {
                    Some(TokenTree::Ident(next)) => path.push(next.to_string()),
                    Some(TokenTree::Group(group)) => self.read_tokens(group.stream(), &path),
                    _ => break,
                }
                at += 3;
            }
            self.here().uses.push(Use { path, place: Place::Code });
        }
    }
}

impl<'ast> Visit<'ast> for Reader<'_> {
    fn visit_item(&mut self, item: &'ast Item) {
        let (attributes, name) = describe(item);
        if attributes.iter().any(is_test) {
            return;
        }
        if self.blocks == 0 {
            self.here().items.extend(name);
        }
        match item {
            Item::Mod(declaration) => self.read_module(declaration),
            Item::Use(declaration) => self.read_use(declaration),
            other => visit::visit_item(self, other),
        }
    }

    fn visit_impl_item_fn(&mut self, function: &'ast syn::ImplItemFn) {
        if !function.attrs.iter().any(is_test) {
            visit::visit_impl_item_fn(self, function);
        }
    }

    fn visit_block(&mut self, block: &'ast syn::Block) {
        self.blocks += 1;
        visit::visit_block(self, block);
        self.blocks -= 1;
    }

    fn visit_path(&mut self, path: &'ast syn::Path) {
        let start = path.leading_colon.as_ref().map(|_| String::new());
        let segments = start.into_iter().chain(path.segments.iter().map(|segment| segment.ident.to_string()));
        let path_use = Use { path: segments.collect(), place: Place::Code };
        self.here().uses.push(path_use);
        visit::visit_path(self, path);
    }

    fn visit_macro(&mut self, called: &'ast syn::Macro) {
        self.visit_path(&called.path);
        self.read_tokens(called.tokens.clone(), &[]);
    }

    fn visit_attribute(&mut self, attribute: &'ast Attribute) {
        match &attribute.meta {
            Meta::List(list) => self.read_tokens(list.tokens.clone(), &[]),
            Meta::Path(_) | Meta::NameValue(_) => {}
        }
    }
}

fn is_test(attribute: &Attribute) -> bool {
    let Meta::List(list) = &attribute.meta else { return attribute.path().is_ident("test") };
    let condition = list.tokens.to_string();
    list.path.is_ident("cfg") && (condition == "test" || condition.starts_with("all") && condition.contains("test"))
}

/// The attributes of an item, and its name in its module.
fn describe(item: &Item) -> (&[Attribute], Option<String>) {
    let (attributes, name) = match item {
        Item::Const(item) => (&item.attrs, Some(&item.ident)),
        Item::Enum(item) => (&item.attrs, Some(&item.ident)),
        Item::Fn(item) => (&item.attrs, Some(&item.sig.ident)),
        Item::Impl(item) => (&item.attrs, None),
        Item::Macro(item) => (&item.attrs, item.ident.as_ref()),
        Item::Mod(item) => (&item.attrs, None),
        Item::Static(item) => (&item.attrs, Some(&item.ident)),
        Item::Struct(item) => (&item.attrs, Some(&item.ident)),
        Item::Trait(item) => (&item.attrs, Some(&item.ident)),
        Item::TraitAlias(item) => (&item.attrs, Some(&item.ident)),
        Item::Type(item) => (&item.attrs, Some(&item.ident)),
        Item::Union(item) => (&item.attrs, Some(&item.ident)),
        Item::Use(item) => (&item.attrs, None),
        Item::ExternCrate(item) => (&item.attrs, None),
        Item::ForeignMod(item) => (&item.attrs, None),
        _ => panic!("an item of unknown kind"),
    };
    (attributes, name.map(ToString::to_string))
}
