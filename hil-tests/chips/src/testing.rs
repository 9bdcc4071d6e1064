//! Signals and bus transactions for tests of the chips and of what reads them.

use std::sync::Arc;

use super::bus::{Chip, I2cChip, SpiChip};
use super::options::ChipOptions;
use super::stimulus::{STANDARD_GRAVITY, Stimulus, StimulusSource};

/// A millisecond, ns.
pub const MS: u64 = 1_000_000;
/// A second, ns.
pub const SECOND: u64 = 1_000_000_000;

/// A specimen with an exact oscillator and no noise.
pub fn exact() -> ChipOptions {
    ChipOptions {
        oscillator_error: Some(0.0),
        ..ChipOptions::default()
    }
}

/// A specimen as bought: noise and a drawn oscillator error.
pub fn real(seed: u64) -> ChipOptions {
    ChipOptions {
        seed,
        noise: true,
        ..ChipOptions::default()
    }
}

/// Specific force given in g as a function of seconds; all else is zero.
pub fn force_g(at: impl Fn(f64) -> [f64; 3] + Send + Sync + 'static) -> Arc<dyn StimulusSource> {
    Arc::new(move |ns: u64| Stimulus {
        specific_force: at(ns as f64 * 1e-9).map(|g| g * STANDARD_GRAVITY),
        temperature_c: 25.0,
        ..Stimulus::default()
    })
}

/// Rate given in degrees per second as a function of seconds.
pub fn rate_dps(at: impl Fn(f64) -> [f64; 3] + Send + Sync + 'static) -> Arc<dyn StimulusSource> {
    Arc::new(move |ns: u64| Stimulus {
        gyro: at(ns as f64 * 1e-9).map(f64::to_radians),
        temperature_c: 25.0,
        ..Stimulus::default()
    })
}

/// Field given in gauss as a function of seconds.
pub fn field_gauss(
    at: impl Fn(f64) -> [f64; 3] + Send + Sync + 'static,
) -> Arc<dyn StimulusSource> {
    Arc::new(move |ns: u64| Stimulus {
        magnetic_field: at(ns as f64 * 1e-9),
        temperature_c: 25.0,
        ..Stimulus::default()
    })
}

/// A lively signal on everything, for comparisons of whole runs.
pub fn lively() -> Arc<dyn StimulusSource> {
    Arc::new(|ns: u64| {
        let t = ns as f64 * 1e-9;
        Stimulus {
            gyro: [(t * 40.0).sin(), (t * 7.0).cos() * 3.0, t.sin()],
            specific_force: [(t * 30.0).sin() * 5.0, t.cos(), STANDARD_GRAVITY],
            magnetic_field: [0.2 * t.sin(), 0.3, -0.4 * (t * 3.0).cos()],
            temperature_c: 30.0 + t,
        }
    })
}

/// Sends a whole SPI transaction at one instant and returns what MISO showed.
pub fn spi(chip: &mut dyn SpiChip, now_ns: u64, mosi: &[u8]) -> Vec<u8> {
    chip.select(now_ns);
    let miso = mosi
        .iter()
        .map(|byte| chip.transfer(now_ns, *byte))
        .collect();
    chip.deselect(now_ns);
    miso
}

/// Reads `count` bytes from an accelerometer register on, all FF on MOSI.
pub fn read_accel(chip: &mut dyn SpiChip, now_ns: u64, address: u8, count: usize) -> Vec<u8> {
    let mut mosi = vec![0xFF; count + 1];
    mosi[0] = 0xC0 | address;
    spi(chip, now_ns, &mosi).split_off(1)
}

/// Reads `count` bytes from a magnetometer register on, all FF on MOSI.
pub fn read_mag(chip: &mut dyn SpiChip, now_ns: u64, address: u8, count: usize) -> Vec<u8> {
    let mut mosi = vec![0xFF; count + 1];
    mosi[0] = 0x80 | address;
    spi(chip, now_ns, &mosi).split_off(1)
}

/// Writes registers one by one at one instant.
pub fn write_spi(chip: &mut dyn SpiChip, now_ns: u64, values: &[(u8, u8)]) {
    for (address, value) in values {
        spi(chip, now_ns, &[*address, *value]);
    }
}

/// Writes registers one by one at one instant.
pub fn write_i2c(chip: &mut dyn I2cChip, now_ns: u64, values: &[(u8, u8)]) {
    for (address, value) in values {
        assert!(chip.start(now_ns, 0x68, false));
        assert!(chip.write(now_ns, *address) && chip.write(now_ns, *value));
        chip.stop(now_ns);
    }
}

/// Reads a burst at one instant.
pub fn read_i2c(chip: &mut dyn I2cChip, now_ns: u64, address: u8, count: usize) -> Vec<u8> {
    chip.start(now_ns, 0x68, false);
    chip.write(now_ns, address);
    chip.start(now_ns, 0x68, true);
    let bytes = (1..=count).map(|n| chip.read(now_ns, n == count)).collect();
    chip.stop(now_ns);
    bytes
}

/// Three little-endian codes.
pub fn little(bytes: &[u8]) -> [i16; 3] {
    [0, 2, 4].map(|n| i16::from_le_bytes([bytes[n], bytes[n + 1]]))
}

/// Three big-endian codes.
pub fn big(bytes: &[u8]) -> [i16; 3] {
    [0, 2, 4].map(|n| i16::from_be_bytes([bytes[n], bytes[n + 1]]))
}

/// Follows `next_event` until `end_ns`; instants of the pin's rising edges.
pub fn rising_edges(chip: &mut dyn Chip, end_ns: u64) -> Vec<u64> {
    let mut edges = Vec::new();
    let mut before = chip.interrupt();
    loop {
        let at_ns = chip.next_event();
        if at_ns > end_ns {
            return edges;
        }
        chip.advance(at_ns);
        let now = chip.interrupt();
        if now && !before {
            edges.push(at_ns);
        }
        before = now;
    }
}
