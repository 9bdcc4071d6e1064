//! The source file of a control logic, and the same with its graph run another way.

use std::env;
use std::fs;
use std::path::Path;

use proc_macro2::{Group, Ident, TokenStream, TokenTree};
use quote::{ToTokens, format_ident, quote};
use reflex_dataflow_language::{Graph, Plan};
use syn::{File, Item, UseTree};

use crate::{callbacks, pointer_vector, straight_line};

/// A page of `src/graph/`.
pub struct Page {
    name: Ident,
    /// Where it lies, for the compiler to watch.
    path: String,
    file: File,
    graph: Graph,
}

impl Page {
    /// Reads the page of a control logic.
    pub fn read(name: &Ident) -> Result<Self, String> {
        let root = env::var("CARGO_MANIFEST_DIR").map_err(|error| error.to_string())?;
        let path = Path::new(&root).join(format!("../src/graph/{name}.rs"));
        let path = path.display().to_string();
        let wrong = |error: String| format!("{path}: {error}");
        let text = fs::read_to_string(&path).map_err(|error| wrong(error.to_string()))?;
        let file = syn::parse_file(&text).map_err(|error| wrong(error.to_string()))?;
        let declared = file.items.iter().find_map(declaration);
        let declared = declared.ok_or_else(|| wrong("declares no graph".to_owned()))?;
        let graph = Graph::parse(declared).map_err(|error| wrong(error.to_string()))?;
        Ok(Self {
            name: name.clone(),
            path,
            file,
            graph,
        })
    }

    /// The module of the page's name, with a module for each other way.
    pub fn in_every_way(&self) -> Result<TokenStream, String> {
        let plan = Plan::of(&self.graph).map_err(|error| format!("{}: {error}", self.path))?;
        let (name, path, own) = (&self.name, &self.path, &self.graph.name);
        let ways = [
            ("straight_line", straight_line::graph(&plan)),
            ("callbacks", callbacks::graph(&plan)),
            ("pointer_vector", pointer_vector::graph(&plan)),
        ];
        let ways = ways.map(|(way, graph)| self.module(way, &graph, &plan));
        let of_page = self.way(&plan, &quote!(reflex::graph::#own));
        let doc = format!("`src/graph/{name}.rs` in every way.");
        Ok(quote! {
            #[doc = #doc]
            pub mod #name {
                // A changed page is a reason to compile this again.
                const _: &[u8] = include_bytes!(#path);
                #of_page
                #(#ways)*
            }
        })
    }

    fn module(&self, name: &str, graph: &TokenStream, plan: &Plan) -> TokenStream {
        let items = self.file.items.iter().filter(|item| is_kept(item));
        let items = items.map(|item| outside_the_library(item.to_token_stream()));
        let (module, own) = (format_ident!("{name}"), &self.graph.name);
        let way = self.way(plan, &quote!(#own));
        let doc = format!("As `{name}`.");
        let graph = outside_the_library(graph.clone());
        quote! {
            #[doc = #doc]
            #[allow(dead_code, missing_docs, unused_imports)]
            pub mod #module {
                #(#items)*
                #graph
                #way
            }
        }
    }

    /// How the graph begins, and takes a step: each input by its name.
    fn way(&self, plan: &Plan, of_type: &TokenStream) -> TokenStream {
        let page = &self.name;
        let inputs = plan.inputs().map(|value| {
            let (name, setter) = (&value.name, format_ident!("set_{}", value.name));
            quote! {
                if let Some(value) = step.#name {
                    self.#setter(value);
                }
            }
        });
        quote! {
            impl crate::ways::Way for #of_type {
                fn configured() -> Self {
                    Self::new(reflex::config::#page::GAINS, reflex::airframe::Mixer::default())
                }

                fn take(&mut self, step: &crate::step::Step) -> reflex::airframe::MotorShares {
                    #(#inputs)*
                    let _ = self.propagate();
                    self.command().shares
                }
            }
        }
    }
}

/// What stands within `graph! { ... }`.
fn declaration(item: &Item) -> Option<TokenStream> {
    let Item::Macro(item) = item else {
        return None;
    };
    let is_graph = item.mac.path.is_ident("graph");
    is_graph.then(|| item.mac.tokens.clone())
}

/// All but the graph itself, its tests, and what connects it with the autopilot.
fn is_kept(item: &Item) -> bool {
    match item {
        Item::Mod(_) | Item::Macro(_) => false,
        Item::Impl(item) => item.trait_.is_none(),
        Item::Use(item) => !matches!(&item.tree, UseTree::Path(path) if path.ident == "super"),
        _ => true,
    }
}

/// The same with `crate` as another crate calls it.
fn outside_the_library(tokens: TokenStream) -> TokenStream {
    let token = |token| match token {
        TokenTree::Ident(word) if word == "crate" => TokenTree::Ident(format_ident!("reflex")),
        TokenTree::Group(group) => {
            let inside = outside_the_library(group.stream());
            TokenTree::Group(Group::new(group.delimiter(), inside))
        }
        other => other,
    };
    tokens.into_iter().map(token).collect()
}
