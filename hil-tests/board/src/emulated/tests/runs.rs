//! Whole runs: what is reported, and the name of every fault.

use std::sync::Arc;

use super::program::{
    CALLS, CODE, CRASH, HELLO, PANICKED, SETTINGS, STACK, assembled, logging, writing, writing_then,
};
use super::{Pulse, sensors};
use crate::emulated::EmulatedBoard;
use crate::{
    Board, Came, Edge, Elf, Fault, FaultKind, Feed, Hit, LogLine, MotorWrite, Observer, Options,
    Outcome, SensorLine, Watched,
};

/// Everything that a run showed.
#[derive(Debug, Default, PartialEq)]
struct Observed {
    motors: Vec<MotorWrite>,
    edges: Vec<Edge>,
    calls: Vec<(u64, Vec<u8>)>,
    hits: Vec<Hit>,
    log: Vec<String>,
    progress: u64,
}

impl Observer for Observed {
    fn motors(&mut self, write: &MotorWrite) {
        self.motors.push(*write);
    }
    fn edge(&mut self, edge: Edge) {
        self.edges.push(edge);
    }
    fn calls(&mut self, at_ns: u64, bytes: &[u8]) {
        self.calls.push((at_ns, bytes.to_vec()));
    }
    fn hit(&mut self, hit: Hit) {
        self.hits.push(hit);
    }
    fn log(&mut self, line: &LogLine) {
        self.log.push(line.to_string());
    }
    fn progress(&mut self, at_ns: u64, _instructions: u64) {
        self.progress = at_ns;
    }
}

const MILLISECOND: u64 = 1_000_000;

fn run(elf: Elf, options: &Options, until_ns: u64) -> (Observed, Result<Outcome, Fault>) {
    let imu = Pulse {
        from_ns: 5_000,
        to_ns: 55_000,
        now_ns: 0,
    };
    let mut board = EmulatedBoard::boot(&Arc::new(elf), sensors(imu), options).unwrap();
    let mut seen = Observed::default();
    let ran = board.run_until(until_ns, &mut seen);
    let outcome = ran.and_then(|()| Box::new(board).finish());
    (seen, outcome)
}

fn fault_of(elf: Elf) -> FaultKind {
    run(elf, &Options::default(), 700 * MILLISECOND)
        .1
        .unwrap_err()
        .kind
}

/// Clock, mode 1 with preload, enable, pulse, count: motor 1 is driven.
const MOTOR_ON: [(u32, u32); 5] = [
    (0x4002_3840, 1 << 1),
    (0x4000_0418, 0x68),
    (0x4000_0420, 1),
    (0x4000_0400, 0x81),
    (0x4000_0434, 160),
];

#[test]
fn settings_are_there_before_the_first_instruction_and_calls_are_read() {
    // ldr r0, =settings; ldr r1, [r0]; ldr r2, =calls; str r1, [r2, #4];
    // movs r3, #4; str r3, [r2]; wfi; b .-2
    let code = [
        0x4803, 0x6801, 0x4A03, 0x6051, 0x2304, 0x6013, 0xBF30, 0xE7FD,
    ];
    let elf = assembled(&code, &[SETTINGS, CALLS]);
    let options = Options {
        settings: Some(vec![1, 2, 3, 4]),
        ..Options::default()
    };
    let (seen, outcome) = run(elf, &options, 3 * MILLISECOND);
    outcome.unwrap();
    assert_eq!(seen.calls, [(MILLISECOND, vec![1, 2, 3, 4])]);
    assert_eq!(seen.progress, 3 * MILLISECOND);
}

#[test]
fn each_arrival_is_fed_the_next_block_until_there_is_none() {
    // ldr r0, =settings; ldr r2, =calls; movs r3, #0; loop: ldr r1, [r0]; adds r3, #4;
    // str r1, [r2, r3]; cmp r3, #12; bne loop; str r3, [r2]; wfi; b .-2; nop
    let code = [
        0x4805, 0x4A06, 0x2300, 0x6801, 0x3304, 0x50D1, 0x2B0C, 0xD1FA, 0x6013, 0xBF30, 0xE7FD,
        0xBF00,
    ];
    let elf = assembled(&code, &[SETTINGS, CALLS]);
    let options = Options {
        feed: Some(Feed {
            asks: Watched::Address(CODE + 6),
            address: SETTINGS,
            blocks: vec![vec![1, 2, 3, 4], vec![5, 6, 7, 8]],
        }),
        ..Options::default()
    };
    let (seen, outcome) = run(elf, &options, 2 * MILLISECOND);
    outcome.unwrap();
    let bytes = vec![1, 2, 3, 4, 5, 6, 7, 8, 5, 6, 7, 8];
    assert_eq!(seen.calls, [(MILLISECOND, bytes)]);
}

