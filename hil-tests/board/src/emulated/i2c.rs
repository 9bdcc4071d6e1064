//! I2C1 as the master of the inertial sensor's bus, and what a bus can do to one.
//!
//! RM0090 chapter 27, in master mode with 7-bit addresses. Beside what the emulator's own model does:
//! a START, a repeated START and a STOP take their time on the wire, and their request bits stay set
//! until then; LAST has the byte before the end of the DMA refused; BERR and ARLO, a held SDA or SCL
//! and a stretched clock are played from a [`Script`](crate::bus_fault::Script). A write of CR1 while
//! a request is pending, which 27.6.1 forbids, is told to the run.
//!
//! Times on the wire follow from CCR: a START holds for the high half of a clock, a repeated START and
//! a STOP take a whole one, and the bus is free for the low half before the next START. A byte takes
//! nine clocks.
//!
//! **Not played**: the slave, 10-bit addresses, SMBus, PEC; levels of the wires while the peripheral
//! drives them; another master's bytes.

mod wires;

pub(super) use wires::{Levels, RELEASED, SharedWires};

use rigless::device::{Device, DeviceContext, Level, RegisterFile};
use rigless::soc::FieldSpec;
use rigless::soc::stm32f427::generated::i2c3::{Register, ccr, cr1, cr2, sr1, sr2};
use rigless::time::{EventId, VirtualNanos};

use crate::bus_fault::Disturbance;

/// Places of the event and the error interrupt in the instance's table.
const EVENT: usize = 0;
const ERROR: usize = 1;
/// The DMA requests of a received byte and of room for one to send.
const REQUESTS: usize = 2;
/// From a reset of the logic until it notices a wire that is low, in ns: the filters of its inputs.
const NOTICES_AFTER_NS: u64 = 500;
const NANOS: u128 = 1_000_000_000;
/// Clocks of a byte, with its acknowledge bit.
const CLOCKS: u64 = 9;

/// What occupies the wires.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Step {
    Start,
    Stop,
    Address(u8),
    Write(u8),
    Read,
    /// A byte in which arbitration will be lost.
    Lost,
}

/// A step, since when, and the event that ends it; none where the clock is held for ever.
#[derive(Clone, Copy, Debug)]
struct Activity {
    step: Step,
    began_ns: u64,
    ends: Option<EventId>,
}

/// Why the clocks of a read stand still.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Reading {
    /// The next byte follows by itself.
    Goes,
    /// The last byte was refused.
    Refused,
}

/// The peripheral.
#[derive(Debug)]
pub(super) struct I2c {
    wires: SharedWires,
    clock_hz: u64,
    activity: Option<Activity>,
    /// Direction of the open transfer; none where no chip is addressed.
    reading: Option<bool>,
    flow: Reading,
    status_read: bool,
    transmit: Option<u8>,
    /// The received byte in DR, and one behind it that stretches the clock.
    received: [Option<u8>; 2],
    acknowledge_before: bool,
    /// The stream told that its last transfer but one is done.
    end_is_near: bool,
    carry: u128,
    free_ns: u64,
    /// The wires as they were at the last look.
    seen: Levels,
    control: u64,
    interrupts: [bool; 2],
    requests: [Level; REQUESTS],
    /// Transfers that the DMA stream has left, kept up by the part's wiring.
    pub(super) dma_left: u64,
}

fn change(registers: &mut RegisterFile, register: Register, fields: &[(&FieldSpec, bool)]) {
    let held = registers.get(register);
    let new = fields.iter().fold(held, |value, (field, set)| {
        field.set(value, u64::from(*set))
    });
    registers.set(register, new);
}

fn has(registers: &RegisterFile, register: Register, field: &FieldSpec) -> bool {
    field.is_set(registers.get(register))
}

