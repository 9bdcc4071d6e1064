//! The unmodified firmware at rest, on a board whose sensors' wires are disturbed.

use std::sync::{Arc, LazyLock, Mutex};

use chip_models::{ChipOptions, I2cChip, SharedChips, Stimulus, StimulusSource};
use emulated_board::emulated::{EmulatedBoard, Sensors};
use emulated_board::{Board, BusFault, Disturbance, Edge, Elf, LogLine, Observer, Options};
use emulated_board::{Outcome, SensorLine};
use hil_tests::firmware::Firmware;
use hil_tests::logics::LogicName;
use hil_tests::progress::Silent;
use reflex::app::{Call, Fault, Stamped};

/// Nanoseconds of a millisecond.
pub const MS: u64 = 1_000_000;
/// The firmware has booted and samples by then: in a burst, and between two of them.
pub const FROM_NS: u64 = 200 * MS;
pub const IDLE_NS: u64 = FROM_NS + 600_000;

static FIRMWARE: LazyLock<Arc<Elf>> = LazyLock::new(|| {
    let firmware = Firmware::build(LogicName::configured(), &mut Silent).expect("built");
    Arc::new(Elf::parse(firmware.bytes).expect("an ELF"))
});

/// What the firmware did, stamped in ns of the board's time.
#[derive(Default)]
pub struct Seen {
    undecoded: Vec<u8>,
    calls: Vec<Stamped>,
    edges: Vec<u64>,
    pub log: Vec<LogLine>,
}

impl Observer for Seen {
    fn calls(&mut self, _at_ns: u64, bytes: &[u8]) {
        self.undecoded.extend_from_slice(bytes);
        while let Ok((stamped, length)) = Stamped::decode(&self.undecoded) {
            self.calls.push(stamped);
            self.undecoded.drain(..length);
        }
    }

    fn edge(&mut self, edge: Edge) {
        if edge.rising && edge.line == SensorLine::ImuReady {
            self.edges.push(edge.at_ns);
        }
    }

    fn log(&mut self, line: &LogLine) {
        self.log.push(line.clone());
    }
}

impl Seen {
    /// From the firmware's clock to the board's: no sample is stamped before its edge.
    fn clock_ns(&self) -> u64 {
        let of_first = self.samples_us().next().expect("samples") * 1000;
        let edge = self.edges.iter().find(|&&at_ns| at_ns >= of_first);
        edge.map_or(0, |edge| edge - of_first)
    }

    fn samples_us(&self) -> impl Iterator<Item = u64> {
        let samples = self
            .calls
            .iter()
            .filter(|call| matches!(call.call, Call::Imu(_)));
        samples.map(|stamped| stamped.at.ticks())
    }

    /// Instants of samples.
    pub fn samples(&self) -> Vec<u64> {
        let clock_ns = self.clock_ns();
        self.samples_us().map(|us| us * 1000 + clock_ns).collect()
    }

    /// Instants of faults, with what they are.
    pub fn faults(&self) -> Vec<(u64, Fault)> {
        let clock_ns = self.clock_ns();
        let faults = self.calls.iter().filter_map(|stamped| match stamped.call {
            Call::Fault(fault) => Some((stamped.at.ticks() * 1000 + clock_ns, fault)),
            _ => None,
        });
        faults.collect()
    }

    /// How often a fault came.
    pub fn count(&self, of: Fault) -> usize {
        self.faults()
            .iter()
            .filter(|(_, fault)| *fault == of)
            .count()
    }

    /// When a fault came first from an instant on, in ms behind it.
    pub fn first_fault_ms(&self, from_ns: u64) -> Option<f64> {
        let faults = self.faults();
        let first = faults.iter().find(|(at_ns, _)| *at_ns >= from_ns)?;
        Some(ms(first.0 - from_ns))
    }

    /// When samples came again behind an instant, in ms: the first of ten in a row.
    pub fn back_ms(&self, from_ns: u64) -> Option<f64> {
        let samples = self.samples();
        let behind = samples.partition_point(|&at_ns| at_ns < from_ns);
        let regular = |ten: &&[u64]| ten.windows(2).all(|pair| pair[1] - pair[0] < 1_600_000);
        let ten = samples[behind..].windows(10).find(regular)?;
        Some(ms(ten[0] - from_ns))
    }

    /// The longest time without a sample that ends behind an instant, in ms.
    pub fn longest_gap_ms(&self, from_ns: u64) -> f64 {
        let samples = self.samples();
        let gaps = samples.windows(2).filter(|pair| pair[1] > from_ns);
        gaps.map(|pair| ms(pair[1] - pair[0])).fold(0.0, f64::max)
    }
}

fn ms(ns: u64) -> f64 {
    ns as f64 * 1e-6
}

/// Chips that lie still.
pub fn chips() -> SharedChips {
    let source: Arc<dyn StimulusSource> = Arc::new(|_| Stimulus {
        specific_force: [0.0, 0.0, 9.80665],
        magnetic_field: [0.2, 0.0, 0.4],
        temperature_c: 25.0,
        ..Stimulus::default()
    });
    SharedChips::feeling(&source, ChipOptions::default())
}

/// A board that runs.
pub struct Running {
    board: Box<EmulatedBoard>,
    pub seen: Seen,
}

impl Running {
    /// Boots the firmware, with another inertial sensor where one is given.
    pub fn new(
        chips: &SharedChips,
        imu: Option<Arc<Mutex<dyn I2cChip>>>,
        script: &[BusFault],
    ) -> Self {
        let mut sensors = Sensors::from(chips);
        if let Some(imu) = imu {
            sensors.imu = imu;
        }
        let options = Options {
            bus_faults: script.to_vec(),
            ..Options::default()
        };
        let board = EmulatedBoard::boot(&FIRMWARE, sensors, &options).expect("booted");
        Self {
            board: Box::new(board),
            seen: Seen::default(),
        }
    }

    /// Runs on until an instant.
    pub fn until(&mut self, at_ns: u64) {
        let ran = self.board.run_until(at_ns, &mut self.seen);
        ran.unwrap_or_else(|fault| panic!("{fault}"));
    }

    /// Ends the run.
    pub fn end(self) -> (Seen, Outcome) {
        let outcome = self
            .board
            .finish()
            .unwrap_or_else(|fault| panic!("{fault}"));
        (self.seen, outcome)
    }
}

/// Disturbs the wires from an instant on for a time, and 50 ms longer lets the firmware run.
pub fn disturbed(what: &[Disturbance], from_ns: u64, for_ns: u64) -> (Seen, Outcome) {
    let fault = |&what| BusFault {
        what,
        from_ns,
        until_ns: from_ns.saturating_add(for_ns),
    };
    let script: Vec<_> = what.iter().map(fault).collect();
    let mut running = Running::new(&chips(), None, &script);
    let disturbed_ns = for_ns.min(150 * MS);
    running.until(from_ns + disturbed_ns + 50 * MS);
    running.end()
}
