//! Why a recorded flight was refused: one line naming the file and where in it.

use std::fmt;
use std::path::{Path, PathBuf};

/// Where in a log the trouble is.
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum Location {
    /// The file as a whole.
    File,
    /// A line of a text log, counted from 1.
    Line(u64),
    /// A named column in a line of a text log.
    Cell {
        /// Line, counted from 1.
        line: u64,
        /// Name of the column as the header gives it.
        column: String,
    },
    /// A byte offset in a binary log, counted from 0.
    Byte(u64),
}

impl fmt::Display for Location {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::File => Ok(()),
            Self::Line(line) => write!(f, "line {line}: "),
            Self::Cell { line, column } => write!(f, "line {line}, column {column}: "),
            Self::Byte(offset) => write!(f, "byte {offset}: "),
        }
    }
}

/// What is wrong with the content of a log, before its file is known.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Fault {
    /// Where.
    pub location: Location,
    /// What, and the way out where there is one.
    pub reason: String,
}

impl Fault {
    /// A fault at a place.
    pub fn new(location: Location, reason: impl Into<String>) -> Self {
        Self {
            location,
            reason: reason.into(),
        }
    }

    /// A fault of the log as a whole.
    pub fn whole(reason: impl Into<String>) -> Self {
        Self::new(Location::File, reason)
    }

    /// The same fault, in a named file.
    #[must_use]
    pub fn in_file(self, file: &Path) -> FlightError {
        FlightError {
            file: file.to_owned(),
            fault: self,
        }
    }
}

/// A recorded flight that cannot be replayed; displays as exactly one line.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct FlightError {
    file: PathBuf,
    fault: Fault,
}

impl FlightError {
    /// The log that was refused.
    #[must_use]
    pub fn file(&self) -> &Path {
        &self.file
    }

    /// Where in the log the trouble is.
    #[must_use]
    pub fn location(&self) -> &Location {
        &self.fault.location
    }
}

impl fmt::Display for FlightError {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let Fault { location, reason } = &self.fault;
        let text = format!("{}: {location}{reason}", self.file.display());
        escaped(text.chars()).try_for_each(|character| write!(f, "{character}"))
    }
}

impl std::error::Error for FlightError {}

/// Text from outside: nothing in it may break the line.
fn escaped(text: impl Iterator<Item = char>) -> impl Iterator<Item = char> {
    text.flat_map(|character| {
        let is_control = character.is_control();
        let escape = is_control.then(|| character.escape_default());
        let plain = (!is_control).then_some(character);
        escape.into_iter().flatten().chain(plain)
    })
}

/// A piece of a log or of an option, shortened so that it can be quoted in one line.
pub(super) fn quoted(text: &str) -> String {
    const LONGEST: usize = 40;
    let dots = if text.chars().count() > LONGEST {
        "..."
    } else {
        ""
    };
    let start: String = escaped(text.chars().take(LONGEST)).collect();
    format!("'{start}{dots}'")
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn an_error_is_one_line_even_when_the_file_name_is_two() {
        let error = Fault::new(Location::Line(3), "no\r\ngood").in_file(Path::new("a\nb.csv"));
        assert_eq!(error.to_string(), r"a\nb.csv: line 3: no\r\ngood");
    }

    #[test]
    fn a_long_quotation_is_cut() {
        assert_eq!(quoted(&"x".repeat(1000)).len(), 45);
        assert_eq!(quoted("gx"), "'gx'");
        assert_eq!(quoted("a\nb"), r"'a\nb'");
    }
}
