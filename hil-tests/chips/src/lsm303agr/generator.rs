//! The accelerometer's two threshold generators.
//!
//! A generator compares the magnitude of each axis with one threshold at every
//! sample and combines the enabled conditions by OR or AND. The condition must
//! outlast the duration, in samples, before the interrupt comes.

/// INTx_CFG: all enabled conditions instead of any.
const AND: u8 = 0x80;
/// INTx_CFG: six-direction detection, which is not modelled and never fires.
const DIRECTION: u8 = 0x40;
/// INTx_SRC: an interrupt was generated.
const ACTIVE: u8 = 0x40;

/// What the registers ask of a generator.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Setup {
    /// INTx_CFG: AOI 6D ZHIE ZLIE YHIE YLIE XHIE XLIE.
    pub config: u8,
    /// The threshold, in the unit of the values compared.
    pub threshold: f64,
    /// INTx_DURATION: samples that the condition must outlast.
    pub duration: u8,
    /// CTRL_REG5_A: hold until INTx_SRC is read.
    pub latched: bool,
}

/// State of one generator.
#[derive(Clone, Copy, Debug, Default)]
pub struct Generator {
    held_for: u8,
    source: u8,
}

impl Generator {
    /// One sample; whether an interrupt begins.
    pub fn step(&mut self, value: [f64; 3], setup: &Setup) -> bool {
        let events = events(value, setup.threshold) & setup.config;
        let enabled = setup.config & 0x3F;
        let met = match setup.config & (AND | DIRECTION) {
            0 => events != 0,
            AND => enabled != 0 && events == enabled,
            _ => false,
        };
        self.held_for = if met {
            self.held_for.saturating_add(1)
        } else {
            0
        };
        let firing = met && self.held_for > setup.duration;
        let was_active = self.active();
        if !setup.latched {
            self.source = events | if firing { ACTIVE } else { 0 };
        } else if firing && !was_active {
            self.source = events | ACTIVE;
        }
        self.active() && !was_active
    }

    /// Whether the interrupt signal is active.
    pub fn active(&self) -> bool {
        self.source & ACTIVE != 0
    }

    /// INTx_SRC without the effects of reading it.
    pub fn source(&self) -> u8 {
        self.source
    }

    /// INTx_SRC; reading it releases a latched interrupt.
    pub fn read_source(&mut self, latched: bool) -> u8 {
        let source = self.source;
        if latched {
            self.source = 0;
        }
        source
    }
}

/// Bits ZH ZL YH YL XH XL from bit 5 down: above or below in magnitude.
fn events(value: [f64; 3], threshold: f64) -> u8 {
    let mut bits = 0;
    for (axis, value) in value.into_iter().enumerate() {
        if value.abs() > threshold {
            bits |= 0b10 << (2 * axis);
        } else if value.abs() < threshold {
            bits |= 0b01 << (2 * axis);
        }
    }
    bits
}

#[cfg(test)]
mod tests {
    use super::*;

    const ANY_HIGH: u8 = 0x2A;

    fn setup(config: u8) -> Setup {
        Setup {
            config,
            threshold: 10.0,
            duration: 0,
            latched: false,
        }
    }

    #[test]
    fn or_fires_on_any_axis_in_either_direction_and_names_it() {
        for (value, source) in [
            ([11.0, 0.0, 0.0], 0x42),
            ([0.0, -11.0, 0.0], 0x48),
            ([0.0, 0.0, 11.0], 0x60),
            ([-11.0, 11.0, 11.0], 0x6A),
        ] {
            let mut generator = Generator::default();
            assert!(generator.step(value, &setup(ANY_HIGH)));
            assert_eq!(generator.source(), source);
        }
    }

    #[test]
    fn the_threshold_itself_does_not_fire() {
        let mut generator = Generator::default();
        assert!(!generator.step([10.0, -10.0, 0.0], &setup(ANY_HIGH)));
    }

    #[test]
    fn and_of_lows_is_free_fall() {
        let free_fall = setup(0x80 | 0x15);
        let mut generator = Generator::default();
        assert!(!generator.step([0.0, 0.0, 11.0], &free_fall));
        assert!(generator.step([1.0, -2.0, 3.0], &free_fall));
        assert_eq!(generator.source(), 0x55);
    }

    #[test]
    fn nothing_enabled_never_fires() {
        for config in [0x00, 0x80, 0x40, 0xC0] {
            assert!(!Generator::default().step([99.0; 3], &setup(config)));
        }
    }

    #[test]
    fn the_condition_must_outlast_the_duration() {
        let setup = Setup {
            duration: 3,
            ..setup(ANY_HIGH)
        };
        let mut generator = Generator::default();
        let fired: Vec<bool> = [20.0, 20.0, 0.0, 20.0, 20.0, 20.0, 20.0]
            .map(|x| generator.step([x, 0.0, 0.0], &setup))
            .into();
        assert_eq!(fired, [false, false, false, false, false, false, true]);
    }

    #[test]
    fn a_latch_holds_the_first_event_until_its_source_is_read() {
        let setup = Setup {
            latched: true,
            ..setup(ANY_HIGH)
        };
        let mut generator = Generator::default();
        generator.step([11.0, 0.0, 0.0], &setup);
        assert!(!generator.step([0.0, 11.0, 0.0], &setup), "already active");
        generator.step([0.0; 3], &setup);
        assert!(generator.active());
        assert_eq!(generator.read_source(true), 0x42);
        assert!(!generator.active());
        assert_eq!(generator.read_source(true), 0x00);
        assert!(generator.step([0.0, 0.0, 11.0], &setup));
    }

    #[test]
    fn without_a_latch_the_interrupt_ends_with_the_condition() {
        let mut generator = Generator::default();
        generator.step([11.0, 0.0, 0.0], &setup(ANY_HIGH));
        assert!(generator.active());
        assert_eq!(generator.read_source(false), 0x42);
        assert!(generator.active(), "reading does not end it");
        generator.step([0.0; 3], &setup(ANY_HIGH));
        assert!(!generator.active());
    }
}
