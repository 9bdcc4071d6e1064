//! The processor as this board has it: the emulator's part, completed.
//!
//! Ours are [`Exti`], [`Syscfg`], [`PwmTimer`], and with the inertial sensor's bus [`I2c`],
//! [`OpenDrainPort`] and [`SlowDma`]; everything else is the emulator's. The sensors' interrupt pins and the frames of the
//! link change at instants the part cannot know, so it asks for a stop at the
//! next of them and looks at every stop what has changed.

use rigless::device::{Device, ErasedDevice, Level, ResetCause};
use rigless::machine::{Board, Target, armv7m};
use rigless::mcu::{Mcu, Operate};
use rigless::snapshot::Store;
use rigless::soc::stm32f427::Stm32f427;
use rigless::soc::stm32f427::generated::{dma2, rcc};
use rigless::soc::stm32f427::peripherals::adc::Channel;
use rigless::soc::stm32f427::peripherals::dma::Dma;
use rigless::soc::stm32f427::peripherals::gpio::Pin;
use rigless::soc::{Bus, Error};
use rigless::time::VirtualNanos;

use std::num::{NonZeroU32, NonZeroU64};
use std::sync::Arc;

use super::dma::SlowDma;
use super::exti::Exti;
use super::i2c::{I2c, SharedWires};
use super::link::Link;
use super::meter::SharedMeter;
use super::metered::MeteredCore;
use super::open_drain::OpenDrainPort;
use super::pwm_timer::{CHANNELS, PwmTimer};
use super::reflex_f427::{
    BATTERY_ADC, BATTERY_CHANNELS, CRYSTAL_HZ, IMU_BUS, IMU_PORT, LINE_PORT_NUMBER, LINK_USART,
    MOTOR_TIMERS,
};
use super::sensors::Sensors;
use super::syscfg::Syscfg;
use crate::bus_fault::Script;
use crate::{Edge, SensorLine};

/// Supply of the processor, in mV.
const SUPPLY_MV: u32 = 3_300;
/// Core clock that the firmware sets up.
const CORE_HZ: NonZeroU64 = NonZeroU64::new(168_000_000).expect("not zero");
/// Slots of the models that answer in place of the emulator's own.
#[derive(Clone, Copy, Debug)]
struct Slots {
    exti: usize,
    syscfg: usize,
    timers: [usize; 2],
    rcc: usize,
    imu_bus: usize,
    imu_port: usize,
    dma: usize,
}

/// The STM32F427 with the sensors and the link on its pins.
#[derive(Debug)]
pub(super) struct Part {
    pub(super) soc: Stm32f427,
    exti: Exti,
    pub(super) syscfg: Syscfg,
    pub(super) timers: [PwmTimer; 2],
    imu_bus: I2c,
    imu_port: OpenDrainPort,
    dma: SlowDma,
    script: Arc<Script>,
    slots: Slots,
    sensors: Sensors,
    pub(super) link: Link,
    levels: [bool; SensorLine::ALL.len()],
    next_change_ns: u64,
    armed_ns: u64,
    /// Edges since the run loop last took them.
    pub(super) edges: Vec<Edge>,
}

impl Part {
    /// A part out of reset with its crystal, supply, sensors and link, and what disturbs it.
    pub(super) fn new(sensors: Sensors, link: Link, script: Script) -> Result<Self, Error> {
        let mut soc = Stm32f427::new()?;
        soc.rcc.attach_crystals(CRYSTAL_HZ, 0);
        soc.set_supply(SUPPLY_MV);
        soc.adc[BATTERY_ADC].set_reference(SUPPLY_MV);
        sensors.attach(&mut soc);
        soc.usart[LINK_USART].attach_boxed(Box::new(link.clone()));
        let [first, second] = MOTOR_TIMERS;
        let slots = Slots {
            exti: soc.bus().slot("EXTI")?,
            syscfg: soc.bus().slot("SYSCFG")?,
            timers: [soc.bus().slot(first)?, soc.bus().slot(second)?],
            rcc: soc.bus().slot("RCC")?,
            imu_bus: soc.bus().slot(IMU_BUS)?,
            imu_port: soc.bus().slot(IMU_PORT)?,
            dma: soc.bus().slot("DMA1")?,
        };
        let script = Arc::new(script);
        let wires = SharedWires::new(Arc::clone(&sensors.imu), Arc::clone(&script));
        let [controller, _] = &mut soc.dma;
        let controller = std::mem::replace(controller, Dma::new(&[], &[], false));
        let mut part = Self {
            soc,
            exti: Exti::default(),
            syscfg: Syscfg::default(),
            timers: [PwmTimer::new(0), PwmTimer::new(CHANNELS)],
            imu_bus: I2c::new(wires.clone()),
            imu_port: OpenDrainPort::new(wires),
            dma: SlowDma::new(controller, Arc::clone(&script)),
            script,
            slots,
            sensors,
            link,
            levels: [false; SensorLine::ALL.len()],
            next_change_ns: 0,
            armed_ns: u64::MAX,
            edges: Vec::new(),
        };
        part.drive_outside(VirtualNanos(0));
        Ok(part)
    }

