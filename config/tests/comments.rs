//! The comments of the TOML files say what the declarations say.

use std::fs;
use std::path::Path;

use reflex_settings::gains::LOGICS;
use reflex_settings::{BOARD, Declared, INPUT, Kind, REACTIVE, SAFETY, Setting, Settings};

/// The comment of a key: the lines above it and what follows its value, as one line. Words that may
/// be chosen for several keys stand once, at the head of their section.
fn comment(text: &str, setting: &Setting) -> String {
    let section = format!("[{}]", setting.section);
    let body = text.split(&format!("\n{section}")).nth(1).expect(&section);
    let body = body.split("\n[").next().unwrap();
    let head = body.trim_start().split("\n\n").next().unwrap_or_default();
    let is_head = head.lines().all(|line| line.starts_with('#'));
    let head = if is_head {
        head.replace('#', "")
    } else {
        String::new()
    };
    let mut above = String::new();
    for line in body.lines() {
        if let Some(words) = line.strip_prefix('#') {
            above += words;
        } else if line.starts_with(&format!("{} =", setting.key)) {
            let (_, behind) = line.split_once('#').unwrap_or_default();
            return head + &above + behind;
        } else {
            above.clear();
        }
    }
    panic!("{} is not in {section}", setting.key);
}

fn file(name: &str) -> String {
    fs::read_to_string(Path::new(env!("CARGO_MANIFEST_DIR")).join(name)).unwrap()
}

/// What a comment must contain.
fn words(setting: &'static Setting) -> Vec<String> {
    let default = setting.default;
    match setting.kind {
        Kind::Word(choices) => {
            let words = choices.variants.iter().map(|[_, word]| format!("{word:?}"));
            words.chain([format!("efault {default:?}")]).collect()
        }
        Kind::WordOrSpan(words, _) => {
            let [word, ..] = words else { panic!("no word") };
            vec![format!("{word:?}"), format!("default {default:?}")]
        }
        Kind::Step { steps, .. } => vec![format!("{steps}, default {default}")],
        _ => {
            let range = setting.range().to_string();
            let range = range.strip_suffix(setting.unit).unwrap_or(&range);
            vec![format!("{}, default {default}", range.trim_end())]
        }
    }
}

fn check(file_name: &str, settings: impl Iterator<Item = &'static Setting>) {
    let text = file(file_name);
    for setting in settings.filter(|setting| setting.kind != Kind::Inputs) {
        let comment = comment(&text, setting);
        for words in words(setting) {
            let path = setting.path();
            assert!(
                comment.contains(&words),
                "{file_name}: {path}: {comment:?} does not say {words:?}"
            );
        }
    }
}

#[test]
fn every_comment_of_reactive_toml_says_range_and_default() {
    let chosen = Settings::SETTINGS
        .iter()
        .filter(|setting| !setting.of_board);
    check("reactive.toml", chosen.chain(REACTIVE));
}

#[test]
fn every_comment_of_the_board_says_range_and_default() {
    let chosen = Settings::SETTINGS.iter().filter(|setting| setting.of_board);
    check("boards/reflex_f427.toml", chosen.chain(BOARD));
}

#[test]
fn every_comment_of_safety_toml_says_range_and_default() {
    check("safety.toml", SAFETY.iter());
}

#[test]
fn the_comment_of_the_inputs_says_what_each_has() {
    let text = file("reactive.toml");
    for setting in INPUT {
        assert!(
            text.contains(&format!("`{}`", setting.key)),
            "{}",
            setting.key
        );
        if let Some(range) = setting.kind.range() {
            assert!(text.contains(&range.to_string()), "{range}");
        }
    }
}

/// The value behind "default" in a comment, as it is written.
fn default_of(comment: &str) -> &str {
    let (_, behind) = comment.split_once("default ").unwrap_or_default();
    let end = match behind.strip_prefix('[') {
        Some(list) => list.find(']').map(|end| end + 2),
        None => behind.find([':', ',', ' ', ';']),
    };
    behind[..end.unwrap_or(behind.len())].trim_end_matches('.')
}

#[test]
fn every_comment_of_a_logic_says_range_and_default() {
    for logic in LOGICS {
        let name = format!("logics/{}.toml", logic.logic);
        let text = file(&name);
        for gain in logic.gains {
            let (comment, path) = (comment(&text, gain), gain.path());
            let range = gain.kind.range().unwrap().to_string();
            let says = format!("{range}, default ");
            assert!(
                comment.contains(&says),
                "{name}: {path}: {comment:?} does not say {says:?}"
            );
            let written = gain.parse(default_of(&comment));
            assert_eq!(
                written,
                gain.parse(gain.default),
                "{name}: {path}: {comment:?}"
            );
        }
    }
}
