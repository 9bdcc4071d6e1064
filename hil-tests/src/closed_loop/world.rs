//! The simulated world: a drone in wind, moved by motor commands, sensed by chips.

use std::collections::VecDeque;
use std::f64::consts::TAU;
use std::sync::Arc;

use anyhow::{Result, anyhow};
use flight_dynamics::{self as dynamics, Drone, Start, State};
use nalgebra::Vector3;
use rand_distr::{Distribution, StandardUniform};
use random_streams::generator;
use reflex::config::{BATTERY_AMPS_PER_VOLT, BATTERY_VOLTS_PER_VOLT};
use reflex_config::plant::{self, Environment, Vehicle};
use reflex_config::{Airframe, Spin};

use super::bent_field::BentField;
use super::flying_board::Applied;
use super::sensed_motion::SensedMotion;
use crate::faults::{Effect, Script};
use chip_models::Stimulus;

/// Longest step of the dynamics, ns.
pub(super) const LONGEST_STEP_NS: u64 = 1_000_000;
/// Slowest that turbulence is carried past the drone, m/s: in still air it moves by itself.
const SLOWEST_AIR: f64 = 1.0;
/// Temperature of the chips: their own errors do not depend on it.
const TEMPERATURE_C: f64 = 25.0;
/// Density of the air, kg/m3 (ISO 2533, sea level).
const AIR_DENSITY: f64 = 1.225;
/// Keeps the mean wind's direction apart from other chance of the same seed.
const STREAM: u64 = 0x5749_4E44;

/// One drone in one weather.
pub(super) struct World {
    drone: Drone,
    wind: dynamics::Wind,
    /// The air's velocity in the newest step, m/s.
    pub(super) air: Vector3<f64>,
    pub(super) sensed: Arc<SensedMotion>,
    now_ns: u64,
    commands: VecDeque<Applied>,
    throttles: Vec<f64>,
    bent: BentField,
    /// Inner resistance of the battery while it is sound, ohm.
    resistance: f64,
}

impl World {
    /// A drone at rest on the ground.
    ///
    /// # Errors
    /// Parameters that describe no drone or no weather, by their name and range.
    pub(super) fn new(
        (vehicle, airframe): (&Vehicle, &Airframe),
        environment: &Environment,
        seed: u64,
    ) -> Result<Self> {
        let bent = BentField::of(&vehicle.magnetometer);
        let vehicle = vehicle_of(vehicle, airframe);
        let weather = weather_of(environment, seed);
        let drone = Drone::new(&vehicle, Start::default(), &weather)?;
        let sensed = Arc::new(SensedMotion::new(0, stimulus(&drone, &bent)));
        Ok(Self {
            wind: dynamics::Wind::new(&weather, seed)?,
            air: Vector3::zeros(),
            sensed,
            now_ns: 0,
            commands: VecDeque::new(),
            throttles: vec![0.0; airframe.motors.len()],
            resistance: vehicle.battery.resistance,
            bent,
            drone,
        })
    }

    /// Motors and battery are as a script says for now.
    pub(super) fn wear(&mut self, faults: &Script) {
        let mut strengths = vec![1.0; self.throttles.len()];
        let (mut charge, mut resistance, mut sag) = (1.0, self.resistance, 0.0);
        for fault in faults.now(self.now_ns) {
            match fault.effect {
                Effect::Motor(motor, share) => strengths[motor] = share,
                Effect::Charge(share) => charge = share,
                Effect::Resistance(factor) => resistance = self.resistance * factor,
                Effect::Sag(volts) => sag = volts,
                _ => {}
            }
        }
        for (motor, share) in strengths.into_iter().enumerate() {
            self.drone.weaken(motor, share);
        }
        self.drone.wear_battery(charge, resistance, sag);
    }

    /// A command that will apply; later ones are given later.
    pub(super) fn command(&mut self, applied: Applied) {
        self.commands.push_back(applied);
    }

