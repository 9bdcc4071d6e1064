//! DMA1, whose streams need time to stop.
//!
//! RM0090 10.3.14 and 10.5.5: a stream that is switched off ends the access under way first, EN reads
//! set until then, and TCIF comes with its end; until then its registers cannot be written. The
//! emulator's controller does all that in the same instant. Here it takes ten cycles of the bus, or as
//! long as a script says, which also has the sensor's bus served late or fails an access of it.

use std::sync::Arc;

use rigless::device::{Device, DeviceContext, Level, RegisterFile, RequestChange};
use rigless::soc::stm32f427::generated::dma2::{Register, lisr, s0cr};
use rigless::soc::stm32f427::peripherals::dma::{Dma, STREAMS};
use rigless::soc::{Layout, RegisterSpec};
use rigless::time::{EventId, VirtualNanos};

use super::reflex_f427::{IMU_BUS, IMU_STREAM};
use crate::bus_fault::{Disturbance, Script};

/// What a stream needs to stop, in ns.
const STOPS_AFTER_NS: u64 = 60;
const CONTROLS: [Register; STREAMS] = [
    Register::S0cr,
    Register::S1cr,
    Register::S2cr,
    Register::S3cr,
    Register::S4cr,
    Register::S5cr,
    Register::S6cr,
    Register::S7cr,
];

/// The emulator's controller behind what takes time.
#[derive(Debug)]
pub(super) struct SlowDma {
    controller: Dma,
    script: Arc<Script>,
    running: [bool; STREAMS],
    stopping: [Option<EventId>; STREAMS],
    /// A request that is served late.
    waiting: Option<(EventId, RequestChange)>,
}

impl SlowDma {
    /// Takes the place of the part's own controller.
    pub(super) fn new(controller: Dma, script: Arc<Script>) -> Self {
        Self {
            controller,
            script,
            running: [false; STREAMS],
            stopping: [None; STREAMS],
            waiting: None,
        }
    }

    fn note(&mut self, registers: &RegisterFile) {
        self.running = CONTROLS.map(|control| s0cr::EN.is_set(registers.get(control)));
    }

    /// Hands a control register's value to the controller.
    fn control(
        &mut self,
        stream: usize,
        value: u64,
        registers: &mut RegisterFile,
        context: &mut DeviceContext<'_>,
    ) {
        registers.set(CONTROLS[stream], value);
        Device::write(
            &mut self.controller,
            CONTROLS[stream],
            value,
            registers,
            context,
        );
        self.note(registers);
    }

    /// The access fails: the stream is off, with its error flag.
    fn fail(&mut self, registers: &mut RegisterFile, context: &mut DeviceContext<'_>) {
        let held = registers.get(CONTROLS[IMU_STREAM]);
        let off = s0cr::EN.set(held, 0);
        self.control(IMU_STREAM, s0cr::TCIE.set(off, 0), registers, context);
        let flags = registers.get(Register::Lisr);
        registers.set(
            Register::Lisr,
            lisr::TEIF0.set(lisr::TCIF0.set(flags, 0), 1),
        );
        self.control(IMU_STREAM, off, registers, context);
    }
}

impl Device for SlowDma {
    type Register = Register;

    fn layout(&self) -> &'static [RegisterSpec] {
        Register::REGISTERS
    }

    fn write(
        &mut self,
        register: Register,
        value: u64,
        registers: &mut RegisterFile,
        context: &mut DeviceContext<'_>,
    ) {
        let stream = CONTROLS
            .iter()
            .position(|control| *control as usize == register as usize);
        match stream {
            Some(stream) if self.running[stream] && !s0cr::EN.is_set(value) => {
                let now_ns = context.now().0;
                self.control(stream, s0cr::EN.set(value, 1), registers, context);
                let after_ns = self.script.dma_delay(now_ns).unwrap_or(STOPS_AFTER_NS);
                if self.stopping[stream].is_none() {
                    let event = context.schedule(VirtualNanos(now_ns + after_ns));
                    self.stopping[stream] = Some(event);
                }
            }
            _ => {
                Device::write(&mut self.controller, register, value, registers, context);
                self.note(registers);
            }
        }
    }

    fn on_request(
        &mut self,
        change: RequestChange,
        registers: &mut RegisterFile,
        context: &mut DeviceContext<'_>,
    ) {
        let of_imu = change.instance == IMU_BUS && !self.script.is_empty();
        if of_imu {
            let now_ns = context.now().0;
            self.waiting = None;
            let rises = change.level == Level::High && self.running[IMU_STREAM];
            if rises && self.script.has(Disturbance::DmaError, now_ns) {
                return self.fail(registers, context);
            }
            if let Some(by_ns) = self.script.dma_delay(now_ns).filter(|_| rises) {
                let event = context.schedule(VirtualNanos(now_ns + by_ns));
                self.waiting = Some((event, change));
                return;
            }
        }
        Device::on_request(&mut self.controller, change, registers, context);
        self.note(registers);
    }

    fn on_event(
        &mut self,
        event: EventId,
        registers: &mut RegisterFile,
        context: &mut DeviceContext<'_>,
    ) {
        if let Some((_, change)) = self.waiting.take_if(|(due, _)| *due == event) {
            Device::on_request(&mut self.controller, change, registers, context);
            self.note(registers);
        }
        for stream in 0..STREAMS {
            if self.stopping[stream].take_if(|due| *due == event).is_some() {
                let value = registers.get(CONTROLS[stream]);
                self.control(stream, s0cr::EN.set(value, 0), registers, context);
            }
        }
    }

    fn on_access(
        &mut self,
        token: u64,
        value: u64,
        registers: &mut RegisterFile,
        context: &mut DeviceContext<'_>,
    ) {
        Device::on_access(&mut self.controller, token, value, registers, context);
        self.note(registers);
    }

    fn on_refused(
        &mut self,
        token: u64,
        registers: &mut RegisterFile,
        context: &mut DeviceContext<'_>,
    ) {
        Device::on_refused(&mut self.controller, token, registers, context);
        self.note(registers);
    }

    fn reset(&mut self) {
        Device::reset(&mut self.controller);
        self.running = [false; STREAMS];
        self.stopping = [None; STREAMS];
        self.waiting = None;
    }
}
