//! From a plan to Rust: one file for each way to run a graph.

pub mod callbacks;
mod constants;
mod description;
mod measured;
pub mod pointer_vector;
pub mod reactive;
pub mod straight_line;

use proc_macro2::{Ident, TokenStream};
use quote::{format_ident, quote};

use crate::graph::{Argument, Computed, Value};
use crate::plan::Plan;

/// The constant that marks a value as dirty.
fn mark(name: &Ident) -> Ident {
    format_ident!("{}", name.to_string().to_uppercase(), span = name.span())
}

/// A call of a value's function; `place` says where an argument's value is found.
fn call(computed: &Computed, place: impl Fn(&Argument) -> TokenStream) -> TokenStream {
    let function = &computed.function;
    let arguments = computed.arguments.iter().map(|argument| {
        let place = place(argument);
        if argument.by_reference {
            quote!(&#place)
        } else {
            place
        }
    });
    quote!(#function(#(#arguments),*))
}

/// What a value is before anything came in.
fn starting(value: &Value) -> TokenStream {
    match &value.starting {
        Some(starting) => quote!(#starting),
        None => quote!(::core::default::Default::default()),
    }
}

/// `let NAME = ...;` for all values before anything came in: what nodes come to, too.
fn start(plan: &Plan) -> TokenStream {
    let given = plan.graph.values.iter().filter(|it| !it.is_plain_node());
    let given = given.map(|value| {
        let (name, of_type, starting) = (&value.name, &value.of_type, starting(value));
        quote!(let #name: #of_type = #starting;)
    });
    let nodes = plan.computed().filter(|(value, _)| value.is_plain_node());
    let nodes = nodes.map(|(value, computed)| {
        let name = &value.name;
        let call = call(computed, |argument| {
            let read = &argument.name;
            quote!(#read)
        });
        quote!(let #name = #call;)
    });
    quote!(#(#given)* #(#nodes)*)
}

/// Whether a new value differs from the one last propagated, so that others must know.
fn differs(computed: &Computed, new: &TokenStream, stored: &TokenStream) -> TokenStream {
    match &computed.quantum {
        Some(quantum) => {
            quote!(::reflex::dataflow::Distance::distance(&#new, &#stored) >= #quantum)
        }
        None => quote!(#new != #stored),
    }
}