impl I2c {
    /// The peripheral on its wires, without a clock.
    pub(super) fn new(wires: SharedWires) -> Self {
        Self {
            wires,
            clock_hz: 0,
            activity: None,
            reading: None,
            flow: Reading::Goes,
            status_read: false,
            transmit: None,
            received: [None; 2],
            acknowledge_before: true,
            end_is_near: false,
            carry: 0,
            free_ns: 0,
            seen: RELEASED,
            control: 0,
            interrupts: [false; 2],
            requests: [Level::Low; REQUESTS],
            dma_left: 0,
        }
    }

    /// Asks to be woken at every change that the script makes.
    pub(super) fn start(&self, context: &mut DeviceContext<'_>) {
        let now_ns = context.now().0;
        let wires = self.wires.lock();
        for at_ns in wires.script.changes().filter(|&at_ns| at_ns >= now_ns) {
            context.schedule(VirtualNanos(at_ns));
        }
    }

    /// So many clocks in thirds, in ns; none without a divider. What a division drops is carried on.
    fn clocks(&mut self, thirds: u64, registers: &RegisterFile) -> Option<u64> {
        let value = registers.get(Register::Ccr);
        let count = ccr::CCR.get(value);
        if count == 0 || self.clock_hz == 0 {
            return None;
        }
        let periods: u128 = match (ccr::F_S.is_set(value), ccr::DUTY.is_set(value)) {
            (false, _) => 2,
            (true, false) => 3,
            (true, true) => 25,
        };
        let total = u128::from(thirds) * periods * u128::from(count) * NANOS / 3 + self.carry;
        let clock_hz = u128::from(self.clock_hz);
        self.carry = total % clock_hz;
        Some((total / clock_hz) as u64)
    }

    fn occupy(
        &mut self,
        step: Step,
        from_ns: u64,
        thirds: u64,
        registers: &RegisterFile,
        context: &mut DeviceContext<'_>,
    ) {
        let Some(duration_ns) = self.clocks(thirds, registers) else {
            return;
        };
        let wires = self.wires.lock();
        let lost = match step {
            Step::Address(byte) | Step::Write(byte) => {
                let bit_ns = duration_ns / CLOCKS;
                let ones = (0..8).filter(|bit| byte << bit & 0x80 != 0);
                let mut middles = ones.map(|bit| from_ns + bit * bit_ns + bit_ns / 2);
                middles.find(|&at_ns| {
                    wires.is_data_held(at_ns)
                        || wires.script.has(Disturbance::ArbitrationLost, at_ns)
                })
            }
            _ => None,
        };
        let step = if lost.is_some() { Step::Lost } else { step };
        let end = lost.or_else(|| wires.script.end_of(from_ns, duration_ns));
        self.activity = Some(Activity {
            step,
            began_ns: from_ns,
            ends: end.map(|at_ns| context.schedule(VirtualNanos(at_ns))),
        });
    }

    fn shift(&mut self, step: Step, registers: &RegisterFile, context: &mut DeviceContext<'_>) {
        self.occupy(step, context.now().0, 3 * CLOCKS, registers, context);
    }

    /// Whether software asks for a START or STOP that was not carried out yet.
    fn is_asked(registers: &RegisterFile) -> bool {
        has(registers, Register::Cr1, cr1::START) || has(registers, Register::Cr1, cr1::STOP)
    }

    /// Begins what software asks for, as soon as the wires allow it.
    fn carry_out(&mut self, registers: &mut RegisterFile, context: &mut DeviceContext<'_>) {
        if self.activity.is_some() || !Self::is_asked(registers) {
            return;
        }
        let now_ns = context.now().0;
        let levels = self.wires.lock().levels(now_ns);
        let master = has(registers, Register::Sr2, sr2::MSL);
        if has(registers, Register::Cr1, cr1::STOP) && !master {
            change(registers, Register::Cr1, &[(cr1::STOP, false)]);
        }
        let stops = has(registers, Register::Cr1, cr1::STOP);
        if master {
            // SDA must rise before either condition.
            if levels.sda {
                let step = if stops { Step::Stop } else { Step::Start };
                self.occupy(step, now_ns, 3, registers, context);
            }
        } else if has(registers, Register::Cr1, cr1::START)
            && !has(registers, Register::Sr2, sr2::BUSY)
            && levels == RELEASED
        {
            let from_ns = now_ns.max(self.free_ns);
            self.occupy(Step::Start, from_ns, 1, registers, context);
        }
    }

