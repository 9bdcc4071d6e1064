//! Text in the encodings that people have: UTF-8, UTF-16, Latin-1.

use std::borrow::Cow;

use encoding_rs::{Encoding, UTF_8, UTF_16BE, UTF_16LE, WINDOWS_1252};

/// How much of a file shows what it is.
const LOOK_AT: usize = 4096;

/// True for text: hardly any control characters, in one of the encodings.
pub(crate) fn is_text(bytes: &[u8]) -> bool {
    let start = &bytes[..bytes.len().min(LOOK_AT)];
    if wide(start).is_some() {
        return true;
    }
    let is_control = |byte: &&u8| byte.is_ascii_control() && !byte.is_ascii_whitespace();
    let controls = start.iter().filter(is_control).count();
    controls * 50 < start.len() && !start.starts_with(&[0])
}

/// UTF-16 by its mark, or by the zeros of letters and digits.
fn wide(start: &[u8]) -> Option<&'static Encoding> {
    if let Some((encoding, _)) = Encoding::for_bom(start) {
        return (encoding != UTF_8).then_some(encoding);
    }
    let zeros = |from: usize| {
        start
            .iter()
            .skip(from)
            .step_by(2)
            .filter(|byte| **byte == 0)
            .count()
    };
    let (even, odd) = (zeros(0), zeros(1));
    let most = start.len() * 2 / 5;
    match (even > most, odd > most) {
        (true, false) => Some(UTF_16BE),
        (false, true) => Some(UTF_16LE),
        _ => None,
    }
}

/// The text, and which encoding it had, where that is worth a word.
pub(super) fn decoded(bytes: &[u8]) -> (Cow<'_, str>, Option<String>) {
    let start = &bytes[..bytes.len().min(LOOK_AT)];
    let encoding = wide(start).unwrap_or(UTF_8);
    if encoding == UTF_8 {
        let text = bytes.strip_prefix(b"\xef\xbb\xbf").unwrap_or(bytes);
        if let Ok(text) = std::str::from_utf8(text) {
            return (Cow::Borrowed(text), None);
        }
    }
    let encoding = if encoding == UTF_8 {
        WINDOWS_1252
    } else {
        encoding
    };
    let (text, _, _) = encoding.decode(bytes);
    (text, Some(format!("text in {}", encoding.name())))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn text_is_known_in_each_encoding_and_binary_is_none() {
        let wide: Vec<u8> = "t_us,gx\n0,1\n"
            .encode_utf16()
            .flat_map(u16::to_le_bytes)
            .collect();
        let marked = [&[0xff, 0xfe][..], &wide].concat();
        let swapped: Vec<u8> = "t_us,gx\n0,1\n"
            .encode_utf16()
            .flat_map(u16::to_be_bytes)
            .collect();
        for bytes in [&wide, &marked, &swapped] {
            assert!(is_text(bytes));
            assert_eq!(decoded(bytes).0, "t_us,gx\n0,1\n");
        }
        let latin = b"t [\xb5s],gx\n";
        assert!(is_text(latin));
        assert_eq!(decoded(latin).0, "t [µs],gx\n");
        assert!(!is_text(&[0; 100]) && !is_text(&[7, 1, 2, 3, 200, 4]));
    }
}
