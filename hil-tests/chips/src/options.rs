//! What may differ from one specimen of a chip to the next.

/// Properties of one specimen of a chip, fixed for a run.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ChipOptions {
    /// Seed of the noise and of the oscillator error.
    pub seed: u64,
    /// Adds the datasheet's noise to the analogue signals; off by default.
    pub noise: bool,
    /// Relative error of all the chip's oscillators: +0.01 samples 1 % faster.
    ///
    /// `None` draws one from the seed: within the datasheet's tolerance for the
    /// MPU6050 (5 %, or 2 % on a gyroscope's clock), and within 5 % for the
    /// LSM303AGR, whose datasheet gives none. Beyond +-0.5 it is clamped.
    pub oscillator_error: Option<f64>,
    /// Which sensors exist; an absent one answers a constant sample.
    pub present: Present,
    /// MPU6050: weight of one count of MOT_THR in mg (datasheet: 32).
    ///
    /// Dies with 2 mg are reported, so firmware has to calibrate it.
    pub motion_threshold_lsb_mg: f64,
    /// How the inertial sensor lies in the drone, and the other chip.
    pub mountings: [Axes; 2],
    /// What the MPU6050's gyroscope shows at rest; nothing by default.
    pub zero_rate: ZeroRate,
}

/// A chip's x, y and z along the axes of the body that feels the stimulus.
pub type Axes = [[f64; 3]; 3];

/// Of a chip that lies as the body does.
pub const AS_THE_BODY: Axes = [[1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]];

/// Zero-rate output of a gyroscope: each axis draws its share of the most, from the seed.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct ZeroRate {
    /// Most at turn-on, in deg/s (datasheet: 20).
    pub turn_on_deg_s: f64,
    /// By how much the die warms up, in degrees Celsius, two thirds of it in the first minute.
    ///
    /// The output moves with it, by a third of 1 deg/s a degree at most: 20 deg/s from 25 to 85
    /// degrees (datasheet).
    pub warm_up_c: f64,
}

impl Default for ChipOptions {
    fn default() -> Self {
        Self {
            seed: 0,
            noise: false,
            oscillator_error: None,
            present: Present::default(),
            motion_threshold_lsb_mg: 32.0,
            mountings: [AS_THE_BODY; 2],
            zero_rate: ZeroRate::default(),
        }
    }
}

/// Which sensors exist. An absent one is alive but answers zeros, noiseless.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Present {
    /// The gyroscope of the MPU6050.
    pub gyro: bool,
    /// The accelerometer of the chip the options are given to.
    pub accelerometer: bool,
    /// The magnetometer of the LSM303AGR.
    pub magnetometer: bool,
}

impl Default for Present {
    fn default() -> Self {
        Self {
            gyro: true,
            accelerometer: true,
            magnetometer: true,
        }
    }
}
