//! All airframes: allocations worked out by hand, and rules for every demand.

use std::path::Path;
use std::sync::LazyLock;

use super::*;
use crate::math::Vec3;
use crate::units::TorqueDemand;
use proptest::prelude::*;
use reflex_config::{Airframe, Spin, load_chosen};

type Mix = Box<dyn Fn(TorqueDemand, Thrust) -> (Vec<f32>, bool) + Send + Sync>;

/// One airframe of `config/airframes/`, and its mixer whatever its number of motors.
struct Frame {
    name: &'static str,
    geometry: Airframe,
    mix: Mix,
}

static FRAMES: LazyLock<[Frame; 3]> = LazyLock::new(|| ["quad_x", "hexa_x", "y6"].map(frame));

fn frame(name: &'static str) -> Frame {
    let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("config");
    let chosen = |variable: &str| (variable == "REFLEX_AIRFRAME").then(|| name.to_owned());
    let geometry = load_chosen(&folder, chosen).expect(name).airframe;
    let mixer = Mixer::new(&geometry.geometry());
    let mix = Box::new(move |torque, thrust| {
        let Mixed {
            shares, saturated, ..
        } = mixer.mix(torque, thrust, &LevelFirst);
        (shares.to_vec(), saturated)
    });
    Frame {
        name,
        geometry,
        mix,
    }
}

/// What motors do to the body: torque in units of demand, and the mean share.
struct Achieved {
    torque: Vec3,
    mean: f32,
}

impl Frame {
    fn mix(&self, [x, y, z]: [f32; 3], thrust: f32) -> (Vec<f32>, bool) {
        let torque = TorqueDemand(Vec3::new(x, y, z));
        (self.mix)(torque, Thrust::new(thrust).expect("in range"))
    }

    /// By the geometry alone, which knows nothing of the allocation.
    fn achieved(&self, shares: &[f32]) -> Achieved {
        let count = shares.len() as f64;
        let mut sums = [0.0; 4];
        for (motor, share) in self.geometry.motors.iter().zip(shares) {
            let (sin, cos) = motor.angle_deg.to_radians().sin_cos();
            let reaction = if motor.spin == Spin::Cw { -1.0 } else { 1.0 };
            // A unit of roll or pitch is every motor at full scale on 1/sqrt(2) of an arm.
            let per_lever = std::f64::consts::SQRT_2;
            for (sum, effect) in
                sums.iter_mut()
                    .zip([-sin * per_lever, cos * per_lever, reaction, 1.0])
            {
                *sum += effect * f64::from(*share) / count;
            }
        }
        let [x, y, z, mean] = sums.map(|sum| sum as f32);
        Achieved {
            torque: Vec3::new(x, y, z),
            mean,
        }
    }
}

const LEAST: f32 = GEOMETRY.armed_minimum();

/// The share of every motor at half thrust and no torque.
const HOVER: f32 = LEAST + 0.5 * (1.0 - LEAST);

/// Roll, pitch and yaw steps in the order of the outputs: lever times sqrt(2), reaction.
///
/// With arms evenly spaced the squares of the levers add up to half of the motors about either
/// axis, so a torque of N/sqrt(2) takes steps of lever * (N/sqrt(2)) / (N/2) = lever * sqrt(2).
/// Levers are -sin(angle) for roll, cos(angle) for pitch; "ccw" turns the nose right: +1.
fn by_hand(name: &str) -> Vec<[f32; 3]> {
    /// sqrt(2): an arm along the axis of the lever.
    const FULL: f32 = std::f32::consts::SQRT_2;
    /// sqrt(2) * sqrt(3) / 2: 60 degrees from the axis of rotation.
    const LONG: f32 = 1.224_744_9;
    /// sqrt(2) / 2: 30 degrees from it.
    const SHORT: f32 = std::f32::consts::FRAC_1_SQRT_2;
    match name {
        // sin and cos of 45 degrees are 1/sqrt(2): every step is 1.
        "quad_x" => vec![
            [-1.0, 1.0, 1.0],   // front right, ccw
            [1.0, -1.0, 1.0],   // rear left, ccw
            [1.0, 1.0, -1.0],   // front left, cw
            [-1.0, -1.0, -1.0], // rear right, cw
        ],
        "hexa_x" => vec![
            [-FULL, 0.0, -1.0],   // right (90), cw
            [FULL, 0.0, 1.0],     // left (270), ccw
            [SHORT, LONG, -1.0],  // front left (330), cw
            [-SHORT, -LONG, 1.0], // rear right (150), ccw
            [-SHORT, LONG, 1.0],  // front right (30), ccw
            [SHORT, -LONG, -1.0], // rear left (210), cw
        ],
        // The rear arm has twice the front ones' lever in pitch and none in roll.
        "y6" => vec![
            [-LONG, SHORT, -1.0], // front right (60), top, cw
            [-LONG, SHORT, 1.0],  // front right, bottom, ccw
            [0.0, -FULL, -1.0],   // rear (180), top, cw
            [0.0, -FULL, 1.0],    // rear, bottom, ccw
            [LONG, SHORT, -1.0],  // front left (300), top, cw
            [LONG, SHORT, 1.0],   // front left, bottom, ccw
        ],
        other => panic!("{other} was not worked out"),
    }
}

