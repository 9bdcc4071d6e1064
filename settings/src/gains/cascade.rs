//! Gains of the control logic `cascade`.

use super::{LogicGains, next, outside};
use crate::{Setting, above, within};

gains! {
    "cascade";

    /// The attitude filter.
    estimate: Estimate {
        accel_correction: number = 0.4, within(0.0, 10.0), "1/s",
            "How fast the attitude follows the accelerometer";
        heading_correction: number = 0.1, within(0.0, 10.0), "1/s",
            "How fast the heading follows the magnetometer";
    }

    /// The attitude loop.
    attitude: Attitude {
        p: axes = [6.0, 6.0, 3.0], within(0.0, 30.0), "1/s",
            "Body rate asked for per radian of error", grows 1;
        rate_limit_rad_s: axes = [4.0, 4.0, 2.0], above(0.0, 35.0), "rad/s",
            "Most that the attitude loop asks for";
    }

    /// The rate loop.
    rate: Rate {
        p: axes = [0.06, 0.06, 0.1], within(0.0, 2.0), "share of full authority per rad/s",
            "Torque asked for per error of the rate", grows 1;
        i: axes = [0.06, 0.06, 0.05], within(0.0, 5.0), "share of full authority per rad",
            "Torque asked for per integrated error of the rate", grows 2;
        d: axes = [0.001, 0.001, 0.0], within(0.0, 0.1), "share of full authority per rad/s2",
            "Torque taken back per measured angular acceleration", grows 1;
        d_cutoff_hz: number = 20.0, within(1.0, 200.0), "Hz",
            "Corner of the derivative's low-pass filter";
        integral_limit: number = 0.15, within(0.0, 1.0), "share of full authority",
            "Most that the integral holds";
    }
}
