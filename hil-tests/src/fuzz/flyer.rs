//! A board in small around the autopilot: holds calls and commands to account.

use reflex::airframe::MotorShares;
use reflex::app::{
    Autopilot, Call, ChipAction, ChipOrder, ChipSetting, LONGEST_RECORD, Next, Recorder, Stamped,
};
use reflex::config::MOTOR_TEST_SHARE;
use reflex::control::Setpoint;
use reflex::graph::ControlLogic;
use reflex::link::{ArmCommand, Message};
use reflex::math::Vec3;
use reflex::safety::{FlightState, MotorOutput};
use reflex::sensors::{GRAVITY, ImuReading};
use reflex::time::{Instant, at_micros};
use reflex::units::{BodyRates, SpecificForce, Thrust};

use crate::logics::{AnyLogic, Start};

/// Most that is asked of the autopilot at an instant: none of its queues is longer.
const MOST: usize = 1000;

/// Records every call, which must be read back as it was written.
#[derive(Default)]
pub(super) struct Written(pub(super) Vec<u8>);

impl Recorder for Written {
    fn record(&mut self, at: Instant, call: &Call) {
        if let Call::Ran(ran) = call {
            hold(&ran.shares);
        }
        let (mut first, mut second) = ([0; LONGEST_RECORD], [0; LONGEST_RECORD]);
        let written = Stamped { at, call: *call }.encode(&mut first);
        let (read, length) = Stamped::decode(written).expect("what was written can be read");
        assert_eq!(length, written.len(), "{call:?}");
        assert_eq!(read.encode(&mut second), written, "{call:?}");
        self.0.extend_from_slice(written);
    }
}

/// The autopilot, and the board's time.
pub(super) struct Flyer {
    pub(super) autopilot: Autopilot<Written, AnyLogic>,
    /// In us.
    pub(super) now: u64,
    /// When the hyperperiod is to be ended.
    due: Option<Instant>,
}

impl Flyer {
    pub(super) fn new(start: &Start) -> Self {
        Self {
            autopilot: start.autopilot(Written::default()),
            now: 0,
            due: None,
        }
    }

    /// Calibrates, arms and flies at half thrust.
    pub(super) fn take_off(&mut self) {
        self.pass(600, 1.0);
        self.fly_at(0.0);
        self.tell(&Message::Arm(ArmCommand::ARM));
        self.fly_at(0.5);
    }

    pub(super) fn at(&self) -> Instant {
        at_micros(self.now)
    }

    /// Lets time pass with samples of a drone at rest, with so much noise.
    pub(super) fn pass(&mut self, milliseconds: u64, noise: f32) {
        for _ in 0..milliseconds {
            self.now += 1000;
            self.sense(&living(self.now, noise));
        }
        self.idle();
    }

    /// A sample, and all that the board does with it.
    pub(super) fn sense(&mut self, reading: &ImuReading) {
        let now = self.at();
        if self.autopilot.deadline() <= now {
            let output = self.autopilot.on_timer(now);
            self.write(output);
        }
        let next = self.autopilot.on_imu(now, reading);
        self.follow(next);
        if self.due.is_some_and(|due| due <= now) {
            self.due = None;
            self.end_hyperperiod();
        }
    }

    pub(super) fn tell(&mut self, message: &Message) {
        let (next, _) = self.autopilot.on_message(self.at(), message);
        self.follow(next);
    }

    fn fly_at(&mut self, thrust: f32) {
        let thrust = Thrust::new(thrust).expect("a share");
        self.tell(&Message::Setpoint(Setpoint::level(thrust)));
    }

    /// Does what a call asked for.
    pub(super) fn follow(&mut self, next: Next) {
        match next {
            Next::Wait => {}
            Next::Hyperperiod => self.end_hyperperiod(),
            Next::HyperperiodAt(at) => self.due = Some(self.due.map_or(at, |due| due.min(at))),
        }
    }

    pub(super) fn end_hyperperiod(&mut self) {
        let output = self.autopilot.on_hyperperiod(self.at());
        self.write(output);
    }