    /// BUSY follows the wires: set by a low one, cleared by a STOP, which SDA's rise is.
    fn look(&mut self, registers: &mut RegisterFile, now_ns: u64) {
        let mut wires = self.wires.lock();
        wires.begin(now_ns);
        let levels = wires.levels(now_ns);
        let before = std::mem::replace(&mut self.seen, levels);
        if levels != RELEASED {
            change(registers, Register::Sr2, &[(sr2::BUSY, true)]);
        } else if !before.sda && !has(registers, Register::Sr2, sr2::MSL) {
            change(registers, Register::Sr2, &[(sr2::BUSY, false)]);
        }
    }

    fn started(&mut self, registers: &mut RegisterFile) {
        self.carry = 0;
        self.transmit = None;
        self.reading = None;
        change(registers, Register::Cr1, &[(cr1::START, false)]);
        let flags = [(sr1::SB, true), (sr1::TXE, false), (sr1::BTF, false)];
        change(registers, Register::Sr1, &flags);
        let flags = [(sr2::MSL, true), (sr2::BUSY, true), (sr2::TRA, false)];
        change(registers, Register::Sr2, &flags);
    }

    fn stopped(&mut self, registers: &mut RegisterFile, now_ns: u64) {
        self.wires.lock().stop(now_ns);
        change(registers, Register::Cr1, &[(cr1::STOP, false)]);
        let flags = [(sr2::MSL, false), (sr2::BUSY, false), (sr2::TRA, false)];
        change(registers, Register::Sr2, &flags);
        change(registers, Register::Sr1, &[(sr1::TXE, false)]);
        if self.reading != Some(true) {
            change(registers, Register::Sr1, &[(sr1::BTF, false)]);
        }
        self.reading = None;
        self.transmit = None;
        let low_ns = self.clocks(2, registers).unwrap_or(0);
        self.free_ns = now_ns + low_ns;
    }

    fn addressed(&mut self, byte: u8, registers: &mut RegisterFile, now_ns: u64) {
        let read = byte & 1 != 0;
        if self.wires.lock().start(now_ns, byte >> 1, read) {
            self.reading = Some(read);
            change(
                registers,
                Register::Sr1,
                &[(sr1::ADDR, true), (sr1::TXE, !read)],
            );
            change(registers, Register::Sr2, &[(sr2::TRA, !read)]);
        } else {
            change(registers, Register::Sr1, &[(sr1::AF, true)]);
        }
    }

    fn written(&mut self, byte: u8, registers: &mut RegisterFile, context: &mut DeviceContext<'_>) {
        if !self.wires.lock().write(context.now().0, byte) {
            self.transmit = None;
            change(registers, Register::Sr1, &[(sr1::AF, true)]);
        } else if Self::is_asked(registers) {
            // The condition follows the byte.
        } else if let Some(next) = self.transmit.take() {
            change(registers, Register::Sr1, &[(sr1::TXE, true)]);
            self.shift(Step::Write(next), registers, context);
        } else {
            change(
                registers,
                Register::Sr1,
                &[(sr1::BTF, true), (sr1::TXE, true)],
            );
        }
    }

    /// Whether the byte that has just crossed is acknowledged.
    fn acknowledges(&mut self, registers: &RegisterFile) -> bool {
        let now = has(registers, Register::Cr1, cr1::ACK);
        let before = std::mem::replace(&mut self.acknowledge_before, now);
        let by_software = match has(registers, Register::Cr1, cr1::POS) {
            true => before,
            false => now,
        };
        let ends = self.end_is_near && self.dma_left == 1;
        by_software && !(ends && has(registers, Register::Cr2, cr2::LAST))
    }

