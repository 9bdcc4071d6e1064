//! Thresholds in SI units become codes rounded down, never 0.
//!
//! Checked against the weights of the datasheet, in two places: the drivers'
//! codes, and what the chips hold behind the orders that the firmware gives
//! when a model is swapped in.

use std::cell::RefCell;
use std::convert::Infallible;
use std::rc::Rc;

use embedded_hal::spi::{ErrorType, Operation, SpiDevice};
use reflex::airframe::Mixer;
use reflex::app::{Autopilot, ChipAction, ChipSetting, Next};
use reflex::config::SETTINGS;
use reflex::control::Setpoint;
use reflex::graph::CONFIGURED;
use reflex::link::{ArmCommand, Message};
use reflex::math::Vec3;
use reflex::reactive::{Fit, Logistic, Phase, Refit};
use reflex::sensors::{Cause, ChipSample, Input};
use reflex::settings::{Settings, Start, WarmUp};
use reflex::tasks::chips::Chips;
use reflex::tasks::drivers::Drivers;
use reflex::tasks::imu::Imu;
use reflex::tasks::mpu6050::Sensor;
use reflex::time::{at_micros, micros};
use reflex::units::Thrust;
use reflex_drivers::lsm303agr::{AccelFullScale, AccelThreshold, MagThreshold};
use reflex_drivers::mpu6050::{MotionThreshold, NOMINAL_MOTION_STEP};
use reflex_drivers::quantity::{Gauss, MetersPerSecondSquared};
use reflex_drivers::threshold::ThresholdError;

use super::ports::SpiPort;
use chip_models::stimulus::STANDARD_GRAVITY;
use chip_models::testing::{exact, lively};
use chip_models::{DIES, OfDies, OwnClock};

/// mg per count of INT1_THS_A.
const ACCEL_MG: [(AccelFullScale, f64); 4] = [
    (AccelFullScale::G2, 16.0),
    (AccelFullScale::G4, 32.0),
    (AccelFullScale::G8, 62.0),
    (AccelFullScale::G16, 186.0),
];
/// Gauss per count of INT_THS_M.
const MAG_GAUSS: f64 = 1.5e-3;
/// Room for `f32`: three of its roundings.
const ROUNDING: f64 = 3.0 / 16_777_216.0;

/// Values within a code, from its own level to just below the next one's.
fn within(code: u16, step: f64) -> [f32; 4] {
    let level = f64::from(code) * step;
    [1e-6, 0.25, 0.75, 1.0 - 1e-6].map(|share| {
        // A share of the step, but not less than what `f32` can tell apart.
        let inside = (share * step).clamp(level * ROUNDING, step - (level + step) * ROUNDING);
        (level + inside) as f32
    })
}

/// `round_down` must answer with the code for everything within it.
fn rounds_down<T: std::fmt::Debug + PartialEq>(
    (largest, step): (u16, f64),
    code_of: impl Fn(u16) -> T,
    round_down: impl Fn(f32) -> Result<T, ThresholdError>,
) {
    for value in within(0, step) {
        assert_eq!(round_down(value), Err(ThresholdError::BelowOneStep));
    }
    for code in 1..=largest {
        for value in within(code, step) {
            assert_eq!(round_down(value), Ok(code_of(code)), "{value} {code}");
        }
    }
    let beyond = (f64::from(largest) * 3.0 * step) as f32;
    assert_eq!(round_down(beyond), Ok(code_of(largest)));
}

#[test]
fn every_value_becomes_the_code_below_it_by_the_datasheet_s_weights() {
    for (scale, milli_g) in ACCEL_MG {
        rounds_down(
            (127, milli_g * 1e-3 * STANDARD_GRAVITY),
            |code| AccelThreshold::from_code(code as u8).expect("1 to 127"),
            |value| AccelThreshold::round_down(MetersPerSecondSquared(value), scale),
        );
    }
    rounds_down(
        (u16::MAX, MAG_GAUSS),
        |code| MagThreshold::from_code(code).expect("not 0"),
        |value| MagThreshold::round_down(Gauss(value)),
    );
    rounds_down(
        (255, 32e-3 * STANDARD_GRAVITY),
        |code| MotionThreshold::from_code(code as u8).expect("1 to 255"),
        |value| MotionThreshold::round_down(MetersPerSecondSquared(value), NOMINAL_MOTION_STEP),
    );
}

/// A die that its driver and the test share.
struct Port(Rc<RefCell<Box<dyn OwnClock>>>);

