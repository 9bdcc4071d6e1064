//! The drone: its state, and its steps.

use std::cell::Cell;
use std::f64::consts::TAU;

use differential_equations::methods::ExplicitRungeKutta;
use differential_equations::ode::{ODE, OrdinaryNumericalMethod};
use nalgebra::{UnitQuaternion, Vector3};

use crate::environment::Environment;
use crate::faults::{Crash, Diverged, Divergence};
use crate::frame::Frame;
use crate::ground::{Anchors, Ground};
use crate::motion::{self, Flat, Loads, Motion};
use crate::range::Unfit;
use crate::state::State;
use crate::vehicle::{MAX_MOTORS, Vehicle};

mod watch;

use watch::Watch;

/// What is left of a battery's voltage at least, V: currents follow from powers.
const LEAST_VOLTAGE: f64 = 0.1;
/// Longest step of the integrator, s; a longer advance is split into equal ones.
const LONGEST_STEP: f64 = 1e-3;
/// Longest advance, s.
const LONGEST_ADVANCE: f64 = 0.1;
/// Body rate beyond which the flight is no flight, rad/s.
const HIGHEST_RATE: f64 = 200.0;
/// Speed beyond which the flight is no flight, m/s.
const HIGHEST_SPEED: f64 = 300.0;
/// Fastest wind accepted, m/s.
const FASTEST_WIND: f64 = 150.0;

/// Where a drone stands at the start.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Start {
    /// m.
    pub north: f64,
    /// m.
    pub east: f64,
    /// Where forward points, rad clockwise from north.
    pub heading: f64,
}

/// What perfect sensors in the centre of mass read, body axes.
///
/// Motion, vibration and constant biases.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Readings {
    /// Angular rates, rad/s.
    pub rates: Vector3<f64>,
    /// Acceleration less gravity, m/s2; -9.80665 along down at rest.
    pub specific_force: Vector3<f64>,
    /// The earth's magnetic field, gauss.
    pub magnetic_field: Vector3<f64>,
}

/// A vehicle in flight or on the ground.
#[derive(Clone, Debug)]
pub struct Drone {
    frame: Frame,
    ground: Ground,
    anchors: Anchors,
    magnetic_field: Vector3<f64>,
    state: State,
    loads: Loads,
    readings: Readings,
    watch: Watch,
    /// Share of its thrust that each motor gives.
    strengths: [f64; MAX_MOTORS],
    /// What the battery lacks of the voltage that its charge has, V.
    sag: f64,
}

impl Drone {
    /// A drone that stands level and still, its battery full.
    pub fn new(vehicle: &Vehicle, start: Start, environment: &Environment) -> Result<Self, Unfit> {
        let mut state = State::at_height(vehicle.skids.height - Ground::sag());
        state.position.x = start.north;
        state.position.y = start.east;
        state.attitude = UnitQuaternion::from_axis_angle(&Vector3::z_axis(), start.heading);
        Self::in_state(vehicle, state, environment)
    }

    /// A drone in any state, as in the middle of a flight.
    pub fn in_state(
        vehicle: &Vehicle,
        state: State,
        environment: &Environment,
    ) -> Result<Self, Unfit> {
        vehicle.check()?;
        environment.check()?;
        fault_of(&state).map_or(Ok(()), |what| Err(Unfit(format!("state: {what}"))))?;
        let frame = Frame::new(vehicle, environment);
        let none = Loads {
            force: Vector3::zeros(),
            power: 0.0,
            volts: 0.0,
        };
        let mut drone = Self {
            ground: Ground::new(&frame),
            anchors: Anchors::default(),
            magnetic_field: environment.magnetic_field,
            state,
            loads: none,
            readings: Readings {
                rates: Vector3::zeros(),
                specific_force: Vector3::zeros(),
                magnetic_field: Vector3::zeros(),
            },
            watch: Watch::default(),
            strengths: [1.0; MAX_MOTORS],
            sag: 0.0,
            frame,
        };
        drone.ground.settle(&state, &state, &mut drone.anchors);
        let wind = Vector3::zeros();
        let motion = drone.motion(wind, state.rotor_speeds);
        let mut unused: Flat = motion::flatten(&state);
        motion.diff(0.0, &motion::flatten(&state), &mut unused);
        drone.loads = motion.loads.get();
        drone.readings = drone.measure();
        Ok(drone)
    }

