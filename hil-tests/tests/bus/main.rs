//! The inertial sensor's bus and line go wrong: noticed within, back within.
//!
//! The unmodified firmware runs at rest on the emulated board. `cargo test` with `--nocapture` prints
//! the figures.

mod board;

use board::{FROM_NS, IDLE_NS, MS, Running, Seen, chips, disturbed};
use chip_models::{Chip, ChipOptions, I2cChip, Mpu6050, Stimulus, StimulusSource};
use emulated_board::Disturbance::{self, *};
use emulated_board::Outcome;
use emulated_board::SensorLine::ImuReady;
use reflex::app::Fault;
use std::sync::{Arc, Mutex};

const FOR_EVER: u64 = u64::MAX - FROM_NS;

/// Bounds in ms: until the first fault is told, and from the disturbance's end until samples come
/// regularly again; none where they never do.
#[derive(Clone, Copy)]
struct Bounds {
    noticed: f64,
    back: Option<f64>,
}

/// Busy share of the core while disturbed.
fn load(outcome: &Outcome) -> f64 {
    outcome.load.busy_fraction(FROM_NS)
}

fn check(what: &[Disturbance], from_ns: u64, for_ns: u64, bounds: Bounds) -> (Seen, Outcome) {
    let (seen, outcome) = disturbed(what, from_ns, for_ns);
    let noticed = seen.first_fault_ms(from_ns);
    let back = match bounds.back {
        Some(_) if for_ns == FOR_EVER => seen.back_ms(from_ns),
        _ => seen.back_ms(from_ns.saturating_add(for_ns)),
    };
    let faults = seen.faults();
    let mut kinds: Vec<_> = faults
        .iter()
        .map(|(_, fault)| format!("{fault:?}"))
        .collect();
    kinds.sort();
    kinds.dedup();
    let millis =
        |after: Option<f64>| after.map_or("never".into(), |after| format!("{after:.2} ms"));
    println!(
        "{what:?} {}: noticed {}, back {}, gap {:.1} ms, load {:.1} %, {}",
        match for_ns {
            FOR_EVER => "for ever".into(),
            ns => format!("for {} ms", ns / MS),
        },
        millis(noticed),
        millis(back),
        seen.longest_gap_ms(from_ns),
        100.0 * load(&outcome),
        kinds.join(" ")
    );
    for line in &seen.log {
        println!("    {line}");
    }
    assert!(
        noticed.is_some_and(|after| after <= bounds.noticed),
        "noticed {noticed:?}"
    );
    match bounds.back {
        Some(most) => assert!(back.is_some_and(|after| after <= most), "back {back:?}"),
        None => assert_eq!(back, None),
    }
    (seen, outcome)
}

/// One test per scenario: they run side by side and fail by name.
macro_rules! scenarios {
    ($($name:ident: $what:expr, $from_ns:expr, $for_ns:expr, $noticed:literal, $back:expr;)*) => {
        $(#[test]
        fn $name() {
            let bounds = Bounds {
                noticed: $noticed,
                back: $back,
            };
            check(&$what, $from_ns, $for_ns, bounds);
        })*
    };
}

scenarios! {
    nobody_acknowledges_for_20_ms: [NoAcknowledge], FROM_NS, 20 * MS, 2.0, Some(5.0);
    nobody_acknowledges_for_ever: [NoAcknowledge], FROM_NS, FOR_EVER, 2.0, None;
    arbitration_is_lost_for_3_ms: [ArbitrationLost], FROM_NS, 3 * MS, 2.0, Some(5.0);
    sda_is_held_for_50_ms: [DataHeld], FROM_NS, 50 * MS, 2.0, Some(5.0);
    sda_is_held_from_a_pause_on: [DataHeld], IDLE_NS, 50 * MS, 2.0, Some(5.0);
    sda_is_held_for_ever: [DataHeld], FROM_NS, FOR_EVER, 2.0, None;
    sda_is_held_by_a_chip_that_lost_count:
        [DataHeldByChip { clocks: 7 }], IDLE_NS, FOR_EVER, 2.0, Some(5.0);
    scl_is_held_for_50_ms: [ClockHeld], FROM_NS, 50 * MS, 3.0, Some(5.0);
    scl_is_held_for_ever: [ClockHeld], FROM_NS, FOR_EVER, 3.0, None;
    both_wires_are_held_for_50_ms: [DataHeld, ClockHeld], FROM_NS, 50 * MS, 3.0, Some(5.0);
    a_stream_fails_for_3_ms: [DmaError], FROM_NS, 3 * MS, 3.0, Some(5.0);
    a_stream_that_stops_late_when_cut_off_raises_no_storm:
        [ClockHeld, DmaLate { by_ns: 200_000 }], FROM_NS, 3 * MS, 3.0, Some(5.0);
    the_line_is_stuck_high:
        [LineHeld { line: ImuReady, high: true }], FROM_NS, FOR_EVER, 3.6, Some(3.6);
    the_line_is_stuck_low:
        [LineHeld { line: ImuReady, high: false }], FROM_NS, FOR_EVER, 3.6, Some(3.6);
    the_line_is_stuck_for_20_ms:
        [LineHeld { line: ImuReady, high: false }], FROM_NS, 20 * MS, 3.6, Some(2.0);
}

#[test]
fn a_spurious_bus_error_is_cleared_and_no_burst_is_lost() {
    let bounds = Bounds {
        noticed: 2.0,
        back: Some(1.1),
    };
    let (seen, outcome) = check(&[BusError], FROM_NS, FOR_EVER, bounds);
    assert!(seen.longest_gap_ms(FROM_NS) < 1.1);
    assert_eq!(seen.count(Fault::ImuBus), 0);
    assert!(load(&outcome) < 0.03);
}

