//! Walks over the frames of a Blackbox session, and past spoilt ones.
//!
//! A frame counts once what follows looks like another, as in the vendor's own
//! reader. Behind a spoilt one, frames of differences mean nothing until the
//! next that stands by itself.

use super::super::super::error::Location;
use super::super::super::skipped::Skipped;
use super::header::Header;
use super::layout::{Before, Bytes};

/// No frame is longer.
const LONGEST_FRAME: usize = 256;
/// Loops and time (us) between two frames of a log that is whole.
const MOST_LOOPS: i64 = 5000;
const MOST_TIME_US: i64 = 10_000_000;

/// What a session tells.
pub(super) enum Frame<'f> {
    /// A main frame: all values of one loop.
    Main { place: Location, values: &'f [i64] },
    /// Logging was paused before what follows.
    Resumed,
}

/// The frames of a session.
pub(super) struct Frames<'a> {
    header: &'a Header,
    bytes: Bytes<'a>,
    /// Where in the log the bytes begin.
    from: usize,
    /// The two main frames before; none where differences mean nothing.
    history: Option<[Vec<i64>; 2]>,
    /// Loop and time of the last main frame, where the next must be near.
    last: Option<(i64, i64)>,
    has_ended: bool,
}

/// A frame that was read, before it is known to be one.
enum Read {
    Intra(Vec<i64>),
    Inter(Vec<i64>),
    Resumed(i64, i64),
    Other,
    End,
}

impl<'a> Frames<'a> {
    /// Of what follows a header, from a byte of the log on.
    pub(super) fn new(header: &'a Header, bytes: &'a [u8], from: usize) -> Self {
        Self {
            header,
            bytes: Bytes::new(bytes),
            from,
            history: None,
            last: None,
            has_ended: false,
        }
    }

    /// The next frame that is used; `None` at the session's end.
    pub(super) fn next(&mut self, skipped: &mut Skipped) -> Option<Frame<'_>> {
        while !self.has_ended {
            let start = self.bytes.position;
            let kind = self.bytes.byte()?;
            let place = Location::Byte((self.from + start) as u64);
            let read = self.read(kind).filter(|read| self.is_whole(start, read));
            let Some(read) = read else {
                self.lose_track(start, place, skipped);
                continue;
            };
            match read {
                Read::Intra(values) if self.follows(&values) => {
                    self.last = Some((values[self.header.iteration], values[self.header.time]));
                    self.history = Some([values.clone(), values]);
                }
                Read::Inter(values) if self.history.is_some() && self.follows(&values) => {
                    self.last = Some((values[self.header.iteration], values[self.header.time]));
                    if let Some(history) = &mut self.history {
                        history.swap(0, 1);
                        history[0] = values;
                    }
                }
                Read::Intra(_) | Read::Inter(_) => {
                    skipped.add(place, "frames that follow from nothing");
                    (self.history, self.last) = (None, None);
                    continue;
                }
                Read::Resumed(iteration, time) => {
                    self.last = Some((iteration, time));
                    return Some(Frame::Resumed);
                }
                Read::End => {
                    self.has_ended = true;
                    continue;
                }
                Read::Other => continue,
            }
            let [values, _] = self.history.as_ref()?;
            return Some(Frame::Main { place, values });
        }
        None
    }

    /// Reads a frame behind its first byte.
    fn read(&mut self, kind: u8) -> Option<Read> {
        let header = self.header;
        let alone = Before {
            last: None,
            left_out: 0,
        };
        Some(match kind {
            b'I' => Read::Intra(header.intra.read(&mut self.bytes, &alone)?),
            b'P' => {
                let history = self.history.as_ref();
                let before = Before {
                    last: history.map(|[last, older]| [last.as_slice(), older.as_slice()]),
                    left_out: self
                        .last
                        .map_or(0, |(loops, _)| header.left_out_behind(loops)),
                };
                Read::Inter(header.inter.read(&mut self.bytes, &before)?)
            }
            b'S' => header
                .slow
                .read(&mut self.bytes, &alone)
                .map(|_| Read::Other)?,
            b'G' => header
                .gps
                .read(&mut self.bytes, &alone)
                .map(|_| Read::Other)?,
            b'H' => header
                .home
                .read(&mut self.bytes, &alone)
                .map(|_| Read::Other)?,
            b'E' => self.event()?,
            _ => return None,
        })
    }

    /// Reads an event behind its first byte.
    fn event(&mut self) -> Option<Read> {
        let bytes = &mut self.bytes;
        let numbers = match bytes.byte()? {
            // A beep, a disarm, a failure of the sensor; flight modes.
            0 | 15 | 40 => 1,
            30 => 2,
            13 => {
                // An adjustment: of a float, or of a whole number.
                let is_float = bytes.byte()? >= 128;
                for _ in 0..if is_float { 4 } else { 0 } {
                    bytes.byte()?;
                }
                usize::from(!is_float)
            }
            14 => {
                let (iteration, time) = (bytes.unsigned()?, bytes.unsigned()?);
                return Some(Read::Resumed(iteration.into(), time.into()));
            }
            255 => return bytes.skip(b"End of log\0").then_some(Read::End),
            _ => return None,
        };
        for _ in 0..numbers {
            bytes.unsigned()?;
        }
        Some(Read::Other)
    }

    /// True for a frame that is not too long, and that another, or the end, follows.
    fn is_whole(&self, start: usize, read: &Read) -> bool {
        let is_next = self
            .bytes
            .peek()
            .is_none_or(|kind| b"IPSGHE".contains(&kind));
        let length = self.bytes.position - start;
        length <= LONGEST_FRAME && (is_next || matches!(read, Read::End))
    }

    /// True for a frame whose loop and time are a little later than the last.
    fn follows(&self, values: &[i64]) -> bool {
        let (iteration, time) = (values[self.header.iteration], values[self.header.time]);
        self.last.is_none_or(|(last_iteration, last_time)| {
            (0..MOST_LOOPS).contains(&(iteration - last_iteration))
                && (0..MOST_TIME_US).contains(&(time - last_time))
        })
    }

    /// Skips one byte of what is no frame.
    fn lose_track(&mut self, start: usize, place: Location, skipped: &mut Skipped) {
        let was_cut = self.bytes.position >= self.bytes.end();
        let what = match was_cut {
            true => "bytes behind the last whole frame",
            false => "bytes of garbage",
        };
        skipped.add(place, what);
        self.bytes.position = start + 1;
        (self.history, self.last) = (None, None);
    }
}
