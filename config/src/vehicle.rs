//! `vehicles/*.toml`: what an airframe weighs and what its motors do, simulated.
//!
//! Not part of what the firmware is built from: `cargo hil fly` and `cargo hil campaign` read it.
//! The arms' directions and the propellers' spins are those of the airframe of the same name.

use std::f64::consts::TAU;
use std::path::Path;

use serde::Deserialize;

use crate::document::Document;
use crate::{Airframe, ConfigError, names_in, range, selected_file};

/// The content of a file of `vehicles/`.
#[derive(Clone, Debug, PartialEq, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Vehicle {
    /// Mass in kg, all included.
    #[serde(deserialize_with = "range::mass")]
    pub mass_kg: f64,
    /// Moments of inertia about forward, right and down in kg m2.
    #[serde(deserialize_with = "range::inertia")]
    pub inertia_kg_m2: [f64; 3],
    /// Rotors and motors, all alike.
    pub rotors: Rotors,
    /// What the air does to the frame.
    pub drag: Drag,
    /// How speed controllers read their pulses.
    pub esc: Esc,
    /// What feeds the motors.
    pub battery: Battery,
    /// What sensors feel of the rotors.
    pub vibration: Vibration,
    /// What the drone stands on.
    pub skids: Skids,
    /// What its gyroscope shows at rest; nothing unless it is said.
    #[serde(default)]
    pub gyroscope: Gyroscope,
    /// What bends the field at its magnetometer; nothing unless it is said.
    #[serde(default)]
    pub magnetometer: Magnetometer,
}

/// Rotors and motors, all alike.
#[derive(Clone, Debug, PartialEq, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Rotors {
    /// Distance of each rotor's axis from the centre of mass in m.
    #[serde(deserialize_with = "range::length")]
    pub arm_m: f64,
    /// Height of the rotors' plane above the centre of mass in m: wind across it tilts the body.
    #[serde(deserialize_with = "range::rise")]
    pub rise_m: f64,
    /// Radius of a rotor in m.
    #[serde(deserialize_with = "range::length")]
    pub radius_m: f64,
    /// Thrust of one rotor at full throttle of a full battery, in N.
    #[serde(deserialize_with = "range::thrust")]
    pub full_thrust_n: f64,
    /// Speed of the rotor then, in rad/s.
    #[serde(deserialize_with = "range::rotor_speed")]
    pub full_speed_rad_s: f64,
    /// Bend of the thrust over the throttle, 0 (straight) to 1 (a square).
    #[serde(deserialize_with = "range::share")]
    pub thrust_bend: f64,
    /// Torque over thrust in m.
    #[serde(deserialize_with = "range::share")]
    pub torque_per_thrust_m: f64,
    /// Time constant of the rotor's speed in s when it rises, and when it falls.
    #[serde(deserialize_with = "range::motor_lag")]
    pub lag_s: [f64; 2],
    /// Moment of inertia of rotor and bell in kg m2.
    #[serde(deserialize_with = "range::share")]
    pub inertia_kg_m2: f64,
    /// Speed of a motor without load per voltage, in rpm/V.
    #[serde(deserialize_with = "range::velocity_constant")]
    pub velocity_constant_rpm_v: f64,
    /// Resistance of a motor between two terminals in ohm.
    #[serde(deserialize_with = "range::winding")]
    pub winding_ohm: f64,
    /// Ideal power over electric power at a steady speed.
    #[serde(deserialize_with = "range::merit")]
    pub figure_of_merit: f64,
    /// Drag of a rotor across its axis, N per m/s and rad/s.
    #[serde(deserialize_with = "range::share")]
    pub drag_across: f64,
    /// Loss of thrust of a rotor that climbs, N per m/s and rad/s.
    #[serde(deserialize_with = "range::share")]
    pub drag_along: f64,
    /// Motors that work in the wash of the rotor above, by their number from 1.
    #[serde(default)]
    pub lower: Vec<usize>,
    /// What is left of their thrust.
    #[serde(default = "whole", deserialize_with = "range::positive_share")]
    pub lower_efficiency: f64,
}

impl Rotors {
    /// Torque per root of the heat in a motor's windings, N m/W^0.5.
    ///
    /// Torque per current is the inverse of speed per voltage.
    #[must_use]
    pub fn motor_constant(&self) -> f64 {
        let radians_per_volt = self.velocity_constant_rpm_v * TAU / 60.0;
        1.0 / (radians_per_volt * self.winding_ohm.sqrt())
    }
}

fn whole() -> f64 {
    1.0
}

/// What the air does to the frame, along forward, right and down.
#[derive(Clone, Debug, PartialEq, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Drag {
    /// N per m/s.
    #[serde(deserialize_with = "range::drag")]
    pub linear: [f64; 3],
    /// N per (m/s)2.
    #[serde(deserialize_with = "range::drag")]
    pub quadratic: [f64; 3],
    /// N m per rad/s about each axis.
    #[serde(deserialize_with = "range::drag")]
    pub turning: [f64; 3],
}

/// How speed controllers read their pulses.
#[derive(Clone, Debug, PartialEq, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Esc {
    /// Steps from standstill to full throttle.
    #[serde(deserialize_with = "range::steps")]
    pub steps: u32,
    /// Share of full throttle below which a motor stands.
    #[serde(deserialize_with = "range::armed_minimum")]
    pub dead_zone: f64,
}

