//! Input that is refused: the user's to mend, unlike a failure of ours.

use std::fmt;

/// Why input is refused, in one line that names it and what would be right.
///
/// A command that meets one ends with exit code 2; any other error ends it with 1.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Refusal(String);

impl Refusal {
    /// A refusal in one line: breaks in what it quotes are blanks.
    pub fn new(line: impl Into<String>) -> Self {
        Self(line.into().replace(char::is_control, " "))
    }
}

impl fmt::Display for Refusal {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(&self.0)
    }
}

impl std::error::Error for Refusal {}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn what_is_quoted_breaks_no_line() {
        let refusal = Refusal::new("unknown variant `l\nded\r`");
        assert_eq!(refusal.to_string(), "unknown variant `l ded `");
    }
}
