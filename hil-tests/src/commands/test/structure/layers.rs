//! The layers of modules: each uses its own layer and those below.

use super::modules::Modules;

/// The layers of one crate, the lowest first.
struct Layers {
    /// File of the crate's root.
    root: &'static str,
    layers: &'static [&'static [&'static str]],
}

const LAYERS: [Layers; 2] = [
    Layers {
        root: "src/lib.rs",
        layers: &[
            &[
                "battery", "config", "math", "numbered", "reset", "sensors", "settings", "time",
                "units",
            ],
            &["airframe", "control", "dataflow", "estimate"],
            &["graph"],
            &["link", "reactive", "safety"],
            &["store"],
            &["app"],
            &["tasks"],
        ],
    },
    Layers {
        root: "hil-tests/src/lib.rs",
        layers: &[
            &[
                "clock",
                "faults",
                "ground_station",
                "interval",
                "json",
                "mountings",
                "output_file",
                "page",
                "progress",
                "refusal",
            ],
            &[
                "logics",
                "magnetometer",
                "parallel",
                "picture",
                "plot",
                "scoring",
                "toolchain",
            ],
            &["firmware"],
            &["flight_log", "native", "record"],
            &["closed_loop", "replay"],
            &["profile", "scenarios", "sweep", "tune"],
            &["costs"],
            &["campaign"],
            &["fuzz"],
            &["commands"],
        ],
    },
];

/// One line for each use of a higher layer, and for each entry that is out of date.
pub(super) fn faults(modules: &Modules) -> Vec<String> {
    let layers = LAYERS.iter().find(|layers| layers.root == modules.root);
    layers.map_or_else(Vec::new, |layers| layers.faults(modules))
}

impl Layers {
    fn layer(&self, name: &str) -> Option<usize> {
        self.layers.iter().position(|layer| layer.contains(&name))
    }

    fn faults(&self, modules: &Modules) -> Vec<String> {
        let mut faults = Vec::new();
        for used in modules.uses() {
            let (from, to) = (&used.from[0], &used.to[0]);
            if let (Some(own), Some(other)) = (self.layer(from), self.layer(to))
                && own < other
            {
                faults.push(format!("{}: {from} lies below {to}", used.place));
            }
        }
        let without = modules.top().filter(|name| self.layer(name).is_none());
        faults.extend(without.map(|name| format!("{}: {name} has no layer", self.root)));
        let listed = self.layers.iter().copied().flatten();
        let gone = listed.filter(|name| !modules.top().any(|module| module == **name));
        faults.extend(gone.map(|name| format!("{}: there is no module {name}", self.root)));
        faults
    }
}

#[cfg(test)]
mod tests {
    use super::super::modules::tests::made_up;
    use super::*;

    const TWO: Layers = Layers {
        root: "src/lib.rs",
        layers: &[&["low"], &["high", "other"]],
    };

    #[test]
    fn a_use_of_a_higher_layer_is_named_with_its_place() {
        let modules = made_up(&[
            ("lib.rs", "mod low; mod high; mod other;"),
            ("low.rs", "use crate::high::High;"),
            ("high.rs", "use crate::other::Other;"),
            ("other.rs", "pub struct Other;"),
        ]);
        assert_eq!(TWO.faults(&modules), ["src/low.rs:1: low lies below high"]);
    }

    #[test]
    fn every_module_has_a_layer_and_every_entry_a_module() {
        let modules = made_up(&[
            ("lib.rs", "mod low; mod high; mod new;"),
            ("low.rs", ""),
            ("high.rs", ""),
            ("new.rs", ""),
        ]);
        assert_eq!(
            TWO.faults(&modules),
            [
                "src/lib.rs: new has no layer",
                "src/lib.rs: there is no module other"
            ]
        );
    }
}
