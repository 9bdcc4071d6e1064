//! A line of text for the ground station: what happened, and how bad it is.

/// How bad it is (MAV_SEVERITY).
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
#[cfg_attr(target_os = "none", derive(defmt::Format))]
#[repr(u8)]
pub enum Severity {
    /// The drone cannot be used.
    Emergency,
    /// Something must be done at once.
    Alert,
    /// Something that flight needs has failed.
    Critical,
    /// Something has failed that flight can do without.
    Error,
    /// Something may fail soon.
    Warning,
    /// Out of the ordinary, and no fault.
    Notice,
    /// As expected.
    Info,
    /// For who looks for a fault.
    Debug,
}

/// A line `what: why` with its severity, as one STATUSTEXT carries it.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Notice {
    severity: Severity,
    what: &'static str,
    why: &'static str,
}

impl Notice {
    /// Bytes of the longest line: longer ones would come in pieces that may get lost one by one.
    pub const LONGEST: usize = 50;

    /// A notice; of a line beyond [`Self::LONGEST`] bytes of ASCII the rest is not sent.
    #[must_use]
    pub const fn new(severity: Severity, what: &'static str, why: &'static str) -> Self {
        Self {
            severity,
            what,
            why,
        }
    }

    /// How bad it is.
    #[must_use]
    pub const fn severity(&self) -> Severity {
        self.severity
    }

    /// The bytes of its line.
    pub fn line(&self) -> impl Iterator<Item = u8> {
        self.what.bytes().chain(*b": ").chain(self.why.bytes())
    }
}
