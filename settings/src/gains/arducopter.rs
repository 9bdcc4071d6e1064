//! Gains of the control logic `arducopter`.

use super::{LogicGains, next, outside};
use crate::{Setting, above, within};

gains! {
    "arducopter";

    /// The attitude estimate.
    estimate: Estimate {
        tilt_p: number = 0.2, within(0.0, 1.0), "1/s",
            "How fast the tilt follows the accelerometer";
        tilt_i: number = 0.0087, within(0.0, 0.1), "1/s2",
            "How fast the gyroscope's drift is learned from the tilt";
        heading_p: number = 0.2, within(0.0, 1.0), "1/s",
            "How fast the heading follows the magnetometer";
        heading_i: number = 0.01, within(0.0, 0.1), "1/s2",
            "How fast the gyroscope's drift is learned from the heading";
        drift_limit_rad_s2: number = 0.000145, within(0.0, 0.01), "rad/s2",
            "How fast the learned drift may change";
    }

    /// The angle loop.
    angle: Angle {
        p: axes = [4.5, 4.5, 4.5], above(0.0, 60.0), "1/s",
            "Body rate asked for per radian of a small error", grows 1;
        acceleration_rad_s2: axes = [9.6, 9.6, 2.09], above(0.0, 250.0), "rad/s2",
            "Deceleration by which a larger error may be approached", grows 2;
        yaw_error_limit_rad: number = 0.785, above(0.0, 3.0), "rad",
            "Most of a yaw error that is corrected at once";
    }

    /// The rate loop.
    rate: Rate {
        p: axes = [0.0675, 0.0675, 0.09], within(0.0, 1.0), "share of full authority per rad/s",
            "Torque asked for per error of the rate", grows 1;
        i: axes = [0.0675, 0.0675, 0.009], within(0.0, 5.0), "share of full authority per rad",
            "Torque asked for per integrated error of the rate", grows 2;
        d: axes = [0.0018, 0.0018, 0.0], within(0.0, 0.05), "share of full authority per rad/s2",
            "Torque asked for per derivative of the rate's error", grows 1;
        integral_limit: number = 0.25, within(0.0, 0.5), "share of full authority",
            "Most that an integral of the rate loop holds";
        d_cutoff_hz: number = 20.0, within(1.0, 200.0), "Hz",
            "Corner of the derivative's low-pass filter";
        yaw_error_cutoff_hz: number = 2.5, within(0.5, 50.0), "Hz",
            "Corner of the low-pass filter of the yaw rate's error";
    }

    /// The position loop.
    position: Position {
        p: number = 1.0, above(0.0, 4.0), "1/s",
            "Velocity asked for per metre of a small horizontal error";
        acceleration_m_s2: number = 1.0, above(0.0, 10.0), "m/s2",
            "Deceleration by which a larger horizontal error may be approached";
        speed_m_s: number = 5.0, above(0.0, 20.0), "m/s", "Most that a horizontal error asks for";
    }

    /// The velocity loop.
    velocity: Velocity {
        p: number = 2.0, within(0.0, 10.0), "1/s",
            "Acceleration asked for per horizontal error of the velocity";
        i: number = 1.0, within(0.0, 5.0), "1/s2",
            "Acceleration asked for per integrated error of the velocity";
        d: number = 0.25, within(0.0, 1.0), "m/s2 per m/s2",
            "Acceleration asked for per derivative of the velocity's error";
        integral_limit_m_s2: number = 10.0, within(0.0, 20.0), "m/s2",
            "Most that the integral of the velocity loop holds";
        cutoff_hz: number = 5.0, within(0.5, 50.0), "Hz",
            "Corner of the low-pass filters of the velocity's error and its derivative";
        lean_limit_rad: number = 0.524, above(0.0, 1.2), "rad", "Most that position control leans";
    }

    /// The altitude loop.
    altitude: Altitude {
        p: number = 1.0, above(0.0, 4.0), "1/s",
            "Climb rate asked for per metre of a small error of the altitude";
        acceleration_m_s2: number = 2.5, above(0.0, 10.0), "m/s2",
            "Deceleration by which a larger error of the altitude may be approached";
        climb_m_s: number = 2.5, above(0.0, 10.0), "m/s",
            "Most that an error of the altitude asks for upwards";
        descent_m_s: number = 1.5, above(0.0, 5.0), "m/s",
            "Most that an error of the altitude asks for downwards";
        climb_p: number = 5.0, within(0.0, 10.0), "1/s",
            "Vertical acceleration asked for per error of the climb rate";
        throttle_p: number = 0.05, within(0.0, 0.5), "share of thrust per m/s2",
            "Thrust asked for per error of the vertical acceleration";
        throttle_i: number = 0.1, within(0.0, 1.0), "share of thrust per m/s",
            "Thrust asked for per integrated error of the vertical acceleration";
        throttle_integral_limit: number = 0.8, within(0.0, 1.0), "share of thrust",
            "Most that the integral of the thrust holds";
        error_cutoff_hz: number = 20.0, within(1.0, 100.0), "Hz",
            "Corner of the low-pass filter of the vertical acceleration's error";
        throttle_cutoff_hz: number = 2.0, within(0.5, 50.0), "Hz",
            "Corner of the low-pass filter of the thrust";
    }

    /// How thrust is learned and shared.
    thrust: Thrust {
        hover: number = 0.35, within(0.125, 0.6875), "share of thrust",
            "Thrust that the learning of hover begins with";
        hover_learning_s: number = 10.0, within(1.0, 100.0), "s",
            "Time constant of the learned thrust in hover";
        attitude_priority: number = 0.5, within(0.0, 1.0), "share of hover",
            "How far thrust may be raised towards hover to keep the attitude";
        yaw_headroom: number = 0.1, within(0.0, 0.5), "share of full scale",
            "Part of every motor's range that yaw may have before roll and pitch";
    }
}
