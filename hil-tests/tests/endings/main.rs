//! However the firmware ends, motors stop at once and the next start knows why.
//!
//! The firmware is as it is flashed but for one vector: that of the IMU's interrupt leads through a few
//! instructions of the test's, which do what must not happen once a register has reached a value.

use std::sync::Arc;

use hil_tests::firmware::Firmware;
use hil_tests::ground_station::{DRONE, MILLISECOND_NS, arm, frame, heartbeat};
use hil_tests::logics::LogicName;
use hil_tests::progress::Silent;
use mavlink::dialects::common::{AttitudeTargetTypemask, MavMessage, SET_ATTITUDE_TARGET_DATA};
use object::{Object, ObjectSection};
use reflex::reset::{Ending, LastWords, Mode};

use chip_models::testing::{SECOND, real};
use chip_models::{SharedChips, Stimulus, StimulusSource};
use emulated_board::emulated::{EmulatedBoard, Sensors};
use emulated_board::{Board, Elf, Hit, LogLine, MotorWrite, Observer, Options};

/// The exception of `imu_ready`: vector EXTI0.
const IMU_READY: u16 = 16 + 6;
/// Memory that the firmware does not use: the end of RAM.
const STUB: u32 = 0x2002_F000;
/// The counter of the monotonic, us, and what it is compared with; RCC_CIR with the flag of the clock security system.
const CLOCK: u32 = 0x4000_0C24;
const CLOCK_COMPARE: u32 = 0x4000_0C38;
const CLOCK_INTERRUPTS: (u32, u32) = (0x4002_380C, 1 << 7);
/// When the firmware shall end, us of its clock: it is armed then, and motors turn.
const END_US: u32 = 2_000_000;
/// The shortest pulse, ns.
const SHORTEST_NS: u32 = 125_000;
const MOTORS: usize = 4;

/// What a firmware is made to do.
#[derive(Clone, Copy, Debug, PartialEq)]
enum Crime {
    /// Panics at a place in the source.
    Panic,
    /// Reads where nothing is.
    BadPointer,
    /// Pushes without end.
    Overflow,
    /// Pends NMI.
    Nmi,
    /// Pends an exception that has no handler.
    NoHandler,
    /// Never comes back.
    Hang,
}

/// `ldr r0, =register; ldr r0, [r0]; ldr r1, =mask; ands r0, r1; ldr r1, =limit; cmp r0, r1; bhs
/// crime; ldr r0, =handler; bx r0; crime: ldr r0, =first; ldr r1, =second; ...`
fn stub(
    crime: Crime,
    (register, mask, limit): (u32, u32, u32),
    handler: u32,
    elf: &Elf,
) -> Vec<u8> {
    let (deed, first, second): ([u16; 2], u32, u32) = match crime {
        // bx r1, with the place in r0
        Crime::Panic => ([0x4708, 0xBF00], place(elf), panics(elf)),
        // ldr r0, [r0]
        Crime::BadPointer => ([0x6800, 0xBF00], 0x3000_0000, 0),
        // push {r0-r7}; b .-2
        Crime::Overflow => ([0xB4FF, 0xE7FD], 0, 0),
        // str r1, [r0]: NMIPENDSET of ICSR
        Crime::Nmi => ([0x6001, 0xBF00], 0xE000_ED04, 1 << 31),
        // svc 0
        Crime::NoHandler => ([0xDF00, 0xBF00], 0, 0),
        // b .
        Crime::Hang => ([0xE7FE, 0xBF00], 0, 0),
    };
    let code = [
        0x4807, 0x6800, 0x4907, 0x4008, 0x4907, 0x4288, 0xD201, 0x4807, 0x4700, 0x4807, 0x4907,
        deed[0], deed[1], 0xE7FE, 0xBF00, 0xBF00,
    ];
    let words = [register, mask, limit, handler, first, second];
    let code = code.iter().flat_map(|half: &u16| half.to_le_bytes());
    let words = words.iter().flat_map(|word| word.to_le_bytes());
    code.chain(words).collect()
}

/// A function that panics at the place that it is given.
fn panics(elf: &Elf) -> u32 {
    elf.function(&["panic_const", "panic_const_async_fn_resumed"])
        .unwrap()
        | 1
}

/// A place in the source where the firmware might panic, as the compiler laid it out: address and
/// length of the file's name, line, column.
fn place(elf: &Elf) -> u32 {
    let file = object::File::parse(elf.bytes()).unwrap();
    let constants = file.section_by_name(".rodata").unwrap();
    let (start, data) = (constants.address() as u32, constants.data().unwrap());
    let named = |[address, length, line, column]: [u32; 4]| {
        let from = address.checked_sub(start)? as usize;
        let name = data.get(from..from + length as usize)?;
        let plausible = (5..80).contains(&length) && line < 5_000 && column < 200;
        Some(plausible && name.starts_with(b"src/") && name.ends_with(b".rs"))
    };
    let words = data
        .as_chunks()
        .0
        .iter()
        .map(|word| u32::from_le_bytes(*word));
    let words: Vec<u32> = words.collect();
    let at = words
        .array_windows()
        .position(|four| named(*four) == Some(true));
    start + 4 * at.expect("a place") as u32
}

