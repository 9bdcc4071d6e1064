//! Dies with a clock and an interrupt pin of their own, whatever they measure.

use std::sync::Arc;

use super::bus::SpiChip;
use super::options::{ChipOptions, Present};
use super::stimulus::StimulusSource;

/// A die on SPI with a clock and an interrupt pin of its own, as both tiers look at it.
pub trait OwnClock: SpiChip {
    /// Output samples produced so far, across resets.
    fn samples(&self) -> u64;
    /// The threshold code that the interrupt pin follows; `None` where it follows every sample.
    fn pin_threshold(&self) -> Option<u32>;
    /// Nominal data rate in Hz; `None` where it does not sample.
    fn rate_hz(&self) -> Option<f64>;
    /// A supply dip at `now_ns`: every register back to its reset value.
    fn brown_out(&mut self, now_ns: u64);
    /// A bit of the threshold that its interrupt pin compares with turns over by itself.
    fn flip_threshold_bit(&mut self, now_ns: u64, bit: u8);
    /// From now on its clock is faster by a share than it was at power-on.
    fn hurry(&mut self, now_ns: u64, share: f64);
}

/// A kind of die with a clock of its own; its model's file declares it.
#[derive(Clone, Copy, Debug)]
pub struct Die {
    /// Its name in reports.
    pub name: &'static str,
    /// True where the sensor exists.
    pub is_present: fn(Present) -> bool,
    /// A new one that feels a source.
    pub model: fn(Arc<dyn StimulusSource>, ChipOptions) -> Box<dyn OwnClock>,
}
