//! Data and status registers, laid out alike on both dies.
//!
//! With block data update a register pair that has been read halfway keeps the
//! sample it began with until its other half has been read.

/// Which half of an axis a byte is.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Half {
    Low,
    High,
}

#[derive(Clone, Copy, Debug, Default)]
struct Axis {
    newest: i16,
    shown: i16,
    half_read: Option<Half>,
    /// A newer sample waits for the halfway read to end.
    held_back: bool,
    fresh: bool,
    overrun: bool,
}

/// Three 16-bit outputs with their data-available and overrun flags.
#[derive(Clone, Copy, Debug, Default)]
pub struct Outputs {
    axes: [Axis; 3],
}

impl Outputs {
    /// A new set of samples; `hold` is block data update.
    pub fn store(&mut self, sample: [i16; 3], hold: bool) {
        for (axis, value) in self.axes.iter_mut().zip(sample) {
            axis.overrun |= axis.fresh;
            axis.fresh = true;
            axis.newest = value;
            axis.held_back = hold && axis.half_read.is_some();
            if !axis.held_back {
                axis.shown = value;
            }
        }
    }

    /// Reads byte 0..=5: X low, X high, Y low and so on; `swap` is BLE.
    pub fn read(&mut self, index: u8, swap: bool) -> u8 {
        let axis = &mut self.axes[usize::from(index / 2 % 3)];
        let half = match (index % 2 == 1) != swap {
            true => Half::High,
            false => Half::Low,
        };
        let [low, high] = axis.shown.to_le_bytes();
        if half == Half::High {
            axis.fresh = axis.held_back;
            axis.overrun = false;
        }
        if axis.half_read.is_some_and(|first| first != half) {
            axis.half_read = None;
            axis.held_back = false;
            axis.shown = axis.newest;
        } else {
            axis.half_read = Some(half);
        }
        match half {
            Half::Low => low,
            Half::High => high,
        }
    }

    /// The byte a read would return, without its effects.
    pub fn peek(&self, index: u8, swap: bool) -> u8 {
        let mut copy = *self;
        copy.read(index, swap)
    }

    /// STATUS_REG: ZYXOR ZOR YOR XOR ZYXDA ZDA YDA XDA.
    pub fn status(&self) -> u8 {
        let bits = |flag: fn(&Axis) -> bool| {
            let bit = |(n, axis)| u8::from(flag(axis)) << n;
            self.axes.iter().enumerate().map(bit).sum::<u8>()
        };
        let group = |bits: u8| bits | u8::from(bits != 0) << 3;
        group(bits(|axis| axis.fresh)) | group(bits(|axis| axis.overrun)) << 4
    }

    /// Whether some axis has data that has not been read: the DRDY signal.
    pub fn ready(&self) -> bool {
        self.axes.iter().any(|axis| axis.fresh)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn read_all(outputs: &mut Outputs) -> [i16; 3] {
        [0, 2, 4].map(|index| {
            let low = outputs.read(index, false);
            i16::from_le_bytes([low, outputs.read(index + 1, false)])
        })
    }

    #[test]
    fn flags_follow_new_data_reading_and_overrun() {
        let mut outputs = Outputs::default();
        assert_eq!(outputs.status(), 0x00);
        outputs.store([1, 2, 3], false);
        assert_eq!(outputs.status(), 0x0F);
        outputs.store([4, 5, 6], false);
        assert_eq!(outputs.status(), 0xFF);
        assert!(outputs.ready());
        assert_eq!(read_all(&mut outputs), [4, 5, 6]);
        assert_eq!(outputs.status(), 0x00);
        assert!(!outputs.ready());
    }

    #[test]
    fn data_ready_lasts_until_every_axis_is_read() {
        let mut outputs = Outputs::default();
        outputs.store([1, 2, 3], false);
        outputs.read(0, false);
        assert_eq!(outputs.status(), 0x0F);
        outputs.read(1, false);
        assert_eq!(outputs.status(), 0x0E);
    }

    #[test]
    fn block_data_update_never_mixes_two_samples() {
        let mut outputs = Outputs::default();
        outputs.store([0x1122, 0, 0], true);
        assert_eq!(outputs.read(0, false), 0x22);
        outputs.store([0x3344, 0, 0], true);
        assert_eq!(outputs.read(1, false), 0x11);
        assert_eq!(read_all(&mut outputs)[0], 0x3344);
    }

    #[test]
    fn without_block_data_update_halves_of_two_samples_mix() {
        let mut outputs = Outputs::default();
        outputs.store([0x1122, 0, 0], false);
        assert_eq!(outputs.read(0, false), 0x22);
        outputs.store([0x3344, 0, 0], false);
        assert_eq!(outputs.read(1, false), 0x33);
    }

    #[test]
    fn a_sample_that_came_during_a_held_read_is_still_announced() {
        let mut outputs = Outputs::default();
        outputs.store([1, 1, 1], true);
        outputs.read(0, false);
        outputs.store([2, 2, 2], true);
        outputs.read(1, false);
        assert_eq!(outputs.status() & 0x01, 0x01);
    }

    #[test]
    fn big_endian_swaps_the_halves() {
        let mut outputs = Outputs::default();
        outputs.store([0x1122, 0, 0], false);
        assert_eq!([outputs.read(0, true), outputs.read(1, true)], [0x11, 0x22]);
    }
}
