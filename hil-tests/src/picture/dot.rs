//! The picture in Graphviz's language: `dot -Tsvg`, or another reader.

use std::fmt::Write;

use reflex::dataflow::Description;

use super::scene::{Arrow, LEGEND, Role, Shape, Stroke, arrows, shapes};

/// The graph in DOT, inputs on top.
#[must_use]
pub fn dot(graph: &Description) -> String {
    let title = format!("{}: {}\n{LEGEND}", graph.name, graph.doc);
    let shapes = shapes(graph);
    let mut text = format!("digraph {} {{\n", quoted(graph.name));
    push(
        &mut text,
        &format!("graph [label={}, labelloc=t]", quoted(&title)),
    );
    push(&mut text, "graph [fontname=\"sans-serif\", ranksep=0.6]");
    push(
        &mut text,
        "node [shape=box, fontname=\"sans-serif\", fontsize=11]",
    );
    for shape in &shapes {
        push(&mut text, &box_of(shape));
    }
    let inputs = shapes.iter().filter(|shape| shape.role == Role::Input);
    let names: Vec<String> = inputs.map(|shape| quoted(shape.name)).collect();
    push(
        &mut text,
        &format!("{{ rank=source; {} }}", names.join("; ")),
    );
    for arrow in arrows(graph) {
        push(&mut text, &line_of(&arrow));
    }
    text + "}\n"
}

fn push(text: &mut String, statement: &str) {
    // Writing to a string cannot fail.
    let _ = writeln!(text, "    {statement};");
}

fn box_of(shape: &Shape) -> String {
    let style = match shape.role {
        Role::Input => "style=\"rounded,filled\", fillcolor=\"#eeeeee\"",
        Role::State => "style=filled, fillcolor=\"#cfe2f7\"",
        Role::Node => "style=filled, fillcolor=\"#ffffff\"",
        Role::Output => "style=\"filled,bold\", fillcolor=\"#ffffff\"",
    };
    let (name, label) = (quoted(shape.name), quoted(&shape.label.join("\n")));
    format!(
        "{name} [label={label}, tooltip={}, {style}]",
        quoted(shape.doc)
    )
}

/// What was before this run does not pull its reader below it.
fn line_of(arrow: &Arrow) -> String {
    let style = match arrow.stroke {
        Stroke::Solid => "",
        Stroke::Dashed => " [style=dashed, constraint=false]",
        Stroke::Dotted => " [style=dotted, arrowhead=empty]",
    };
    format!("{} -> {}{style}", quoted(arrow.from), quoted(arrow.to))
}

/// A string of DOT: quotes and line ends escaped, backslashes kept as such.
fn quoted(text: &str) -> String {
    let escaped = text
        .replace('\\', "\\\\")
        .replace('"', "\\\"")
        .replace('\n', "\\n");
    format!("\"{escaped}\"")
}