    /// Moves on to an instant, not more than a step away.
    ///
    /// # Errors
    /// The simulation diverged, with time and state.
    pub(super) fn advance_to(&mut self, until_ns: u64) -> Result<()> {
        while self.now_ns < until_ns {
            while let Some(due) = self.commands.pop_front_if(|next| next.at_ns <= self.now_ns) {
                self.throttles = due.throttles;
            }
            let next = self.commands.front().map_or(until_ns, |next| next.at_ns);
            let stop_ns = next.min(until_ns);
            let dt_s = (stop_ns - self.now_ns) as f64 * 1e-9;
            self.air = self.wind.advance(dt_s);
            self.drone
                .advance(dt_s, &self.throttles, self.air)
                .map_err(|diverged| anyhow!("{diverged}"))?;
            self.now_ns = stop_ns;
        }
        let stimulus = stimulus(&self.drone, &self.bent);
        self.sensed.push(self.now_ns, stimulus);
        Ok(())
    }

    /// What the battery's divider and shunt put on their pins, mV.
    pub(super) fn battery_pins_mv(&self) -> [u32; 2] {
        let volts = self.drone.voltage();
        [
            pin_mv(volts, BATTERY_VOLTS_PER_VOLT),
            pin_mv(self.drone.power() / volts, BATTERY_AMPS_PER_VOLT),
        ]
    }

    pub(super) fn drone(&self) -> &Drone {
        &self.drone
    }

    pub(super) fn state(&self) -> &State {
        self.drone.state()
    }

    /// Roll, pitch and yaw, rad.
    pub(super) fn angles(&self) -> [f64; 3] {
        let (roll, pitch, yaw) = self.state().attitude.euler_angles();
        [roll, pitch, yaw]
    }
}

/// What is on a pin for a value, of which each volt there means so much; nothing where none is wired.
fn pin_mv(value: f64, per_volt: f32) -> u32 {
    match per_volt > 0.0 {
        true => (1e3 * value / f64::from(per_volt)).round() as u32,
        false => 0,
    }
}

fn stimulus(drone: &Drone, bent: &BentField) -> Stimulus {
    let sensed = drone.readings();
    let field = bent.around(sensed.magnetic_field, drone.motor_current());
    Stimulus {
        gyro: sensed.rates.into(),
        specific_force: sensed.specific_force.into(),
        magnetic_field: field.into(),
        temperature_c: TEMPERATURE_C,
    }
}

fn vehicle_of(vehicle: &Vehicle, airframe: &Airframe) -> dynamics::Vehicle {
    let plant::Vehicle {
        rotors,
        drag,
        esc,
        battery,
        vibration,
        skids,
        ..
    } = vehicle;
    dynamics::Vehicle {
        mass: vehicle.mass_kg,
        inertia: vehicle.inertia_kg_m2.into(),
        motors: motors_of(rotors, airframe),
        propulsion: dynamics::Propulsion {
            full_thrust: rotors.full_thrust_n,
            full_speed: rotors.full_speed_rad_s,
            expo: rotors.thrust_bend,
            torque_per_thrust: rotors.torque_per_thrust_m,
            lag_up: rotors.lag_s[0],
            lag_down: rotors.lag_s[1],
            rotor_inertia: rotors.inertia_kg_m2,
            rotor_radius: rotors.radius_m,
            motor_constant: rotors.motor_constant(),
            figure_of_merit: rotors.figure_of_merit,
            electronics: battery.electronics_w,
        },
        drag: dynamics::Drag {
            linear: drag.linear.into(),
            quadratic: drag.quadratic.into(),
            rotor_across: rotors.drag_across,
            rotor_along: rotors.drag_along,
            rotational: drag.turning.into(),
        },
        esc: dynamics::Esc {
            steps: Some(esc.steps),
            dead_zone: esc.dead_zone,
        },
        battery: dynamics::Battery {
            cells: battery.cells,
            open_circuit: battery.open_circuit.clone(),
            resistance: battery.resistance_ohm,
            capacity: battery.capacity_ah,
        },
        vibration: dynamics::Vibration {
            force: vibration.force,
            force_double: vibration.force_double,
            rate: vibration.rate,
            rate_double: vibration.rate_double,
        },
        skids: dynamics::Skids {
            reach: skids.reach_m,
            height: skids.height_m,
            friction: 0.6,
        },
        biases: dynamics::Biases::default(),
    }
}

