//! A parsed source file, and everything that its code names.

use std::collections::BTreeSet;

use anyhow::{Context, Result};
use proc_macro2::{Delimiter, TokenStream, TokenTree};
use quote::ToTokens;
use syn::{File, Item, ItemMod};

/// A source file.
pub(super) struct Source {
    /// Path from the workspace's folder, with slashes.
    pub(super) name: String,
    pub(super) text: String,
    pub(super) file: File,
    /// What the file names, in and outside of macros; not in comments and strings.
    pub(super) mentions: Vec<Mention>,
}

/// A place where code names something.
#[derive(Clone, Debug, PartialEq, Eq)]
pub(super) struct Mention {
    /// A path (`crate::app::Call`), or a word alone. An entry of a `use` with braces is a path too.
    pub(super) path: Vec<String>,
    /// Names of the modules within the file that it stands in.
    pub(super) inside: Vec<String>,
    /// Line in the file, from 1.
    pub(super) line: usize,
    /// The code is there for tests only.
    pub(super) is_test: bool,
    /// The path is the divisor of `1.0 /`.
    pub(super) is_inverted: bool,
}

impl Source {
    /// Parses a file.
    ///
    /// # Errors
    /// It is no Rust.
    pub(super) fn parse(name: &str, text: String) -> Result<Self> {
        let file = syn::parse_file(&text).with_context(|| name.to_owned())?;
        let mut reader = Reader::default();
        for attribute in &file.attrs {
            reader.read(attribute.to_token_stream(), &[]);
        }
        reader.items(&file.items, false);
        Ok(Self {
            name: name.to_owned(),
            text,
            file,
            mentions: reader.mentions,
        })
    }
}

/// Whether an item is compiled for tests only: by one of the attributes that it begins with.
pub(super) fn is_for_tests(item: &Item) -> bool {
    let tokens: Vec<TokenTree> = item.to_token_stream().into_iter().collect();
    let attributes = tokens.chunks_exact(2).take_while(|pair| is(pair, '#'));
    attributes
        .map(|pair| pair[1].to_string())
        .any(|attribute| attribute == "[cfg (test)]" || attribute == "[cfg(test)]")
}

/// Gathers mentions from tokens.
#[derive(Default)]
struct Reader {
    mentions: Vec<Mention>,
    inside: Vec<String>,
    is_test: bool,
}

impl Reader {
    fn items(&mut self, items: &[Item], is_test: bool) {
        for item in items {
            let is_test = is_test || is_for_tests(item);
            match item {
                Item::Mod(ItemMod {
                    attrs,
                    ident,
                    content: Some((_, items)),
                    ..
                }) => {
                    for attribute in attrs {
                        self.read(attribute.to_token_stream(), &[]);
                    }
                    self.inside.push(ident.to_string());
                    self.items(items, is_test);
                    self.inside.pop();
                }
                _ => {
                    self.is_test = is_test;
                    self.read(item.to_token_stream(), &[]);
                }
            }
        }
    }

    /// Reads tokens; within the braces of a `use`, paths go on from `prefix`.
    fn read(&mut self, tokens: TokenStream, prefix: &[String]) {
        let tokens: Vec<TokenTree> = tokens.into_iter().collect();
        let mut rest = tokens.as_slice();
        let mut is_inverted = false;
        while let [token, after @ ..] = rest {
            rest = after;
            match token {
                TokenTree::Group(group) => self.read(group.stream(), &[]),
                TokenTree::Ident(word) if *word == "as" => rest = after.get(1..).unwrap_or(&[]),
                TokenTree::Ident(_) => rest = self.path(token, after, prefix, is_inverted),
                TokenTree::Literal(literal) => {
                    is_inverted = literal.to_string() == "1.0" && is(after, '/');
                }
                TokenTree::Punct(punct) => is_inverted &= !matches!(punct.as_char(), ',' | ';'),
            }
        }
    }