/// What feeds the motors.
#[derive(Clone, Debug, PartialEq, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Battery {
    /// Cells in series.
    #[serde(deserialize_with = "range::cells")]
    pub cells: u32,
    /// Charge from full to empty in Ah.
    #[serde(deserialize_with = "range::charge")]
    pub capacity_ah: f64,
    /// Internal resistance of all cells and cables in ohm.
    #[serde(deserialize_with = "range::share")]
    pub resistance_ohm: f64,
    /// State of charge (0 to 1, rising) and open-circuit voltage of a cell.
    pub open_circuit: Vec<[f64; 2]>,
    /// Power of the electronics in W.
    #[serde(deserialize_with = "range::electronics")]
    pub electronics_w: f64,
}

/// What sensors feel of each rotor, in proportion to its thrust.
#[derive(Clone, Debug, PartialEq, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Vibration {
    /// Across the axis at the rotor's frequency, m/s2 per N.
    #[serde(deserialize_with = "range::vibration")]
    pub force: f64,
    /// Along the axis at twice that, m/s2 per N.
    #[serde(deserialize_with = "range::vibration")]
    pub force_double: f64,
    /// Rate across the axis, rad/s per N.
    #[serde(deserialize_with = "range::vibration")]
    pub rate: f64,
    /// Rate about the axis at twice the frequency, rad/s per N.
    #[serde(deserialize_with = "range::vibration")]
    pub rate_double: f64,
}

/// What the drone stands on.
#[derive(Clone, Debug, PartialEq, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Skids {
    /// Distance of each foot forward or back, and right or left, in m.
    #[serde(deserialize_with = "range::length")]
    pub reach_m: f64,
    /// Height of the centre of mass over the feet in m.
    #[serde(deserialize_with = "range::length")]
    pub height_m: f64,
}

/// What a gyroscope shows at rest.
#[derive(Clone, Copy, Debug, Default, PartialEq, Deserialize)]
#[serde(deny_unknown_fields, default)]
pub struct Gyroscope {
    /// Most on an axis at turn-on, by the seed, in deg/s.
    #[serde(deserialize_with = "range::turn_on")]
    pub turn_on_deg_s: f64,
    /// By how much the die warms up in flight, in degrees Celsius: the output moves with it.
    #[serde(deserialize_with = "range::warming")]
    pub warm_up_c: f64,
}

/// What bends the field at a magnetometer: iron in the words of a board's file, and motors.
#[derive(Clone, Copy, Debug, PartialEq, Deserialize)]
#[serde(deny_unknown_fields, default)]
pub struct Magnetometer {
    /// Field of the magnets that travel with it in gauss.
    #[serde(deserialize_with = "range::hard_iron")]
    pub hard_iron_gauss: [f64; 3],
    /// Of the symmetric matrix that undoes what steel bends: xx, yy, zz.
    #[serde(deserialize_with = "range::soft_iron_diagonal")]
    pub soft_iron_diagonal: [f64; 3],
    /// Of the same matrix: xy, xz, yz.
    #[serde(deserialize_with = "range::soft_iron_off_diagonal")]
    pub soft_iron_off_diagonal: [f64; 3],
    /// Field of the motors' current in gauss for each A of all of them.
    #[serde(deserialize_with = "range::motor_field")]
    pub motor_gauss_per_a: [f64; 3],
}

impl Default for Magnetometer {
    /// Nothing.
    fn default() -> Self {
        Self {
            hard_iron_gauss: [0.0; 3],
            soft_iron_diagonal: [1.0; 3],
            soft_iron_off_diagonal: [0.0; 3],
            motor_gauss_per_a: [0.0; 3],
        }
    }
}

impl Vehicle {
    /// Reads a vehicle and its airframe by their name, from the folder of the configuration.
    ///
    /// # Errors
    /// An unknown name, with those that are known; a key or value that is wrong.
    pub fn load(dir: &Path, name: &str) -> Result<(Self, Airframe), ConfigError> {
        let file = |folder| {
            selected_file(dir, folder, name)
                .map_err(|message| ConfigError::of_file(Path::new(name), message))
        };
        let geometry = Document::open(&file("airframes")?)?;
        let airframe: Airframe = geometry.parse()?;
        airframe.check(&geometry)?;
        let document = Document::open(&file("vehicles")?)?;
        let vehicle: Self = document.parse()?;
        vehicle.check(&document, &airframe)?;
        Ok((vehicle, airframe))
    }

    /// The names that [`Self::load`] knows, in order.
    ///
    /// # Errors
    /// The folder cannot be read.
    pub fn names(dir: &Path) -> Result<Vec<String>, ConfigError> {
        names_in(dir, "vehicles").map_err(|message| ConfigError::of_file(dir, message))
    }

    /// What only several values together can show.
    fn check(&self, document: &Document, airframe: &Airframe) -> Result<(), ConfigError> {
        let motors = airframe.motors.len();
        for (place, number) in self.rotors.lower.iter().enumerate() {
            if !(1..=motors).contains(number) {
                let message = format!("{number} is out of range, must be 1 to {motors}");
                return Err(document.error_at(&format!("rotors.lower.{place}"), message));
            }
        }
        let points = &self.battery.open_circuit;
        let rising = points.is_sorted_by(|a, b| a[0] < b[0]);
        let inside = points
            .iter()
            .all(|[charge, volts]| (0.0..=1.0).contains(charge) && (1.0..=5.0).contains(volts));
        if points.is_empty() || points.len() > 64 || !rising || !inside {
            let message = "must be 1 to 64 pairs of a rising charge, 0 to 1, and 1 to 5 V";
            return Err(document.error_at("battery.open_circuit", message));
        }
        Ok(())
    }
}
