//! A plain struct, straight-line code, dirty marks in one word.

use proc_macro2::{Ident, TokenStream};
use quote::{format_ident, quote, quote_spanned};

use reflex_dataflow_language::code::{default, differs, given_params, mark, start};
use reflex_dataflow_language::{Computed, Plan, Read, Value};

use crate::{constants, description};

/// The graph's type, its constants and methods.
pub fn graph(plan: &Plan) -> TokenStream {
    let graph = plan.graph;
    let (attributes, visibility, name) = (&graph.attributes, &graph.visibility, &graph.name);
    let fields = graph.values.iter().map(|value| {
        let (docs, name, of_type) = (&value.docs, &value.name, &value.of_type);
        quote!(#(#docs)* #name: #of_type)
    });
    let constants = constants::of_type(plan);
    let assertions = constants::assertions(plan);
    let description = description::of_type(plan);
    let methods = [new(plan), params(plan), setters(plan), getters(plan)];
    let propagation = [propagate(plan), recompute(plan), foresee(plan)];
    let default = default(plan);
    quote! {
        #(#attributes)*
        #[derive(Clone, Debug)]
        #visibility struct #name {
            #(#fields,)*
            dirty: ::reflex::dataflow::Dirty,
        }

        #assertions

        impl #name {
            #constants
            #description
            #(#methods)*
            #(#propagation)*
        }

        #default
    }
}

