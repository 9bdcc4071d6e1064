//! No two modules of one folder use each other, directly or by way of others.
//!
//! A module and what lies in its folder are one thing: between those no circle is looked for.

use std::collections::{BTreeMap, BTreeSet};

use super::modules::{Modules, Path};

/// Uses between the modules of one folder: who, whom, and the first place.
type Graph = BTreeMap<String, BTreeMap<String, String>>;

/// One line for each folder with a circle: every use on the way round, with its place.
pub(super) fn faults(modules: &Modules) -> Vec<String> {
    let mut graphs = BTreeMap::<Path, Graph>::new();
    for used in modules.uses() {
        let pairs = used.from.iter().zip(&used.to);
        let common = pairs.take_while(|(from, to)| from == to).count();
        let graph = graphs.entry(used.from[..common].to_vec()).or_default();
        let of = graph.entry(used.from[common].clone()).or_default();
        of.entry(used.to[common].clone()).or_insert(used.place);
    }
    let mut faults = Vec::new();
    for (folder, graph) in graphs {
        let folder: String = folder.iter().map(|name| format!("{name}::")).collect();
        let mut uses = Vec::new();
        for (from, of) in &graph {
            for (to, place) in of {
                if reached(&graph, to).contains(from.as_str()) {
                    uses.push(format!("{folder}{from} uses {to} ({place})"));
                }
            }
        }
        if !uses.is_empty() {
            faults.push(format!("{}: a circle: {}", modules.root, uses.join(", ")));
        }
    }
    faults
}

/// The modules that one uses, directly or by way of others.
fn reached<'g>(graph: &'g Graph, from: &'g str) -> BTreeSet<&'g str> {
    let (mut reached, mut waiting) = (BTreeSet::new(), vec![from]);
    while let Some(from) = waiting.pop() {
        let new = graph.get(from).into_iter().flat_map(BTreeMap::keys);
        waiting.extend(
            new.filter(|to| reached.insert(to.as_str()))
                .map(String::as_str),
        );
    }
    reached
}

#[cfg(test)]
mod tests {
    use super::super::modules::tests::made_up;
    use super::*;

    #[test]
    fn a_circle_is_named_with_a_place_for_each_step() {
        let modules = made_up(&[
            ("lib.rs", "mod a; mod b; mod c;"),
            ("a.rs", "use crate::b::B;"),
            ("b.rs", "use crate::c::deep::C;"),
            ("c.rs", "pub mod deep;"),
            ("c/deep.rs", "\nfn f() { crate::a::g() }"),
        ]);
        assert_eq!(
            faults(&modules),
            [
                "src/lib.rs: a circle: a uses b (src/a.rs:1), b uses c (src/b.rs:1), \
                 c uses a (src/c/deep.rs:2)"
            ]
        );
    }

    #[test]
    fn a_module_and_its_folder_are_one_thing() {
        let modules = made_up(&[
            ("lib.rs", "mod a; mod b;"),
            ("a.rs", "mod c; use c::C; pub struct A; use crate::b::B;"),
            ("a/c.rs", "use super::A; pub struct C;"),
            ("b.rs", "pub struct B;"),
        ]);
        assert!(faults(&modules).is_empty());
    }
}