#[test]
fn a_slower_bus_and_a_late_dma_cost_no_sample_while_a_burst_fits() {
    for what in [Stretched { percent: 150 }, DmaLate { by_ns: 20_000 }] {
        let (seen, _) = disturbed(&[what], FROM_NS, FOR_EVER);
        println!("{what:?}: gap {:.2} ms", seen.longest_gap_ms(FROM_NS));
        assert!(seen.longest_gap_ms(FROM_NS) < 1.1);
        assert_eq!(seen.faults(), []);
    }
}

#[test]
fn of_a_bus_on_which_a_burst_takes_longer_than_a_sample_every_other_one_is_left() {
    let (seen, _) = disturbed(&[Stretched { percent: 250 }], FROM_NS, FOR_EVER);
    println!("x2.5: gap {:.2} ms", seen.longest_gap_ms(FROM_NS));
    assert!(seen.longest_gap_ms(FROM_NS) < 2.2);
    assert!(seen.count(Fault::ImuOverrun) > 100);
    assert_eq!(seen.count(Fault::ImuBus), 0);
}

#[test]
fn a_storm_on_the_line_costs_a_bounded_share_and_few_samples() {
    for hz in [5_000, 20_000] {
        let period_ns = 1_000_000_000 / hz;
        let what = LineStorm {
            line: ImuReady,
            period_ns,
        };
        let (_, quiet) = disturbed(&[what], FROM_NS, 0);
        let bounds = Bounds {
            noticed: 2.0,
            back: Some(3.0),
        };
        let (seen, outcome) = check(&[what], FROM_NS, FOR_EVER, bounds);
        let more = load(&outcome) - load(&quiet);
        println!("storm of {hz} Hz: {:.2} % of the core", 100.0 * more);
        assert!(more < 0.02, "{more}");
        assert!(seen.longest_gap_ms(FROM_NS) < 2.2);
    }
}

#[test]
fn a_chip_that_forgot_its_registers_is_armed_again_within_two_failsafe_periods() {
    let chips = chips();
    let mut running = Running::new(&chips, None, &[]);
    running.until(FROM_NS);
    chips.imu.lock().unwrap().brown_out(FROM_NS);
    running.until(FROM_NS + 400 * MS);
    let (seen, _) = running.end();
    let back = seen.back_ms(FROM_NS);
    println!(
        "brown-out: noticed {:.2?} ms, back {back:.2?} ms",
        seen.first_fault_ms(FROM_NS)
    );
    for line in &seen.log {
        println!("    {line}");
    }
    let two_periods_ms = reflex::config::SETTINGS.failsafe.ticks() as f64 * 2e-3;
    assert!(back.is_some_and(|after| after < two_periods_ms.min(20.0)));
}

/// A chip whose inside stands still: its registers answer, but it samples nothing until it is reset.
struct Wedged {
    chip: Mpu6050,
    from_ns: u64,
    written: Vec<u8>,
    is_reset: bool,
}

impl Wedged {
    /// The time inside.
    fn inside(&self, now_ns: u64) -> u64 {
        match self.is_reset {
            true => now_ns,
            false => now_ns.min(self.from_ns),
        }
    }
}

impl Chip for Wedged {
    fn advance(&mut self, now_ns: u64) {
        self.chip.advance(self.inside(now_ns));
    }
    fn next_event(&self) -> u64 {
        match self.chip.next_event() {
            next_ns if self.is_reset || next_ns < self.from_ns => next_ns,
            _ => u64::MAX,
        }
    }
    fn interrupt(&self) -> bool {
        self.chip.interrupt()
    }
}

impl I2cChip for Wedged {
    fn start(&mut self, now_ns: u64, address: u8, read: bool) -> bool {
        self.written.clear();
        self.chip.start(self.inside(now_ns), address, read)
    }
    fn write(&mut self, now_ns: u64, byte: u8) -> bool {
        const DEVICE_RESET: [u8; 2] = [0x6B, 0x80];
        self.written.push(byte);
        self.is_reset |= now_ns > self.from_ns && self.written == DEVICE_RESET;
        self.chip.write(self.inside(now_ns), byte)
    }
    fn read(&mut self, now_ns: u64, last: bool) -> u8 {
        self.chip.read(self.inside(now_ns), last)
    }
    fn stop(&mut self, now_ns: u64) {
        self.chip.stop(self.inside(now_ns));
    }
}

#[test]
fn a_chip_that_answers_but_samples_no_more_is_reset() {
    let source: Arc<dyn StimulusSource> = Arc::new(|_| Stimulus::default());
    let wedged = Wedged {
        chip: Mpu6050::new(source, ChipOptions::default()),
        from_ns: FROM_NS,
        written: Vec::new(),
        is_reset: false,
    };
    let imu: Arc<Mutex<dyn I2cChip>> = Arc::new(Mutex::new(wedged));
    let mut running = Running::new(&chips(), Some(imu), &[]);
    running.until(FROM_NS + 600 * MS);
    let (seen, _) = running.end();
    let back = seen.back_ms(FROM_NS);
    println!(
        "wedged: noticed {:.2?} ms, back {back:.2?} ms",
        seen.first_fault_ms(FROM_NS)
    );
    for line in &seen.log {
        println!("    {line}");
    }
    assert!(back.is_some_and(|after| after < 300.0));
}