    /// Motor outputs that pulse, a bit each.
    pub(super) fn driven(&self) -> u8 {
        self.timers
            .iter()
            .fold(0, |driven, timer| driven | timer.driven())
    }

    /// The crystal stops.
    pub(super) fn lose_crystal(&mut self, at: VirtualNanos) {
        self.soc.drive_clocks(at, |rcc, registers, context| {
            rcc.fail_hse(registers, context)
        });
    }

    /// What the battery's divider and shunt put on their pins, mV.
    pub(super) fn measure(&mut self, millivolts: [u32; 2]) {
        for (channel, millivolts) in BATTERY_CHANNELS.into_iter().zip(millivolts) {
            let channel = Channel::new(channel).expect("one of sixteen");
            self.soc.adc[BATTERY_ADC].set_input(channel, millivolts);
        }
    }

    /// Puts on the pins what the board holds there at a reset.
    fn drive_outside(&mut self, at: VirtualNanos) {
        let (registers, mut context) = self.soc.bus_mut().drive(at, self.slots.imu_port);
        self.imu_port.sample(registers, &mut context);
        let (_, mut context) = self.soc.bus_mut().drive(at, self.slots.imu_bus);
        self.imu_bus.start(&mut context);
        for line in SensorLine::ALL {
            self.drive_pin(at, LINE_PORT_NUMBER, line.pin(), self.levels[line as usize]);
        }
    }

    fn drive_pin(&mut self, at: VirtualNanos, port: usize, pin: u8, level: bool) {
        let pin = Pin::new(pin).expect("a port has sixteen pins");
        self.soc.drive_port(at, port, |gpio, registers, context| {
            gpio.drive(pin, Some(Level::from(level)), registers, context);
        });
    }

    /// Carries changes of the sensors' pins to the port and to the EXTI.
    fn look_at_sensors(&mut self, now: VirtualNanos) {
        if now.0 >= self.next_change_ns {
            self.sensors.advance(now.0);
        }
        if std::mem::take(&mut self.syscfg.changed) {
            self.reselect_lines();
        }
        let (mut levels, mut next_change_ns) = self.sensors.lines();
        for line in SensorLine::ALL {
            let level = &mut levels[line as usize];
            let (disturbed, next_ns) = self.script.line(line, *level, now.0);
            *level = disturbed;
            next_change_ns = next_change_ns.min(next_ns);
        }
        self.next_change_ns = next_change_ns;
        if levels == self.levels {
            return;
        }
        let ports = self.syscfg.ports();
        for line in SensorLine::ALL {
            let (index, rising) = (line as usize, levels[line as usize]);
            if rising == self.levels[index] {
                continue;
            }
            self.levels[index] = rising;
            self.edges.push(Edge {
                at_ns: now.0,
                line,
                rising,
            });
            self.drive_pin(now, LINE_PORT_NUMBER, line.pin(), rising);
            if usize::from(ports[usize::from(line.pin())]) == LINE_PORT_NUMBER {
                let (registers, mut context) = self.soc.bus_mut().drive(now, self.slots.exti);
                self.exti
                    .set_line(line.pin(), rising, registers, &mut context);
            }
        }
    }

    fn reselect_lines(&mut self) {
        let ports = self.syscfg.ports();
        for line in SensorLine::ALL {
            let heard = usize::from(ports[usize::from(line.pin())]) == LINE_PORT_NUMBER;
            self.exti
                .reselect(line.pin(), heard && self.levels[line as usize]);
        }
    }

