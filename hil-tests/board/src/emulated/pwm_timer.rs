//! TIM3 and TIM4 as pulse generators, cheap and observable.
//!
//! The emulator's own timer model wakes at every compare match, which at eight
//! motors and 2 kHz would cost more than the rest of the board. This one is
//! asked only when the firmware touches it: update events, preload transfers
//! and the counter follow from arithmetic. Played is what RM0090 chapter 18
//! says of edge-aligned PWM mode 1 counting up; whatever else a timer can do
//! is told to the run, which then fails.

use rigless::device::{Device, DeviceContext, RegisterFile};
use rigless::soc::RegisterSpec;
use rigless::soc::stm32f427::generated::tim3::{self, Register};

use crate::motors::CompareWrite;

/// Output channels of one timer.
pub(super) const CHANNELS: usize = 4;
const COMPARES: [Register; CHANNELS] = [
    Register::Ccr1,
    Register::Ccr2,
    Register::Ccr3,
    Register::Ccr4,
];
/// Registers that decide whether an output pulses.
const CONTROLS: [Register; 6] = [
    Register::Cr1,
    Register::Ccer,
    Register::Ccmr1Input,
    Register::Ccmr1Output,
    Register::Ccmr2Input,
    Register::Ccmr2Output,
];
const NANOS: u128 = 1_000_000_000;
/// CR1: CEN, URS, ARPE and CKD are played, UDIS, OPM, DIR and CMS are not.
const CEN: u64 = 1 << 0;
const URS: u64 = 1 << 2;
const ARPE: u64 = 1 << 7;
const CR1_NOT_PLAYED: u64 = 0b111_1010;
const UPDATE_FLAG: u64 = 1 << 0;
const PRELOAD: u64 = 1 << 3;
const PWM_MODE_1: u64 = 0b110 << 4;
/// One channel's byte of CCMR without the preload enable.
const MODE_MASK: u64 = 0xFF & !PRELOAD;

/// One timer with four pulse outputs.
#[derive(Debug)]
pub(super) struct PwmTimer {
    first_motor: usize,
    clock_hz: u64,
    /// Start of the running period: an instant, and cycles since then.
    epoch_ns: u64,
    segment_cycle: u128,
    running: bool,
    prescaler: u64,
    reload: u64,
    /// Prescaler and period that the next update event brings into force.
    preloaded: (u64, u64),
    updated: bool,
    /// Bit `n` is set while channel `n`'s output pulses.
    driven: u8,
    /// Compare writes since the board last took them.
    pub(super) writes: Vec<CompareWrite>,
}

impl PwmTimer {
    /// A timer out of reset whose channel 1 is motor `first_motor`.
    pub(super) fn new(first_motor: usize) -> Self {
        Self {
            first_motor,
            clock_hz: 0,
            epoch_ns: 0,
            segment_cycle: 0,
            running: false,
            prescaler: 0,
            reload: 0xFFFF,
            preloaded: (0, 0xFFFF),
            updated: false,
            driven: 0,
            writes: Vec::new(),
        }
    }

    /// Time between two update events, in ns; none while it stands still.
    pub(super) fn period_ns(&self) -> Option<u64> {
        let nanos = self.period_cycles() * NANOS;
        (self.running && self.clock_hz > 0).then(|| (nanos / u128::from(self.clock_hz)) as u64)
    }

    /// Outputs that pulse, as bits of the board's motors.
    pub(super) fn driven(&self) -> u8 {
        self.driven << self.first_motor
    }

    fn period_cycles(&self) -> u128 {
        u128::from(self.prescaler + 1) * u128::from(self.reload + 1)
    }

    fn cycles_at(&self, now_ns: u64) -> u128 {
        u128::from(now_ns - self.epoch_ns) * u128::from(self.clock_hz) / NANOS
    }

    /// The first update event after now, in ns.
    fn next_update_ns(&self, now_ns: u64) -> u64 {
        if !self.running || self.clock_hz == 0 {
            return now_ns;
        }
        let cycle = self.segment_cycle + self.period_cycles();
        let since = (cycle * NANOS).div_ceil(u128::from(self.clock_hz));
        self.epoch_ns + since as u64
    }

    /// Carries out the update events due by `now_ns`.
    fn settle(&mut self, now_ns: u64) {
        if !self.running || self.clock_hz == 0 {
            return;
        }
        let now = self.cycles_at(now_ns);
        if now < self.segment_cycle + self.period_cycles() {
            return;
        }
        self.segment_cycle += self.period_cycles();
        self.transfer();
        let passed = (now - self.segment_cycle) / self.period_cycles();
        self.segment_cycle += passed * self.period_cycles();
    }

    /// An update event: the preloaded prescaler and period come into force.
    fn transfer(&mut self) {
        (self.prescaler, self.reload) = self.preloaded;
        self.updated = true;
    }

    /// EGR.UG: an update event now; under URS it sets no flag.
    fn update_by_software(&mut self, now_ns: u64, registers: &RegisterFile) {
        let flagged = self.updated || registers.get(Register::Cr1) & URS == 0;
        self.transfer();
        self.updated = flagged;
        self.restart(now_ns);
    }

    fn restart(&mut self, now_ns: u64) {
        self.epoch_ns = now_ns;
        self.segment_cycle = 0;
    }