/// What a run showed.
#[derive(Debug, Default)]
struct Seen {
    motors: Vec<MotorWrite>,
    hits: Vec<Hit>,
    log: Vec<String>,
}

impl Observer for Seen {
    fn motors(&mut self, write: &MotorWrite) {
        self.motors.push(*write);
    }
    fn hit(&mut self, hit: Hit) {
        self.hits.push(hit);
    }
    fn log(&mut self, line: &LogLine) {
        self.log.push(line.to_string());
    }
}

/// Lies still on a bench.
fn at_rest() -> Arc<dyn StimulusSource> {
    Arc::new(|_: u64| Stimulus {
        specific_force: [0.0, 0.0, -9.806_65],
        magnetic_field: [0.2, 0.0, 0.4],
        temperature_c: 25.0,
        ..Stimulus::default()
    })
}

fn thrust(share: f32) -> MavMessage {
    MavMessage::SET_ATTITUDE_TARGET(SET_ATTITUDE_TARGET_DATA {
        q: [1.0, 0.0, 0.0, 0.0],
        thrust: share,
        target_system: DRONE.0,
        target_component: DRONE.1,
        type_mask: AttitudeTargetTypemask::ATTITUDE_TARGET_TYPEMASK_BODY_ROLL_RATE_IGNORE
            | AttitudeTargetTypemask::ATTITUDE_TARGET_TYPEMASK_BODY_PITCH_RATE_IGNORE
            | AttitudeTargetTypemask::ATTITUDE_TARGET_TYPEMASK_BODY_YAW_RATE_IGNORE,
        ..SET_ATTITUDE_TARGET_DATA::DEFAULT
    })
}

/// What a ground station sends that arms the drone and has it climb.
fn fly(board: &mut EmulatedBoard, until_ns: u64) {
    for (sequence, at_ns) in (SECOND..until_ns)
        .step_by(50 * MILLISECOND_NS as usize)
        .enumerate()
    {
        let message = match at_ns {
            at_ns if at_ns == SECOND => heartbeat(),
            at_ns if at_ns == SECOND + 300 * MILLISECOND_NS => arm(0),
            at_ns if at_ns < SECOND + 500 * MILLISECOND_NS => thrust(0.0),
            _ => thrust(0.5),
        };
        board.transmit(at_ns, &frame(&message, sequence as u8));
    }
}

/// A drone that is armed, and then does something that it must not.
struct Bench {
    elf: Arc<Elf>,
    board: EmulatedBoard,
    seen: Seen,
}

impl Bench {
    /// A condition that nothing meets.
    const NEVER: (u32, u32, u32) = (CLOCK_INTERRUPTS.0, CLOCK_INTERRUPTS.1, 1 << 31);

    fn new(crime: Crime, condition: (u32, u32, u32)) -> Self {
        Self::started(crime, condition, Options::default())
    }

    /// On a board that is watched in some way.
    fn started(crime: Crime, condition: (u32, u32, u32), options: Options) -> Self {
        let firmware = Firmware::build(LogicName::configured(), &mut Silent).unwrap();
        let mut elf = Elf::parse(firmware.bytes).unwrap();
        let handler = elf.lead(IMU_READY, STUB).unwrap();
        let code = stub(crime, condition, handler, &elf);
        let options = Options {
            memory: vec![(STUB, code)],
            survives: true,
            flies: false,
            watches: vec!["HardFault".into()],
            ..options
        };
        let elf = Arc::new(elf);
        let sensors = Sensors::from(&SharedChips::feeling(&at_rest(), real(1)));
        let mut board = EmulatedBoard::boot(&elf, sensors, &options).unwrap();
        fly(&mut board, 4 * SECOND);
        Self {
            elf,
            board,
            seen: Seen::default(),
        }
    }

    /// One that never ends.
    fn resting() -> Self {
        Self::new(Crime::Hang, Self::NEVER)
    }

    fn after(crime: Crime) -> Self {
        Self::new(crime, (CLOCK, u32::MAX, END_US))
    }

    fn run(mut self, until_ns: u64) -> Self {
        self.board.run_until(until_ns, &mut self.seen).unwrap();
        self
    }

    fn word(&mut self, address: u32) -> u32 {
        let bytes = self.board.read(address, 4).unwrap();
        u32::from_le_bytes(bytes.try_into().unwrap())
    }

