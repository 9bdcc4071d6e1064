//! No two modules of one folder use each other, directly or by way of others.
//!
//! A module and what lies in its folder are one thing: between those no circle is looked for.

use std::collections::{BTreeMap, VecDeque};

use super::modules::{Modules, Path};

/// Uses between the modules of one folder: who, whom, and the first place.
type Graph = BTreeMap<String, BTreeMap<String, String>>;

/// One line for each circle, with a place for each of its steps.
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
    for (folder, mut graph) in graphs {
        let folder: String = folder.iter().map(|name| format!("{name}::")).collect();
        while let Some(circle) = shortest_circle(&graph) {
            let place = |(from, to): &(String, String)| {
                format!("{folder}{from} uses {to} ({})", graph[from][to])
            };
            let places: Vec<String> = circle.iter().map(place).collect();
            faults.push(format!("{}: a circle: {}", modules.root, places.join(", ")));
            for (from, to) in &circle {
                graph.get_mut(from).map(|of| of.remove(to));
            }
        }
    }
    faults
}

/// The steps of a circle, none where there is none.
fn shortest_circle(graph: &Graph) -> Option<Vec<(String, String)>> {
    let circles = graph.keys().filter_map(|start| way_back(graph, start));
    circles.min_by_key(Vec::len)
}

/// The shortest way from a module to itself.
fn way_back(graph: &Graph, start: &str) -> Option<Vec<(String, String)>> {
    let mut before = BTreeMap::<&str, &str>::new();
    let mut waiting = VecDeque::from([start]);
    while let Some(from) = waiting.pop_front() {
        for to in graph.get(from).into_iter().flat_map(BTreeMap::keys) {
            if to == start {
                let mut steps = vec![(from.to_owned(), to.clone())];
                let mut at = from;
                while at != start {
                    steps.push((before[at].to_owned(), at.to_owned()));
                    at = before[at];
                }
                steps.reverse();
                return Some(steps);
            }
            if !before.contains_key(to.as_str()) {
                before.insert(to, from);
                waiting.push_back(to);
            }
        }
    }
    None
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
