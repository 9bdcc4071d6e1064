//! Made-up aerobatics: sensors that agree on flights that nobody recorded.
//!
//! A body turns as a script says, in gusts; its attitude turns gravity's reaction, drag and the
//! Earth's field into what its sensors measure, on a frame that vibrates. The same seed gives the
//! same flight.

use chip_models::stimulus::STANDARD_GRAVITY;
use nalgebra::{UnitQuaternion, Vector3};
use rand_distr::{Distribution, StandardNormal, Uniform};
use random_streams::{Generator, generator};
use recorded_flights::{
    Flight, LogFormat, PartReason, Recorded, Rotation, RotationReason, Skipped, Span, Taken, Track,
    seconds,
};

/// Time between samples in ns: twice as often as the inertial sensor takes them.
const PERIOD_NS: i64 = 500_000;
/// The Earth's field in gauss: north, east, down.
const FIELD: [f64; 3] = [0.22, 0.03, 0.42];
/// Specific force of drag per speed, in 1/s.
const DRAG: f64 = 0.3;
/// How long (s) a gust lasts.
const GUST_S: f64 = 0.2;
/// Hover before the manoeuvres, in s: the models are learned in it.
const LEAD_S: f64 = 6.0;

/// What the body turns by in a part of a flight.
#[derive(Clone, Copy, Debug)]
pub enum Turn {
    /// About its own axes, in rad.
    By(Vector3<f64>),
    /// The short way to this attitude.
    To(UnitQuaternion<f64>),
}

/// A part of a flight.
#[derive(Clone, Copy, Debug)]
pub struct Part {
    /// What it turns by: slow at both ends, twice the mean rate in the middle.
    pub turn: Turn,
    /// Its length in s.
    pub length_s: f64,
    /// What the rotors lift, in g; downwards where they turn backwards.
    pub lift: f64,
}

/// How rough a flight is, drawn once.
struct Roughness {
    gusts: f64,
    vibration_hz: f64,
    vibration: f64,
    noise: f64,
}

/// Draws numbers for scripts and noise.
pub struct Dice(Generator);

impl Dice {
    /// Evenly between two numbers.
    pub fn between(&mut self, low: f64, high: f64) -> f64 {
        let even = Uniform::new(low, high).expect("in order");
        even.sample(&mut self.0)
    }

    /// 1 or -1.
    pub fn sign(&mut self) -> f64 {
        self.between(-1.0, 1.0).signum()
    }

    /// A vector whose components are normal, of this standard deviation.
    pub fn normal(&mut self, deviation: f64) -> Vector3<f64> {
        Vector3::from_fn(|_, _| {
            let drawn: f64 = StandardNormal.sample(&mut self.0);
            drawn * deviation
        })
    }
}

/// The body in flight.
#[derive(Default)]
struct Body {
    attitude: UnitQuaternion<f64>,
    velocity: Vector3<f64>,
    gust: Vector3<f64>,
}

/// A flight of a script, which is given the seed's dice.
pub fn flight(name: &str, seed: u64, script: impl FnOnce(&mut Dice) -> Vec<Part>) -> Flight {
    let mut dice = Dice(generator(seed, 0));
    let rough = Roughness {
        gusts: dice.between(0.1, 0.6),
        vibration_hz: dice.between(70.0, 240.0),
        vibration: dice.between(0.0, 0.15),
        noise: dice.between(0.002, 0.02),
    };
    let lead = Part {
        turn: Turn::By(Vector3::zeros()),
        length_s: LEAD_S,
        lift: 1.0,
    };
    let mut script = script(&mut dice);
    script.insert(0, lead);
    let (mut gyro, mut accel, mut mag) = (Track::new(), Track::new(), Track::new());
    let (mut body, mut at_ns) = (Body::default(), 0);
    for part in script {
        let turn = match part.turn {
            Turn::By(turn) => turn,
            Turn::To(attitude) => (body.attitude.inverse() * attitude).scaled_axis(),
        };
        let steps = (part.length_s * 1e9) as i64 / PERIOD_NS;
        for step in 0..steps {
            let way = (step as f64 + 0.5) / steps as f64;
            let bell = 1.0 - (std::f64::consts::TAU * way).cos();
            let rates = turn * (bell / part.length_s) + body.gust;
            let force = body.step(rates, part.lift, &rough, &mut dice);
            let phase = std::f64::consts::TAU * rough.vibration_hz * seconds(at_ns);
            let shake =
                Vector3::new(phase.sin(), phase.cos(), (0.97 * phase).sin()) * rough.vibration;
            gyro.push(at_ns, (rates + shake + dice.normal(rough.noise)).into());
            accel.push(
                at_ns,
                (force + shake * 20.0 + dice.normal(10.0 * rough.noise)).into(),
            );
            if at_ns % 10_000_000 == 0 {
                let field = body.attitude.inverse() * Vector3::from(FIELD);
                mag.push(at_ns, (field + dice.normal(0.003)).into());
            }
            at_ns += PERIOD_NS;
        }
    }
    logged(format!("{name}, seed {seed}"), gyro, accel, mag)
}

/// A flight as a log that tells no more than what sensors felt.
fn logged(name: String, gyro: Track<3>, accel: Track<3>, mag: Track<3>) -> Flight {
    let duration_ns = gyro.last_time_ns().expect("a lead at least");
    Flight {
        name,
        format: LogFormat::Csv,
        duration_ns,
        part: Taken {
            span: Span {
                from_ns: 0,
                to_ns: duration_ns,
            },
            reason: PartReason::NothingShowsFlight,
        },
        skipped: Skipped::default(),
        notes: Vec::new(),
        rotation: Rotation::NONE,
        rotation_reason: RotationReason::Named,
        gyro,
        accel,
        mag: Some(mag),
        motors: None,
        recorded: Recorded::default(),
        gaps: Vec::new(),
    }
}

impl Body {
    /// Turns and moves on by a sample; the specific force that is felt in it.
    fn step(
        &mut self,
        rates: Vector3<f64>,
        lift: f64,
        rough: &Roughness,
        dice: &mut Dice,
    ) -> Vector3<f64> {
        let dt = seconds(PERIOD_NS);
        let drag = self.attitude.inverse() * self.velocity * -DRAG;
        let force = Vector3::new(0.0, 0.0, -lift * STANDARD_GRAVITY) + drag;
        let gravity = Vector3::new(0.0, 0.0, STANDARD_GRAVITY);
        self.velocity += (self.attitude * force + gravity) * dt;
        self.attitude *= UnitQuaternion::from_scaled_axis(rates * dt);
        // Of a steady deviation, whatever the step.
        let push = dice.normal(rough.gusts * (2.0 * dt / GUST_S).sqrt());
        self.gust += push - self.gust * (dt / GUST_S);
        force
    }
}
