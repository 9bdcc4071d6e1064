//! Marks, hyperperiod, and what the compiler checks of constant expressions.

use proc_macro2::{Span, TokenStream};
use quote::{quote, quote_spanned};
use syn::spanned::Spanned;

use reflex_dataflow_language::code::mark;
use reflex_dataflow_language::{Gates, Input, Plan, Rate, Value};

/// Constants of the graph's type.
pub fn of_type(plan: &Plan) -> TokenStream {
    let marks = (0u32..).zip(plan.marked()).map(|(number, value)| {
        let mark = mark(&value.name);
        let doc = format!("The mark of `{}`.", value.name);
        quote! {
            #[doc = #doc]
            pub const #mark: ::reflex::dataflow::Dirty = ::reflex::dataflow::Dirty::bit(#number);
        }
    });
    let inputs = plan.inputs().map(|value| mark(&value.name));
    let hyperperiod = hyperperiod(&gating(plan));
    let stored = plan.graph.values.iter().map(|value| &value.of_type);
    quote! {
        #(#marks)*

        /// The marks of all inputs.
        const INPUTS: ::reflex::dataflow::Dirty =
            ::reflex::dataflow::Dirty::CLEAN #(.or(Self::#inputs))*;

        /// Time (us) after which the inputs that gate have all come; zero where none gates.
        pub const HYPERPERIOD: u64 = #hyperperiod;

        /// Bytes of the stored values, one by one.
        pub const STORED_BYTES: usize = 0 #(+ ::core::mem::size_of::<#stored>())*;
    }
}

/// Assertions that stop the build at the line at fault.
pub fn assertions(plan: &Plan) -> TokenStream {
    let periods = plan
        .inputs()
        .filter_map(|value| Some((value, value.input()?)));
    let periods = periods.map(|(value, input)| {
        let period = period(input);
        let message = format!("the period of `{}` must be 1 us or more", value.name);
        quote_spanned! { span(input) =>
            #[allow(clippy::assertions_on_constants)]
            const _: () = ::core::assert!(#period > 0, #message);
        }
    });
    let gating = gating(plan);
    let bounds = (1..=gating.len()).map(|length| {
        let until = &gating[..length];
        let names: Vec<String> = until.iter().map(|it| format!("`{}`", it.0.name)).collect();
        let message = format!(
            "the hyperperiod of {} is longer than 20 ms: choose rates with a shorter common period",
            names.join(", ")
        );
        let hyperperiod = hyperperiod(until);
        quote_spanned! { span(gating[length - 1].1) =>
            #[allow(clippy::assertions_on_constants)]
            const _: () =
                ::core::assert!(#hyperperiod <= ::reflex::dataflow::LONGEST_HYPERPERIOD, #message);
        }
    });
    let quanta = plan.computed().filter_map(|(value, computed)| {
        let quantum = computed.quantum.as_ref()?;
        let message = format!("the quantum of `{}` must be zero or more", value.name);
        Some(quote_spanned! { quantum.span() =>
            #[allow(clippy::assertions_on_constants)]
            const _: () = ::core::assert!(#quantum >= 0.0, #message);
        })
    });
    quote!(#(#periods)* #(#bounds)* #(#quanta)*)
}

/// A period in microseconds, as a constant expression.
pub fn period(input: &Input) -> TokenStream {
    match &input.rate {
        Rate::Hertz { number, .. } => {
            let micros = (1e6 / number).round() as u64;
            quote!(#micros)
        }
        Rate::Every(period) => quote!((#period).ticks()),
    }
}

/// Whether an input gates, as a constant expression.
pub fn gates(input: &Input) -> TokenStream {
    match &input.gates {
        Gates::Never => quote!(false),
        Gates::Always => quote!(true),
        Gates::If(condition) => quote!(#condition),
    }
}

/// The largest rate at which a value is updated, in mHz, as a constant expression.
pub fn rate(plan: &Plan, value: &Value) -> TokenStream {
    let behind = plan.inputs_behind(value).into_iter();
    let periods = behind
        .filter_map(|place| plan.graph.values[place].input())
        .map(period);
    let hyperperiod = hyperperiod(&gating(plan));
    quote!(::reflex::dataflow::most_updates(&[#(#periods),*], #hyperperiod))
}

type Gating<'a> = (&'a Value, &'a Input);

/// The inputs that may gate.
fn gating<'a>(plan: &Plan<'a>) -> Vec<Gating<'a>> {
    plan.inputs()
        .filter_map(|value| Some((value, value.input()?)))
        .filter(|(_, input)| !matches!(input.gates, Gates::Never))
        .collect()
}

/// The least common period of these inputs in microseconds, as a constant expression.
fn hyperperiod(gating: &[Gating]) -> TokenStream {
    gating.iter().fold(quote!(0), |until, (_, input)| {
        let (period, gates) = (period(input), gates(input));
        quote!(::reflex::dataflow::joint_period(#until, #period, #gates))
    })
}

fn span(input: &Input) -> Span {
    match &input.rate {
        Rate::Hertz { literal, .. } => literal.span(),
        Rate::Every(period) => period.span(),
    }
}
