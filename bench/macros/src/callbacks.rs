//! As many a firmware does it: a callback for each value, called by what it reads.
//!
//! From every input that changed, depth first through function pointers; where paths meet again,
//! a value is computed once for each of them. What the last callback leaves is right, as each
//! value is computed again behind every change of what it reads.

use proc_macro2::TokenStream;
use quote::{format_ident, quote};

use reflex_dataflow_language::code::{differs, mark};
use reflex_dataflow_language::{Computed, Plan, Value};

use crate::measured::{self, Tables};

/// The graph's type and its methods.
pub fn graph(plan: &Plan) -> TokenStream {
    let callbacks = plan.computed().map(|(value, it)| callback(plan, value, it));
    let values = plan.marked();
    let subscribers = values.map(|value| subscribers(plan, value));
    let (count, propagate) = (plan.marked().count(), propagate(plan));
    let tables = Tables {
        fields: quote! {
            subscribers: [&'static [fn(&mut Self)]; #count],
            ticked: ::reflex::dataflow::Dirty,
        },
        filled: quote! {
            // Registered at run time: the compiler must not see through them.
            subscribers: ::core::hint::black_box(Self::SUBSCRIBERS),
            ticked: ::reflex::dataflow::Dirty::CLEAN,
        },
        methods: quote! {
            const SUBSCRIBERS: [&'static [fn(&mut Self)]; #count] = [#(#subscribers),*];
            #propagate
            #(#callbacks)*

            fn tell(subscribers: &'static [fn(&mut Self)], graph: &mut Self) {
                for callback in subscribers {
                    callback(graph);
                }
            }
        },
    };
    measured::of_tables(plan, &tables)
}

fn propagate(plan: &Plan) -> TokenStream {
    let keep = measured::keep_before(plan);
    let tell = plan.inputs().map(|value| {
        let (mark, place) = (mark(&value.name), number(plan, value));
        quote!(if ticked.any(Self::#mark) { Self::tell(self.subscribers[#place], self); })
    });
    quote! {
        pub fn propagate(&mut self) {
            #keep
            let ticked = self.dirty.take();
            self.ticked = ticked;
            #(#tell)*
        }
    }
}

fn callback(plan: &Plan, value: &Value, computed: &Computed) -> TokenStream {
    let (name, place) = (&value.name, number(plan, value));
    let callback = format_ident!("on_{}", name);
    let expression = computed
        .expression
        .with(|read| measured::place(value, read));
    let differs = differs(computed, &quote!(new), &quote!(self.#name));
    let waits = value.clock().map(|clock| {
        let clock = mark(clock);
        quote!(if !self.ticked.any(Self::#clock) { return; })
    });
    quote! {
        fn #callback(&mut self) {
            #waits
            let new = #expression;
            if #differs {
                self.#name = new;
                Self::tell(self.subscribers[#place], self);
            }
        }
    }
}

/// The place of a value among those that have subscribers.
fn number(plan: &Plan, of: &Value) -> usize {
    plan.marked().take_while(|it| it.name != of.name).count()
}

/// The callbacks of everything that reads a value as it is now, or is clocked by it.
fn subscribers(plan: &Plan, of: &Value) -> TokenStream {
    let callbacks = plan.computed().filter(|(value, computed)| {
        let own = of.name == value.name;
        let reads = computed
            .reads()
            .any(|it| it.name == of.name && !it.last && !own);
        reads || value.clock() == Some(&of.name)
    });
    let callbacks = callbacks.map(|(value, _)| format_ident!("on_{}", value.name));
    quote!(&[#(Self::#callbacks),*])
}