fn motors_of(rotors: &plant::Rotors, airframe: &Airframe) -> Vec<dynamics::Motor> {
    let motors = airframe.motors.iter().enumerate();
    let motor = |(place, motor): (usize, &reflex_config::Motor)| dynamics::Motor {
        arm_angle: motor.angle_deg.to_radians(),
        arm_length: rotors.arm_m,
        height: rotors.rise_m,
        spin: match motor.spin {
            Spin::Cw => dynamics::Spin::Clockwise,
            Spin::Ccw => dynamics::Spin::CounterClockwise,
        },
        efficiency: if rotors.lower.contains(&(place + 1)) {
            rotors.lower_efficiency
        } else {
            1.0
        },
    };
    motors.map(motor).collect()
}

fn weather_of(environment: &Environment, seed: u64) -> dynamics::Environment {
    let Environment {
        wind,
        gusts,
        shelters,
        field_gauss: [north, down],
        ..
    } = environment;
    let chance: f64 = StandardUniform.sample(&mut generator(seed, STREAM));
    let aside = 2.0 * chance - 1.0;
    let from = (wind.from_deg + aside * wind.spread_deg).to_radians();
    let airspeed = wind.mean_m_s.max(SLOWEST_AIR);
    dynamics::Environment {
        air_density: AIR_DENSITY,
        magnetic_field: Vector3::new(*north, 0.0, *down),
        wind: dynamics::WindClimate {
            mean: -wind.mean_m_s * Vector3::new(from.cos(), from.sin(), 0.0),
            speed_at_20_ft: wind.turbulence_m_s,
            nominal_altitude: wind.height_m,
            nominal_airspeed: airspeed,
            gusts: Some(dynamics::Gusts {
                mean_interval: gusts.interval_s,
                amplitude: gusts.speed_m_s,
                length: (0.5 * gusts.length_s * airspeed).max(0.5),
            }),
            sheltered: (shelters.iter())
                .map(|shelter| dynamics::Shelter {
                    from: shelter.from_deg.to_radians() % TAU,
                    half_width: 0.5 * shelter.width_deg.to_radians(),
                    factor: shelter.passes,
                })
                .collect(),
        },
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use chip_models::StimulusSource;
    use std::path::Path;

    const STEP_NS: u64 = LONGEST_STEP_NS / 2;

    fn world(environment: &str, seed: u64) -> World {
        let config = Path::new(env!("CARGO_MANIFEST_DIR")).join("../config");
        let (vehicle, airframe) = Vehicle::load(&config, "quad_x").unwrap();
        let environment = Environment::load(&config, environment).unwrap();
        World::new((&vehicle, &airframe), &environment, seed).unwrap()
    }

    #[test]
    fn at_rest_the_chips_feel_gravity_and_the_field() {
        let mut world = world("lab", 1);
        for step in 1..=200 {
            world.advance_to(step * STEP_NS).unwrap();
        }
        let sensed = world.sensed.at(100 * STEP_NS);
        assert!(
            (sensed.specific_force[2] + 9.80665).abs() < 0.01,
            "{sensed:?}"
        );
        assert!((sensed.magnetic_field[0] - 0.21).abs() < 1e-3, "{sensed:?}");
    }

    #[test]
    fn a_command_counts_from_its_instant_on() {
        let mut world = world("lab", 1);
        world.command(Applied {
            at_ns: 3 * STEP_NS / 2,
            throttles: vec![0.9; 4],
        });
        world.advance_to(STEP_NS).unwrap();
        assert_eq!(world.throttles, [0.0; 4]);
        world.advance_to(2 * STEP_NS).unwrap();
        assert_eq!(world.throttles, [0.9; 4]);
        for step in 3..=2_000 {
            world.advance_to(step * STEP_NS).unwrap();
        }
        assert!(world.drone().height() > 1.0, "{}", world.drone().height());
    }

    #[test]
    fn the_wind_of_a_seed_is_the_same_whatever_flies() {
        let air = |throttle: f64| {
            let mut world = world("arch", 3);
            world.command(Applied {
                at_ns: 0,
                throttles: vec![throttle; 4],
            });
            let step = |step| {
                world.advance_to(step * STEP_NS).unwrap();
                world.air
            };
            (1..=2_000).map(step).collect::<Vec<_>>()
        };
        assert_eq!(air(0.0), air(0.7));
    }
}
