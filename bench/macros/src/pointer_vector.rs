//! The layout of RP-Embedded (Bregu et al., MobiSys 2016, section 6.2).
//!
//! One vector points from each node, in a segment of its own, to the nodes that use it; a second
//! one, `quick_access`, to where each segment begins. Nodes stand in the order of their levels,
//! and each is computed at most once. Pointers are numbers of nodes.

use proc_macro2::TokenStream;
use quote::{format_ident, quote};

use reflex_dataflow_language::code::{differs, mark};
use reflex_dataflow_language::{Computed, Plan, Value};

use crate::measured::{self, Tables};

/// The graph's type and its methods.
pub fn graph(plan: &Plan) -> TokenStream {
    let updates = plan.computed().map(|(value, it)| update(value, it));
    let vectors = Vectors::of(plan);
    let (pointers, quick_access) = (&vectors.pointers, &vectors.quick_access);
    let functions = plan
        .computed()
        .map(|(it, _)| format_ident!("update_{}", it.name));
    let inputs = plan.inputs().map(|value| {
        let waiting = bits(&users(plan, value));
        let mark = mark(&value.name);
        quote!((Self::#mark, #waiting))
    });
    let (most, ends, nodes) = (pointers.len(), quick_access.len(), quick_access.len() - 1);
    let (count, propagate) = (plan.inputs().count(), propagate(plan));
    let tables = Tables {
        fields: quote! {
            pointers: [u8; #most],
            quick_access: [u8; #ends],
            nodes: [fn(&mut Self) -> bool; #nodes],
            inputs: [(::reflex::dataflow::Dirty, u32); #count],
        },
        filled: quote! {
            // Filled at run time: the compiler must not see through them.
            pointers: ::core::hint::black_box([#(#pointers),*]),
            quick_access: ::core::hint::black_box([#(#quick_access),*]),
            nodes: ::core::hint::black_box([#(Self::#functions),*]),
            inputs: ::core::hint::black_box([#(#inputs),*]),
        },
        methods: quote! {
            #propagate
            #(#updates)*
        },
    };
    measured::of_tables(plan, &tables)
}

fn propagate(plan: &Plan) -> TokenStream {
    let keep = measured::keep_before(plan);
    quote! {
        pub fn propagate(&mut self) {
            #keep
            let dirty = self.dirty.take();
            let mut waiting = 0u32;
            for (mark, users) in &self.inputs {
                if dirty.any(*mark) {
                    waiting |= users;
                }
            }
            for node in 0..self.nodes.len() {
                if waiting & (1 << node) == 0 || !self.nodes[node](self) {
                    continue;
                }
                let segment = self.quick_access[node]..self.quick_access[node + 1];
                for pointer in segment {
                    waiting |= 1 << self.pointers[usize::from(pointer)];
                }
            }
        }
    }
}

fn update(value: &Value, computed: &Computed) -> TokenStream {
    let name = &value.name;
    let update = format_ident!("update_{}", name);
    let expression = computed
        .expression
        .with(|read| measured::place(value, read));
    let differs = differs(computed, &quote!(new), &quote!(self.#name));
    quote! {
        fn #update(&mut self) -> bool {
            let new = #expression;
            let differs = #differs;
            if differs {
                self.#name = new;
            }
            differs
        }
    }
}

/// The two vectors.
struct Vectors {
    pointers: Vec<u8>,
    quick_access: Vec<u8>,
}

impl Vectors {
    fn of(plan: &Plan) -> Self {
        let mut vectors = Self {
            pointers: Vec::new(),
            quick_access: vec![0],
        };
        for (value, _) in plan.computed() {
            vectors.pointers.extend(users(plan, value));
            vectors.quick_access.push(vectors.pointers.len() as u8);
        }
        vectors
    }
}

/// Numbers of the nodes that a change of this value makes run.
fn users(plan: &Plan, of: &Value) -> Vec<u8> {
    let nodes = (0u8..).zip(plan.computed());
    nodes
        .filter(|(_, (value, _))| {
            let wakes = plan.wakes(value);
            wakes.iter().any(|waker| waker.name == of.name)
        })
        .map(|(number, _)| number)
        .collect()
}

fn bits(numbers: &[u8]) -> u32 {
    numbers.iter().fold(0, |bits, number| bits | 1 << number)
}