#[test]
fn every_motor_of_every_airframe_moves_as_worked_out_by_hand() {
    for frame in FRAMES.iter() {
        let steps = by_hand(frame.name);
        for axis in 0..3 {
            let mut demand = [0.0; 3];
            demand[axis] = 0.1;
            let (shares, saturated) = frame.mix(demand, 0.5);
            assert!(!saturated);
            assert_eq!(shares.len(), steps.len());
            for (motor, (share, steps)) in shares.iter().zip(&steps).enumerate() {
                let expected = HOVER + 0.1 * steps[axis];
                assert!(
                    (share - expected).abs() < 1e-6,
                    "{}: axis {axis} moves motor {} to {share}, not {expected}",
                    frame.name,
                    motor + 1
                );
            }
        }
    }
}

#[test]
fn the_built_mixer_is_that_of_its_file() {
    let built = FRAMES
        .iter()
        .find(|frame| frame.name == crate::config::AIRFRAME)
        .expect("worked out");
    let (torque, thrust) = (
        TorqueDemand(Vec3::new(0.1, -0.05, 0.02)),
        Thrust::new(0.5).expect("in range"),
    );
    let mixed = Mixer::default().mix(torque, thrust, &LevelFirst);
    assert_eq!((built.mix)(torque, thrust), (mixed.shares.to_vec(), false));
}

#[test]
fn yaw_yields_to_pitch_where_the_rear_arm_has_the_longest_lever() {
    let y6 = &FRAMES[2];
    // Pitch moves the rear motors down by 0.3 * sqrt(2) = 0.4243, to 0.5250 - 0.4243 = 0.1007
    // of full scale; 0.0507 above the least are left to yaw, whose demand is 0.2.
    let (shares, saturated) = y6.mix([0.0, 0.3, 0.2], 0.5);
    assert!(saturated);
    let got = y6.achieved(&shares);
    assert!((got.torque.y - 0.3).abs() < 1e-5);
    assert!((got.torque.z - 0.0507).abs() < 1e-4);
    assert!((got.mean - HOVER).abs() < 1e-5);
    assert!((shares[2] - LEAST).abs() < 1e-5, "the rear top one");
}

fn torque(most: f32) -> [std::ops::Range<f32>; 3] {
    [-most..most, -most..most, -most..most]
}

proptest! {
    #[test]
    fn commands_never_leave_their_range(demand in torque(3.0), thrust in 0.0f32..=1.0) {
        for frame in FRAMES.iter() {
            let (shares, _) = frame.mix(demand, thrust);
            for share in shares {
                prop_assert!((LEAST..=1.0).contains(&share), "{}", frame.name);
            }
        }
    }

    #[test]
    fn what_the_motors_can_give_is_given_in_full_and_on_no_other_axis(
        demand in torque(0.5), thrust in 0.0f32..=1.0
    ) {
        for frame in FRAMES.iter() {
            let (shares, saturated) = frame.mix(demand, thrust);
            if !saturated {
                let got = frame.achieved(&shares);
                let [x, y, z] = demand;
                prop_assert!((got.torque - Vec3::new(x, y, z)).max_norm() < 1e-5, "{}", frame.name);
                let wanted = LEAST + thrust * (1.0 - LEAST);
                prop_assert!((got.mean - wanted).abs() < 1e-5, "{}", frame.name);
            }
        }
    }

    #[test]
    fn a_demand_that_fits_is_not_called_saturated(
        demand in torque(0.13), thrust in 0.495f32..=0.505
    ) {
        // At most 0.13 * (sqrt(2) * sqrt(2) + 1) = 0.39 from hover, where 0.47 are free.
        for frame in FRAMES.iter() {
            prop_assert!(!frame.mix(demand, thrust).1, "{}", frame.name);
        }
    }

    #[test]
    fn roll_and_pitch_are_kept_before_thrust_and_yaw(
        x in -0.2f32..0.2, y in -0.2f32..0.2, z in -3.0f32..3.0, thrust in 0.0f32..=1.0
    ) {
        for frame in FRAMES.iter() {
            let got = frame.achieved(&frame.mix([x, y, z], thrust).0).torque;
            prop_assert!((got.x - x).abs() < 1e-5, "{}", frame.name);
            prop_assert!((got.y - y).abs() < 1e-5, "{}", frame.name);
            prop_assert!(got.z * z.signum() > -1e-5, "{}", frame.name);
            prop_assert!(got.z.abs() <= z.abs() + 1e-5, "{}", frame.name);
        }
    }

    #[test]
    fn thrust_is_kept_before_yaw(demand in torque(3.0), thrust in 0.0f32..=1.0) {
        for frame in FRAMES.iter() {
            let [x, y, _] = demand;
            let with = frame.achieved(&frame.mix(demand, thrust).0);
            let without = frame.achieved(&frame.mix([x, y, 0.0], thrust).0);
            prop_assert!((with.mean - without.mean).abs() < 1e-5, "{}", frame.name);
        }
    }

    #[test]
    fn roll_and_pitch_past_the_motors_range_are_cut_alike(
        demand in torque(3.0), thrust in 0.0f32..=1.0
    ) {
        for frame in FRAMES.iter() {
            let got = frame.achieved(&frame.mix(demand, thrust).0).torque;
            let [x, y, _] = demand;
            prop_assert!((got.x * y - got.y * x).abs() < 1e-4, "{}", frame.name);
            prop_assert!(got.x * x + got.y * y > -1e-4, "{}", frame.name);
            prop_assert!(got.x.abs() <= x.abs() + 1e-5, "{}", frame.name);
        }
    }
}
