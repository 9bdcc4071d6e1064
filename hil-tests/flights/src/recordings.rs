//! Real flights for tests, where they are at hand.

use std::path::{Path, PathBuf};

use crate::{Flight, Rotate, sample_flight};

/// Where recorded flights are looked for, from this package's folder.
const RECORDINGS: &str = "../../../shared/streams";

/// A recorded flight, or `None`, with a message, where it is not at hand.
pub fn recording(name: &str) -> Option<PathBuf> {
    let path = Path::new(env!("CARGO_MANIFEST_DIR"))
        .join(RECORDINGS)
        .join(name);
    if path.is_file() {
        return Some(path);
    }
    eprintln!(
        "skipped: the recorded flight {} is not at hand",
        path.display()
    );
    None
}

/// Every recorded flight that is at hand, and the one that comes with the crates.
pub fn flights() -> Vec<Flight> {
    const NAMES: [&str; 9] = [
        "ansfl_phantom4_h11",
        "ap33_solo_acro_crash_mpu6000_lsm303d",
        "ap33_solo_loiter_mpu6000_lsm303d",
        "bf42_gecko_cruise",
        "bf42_kakutef7_ar8_hover",
        "bf45_speedybee_freestyle",
        "bf45_speedybee_freestyle_unfilt",
        "px4_v5_hexa_vib",
        "px4_v6c_quad_calm",
    ];
    let recorded = NAMES.map(|name| recording(&format!("csv/{name}.csv")));
    let logs = recorded.into_iter().flatten();
    logs.chain(sample_flight())
        .map(|log| Flight::read(&log, Rotate::Auto).expect("a flight"))
        .collect()
}
