//! The reference board: MPU6050 on I2C, LSM303AGR on SPI, eight motors, one link.
//!
//! [`start`] brings the chip up and hands its parts to the tasks of `main.rs`. Pins:
//!
//! | signal | pin | peripheral |
//! |---|---|---|
//! | LSM303AGR SCK, MISO, MOSI | PA5, PA6, PA7 | SPI1, mode 3, 5.25 MHz; MISO and MOSI joined by a resistor |
//! | LSM303AGR chip selects | PA4 accelerometer, PC4 magnetometer | outputs |
//! | LSM303AGR INT_1_XL, INT_MAG | PC1, PC2 | EXTI1, EXTI2, rising |
//! | MPU6050 SCL, SDA | PB8, PB9 | I2C1, 400 kHz; DMA1 stream 0 |
//! | MPU6050 INT | PC0 | EXTI0, rising; TIM2 knows when it is due |
//! | motors 1 to 4, 5 to 8 | PC6 to PC9, PD12 to PD15 | TIM3, TIM4 |
//! | link TX, RX | PD5, PD6 | USART2; DMA1 streams 6, 5 |
//! | battery's voltage, current | PC3, PC5 | ADC1; DMA2 stream 0 |
//! | crystal | PH0, PH1 | 8 MHz |

mod battery;
mod chips;
mod flash;
mod i2c;
pub mod imu;
mod imu_line;
mod link_port;
pub mod motors;
mod spi;

pub use battery::Gauge;
pub use chips::Chips;
pub use i2c::Engine;
pub use imu_line::ImuLine;
pub use motors::Motors;

use cortex_m::singleton;
use embedded_hal_bus::util::AtomicCell;
use reflex::airframe::Mixer;
use reflex::config::LINK_WIRED;
use reflex::link::SigningKey;
use reflex::reset::Reset;
use reflex::sensors::Input;
use reflex::tasks::link;
use stm32f4xx_hal::dma::StreamsTuple;
use stm32f4xx_hal::gpio::{self, AnyPin, Output, PinState, Pull, gpioa, gpioc, gpiod};
use stm32f4xx_hal::syscfg::SysCfg;
use stm32f4xx_hal::{pac, prelude::*};

use super::keeper;
use super::lines::Line;
use super::settings_block::Given;
use super::watchdog::{self, Watchdog};
use super::{clock, reset};

/// The crystal in Hz.
const CRYSTAL_HZ: u32 = 8_000_000;

/// The link over its port.
pub type Link = link::Link<link_port::LinkPort>;

/// What a restart must not forget, in this board's flash.
pub type Keeper = keeper::Keeper<flash::Flash>;

/// The interrupt of a sensor with a clock of its own, and the input that it announces.
pub type ChipLine = (Input, Line<AnyPin<gpio::Input>>);

/// The chip's parts, started, each for its task.
pub struct Board {
    /// MPU6050 interrupts.
    pub imu_line: ImuLine,
    /// MPU6050 bursts.
    pub imu_bus: Engine,
    /// Interrupts of the chips with clocks of their own, a task for each.
    pub chip_lines: [ChipLine; Input::OF_CHIPS.len()],
    /// Those chips.
    pub chips: Chips,
    /// The motors, all at the shortest pulse.
    pub motors: Motors,
    /// The link.
    pub link: Link,
    /// The battery.
    pub gauge: Gauge,
    /// What a restart must not forget.
    pub keeper: Keeper,
    /// Running, to be fed from the failsafe timer.
    pub watchdog: Watchdog,
    /// Why it started.
    pub reset: Reset,
    /// What this start was given.
    pub start: Given,
    /// The mixer of its airframe: made before the sensors start, as it takes longer than they wait.
    pub mixer: Mixer,
}

