//! The modules of a crate, and which of them uses which.

use std::collections::{BTreeMap, BTreeSet};

use syn::{Item, UseTree};

use super::source::{Mention, Source, declared, is_for_tests};

/// A path of a module from its crate's root, or of an item.
pub(super) type Path = Vec<String>;

/// One use of a module by another.
#[derive(Clone, Debug, PartialEq, Eq)]
pub(super) struct Use {
    pub(super) from: Path,
    pub(super) to: Path,
    /// `FILE:LINE`.
    pub(super) place: String,
}

/// The modules of one crate, without those for tests.
pub(super) struct Modules {
    /// File of the crate's root.
    pub(super) root: String,
    modules: BTreeMap<Path, Module>,
}

#[derive(Default)]
struct Module {
    file: String,
    items: BTreeSet<String>,
    /// Names that `use` brings, with the paths behind them.
    names: BTreeMap<String, Path>,
    /// Paths whose every item is brought.
    globs: Vec<Path>,
    mentions: Vec<Mention>,
}

/// The files that crates begin with: libraries and programs.
pub(super) fn roots(sources: &[Source]) -> impl Iterator<Item = &Source> {
    sources.iter().filter(|source| {
        let name = source.name.as_str();
        ["src/lib.rs", "src/main.rs"]
            .iter()
            .any(|root| name == *root || name.ends_with(&format!("/{root}")))
    })
}

impl Modules {
    /// Follows the declarations of modules from a crate's root on.
    pub(super) fn of(root: &Source, sources: &[Source]) -> Self {
        let mut modules = Self {
            root: root.name.clone(),
            modules: BTreeMap::new(),
        };
        let folder = root.name.rsplit_once('/').map_or("", |(folder, _)| folder);
        modules.add(Vec::new(), (root, &[]), &root.file.items, folder, sources);
        modules
    }

    fn add(
        &mut self,
        path: Path,
        (source, inside): (&Source, &[String]),
        items: &[Item],
        folder: &str,
        all: &[Source],
    ) {
        let mut module = Module {
            file: source.name.clone(),
            items: declared(items),
            ..Module::default()
        };
        let mentions = source.mentions.iter().filter(|it| !it.is_test);
        module.mentions = mentions.filter(|it| it.inside == inside).cloned().collect();
        for item in items.iter().filter(|item| !is_for_tests(item)) {
            match item {
                Item::Use(item) => module.bring(&item.tree, Vec::new()),
                Item::Mod(item) => {
                    let name = item.ident.to_string();
                    let below = format!("{folder}/{name}");
                    let mut path = path.clone();
                    path.push(name);
                    let file = [format!("{below}.rs"), format!("{below}/mod.rs")];
                    match (&item.content, all.iter().find(|it| file.contains(&it.name))) {
                        (Some((_, items)), _) => {
                            let inside = [inside, &[item.ident.to_string()]].concat();
                            self.add(path, (source, &inside), items, &below, all);
                        }
                        (None, Some(file)) => {
                            self.add(path, (file, &[]), &file.file.items, &below, all);
                        }
                        (None, None) => {}
                    }
                }
                _ => {}
            }
        }
        self.modules.insert(path, module);
    }

    /// Every use of a module by another that lies neither above nor below it.
    pub(super) fn uses(&self) -> Vec<Use> {
        let mut uses = Vec::new();
        for (from, module) in &self.modules {
            for mention in &module.mentions {
                let Some(to) = self.resolve(from, &mention.path, 8) else {
                    continue;
                };
                if !from.starts_with(&to) && !to.starts_with(from) {
                    let place = format!("{}:{}", module.file, mention.line);
                    let from = from.clone();
                    uses.push(Use { from, to, place });
                }
            }
        }
        uses
    }

    /// The names of the modules in the crate's root.
    pub(super) fn top(&self) -> impl Iterator<Item = &str> {
        let paths = self.modules.keys().filter(|path| path.len() == 1);
        paths.map(|path| path[0].as_str())
    }

