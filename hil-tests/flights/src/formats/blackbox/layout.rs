//! How the fields of a Blackbox frame are written, and read back.

/// How a field's difference is written.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) enum Encoding {
    /// Seven bits a byte, the sign in the lowest.
    Signed,
    /// Seven bits a byte.
    Unsigned,
    /// The negative of fourteen bits.
    Negative14,
    /// Up to eight fields, with a bit for each that is not zero.
    Octet,
    /// Three fields of 2, 4, 6 or up to 32 bits.
    Triple,
    /// Four fields of 0, 4, 8 or 16 bits.
    Quartet,
    /// Nothing: it is as predicted.
    Null,
    /// Three fields of 2, about 5, about 7 or up to 32 bits.
    VariableTriple,
}

impl Encoding {
    /// By its number in the header.
    pub(super) fn of(code: &str) -> Option<Self> {
        Some(match code {
            "0" => Self::Signed,
            "1" => Self::Unsigned,
            "3" => Self::Negative14,
            "6" => Self::Octet,
            "7" => Self::Triple,
            "8" => Self::Quartet,
            "9" => Self::Null,
            "10" => Self::VariableTriple,
            _ => return None,
        })
    }
}

/// What the difference is added to.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) enum Predictor {
    Constant(i64),
    /// The value before.
    Previous,
    /// As far beyond the value before as that was beyond its own.
    StraightLine,
    /// The mean of both values before.
    Average,
    /// Another field of the same frame.
    Field(usize),
    /// The value before, and the loops since.
    Increment,
}

/// One field of a frame.
#[derive(Clone, Debug)]
pub(super) struct Field {
    pub(super) name: String,
    pub(super) is_signed: bool,
    pub(super) encoding: Encoding,
    pub(super) predictor: Predictor,
}

/// The fields of a kind of frames, in order.
#[derive(Clone, Debug, Default)]
pub(super) struct Layout {
    pub(super) fields: Vec<Field>,
}

/// What predictors know: both frames before, and how many loops were left out since.
pub(super) struct Before<'a> {
    pub(super) last: Option<[&'a [i64]; 2]>,
    pub(super) left_out: i64,
}

impl Layout {
    /// Reads the fields of a frame; `None` where the bytes end before it does.
    pub(super) fn read(&self, bytes: &mut Bytes, before: &Before) -> Option<Vec<i64>> {
        let mut values = Vec::with_capacity(self.fields.len());
        while let Some(field) = self.fields.get(values.len()) {
            if field.predictor == Predictor::Increment {
                values.push(self.predicted(&values, 0, before));
                continue;
            }
            let differences = self.group(values.len(), field.encoding, bytes)?;
            for difference in differences.into_iter().flatten() {
                if values.len() < self.fields.len() {
                    values.push(self.predicted(&values, difference, before));
                }
            }
        }
        Some(values)
    }

    /// The differences that are written together from a field on.
    fn group(&self, at: usize, encoding: Encoding, bytes: &mut Bytes) -> Option<[Option<i64>; 8]> {
        let mut group = [None; 8];
        match encoding {
            Encoding::Signed => group[0] = Some(bytes.signed()?),
            Encoding::Unsigned => group[0] = Some(bytes.unsigned()?.into()),
            Encoding::Negative14 => {
                group[0] = Some(-extended(bytes.unsigned()?.into(), 14));
            }
            Encoding::Null => group[0] = Some(0),
            Encoding::Octet => {
                let same = |field: &&Field| field.encoding == Encoding::Octet;
                let fields = self.fields.get(at..).unwrap_or_default();
                let count = fields.iter().take(8).take_while(same).count();
                let present = if count == 1 { 1 } else { bytes.byte()? };
                for (i, slot) in group.iter_mut().enumerate().take(count) {
                    let is_present = present >> i & 1 != 0;
                    *slot = Some(if is_present { bytes.signed()? } else { 0 });
                }
            }
            Encoding::Triple => put(&mut group, triple(bytes)?),
            Encoding::VariableTriple => put(&mut group, variable_triple(bytes)?),
            Encoding::Quartet => put(&mut group, quartet(bytes)?),
        }
        Some(group)
    }

