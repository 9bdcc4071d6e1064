//! Files that people have beside logs: named, with the way to a log.

/// How files of a kind begin, and what to do with them.
const KINDS: [(&[u8], &str); 17] = [
    (
        b"PK\x03\x04",
        "is a ZIP archive: unpack it and name the log in it",
    ),
    (
        b"7z\xbc\xaf\x27\x1c",
        "is a 7z archive: unpack it and name the log in it",
    ),
    (
        b"Rar!",
        "is a RAR archive: unpack it and name the log in it",
    ),
    (b"BZh", "is packed by bzip2: unpack it, or pack it by gzip"),
    (
        b"\xfd7zXZ",
        "is packed by xz: unpack it, or pack it by gzip",
    ),
    (
        b"\x28\xb5\x2f\xfd",
        "is packed by zstd: unpack it, or pack it by gzip",
    ),
    (
        b"ULogEnc",
        "is an encrypted ULog: decrypt it with PX4's Tools/decrypt_ulog.py and the private key",
    ),
    (
        b"\x89MCAP",
        "is an MCAP file: replays read logs of autopilots, such as the .ulg that it was made from",
    ),
    (
        b"#ROSBAG",
        "is a ROS bag: write its IMU topic as CSV, as `rostopic echo -b BAG -p TOPIC` does",
    ),
    (
        b"SQLite format 3",
        "is an SQLite file, perhaps a ROS 2 bag: write its IMU topic as CSV",
    ),
    (
        b"\x89HDF",
        "is an HDF5 file, perhaps of MATLAB: write its IMU samples as CSV",
    ),
    (
        b"MATLAB 5.0",
        "is a MATLAB file: write its IMU samples as CSV",
    ),
    (b"%PDF", "is a PDF: name the log itself"),
    (b"<!DOCTYPE", "is a web page: download the log itself"),
    (b"<html", "is a web page: download the log itself"),
    (
        b"FMT, 128, 89,",
        "is the text form of a DataFlash log: name the .bin file that the autopilot wrote",
    ),
    (b"{", "is JSON: replays read logs of autopilots, and CSV"),
];

/// What a file is that is no log, and the way out.
pub(super) fn named(bytes: &[u8]) -> Option<&'static str> {
    let text = bytes.strip_prefix(b"\xef\xbb\xbf").unwrap_or(bytes);
    let kind = KINDS.iter().find(|(start, _)| {
        let begins = text.get(..start.len());
        begins.is_some_and(|begins| begins.eq_ignore_ascii_case(start))
    });
    if let Some((_, reason)) = kind {
        return Some(reason);
    }
    if is_telemetry(bytes) {
        return Some(
            "is a telemetry log (.tlog), which holds no samples fast enough to replay: \
             name the log of the board (.bin, .ulg)",
        );
    }
    let is_blank = bytes.iter().all(|byte| matches!(byte, 0 | 0xff));
    is_blank.then_some("holds nothing but erased memory: the log was never written")
}

/// MAVLink frames, each behind a time of eight bytes, us since 1970, the highest first.
fn is_telemetry(bytes: &[u8]) -> bool {
    const STAMP: usize = 8;
    let frame = |at: usize| -> Option<usize> {
        let length = usize::from(*bytes.get(at + STAMP + 1)?);
        match bytes.get(at + STAMP)? {
            0xfe => Some(at + STAMP + length + 8),
            0xfd => {
                let signed = bytes.get(at + STAMP + 2)? & 1;
                Some(at + STAMP + length + 12 + usize::from(signed) * 13)
            }
            _ => None,
        }
    };
    let is_stamp =
        bytes.starts_with(&[0, 4]) || bytes.starts_with(&[0, 5]) || bytes.starts_with(&[0, 6]);
    is_stamp && frame(0).and_then(frame).is_some()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn files_of_other_kinds_are_named_with_the_way_out() {
        let mut frame = vec![0, 5, 0xf0, 1, 2, 3, 4, 5, 0xfd, 3, 0, 0, 1, 1, 1, 0, 0, 0];
        frame.extend([0; 5]);
        let telemetry = [&frame[..], &frame].concat();
        for (bytes, expected) in [
            (&b"PK\x03\x04rest"[..], "ZIP"),
            (b"ULogEnc\x01", "encrypted"),
            (b"\xef\xbb\xbf<!doctype html>", "web page"),
            (&telemetry, ".tlog"),
            (&[0xff; 4096], "erased"),
        ] {
            let reason = named(bytes).expect(expected);
            assert!(reason.contains(expected), "{reason}");
        }
        assert_eq!(named(b"t_us,gx"), None);
        assert_eq!(named(b"ULog\x01\x12\x35\x01"), None);
    }
}
