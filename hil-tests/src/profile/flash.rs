//! Where the flash of a firmware goes: its code by part, and what is no code.
//!
//! Instructions that the compiler inlined count for the part whose source they are of, as in a profile.

use std::collections::BTreeMap;

use anyhow::{Context, Result};
use object::{Object, ObjectSection, SectionKind};

use super::frames::Frames;
use super::parts::{Part, REST, part, part_among};
use crate::firmware::Firmware;

/// Constants, vectors, and the first values of variables: the compiler merges those of all parts.
pub const CONSTANTS: &str = "constants";

/// Every part that code is counted for, as it is listed.
pub const FLASH_PARTS: [Part; 15] = [
    part(
        "safety",
        &[
            "reflex::safety",
            "reflex::app::airborne",
            "reflex::app::flight",
            "reflex::app::notice",
            "reflex::battery",
            "reflex::reset",
            "reflex::tasks::vitals",
            "board::fault",
            "board::last_words",
            "board::reflex_f427::battery",
            "board::reset",
            "board::watchdog",
        ],
    ),
    part(
        "sensors judged",
        &[
            "reflex::app::sensing",
            "reflex::estimate::arrival",
            "reflex::estimate::calibration",
        ],
    ),
    part("estimate", &["reflex::estimate"]),
    part(
        "control",
        &[
            "reflex::graph",
            "reflex::control",
            "reflex::airframe",
            "reflex::dataflow",
        ],
    ),
    part("reactive control", &["reflex::reactive"]),
    part(
        "link",
        &[
            "reflex::link",
            "reflex::tasks::link",
            "board::reflex_f427::link_port",
            "mavlink",
            "mavlink_core",
        ],
    ),
    part(
        "signing",
        &["reflex::link::signing", "sha2", "digest", "block_buffer"],
    ),
    part(
        "log",
        &[
            "defmt",
            "defmt_rtt",
            "reflex::app::telemetry",
            "board::idle",
        ],
    ),
    part(
        "call recorder",
        &["reflex::app::call", "reflex::app::record", "board::calls"],
    ),
    part("door", &["reflex::app"]),
    part(
        "drivers",
        &[
            "drivers",
            "embedded_hal_bus",
            "lsm303agr",
            "mpu6050",
            "reflex::app::chips",
            "reflex::tasks::chips",
            "reflex::tasks::drivers",
            "reflex::tasks::imu",
            "reflex::tasks::mpu6050",
        ],
    ),
    part(
        "board and HAL",
        &[
            "board",
            "stm32f4xx_hal",
            "stm32_metapac",
            "cortex_m",
            "cortex_m_rt",
        ],
    ),
    part(
        "tasks and RTIC",
        &["main", "reflex::tasks", "rtic", "rtic_core", "rtic_common"],
    ),
    part(
        "clock",
        &[
            "board::clock",
            "rtic_time",
            "rtic_monotonics",
            "portable_atomic",
            "fugit",
        ],
    ),
    part("settings", &["settings", "board::settings_block", "crc"]),
];

/// What is called from everywhere: where it is inlined, it counts for its callers.
const SHARED: [Part; 1] = [part(
    "mathematics",
    &["reflex::math", "libm", "compiler_builtins", "core"],
)];

/// The names of all parts, as they are listed.
pub fn flash_part_names() -> impl Iterator<Item = &'static str> {
    let parts = FLASH_PARTS.iter().chain(&SHARED).map(|part| part.name);
    parts.chain([CONSTANTS, REST])
}

/// Bytes of flash by part; together all that a firmware takes.
///
/// # Errors
/// Debug information that cannot be read.
pub fn flash_of_parts(firmware: &Firmware) -> Result<BTreeMap<&'static str, u64>> {
    let file = object::File::parse(&*firmware.bytes).context("the firmware is not an ELF file")?;
    let mut frames = Frames::of(&firmware.bytes)?;
    let mut bytes: BTreeMap<&str, u64> = BTreeMap::new();
    let code = file
        .sections()
        .filter(|section| section.kind() == SectionKind::Text);
    let halves = code.flat_map(|section| {
        let end = section.address() + section.size();
        (section.address()..end).step_by(2)
    });
    for address in halves {
        let frames = frames.at(address as u32)?;
        let part = match part_among(&FLASH_PARTS, &frames) {
            (REST, _) => part_among(&SHARED, &frames).0,
            (part, _) => part,
        };
        *bytes.entry(part).or_default() += 2;
    }
    let code: u64 = bytes.values().sum();
    bytes.insert(
        CONSTANTS,
        u64::from(firmware.sizes.flash_bytes).saturating_sub(code),
    );
    Ok(bytes)
}
