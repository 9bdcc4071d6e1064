//! The graph as data, for pictures and tables: nothing where nobody asks.

use proc_macro2::TokenStream;
use quote::{ToTokens, quote};
use syn::{Attribute, Expr, ExprLit, Lit, Meta};

use reflex_dataflow_language::code::mark;
use reflex_dataflow_language::{Computed, Kind, Plan, Value};

use crate::constants;

/// The constant `DESCRIPTION` of the graph's type.
pub fn of_type(plan: &Plan) -> TokenStream {
    let name = plan.graph.name.to_string();
    let doc = first_line(&plan.graph.attributes);
    let inputs = plan.inputs().filter_map(|value| {
        let input = value.input()?;
        let (gates, triggers) = (constants::gates(input), input.triggers);
        let source = quote!(Input { gates: #gates, triggers: #triggers });
        Some(described(plan, value, &source))
    });
    let computed = plan
        .computed()
        .map(|(value, computed)| described(plan, value, &of_computed(plan, computed)));
    let values = inputs.chain(computed);
    quote! {
        /// The graph as data: inputs first, then each value behind all that it reads.
        pub const DESCRIPTION: ::reflex::dataflow::Description =
            ::reflex::dataflow::Description {
                name: #name,
                doc: #doc,
                hyperperiod: Self::HYPERPERIOD,
                values: &[#(#values),*],
            };
    }
}

fn described(plan: &Plan, value: &Value, source: &TokenStream) -> TokenStream {
    let name = value.name.to_string();
    let doc = first_line(&value.docs);
    let of_type = source_text(&value.of_type);
    let (mark, rate) = (mark(&value.name), constants::rate(plan, value));
    quote! {
        ::reflex::dataflow::Described {
            name: #name,
            doc: #doc,
            mark: Self::#mark,
            of_type: #of_type,
            most_updates: #rate,
            source: ::reflex::dataflow::Source::#source,
        }
    }
}

fn of_computed(plan: &Plan, computed: &Computed) -> TokenStream {
    let kind = match &computed.kind {
        Kind::State { clock } => {
            let clock = clock.to_string();
            quote!(State { clock: #clock })
        }
        Kind::Node => quote!(Node),
        Kind::Output => quote!(Output),
    };
    let function = source_text(&computed.expression.function());
    let reads = computed
        .reads()
        .filter(|it| !plan.value(&it.name).is_param());
    let reads = reads.map(|read| {
        let (name, last) = (read.name.to_string(), read.last);
        quote!(::reflex::dataflow::Read { name: #name, last: #last })
    });
    let quantum = match &computed.quantum {
        Some(quantum) => quote!(Some(#quantum)),
        None => quote!(None),
    };
    quote! {
        Computed {
            kind: ::reflex::dataflow::Kind::#kind,
            function: #function,
            reads: &[#(#reads),*],
            quantum: #quantum,
        }
    }
}

/// Tokens as somebody would write them.
fn source_text(tokens: &impl ToTokens) -> String {
    let text = tokens.to_token_stream().to_string();
    [" < ", "< ", " <", " > ", " >", " :: ", " , "]
        .into_iter()
        .zip(["<", "<", "<", ">", ">", "::", ", "])
        .fold(text, |text, (from, to)| text.replace(from, to))
}

/// The first line of a documentation.
fn first_line(attributes: &[Attribute]) -> String {
    let line = attributes.iter().find_map(|attribute| {
        let Meta::NameValue(pair) = &attribute.meta else {
            return None;
        };
        match &pair.value {
            Expr::Lit(ExprLit {
                lit: Lit::Str(line),
                ..
            }) if pair.path.is_ident("doc") => Some(line.value().trim().to_owned()),
            _ => None,
        }
    });
    line.unwrap_or_default()
}
