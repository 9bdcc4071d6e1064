//! The models on their own, and whole runs of programs of a few words.

mod i2c;
mod models;
mod program;
mod runs;

use std::sync::{Arc, Mutex};

use super::Sensors;
use chip_models::{Chip, DIES, I2cChip, SpiChip};

/// A chip that only has an interrupt pin, high between two instants.
#[derive(Clone, Copy, Debug, Default)]
struct Pulse {
    from_ns: u64,
    to_ns: u64,
    now_ns: u64,
}

impl Chip for Pulse {
    fn advance(&mut self, now_ns: u64) {
        self.now_ns = now_ns;
    }
    fn next_event(&self) -> u64 {
        let ahead = [self.from_ns, self.to_ns]
            .into_iter()
            .filter(|&at| at > self.now_ns);
        ahead.min().unwrap_or(u64::MAX)
    }
    fn interrupt(&self) -> bool {
        (self.from_ns..self.to_ns).contains(&self.now_ns)
    }
}

impl I2cChip for Pulse {
    fn start(&mut self, _: u64, _: u8, _: bool) -> bool {
        false
    }
    fn write(&mut self, _: u64, _: u8) -> bool {
        false
    }
    fn read(&mut self, _: u64, _: bool) -> u8 {
        0
    }
    fn stop(&mut self, _: u64) {}
}

impl SpiChip for Pulse {
    fn select(&mut self, _: u64) {}
    fn transfer(&mut self, _: u64, mosi: u8) -> u8 {
        mosi
    }
    fn deselect(&mut self, _: u64) {}
}

/// Sensors of which only the IMU ever raises its line.
fn sensors(imu: Pulse) -> Sensors {
    Sensors {
        imu: Arc::new(Mutex::new(imu)),
        dies: DIES.map(|_| -> Arc<Mutex<dyn SpiChip>> { Arc::new(Mutex::new(Pulse::default())) }),
    }
}
