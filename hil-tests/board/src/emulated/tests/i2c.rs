//! The inertial sensor's bus, driven register by register, with all that can go wrong on it.

use std::sync::{Arc, Mutex};

use chip_models::{Chip, I2cChip};
use rigless::mcu::Operate;
use rigless::soc::Width;
use rigless::time::VirtualNanos;

use super::{Pulse, sensors};
use crate::bus_fault::{BusFault, Disturbance, Script};
use crate::emulated::link::Link;
use crate::emulated::part::Part;

const RCC_AHB1ENR: u64 = 0x4002_3830;
const RCC_APB1ENR: u64 = 0x4002_3840;
const CR1: u64 = 0x4000_5400;
const CR2: u64 = 0x4000_5404;
const DR: u64 = 0x4000_5410;
const SR1: u64 = 0x4000_5414;
const SR2: u64 = 0x4000_5418;
const CCR: u64 = 0x4000_541C;
const PORT_MODE: u64 = 0x4002_0400;
const PORT_TYPE: u64 = 0x4002_0404;
const PORT_IN: u64 = 0x4002_0410;
const PORT_SET: u64 = 0x4002_0418;
const LISR: u64 = 0x4002_6000;
const S0CR: u64 = 0x4002_6010;
const S0NDTR: u64 = 0x4002_6014;
const S0PAR: u64 = 0x4002_6018;
const S0M0AR: u64 = 0x4002_601C;

const PE: u64 = 1 << 0;
const START: u64 = 1 << 8;
const STOP: u64 = 1 << 9;
const ACK: u64 = 1 << 10;
const SWRST: u64 = 1 << 15;
const SB: u64 = 1 << 0;
const ADDR: u64 = 1 << 1;
const RXNE: u64 = 1 << 6;
const BERR: u64 = 1 << 8;
const ARLO: u64 = 1 << 9;
const AF: u64 = 1 << 10;
const MSL: u64 = 1 << 0;
const BUSY: u64 = 1 << 1;
const EN: u64 = 1 << 0;
const TCIF0: u64 = 1 << 5;
const TEIF0: u64 = 1 << 3;

const WRITE: u64 = 0xD0;
const READ: u64 = 0xD1;
/// A clock of 400 kHz, as from 16 MHz, and what follows from it, in ns.
const DIVIDER: u64 = 0x8000 | 13;
const CLOCK: u64 = 3 * 13 * 1000 / 16;
const BYTE: u64 = 9 * 3 * 13 * 1000 / 16;

/// A chip that sends zeros and notes what it hears.
#[derive(Debug, Default)]
struct Noted {
    starts: Vec<bool>,
    /// Whether each byte that it sent was refused.
    sent: Vec<bool>,
    stops: usize,
}

impl Chip for Noted {
    fn advance(&mut self, _: u64) {}
    fn next_event(&self) -> u64 {
        u64::MAX
    }
    fn interrupt(&self) -> bool {
        false
    }
}

impl I2cChip for Noted {
    fn start(&mut self, _: u64, _: u8, read: bool) -> bool {
        self.starts.push(read);
        true
    }
    fn write(&mut self, _: u64, _: u8) -> bool {
        true
    }
    fn read(&mut self, _: u64, last: bool) -> u8 {
        self.sent.push(last);
        0
    }
    fn stop(&mut self, _: u64) {
        self.stops += 1;
    }
}

/// The part with such a chip, at an instant.
struct Master {
    part: Part,
    chip: Arc<Mutex<Noted>>,
    now_ns: u64,
}

/// RAM that takes what a stream writes.
struct Sink;

impl rigless::emulator::Memory for Sink {
    fn read(&mut self, _: u64, _: Width) -> Result<u64, rigless::emulator::Error> {
        Ok(0)
    }
    fn write(&mut self, _: u64, _: Width, _: u64) -> Result<(), rigless::emulator::Error> {
        Ok(())
    }
}

impl Master {
    fn new(what: &[(Disturbance, u64, u64)]) -> Self {
        let chip = Arc::new(Mutex::new(Noted::default()));
        let mut sensors = sensors(Pulse::default());
        sensors.imu = chip.clone();
        let fault = |&(what, from_ns, until_ns): &_| BusFault {
            what,
            from_ns,
            until_ns,
        };
        let faults: Vec<_> = what.iter().map(fault).collect();
        let part = Part::new(sensors, Link::default(), Script::from(faults.as_slice())).unwrap();
        let mut master = Self {
            part,
            chip,
            now_ns: 0,
        };
        master.write(RCC_AHB1ENR, 1 << 1 | 1 << 21);
        master.write(RCC_APB1ENR, 1 << 21);
        master.write(PORT_TYPE, 0b11 << 8);
        master.write(PORT_SET, 0b11 << 8);
        master.write(PORT_MODE, 0b1010 << 16);
        master.write(CCR, DIVIDER);
        master.write(CR1, PE);
        master
    }

