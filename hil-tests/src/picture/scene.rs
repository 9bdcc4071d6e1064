//! What DOT and SVG both draw: boxes with labels, and arrows between them.

use reflex::dataflow::{Described, Description, Kind, Source};

/// What the picture says of the lines.
pub(super) const LEGEND: &str =
    "solid: value of this run; dashed: value before this run; dotted: clock";

/// What a box stands for.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Role {
    Input,
    State,
    Node,
    Output,
}

/// How an arrow is drawn.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Stroke {
    /// A value of this run.
    Solid,
    /// A value from before this run.
    Dashed,
    /// What clocks a state.
    Dotted,
}

/// A value of the graph.
#[derive(Clone, Debug)]
pub(super) struct Shape {
    pub(super) role: Role,
    pub(super) name: &'static str,
    pub(super) doc: &'static str,
    /// Its lines of text, the name first.
    pub(super) label: Vec<String>,
}

/// Who reads whom.
#[derive(Clone, Copy, Debug)]
pub(super) struct Arrow {
    pub(super) from: &'static str,
    pub(super) to: &'static str,
    pub(super) stroke: Stroke,
}

/// The boxes, in the order of the description.
pub(super) fn shapes(graph: &Description) -> Vec<Shape> {
    graph.values.iter().map(shape).collect()
}

fn shape(value: &Described) -> Shape {
    let of_type = type_words(value.of_type);
    let rate = rate_words(value.most_updates);
    let (role, label) = match value.source {
        Source::Input { gates, triggers } => {
            let roles = [("gates", gates), ("triggers", triggers)];
            let mut does: Vec<&str> = roles.iter().filter(|role| role.1).map(|r| r.0).collect();
            if does.is_empty() {
                does.push("joins");
            }
            let clauses = format!("{rate}, {}", does.join(", "));
            (Role::Input, vec![of_type, clauses])
        }
        Source::Computed {
            kind,
            function,
            quantum,
            ..
        } => {
            let (role, clause) = match kind {
                Kind::State { clock } => (Role::State, format!(", clocked by {clock}")),
                Kind::Node => (Role::Node, String::new()),
                Kind::Output => (Role::Output, String::new()),
            };
            let quantum = quantum.map_or_else(String::new, |size| format!(", quantum {size}"));
            let clauses = format!("at most {rate}{clause}{quantum}");
            (role, vec![format!("{function}: {of_type}"), clauses])
        }
    };
    Shape {
        role,
        name: value.name,
        doc: value.doc,
        label: std::iter::once(value.name.to_owned())
            .chain(label)
            .collect(),
    }
}

/// The arrows: for each reader those of its values in order, then its clock.
///
/// A state that reads its own name reads what it was before the run.
pub(super) fn arrows(graph: &Description) -> Vec<Arrow> {
    let mut arrows = Vec::new();
    for value in graph.values {
        let Source::Computed { kind, reads, .. } = value.source else {
            continue;
        };
        let to = value.name;
        for read in reads {
            let before = read.last || read.name == to;
            let stroke = if before {
                Stroke::Dashed
            } else {
                Stroke::Solid
            };
            arrows.push(Arrow {
                from: read.name,
                to,
                stroke,
            });
        }
        if let Kind::State { clock } = kind {
            arrows.push(Arrow {
                from: clock,
                to,
                stroke: Stroke::Dotted,
            });
        }
    }
    arrows
}

/// A type as it is written, without the spaces between its tokens.
pub(super) fn type_words(of_type: &str) -> String {
    of_type
        .replace(" :: ", "::")
        .replace(" <", "<")
        .replace("< ", "<")
        .replace(" >", ">")
}

/// A rate in Hz, given in mHz.
fn rate_words(millihertz: u64) -> String {
    format!("{} Hz", millihertz as f64 / 1000.0)
}