    fn has_read(
        &mut self,
        began_ns: u64,
        registers: &mut RegisterFile,
        context: &mut DeviceContext<'_>,
    ) {
        let now_ns = context.now().0;
        let last = !self.acknowledges(registers);
        let byte = {
            let mut wires = self.wires.lock();
            let bit_ns = (now_ns - began_ns) / CLOCKS;
            let held = |bit: &u64| {
                let middle_ns = began_ns + bit * bit_ns + bit_ns / 2;
                wires.script.has(Disturbance::DataHeld, middle_ns)
            };
            let zeros = (0..8)
                .filter(held)
                .fold(0, |zeros, bit| zeros | 0x80_u8 >> bit);
            wires.read(now_ns, last) & !zeros
        };
        if last {
            self.flow = Reading::Refused;
        }
        let [first, second] = &mut self.received;
        if first.is_none() {
            *first = Some(byte);
            change(registers, Register::Sr1, &[(sr1::RXNE, true)]);
            self.read_on(registers, context);
        } else {
            *second = Some(byte);
            change(registers, Register::Sr1, &[(sr1::BTF, true)]);
        }
    }

    /// Clocks the next byte in, unless something stops the clock.
    fn read_on(&mut self, registers: &RegisterFile, context: &mut DeviceContext<'_>) {
        let goes = self.reading == Some(true) && self.flow == Reading::Goes;
        if goes
            && self.received[1].is_none()
            && self.activity.is_none()
            && !Self::is_asked(registers)
        {
            self.shift(Step::Read, registers, context);
        }
    }

    fn lose(&mut self, registers: &mut RegisterFile) {
        self.wires.lock().cut_writing(0);
        self.reading = None;
        self.transmit = None;
        change(
            registers,
            Register::Cr1,
            &[(cr1::START, false), (cr1::STOP, false)],
        );
        change(
            registers,
            Register::Sr1,
            &[(sr1::ARLO, true), (sr1::TXE, false)],
        );
        change(
            registers,
            Register::Sr2,
            &[(sr2::MSL, false), (sr2::TRA, false)],
        );
    }

    fn end_step(
        &mut self,
        Activity { step, began_ns, .. }: Activity,
        registers: &mut RegisterFile,
        context: &mut DeviceContext<'_>,
    ) {
        let now_ns = context.now().0;
        self.activity = None;
        match step {
            // Somebody holds SDA meanwhile: the condition was not made.
            Step::Start | Step::Stop if self.wires.lock().is_data_held(now_ns) => {
                change(registers, Register::Sr2, &[(sr2::BUSY, true)]);
                return;
            }
            Step::Start => self.started(registers),
            Step::Stop => self.stopped(registers, now_ns),
            Step::Address(byte) => self.addressed(byte, registers, now_ns),
            Step::Write(byte) => self.written(byte, registers, context),
            Step::Read => self.has_read(began_ns, registers, context),
            Step::Lost => return self.lose(registers),
        }
        let byte = !matches!(step, Step::Start | Step::Stop);
        if byte && self.wires.lock().script.has(Disturbance::BusError, now_ns) {
            change(registers, Register::Sr1, &[(sr1::BERR, true)]);
        }
        self.carry_out(registers, context);
    }

    /// The logic lets go of both wires, whatever it was at; a chip stays where it is.
    fn let_go(&mut self, registers: &RegisterFile, now_ns: u64) {
        let mut wires = self.wires.lock();
        let bits = |began_ns: u64, byte_ns: u64| {
            let passed = now_ns.saturating_sub(began_ns) * CLOCKS / byte_ns.max(1);
            passed.min(CLOCKS - 1) as u8
        };
        match self.activity {
            Some(Activity { step, began_ns, .. }) => {
                let byte_ns = byte_ns(self.clock_hz, registers);
                match step {
                    Step::Read => wires.cut_reading(now_ns, bits(began_ns, byte_ns)),
                    Step::Address(_) | Step::Write(_) => {
                        wires.cut_writing(bits(began_ns, byte_ns));
                    }
                    _ => {}
                }
            }
            // The chip's next bit is out already.
            None if self.reading == Some(true) && self.flow == Reading::Goes => {
                wires.cut_reading(now_ns, 0);
            }
            None => {}
        }
    }