    fn last_words(&mut self) -> Option<LastWords> {
        let address = self.elf.symbol("REFLEX_LAST_WORDS").unwrap();
        let bytes = self.board.read(address, LastWords::LENGTH).unwrap();
        LastWords::from_bytes(bytes.as_slice().try_into().unwrap())
    }

    fn has_logged(&self, text: &str) -> bool {
        self.seen.log.iter().any(|line| line.contains(text))
    }

    /// The motors turned, and had the shortest pulse soon after the end.
    fn check_motors(&self) {
        let end_ns = self.seen.hits[0].at_ns;
        let (before, after): (Vec<&MotorWrite>, Vec<_>) = self
            .seen
            .motors
            .iter()
            .partition(|write| write.at_ns < end_ns);
        let turning = before.last().expect("motors were driven");
        assert!(
            turning.pulse_ns[..MOTORS]
                .iter()
                .all(|ns| *ns > SHORTEST_NS + 20_000),
            "{turning:?}"
        );
        let stopped = after.first().expect("motors were stopped");
        assert_eq!(stopped.pulse_ns[..MOTORS], [SHORTEST_NS; MOTORS]);
        let took_ns = stopped.at_ns - end_ns;
        assert!(took_ns < 2_000, "{took_ns} ns");
    }
}

/// What is left at once, and what the next start says.
fn check(crime: Crime, ending: Ending, exception: u8) {
    let mut bench = Bench::after(crime).run(2_100 * MILLISECOND_NS);
    bench.check_motors();
    let words = bench.last_words().expect("last words");
    assert_eq!(
        (words.ending, words.exception),
        (ending, exception),
        "{words:?}"
    );
    assert_eq!(words.mode, Mode::WarmUp);
    let stops = bench.seen.motors.len();
    let mut bench = bench.run(3 * SECOND);
    assert!(
        bench.has_logged("started by Watchdog, which nobody asked for"),
        "{:?}",
        bench.seen.log
    );
    let told = bench
        .seen
        .log
        .iter()
        .filter(|line| line.contains("ended by"));
    assert_eq!(
        told.count(),
        2,
        "at once and after the reset: {:?}",
        bench.seen.log
    );
    assert_eq!(bench.last_words(), None, "told once");
    let later = &bench.seen.motors[stops..];
    let still = |write: &&MotorWrite| write.pulse_ns[..MOTORS].iter().all(|ns| *ns <= SHORTEST_NS);
    assert_eq!(later.iter().filter(still).count(), later.len());
}

#[test]
fn a_panic_stops_the_motors_and_tells_its_place() {
    check(Crime::Panic, Ending::Panic, IMU_READY as u8);
    let bench = Bench::after(Crime::Panic).run(2_100 * MILLISECOND_NS);
    assert!(bench.has_logged("panicked at src/"), "{:?}", bench.seen.log);
}

#[test]
fn a_hard_fault_stops_the_motors() {
    check(Crime::BadPointer, Ending::HardFault, IMU_READY as u8);
}

#[test]
fn a_stack_that_overflows_meets_the_guard_and_stops_the_motors() {
    check(Crime::Overflow, Ending::StackOverflow, 3);
}

#[test]
fn an_interrupt_without_a_task_stops_the_motors() {
    check(Crime::NoHandler, Ending::Unhandled, 11);
}

#[test]
fn nmi_stops_the_motors() {
    check(Crime::Nmi, Ending::ClockLost, IMU_READY as u8);
}

#[test]
fn without_its_crystal_the_processor_makes_pulses_of_the_same_length() {
    let (register, flag) = CLOCK_INTERRUPTS;
    let mut bench = Bench::new(Crime::Nmi, (register, flag, flag)).run(2 * SECOND);
    bench.board.lose_crystal();
    let mut bench = bench.run(2_200 * MILLISECOND_NS);
    let last = bench.seen.motors.last().expect("motors were stopped");
    assert_eq!(last.pulse_ns[..MOTORS], [SHORTEST_NS; MOTORS]);
    assert_eq!(bench.last_words().expect("words").ending, Ending::ClockLost);
    // TIM3: no prescaler, 2 kHz of 16 MHz.
    assert_eq!(bench.word(0x4000_0428), 0);
    assert_eq!(bench.word(0x4000_042C), 7_999);
}

#[test]
fn a_task_that_never_comes_back_is_ended_by_the_watchdog() {
    let bench = Bench::after(Crime::Hang).run(3 * SECOND);
    assert!(
        bench.has_logged("started by Watchdog, which nobody asked for"),
        "{:?}",
        bench.seen.log
    );
}

