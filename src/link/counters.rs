//! What the link has read and refused, for the log.

/// Counts of frames and bytes since the start; each stops at its largest value.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
#[cfg_attr(target_os = "none", derive(defmt::Format))]
pub struct LinkCounters {
    /// Frames of the messages used whose checksum holds, whatever became of them.
    pub frames: u32,
    /// Starts of frames of the messages used whose checksum does not hold.
    pub bad_checksum: u32,
    /// Frames without payload: MAVLink 2 sends at least one byte.
    pub bad_length: u32,
    /// Starts of frames with incompatibility flags other than "signed".
    pub bad_flags: u32,
    /// Frames that were not complete in time.
    pub truncated: u32,
    /// MAVLink 1 frames skipped.
    pub version_1: u32,
    /// Frames of messages that are not used here.
    pub unknown_message: u32,
    /// Frames for another system or component, and echoes of our own.
    pub not_for_us: u32,
    /// Frames without a signature, though there is a key.
    pub unsigned: u32,
    /// Frames with another signature than the key's.
    pub bad_signature: u32,
    /// Signed frames that were heard before, or may have been.
    pub old_stamp: u32,
    /// Commands, setpoints and goals of another than the pilot; positions of another than the tracker.
    pub not_allowed: u32,
    /// Frames refused for a value: not a number, out of range, not supported, for every system.
    pub refused_value: u32,
    /// Frames that senders numbered and that never arrived.
    pub lost_sequence: u32,
    /// Bytes that belonged to no frame.
    pub garbage_bytes: u32,
}

impl LinkCounters {
    /// Nothing read yet; `Default` for constants.
    pub(super) const NONE: Self = Self {
        frames: 0,
        bad_checksum: 0,
        bad_length: 0,
        bad_flags: 0,
        truncated: 0,
        version_1: 0,
        unknown_message: 0,
        not_for_us: 0,
        unsigned: 0,
        bad_signature: 0,
        old_stamp: 0,
        not_allowed: 0,
        refused_value: 0,
        lost_sequence: 0,
        garbage_bytes: 0,
    };

    /// Frames that changed nothing because they were malformed, cut off or refused.
    #[must_use]
    pub fn spoilt(&self) -> u32 {
        self.bad_checksum
            .saturating_add(self.bad_length)
            .saturating_add(self.bad_flags)
            .saturating_add(self.truncated)
            .saturating_add(self.unsigned)
            .saturating_add(self.bad_signature)
            .saturating_add(self.old_stamp)
            .saturating_add(self.not_allowed)
            .saturating_add(self.refused_value)
    }
}

/// Counts one more.
pub(super) fn count(counter: &mut u32) {
    count_many(counter, 1);
}

/// Counts several more.
pub(super) fn count_many(counter: &mut u32, more: usize) {
    *counter = counter.saturating_add(u32::try_from(more).unwrap_or(u32::MAX));
}
