//! A file that an option names for a result, and what is refused as one.

use std::fmt::Display;
use std::fs::{self, File};
use std::io::BufWriter;
use std::path::Path;

use crate::refusal::Refusal;

/// A file to be written, with the name of its option, so that refusals name both.
#[derive(Clone, Copy, Debug)]
pub(crate) struct OutputFile<'f> {
    option: &'f str,
    path: &'f Path,
}

impl<'f> OutputFile<'f> {
    /// The file that an option (`svg` for `--svg`) names.
    pub(crate) const fn new(option: &'f str, path: &'f Path) -> Self {
        Self { option, path }
    }

    /// Why the file is refused, in one line that names the option.
    pub(crate) fn refusal(&self, reason: impl Display) -> Refusal {
        Refusal::new(format!(
            "--{} {}: {reason}",
            self.option,
            self.path.display()
        ))
    }

    /// Refuses what no file can be written to.
    pub(crate) fn check(&self) -> Result<(), Refusal> {
        if self.path.as_os_str().is_empty() || self.path == Path::new("-") {
            return Err(self.refusal("must be the name of a file, stdout is for the result"));
        }
        if self.path.is_dir() {
            return Err(self.refusal("is a folder, must be the name of a file"));
        }
        let folder = self.path.parent();
        let folder = folder.filter(|folder| !folder.as_os_str().is_empty());
        if !folder.unwrap_or(Path::new(".")).is_dir() {
            return Err(self.refusal("its folder does not exist"));
        }
        Ok(())
    }

    /// Refuses a recorded flight, which would be lost.
    pub(crate) fn check_is_not(&self, log: &Path) -> Result<(), Refusal> {
        if self.is(log) {
            return Err(self.refusal("is the recorded flight itself, and would be overwritten"));
        }
        Ok(())
    }

    /// Refuses a pipe: opening it would wait for a reader.
    pub(crate) fn check_is_no_pipe(&self) -> Result<(), Refusal> {
        if fs::metadata(self.path).is_ok_and(|file| is_pipe(&file)) {
            return Err(self.refusal("is a pipe, must be a file"));
        }
        Ok(())
    }

    /// Whether both names lead to one file, however each is spelt or linked.
    pub(crate) fn is(&self, other: &Path) -> bool {
        match (fs::metadata(self.path), fs::metadata(other)) {
            (Ok(a), Ok(b)) => is_same(&a, &b),
            _ => false,
        }
    }

    /// Opens the file, empty.
    pub(crate) fn create(&self) -> Result<BufWriter<File>, Refusal> {
        let file = File::create(self.path);
        Ok(BufWriter::new(
            file.map_err(|error| self.unwritable(error))?,
        ))
    }

    /// Writes the whole file.
    pub(crate) fn write(&self, content: &str) -> Result<(), Refusal> {
        fs::write(self.path, content).map_err(|error| self.unwritable(error))
    }

    fn unwritable(&self, error: std::io::Error) -> Refusal {
        self.refusal(format_args!("cannot be written: {error}"))
    }
}

#[cfg(unix)]
fn is_same(a: &fs::Metadata, b: &fs::Metadata) -> bool {
    use std::os::unix::fs::MetadataExt;
    (a.dev(), a.ino()) == (b.dev(), b.ino())
}

/// Other systems do not number their files in the standard library.
#[cfg(not(unix))]
fn is_same(_: &fs::Metadata, _: &fs::Metadata) -> bool {
    false
}

#[cfg(unix)]
fn is_pipe(file: &fs::Metadata) -> bool {
    use std::os::unix::fs::FileTypeExt;
    file.file_type().is_fifo()
}

#[cfg(not(unix))]
fn is_pipe(_: &fs::Metadata) -> bool {
    false
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_refusal_names_the_option_that_the_file_was_given_to() {
        let refused = |path: &str| {
            let path = Path::new(path);
            OutputFile::new("plot", path)
                .check()
                .unwrap_err()
                .to_string()
        };
        assert_eq!(
            refused("src"),
            "--plot src: is a folder, must be the name of a file"
        );
        assert_eq!(
            refused("nowhere/a.svg"),
            "--plot nowhere/a.svg: its folder does not exist"
        );
        let unwritable = OutputFile::new("plot", Path::new("nowhere/a.svg")).write("");
        let line = unwritable.unwrap_err().to_string();
        assert!(
            line.starts_with("--plot nowhere/a.svg: cannot be written: "),
            "{line}"
        );
    }

    #[test]
    fn a_flight_is_not_overwritten_under_another_name() {
        let file = OutputFile::new("defmt", Path::new("./src/../Cargo.toml"));
        let line = file.check_is_not(Path::new("Cargo.toml")).unwrap_err();
        assert!(line.to_string().contains("is the recorded flight itself"));
        assert!(file.check_is_not(Path::new("src/lib.rs")).is_ok());
        assert!(file.check_is_not(Path::new("nowhere.csv")).is_ok());
    }
}
