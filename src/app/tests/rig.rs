//! A board that does what the firmware does, without one.

use super::*;

impl Recorder for Vec<Stamped> {
    fn record(&mut self, at: Instant, call: &Call) {
        self.push(Stamped { at, call: *call });
    }
}

/// The noise (counts) of an axis of a sensor that is alive, at an instant in us.
pub fn breath(now: u64, axis: u64) -> f32 {
    let mixed = (now / 1000 * 3 + axis).wrapping_mul(0x9E37_79B9_7F4A_7C15);
    (mixed >> 60) as f32 / 4.0 - 2.0
}

/// What sensors that are alive read at an instant.
pub fn felt(now: u64, rates: Vec3, force: Vec3) -> ImuReading {
    let breath = |first| {
        let [x, y, z] = [first, first + 1, first + 2].map(|axis| breath(now, axis));
        Vec3::new(x, y, z)
    };
    ImuReading {
        rates: BodyRates(rates + breath(0) * (core::f32::consts::PI / (180.0 * 16.4))),
        force: SpecificForce(force + breath(3) * (GRAVITY / 2048.0)),
        temperature: 36.53,
    }
}

/// A drone at rest that turns about roll at `rate` counts of a gyroscope with 16.4 per deg/s.
pub fn alive(rate: i16, now: u64) -> ImuReading {
    let rate = f32::from(rate) * (core::f32::consts::PI / (180.0 * 16.4));
    let mut reading = felt(now, Vec3::ZERO, Vec3::new(0.0, 0.0, -GRAVITY));
    reading.rates.0.x = rate;
    reading
}

/// At rest: the counts of a gyroscope's axis that is alive.
pub fn resting(now: u64) -> Option<i16> {
    Some(breath(now, 0) as i16)
}

/// Counts of an accelerometer with 16 per 0.98 mg.
pub fn force(counts: [i16; 3], cause: Cause) -> ChipSample {
    let axes = counts.map(|count| f32::from(count) * (GRAVITY * 0.000_98 / 16.0));
    ChipSample {
        input: Input::ChipAccel,
        axes: Vec3::from_array(axes),
        cause,
    }
}

/// What a chip answers whose comparator has steps of 0.1 m/s2 or gauss.
pub fn obeyed(order: ChipOrder) -> ChipSetting {
    const STEP: f32 = 0.1;
    match order.action {
        ChipAction::Threshold(change) if change >= STEP => {
            let steps = (change / STEP).floor();
            ChipSetting::PastThreshold {
                level: steps * STEP,
                from: steps * STEP,
                next: (steps + 1.0) * STEP,
            }
        }
        ChipAction::Threshold(_) => ChipSetting::PastThreshold {
            level: STEP,
            from: f32::NEG_INFINITY,
            next: 2.0 * STEP,
        },
        _ => ChipSetting::EverySample,
    }
}

/// A board that does what the firmware does, without one.
///
/// Whichever logic is built in: what is expected was worked out for the cascade.
pub struct Rig<L = Cascade> {
    pub autopilot: Autopilot<Vec<Stamped>, L>,
    pub now: u64,
    pub outputs: Vec<(u64, MotorShares)>,
}

impl Rig {
    pub fn new(settings: Settings) -> Self {
        Self::with_logic(settings, Cascade::default())
    }

    pub fn armed(settings: Settings) -> Self {
        Self::new(settings).readied()
    }
}

impl<L: ControlLogic> Rig<L> {
    pub fn with_logic(settings: Settings, logic: L) -> Self {
        Self {
            autopilot: Autopilot::with_logic(settings, Vec::new(), logic),
            now: 0,
            outputs: Vec::new(),
        }
    }

    /// The same, calibrated and armed, in the air with a setpoint of half thrust.
    pub fn readied(mut self) -> Self {
        self.milliseconds(600, resting);
        self.fly_at(0.0);
        assert_eq!(
            self.tell(&Message::Arm(ArmCommand::ARM)),
            Some(Answer::Accepted)
        );
        self.fly_at(0.5);
        self
    }

    /// Lets time pass while a pilot holds it level at half thrust.
    pub fn flown(&mut self, milliseconds: u64, mut rate: impl FnMut(u64) -> Option<i16>) {
        for _ in 0..milliseconds / 500 {
            self.fly_at(0.5);
            self.milliseconds(500, &mut rate);
        }
    }

    /// Tells it to fly level with a thrust.
    pub fn fly_at(&mut self, thrust: f32) {
        let thrust = Thrust::new(thrust).expect("in range");
        self.tell(&Message::Setpoint(Setpoint::level(thrust)));
    }

    /// Lets time pass with readings of a drone at rest that turns; none where the sensor is silent.
    pub fn milliseconds(&mut self, count: u64, mut rate: impl FnMut(u64) -> Option<i16>) {
        self.pass(count, |now| rate(now).map(|rate| alive(rate, now)));
    }

    /// Lets time pass with these readings.
    pub fn readings(&mut self, count: u64, mut reading: impl FnMut(u64) -> ImuReading) {
        self.pass(count, |now| Some(reading(now)));
    }

    fn pass(&mut self, count: u64, mut reading: impl FnMut(u64) -> Option<ImuReading>) {
        for _ in 0..count {
            self.now += 1000;
            let now = at_micros(self.now);
            if self.autopilot.deadline() <= now
                && let Some(output) = self.autopilot.on_timer(now)
            {
                self.outputs.push((self.now, output.share()));
            }
            if let Some(reading) = reading(self.now)
                && self.autopilot.on_imu(now, &reading) == Next::Hyperperiod
                && let Some(output) = self.autopilot.on_hyperperiod(now)
            {
                self.outputs.push((self.now, output.share()));
            }
            while let Some(job) = self.autopilot.refit_due(now) {
                self.autopilot.on_refit(now, job.fit());
            }
        }
    }

    pub fn tell(&mut self, message: &Message) -> Option<Answer> {
        let (_, answer) = self.autopilot.on_message(at_micros(self.now), message);
        answer
    }

    /// What the pilot was told since the last look.
    pub fn told_pilot(&mut self) -> Vec<String> {
        let lines = core::iter::from_fn(|| {
            let notice = self.autopilot.notice()?;
            self.autopilot.on_told();
            Some(String::from_utf8(notice.line().collect()).expect("ASCII"))
        });
        lines.collect()
    }

    pub fn phase(&self) -> Phase {
        self.autopilot.telemetry().phase
    }

    pub fn reasons(&mut self) -> Vec<Reason> {
        self.autopilot
            .recorder()
            .iter()
            .filter_map(|stamped| match stamped.call {
                Call::Ran(ran) => Some(ran.reason),
                _ => None,
            })
            .collect()
    }
}