#[test]
fn a_first_start_knows_its_supply_and_what_a_halt_does() {
    let mut bench = Bench::after(Crime::Hang).run(SECOND);
    assert!(
        bench.has_logged("started by PowerOn"),
        "{:?}",
        bench.seen.log
    );
    assert!(
        bench.has_logged("brown-out reset at None mV, not 2830"),
        "{:?}",
        bench.seen.log
    );
    // DBGMCU_APB1_FZ: TIM3 and TIM4 stand still, the watchdog goes on.
    assert_eq!(bench.word(0xE004_2008) & (1 << 12 | 0b110), 0b110);
    assert!(!bench.has_logged("halt would leave"));
}

#[test]
fn a_battery_that_sags_is_warned_of() {
    let mut bench = Bench::resting();
    // 11.8 V and 8.5 A, then 10.2 V, behind a divider by 10.1 and a shunt of 17 A/V.
    bench.board.measure(1_168, 500);
    let bench = bench.run(1_500 * MILLISECOND_NS);
    let warned = |bench: &Bench, state: &str| {
        let line = bench.seen.log.iter().find(|line| line.contains(state));
        line.cloned()
            .unwrap_or_else(|| panic!("{:?}", bench.seen.log))
    };
    let good = warned(&bench, "battery Good: BatteryReading { volts: 11.");
    assert!(
        good.contains("amps: 8.4") || good.contains("amps: 8.5"),
        "{good}"
    );
    let mut bench = bench;
    bench.board.measure(1_010, 500);
    let bench = bench.run(10 * SECOND);
    warned(&bench, "battery Low");
}

/// A debugger that left the log's channel in blocking mode (RTT: flags of up-channel 0), and is gone.
#[test]
fn a_log_that_nobody_reads_stops_nothing_in_any_mode() {
    const BLOCK_IF_FULL: u32 = 2;
    let options = Options {
        log_is_unread: true,
        ..Options::default()
    };
    let mut bench = Bench::started(Crime::Hang, Bench::NEVER, options).run(200 * MILLISECOND_NS);
    // Its write and read positions and its flags.
    let channel = bench.elf.symbol("_SEGGER_RTT").unwrap() + 24;
    let [write, read, flags] = [12, 16, 20].map(|offset| channel + offset);
    let written = bench.word(write);
    // The ring is full.
    bench.board.write(read, &(written + 1).to_le_bytes());
    bench.board.write(flags, &BLOCK_IF_FULL.to_le_bytes());
    let mut bench = bench.run(3 * SECOND);
    assert_ne!(bench.word(write), written, "something was logged");
    // A start would have put it back.
    assert_eq!(bench.word(flags), BLOCK_IF_FULL);
    let flown: Vec<_> = bench.seen.motors.iter().map(|write| write.at_ns).collect();
    let from = flown.partition_point(|at_ns| *at_ns < 1_500 * MILLISECOND_NS);
    let longest = flown[from..].windows(2).map(|pair| pair[1] - pair[0]).max();
    assert!(
        longest.expect("motors") < 101 * MILLISECOND_NS,
        "{longest:?}"
    );
    let last = bench.seen.motors.last().expect("motors");
    assert!(
        last.at_ns > 2_890 * MILLISECOND_NS && last.pulse_ns[0] > SHORTEST_NS,
        "{last:?}"
    );
}

/// The clock is put to 1.5 s before its 32 bits are full, 71.6 minutes, before the drone is armed:
/// it flies on past that.
#[test]
fn the_clock_outlives_thirty_two_bits_in_flight() {
    // Long enough before the drone is armed: a clock that jumps makes a run late.
    let mut bench = Bench::resting().run(200 * MILLISECOND_NS);
    let periods = bench.elf.variable(&["TIMER5_OVERFLOWS"]).unwrap();
    // The second half of the first period.
    bench.board.write(periods, &1_u64.to_le_bytes());
    let late = u32::MAX - 2_200_000;
    bench.board.write(CLOCK, &late.to_le_bytes());
    // Tasks that sleep are due now: the timer would compare with that again after a whole turn.
    bench.board.write(CLOCK_COMPARE, &(late + 50).to_le_bytes());
    let bench = bench.run(3_500 * MILLISECOND_NS);
    assert!(!bench.has_logged("ended by"), "{:?}", bench.seen.log);
    let newest = bench.seen.log.last().unwrap().split_whitespace().next();
    let newest: f64 = newest.unwrap().parse().unwrap();
    assert!(newest > 4_294.97, "{newest}");
    let flown: Vec<_> = bench.seen.motors.iter().map(|write| write.at_ns).collect();
    let from = flown.partition_point(|at_ns| *at_ns < 1_800 * MILLISECOND_NS);
    let longest = flown[from..].windows(2).map(|pair| pair[1] - pair[0]).max();
    assert!(
        longest.expect("motors") < 101 * MILLISECOND_NS,
        "{longest:?}"
    );
    let last = bench.seen.motors.last().unwrap();
    assert!(
        last.at_ns > 3_390 * MILLISECOND_NS && last.pulse_ns[0] > SHORTEST_NS,
        "{last:?}"
    );
}