/// Starting values, and the nodes computed from them: nothing is ever stale.
fn new(plan: &Plan) -> TokenStream {
    let (given, start) = (given_params(plan), start(plan));
    let names = plan.graph.values.iter().map(|value| &value.name);
    quote! {
        /// The graph with its parameters and starting values.
        #[must_use]
        pub fn new(#given) -> Self {
            #start
            Self { #(#names,)* dirty: ::reflex::dataflow::Dirty::CLEAN }
        }
    }
}

/// `set_NAME` of the parameters that are given; those that are made of them follow.
fn params(plan: &Plan) -> TokenStream {
    let given = plan.params().filter(|it| it.expression().is_none());
    let setters = given.map(|value| {
        let (name, of_type) = (&value.name, &value.of_type);
        let setter = format_ident!("set_{}", name);
        let doc = format!("Sets `{name}`, which counts from the next run on and asks for none.");
        let derived = plan
            .derived_params()
            .filter(|(value, _)| plan.needed_now(value).contains(&plan.place(name)))
            .map(|(value, expression)| {
                let (name, expression) = (&value.name, expression.with(stored));
                quote!(self.#name = #expression;)
            });
        quote! {
            #[doc = #doc]
            pub fn #setter(&mut self, #name: #of_type) {
                self.#name = #name;
                #(#derived)*
            }
        }
    });
    quote!(#(#setters)*)
}

/// `set_NAME` of inputs and states.
fn setters(plan: &Plan) -> TokenStream {
    let set = plan.marked().filter(|it| !it.is_plain_node());
    let setters = set.map(|value| {
        let (name, of_type, mark) = (&value.name, &value.of_type, mark(&value.name));
        let setter = format_ident!("set_{}", name);
        let is_clock = plan.is_clock(name);
        let doc = match (value.clock(), is_clock) {
            (Some(_), _) => format!("Starts the state `{name}` anew from this value."),
            (None, true) => format!("A new sample of `{name}`, which advances what it clocks."),
            (None, false) => format!("Sets `{name}`; a value that is the same reaches nothing."),
        };
        let store = quote! {
            self.#name = #name;
            self.dirty |= Self::#mark;
        };
        let store = if is_clock {
            store
        } else {
            quote!(if self.#name != #name { #store })
        };
        quote! {
            #[doc = #doc]
            pub fn #setter(&mut self, #name: #of_type) { #store }
        }
    });
    quote!(#(#setters)*)
}

/// Every value, as last propagated; inputs and parameters as last set.
fn getters(plan: &Plan) -> TokenStream {
    let values = plan.graph.values.iter();
    let readable = values.filter(|it| !it.is_param() || it.expression().is_none());
    let getters = readable.map(|value| {
        let (docs, name, of_type) = (&value.docs, &value.name, &value.of_type);
        quote! {
            #(#docs)*
            #[must_use]
            pub fn #name(&self) -> &#of_type { &self.#name }
        }
    });
    quote!(#(#getters)*)
}

/// Runs the slice that the changed inputs reach.
fn propagate(plan: &Plan) -> TokenStream {
    let remembered = remembered(plan);
    let steps = plan.computed().map(|(value, computed)| {
        let (name, mark) = (&value.name, mark(&value.name));
        let wakes = plan.wakes(value).into_iter().map(|it| self::mark(&it.name));
        let expression = computed.expression.with(stored);
        let differs = differs(computed, &quote!(new), &quote!(self.#name));
        quote! {
            if dirty.any(::reflex::dataflow::Dirty::CLEAN #(.or(Self::#wakes))*) {
                let new = #expression;
                if #differs {
                    self.#name = new;
                    dirty |= Self::#mark;
                }
            }
        }
    });
    let all = plan.marked().map(|value| mark(&value.name));
    quote! {
        /// Runs the slice that the changed inputs reach; says which values changed.
        ///
        /// Where every input changed, everything is computed, and nothing compared.
        pub fn propagate(&mut self) -> ::reflex::dataflow::Dirty {
            let mut dirty = self.dirty.take();
            if dirty.all(Self::INPUTS) {
                self.recompute();
                return ::reflex::dataflow::Dirty::CLEAN #(.or(Self::#all))*;
            }
            #(#remembered)*
            #(#steps)*
            dirty
        }
    }
}

/// Computes every value, one after the other, and compares none.
fn recompute(plan: &Plan) -> TokenStream {
    let remembered = remembered(plan);
    let steps = plan.computed().map(|(value, computed)| {
        let (name, expression) = (&value.name, computed.expression.with(stored));
        quote!(self.#name = #expression;)
    });
    quote! {
        fn recompute(&mut self) {
            #(#remembered)*
            #(#steps)*
        }
    }
}

/// Computes what an output would be after a run, and changes nothing.
fn foresee(plan: &Plan) -> TokenStream {
    let outputs = plan.graph.values.iter().filter(|it| it.is_output());
    let methods = outputs.map(|output| {
        let needed = plan.needed_now(output);
        let (name, of_type) = (&output.name, &output.of_type);
        let method = format_ident!("foresee_{}", name);
        let steps = plan
            .computed()
            .filter(|(value, _)| needed.contains(&plan.place(&value.name)))
            .map(|(value, computed)| foreseen(plan, value, computed));
        let doc = format!("What [`Self::propagate`] would bring `{name}` to; advances nothing.");
        quote! {
            #[doc = #doc]
            #[must_use]
            pub fn #method(&self) -> #of_type {
                let pending = self.dirty;
                #(#steps)*
                #name
            }
        }
    });
    quote!(#(#methods)*)
}

/// One value of what would come, as a local variable.
fn foreseen(plan: &Plan, value: &Value, computed: &Computed) -> TokenStream {
    let name = &value.name;
    let expression = computed.expression.with(|read| {
        let found = &read.name;
        let unchanged = read.last || found == name || plan.value(found).computed().is_none();
        if unchanged {
            field(found)
        } else {
            local(found)
        }
    });
    if let Some(clock) = value.clock() {
        let clock = mark(clock);
        return quote!(let #name = if pending.any(Self::#clock) { #expression } else { self.#name };);
    }
    if computed.quantum.is_none() {
        return quote!(let #name = #expression;);
    }
    let differs = differs(computed, &quote!(new), &quote!(self.#name));
    quote! {
        let new = #expression;
        let #name = if pending.all(Self::INPUTS) || #differs { new } else { self.#name };
    }
}

/// Copies of the values that a state reads as they were before the run.
fn remembered(plan: &Plan) -> Vec<TokenStream> {
    let values = plan.graph.values.iter();
    values
        .filter(|value| plan.is_remembered(&value.name))
        .map(|value| {
            let (name, last) = (&value.name, last(&value.name));
            quote!(let #last = self.#name;)
        })
        .collect()
}

/// Where a value is found while values are stored one after the other.
fn stored(read: &Read) -> TokenStream {
    let name = &read.name;
    if read.last {
        let last = last(name);
        quote!(#last)
    } else {
        field(name)
    }
}

/// A field, at the place of its name: there an argument of a wrong type is shown.
fn field(name: &Ident) -> TokenStream {
    quote_spanned!(name.span() => self.#name)
}

fn local(name: &Ident) -> TokenStream {
    quote!(#name)
}

fn last(name: &Ident) -> Ident {
    format_ident!("last_{}", name)
}
