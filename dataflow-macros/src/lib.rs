//! Compiles the declaration of a dataflow graph to straight-line code.
//!
//! What a graph is, and how it is declared, stands in `reflex::dataflow`. The language itself, from
//! tokens to a checked and ordered plan, is `reflex-dataflow-language`.

mod constants;
mod description;
mod graph;

use proc_macro::TokenStream;
use reflex_dataflow_language::{Graph, Plan};

/// Declares a graph: a plain struct, and propagation that runs only what a change reaches.
///
/// See `reflex::dataflow` for the declaration and for what is generated.
#[proc_macro]
pub fn graph(tokens: TokenStream) -> TokenStream {
    Graph::parse(tokens.into())
        .and_then(|graph| Plan::of(&graph).map(|plan| graph::graph(&plan)))
        .unwrap_or_else(|error| error.to_compile_error())
        .into()
}
