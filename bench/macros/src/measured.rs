//! What the ways to run a graph that are only measured have in common.
//!
//! Each is a struct of the declared name with the methods of the reactive one: `new`, `set_NAME`
//! for inputs, `propagate`, and `NAME` for outputs.

use proc_macro2::TokenStream;
use quote::{format_ident, quote};

use reflex_dataflow_language::code::{default, given_params, mark, start};
use reflex_dataflow_language::{Plan, Read, Value};

/// Marks of all values.
fn marks(plan: &Plan) -> TokenStream {
    let marks = (0u32..).zip(plan.marked()).map(|(number, value)| {
        let mark = mark(&value.name);
        quote! {
            const #mark: ::reflex::dataflow::Dirty = ::reflex::dataflow::Dirty::bit(#number);
        }
    });
    quote!(#(#marks)*)
}

/// Fields of all values, and of those that are remembered as they were before the run.
fn fields(plan: &Plan) -> TokenStream {
    let values = plan.graph.values.iter();
    let values = values.map(|value| field(&value.name, value));
    let before = before(plan).map(|value| field(&format_ident!("before_{}", value.name), value));
    quote!(#(#values,)* #(#before,)*)
}

fn field(name: &proc_macro2::Ident, value: &Value) -> TokenStream {
    let of_type = &value.of_type;
    quote!(#name: #of_type)
}

/// Values that somebody reads as they were before the run: states themselves, and `last NAME`.
fn before<'a>(plan: &'a Plan) -> impl Iterator<Item = &'a Value> {
    let values = plan.graph.values.iter();
    values.filter(|it| it.clock().is_some() || plan.is_remembered(&it.name))
}

/// The fields of a literal, behind `start`.
fn literal(plan: &Plan) -> TokenStream {
    let names = plan.graph.values.iter().map(|value| &value.name);
    let before = before(plan).map(|value| {
        let name = &value.name;
        let before = format_ident!("before_{}", name);
        quote!(#before: #name)
    });
    quote!(#(#names,)* #(#before,)*)
}

/// `set_NAME` of the inputs; what ticks is dirty, and what differs.
fn setters(plan: &Plan) -> TokenStream {
    let setters = plan.inputs().map(|value| {
        let (name, of_type, mark) = (&value.name, &value.of_type, mark(&value.name));
        let setter = format_ident!("set_{}", name);
        let is_clock = plan.is_clock(name);
        quote! {
            pub fn #setter(&mut self, #name: #of_type) {
                if #is_clock || self.#name != #name {
                    self.#name = #name;
                    self.dirty |= Self::#mark;
                }
            }
        }
    });
    quote!(#(#setters)*)
}

/// `NAME` of the outputs.
pub fn getters(plan: &Plan) -> TokenStream {
    let outputs = plan.graph.values.iter().filter(|it| it.is_output());
    let getters = outputs.map(|value| {
        let (name, of_type) = (&value.name, &value.of_type);
        quote! {
            #[must_use]
            pub fn #name(&self) -> &#of_type { &self.#name }
        }
    });
    quote!(#(#getters)*)
}

/// Keeps the values that are read as they were before the run.
pub fn keep_before(plan: &Plan) -> TokenStream {
    let keep = before(plan).map(|value| {
        let name = &value.name;
        let before = format_ident!("before_{}", name);
        quote!(self.#before = self.#name;)
    });
    quote!(#(#keep)*)
}

/// Where a value is found, in a graph that keeps what was before.
pub fn place(value: &Value, read: &Read) -> TokenStream {
    let name = &read.name;
    if read.last || (*name == value.name && value.clock().is_some()) {
        let before = format_ident!("before_{}", name);
        quote!(self.#before)
    } else {
        quote!(self.#name)
    }
}

/// What the graphs of nodes behind function pointers differ by.
pub struct Tables {
    /// Their fields.
    pub fields: TokenStream,
    /// What these begin with.
    pub filled: TokenStream,
    /// How a change spreads, and the functions of the nodes.
    pub methods: TokenStream,
}

/// The type of a graph that stores every value, and finds its nodes in tables.
pub fn of_tables(plan: &Plan, tables: &Tables) -> TokenStream {
    let (attributes, visibility) = (&plan.graph.attributes, &plan.graph.visibility);
    let name = &plan.graph.name;
    let (values, start, literal) = (fields(plan), start(plan), literal(plan));
    let (given, default) = (given_params(plan), default(plan));
    let common = [marks(plan), setters(plan), getters(plan)];
    let Tables {
        fields,
        filled,
        methods,
    } = tables;
    quote! {
        #(#attributes)*
        #[derive(Clone, Debug)]
        #visibility struct #name {
            #values
            #fields
            dirty: ::reflex::dataflow::Dirty,
        }

        #[allow(missing_docs)]
        impl #name {
            #[must_use]
            pub fn new(#given) -> Self {
                #start
                Self {
                    #literal
                    #filled
                    dirty: ::reflex::dataflow::Dirty::CLEAN,
                }
            }
            #(#common)*
            #methods
        }

        #default
    }
}