impl ErrorType for Port {
    type Error = Infallible;
}

impl SpiDevice for Port {
    fn transaction(&mut self, operations: &mut [Operation<'_, u8>]) -> Result<(), Infallible> {
        let (mut chip, now_ns) = (self.0.borrow_mut(), 0);
        let chip = chip.as_mut();
        SpiPort { chip, now_ns }.transaction(operations)
    }
}

/// What an order left in a chip: its threshold code, `None` where it interrupts at every sample.
#[derive(Debug, PartialEq)]
struct Programmed(Option<u32>);

/// The firmware's autopilot in flight, under reactive control, with its chips.
struct Flight {
    autopilot: Autopilot<()>,
    now: u64,
    dies: OfDies<Rc<RefCell<Box<dyn OwnClock>>>>,
    chips: Drivers<Port>,
}

impl Flight {
    fn reactive() -> Self {
        let settings = Settings {
            warm_up: WarmUp::Fixed(micros(4_000_000)),
            ..SETTINGS
        };
        let dies = DIES.map(|die| Rc::new(RefCell::new((die.model)(lively(), exact()))));
        let ports = dies.each_ref().map(|die| Port(Rc::clone(die)));
        let mut flight = Self {
            autopilot: Autopilot::new(
                &Start {
                    settings,
                    ..CONFIGURED
                },
                &Mixer::default(),
                (),
            ),
            now: 0,
            dies,
            chips: Drivers::new(ports, &settings),
        };
        flight.milliseconds(600, |_| 0);
        flight.tell(&Message::Setpoint(Setpoint::default()));
        flight.tell(&Message::Arm(ArmCommand::ARM));
        flight.milliseconds(8000, gusty);
        assert_eq!(flight.autopilot.telemetry().phase, Phase::Reactive);
        flight
    }

    fn tell(&mut self, message: &Message) {
        let _ = self.autopilot.on_message(at_micros(self.now), message);
    }

    /// Time passes; once armed, a pilot holds it in the air.
    fn milliseconds(&mut self, count: u64, rate: impl Fn(u64) -> i16) {
        for _ in 0..count {
            self.millisecond(rate(self.now + 1000));
            let now = at_micros(self.now);
            while let Some(job) = self.autopilot.refit_due(now) {
                self.autopilot.on_refit(now, job.fit());
            }
        }
    }

    /// A millisecond passes; true where control ran.
    fn millisecond(&mut self, rate: i16) -> bool {
        self.now += 1000;
        let now = at_micros(self.now);
        if self.now.is_multiple_of(500_000) && self.autopilot.telemetry().state.is_armed() {
            let hover = Setpoint::level(Thrust::new(0.5).expect("in range"));
            self.tell(&Message::Setpoint(hover));
        }
        let failsafe = self.autopilot.deadline() <= now && self.autopilot.on_timer(now).is_some();
        let ended = self.turn(rate) == Next::Hyperperiod;
        ended && self.autopilot.on_hyperperiod(now).is_some() || failsafe
    }

    /// A sample of a drone at rest that turns about roll, in counts, with a sensor's noise.
    fn turn(&mut self, rate: i16) -> Next {
        let mut reading = Sensor::reading(&burst(rate)).expect("data ready");
        let noise = |axis: u64| {
            let mixed = (self.now / 1000 * 3 + axis).wrapping_mul(0x9E37_79B9_7F4A_7C15);
            (mixed >> 60) as f32 * 1e-3
        };
        reading.rates.0 += Vec3::new(noise(0), noise(1), noise(2));
        reading.force.0 += Vec3::new(noise(3), noise(4), noise(5));
        self.autopilot.on_imu(at_micros(self.now), &reading)
    }

    /// A chip that falls silent, or repeats itself, is not left to compare.
    fn deliver_samples(&mut self) {
        let now = at_micros(self.now);
        let axes = Vec3::new(self.now as f32 * 1e-6, 0.0, -9.8);
        for input in Input::OF_CHIPS {
            let sample = ChipSample {
                input,
                axes,
                cause: Cause::DataReady,
            };
            let _ = self.autopilot.on_chip(now, &sample);
        }
    }