    /// Asks for a stop at the next instant something outside changes.
    fn arm(&mut self, now: VirtualNanos) {
        let link_ns = self.link.next_start();
        // A frame that is due but not begun waits for the line, not for time.
        let link_ns = if link_ns <= now.0 { u64::MAX } else { link_ns };
        let next_ns = self.next_change_ns.min(link_ns);
        if next_ns != self.armed_ns && next_ns != u64::MAX {
            self.armed_ns = next_ns;
            let (_, mut context) = self.soc.bus_mut().drive(now, self.slots.exti);
            context.schedule(VirtualNanos(next_ns));
        }
    }
}

impl Mcu for Part {
    fn bus(&self) -> &Bus {
        self.soc.bus()
    }

    fn bus_mut(&mut self) -> &mut Bus {
        self.soc.bus_mut()
    }

    fn reset(&mut self, at: VirtualNanos, cause: ResetCause) {
        self.soc.reset(at, cause);
        Device::reset(&mut self.exti);
        Device::reset(&mut self.syscfg);
        self.timers.iter_mut().for_each(Device::reset);
        Device::reset(&mut self.imu_bus);
        Device::reset(&mut self.imu_port);
        Device::reset(&mut self.dma);
        self.armed_ns = u64::MAX;
        self.drive_outside(at);
        self.arm(at);
    }

    fn poll(&mut self, now: VirtualNanos) {
        self.look_at_sensors(now);
        self.soc.poll(now);
        self.arm(now);
    }

    fn split(&mut self, slot: usize) -> (&mut Bus, Option<&mut dyn ErasedDevice>) {
        let Self {
            soc,
            exti,
            syscfg,
            timers,
            imu_bus,
            imu_port,
            dma,
            slots,
            ..
        } = self;
        let ours: &mut dyn ErasedDevice = if slot == slots.exti {
            exti
        } else if slot == slots.timers[0] {
            &mut timers[0]
        } else if slot == slots.timers[1] {
            &mut timers[1]
        } else if slot == slots.imu_bus {
            let streams = soc.bus().slots()[slots.dma].registers();
            imu_bus.dma_left = match dma2::s0cr::EN.is_set(streams.get(dma2::Register::S0cr)) {
                true => streams.get(dma2::Register::S0ndtr),
                false => 0,
            };
            imu_bus
        } else if slot == slots.imu_port {
            imu_port
        } else if slot == slots.dma {
            dma
        } else if slot == slots.syscfg {
            let enables = soc.bus().slots()[slots.rcc].registers();
            let enabled = rcc::apb2enr::SYSCFGEN.is_set(enables.get(rcc::Register::Apb2enr));
            syscfg.clocked = enabled;
            syscfg
        } else {
            return soc.split(slot);
        };
        (soc.bus_mut(), Some(ours))
    }
}

/// The board as the emulator knows it: one part, no other targets.
#[derive(Debug)]
pub(super) struct Rig {
    pub(super) part: Part,
    /// How fast the core is, whatever its clock: buses and timers keep theirs.
    pub(super) instructions_per_second: NonZeroU64,
    /// Counts what the core executes.
    pub(super) meter: SharedMeter,
}

impl Store for Rig {}

impl Board for Rig {
    fn name(&self) -> &'static str {
        "reflex"
    }

    fn target_names(&self) -> Vec<&'static str> {
        vec!["stm32f427"]
    }

    fn mcu(&mut self, target: usize) -> Option<&mut dyn Mcu> {
        (target == 0).then_some(&mut self.part)
    }

    fn targets(&mut self) -> Vec<Target<'_>> {
        let lines = u32::from(self.part.cpu().interrupt_lines);
        let mut core = armv7m::Core {
            variant: armv7m::Variant::M4,
            clock_hz: CORE_HZ,
            interrupt_lines: NonZeroU32::new(lines).expect("a part with interrupts"),
            priority_bits: 4,
            refclk_divider: NonZeroU32::new(8).expect("not zero"),
            instructions_per_second: self.instructions_per_second,
            boot: "flash",
        }
        .spec_with_parts(
            &rigless::cpu::armv7m::windows(self.part.bus()),
            armv7m::Fpu::FpV4Sp,
            armv7m::MpuRegions::Eight,
        );
        let (plain, meter) = (Arc::clone(&core.processor), self.meter.clone());
        core.processor =
            Arc::new(move |endian| Ok(Box::new(MeteredCore::new(plain(endian)?, meter.clone()))));
        vec![Target::new("stm32f427", &mut self.part, core)]
    }
}
