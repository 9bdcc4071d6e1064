//! Fields to bytes and back, little-endian, for every record.
//!
//! A reader is a slice that gets shorter, a writer a vector that gets longer.

pub use heapless::Vec;

/// Behind every record.
pub const CHECKSUM: crc::Crc<u32> = crc::Crc::<u32>::new(&crc::CRC_32_ISO_HDLC);

/// Takes the first bytes off a slice, `None` where there are not as many.
pub fn take<const N: usize>(bytes: &mut &[u8]) -> Option<[u8; N]> {
    let (field, rest) = bytes.split_first_chunk()?;
    *bytes = rest;
    Some(*field)
}

/// Appends bytes; those of a field that does not fit as a whole are dropped.
pub fn put<const N: usize>(bytes: &mut Vec<u8, N>, field: &[u8]) {
    // A vector that is too short is a mistake of its owner, whom a test of the round trip warns.
    let _ = bytes.extend_from_slice(field);
}