    fn write(&mut self, address: u64, value: u64) {
        let now = VirtualNanos(self.now_ns);
        self.part.write(now, address, Width::W32, value).unwrap();
        self.part.settle(&mut Sink).unwrap();
    }

    fn read(&mut self, address: u64) -> u64 {
        let now = VirtualNanos(self.now_ns);
        let value = self.part.read(now, address, Width::W32).unwrap();
        self.part.settle(&mut Sink).unwrap();
        value
    }

    /// Runs on by so many ns, event by event as a session does.
    fn pass(&mut self, ns: u64) {
        let until = self.now_ns + ns;
        while let Some(next) = self.part.next_event().filter(|next| next.0 <= until) {
            self.part.advance_to(next);
            self.part.settle(&mut Sink).unwrap();
        }
        self.now_ns = until;
    }

    fn has(&mut self, register: u64, flag: u64) -> bool {
        self.read(register) & flag == flag
    }

    /// START and an address, up to its acknowledge bit.
    fn address(&mut self, byte: u64) {
        self.write(CR1, PE | ACK | START);
        self.pass(2 * CLOCK);
        assert!(self.has(SR1, SB));
        self.write(DR, byte);
        self.pass(BYTE);
    }

    /// A stream that reads so many bytes, LAST included.
    fn stream(&mut self, bytes: u64) {
        for (register, value) in [
            (S0PAR, DR),
            (S0M0AR, 0x2000_0000),
            (S0NDTR, bytes),
            (S0CR, 1 << 25 | 1 << 10 | EN),
            (CR2, 1 << 11 | 1 << 12),
        ] {
            self.write(register, value);
        }
    }

    fn chip(&self) -> std::sync::MutexGuard<'_, Noted> {
        self.chip.lock().unwrap()
    }

    /// The levels of SCL and SDA as the port reads them.
    fn wires(&mut self) -> u64 {
        self.read(PORT_IN) >> 8 & 0b11
    }
}

#[test]
fn start_and_stop_take_their_time_and_read_as_pending_until_then() {
    let mut master = Master::new(&[]);
    master.write(CR1, PE | START);
    master.pass(CLOCK / 3 - 1);
    assert!(!master.has(SR1, SB) && master.has(CR1, START));
    master.pass(2);
    assert!(master.has(SR1, SB) && !master.has(CR1, START) && master.has(SR2, MSL | BUSY));
    master.write(DR, WRITE);
    master.pass(BYTE + 1);
    assert!(master.has(SR1, ADDR));
    master.read(SR2);
    master.write(CR1, PE | STOP);
    master.pass(CLOCK - 10);
    assert!(master.has(CR1, STOP) && master.has(SR2, BUSY));
    master.pass(20);
    assert!(!master.has(CR1, STOP) && !master.has(SR2, BUSY));
    assert_eq!(master.chip().stops, 1);
    // The bus is to be free for a while.
    master.write(CR1, PE | START);
    master.pass(CLOCK / 3 + 1);
    assert!(!master.has(SR1, SB));
    master.pass(CLOCK);
    assert!(master.has(SR1, SB));
    assert!(master.part.drain_told().is_empty());
}

#[test]
fn a_write_of_the_control_register_while_a_request_is_pending_is_told() {
    let mut master = Master::new(&[]);
    master.address(WRITE);
    master.read(SR2);
    master.write(CR1, PE | STOP);
    master.write(CR1, PE | START);
    let told = master.part.drain_told();
    assert_eq!(told[0].reason, "is written while START or STOP is pending");
}

#[test]
fn with_last_the_byte_before_the_end_of_the_stream_is_refused_and_no_other_is_clocked() {
    for bytes in [2, 15] {
        let mut master = Master::new(&[]);
        master.address(READ);
        master.stream(bytes);
        master.read(SR1);
        master.read(SR2);
        master.pass(100 * BYTE);
        let mut refused = vec![false; bytes as usize];
        *refused.last_mut().unwrap() = true;
        assert_eq!(master.chip().sent, refused);
        assert!(master.has(LISR, TCIF0) && !master.has(SR1, RXNE));
    }
}

#[test]
fn nobody_acknowledges_while_the_script_says_so() {
    let mut master = Master::new(&[(Disturbance::NoAcknowledge, 0, 40_000)]);
    master.address(WRITE);
    assert!(master.has(SR1, AF) && !master.has(SR1, ADDR));
    master.write(SR1, 0);
    master.write(CR1, PE | STOP);
    master.pass(40_000);
    master.address(WRITE);
    assert!(master.has(SR1, ADDR));
}