#[test]
fn pins_and_motors_are_reported_at_their_instants_and_again_the_same() {
    let observed = || run(writing(&MOTOR_ON), &Options::default(), 2 * MILLISECOND).0;
    let seen = observed();
    let [rise, fall] = seen.edges[..] else {
        panic!("{seen:?}")
    };
    let line = SensorLine::ImuReady;
    assert_eq!(
        rise,
        Edge {
            at_ns: 5_000,
            line,
            rising: true
        }
    );
    assert_eq!(
        fall,
        Edge {
            at_ns: 55_000,
            line,
            rising: false
        }
    );
    assert_eq!(seen.motors.len(), 1);
    assert_eq!(seen.motors[0].pulse_ns[0], 10_000, "160 ticks of 16 MHz");
    assert_eq!(seen.motors[0].driven, 1);
    assert_eq!(observed(), seen);
}

#[test]
fn the_log_is_decoded_with_the_strings_of_the_firmware() {
    let (seen, outcome) = run(writing(&logging(HELLO)), &Options::default(), MILLISECOND);
    assert_eq!(seen.log, ["info  hello"]);
    assert_eq!(outcome.unwrap().damaged_log_frames, 0);
}

#[test]
fn a_damaged_log_frame_is_counted_and_passed_over() {
    let damaged = writing(&logging(0x00_7E_7F));
    let (seen, outcome) = run(damaged, &Options::default(), MILLISECOND);
    assert_eq!(seen.log, [] as [String; 0]);
    assert_eq!(outcome.unwrap().damaged_log_frames, 1);
}

#[test]
fn a_crash_after_a_panic_is_that_panic() {
    let fault = fault_of(writing_then(&logging(PANICKED), CRASH));
    assert_eq!(fault, FaultKind::Panic("x.rs:1: sorry".into()));
}

#[test]
fn a_crash_without_a_logged_error_has_nothing_to_add() {
    let fault = fault_of(writing_then(&logging(HELLO), CRASH));
    assert_eq!(
        fault,
        FaultKind::HardFault { detail: None },
        "no error was logged"
    );
}

#[test]
fn a_watched_symbol_reports_time_and_instructions() {
    let options = Options {
        watches: vec!["HardFault".into()],
        ..Options::default()
    };
    let (seen, fault) = run(assembled(&[0xBF00, 0xDE00], &[]), &options, MILLISECOND);
    assert_eq!(fault.unwrap_err().kind.name(), "hard_fault");
    assert_eq!(seen.hits[0].watch, 0);
    assert!(seen.hits[0].instructions <= 2, "{seen:?}");
}

#[test]
fn an_unknown_watch_is_refused_by_name() {
    let options = Options {
        watches: vec!["nowhere".into()],
        ..Options::default()
    };
    let elf = Arc::new(writing(&[]));
    let refused = EmulatedBoard::boot(&elf, sensors(Pulse::default()), &options);
    assert_eq!(
        refused.err().unwrap().to_string(),
        "the firmware has no symbol nowhere"
    );
}

#[test]
fn a_sleeping_core_is_not_busy_and_leaves_its_stack_alone() {
    let (_, outcome) = run(writing(&[]), &Options::default(), 100 * MILLISECOND);
    let outcome = outcome.unwrap();
    assert!(outcome.load.busy_fraction(0) < 1e-4);
    assert_eq!((outcome.stack.used, outcome.stack.available), (0, 0x400));
    assert_eq!(outcome.ended_ns, 100 * MILLISECOND);
}

#[test]
fn an_undefined_instruction_is_a_hard_fault() {
    assert_eq!(
        fault_of(assembled(&[0xDE00, 0xBF00], &[])),
        FaultKind::HardFault { detail: None }
    );
}

#[test]
fn an_interrupt_that_nobody_handles_is_named() {
    // SysTick: reload, counter, and on with its interrupt.
    let tick = [(0xE000_E014, 1000), (0xE000_E018, 0), (0xE000_E010, 7)];
    assert_eq!(fault_of(writing(&tick)), FaultKind::UnhandledInterrupt);
}

#[test]
fn a_bad_pointer_is_a_hard_fault_that_names_the_address() {
    let fault = fault_of(writing(&[(0x3000_0000, 1)])).to_string();
    assert!(
        fault.starts_with("HardFault in the firmware: no memory at 0x30000000"),
        "{fault}"
    );
}

#[test]
fn a_stack_that_grows_too_deep_is_an_overflow() {
    // push {r0-r7}, without end
    let available = STACK.end - STACK.start;
    assert_eq!(
        fault_of(assembled(&[0xB4FF, 0xE7FD], &[])),
        FaultKind::StackOverflow { available }
    );
}

#[test]
fn an_access_between_peripherals_is_unmapped() {
    let fault = fault_of(writing(&[(0x4008_0000, 1)]));
    assert!(
        matches!(
            fault,
            FaultKind::UnmappedAccess {
                address: 0x4008_0000,
                ..
            }
        ),
        "{fault}"
    );
}

