//! How long work reports its progress to a person.

use std::path::Path;

/// A file as a stage names it: the folders of its path would fill the line.
pub(crate) fn named(file: &Path) -> std::path::Display<'_> {
    file.file_name().map_or(file, Path::new).display()
}

/// Hears how far a piece of work is.
pub trait Progress {
    /// A new stage begins, named as a person would: `Replaying sample.ulg`.
    fn stage(&mut self, name: &str);

    /// What the stage is busy with, where it has no measure of its own.
    fn detail(&mut self, _what: &str) {}

    /// How much of the stage is done, in seconds of flight or another measure.
    fn done(&mut self, _done: f64, _of: f64) {}

    /// Everything that a command said which failed, to be shown as it is.
    fn output(&mut self, _text: &str) {}
}

/// Reports nothing.
#[derive(Clone, Copy, Debug, Default)]
pub struct Silent;

impl Progress for Silent {
    fn stage(&mut self, _name: &str) {}
}
