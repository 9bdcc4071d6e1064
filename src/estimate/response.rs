//! Whether the body answers the motors: lost ones, and wrong rates.
//!
//! Torque and lift that the command asks for, behind the motors' lag, are held against those that
//! gyroscope and accelerometer show, a hundred times a second, whether control runs or not.
//!
//! | torque is answered | lift | then |
//! |---|---|---|
//! | the wrong way round, towards a motor | that of about one motor is missing | [`Unanswered::Motor`] |
//! | for long, though more of one motor is asked for all the time | the same | the same |
//! | exactly the wrong way round | is there | [`Unanswered::Rates`] |
//!
//! The second row is for loops so fast that the others make up for a motor at once.
//!
//! Inertia is not known here, so that signs and directions count, and sizes only beside those of
//! one motor. What pushes a body from outside is answered by control at once; against a lost
//! motor, or by wrong rates, the more is asked for the less comes of it. A body that does not do
//! as it is asked even when all is well, as that of a recorded flight, says nothing about motors:
//! a verdict counts only where both agreed before. Wrong rates count as well in the first seconds
//! in the air, as those of a sensor that was mounted another way.

use crate::airframe::{Asked, Mixer};
use crate::math::{RunningMean, Vec3, max, sqrt, towards};
use crate::time::{Duration, Instant, micros, seconds, span};

/// Between two looks.
const LOOK: Duration = micros(8_000);
/// Behind a longer gap (s) the memory is no good.
const GAP: f32 = 0.05;
/// Time constant (s) of common motors with their rotors.
const LAG: f32 = 0.03;
/// Time constants (s): of the torque that balances the body; of an agreement now, and usually.
const TRIM: f32 = 2.0;
const NOW: f32 = 0.08;
const USUAL: f32 = 5.0;
/// So long (s) a drone is new in the air: a sensor that was mounted another way shows at once.
const FIRST: f32 = 2.0;
/// Time constants (s) that take the noise off motion, and off lift.
const SMOOTH: f32 = 0.05;
const SMOOTH_LIFT: f32 = 0.03;
/// The least share that lift is related to.
const LEAST_LIFT: f32 = 0.1;

/// What is asked for counts from a third of a motor on; what is answered from this, in rad/s2.
const ASKED: f32 = 0.3;
const ANSWERED: f32 = 4.0;
/// Cosines between asked and answered, with their signs, squared: of a loss, of wrong rates, and
/// of a body that usually does as it is asked.
const AGAINST: f32 = -0.5;
const REVERSED: f32 = -0.8;
const AGREES: f32 = 0.09;
/// How fast the last fades, in 1/s: what is lost spoils it at once.
const FADING: f32 = 0.1;
/// For so many looks in a row.
const LOOKS: u8 = 3;
const LOOKS_REVERSED: u8 = 6;
/// So many motors' torque that is asked for, in so many looks in a row, in vain.
const LEANT: f32 = 0.5;
const LOOKS_LEANT: u8 = 50;
/// Time constant (s) that takes turns back and forth off it.
const LEANING: f32 = 0.5;
/// Motors whose lift is missing where one is lost; with less none is.
const ONE_MOTOR: core::ops::Range<f32> = 0.5..2.5;
/// Cosine between the way that the body falls, or is held up, and the motor that is lost.
const TOWARDS: f32 = 0.9;
/// What tells two motors of one arm apart: which way the body is turned.
const SPIN: f32 = 0.1;

/// What a body does not answer.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Unanswered {
    /// A motor, from 0, gives no lift.
    Motor(u8),
    /// The body turns the other way: rates have wrong signs or axes, or motors wrong places.
    Rates,
}

/// How far two vectors agree over a time.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
struct Agreement {
    product: f32,
    asked: f32,
    answered: f32,
}

impl Agreement {
    fn take(&mut self, asked: [f32; 2], answered: Vec3, share: f32) {
        let [x, y] = asked;
        self.product += (x * answered.x + y * answered.y - self.product) * share;
        self.asked += (x * x + y * y - self.asked) * share;
        self.answered +=
            (answered.x * answered.x + answered.y * answered.y - self.answered) * share;
    }

    /// The cosine between both, squared, with its sign.
    fn cosine(&self) -> f32 {
        self.product * self.product.abs() / max(self.asked * self.answered, 1e-9)
    }
}

/// What was asked of the motors, and what the body did.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Response {
    before: Option<(Instant, Vec3)>,
    /// What motors that lag give of the command.
    given: Asked,
    /// The torque that balances the body.
    trim: [f32; 2],
    /// Of the lift (m/s2) of a whole share, in flight.
    lift: RunningMean,
    /// How many motors' lift is missing.
    missing: f32,
    asked: [f32; 2],
    leaning: [f32; 2],
    answered: Vec3,
    now: Agreement,
    usual: Agreement,
    /// The best usual agreement of late.
    agreed: f32,
    against: u8,
    leant: u8,
    reversed: u8,
}

