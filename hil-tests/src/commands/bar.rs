//! Progress as a person sees it: a bar on a terminal, a few lines elsewhere.

use std::io::Write;

use std::io::IsTerminal;

use indicatif::{ProgressBar, ProgressStyle};

use crate::progress::Progress;

/// Parts of a bar, so that its position may be any number.
const PARTS: u64 = 1000;
/// Steps in which progress is written to a log that is no terminal, as shares.
const SPOKEN: u64 = 250;

/// Progress on stderr; stdout stays for the result.
pub(super) struct Bar {
    bar: ProgressBar,
    terminal: bool,
    /// The stage under way.
    name: String,
    spoken: u64,
}

impl Bar {
    pub(super) fn new() -> Self {
        Self {
            bar: ProgressBar::hidden(),
            terminal: std::io::stderr().is_terminal(),
            name: String::new(),
            spoken: 0,
        }
    }

    /// Removes the bar, so that the result stands alone.
    pub(super) fn finish(&self) {
        self.bar.finish_and_clear();
    }
}

impl Progress for Bar {
    fn stage(&mut self, name: &str) {
        self.finish();
        self.spoken = 0;
        name.clone_into(&mut self.name);
        if self.terminal {
            self.bar = ProgressBar::new(PARTS)
                .with_style(spinner())
                .with_message(name.to_owned());
            self.bar.tick();
        } else {
            say(&format!("{name}\n"));
        }
    }

    fn detail(&mut self, what: &str) {
        self.bar.set_message(format!("{}: {what}", self.name));
        self.bar.tick();
        // Elsewhere, what takes its time is said once; that nothing happens is said too.
        if !self.terminal && what.starts_with("Blocking") {
            say(&format!("  {what}\n"));
        }
    }

    fn done(&mut self, done: f64, of: f64) {
        let parts = (done / of * PARTS as f64).clamp(0.0, PARTS as f64) as u64;
        if self.terminal {
            if self.bar.position() == 0 {
                self.bar.set_style(measured());
            }
            self.bar.set_position(parts);
        } else if parts >= self.spoken + SPOKEN {
            self.spoken = parts - parts % SPOKEN;
            say(&format!("  {} %\n", self.spoken * 100 / PARTS));
        }
    }

    fn output(&mut self, text: &str) {
        self.finish();
        say(text);
    }
}

/// Progress is best effort: where it cannot be written, the work continues.
fn say(text: &str) {
    let _ = std::io::stderr().write_all(text.as_bytes());
}

fn spinner() -> ProgressStyle {
    style("{spinner} {wide_msg}")
}

/// What is of any length stands last, where a narrow terminal cuts it.
fn measured() -> ProgressStyle {
    style("[{bar:24}] {percent:>3} %, {eta} left  {wide_msg}")
}

fn style(template: &str) -> ProgressStyle {
    ProgressStyle::with_template(template).unwrap_or_else(|_| ProgressStyle::default_bar())
}