    fn reset_logic(&mut self) {
        *self = Self {
            clock_hz: self.clock_hz,
            interrupts: self.interrupts,
            requests: self.requests,
            control: self.control,
            ..Self::new(self.wires.clone())
        };
    }

    fn write_control(
        &mut self,
        value: u64,
        registers: &mut RegisterFile,
        context: &mut DeviceContext<'_>,
    ) {
        let (was, now_ns) = (self.control, context.now().0);
        if cr1::SWRST.is_set(value) {
            if !cr1::SWRST.is_set(was) {
                self.let_go(registers, now_ns);
                registers.reset();
                self.reset_logic();
            }
            registers.set(Register::Cr1, cr1::SWRST.mask());
            return;
        }
        if cr1::SWRST.is_set(was) {
            context.schedule(VirtualNanos(now_ns + NOTICES_AFTER_NS));
        } else if cr1::START.is_set(was) || cr1::STOP.is_set(was) {
            context.tell("CR1", "is written while START or STOP is pending");
        }
        if !cr1::PE.is_set(value) {
            let off = [(cr1::START, false), (cr1::STOP, false), (cr1::ACK, false)];
            change(registers, Register::Cr1, &off);
            if cr1::PE.is_set(was) {
                self.let_go(registers, now_ns);
                self.reset_logic();
                registers.set(Register::Sr1, 0);
                change(
                    registers,
                    Register::Sr2,
                    &[(sr2::MSL, false), (sr2::TRA, false)],
                );
            }
            return;
        }
        self.carry_out(registers, context);
    }

    fn write_data(
        &mut self,
        byte: u8,
        registers: &mut RegisterFile,
        context: &mut DeviceContext<'_>,
    ) {
        if self.status_read && has(registers, Register::Sr1, sr1::SB) {
            self.status_read = false;
            change(registers, Register::Sr1, &[(sr1::SB, false)]);
            self.shift(Step::Address(byte), registers, context);
        } else if self.reading != Some(false) {
            // No chip takes it.
        } else if self.activity.is_some() {
            change(registers, Register::Sr1, &[(sr1::TXE, false)]);
            self.transmit = Some(byte);
        } else {
            change(registers, Register::Sr1, &[(sr1::BTF, false)]);
            self.shift(Step::Write(byte), registers, context);
        }
    }

    fn read_data(&mut self, registers: &mut RegisterFile, context: &mut DeviceContext<'_>) -> u64 {
        let [first, second] = std::mem::take(&mut self.received);
        self.received[0] = second;
        let flags = [(sr1::RXNE, second.is_some()), (sr1::BTF, false)];
        change(registers, Register::Sr1, &flags);
        if has(registers, Register::Cr2, cr2::DMAEN) && self.dma_left == 2 {
            self.end_is_near = true;
        }
        if second.is_some() {
            self.read_on(registers, context);
        }
        u64::from(first.unwrap_or(0))
    }

    /// SR1 was read, then SR2: ADDR is cleared, and a read's bytes begin to come.
    fn clear_address(&mut self, registers: &mut RegisterFile, context: &mut DeviceContext<'_>) {
        if !self.status_read || !has(registers, Register::Sr1, sr1::ADDR) {
            return;
        }
        self.status_read = false;
        change(registers, Register::Sr1, &[(sr1::ADDR, false)]);
        self.acknowledge_before = true;
        self.end_is_near = false;
        self.flow = Reading::Goes;
        self.read_on(registers, context);
    }

