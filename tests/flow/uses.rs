//! Uses of one module by another, and those that go against the declared order.

use std::collections::{BTreeMap, BTreeSet};
use std::path::Path;

use super::source::{self, Module, Place, Source};

/// Number of re-exports that a path is followed through: `use a::a` of another crate would never end.
const MAX_RE_EXPORTS: usize = 16;

/// Names of a module that another uses, by the indices of the using and the used module; `self` where only the module
/// is named.
pub type Edges = BTreeMap<(usize, usize), BTreeSet<String>>;

/// The modules of a crate, the first of which is its root.
#[derive(Debug)]
pub struct Crate {
    pub modules: Vec<Module>,
}

/// The target of a path: an item in the module that defines it, or a module.
struct Target<'a> {
    module: usize,
    item: Option<&'a str>,
}

/// The meaning of a name inside a module.
enum Meaning<'a> {
    Module(usize),
    Item,
    Import(&'a [String]),
}

impl Crate {
    pub fn read(root: &Path, source: Source<'_>) -> Self {
        Self { modules: source::read(root, source) }
    }

    /// The meaning of `name` in `module`. If both a module and an item have that name, `last` chooses the item.
    fn look_up(&self, module: usize, name: &str, last: bool) -> Option<Meaning<'_>> {
        let known = &self.modules[module];
        let child = known.children.iter().find(|(child, _)| child == name).map(|(_, child)| Meaning::Module(*child));
        let item = known.items.contains(name).then_some(Meaning::Item);
        let import = known.imports.iter().find(|(import, _)| import == name);
        let item = item.or(import.map(|(_, path)| Meaning::Import(path)));
        if last { item.or(child) } else { child.or(item) }
    }

    /// Follows `path`, as written in `module`, through re-exports to the module that defines its item. Returns nothing
    /// if the path leaves the crate or names a local variable.
    fn resolve<'a>(&'a self, module: usize, path: &[&'a str], depth: usize) -> Option<Target<'a>> {
        let mut now = module;
        for (at, &name) in path.iter().enumerate() {
            match name {
                "crate" => now = 0,
                "self" => {}
                "super" => now = self.modules[now].parent?,
                _ => match self.look_up(now, name, at + 1 == path.len()) {
                    Some(Meaning::Module(child)) => now = child,
                    Some(Meaning::Item) => return Some(Target { module: now, item: Some(name) }),
                    found => {
                        let rest = &path[at + 1..];
                        let followed = match found {
                            Some(Meaning::Import(import)) => self.follow(now, import, rest, depth),
                            _ => self.resolve_glob(now, name, rest, depth),
                        };
                        // An item that a module re-exports from another crate, or makes by a macro, counts as its own.
                        return followed.or_else(|| (at > 0).then_some(Target { module: now, item: Some(name) }));
                    }
                },
            }
        }
        Some(Target { module: now, item: None })
    }

    fn follow<'a>(&'a self, module: usize, start: &'a [String], rest: &[&'a str], depth: usize) -> Option<Target<'a>> {
        let path: Vec<&str> = start.iter().map(String::as_str).chain(rest.iter().copied()).collect();
        if depth == MAX_RE_EXPORTS { None } else { self.resolve(module, &path, depth + 1) }
    }

    fn resolve_glob<'a>(&'a self, module: usize, name: &'a str, rest: &[&'a str], depth: usize) -> Option<Target<'a>> {
        self.modules[module].globs.iter().find_map(|glob| {
            let Target { module: from, item: None } = self.follow(module, glob, &[], depth)? else { return None };
            let known = from != module
                && (self.look_up(from, name, rest.is_empty()).is_some() || !self.modules[from].globs.is_empty());
            let path: Vec<&str> = ["self", name].into_iter().chain(rest.iter().copied()).collect();
            let found = (known && depth < MAX_RE_EXPORTS).then(|| self.resolve(from, &path, depth + 1))??;
            let is_guess = found.module == from && self.look_up(from, name, rest.is_empty()).is_none();
            (!is_guess).then_some(found)
        })
    }

    /// The modules from the root down to `module`.
    fn chain(&self, module: usize) -> Vec<usize> {
        let mut chain: Vec<usize> =
            std::iter::successors(Some(module), |module| self.modules[*module].parent).collect();
        chain.reverse();
        chain
    }

    /// Every use of one module by another. A module does not use what it re-exports from its own modules, nor an
    /// enclosing module that it only names.
    pub fn edges(&self) -> Edges {
        let mut edges = Edges::new();
        for (user, module) in self.modules.iter().enumerate() {
            for written in &module.uses {
                let path: Vec<&str> = written.path.iter().map(String::as_str).collect();
                let Some(target) = self.resolve(user, &path, 0) else { continue };
                let names_module = target.item.is_none()
                    && (written.place == Place::Code || self.chain(user).contains(&target.module));
                let passes_on = written.place == Place::ReExport && self.chain(target.module).contains(&user);
                if target.module != user && !names_module && !passes_on {
                    let names = edges.entry((user, target.module)).or_default();
                    names.insert(target.item.unwrap_or("self").to_string());
                }
            }
        }
        edges
    }

    /// Uses against the order of declaration, and circles between a module and the modules inside it.
    pub fn faults(&self) -> Vec<String> {
        let edges = self.edges();
        let against_order = edges.iter().filter_map(|(&(user, used), names)| {
            let (above, below) = self.diverge(user, used)?;
            let siblings = &self.modules[self.modules[above?].parent?].children;
            let place = |module| siblings.iter().position(|(_, sibling)| *sibling == module);
            (place(below?) > place(above?)).then(|| {
                format!("{}, declared below {}", self.sentence(user, used, names), self.short_path(above.unwrap_or(0)))
            })
        });
        let circles = (0..self.modules.len()).flat_map(|parent| self.circles(parent, &edges));
        against_order.chain(circles).collect()
    }

    /// Uses of the module `top`, or of one of the `packages`, by modules outside `top`.
    pub fn users_of(&self, top: &str, packages: &[&str]) -> Vec<String> {
        let inside = |module: usize| self.chain(module).iter().any(|outer| self.modules[*outer].path == top);
        let of_modules = self.edges().into_iter().filter(|((user, used), _)| inside(*used) && !inside(*user));
        let of_modules = of_modules.map(|((user, used), names)| self.sentence(user, used, &names));
        let of_packages = (0..self.modules.len()).filter(|module| !inside(*module)).flat_map(|module| {
            let first = |path: &[String]| path.iter().find(|segment| !segment.is_empty()).cloned();
            let named: BTreeSet<String> = self.modules[module].uses.iter().filter_map(|u| first(&u.path)).collect();
            let named = named.into_iter().filter(|package| packages.contains(&package.as_str()));
            named.map(move |package| format!("{} uses {package}", self.modules[module].file.display()))
        });
        of_modules.chain(of_packages).collect()
    }

    /// The first modules that differ on the paths from the root to two modules.
    fn diverge(&self, user: usize, used: usize) -> Option<(Option<usize>, Option<usize>)> {
        let (user, used) = (self.chain(user), self.chain(used));
        let common = user.iter().zip(&used).take_while(|(a, b)| a == b).count();
        Some((user.get(common).copied(), used.get(common).copied()))
    }

    /// Uses of items that `parent` itself defines, by modules inside it that `parent` uses directly or through others.
    fn circles(&self, parent: usize, edges: &Edges) -> Vec<String> {
        let node = |module| {
            let chain = self.chain(module);
            let depth = chain.iter().position(|inner| *inner == parent)?;
            Some(chain.get(depth + 1).copied().unwrap_or(parent))
        };
        let arrows: BTreeSet<(usize, usize)> =
            edges.keys().filter_map(|&(user, used)| Some((node(user)?, node(used)?))).collect();
        let mut reached = BTreeSet::from([parent]);
        loop {
            let more: Vec<usize> = arrows
                .iter()
                .filter(|(from, to)| reached.contains(from) && !reached.contains(to))
                .map(|a| a.1)
                .collect();
            if more.is_empty() {
                break;
            }
            reached.extend(more);
        }
        let back = edges.iter().filter(|((user, used), _)| {
            *used == parent && node(*user).is_some_and(|child| child != parent && reached.contains(&child))
        });
        back.map(|(&(user, used), names)| {
            let child = node(user).unwrap_or(user);
            let how = if arrows.contains(&(parent, child)) { "uses" } else { "indirectly uses" };
            let file = self.modules[parent].file.display();
            format!("{}, in {file}, which {how} {}: a circle", self.sentence(user, used, names), self.short_path(child))
        })
        .collect()
    }

    fn short_path(&self, module: usize) -> &str {
        let path = &self.modules[module].path;
        path.strip_prefix("crate::").unwrap_or(path)
    }

    fn sentence(&self, user: usize, used: usize, names: &BTreeSet<String>) -> String {
        let (user, used) = (&self.modules[user], &self.modules[used]);
        let names: Vec<&str> = names.iter().map(String::as_str).filter(|name| *name != "self").collect();
        let names = match names[..] {
            [] => String::new(),
            [one] => format!("::{one}"),
            _ => format!("::{{{}}}", names.join(", ")),
        };
        format!("{} uses {}{names}", user.file.display(), used.path)
    }
}
