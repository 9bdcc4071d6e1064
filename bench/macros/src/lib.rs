//! Runs the firmware's control logics in other ways, to measure what each costs.
//!
//! The pages of `src/graph/` are read as they stand: nothing in them is there for the benchmark.

mod callbacks;
mod measured;
mod page;
mod pointer_vector;
mod straight_line;

use proc_macro::TokenStream;
use quote::quote;
use syn::{Ident, parse_macro_input};

use page::Page;

/// `every_way!(NAME)`: the page `src/graph/NAME.rs` in its three other ways, each in a module.
///
/// | module | is |
/// |---|---|
/// | `straight_line` | one function that computes everything at every step |
/// | `callbacks` | a callback for each value, depth first from every input that changed |
/// | `pointer_vector` | nodes behind a pointer vector, level by level |
///
/// Each holds all of the page but its tests and the autopilot's door, with another `graph!`, whose
/// type is a `Way`. The page's own graph is one too.
#[proc_macro]
pub fn every_way(name: TokenStream) -> TokenStream {
    let name = parse_macro_input!(name as Ident);
    Page::read(&name)
        .and_then(|page| page.in_every_way())
        .unwrap_or_else(|error| {
            let error = syn::Error::new(name.span(), error).to_compile_error();
            quote!(#error)
        })
        .into()
}
