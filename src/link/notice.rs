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

/// A text with its severity, as one STATUSTEXT carries it.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Notice {
    severity: Severity,
    text: &'static str,
}

impl Notice {
    /// Bytes of the longest text: longer ones would come in pieces that may get lost one by one.
    pub const LONGEST: usize = 50;

    /// A notice for a constant, or `const { .. }`: a text that is too long stops the build there.
    ///
    /// # Panics
    /// The text is longer than [`Self::LONGEST`] bytes, or not ASCII.
    #[must_use]
    pub const fn new(severity: Severity, text: &'static str) -> Self {
        assert!(
            text.len() <= Self::LONGEST && text.is_ascii(),
            "a notice is at most 50 bytes of ASCII"
        );
        Self { severity, text }
    }

    /// How bad it is.
    #[must_use]
    pub const fn severity(&self) -> Severity {
        self.severity
    }

    /// What happened.
    #[must_use]
    pub const fn text(&self) -> &'static str {
        self.text
    }
}