impl Response {
    /// True where it is time to look.
    #[inline]
    #[must_use]
    pub fn is_due(&self, now: Instant) -> bool {
        self.before.is_none_or(|(at, _)| span(at, now) >= LOOK)
    }

    /// Takes the filtered rates (rad/s) and specific force (m/s2), and what the command in force
    /// asks of motors that a mixer knows.
    #[inline(never)]
    pub fn look(
        &mut self,
        at: Instant,
        [rates, force]: [Vec3; 2],
        asked: &Asked,
        mixer: &Mixer,
    ) -> Option<Unanswered> {
        let (since, before) = self.before.replace((at, rates))?;
        let dt = seconds(span(since, at));
        if dt > GAP {
            *self = Self {
                before: self.before,
                ..Self::default()
            };
            return None;
        }
        self.follow(dt, asked);
        self.compare((rates - before) * (1.0 / dt), dt);
        self.weigh_lift(-force.z, dt, mixer.motors());
        let found = self.judge(mixer);
        if found.is_some() {
            (self.against, self.leant, self.reversed) = (0, 0, 0);
            self.now = Agreement::default();
        }
        found
    }

    /// Motors follow the command, and the balance follows them.
    fn follow(&mut self, dt: f32, asked: &Asked) {
        self.given = self.given.towards(asked, dt / (LAG + dt));
    }

    fn compare(&mut self, answered: Vec3, dt: f32) {
        let share = |time: f32| dt / (time + dt);
        let [roll, pitch] = self.given.motors(LEAST_LIFT);
        self.trim = towards(self.trim, [roll, pitch], share(TRIM));
        let asked = [roll - self.trim[0], pitch - self.trim[1]];
        self.now.take(asked, answered, share(NOW));
        self.asked = towards(self.asked, asked, share(SMOOTH));
        self.leaning = towards(self.leaning, asked, share(LEANING));
        self.answered += (answered - self.answered) * share(SMOOTH);
        self.usual.take(self.asked, self.answered, share(USUAL));
        self.agreed = max(self.usual.cosine(), self.agreed - dt * FADING);
        let large = self.now.asked > ASKED * ASKED && self.now.answered > ANSWERED * ANSWERED;
        let cosine = self.now.cosine();
        self.against = counted(self.against, large && cosine < AGAINST);
        self.reversed = counted(self.reversed, large && cosine < REVERSED);
    }

    fn weigh_lift(&mut self, felt: f32, dt: f32, motors: usize) {
        let lift = felt / max(self.given.lift, LEAST_LIFT);
        self.lift.take(lift, dt, USUAL);
        let missing = (1.0 - lift / max(self.lift.value(), 1.0)) * motors as f32;
        self.missing += (missing - self.missing) * (dt / (SMOOTH_LIFT + dt));
    }

    fn judge(&mut self, mixer: &Mixer) -> Option<Unanswered> {
        let answered = self.agreed > AGREES;
        // In a shorter time gusts agree by chance.
        let known = answered && self.lift.behind() >= USUAL;
        let agreed = known && ONE_MOTOR.contains(&self.missing);
        let [x, y] = self.leaning;
        self.leant = counted(self.leant, agreed && x * x + y * y > LEANT * LEANT);
        let held_up = Vec3::new(x, y, 0.0);
        let lost = if agreed && self.against >= LOOKS {
            self.motor_below(mixer, -self.answered)
        } else if self.leant >= LOOKS_LEANT {
            self.motor_below(mixer, held_up)
        } else {
            None
        };
        let judged = answered || self.lift.behind() < FIRST;
        let lifts = self.missing < ONE_MOTOR.start;
        let wrong = self.reversed >= LOOKS_REVERSED && lifts && judged;
        lost.map(Unanswered::Motor)
            .or(wrong.then_some(Unanswered::Rates))
    }

    /// The motor whose lift would turn the body this way.
    #[inline(never)] // Hardly ever.
    fn motor_below(&self, mixer: &Mixer, way: Vec3) -> Option<u8> {
        let [roll, pitch, yaw] = mixer.axes();
        let way = Vec3::new(way.x, way.y, 0.0);
        let mut best = (TOWARDS, None);
        for (motor, ((x, y), spin)) in (0..).zip(roll.iter().zip(pitch).zip(yaw)) {
            let arm = Vec3::new(*x, *y, 0.0);
            let towards = arm.dot(way) / max(sqrt(arm.dot(arm) * way.dot(way)), 1e-6);
            let turned = if spin * self.answered.z < 0.0 {
                SPIN
            } else {
                0.0
            };
            if towards > TOWARDS && towards + turned > best.0 {
                best = (towards + turned, Some(motor));
            }
        }
        best.1
    }
}

/// How many looks in a row something has held.
fn counted(looks: u8, holds: bool) -> u8 {
    if holds { looks.saturating_add(1) } else { 0 }
}

#[cfg(test)]
mod tests;
