//! Gains of the control logic `openpilot`.

use super::{LogicGains, next, outside};
use crate::{Setting, above, within};

gains! {
    "openpilot";

    /// The attitude filter.
    estimate: Estimate {
        accel_kp: number = 0.436, within(0.0, 10.0), "1/s",
            "How fast the attitude follows the accelerometer";
        accel_ki: number = 0.00087, within(0.0, 0.1), "1/s2",
            "How fast the gyroscope's bias follows the accelerometer";
        mag_kp: number = 0.0131, within(0.0, 10.0), "1/s",
            "How fast the heading follows the magnetometer";
        yaw_bias_rate: number = 0.0005, within(0.0, 0.1), "1/s",
            "How fast the mean yaw rate is taken for a bias";
        bias_limit_rad_s: number = 0.35, within(0.0, 1.0), "rad/s",
            "Most that the gyroscope's bias comes to";
    }

    /// The attitude loop.
    attitude: Attitude {
        kp: axes = [2.5, 2.5, 2.5], within(0.0, 30.0), "1/s",
            "Body rate asked for per radian of error", grows 1;
        ki: axes = [0.0, 0.0, 0.0], within(0.0, 30.0), "1/s2",
            "Body rate asked for per integrated error", grows 2;
        integral_limit_rad_s: axes = [0.873, 0.873, 0.873], within(0.0, 10.0), "rad/s",
            "Most that the attitude loop's integral holds";
        maximum_rate_rad_s: axes = [5.24, 5.24, 0.873], above(0.0, 35.0), "rad/s",
            "Most that the attitude loop asks for";
        manual_rate_rad_s: axes = [2.62, 2.62, 3.05], above(0.0, 35.0), "rad/s",
            "Most of a setpoint's own rates that is flown";
    }

    /// The rate loop.
    rate: Rate {
        kp: axes = [0.086, 0.086, 0.1], within(0.0, 2.0), "share of full authority per rad/s",
            "Torque asked for per error of the rate", grows 1;
        ki: axes = [0.086, 0.086, 0.1], within(0.0, 5.0), "share of full authority per rad",
            "Torque asked for per integrated error of the rate", grows 2;
        kd: axes = [0.00057, 0.00057, 0.0], within(0.0, 0.1), "share of full authority per rad/s2",
            "Torque taken back per measured angular acceleration", grows 1;
        d_cutoff_hz: number = 20.0, within(1.0, 200.0), "Hz",
            "Corner of the derivative's low-pass filter";
        integral_limit: number = 0.15, within(0.0, 1.0), "share of full authority",
            "Most that the rate loop's integral holds";
        output_limit: number = 0.5, above(0.0, 1.0), "share of full authority",
            "Most that an axis asks for";
    }

    /// The position loop.
    position: Position {
        p: number = 0.25, within(0.0, 10.0), "1/s",
            "Horizontal velocity asked for per metre of error";
        speed_limit_m_s: number = 10.0, above(0.0, 50.0), "m/s",
            "Most horizontal velocity asked for";
        velocity_kp: number = 0.14, within(0.0, 1.0), "rad per m/s",
            "Lean per error of the horizontal velocity";
        velocity_ki: number = 0.0087, within(0.0, 1.0), "rad per m",
            "Lean per integrated error of the horizontal velocity";
        velocity_kd: number = 0.0, within(0.0, 1.0), "rad per m/s2",
            "Lean taken back per horizontal acceleration";
        integral_limit_rad: number = 0.262, within(0.0, 1.0), "rad",
            "Most lean that the integral holds";
        velocity_feedforward: number = 0.035, within(0.0, 1.0), "rad per m/s",
            "Lean per horizontal velocity asked for";
        maximum_lean_rad: number = 0.436, above(0.0, 1.0), "rad",
            "Most that roll and pitch each lean";
    }

    /// The altitude loop.
    altitude: Altitude {
        p: number = 0.7, within(0.0, 10.0), "1/s", "Vertical velocity asked for per metre of error";
        speed_limit_m_s: number = 4.0, above(0.0, 20.0), "m/s",
            "Most vertical velocity asked for, up or down";
        velocity_kp: number = 0.3, within(0.0, 5.0), "thrust per m/s",
            "Thrust per error of the vertical velocity";
        velocity_ki: number = 0.4, within(0.0, 5.0), "thrust per m",
            "Thrust per integrated error of the vertical velocity";
        velocity_kd: number = 0.0001, within(0.0, 1.0), "thrust per m/s2",
            "Thrust taken back per vertical acceleration";
        velocity_beta: number = 0.9, within(0.0, 1.0), "share",
            "How much of the vertical velocity asked for CLIMB_KP sees";
        thrust_minimum: number = 0.2, within(0.0, 0.5), "thrust", "Least thrust in flight";
        thrust_neutral: number = 0.5, within(0.0, 1.0), "thrust",
            "Thrust that hovering is taken to need at first";
        thrust_maximum: number = 0.9, within(0.5, 1.0), "thrust",
            "Most thrust that the altitude loop asks for";
    }
}