#[test]
fn a_bus_error_is_flagged_and_the_transfer_goes_on() {
    let mut master = Master::new(&[(Disturbance::BusError, 0, u64::MAX)]);
    master.address(WRITE);
    assert!(master.has(SR1, ADDR | BERR));
    master.write(SR1, !BERR);
    assert!(master.has(SR1, ADDR) && !master.has(SR1, BERR));
}

#[test]
fn arbitration_is_lost_at_the_first_one_and_the_master_is_none_any_more() {
    for what in [Disturbance::ArbitrationLost, Disturbance::DataHeld] {
        let mut master = Master::new(&[(what, 3_000, 60_000)]);
        master.write(CR1, PE | START);
        master.pass(2_500);
        assert!(master.has(SR1, SB));
        master.write(DR, WRITE);
        master.pass(CLOCK);
        assert!(master.has(SR1, ARLO) && !master.has(SR2, MSL) && master.has(SR2, BUSY));
        assert!(master.chip().starts.is_empty(), "the address did not end");
    }
}

#[test]
fn a_held_wire_is_noticed_late_reads_low_and_no_start_is_made() {
    for (what, levels) in [
        (Disturbance::DataHeld, 0b01),
        (Disturbance::ClockHeld, 0b10),
    ] {
        let mut master = Master::new(&[(what, 100, 1_000_000)]);
        master.pass(1_000);
        assert!(master.has(SR2, BUSY));
        assert_eq!(master.wires(), levels);
        master.write(CR1, SWRST);
        master.write(CR1, 0);
        master.write(CCR, DIVIDER);
        master.write(CR1, PE);
        assert!(!master.has(SR2, BUSY), "not yet");
        master.pass(1_000);
        assert!(master.has(SR2, BUSY));
        master.write(CR1, PE | START);
        master.pass(500_000);
        assert!(!master.has(SR1, SB) && master.has(CR1, START));
    }
}

#[test]
fn a_chip_that_is_left_in_a_byte_holds_sda_until_clocks_by_hand_free_it() {
    let mut master = Master::new(&[]);
    master.address(READ);
    master.read(SR1);
    master.read(SR2);
    // It has sent three zeros.
    master.pass(3 * CLOCK + CLOCK / 2);
    master.write(CR1, SWRST);
    master.write(CR1, 0);
    assert_eq!(master.wires(), 0b01);
    master.write(PORT_MODE, 0b0101 << 16);
    for clock in 3..8 {
        assert_eq!(master.wires(), 0b01, "clock {clock}");
        master.write(PORT_SET, 1 << 24);
        master.write(PORT_SET, 1 << 25);
        master.write(PORT_SET, 1 << 8);
        master.write(PORT_SET, 1 << 9);
    }
    assert_eq!(master.wires(), 0b11);
    assert_eq!(master.chip().stops, 1);
}

#[test]
fn a_chip_that_lost_count_lets_go_after_its_clocks() {
    let what = Disturbance::DataHeldByChip { clocks: 4 };
    let mut master = Master::new(&[(what, 100, u64::MAX)]);
    master.pass(1_000);
    master.write(PORT_MODE, 0b0101 << 16);
    let mut clocks = 0;
    while master.wires() != 0b11 {
        master.write(PORT_SET, 1 << 24);
        master.write(PORT_SET, 1 << 8);
        clocks += 1;
    }
    assert_eq!(clocks, 4);
}

#[test]
fn a_stretched_clock_makes_a_byte_longer() {
    let what = Disturbance::Stretched { percent: 200 };
    let mut master = Master::new(&[(what, 3_000, u64::MAX)]);
    master.write(CR1, PE | START);
    master.pass(3_000);
    master.read(SR1);
    master.write(DR, WRITE);
    master.pass(2 * BYTE - 1);
    assert!(!master.has(SR1, ADDR));
    master.pass(1);
    assert!(master.has(SR1, ADDR));
}

#[test]
fn a_stream_that_is_switched_off_stops_later_and_raises_its_flag_then() {
    for (script, after_ns) in [
        (vec![], 60),
        (
            vec![(Disturbance::DmaLate { by_ns: 20_000 }, 0, u64::MAX)],
            20_000,
        ),
    ] {
        let mut master = Master::new(&script);
        master.stream(15);
        master.write(S0CR, 1 << 25 | 1 << 10);
        master.pass(after_ns - 1);
        assert!(master.has(S0CR, EN) && !master.has(LISR, TCIF0));
        master.pass(1);
        assert!(!master.has(S0CR, EN) && master.has(LISR, TCIF0));
    }
}

#[test]
fn an_access_that_fails_ends_the_stream_with_its_error() {
    let mut master = Master::new(&[(Disturbance::DmaError, 0, u64::MAX)]);
    master.address(READ);
    master.stream(15);
    master.read(SR1);
    master.read(SR2);
    master.pass(BYTE + 5);
    assert!(master.has(LISR, TEIF0) && !master.has(LISR, TCIF0) && !master.has(S0CR, EN));
}
