//! What a reader could not use of a log: counted by kind, with the first place.

use std::fmt;

use super::error::{Fault, Location};

/// More kinds than this are counted together: a log of garbage stays one short list.
const MOST_KINDS: usize = 12;

/// One kind of what was skipped.
#[derive(Clone, Debug, PartialEq, Eq, serde::Serialize)]
pub struct Skip {
    /// What it is, and why it cannot be used.
    pub what: String,
    /// How often.
    pub count: u64,
    /// Where it was met first.
    #[serde(serialize_with = "as_text")]
    pub first: Location,
}

impl fmt::Display for Skip {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let Self { what, count, first } = self;
        write!(f, "{count} x {what}")?;
        match first.to_string().trim_end_matches(": ") {
            "" => Ok(()),
            place => write!(f, " (first at {place})"),
        }
    }
}

fn as_text<S: serde::Serializer>(place: &Location, serializer: S) -> Result<S::Ok, S::Error> {
    serializer.serialize_str(place.to_string().trim_end_matches(": "))
}

/// All that was skipped of a log.
#[derive(Clone, Debug, Default, PartialEq, Eq, serde::Serialize)]
pub struct Skipped(Vec<Skip>);

impl Skipped {
    /// Counts one piece; `what` names its kind, without values.
    pub(super) fn add(&mut self, first: Location, what: &str) {
        self.add_many(first, what, 1);
    }

    /// Counts several pieces of a kind that begin at one place.
    pub(super) fn add_many(&mut self, first: Location, what: &str, count: u64) {
        let is_full = self.0.len() >= MOST_KINDS;
        let what = if is_full {
            "pieces of other kinds"
        } else {
            what
        };
        match self.0.iter_mut().find(|skip| skip.what == what) {
            Some(skip) => skip.count += count,
            None => self.0.push(Skip {
                what: what.to_owned(),
                count,
                first,
            }),
        }
    }

    /// Counts a fault as a kind of its own.
    pub(super) fn fault(&mut self, fault: Fault) {
        self.add(fault.location, &fault.reason);
    }

    /// Takes over what another list counts.
    pub(super) fn append(&mut self, other: Self) {
        for skip in other.0 {
            self.add_many(skip.first, &skip.what, skip.count);
        }
    }

    /// Each kind, in the order in which they were met.
    #[must_use]
    pub fn kinds(&self) -> &[Skip] {
        &self.0
    }

    /// How much was skipped of all kinds.
    #[must_use]
    pub fn count(&self) -> u64 {
        self.0.iter().map(|skip| skip.count).sum()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_kind_is_told_once_with_its_count_and_first_place() {
        let mut skipped = Skipped::default();
        for byte in [7, 9, 11] {
            skipped.add(Location::Byte(byte), "bytes of garbage");
        }
        let [kind] = skipped.kinds() else {
            panic!("one kind")
        };
        assert_eq!(kind.to_string(), "3 x bytes of garbage (first at byte 7)");
    }

    #[test]
    fn a_log_of_garbage_leaves_a_short_list() {
        let mut skipped = Skipped::default();
        for line in 0..1000 {
            skipped.add(Location::Line(line), &format!("kind {line}"));
        }
        assert_eq!(skipped.count(), 1000);
        assert_eq!(skipped.kinds().len(), MOST_KINDS + 1);
    }
}
