//! Code that every way to run a graph has in common.

use proc_macro2::{Ident, TokenStream};
use quote::{format_ident, quote};

use crate::expression::Expression;
use crate::graph::{Computed, Value};
use crate::plan::Plan;

/// The constant that marks a value as dirty.
pub fn mark(name: &Ident) -> Ident {
    format_ident!("{}", name.to_string().to_uppercase(), span = name.span())
}

/// What a value is before anything came in.
fn starting(value: &Value) -> TokenStream {
    match &value.starting {
        Some(starting) => quote!(#starting),
        None => quote!(::core::default::Default::default()),
    }
}

/// The arguments of `new`: the parameters that are given.
pub fn given_params(plan: &Plan) -> TokenStream {
    let given = plan.params().filter(|it| it.expression().is_none());
    let given = given.map(|value| {
        let (name, of_type) = (&value.name, &value.of_type);
        quote!(#name: #of_type)
    });
    quote!(#(#given),*)
}

/// `let NAME = ...;` for all values before anything came in. Nodes are computed from the others.
///
/// The parameters that are given are there already.
pub fn start(plan: &Plan) -> TokenStream {
    let here = |value: &Value, expression: &Expression| {
        let (name, of_type) = (&value.name, &value.of_type);
        let expression = expression.with(|read| {
            let read = &read.name;
            quote!(#read)
        });
        quote!(let #name: #of_type = #expression;)
    };
    let derived = plan.derived_params().map(|(value, it)| here(value, it));
    let given = plan.marked().filter(|it| !it.is_plain_node());
    let given = given.map(|value| {
        let (name, of_type, starting) = (&value.name, &value.of_type, starting(value));
        quote!(let #name: #of_type = #starting;)
    });
    let nodes = plan.computed().filter(|(value, _)| value.is_plain_node());
    let nodes = nodes.map(|(value, it)| here(value, &it.expression));
    quote!(#(#derived)* #(#given)* #(#nodes)*)
}

/// `Default` for a graph that needs no parameters.
pub fn default(plan: &Plan) -> TokenStream {
    if plan.params().next().is_some() {
        return TokenStream::new();
    }
    let name = &plan.graph.name;
    quote! {
        impl ::core::default::Default for #name {
            fn default() -> Self {
                Self::new()
            }
        }
    }
}

/// Whether a new value differs from the one last propagated, so that others must know.
pub fn differs(computed: &Computed, new: &TokenStream, stored: &TokenStream) -> TokenStream {
    match &computed.quantum {
        Some(quantum) => {
            quote!(::reflex::dataflow::Distance::distance(&#new, &#stored) >= #quantum)
        }
        None => quote!(#new != #stored),
    }
}
