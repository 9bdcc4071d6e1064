//! Compiles the declaration of a dataflow graph to straight-line code.
//!
//! ```text
//! tokens -> parse -> Graph -> check, order -> Plan -> emit -> tokens
//! ```
//! What a graph is, and how it is declared, stands in `reflex::dataflow`. The other macros make
//! the same graph run in other ways, from the same declaration, to measure what each costs.

mod emit;
mod graph;
mod parse;
mod plan;

use proc_macro::TokenStream;
use syn::parse_macro_input;

use graph::Graph;
use plan::Plan;

/// Declares a graph: a plain struct, and propagation that runs only what a change reaches.
///
/// See `reflex::dataflow` for the declaration and for what is generated.
#[proc_macro]
pub fn graph(tokens: TokenStream) -> TokenStream {
    let declaration = proc_macro2::TokenStream::from(tokens.clone());
    let graph = parse_macro_input!(tokens as Graph);
    expand(&graph, |plan| emit::reactive::graph(plan, &declaration))
}

/// For measuring: the graph as one function that computes everything at every step.
#[proc_macro]
pub fn straight_line(tokens: TokenStream) -> TokenStream {
    let graph = parse_macro_input!(tokens as Graph);
    expand(&graph, emit::straight_line::graph)
}

/// For measuring: the graph as callbacks, depth first from every input that changed.
#[proc_macro]
pub fn callbacks(tokens: TokenStream) -> TokenStream {
    let graph = parse_macro_input!(tokens as Graph);
    expand(&graph, emit::callbacks::graph)
}

/// For measuring: the graph as nodes behind a pointer vector, level by level.
#[proc_macro]
pub fn pointer_vector(tokens: TokenStream) -> TokenStream {
    let graph = parse_macro_input!(tokens as Graph);
    expand(&graph, emit::pointer_vector::graph)
}

fn expand(graph: &Graph, emit: impl Fn(&Plan) -> proc_macro2::TokenStream) -> TokenStream {
    Plan::of(graph)
        .map(|plan| emit(&plan))
        .unwrap_or_else(|error| error.to_compile_error())
        .into()
}