/// Brings the chip up; 105 ms, of which the MPU6050 takes 100 to wake. Motors stand still.
///
/// # Panics
/// Where it is called twice: the buffers of the DMA controller exist once.
#[inline(never)] // Its frame is given back before the autopilot is made.
pub fn start(mut core: cortex_m::Peripherals, device: pac::Peripherals) -> Board {
    // A probe keeps its connection, and the log flowing, while the core sleeps.
    device.DBGMCU.cr().modify(|_, w| w.dbg_sleep().set_bit());
    let mut watchdog = Watchdog::start(device.IWDG, &device.DBGMCU);
    let reset = reset::take(&device.RCC, &device.FLASH);
    let rcc = &mut clock::start(device.RCC, CRYSTAL_HZ.Hz());
    // The clock runs: from here on the log has time stamps.
    reset::tell(&reset);
    watchdog::warn_of_halts(&device.DBGMCU);
    let (keeper, start, stored) = Keeper::start(flash::Flash::new(device.FLASH));
    let mixer = Mixer::new(&start.airframe);
    let (a, b) = (device.GPIOA.split(rcc), device.GPIOB.split(rcc));
    let (c, d) = (device.GPIOC.split(rcc), device.GPIOD.split(rcc));
    let streams = StreamsTuple::new(device.DMA1, rcc);

    let count = start.airframe.count();
    motor_pins(
        (c.pc6, c.pc7, c.pc8, c.pc9),
        (d.pd12, d.pd13, d.pd14, d.pd15),
        count,
    );
    let protocol = start.settings.motors;
    let motors = Motors::start(device.TIM3, device.TIM4, protocol, count, rcc);

    let mut lines = (device.SYSCFG.constrain(rcc), device.EXTI);
    let line = Line::on_rise(c.pc0.into_pull_down_input(), &mut lines);
    let chip_lines = chip_lines((c.pc1, c.pc2), &mut lines);

    d.pd5.into_alternate::<7>();
    d.pd6.into_alternate::<7>().internal_resistor(Pull::Up);
    let ring = singleton!(: [u8; link_port::RING] = [0; link_port::RING]).unwrap();
    let block = singleton!(: [u8; link_port::BLOCK] = [0; link_port::BLOCK]).unwrap();
    let (streams_of_link, buffers) = ((streams.5, streams.6), (ring, block));
    let port = link_port::LinkPort::start(device.USART2, streams_of_link, buffers, rcc);

    let converter = (device.ADC1, device.ADC_COMMON, &device.DMA2);
    let gauge = Gauge::start(converter, (c.pc3, c.pc5), rcc);

    let spi = spi::Spi1::new(device.SPI1, (a.pa5, a.pa6, a.pa7), rcc, &mut core.SCB);
    let spi = singleton!(: AtomicCell<spi::Spi1> = AtomicCell::new(spi)).unwrap();
    let chips = chips::start(spi, chip_selects(a.pa4, c.pc4), &start.settings);

    let (scl, sda) = (
        b.pb8.into_alternate_open_drain(),
        b.pb9.into_alternate_open_drain(),
    );
    let mut bus = i2c::Bus::new(device.I2C1, scl, sda, rcc);
    imu::start(&mut bus);
    let buffer = singleton!(: i2c::Buffer = i2c::Buffer::default()).unwrap();
    let mut imu_bus = Engine::new(streams.0, buffer);
    imu_bus.give_back(bus, &Ok(()));
    let imu_line = ImuLine::new(line, lines.1, device.TIM2, rcc);
    watchdog.feed();
    let link = link(port, count, stored.key);
    Board {
        imu_line,
        imu_bus,
        chip_lines,
        chips,
        motors,
        link,
        gauge,
        keeper,
        watchdog,
        reset,
        start,
        mixer,
    }
}

/// The link, which goes on with the key of an earlier start.
fn link(port: link_port::LinkPort, motors: usize, key: Option<SigningKey>) -> Link {
    let mut link = Link::new(port, LINK_WIRED, motors);
    if let Some(key) = key {
        link.restore(clock::now(), key);
    }
    link
}

/// The pins on which sensors with clocks of their own interrupt.
fn chip_lines(
    (accel, mag): (gpioc::PC1, gpioc::PC2),
    controller: &mut (SysCfg, pac::EXTI),
) -> [ChipLine; Input::OF_CHIPS.len()] {
    let pins = [
        (Input::ChipAccel, accel.into_pull_down_input().erase()),
        (Input::ChipMag, mag.into_pull_down_input().erase()),
    ];
    pins.map(|(input, pin)| (input, Line::on_rise(pin, controller)))
}

/// Their chip selects, in the order of the inputs.
fn chip_selects(accel: gpioa::PA4, mag: gpioc::PC4) -> [AnyPin<Output>; Input::OF_CHIPS.len()] {
    let high = PinState::High;
    [
        accel.into_push_pull_output_in_state(high).erase(),
        mag.into_push_pull_output_in_state(high).erase(),
    ]
}

/// Hands all four pins of each timer that the airframe's motors need to it.
fn motor_pins(
    first: (gpioc::PC6, gpioc::PC7, gpioc::PC8, gpioc::PC9),
    second: (gpiod::PD12, gpiod::PD13, gpiod::PD14, gpiod::PD15),
    count: usize,
) {
    first.0.into_alternate::<2>();
    first.1.into_alternate::<2>();
    first.2.into_alternate::<2>();
    first.3.into_alternate::<2>();
    if count > 4 {
        second.0.into_alternate::<2>();
        second.1.into_alternate::<2>();
        second.2.into_alternate::<2>();
        second.3.into_alternate::<2>();
    }
}
