//! The parts that instructions are counted for, by modules.

use std::rc::Rc;

use super::frames::Frame;

/// A part of the firmware.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Part {
    /// Its name.
    pub name: &'static str,
    /// Its modules, with those below them that no part names by a longer path.
    modules: &'static [&'static str],
    /// Only where this function called, whose part comes before others of the same modules.
    within: Option<&'static str>,
}

/// What runs for no part of the table.
pub const REST: &str = "rest";

/// Modules of the control logics.
const LOGICS: &[&str] = &[
    "reflex::graph",
    "reflex::control",
    "reflex::airframe",
    "reflex::estimate",
];

/// Every part, as it is listed.
///
/// Modules that everybody calls are in none: vectors, units, `core`, the library of floats. What they
/// execute is for the function that called them.
pub const PARTS: [Part; 17] = [
    part("foresight", LOGICS).within("foresee"),
    part("graph", LOGICS),
    part(
        "arrival and decoding",
        &[
            "reflex::estimate::arrival",
            "reflex::estimate::calibration",
            "reflex::app::sensing",
            "reflex::tasks::imu",
            "reflex::tasks::mpu6050",
            "drivers::mpu6050",
        ],
    ),
    part("comparisons", &["reflex::reactive"]),
    part(
        "schedule",
        &[
            "reflex::reactive::exploration",
            "reflex::reactive::hyperperiod",
            "reflex::reactive::schedule",
            "reflex::reactive::supervisor",
        ],
    ),
    part(
        "labels and refits",
        &[
            "reflex::reactive::fit",
            "reflex::reactive::judgement",
            "reflex::reactive::labels",
            "reflex::reactive::logistic",
            "reflex::reactive::outcome",
            "reflex::reactive::shadow_holds",
        ],
    ),
    part(
        "door and safety",
        &[
            "reflex::app",
            "reflex::safety",
            "reflex::battery",
            "reflex::reset",
        ],
    ),
    part(
        "call recorder",
        &["reflex::app::call", "reflex::app::record", "board::calls"],
    ),
    part("I2C engine", &["board::reflex_f427::i2c"]),
    part("SPI", &["board::reflex_f427::spi"]),
    part(
        "chips",
        &[
            "reflex::app::chips",
            "reflex::tasks::chips",
            "reflex::tasks::lsm303agr",
            "drivers::lsm303agr",
        ],
    ),
    part(
        "link",
        &[
            "reflex::link",
            "reflex::tasks::link",
            "board::reflex_f427::link_port",
        ],
    ),
    part(
        "motors",
        &[
            "reflex::airframe::pulse",
            "reflex::safety::motor_gate",
            "board::reflex_f427::motors",
        ],
    ),
    part("log", &["defmt", "defmt_rtt"]),
    part(
        "clock and timers",
        &[
            "board::clock",
            "rtic_time",
            "rtic_monotonics",
            "portable_atomic",
        ],
    ),
    part(
        "idle",
        &["main", "board", "reflex::app", "reflex::reactive"],
    )
    .within("idle"),
    part(
        "tasks and locks",
        &["main", "board", "reflex::tasks", "rtic"],
    ),
];

pub(super) const fn part(name: &'static str, modules: &'static [&'static str]) -> Part {
    Part {
        name,
        modules,
        within: None,
    }
}

impl Part {
    const fn within(self, function: &'static str) -> Self {
        Self {
            within: Some(function),
            ..self
        }
    }

    /// Length of the path by which the part names a module, if it does.
    fn names(&self, module: &str) -> Option<usize> {
        let named = |path: &&&str| {
            let below = module.strip_prefix(**path);
            below.is_some_and(|below| below.is_empty() || below.starts_with("::"))
        };
        let paths = self.modules.iter().filter(named);
        paths.map(|path| path.len()).max()
    }

    /// Whether the part's function is among these, where it has one.
    fn is_within(&self, frames: &[Rc<Frame>]) -> bool {
        let is = |frame: &Rc<Frame>, name| frame.function.rsplit("::").next() == Some(name);
        self.within
            .is_none_or(|name| frames.iter().any(|frame| is(frame, name)))
    }
}

/// The part that a stack of functions, outermost first, executes for, and the function of it that it is in.
///
/// That is the innermost function of a module that some part names; without any, the rest and the
/// innermost of all.
pub(super) fn part_of(frames: &[Rc<Frame>]) -> (&'static str, &str) {
    part_among(&PARTS, frames)
}

/// As [`part_of`], among other parts.
pub(super) fn part_among<'f>(parts: &[Part], frames: &'f [Rc<Frame>]) -> (&'static str, &'f str) {
    let innermost = (0..frames.len()).rev().find_map(|place| {
        let frame = &frames[place];
        let named = parts.iter().filter_map(|part| {
            let length = part.names(&frame.module)?;
            let within = part.is_within(&frames[..=place]);
            within.then_some(((length, part.within.is_some()), part.name))
        });
        let (_, name) = named.max_by_key(|(rank, _)| *rank)?;
        Some((name, frame.function.as_str()))
    });
    innermost.unwrap_or((
        REST,
        frames.last().map_or("unknown", |frame| &frame.function),
    ))
}
