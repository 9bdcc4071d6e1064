//! A line of Rust source without what is not code.

/// The code of a line: comments are cut off, the content of strings is left out.
///
/// Lines are looked at one by one; a string that spans several counts as code from its second
/// line on.
pub(super) fn code_of(line: &str) -> String {
    let mut code = String::new();
    let mut rest = line;
    while let Some(at) = rest.find(['"', '/', '\'']) {
        let (before, found) = rest.split_at(at);
        code.push_str(before);
        if found.starts_with("//") {
            return code;
        }
        let length = if found.starts_with('"') {
            code.push_str("\"\"");
            string_length(found)
        } else if found.starts_with("'\"'") {
            3
        } else {
            code.push_str(&found[..1]);
            1
        };
        rest = &found[length..];
    }
    code + rest
}

/// Length in bytes of the string literal at the start of a text, quotes included.
fn string_length(text: &str) -> usize {
    let mut escaped = false;
    for (at, character) in text.char_indices().skip(1) {
        match character {
            _ if escaped => escaped = false,
            '\\' => escaped = true,
            '"' => return at + 1,
            _ => {}
        }
    }
    text.len()
}

/// The identifiers and numbers in a piece of code.
pub(super) fn words_of(code: &str) -> impl Iterator<Item = &str> {
    code.split(|character: char| !character.is_alphanumeric() && character != '_')
        .filter(|word| !word.is_empty())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn comments_and_strings_are_no_code() {
        assert_eq!(code_of("let a = b / c; // risky"), "let a = b / c; ");
        assert_eq!(code_of("//! all of it"), "");
        assert_eq!(code_of(r#"say("ri\"sky // {}", a)"#), r#"say("", a)"#);
        assert_eq!(code_of(r#"if c == '"' { risky }"#), "if c ==  { risky }");
        assert_eq!(code_of(r#"let text = "begins"#), r#"let text = """#);
        assert_eq!(code_of("&'static str"), "&'static str");
    }

    #[test]
    fn words_are_whole() {
        let words: Vec<_> = words_of("vertical::rtic_time(unsafe_code)").collect();
        assert_eq!(words, ["vertical", "rtic_time", "unsafe_code"]);
    }
}