    /// Lets `dt` seconds pass, above 0 and at most 0.1, in steps of at most 1 ms.
    ///
    /// `throttles` are the shares of full throttle, 0 to 1, one for each motor in the vehicle's
    /// order and before the motor controller's resolution; 0 is a stopped motor. `wind` is the
    /// velocity of the air over the earth, m/s, north east down. On an error the drone is as it
    /// was before the step that failed.
    pub fn advance(
        &mut self,
        dt: f64,
        throttles: &[f64],
        wind: Vector3<f64>,
    ) -> Result<(), Diverged> {
        if let Some(what) = self.fault_in(dt, throttles, &wind) {
            return Err(self.diverged(what));
        }
        let sought = self.sought(throttles);
        let steps = (dt / LONGEST_STEP - 1e-9).ceil().max(1.0);
        for _ in 0..steps as u32 {
            self.step(dt / steps, sought, wind)?;
        }
        self.readings = self.measure();
        Ok(())
    }

    /// A motor gives this share of its thrust from now on, 0 to 1; one that the drone lacks is none.
    pub fn weaken(&mut self, motor: usize, share: f64) {
        if let Some(strength) = self.strengths.get_mut(motor) {
            *strength = share.clamp(0.0, 1.0);
        }
    }

    /// The battery holds at most this share of its charge from now on, has an inner resistance of its own, ohm,
    /// and gives some volts less than its charge says.
    pub fn wear_battery(&mut self, most_charge: f64, resistance: f64, sag: f64) {
        let charge = &mut self.state.state_of_charge;
        *charge = charge.min(most_charge.clamp(0.0, 1.0));
        self.frame.vehicle.battery.resistance = resistance.clamp(0.0, 10.0);
        self.sag = sag.max(0.0);
    }

    /// What the sensors read now.
    pub fn readings(&self) -> Readings {
        self.readings
    }

    /// All that changes in a flight.
    pub fn state(&self) -> &State {
        &self.state
    }

    /// The parameters.
    pub fn vehicle(&self) -> &Vehicle {
        &self.frame.vehicle
    }

    /// Height of the feet, were the drone level, m; 0 at rest on the ground.
    pub fn height(&self) -> f64 {
        -self.state.position.z - self.frame.vehicle.skids.height + Ground::sag()
    }

    /// Voltage at the battery's terminals, V.
    pub fn voltage(&self) -> f64 {
        self.loads.volts
    }

    /// Electric power drawn from the battery, W.
    pub fn power(&self) -> f64 {
        self.loads.power
    }

    /// Current of all motors, A.
    pub fn motor_current(&self) -> f64 {
        let of_motors = self.loads.power - self.frame.vehicle.propulsion.electronics;
        of_motors.max(0.0) / self.loads.volts
    }

    /// True while a foot or a hub touches the ground.
    pub fn is_on_ground(&self) -> bool {
        self.anchors.iter().any(Option::is_some)
    }

    /// The first crash: ground touched at over 2.5 m/s or a tilt over 60 degrees.
    pub fn crash(&self) -> Option<Crash> {
        self.watch.crash
    }

    /// When it had first been tilted over 90 degrees in the air for a second, ns.
    pub fn upset(&self) -> Option<u64> {
        self.watch.upset_ns
    }

    fn fault_in(&self, dt: f64, throttles: &[f64], wind: &Vector3<f64>) -> Option<Divergence> {
        let (motors, given) = (self.frame.rotors.len(), throttles.len());
        if motors != given {
            return Some(Divergence::Throttles { motors, given });
        }
        let unfit = |share: &f64| !(0.0..=1.0).contains(share);
        if let Some(motor) = throttles.iter().position(unfit) {
            let share = throttles[motor];
            return Some(Divergence::Throttle { motor, share });
        }
        if !(dt > 0.0 && dt <= LONGEST_ADVANCE) {
            return Some(Divergence::Step(dt));
        }
        let speed = wind.norm();
        let sound = (0.0..=FASTEST_WIND).contains(&speed);
        (!sound).then_some(Divergence::Wind(speed))
    }

    fn diverged(&self, what: Divergence) -> Diverged {
        Diverged {
            what,
            state: Box::new(self.state),
        }
    }

    /// Speeds that the motors seek with a full battery, rad/s.
    fn sought(&self, throttles: &[f64]) -> [f64; MAX_MOTORS] {
        let vehicle = &self.frame.vehicle;
        let mut sought = [0.0; MAX_MOTORS];
        let motors = throttles.iter().zip(&self.strengths);
        for (speed, (&throttle, strength)) in sought.iter_mut().zip(motors) {
            let reads = vehicle.esc.reads(throttle);
            let thrust = vehicle.propulsion.thrust_share(reads) * strength;
            *speed = vehicle.propulsion.full_speed * thrust.sqrt();
        }
        sought
    }

