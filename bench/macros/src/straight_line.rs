//! Time-triggered: one function that computes everything at every step.
//!
//! As a programmer would write it: what only hands results on is a local variable.

use proc_macro2::TokenStream;
use quote::{format_ident, quote};

use reflex_dataflow_language::code::{default, given_params, start};
use reflex_dataflow_language::{Computed, Plan, Value};

use crate::measured;

/// The graph's type and its methods.
pub fn graph(plan: &Plan) -> TokenStream {
    let (attributes, visibility) = (&plan.graph.attributes, &plan.graph.visibility);
    let name = &plan.graph.name;
    let kept = || {
        plan.graph
            .values
            .iter()
            .filter(|value| is_kept(plan, value))
    };
    let fields = kept().map(|value| {
        let (name, of_type) = (&value.name, &value.of_type);
        quote!(#name: #of_type)
    });
    let (given, start, default) = (given_params(plan), start(plan), default(plan));
    let names = kept().map(|value| &value.name);
    let setters = plan.inputs().map(|value| {
        let (name, of_type) = (&value.name, &value.of_type);
        let setter = format_ident!("set_{}", name);
        quote!(pub fn #setter(&mut self, #name: #of_type) { self.#name = #name; })
    });
    let getters = measured::getters(plan);
    let steps = plan
        .computed()
        .map(|(value, computed)| step(plan, value, computed));
    let store = kept()
        .filter(|value| value.computed().is_some())
        .map(|value| {
            let name = &value.name;
            quote!(self.#name = #name;)
        });
    quote! {
        #(#attributes)*
        #[derive(Clone, Debug)]
        #visibility struct #name { #(#fields,)* }

        #[allow(missing_docs)]
        impl #name {
            #[must_use]
            pub fn new(#given) -> Self {
                #start
                Self { #(#names,)* }
            }
            #(#setters)*
            #getters
            pub fn propagate(&mut self) {
                #(#steps)*
                #(#store)*
            }
        }

        #default
    }
}

/// Parameters, inputs, states, outputs, and what a state reads of the step before.
fn is_kept(plan: &Plan, value: &Value) -> bool {
    value.computed().is_none()
        || value.clock().is_some()
        || value.is_output()
        || plan.is_remembered(&value.name)
}

fn step(plan: &Plan, value: &Value, computed: &Computed) -> TokenStream {
    let (name, of_type) = (&value.name, &value.of_type);
    let expression = computed.expression.with(|read| {
        let found = &read.name;
        let is_computed = plan.value(found).computed().is_some();
        if !is_computed || read.last || found == name {
            quote!(self.#found)
        } else {
            quote!(#found)
        }
    });
    quote!(let #name: #of_type = #expression;)
}
