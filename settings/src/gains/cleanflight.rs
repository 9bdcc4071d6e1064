//! Gains of the control logic `cleanflight`.

use super::{LogicGains, next, outside};
use crate::{Setting, above, within};

gains! {
    "cleanflight";

    /// The attitude filter.
    estimate: Estimate {
        dcm_kp: number = 0.25, within(0.0, 10.0), "1/s",
            "How fast the attitude follows accelerometer and magnetometer";
        dcm_ki: number = 0.0, within(0.0, 1.0), "1/s2",
            "How fast a bias of the gyroscope is learned";
        fast_factor: number = 10.0, within(1.0, 20.0), "times dcm_kp",
            "The correction while the drone stands, just started";
        fast_s: number = 20.0, within(0.0, 60.0), "s", "How long the faster correction may hold";
        spin_limit_rad_s: number = 0.349, within(0.0, 35.0), "rad/s",
            "The rate above which no bias is learned";
        horizontal_field: number = 0.42, above(0.0, 1.0), "share of the field",
            "How much of Earth's field is horizontal";
    }

    /// Level mode.
    level: Level {
        p: number = 5.0, within(0.0, 30.0), "1/s",
            "Body rate asked for per radian of roll or pitch that is missing", grows 1;
        max_lean_rad: number = 0.873, above(0.0, 1.5), "rad",
            "The farthest lean that may be asked for";
        heading_p: number = 0.27, within(0.0, 10.0), "1/s",
            "Yaw rate asked for per radian of heading that is missing", grows 1;
    }

    /// The rate PID.
    rate: Rate {
        p: axes = [0.0859, 0.0859, 0.143], within(0.0, 2.0), "share of full authority per rad/s",
            "Torque asked for per error of the rate", grows 1;
        i: axes = [0.229, 0.229, 0.573], within(0.0, 15.0), "share of full authority per rad",
            "Torque asked for per integrated error of the rate", grows 2;
        d: axes = [0.00172, 0.00172, 0.0], within(0.0, 0.1), "share of full authority per rad/s2",
            "Torque taken back per measured angular acceleration", grows 1;
        d_cutoff_hz: number = 20.0, within(1.0, 200.0), "Hz",
            "Corner of the derivative's low-pass filter";
        integral_limit: number = 0.25, within(0.0, 1.0), "share of full authority",
            "Most that the integral holds";
        d_limit: number = 0.3, within(0.0, 1.0), "share of full authority",
            "Most that the derivative gives";
        yaw_p_limit: number = 0.5, within(0.0, 1.0), "share of full authority",
            "Most that yaw's proportional term gives";
        yaw_jump_limit: number = 0.2, within(0.0, 1.0), "share of full authority",
            "Most that yaw gives where no yaw rate is asked for";
        yaw_jump_slope: number = 0.286, within(0.0, 2.0), "share of full authority per rad/s",
            "What the desired yaw rate adds to that";
    }

    /// Throttle PID attenuation.
    tpa: Tpa {
        attenuation: number = 0.0, within(0.0, 1.0), "share",
            "What is taken from roll and pitch at full thrust";
        breakpoint: number = 0.5, within(0.0, 1.0), "share of full thrust", "Where that begins";
    }

    /// Altitude hold.
    altitude: Altitude {
        p: number = 0.39, within(0.0, 5.0), "1/s", "Climb rate asked for per metre that is missing";
        error_limit_m: number = 5.0, above(0.0, 100.0), "m", "The largest error that counts";
        deadband_m: number = 0.1, within(0.0, 1.0), "m", "The smallest error that counts";
        climb_limit_m_s: number = 3.0, above(0.0, 10.0), "m/s",
            "The fastest climb and descent asked for";
        velocity_p: number = 0.375, within(0.0, 2.0), "share of full thrust per m/s",
            "Thrust per error of the climb rate";
        velocity_i: number = 0.022, within(0.0, 1.0), "share of full thrust per m",
            "Thrust per integrated error of the climb rate";
        velocity_d: number = 0.0016, within(0.0, 0.1), "share of full thrust per m/s2",
            "Thrust taken back per upward acceleration";
        p_limit: number = 0.3, within(0.0, 1.0), "share of full thrust",
            "Most that the proportional term gives";
        integral_limit: number = 0.2, within(0.0, 1.0), "share of full thrust",
            "Most that the integral holds";
        d_limit: number = 0.15, within(0.0, 1.0), "share of full thrust",
            "Most that the derivative gives";
        accel_cutoff_hz: number = 5.0, within(0.5, 50.0), "Hz",
            "Corner of the vertical acceleration's low-pass filter";
        hover_thrust: number = 0.5, within(0.0, 1.0), "share of full thrust",
            "Thrust taken for hovering where the setpoint's is too low";
        low_thrust: number = 0.1, within(0.0, 0.5), "share of full thrust",
            "Below it thrust counts as none";
    }

    /// GPS hold.
    position: Position {
        p: number = 0.15, within(0.0, 5.0), "1/s", "Speed asked for per metre that is missing";
        speed_limit_m_s: number = 1.0, above(0.0, 10.0), "m/s", "The highest speed asked for";
        velocity_p: number = 0.0593, within(0.0, 1.0), "rad per m/s", "Lean per error of the speed";
        velocity_i: number = 0.00244, within(0.0, 1.0), "rad/m",
            "Lean per integrated error of speed and position";
        velocity_d: number = 0.000925, within(0.0, 1.0), "rad per m/s", "Lean against the speed";
        d_least_speed_m_s: number = 0.5, within(0.0, 5.0), "m/s",
            "The speed below which nothing is leaned against";
        integral_limit_rad: number = 0.349, within(0.0, 1.0), "rad",
            "Most that the integral holds and the derivative gives";
        lean_limit_rad: number = 0.524, above(0.0, 1.0), "rad",
            "The farthest lean that the hold asks for";
        slew_rad_s: number = 1.5, above(0.0, 20.0), "rad/s", "How fast that lean may change";
    }
}