    /// Reads a path from its first word on; the tokens behind it.
    fn path<'t>(
        &mut self,
        first: &TokenTree,
        mut rest: &'t [TokenTree],
        prefix: &[String],
        is_inverted: bool,
    ) -> &'t [TokenTree] {
        let line = first.span().start().line;
        let mut path = prefix.to_vec();
        path.push(first.to_string());
        while is(rest, ':') && is(&rest[1..], ':') {
            match rest.get(2) {
                Some(TokenTree::Ident(word)) => path.push(word.to_string()),
                Some(TokenTree::Group(group)) if group.delimiter() == Delimiter::Brace => {
                    self.read(group.stream(), &path);
                    return &rest[3..];
                }
                _ => break,
            }
            rest = &rest[3..];
        }
        // In braces, `self` is what stands before them.
        if path.len() > 1 && path.last().is_some_and(|word| word == "self") {
            path.pop();
        }
        self.mentions.push(Mention {
            path,
            inside: self.inside.clone(),
            line,
            is_test: self.is_test,
            is_inverted,
        });
        rest
    }
}

/// Whether tokens begin with a sign.
fn is(tokens: &[TokenTree], sign: char) -> bool {
    matches!(tokens.first(), Some(TokenTree::Punct(punct)) if punct.as_char() == sign)
}

/// The names of the items that a list of items declares.
pub(super) fn declared(items: &[Item]) -> BTreeSet<String> {
    let name = |item: &Item| match item {
        Item::Const(item) => Some(item.ident.to_string()),
        Item::Enum(item) => Some(item.ident.to_string()),
        Item::Fn(item) => Some(item.sig.ident.to_string()),
        Item::Macro(item) => item.ident.as_ref().map(ToString::to_string),
        Item::Static(item) => Some(item.ident.to_string()),
        Item::Struct(item) => Some(item.ident.to_string()),
        Item::Trait(item) => Some(item.ident.to_string()),
        Item::Type(item) => Some(item.ident.to_string()),
        Item::Union(item) => Some(item.ident.to_string()),
        _ => None,
    };
    items.iter().filter_map(name).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    fn paths(code: &str) -> Vec<String> {
        let source = Source::parse("src/a.rs", code.to_owned()).expect("Rust");
        let mentions = source.mentions.iter();
        mentions.map(|mention| mention.path.join("::")).collect()
    }

    #[test]
    fn comments_and_strings_name_nothing() {
        let said = paths("//! risky\nconst A: char = '\"'; // risky\nconst B: &str = \"risky\";");
        assert!(said.iter().all(|path| !path.contains("risky")), "{said:?}");
    }

    #[test]
    fn paths_are_whole_in_braces_and_in_macros() {
        let said = paths("use a::{b::{self, C}, d as e};\nfn f() { say!(g::h(\"x\")) }");
        for path in ["a::b", "a::b::C", "a::d", "g::h"] {
            assert!(said.iter().any(|known| known == path), "{path}: {said:?}");
        }
        assert!(!said.iter().any(|known| known == "e"), "{said:?}");
    }

    #[test]
    fn code_for_tests_is_known_as_such() {
        let code = "fn a() { b() }\n#[cfg(test)]\nmod tests { fn c() { d() } }";
        let source = Source::parse("src/a.rs", code.to_owned()).expect("Rust");
        let of = |word: &str| {
            let found = source
                .mentions
                .iter()
                .find(|mention| mention.path == [word]);
            found.map(|mention| (mention.is_test, mention.line))
        };
        assert_eq!((of("b"), of("d")), (Some((false, 1)), Some((true, 3))));
    }

    #[test]
    fn a_divisor_of_one_is_known_as_such() {
        let source = Source::parse(
            "src/a.rs",
            "const A: f32 = 1.0 / b::C; const D: f32 = E;".into(),
        );
        let source = source.expect("Rust");
        let inverted = source.mentions.iter().filter(|mention| mention.is_inverted);
        assert_eq!(
            inverted
                .map(|mention| mention.path.join("::"))
                .collect::<Vec<_>>(),
            ["b::C"]
        );
    }
}