    /// The next field's value, those before it known.
    fn predicted(&self, values: &[i64], difference: i64, before: &Before) -> i64 {
        let at = values.len();
        let field = &self.fields[at];
        let last = before.last.map(|frames| frames.map(|frame| frame[at]));
        let base = match (field.predictor, last) {
            (Predictor::Constant(constant), _) => constant,
            (Predictor::Field(other), _) => values.get(other).copied().unwrap_or_default(),
            (Predictor::Increment, Some([last, _])) => last + before.left_out + 1,
            (Predictor::Previous, Some([last, _])) => last,
            (Predictor::StraightLine, Some([last, older])) => 2 * last - older,
            (Predictor::Average, Some([last, older])) => (last + older) / 2,
            (_, None) => 0,
        };
        let value = base.wrapping_add(difference);
        // As wide as the firmware's own: clocks and counters wrap.
        match field.is_signed {
            true => i64::from(value as i32),
            false => i64::from(value as u32),
        }
    }
}

fn put<const N: usize>(group: &mut [Option<i64>; 8], values: [i64; N]) {
    for (slot, value) in group.iter_mut().zip(values) {
        *slot = Some(value);
    }
}

/// The lowest bits as a signed number.
fn extended(value: i64, bits: u32) -> i64 {
    let unused = 64 - bits;
    value << unused >> unused
}

/// Three values, the first two bits of which say how they are written.
fn triple(bytes: &mut Bytes) -> Option<[i64; 3]> {
    let lead = i64::from(bytes.byte()?);
    Some(match lead >> 6 {
        0 => [lead >> 4, lead >> 2, lead].map(|value| extended(value, 2)),
        1 => {
            let next = i64::from(bytes.byte()?);
            [lead, next >> 4, next].map(|value| extended(value, 4))
        }
        2 => {
            let next = [bytes.byte()?, bytes.byte()?].map(i64::from);
            [lead, next[0], next[1]].map(|value| extended(value, 6))
        }
        _ => wide_triple(lead, bytes)?,
    })
}

/// As [`triple`], with fields of unlike widths.
fn variable_triple(bytes: &mut Bytes) -> Option<[i64; 3]> {
    let lead = i64::from(bytes.byte()?);
    Some(match lead >> 6 {
        0 => [lead >> 4, lead >> 2, lead].map(|value| extended(value, 2)),
        1 => {
            let all = lead << 8 | i64::from(bytes.byte()?);
            [
                extended(all >> 9, 5),
                extended(all >> 4, 5),
                extended(all, 4),
            ]
        }
        2 => {
            let next = [bytes.byte()?, bytes.byte()?].map(i64::from);
            let all = lead << 16 | next[0] << 8 | next[1];
            [
                extended(all >> 14, 8),
                extended(all >> 7, 7),
                extended(all, 7),
            ]
        }
        _ => wide_triple(lead, bytes)?,
    })
}

/// Three values of one to four bytes, as two bits of the lead say for each.
fn wide_triple(lead: i64, bytes: &mut Bytes) -> Option<[i64; 3]> {
    let mut values = [0; 3];
    for (i, value) in values.iter_mut().enumerate() {
        let length = (lead >> (2 * i) & 3) as u32 + 1;
        for byte in 0..length {
            *value |= i64::from(bytes.byte()?) << (8 * byte);
        }
        *value = extended(*value, 8 * length);
    }
    Some(values)
}

/// Four values of no, one, two or four halves of a byte.
fn quartet(bytes: &mut Bytes) -> Option<[i64; 4]> {
    let widths = bytes.byte()?;
    let mut pending: Option<u8> = None;
    let mut half = || -> Option<i64> {
        match pending.take() {
            Some(low) => Some(i64::from(low)),
            None => {
                let byte = bytes.byte()?;
                pending = Some(byte & 0xf);
                Some(i64::from(byte >> 4))
            }
        }
    };
    let mut values = [0; 4];
    for (i, value) in values.iter_mut().enumerate() {
        let halves = [0, 1, 2, 4][usize::from(widths >> (2 * i) & 3)];
        for _ in 0..halves {
            *value = *value << 4 | half()?;
        }
        if halves > 0 {
            *value = extended(*value, 4 * halves);
        }
    }
    Some(values)
}

