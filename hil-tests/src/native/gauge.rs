//! The battery's converter: a look takes what the look before began.

use reflex::battery::BatteryReading;

/// Steps of the converter, 12 bits, and what all of them are, mV.
const STEPS: u32 = 4095;
const SUPPLY_MV: u32 = 3_300;

/// The converter, and what is on its pins.
#[derive(Debug, Default)]
pub(crate) struct Gauge {
    /// Of the divider and of the shunt, mV.
    pub(crate) pins_mv: [u32; 2],
    converted: [u16; 2],
}

impl Gauge {
    /// The last conversion; the next one begins.
    pub(super) fn look(&mut self) -> BatteryReading {
        let reading = BatteryReading::of_steps(self.converted);
        let steps = |mv: u32| (u64::from(mv) * u64::from(STEPS) / u64::from(SUPPLY_MV)) as u32;
        self.converted = self.pins_mv.map(|mv| steps(mv).min(STEPS) as u16);
        reading
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_look_shows_what_was_on_the_pins_at_the_look_before() {
        let mut gauge = Gauge {
            pins_mv: [1_168, 500],
            ..Gauge::default()
        };
        assert_eq!(gauge.look(), BatteryReading::default());
        gauge.pins_mv = [9_000, 0];
        assert_eq!(gauge.look(), BatteryReading::of_steps([1_449, 620]));
        // More than the supply is the supply.
        assert_eq!(gauge.look(), BatteryReading::of_steps([4_095, 0]));
    }
}