    /// The module that declares what a path names from a module on; none in another crate.
    fn resolve(&self, from: &[String], path: &[String], steps: usize) -> Option<Path> {
        let steps = steps.checked_sub(1)?;
        let (first, mut rest) = path.split_first()?;
        let mut at = match first.as_str() {
            "crate" => Vec::new(),
            "self" => from.to_vec(),
            "super" => from.split_last()?.1.to_vec(),
            name => {
                let child = [from, &[name.to_owned()]].concat();
                if self.modules.contains_key(&child) {
                    child
                } else {
                    let brought = self.modules.get(from)?.names.get(name)?;
                    if brought.first() == Some(first) {
                        return None;
                    }
                    return self.resolve(from, &[brought, rest].concat(), steps);
                }
            }
        };
        while let Some((next, behind)) = rest.split_first() {
            let child = [at.as_slice(), std::slice::from_ref(next)].concat();
            if next == "super" {
                at.pop()?;
            } else if self.modules.contains_key(&child) {
                at = child;
            } else {
                return Some(self.declaring(&at, next, steps).unwrap_or(at));
            }
            rest = behind;
        }
        Some(at)
    }

    /// Where an item of a module comes from, if the module itself has it from another.
    fn declaring(&self, at: &[String], item: &str, steps: usize) -> Option<Path> {
        let module = self.modules.get(at)?;
        if module.items.contains(item) {
            return None;
        }
        if let Some(path) = module.names.get(item) {
            return self.resolve(at, path, steps);
        }
        module.globs.iter().find_map(|glob| {
            let to = self.resolve(at, glob, steps)?;
            let has = self.modules.get(&to)?;
            let has_item = has.items.contains(item) || has.names.contains_key(item);
            has_item.then(|| self.declaring(&to, item, steps).unwrap_or(to))
        })
    }
}

impl Module {
    fn bring(&mut self, tree: &UseTree, mut path: Path) {
        match tree {
            UseTree::Path(tree) => {
                path.push(tree.ident.to_string());
                self.bring(&tree.tree, path);
            }
            UseTree::Name(tree) if tree.ident == "self" => {
                if let Some(name) = path.last() {
                    self.names.insert(name.clone(), path);
                }
            }
            UseTree::Name(tree) => {
                let name = tree.ident.to_string();
                path.push(name.clone());
                self.names.insert(name, path);
            }
            UseTree::Rename(tree) => {
                path.push(tree.ident.to_string());
                self.names.insert(tree.rename.to_string(), path);
            }
            UseTree::Glob(_) => self.globs.push(path),
            UseTree::Group(tree) => {
                for tree in &tree.items {
                    self.bring(tree, path.clone());
                }
            }
        }
    }
}

#[cfg(test)]
pub(super) mod tests {
    use super::*;

    /// A crate of files (name below `src/`, code), the root first.
    pub(in super::super) fn made_up(files: &[(&str, &str)]) -> Modules {
        let parse = |(name, code): &(&str, &str)| {
            Source::parse(&format!("src/{name}"), (*code).to_owned()).expect("Rust")
        };
        let sources: Vec<Source> = files.iter().map(parse).collect();
        Modules::of(&sources[0], &sources)
    }

    #[test]
    fn a_use_is_traced_to_the_module_that_declares_the_item() {
        let modules = made_up(&[
            ("lib.rs", "mod a; mod b;"),
            (
                "a.rs",
                "use crate::b::{Deep, Near};\n#[cfg(test)]\nmod tests { use crate::b::T; }",
            ),
            ("b.rs", "mod c; pub use c::*; pub struct Near;"),
            ("b/c.rs", "pub struct Deep;"),
        ]);
        let uses = modules.uses();
        let found: Vec<_> = uses
            .iter()
            .map(|it| (it.to.join("::"), it.place.as_str()))
            .collect();
        assert_eq!(
            found,
            [
                ("b::c".to_owned(), "src/a.rs:1"),
                ("b".to_owned(), "src/a.rs:1")
            ]
        );
    }
}