/// Bytes that are read one by one.
pub(super) struct Bytes<'a> {
    bytes: &'a [u8],
    pub(super) position: usize,
}

impl<'a> Bytes<'a> {
    pub(super) fn new(bytes: &'a [u8]) -> Self {
        Self { bytes, position: 0 }
    }

    /// The next byte; `None` at the end.
    pub(super) fn byte(&mut self) -> Option<u8> {
        let byte = self.peek()?;
        self.position += 1;
        Some(byte)
    }

    /// The next byte, left where it is.
    pub(super) fn peek(&self) -> Option<u8> {
        self.bytes.get(self.position).copied()
    }

    /// True where these bytes come next; then they are read.
    pub(super) fn skip(&mut self, expected: &[u8]) -> bool {
        let next = self.bytes.get(self.position..).unwrap_or_default();
        let is_next = next.starts_with(expected);
        self.position += if is_next { expected.len() } else { 0 };
        is_next
    }

    /// Seven bits a byte, the lowest first; 0 where it has more than 32 bits, as the vendor reads it.
    pub(super) fn unsigned(&mut self) -> Option<u32> {
        let mut value = 0_u32;
        for shift in (0..35).step_by(7) {
            let byte = self.byte()?;
            value |= u32::from(byte & 0x7f)
                .checked_shl(shift)
                .unwrap_or_default();
            if byte & 0x80 == 0 {
                return Some(value);
            }
        }
        Some(0)
    }

    /// The same, the sign in the lowest bit.
    fn signed(&mut self) -> Option<i64> {
        let value = self.unsigned()?;
        Some(i64::from((value >> 1) as i32 ^ -((value & 1) as i32)))
    }

    /// Where the bytes end.
    pub(super) fn end(&self) -> usize {
        self.bytes.len()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn bytes(bytes: &[u8]) -> Bytes<'_> {
        Bytes::new(bytes)
    }

    #[test]
    fn each_width_of_a_triple_is_read() {
        assert_eq!(triple(&mut bytes(&[0b0001_1011])), Some([1, -2, -1]));
        assert_eq!(triple(&mut bytes(&[0x4f, 0x81])), Some([-1, -8, 1]));
        assert_eq!(
            triple(&mut bytes(&[0xa0, 0x1f, 0x20])),
            Some([-32, 31, -32])
        );
        let wide = [0b1101_0100, 0xff, 0x00, 0x80, 0x34, 0x12];
        assert_eq!(triple(&mut bytes(&wide)), Some([-1, -32768, 0x1234]));
        assert_eq!(triple(&mut bytes(&wide[..4])), None);
    }

    #[test]
    fn variable_triples_share_their_bits_unevenly() {
        // 01 01111 10000 0111
        let five = 0b0101_1111_0000_0111_u16.to_be_bytes();
        assert_eq!(variable_triple(&mut bytes(&five)), Some([15, -16, 7]));
        // 10 10000000 0111111 1000000
        let eight = 0b1010_0000_0001_1111_1100_0000_u32.to_be_bytes();
        let eight = &eight[1..];
        assert_eq!(variable_triple(&mut bytes(eight)), Some([-128, 63, -64]));
    }

    #[test]
    fn quartets_cross_their_bytes() {
        // None, four bits, eight bits, sixteen bits.
        let written = [0b1110_0100, 0x7f, 0x21, 0x23, 0x40];
        assert_eq!(quartet(&mut bytes(&written)), Some([0, 7, -14, 0x1234]));
    }

    #[test]
    fn numbers_of_seven_bits_a_byte_carry_their_sign() {
        assert_eq!(bytes(&[0xac, 0x02]).unsigned(), Some(300));
        assert_eq!(bytes(&[0x03]).signed(), Some(-2));
        assert_eq!(
            bytes(&[0xff, 0xff, 0xff, 0xff, 0x0f]).signed(),
            Some(i64::from(i32::MIN))
        );
        assert_eq!(bytes(&[0xff; 5]).unsigned(), Some(0));
        assert_eq!(bytes(&[0x80]).unsigned(), None);
    }
}