    fn open_voltage(&self) -> f64 {
        let battery = &self.frame.vehicle.battery;
        let charged = battery.open_circuit_voltage(self.state.state_of_charge);
        (charged - self.sag).max(LEAST_VOLTAGE)
    }

    fn motion(&self, wind: Vector3<f64>, sought: [f64; MAX_MOTORS]) -> Motion<'_> {
        Motion {
            frame: &self.frame,
            ground: &self.ground,
            anchors: &self.anchors,
            wind,
            sought,
            open_voltage: self.open_voltage(),
            loads: Cell::new(self.loads),
        }
    }

    fn step(
        &mut self,
        dt: f64,
        sought: [f64; MAX_MOTORS],
        wind: Vector3<f64>,
    ) -> Result<(), Diverged> {
        let motion = self.motion(wind, sought);
        let Some(flat) = integrate(&motion, dt, &motion::flatten(&self.state)) else {
            return Err(self.diverged(Divergence::NotFinite));
        };
        // The integrator looked at the end of the step last: what acts there is what sensors read.
        let loads = motion.loads.get();
        let mut next = self.state;
        motion::unflatten(&flat, &mut next);
        next.time_ns += (dt * 1e9).round() as u64;
        let turns = next.rotor_phases.iter_mut();
        let speeds = self.state.rotor_speeds.iter().zip(&next.rotor_speeds);
        for (phase, (before, after)) in turns.zip(speeds) {
            let turned = *phase + 0.5 * dt * (before + after);
            // Cheaper than a remainder, and the same: phases are not negative.
            *phase = turned - TAU * f64::from((turned * (1.0 / TAU)) as i32);
        }
        if let Some(what) = fault_of(&next) {
            return Err(self.diverged(what));
        }
        let touch = self.ground.settle(&self.state, &next, &mut self.anchors);
        self.state = next;
        self.loads = loads;
        self.watch.see(&next, touch, dt);
        Ok(())
    }

    fn measure(&self) -> Readings {
        let vehicle = &self.frame.vehicle;
        let (force, rates) = self.vibration();
        let to_body = self.state.attitude.inverse();
        Readings {
            rates: self.state.rates + rates + vehicle.biases.rates,
            specific_force: self.loads.force / vehicle.mass + force + vehicle.biases.specific_force,
            magnetic_field: to_body * self.magnetic_field,
        }
    }

    /// Specific force, m/s2, and rates, rad/s, of the rotors' imbalance and blades.
    fn vibration(&self) -> (Vector3<f64>, Vector3<f64>) {
        let shape = &self.frame.vehicle.vibration;
        let (mut once, mut twice) = (Vector3::zeros(), 0.0);
        let phases = self.state.rotor_phases.iter();
        let rotors = self.frame.rotors.iter().zip(&self.state.rotor_speeds);
        for ((rotor, speed), phase) in rotors.zip(phases) {
            let thrust = rotor.thrust * speed * speed;
            let (sine, cosine) = phase.sin_cos();
            once += Vector3::new(cosine, rotor.spin * sine, 0.0) * thrust;
            twice += (2.0 * cosine * cosine - 1.0) * thrust;
        }
        let along = Vector3::z() * twice;
        (
            once * shape.force + along * shape.force_double,
            once * shape.rate + along * shape.rate_double,
        )
    }
}

/// Classical Runge-Kutta of fourth order, one step.
fn integrate(motion: &Motion, dt: f64, from: &Flat) -> Option<Flat> {
    let mut method = ExplicitRungeKutta::rk4(dt);
    method.init(motion, 0.0, dt, from).ok()?;
    method.step(motion).ok()?;
    Some(*method.y())
}

fn fault_of(state: &State) -> Option<Divergence> {
    let flat = motion::flatten(state);
    if !flat
        .iter()
        .chain(&state.rotor_phases)
        .all(|x| x.is_finite())
    {
        return Some(Divergence::NotFinite);
    }
    let (rate, speed) = (state.rates.norm(), state.velocity.norm());
    if rate > HIGHEST_RATE {
        return Some(Divergence::Rate(rate));
    }
    (speed > HIGHEST_SPEED).then_some(Divergence::Speed(speed))
}