    fn write_control(&mut self, registers: &RegisterFile, context: &mut DeviceContext<'_>) {
        let control = registers.get(Register::Cr1);
        let running = control & CEN != 0;
        if running && !self.running {
            self.restart(context.now().0);
        }
        self.running = running;
        if control & CR1_NOT_PLAYED != 0 {
            context.tell("CR1", "selects UDIS, OPM, down or centre-aligned counting");
        }
    }

    fn write_compare(
        &mut self,
        channel: usize,
        registers: &RegisterFile,
        context: &mut DeviceContext<'_>,
    ) {
        let now_ns = context.now().0;
        let (prescaler, reload) = if self.running {
            (self.prescaler, self.reload)
        } else {
            self.preloaded
        };
        let ticks = (registers.get(COMPARES[channel]) & 0xFFFF).min(reload + 1);
        let cycles = u128::from(ticks) * u128::from(prescaler + 1);
        let pulse_ns = (cycles * NANOS) / u128::from(self.clock_hz.max(1));
        let preloaded = self.mode(channel, registers) & PRELOAD != 0;
        self.writes.push(CompareWrite {
            at_ns: now_ns,
            applied_ns: match preloaded {
                true => self.next_update_ns(now_ns),
                false => now_ns,
            },
            motor: self.first_motor + channel,
            pulse_ns: pulse_ns as u32,
            driven: self.driven >> channel & 1 != 0,
        });
    }

    /// The channel's byte of CCMR1 or CCMR2.
    fn mode(&self, channel: usize, registers: &RegisterFile) -> u64 {
        let modes = match channel / 2 {
            0 => registers.get(Register::Ccmr1Output),
            _ => registers.get(Register::Ccmr2Output),
        };
        modes >> (8 * (channel % 2)) & 0xFF
    }

    /// After a change of control, mode or enable: which outputs pulse now.
    fn look_at_outputs(&mut self, registers: &RegisterFile, context: &mut DeviceContext<'_>) {
        self.driven = 0;
        for channel in 0..CHANNELS {
            let enable = registers.get(Register::Ccer) >> (4 * channel) & 0xF;
            if enable & 1 == 0 || !self.running {
                continue;
            }
            if enable != 1 {
                context.tell("CCER", "drives a motor output with inverted polarity");
            } else if self.mode(channel, registers) & MODE_MASK != PWM_MODE_1 {
                context.tell(
                    "CCMR",
                    "drives a motor output in another mode than PWM mode 1",
                );
            } else {
                self.driven |= 1 << channel;
            }
        }
    }
}

impl Device for PwmTimer {
    type Register = Register;

    fn layout(&self) -> &'static [RegisterSpec] {
        &tim3::REGISTERS
    }

    fn on_clock(&mut self, hz: u64, _: &mut RegisterFile, context: &mut DeviceContext<'_>) {
        let now_ns = context.now().0;
        self.settle(now_ns);
        let into = match self.clock_hz {
            0 => 0,
            _ => self.cycles_at(now_ns).saturating_sub(self.segment_cycle),
        };
        self.clock_hz = hz;
        // The part of the period already counted stays counted.
        let elapsed = (into * NANOS).checked_div(u128::from(hz)).unwrap_or(0);
        self.restart(now_ns.saturating_sub(elapsed as u64));
    }

    fn read(
        &mut self,
        register: Register,
        _: &mut RegisterFile,
        context: &mut DeviceContext<'_>,
    ) -> Option<u64> {
        let now_ns = context.now().0;
        self.settle(now_ns);
        match register {
            Register::Cnt if self.running => {
                let cycles = self.cycles_at(now_ns) - self.segment_cycle;
                Some((cycles / u128::from(self.prescaler + 1)) as u64)
            }
            Register::Sr => Some(u64::from(self.updated) * UPDATE_FLAG),
            _ => None,
        }
    }

    fn write(
        &mut self,
        register: Register,
        value: u64,
        registers: &mut RegisterFile,
        context: &mut DeviceContext<'_>,
    ) {
        let now_ns = context.now().0;
        self.settle(now_ns);
        match register {
            Register::Cr1 => self.write_control(registers, context),
            Register::Egr if value & 1 != 0 => self.update_by_software(now_ns, registers),
            Register::Psc => self.preloaded.0 = value & 0xFFFF,
            Register::Arr => {
                self.preloaded.1 = value & 0xFFFF;
                if registers.get(Register::Cr1) & ARPE == 0 {
                    self.reload = self.preloaded.1;
                }
            }
            Register::Sr => self.updated &= value & UPDATE_FLAG != 0,
            Register::Ccr1 => self.write_compare(0, registers, context),
            Register::Ccr2 => self.write_compare(1, registers, context),
            Register::Ccr3 => self.write_compare(2, registers, context),
            Register::Ccr4 => self.write_compare(3, registers, context),
            Register::Dier if value != 0 => {
                context.tell("DIER", "enables interrupts or DMA of a motor timer");
            }
            Register::Smcr if value != 0 => {
                context.tell("SMCR", "makes a motor timer a slave");
            }
            _ => {}
        }
        if CONTROLS.contains(&register) {
            self.look_at_outputs(registers, context);
        }
    }

    fn reset(&mut self) {
        *self = Self {
            clock_hz: self.clock_hz,
            writes: std::mem::take(&mut self.writes),
            ..Self::new(self.first_motor)
        };
    }
}
