//! Which axes of a sensor repeat themselves to the last bit, window by window.
//!
//! Most axes move within a few samples of a window: from then on it costs nothing to watch them.

use crate::math::Vec3;

/// Samples in a window: a whole number of looks at the roughness.
pub(super) const WINDOW: u8 = 16;
/// One bit for each axis.
const ALL: u8 = 0b111;

/// The window under way, and what those before it showed.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Repeats {
    /// Axes that have not moved in this window.
    axes: u8,
    /// Samples left of it.
    left: u8,
    /// Whole windows in a row in which an axis did not move.
    windows: [u8; 3],
}

impl Default for Repeats {
    fn default() -> Self {
        Self {
            axes: ALL,
            left: WINDOW,
            windows: [0; 3],
        }
    }
}

impl Repeats {
    /// Takes what a sample moved by; true where a window ended in which an axis did not move.
    #[inline]
    pub(super) fn take(&mut self, moved: Vec3) -> bool {
        if self.axes != 0 {
            self.notice(moved);
        }
        self.left -= 1;
        self.left == 0 && self.end_window()
    }

    fn notice(&mut self, moved: Vec3) {
        for (axis, moved) in moved.to_array().into_iter().enumerate() {
            if moved != 0.0 {
                self.axes &= !(1 << axis);
                if let Some(windows) = self.windows.get_mut(axis) {
                    *windows = 0;
                }
            }
        }
    }

    #[inline(never)] // Once in a window.
    fn end_window(&mut self) -> bool {
        let stood = core::mem::replace(&mut self.axes, ALL);
        self.left = WINDOW;
        for (axis, windows) in self.windows.iter_mut().enumerate() {
            *windows = windows.saturating_add(stood >> axis & 1);
        }
        stood != 0
    }

    /// Samples left of the window.
    pub(super) fn left(&self) -> u8 {
        self.left
    }

    /// Whole windows in a row in which an axis did not move.
    pub(super) fn windows(&self) -> [u8; 3] {
        self.windows
    }
}
