//! Whether the firmware uses the pins and buffers that the board has wired.
//!
//! The emulator moves words between peripherals and chips without looking at
//! the pins between them, so a wrong alternate function would pass unnoticed.
//! Here the configuration is compared with the board's wiring.

use rigless::device::RegisterFile;
use rigless::mcu::Mcu;
use rigless::soc::stm32f427::generated::{dma2, exti, gpioa};

use super::part::Part;
use super::reflex_f427::{LINE_PORT, LINE_PORT_NUMBER, SensorLine, Use, Wire, motor_wire, wires};
use crate::motors::MOTORS;

/// Core-coupled memory, which the DMA controllers do not reach.
const CCM: std::ops::Range<u64> = 0x1000_0000..0x1001_0000;
const STREAM_BUFFERS: [(u8, dma2::Register); 8] = [
    (0, dma2::Register::S0m0ar),
    (1, dma2::Register::S1m0ar),
    (2, dma2::Register::S2m0ar),
    (3, dma2::Register::S3m0ar),
    (4, dma2::Register::S4m0ar),
    (5, dma2::Register::S5m0ar),
    (6, dma2::Register::S6m0ar),
    (7, dma2::Register::S7m0ar),
];

/// Every difference between the firmware's configuration and the wiring.
///
/// `driven` has a bit for each motor output that has been driven.
pub(super) fn problems(part: &Part, driven: u8) -> Vec<String> {
    let motors = (0..MOTORS)
        .filter(|motor| driven >> motor & 1 != 0)
        .map(motor_wire);
    let mut problems: Vec<String> = wires()
        .chain(motors)
        .filter_map(|wire| pin_problem(part, wire))
        .collect();
    problems.extend(line_problems(part));
    problems.extend(buffer_problems(part));
    problems
}

fn pin_problem(part: &Part, wire: Wire) -> Option<String> {
    let found = found_use(part.bus().registers(wire.port)?, u32::from(wire.pin));
    (found != Some(wire.uses)).then(|| {
        let Wire {
            signal, port, pin, ..
        } = wire;
        let found = found.map_or("analog".into(), describe);
        format!(
            "{}{pin} ({signal}) is {found}, not {}",
            short(port),
            describe(wire.uses)
        )
    })
}

/// A port as pins spell it: `PC` for `GPIOC`.
fn short(port: &str) -> String {
    port.replace("GPIO", "P")
}

/// How a pin is configured; none when it is analog.
fn found_use(registers: &RegisterFile, pin: u32) -> Option<Use> {
    let field = |register, shift: u32, width: u32| {
        registers.get::<gpioa::Register>(register) >> shift & ((1 << width) - 1)
    };
    let functions = match pin {
        0..8 => gpioa::Register::Afrl,
        _ => gpioa::Register::Afrh,
    };
    match field(gpioa::Register::Moder, 2 * pin, 2) {
        0 => Some(Use::Input),
        1 => Some(Use::Output),
        2 => Some(Use::Alternate {
            number: field(functions, 4 * (pin % 8), 4),
            open_drain: field(gpioa::Register::Otyper, pin, 1) != 0,
        }),
        _ => None,
    }
}

fn describe(uses: Use) -> String {
    match uses {
        Use::Input => "an input".into(),
        Use::Output => "an output".into(),
        Use::Alternate {
            number,
            open_drain: false,
        } => format!("AF{number} push-pull"),
        Use::Alternate {
            number,
            open_drain: true,
        } => format!("AF{number} open drain"),
    }
}

/// Unmasked external interrupts that listen at another port than the sensors'.
fn line_problems(part: &Part) -> Vec<String> {
    let Some(registers) = part.bus().registers("EXTI") else {
        return Vec::new();
    };
    let mask = registers.get(exti::Register::Imr);
    let ports = part.syscfg.ports();
    let wrong = SensorLine::ALL.into_iter().filter_map(|line| {
        let pin = line.pin();
        let port = ports[usize::from(pin)];
        (mask >> pin & 1 != 0 && usize::from(port) != LINE_PORT_NUMBER).then(|| {
            let listens = char::from(b'A' + port);
            let (name, wired) = (line.name(), short(LINE_PORT));
            format!("EXTI{pin} listens at P{listens}{pin}, but {name} is at {wired}{pin}")
        })
    });
    wrong.collect()
}

fn buffer_problems(part: &Part) -> Vec<String> {
    let Some(registers) = part.bus().registers("DMA1") else {
        return Vec::new();
    };
    let unreachable = STREAM_BUFFERS.into_iter().filter_map(|(stream, register)| {
        let address = registers.get(register);
        CCM.contains(&address).then(|| {
            format!("DMA1 stream {stream} has its buffer at {address:#010x} in the CCM, out of its reach")
        })
    });
    unreachable.collect()
}
