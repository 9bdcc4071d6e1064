//! The port of the inertial sensor's bus: its two pins are wires that others hold low as well.
//!
//! Everything else of the port is the emulator's. The pins drive the wires only while they are
//! outputs; handed to the peripheral, they are let go.

use rigless::device::{Device, DeviceContext, Level, RegisterFile};
use rigless::soc::RegisterSpec;
use rigless::soc::stm32f427::generated::gpioa::Register;
use rigless::soc::stm32f427::peripherals::gpio::{Gpio, Pin};

use super::i2c::{Levels, SharedWires};
use super::reflex_f427::{IMU_SCL, IMU_SDA};

const MODE_OUTPUT: u64 = 0b01;

/// The port, with the wires behind two of its pins.
#[derive(Debug)]
pub(super) struct OpenDrainPort {
    port: Gpio,
    wires: SharedWires,
}

impl OpenDrainPort {
    /// A port out of reset.
    pub(super) fn new(wires: SharedWires) -> Self {
        Self {
            port: Gpio::default(),
            wires,
        }
    }

    /// Puts on the pins what the wires carry now.
    pub(super) fn sample(&mut self, registers: &RegisterFile, context: &mut DeviceContext<'_>) {
        let Levels { scl, sda } = self.wires.lock().levels(context.now().0);
        for (pin, level) in [(IMU_SCL, scl), (IMU_SDA, sda)] {
            let pin = Pin::new(pin).expect("a port has sixteen pins");
            self.port
                .drive(pin, Some(Level::from(level)), registers, context);
        }
    }
}

/// Whether a pin lets its wire go.
fn lets_go(pin: u8, registers: &RegisterFile) -> bool {
    let output = registers.get(Register::Moder) >> (2 * pin) & 0b11 == MODE_OUTPUT;
    !output || registers.get(Register::Odr) >> pin & 1 != 0
}

impl Device for OpenDrainPort {
    type Register = Register;

    fn layout(&self) -> &'static [RegisterSpec] {
        self.port.layout()
    }

    fn read(
        &mut self,
        register: Register,
        registers: &mut RegisterFile,
        context: &mut DeviceContext<'_>,
    ) -> Option<u64> {
        if matches!(register, Register::Idr) {
            self.sample(registers, context);
        }
        self.port.read(register, registers, context)
    }

    fn write(
        &mut self,
        register: Register,
        value: u64,
        registers: &mut RegisterFile,
        context: &mut DeviceContext<'_>,
    ) {
        Device::write(&mut self.port, register, value, registers, context);
        let by_hand = Levels {
            scl: lets_go(IMU_SCL, registers),
            sda: lets_go(IMU_SDA, registers),
        };
        self.wires.lock().drive(context.now().0, by_hand);
    }

    fn reset(&mut self) {
        Device::reset(&mut self.port);
    }

    fn reset_line(&mut self, registers: &mut RegisterFile, context: &mut DeviceContext<'_>) {
        Device::reset_line(&mut self.port, registers, context);
    }
}
