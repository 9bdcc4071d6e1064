//! Edits that spoil a sound input: of bytes, of numbers in it, and of words.
//!
//! Most leave the rest as it was, so that what comes behind the spoilt place is still read.

use std::ops::RangeInclusive;

use arbitrary::{Result, Unstructured};

use super::samples::Sample;

/// Most edits of one input; most inputs have few.
const MOST_EDITS: usize = 8;
/// Longest piece that is moved, removed or put in.
const LONGEST: usize = 300;

/// Numbers and words that readers trip over.
const WORDS: [&str; 36] = [
    "0",
    "-0",
    "-1",
    "1",
    "nan",
    "NaN",
    "inf",
    "-inf",
    "1e999",
    "-1e-999",
    "1e-45",
    "3.4e38",
    "0x10",
    "1_000",
    "255",
    "256",
    "65536",
    "4294967296",
    "9223372036854775808",
    "18446744073709551616",
    "",
    " ",
    "\t",
    "\n",
    "\r\n",
    ",",
    ",,",
    "\"",
    "'",
    "[",
    "]",
    "{",
    "}",
    "=",
    "\u{feff}",
    "\u{1F681}",
];

/// Numbers at the ends of their kinds, little-endian.
const ENDS: [&[u8]; 12] = [
    &[0x00],
    &[0xFF],
    &[0x7F],
    &[0x80],
    &[0xFF, 0xFF],
    &[0x00, 0x80],
    &[0xFF, 0xFF, 0xFF, 0xFF],
    &[0x00, 0x00, 0x00, 0x80],
    &[0x00, 0x00, 0xC0, 0x7F],
    &[0x00, 0x00, 0x80, 0x7F],
    &[0xFF, 0xFF, 0x7F, 0x7F],
    &[0xFF; 8],
];

/// One of the samples, spoilt.
pub(super) fn spoilt(samples: &[Sample], from: &mut Unstructured<'_>) -> Result<Vec<u8>> {
    let sample = from.choose(samples)?;
    let (kept, content) = sample.bytes.split_at(sample.kept);
    let mut content = content.to_vec();
    // The smaller of two: few edits more often than many.
    let [one, other] = [
        from.int_in_range(1..=MOST_EDITS)?,
        from.int_in_range(1..=MOST_EDITS)?,
    ];
    for _ in 0..one.min(other) {
        edit(&mut content, samples, from)?;
    }
    Ok([kept, &content].concat())
}

fn edit(bytes: &mut Vec<u8>, samples: &[Sample], from: &mut Unstructured<'_>) -> Result<()> {
    let at = place(bytes, from)?;
    let end = at + from.int_in_range(0..=LONGEST.min(bytes.len() - at))?;
    match from.int_in_range(0..=8)? {
        0 => overwrite(bytes, at, &[from.arbitrary()?]),
        1 => overwrite(bytes, at, from.choose(&ENDS)?),
        2 => {
            let bit = 1 << from.int_in_range(0..=7)?;
            bytes[at..].iter_mut().take(1).for_each(|byte| *byte ^= bit);
        }
        3 => {
            bytes.drain(at..end);
        }
        4 => {
            let piece = bytes[at..end].to_vec();
            let to = place(bytes, from)?;
            bytes.splice(to..to, piece);
        }
        5 => {
            let word = from.choose(&WORDS)?;
            let place = word_at(bytes, at);
            bytes.splice(place, word.bytes());
        }
        6 => {
            // A word of this or another sample, in place of one here.
            let other = &from.choose(samples)?.bytes;
            let word = other[word_at(other, place(other, from)?)].to_vec();
            let place = word_at(bytes, at);
            bytes.splice(place, word);
        }
        7 => {
            let noise = some(from, 1..=16)?.to_vec();
            bytes.splice(at..at, noise);
        }
        _ => bytes.truncate(at),
    }
    Ok(())
}

/// A few random bytes.
pub(super) fn some<'b>(
    from: &mut Unstructured<'b>,
    count: RangeInclusive<usize>,
) -> Result<&'b [u8]> {
    let count = from.int_in_range(count)?;
    from.bytes(count)
}

/// A place in the bytes: half of them near the front, where heads and formats are.
fn place(bytes: &[u8], from: &mut Unstructured<'_>) -> Result<usize> {
    let near = from.ratio(1, 4)?;
    from.int_in_range(
        0..=if near {
            bytes.len().min(200)
        } else {
            bytes.len()
        },
    )
}

fn overwrite(bytes: &mut [u8], at: usize, with: &[u8]) {
    for (byte, new) in bytes[at..].iter_mut().zip(with) {
        *byte = *new;
    }
}

/// The word or number around a place.
fn word_at(bytes: &[u8], at: usize) -> std::ops::Range<usize> {
    let belongs = |byte: &u8| byte.is_ascii_alphanumeric() || b"._-+".contains(byte);
    let start = bytes[..at]
        .iter()
        .rposition(|byte| !belongs(byte))
        .map_or(0, |before| before + 1);
    let length = bytes[at..].iter().position(|byte| !belongs(byte));
    // In bytes that are no text a word may be long.
    start.max(at.saturating_sub(LONGEST))
        ..length
            .map_or(bytes.len(), |length| at + length)
            .min(at + LONGEST)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_word_ends_where_something_else_begins() {
        let text = b"rate = -0.5e3, [a_b]";
        for at in 7..=13 {
            assert_eq!(&text[word_at(text, at)], b"-0.5e3", "{at}");
        }
        assert_eq!(word_at(text, 5), 5..5);
        assert_eq!(word_at(b"", 0), 0..0);
    }

    #[test]
    fn any_numbers_spoil_any_sample_and_leave_what_is_kept() {
        let samples = [Sample::named("name", b"a = 1\n"), Sample::new(Vec::new())];
        let mut differ = 0;
        for seed in 0..=255_u8 {
            let numbers: Vec<u8> = (0..600_u32)
                .map(|at| (at as u8).wrapping_mul(seed) ^ seed)
                .collect();
            let spoilt = spoilt(&samples, &mut Unstructured::new(&numbers)).unwrap();
            differ += usize::from(spoilt != samples[0].bytes);
            assert!(spoilt.starts_with(b"name\n") || samples[1].bytes.is_empty());
        }
        assert!(differ > 100, "{differ}");
    }
}
