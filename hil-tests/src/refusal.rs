//! Input that is refused: the user's to mend, unlike a failure of ours.

use std::fmt;

/// Why input is refused, in one line that names it and what would be right.
///
/// A command that meets one ends with exit code 2; any other error ends it with 1.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Refusal(String);

impl Refusal {
    /// A refusal in one line.
    pub fn new(line: impl Into<String>) -> Self {
        Self(line.into())
    }
}

impl fmt::Display for Refusal {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(&self.0)
    }
}

impl std::error::Error for Refusal {}