    /// The interrupts of table 124 and the requests of 27.3.8.
    fn refresh(&mut self, registers: &RegisterFile, context: &mut DeviceContext<'_>) {
        let (status, enables) = (registers.get(Register::Sr1), registers.get(Register::Cr2));
        let any = |fields: &[&FieldSpec]| fields.iter().any(|field| field.is_set(status));
        let by_dma = cr2::DMAEN.is_set(enables);
        for (output, flag) in [sr1::RXNE, sr1::TXE].into_iter().enumerate() {
            let wanted = Level::from(by_dma && flag.is_set(status));
            if wanted != self.requests[output] {
                self.requests[output] = wanted;
                context.request(output, wanted);
            }
        }
        let buffer = cr2::ITBUFEN.is_set(enables) && any(&[sr1::TXE, sr1::RXNE]);
        let event = any(&[sr1::SB, sr1::ADDR, sr1::BTF]) || buffer;
        let error = any(&[sr1::BERR, sr1::ARLO, sr1::AF, sr1::OVR]);
        let levels = [
            (EVENT, event && cr2::ITEVTEN.is_set(enables)),
            (ERROR, error && cr2::ITERREN.is_set(enables)),
        ];
        for (position, wanted) in levels {
            if wanted != self.interrupts[position] {
                self.interrupts[position] = wanted;
                context.interrupt(position, Level::from(wanted));
            }
        }
    }
}

/// Time of a byte on an unhindered bus, in ns.
fn byte_ns(clock_hz: u64, registers: &RegisterFile) -> u64 {
    let count = ccr::CCR.get(registers.get(Register::Ccr));
    let cycles = u128::from(3 * CLOCKS * count);
    (cycles * NANOS / u128::from(clock_hz.max(1))) as u64
}

impl Device for I2c {
    type Register = Register;

    fn on_clock(&mut self, hz: u64, _: &mut RegisterFile, _: &mut DeviceContext<'_>) {
        self.clock_hz = hz;
        self.carry = 0;
    }

    fn read(
        &mut self,
        register: Register,
        registers: &mut RegisterFile,
        context: &mut DeviceContext<'_>,
    ) -> Option<u64> {
        let value = match register {
            Register::Sr1 => {
                self.status_read = true;
                return None;
            }
            Register::Sr2 => {
                let value = registers.get(Register::Sr2);
                self.clear_address(registers, context);
                value
            }
            Register::Dr => self.read_data(registers, context),
            _ => return None,
        };
        self.refresh(registers, context);
        Some(value)
    }

    fn write(
        &mut self,
        register: Register,
        value: u64,
        registers: &mut RegisterFile,
        context: &mut DeviceContext<'_>,
    ) {
        match register {
            Register::Cr1 => {
                self.write_control(value, registers, context);
                self.control = registers.get(Register::Cr1);
            }
            // Under reset nothing is kept.
            _ if cr1::SWRST.is_set(self.control) => {
                registers.reset();
                registers.set(Register::Cr1, cr1::SWRST.mask());
            }
            Register::Dr => self.write_data(value as u8, registers, context),
            _ => {}
        }
        self.refresh(registers, context);
    }

    fn on_event(
        &mut self,
        event: EventId,
        registers: &mut RegisterFile,
        context: &mut DeviceContext<'_>,
    ) {
        self.look(registers, context.now().0);
        let ended = |activity: &Activity| activity.ends == Some(event);
        match self.activity.filter(ended) {
            Some(activity) => self.end_step(activity, registers, context),
            None => self.carry_out(registers, context),
        }
        self.control = registers.get(Register::Cr1);
        self.refresh(registers, context);
    }

    /// The chip stays where it was left.
    fn reset(&mut self) {
        *self = Self {
            clock_hz: self.clock_hz,
            ..Self::new(self.wires.clone())
        };
    }

    fn reset_line(&mut self, _: &mut RegisterFile, context: &mut DeviceContext<'_>) {
        context.lower_requests(&self.requests);
        self.reset();
        self.start(context);
    }
}