    /// Swaps a model in; the threshold it has, and what the order that programs it left in the
    /// chip.
    fn program(&mut self, input: Input, threshold: f32) -> (f64, Option<Programmed>) {
        self.deliver_samples();
        let b1 = SETTINGS.p_run.ln() - (1.0 - SETTINGS.p_run).ln() - threshold;
        let fit = Fit::Model(Logistic { b1, b2: 1.0 });
        self.autopilot
            .on_refit(at_micros(self.now), Refit { input, fit });
        // What a refit means is judged with the next run.
        while !self.millisecond(gusty(self.now)) {}
        let now = at_micros(self.now);
        let mut programs = None;
        while let Some(order) = self.autopilot.next_order() {
            let obeyed = self.chips.execute(order).expect("the bus works");
            self.autopilot.on_order_done(now, order, Ok(obeyed.setting));
            let upkeep = !matches!(
                order.action,
                ChipAction::DataReady | ChipAction::Threshold(_)
            );
            if order.input == input && !upkeep {
                let mut dies = Input::OF_CHIPS.into_iter().zip(&self.dies);
                let (_, die) = dies.find(|(of, _)| *of == input).expect("of a chip");
                let held = Programmed(die.borrow().pin_threshold());
                let compares = matches!(obeyed.setting, ChipSetting::PastThreshold { .. });
                assert_eq!(held.0.is_some(), compares);
                programs = Some(held);
            }
        }
        (f64::from(self.autopilot.threshold(input)), programs)
    }
}

/// A gust every quarter second over a little noise, in counts.
fn gusty(now: u64) -> i16 {
    let noise = ((now / 1000).wrapping_mul(2_654_435_761) >> 7) % 9;
    let gust = if now / 1000 % 250 < 60 { 400 } else { 0 };
    noise as i16 - 4 + gust
}

/// A burst of a drone at rest that turns about roll.
fn burst(rate: i16) -> [u8; 15] {
    let [high, low] = rate.to_be_bytes();
    let [down, down_low] = (-2048_i16).to_be_bytes();
    [1, 0, 0, 0, 0, down, down_low, 0, 0, high, low, 0, 0, 0, 0]
}

/// A code's threshold must not exceed the model's, and the next code's must.
fn assert_rounded_down(code: u32, step: f64, threshold: f64) {
    let level = f64::from(code) * step;
    assert!(
        code >= 1 && level <= threshold * (1.0 + ROUNDING),
        "{code} {threshold}"
    );
    let next = level + step;
    assert!(next > threshold * (1.0 - ROUNDING), "{code} {threshold}");
}

#[test]
fn the_firmware_orders_every_accelerometer_code_rounded_down_and_never_0() {
    let step = 0.016 * STANDARD_GRAVITY;
    let mut flight = Flight::reactive();
    for wanted in 1..=127 {
        for value in within(wanted, step) {
            // Without a change of code nothing is ordered: one that is far away first.
            let far = if wanted < 64 { 400.0 } else { 0.5 * step };
            let (_, order) = flight.program(Input::ChipAccel, far as f32);
            assert!(
                matches!(order, None | Some(Programmed(Some(1 | 127)))),
                "{order:?}"
            );
            let (threshold, order) = flight.program(Input::ChipAccel, value);
            let Some(Programmed(Some(code))) = order else {
                panic!("{threshold} {order:?}");
            };
            assert_rounded_down(code, step, threshold);
        }
    }
    flight.program(Input::ChipAccel, 0.0);
    let (_, order) = flight.program(Input::ChipAccel, 400.0);
    assert_eq!(order, Some(Programmed(Some(127))), "the largest code");
}

#[test]
fn the_firmware_orders_magnetometer_codes_rounded_down_and_never_0() {
    let mut flight = Flight::reactive();
    let codes = super::magnetometer::codes();
    for wanted in codes.into_iter().filter(|code| *code < 32_767) {
        for value in within(wanted, MAG_GAUSS) {
            let far = if wanted < 1000 { 200.0 } else { 0.5e-3 };
            let (_, order) = flight.program(Input::ChipMag, far);
            assert!(
                matches!(order, None | Some(Programmed(Some(1 | 32_767)))),
                "{order:?}"
            );
            let (threshold, order) = flight.program(Input::ChipMag, value);
            let Some(Programmed(Some(code))) = order else {
                panic!("{threshold} {order:?}");
            };
            assert_rounded_down(code, MAG_GAUSS, threshold);
        }
    }
    flight.program(Input::ChipMag, 0.0);
    let (_, order) = flight.program(Input::ChipMag, 200.0);
    assert_eq!(order, Some(Programmed(Some(32_767))), "the largest code");
}