#[test]
fn an_access_to_an_unclocked_peripheral_is_refused() {
    let fault = fault_of(writing(&[(0x4001_3000, 1)]));
    assert!(
        matches!(
            fault,
            FaultKind::RefusedAccess {
                address: 0x4001_3000,
                ..
            }
        ),
        "{fault}"
    );
}

#[test]
fn a_watchdog_that_is_not_fed_resets_the_board() {
    let watchdog = [(0x4000_3000, 0xCCCC)];
    assert_eq!(fault_of(writing(&watchdog)), FaultKind::WatchdogReset);
}

#[test]
fn a_reset_by_the_firmware_is_unexpected() {
    let fault = fault_of(writing(&[(0xE000_ED0C, 0x05FA_0004)]));
    assert_eq!(fault, FaultKind::Reset("asked for by the firmware".into()));
}

#[test]
fn firmware_that_never_drives_a_motor_never_started() {
    let options = Options {
        boot_limit_ns: 10 * MILLISECOND,
        ..Options::default()
    };
    let fault = run(writing(&[]), &options, 20 * MILLISECOND).1.unwrap_err();
    assert_eq!(fault.kind.name(), "never_started");
    assert_eq!(fault.at_ns, 11 * MILLISECOND);
}

#[test]
fn firmware_that_stops_writing_hangs() {
    let options = Options {
        silence_limit_ns: 10 * MILLISECOND,
        ..Options::default()
    };
    let fault = run(writing(&MOTOR_ON), &options, 20 * MILLISECOND)
        .1
        .unwrap_err();
    assert_eq!(fault.kind.name(), "silent");
}

#[test]
fn motors_on_unconfigured_pins_are_a_wiring_fault() {
    let fault = fault_of(writing(&MOTOR_ON)).to_string();
    assert!(
        fault.contains("PC6 (TIM3_CH1) is an input, not AF2 push-pull"),
        "{fault}"
    );
}

#[test]
fn a_call_log_that_outruns_its_reader_is_a_fault() {
    let fault = fault_of(writing(&[(CALLS, 3_000)]));
    assert_eq!(fault, FaultKind::CallsLost { bytes: 952 });
}

#[test]
fn a_board_keeps_its_fault() {
    let elf = Arc::new(assembled(&[0xDE00, 0xBF00], &[]));
    let mut board =
        EmulatedBoard::boot(&elf, sensors(Pulse::default()), &Options::default()).unwrap();
    let first = board
        .run_until(MILLISECOND, &mut Observed::default())
        .unwrap_err();
    board.transmit(2 * MILLISECOND, b"too late");
    assert_eq!(
        board
            .run_until(3 * MILLISECOND, &mut Observed::default())
            .unwrap_err(),
        first
    );
    assert_eq!(Box::new(board).finish().unwrap_err(), first);
}

/// `bl` to `movs r0, #1; bx lr`, and a branch to itself behind it.
const CALLING: [u16; 6] = [0xF000, 0xF801, 0xE7FE, 0x2001, 0x4770, 0xBF00];

#[test]
fn every_instruction_is_counted_with_the_call_that_led_to_it() {
    let elf = Arc::new(assembled(&CALLING, &[]));
    let options = Options {
        flies: false,
        ..Options::default()
    };
    let mut board = EmulatedBoard::boot(&elf, sensors(Pulse::default()), &options).unwrap();
    board.count();
    board
        .run_until(MILLISECOND, &mut Observed::default())
        .unwrap();
    let outcome = Box::new(board).finish().unwrap();
    let tally = outcome.tally.unwrap();
    let call = Came::Call {
        caller: 0,
        at: CODE,
    };
    assert_eq!(tally.ways, [Came::Exception(0), call]);
    let counted = [(0, CODE), (0, CODE + 4), (1, CODE + 6), (1, CODE + 8)];
    assert_eq!(tally.counts, counted.map(|place| (place, 1)).into());
    assert_eq!((tally.instructions(), tally.executed), (4, 4));
    assert_eq!((tally.from_ns, tally.to_ns), (0, MILLISECOND));
}

#[test]
fn a_run_is_the_same_where_its_instructions_are_counted() {
    let run = |counts: bool| {
        let imu = Pulse {
            from_ns: 5_000,
            to_ns: 55_000,
            now_ns: 0,
        };
        let options = Options {
            flies: false,
            ..Options::default()
        };
        let elf = Arc::new(writing(&logging(HELLO)));
        let mut board = EmulatedBoard::boot(&elf, sensors(imu), &options).unwrap();
        if counts {
            board.count();
        }
        let mut seen = Observed::default();
        board.run_until(10 * MILLISECOND, &mut seen).unwrap();
        let outcome = Box::new(board).finish().unwrap();
        (seen, outcome.load.samples, outcome.tally)
    };
    let (plain, load, none) = run(false);
    let (counted, same, tally) = run(true);
    assert_eq!((plain, load), (counted, same));
    assert_eq!(none, None);
    let tally = tally.unwrap();
    assert!(tally.executed > 10, "{}", tally.executed);
    assert_eq!(tally.instructions(), tally.executed);
}