    /// Holds a command that would be written to the motors to what must hold of each.
    pub(super) fn write(&mut self, output: Option<MotorOutput>) {
        let Some(output) = output else {
            return;
        };
        let (shares, state) = (output.share(), self.autopilot.telemetry().state);
        hold(&shares);
        let motors = self.autopilot.logic().mixed().shares.len();
        assert_eq!(shares.len(), motors, "a command for each motor");
        let turning = shares.iter().filter(|share| **share > 0.0).count();
        match state {
            FlightState::Testing => {
                let most = shares.iter().copied().fold(0.0, f32::max);
                assert!(
                    turning <= 1 && most <= MOTOR_TEST_SHARE,
                    "a test turns {shares:?}"
                );
            }
            state if !state.is_armed() => assert_eq!(turning, 0, "{state:?} turns {shares:?}"),
            _ => {}
        }
        assert!(
            self.autopilot.telemetry().attitude.is_finite(),
            "the attitude is no number"
        );
    }

    /// Carries orders out, fits models, sounds slopes, empties the queues.
    pub(super) fn idle(&mut self) {
        let now = self.at();
        self.ends("orders", |pilot| {
            let order = pilot.next_order()?;
            pilot.on_order_done(now, order, Ok(obeyed(order)));
            Some(())
        });
        self.ends("refits", |pilot| {
            let job = pilot.refit_due(now)?;
            pilot.on_refit(now, job.fit());
            Some(())
        });
        if let Some(sounding) = self.autopilot.sounding_due(now) {
            for column in sounding.columns() {
                self.autopilot.on_column(now, column);
            }
            self.autopilot.on_sounded(now);
        }
        self.ends("events", |pilot| pilot.next_event().map(drop));
        self.ends("notices", |pilot| pilot.notice().map(|_| pilot.on_told()));
    }

    fn ends(
        &mut self,
        what: &str,
        mut step: impl FnMut(&mut Autopilot<Written, AnyLogic>) -> Option<()>,
    ) {
        for _ in 0..MOST {
            if step(&mut self.autopilot).is_none() {
                return;
            }
        }
        panic!("{what} do not end");
    }
}

/// Every share is a number from 0 to 1.
fn hold(shares: &MotorShares) {
    let all = shares.iter().all(|share| (0.0..=1.0).contains(share));
    assert!(all, "a command of {shares:?}");
}

/// What sensors that are alive read of a drone at rest.
fn living(now: u64, noise: f32) -> ImuReading {
    let breath = |axis: u64| {
        let mixed = (now / 1000 * 7 + axis).wrapping_mul(0x9E37_79B9_7F4A_7C15);
        noise * ((mixed >> 60) as f32 / 4.0 - 2.0)
    };
    let vector =
        |first, scale| Vec3::new(breath(first), breath(first + 1), breath(first + 2)) * scale;
    ImuReading {
        rates: BodyRates(vector(0, 0.001)),
        force: SpecificForce(Vec3::new(0.0, 0.0, -GRAVITY) + vector(3, 0.005)),
        temperature: 36.5 + breath(6) * 0.003,
    }
}

/// What a chip answers whose comparator has 127 steps of an eighth: levels and their codes are exact.
fn obeyed(order: ChipOrder) -> ChipSetting {
    const STEP: f32 = 0.125;
    let ChipAction::Threshold(change) = order.action else {
        return ChipSetting::EverySample;
    };
    let code = (change / STEP) as u8;
    let code = code.clamp(1, 127);
    let level = f32::from(code) * STEP;
    ChipSetting::PastThreshold {
        level,
        from: if code == 1 { f32::NEG_INFINITY } else { level },
        next: if code == 127 {
            f32::INFINITY
        } else {
            f32::from(code + 1) * STEP
        },
    }
}

#[cfg(test)]
mod tests {
    use clap::ValueEnum;
    use reflex::config::SETTINGS;

    use super::*;
    use crate::logics::LogicName;

    #[test]
    fn every_logic_takes_off_and_flies_on() {
        for logic in LogicName::value_variants() {
            let mut flyer = Flyer::new(&Start::configured(SETTINGS, logic.gains()));
            flyer.take_off();
            flyer.pass(500, 1.0);
            let state = flyer.autopilot.telemetry().state;
            assert_eq!(state, FlightState::Flying, "{logic:?}");
        }
    }
}
