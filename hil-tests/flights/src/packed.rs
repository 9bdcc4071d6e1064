//! Logs that are compressed: `.gz` is unpacked, other archives are named.

use std::borrow::Cow;
use std::io::Read;

use flate2::read::MultiGzDecoder;

use super::error::{Fault, Location};
use super::skipped::Skipped;

/// What gzip files start with.
const MAGIC: [u8; 2] = [0x1f, 0x8b];

/// The most that is unpacked: with it and its samples a replay stays below half a gigabyte.
pub(super) const MOST_BYTES: u64 = 128 << 20;

/// The bytes of a log, unpacked where they were packed; a cut file as far as it goes.
///
/// # Errors
/// A file that holds nothing, or more than a log.
pub(super) fn unpacked<'a>(bytes: &'a [u8], skipped: &mut Skipped) -> Result<Cow<'a, [u8]>, Fault> {
    if !bytes.starts_with(&MAGIC) {
        return Ok(Cow::Borrowed(bytes));
    }
    let mut unpacked = Vec::new();
    let mut reader = MultiGzDecoder::new(bytes).take(MOST_BYTES + 1);
    let end = reader.read_to_end(&mut unpacked);
    if unpacked.len() as u64 > MOST_BYTES {
        return Err(Fault::whole(format!(
            "unpacks to more than {} MiB: unpack it and cut it into flights",
            MOST_BYTES >> 20
        )));
    }
    if let Err(error) = end {
        if unpacked.is_empty() {
            return Err(Fault::whole(format!("cannot be unpacked: {error}")));
        }
        let at = Location::Byte(unpacked.len() as u64);
        skipped.add(at, "end of the .gz file, cut off or spoilt");
    }
    Ok(Cow::Owned(unpacked))
}
