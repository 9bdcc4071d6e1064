//! What the paper says of its own flights, in numbers and in words.
//!
//! Bregu et al., Reactive Control of Autonomous Drones, MobiSys 2016, sections 3 and 7. Numbers
//! that stand in its pictures alone are not among these.

/// Improvement of the pitch error, lowest and highest, % (section 7.2).
pub const PITCH_PERCENT: [f64; 2] = [27.0, 41.0];
/// Improvement of flight time, lowest and highest, % (section 7.2).
pub const FLIGHT_TIME_PERCENT: [f64; 2] = [11.0, 24.0];
/// Rate of time-triggered control, Hz (section 7.2).
pub const RATE_HZ: f64 = 400.0;

/// Figure 5.
pub const UNCHANGED: &str = "read from the text: the share is highest in Lab and smallest in Arch, \
    and higher for the hexacopter than for the quadcopter. Its numbers stand in the picture alone. \
    It measured motor currents within their sensor's accuracy.";
/// Figure 9.
pub const PITCH: &str = "read from the text: 27 % (Ardupilot in Arch) to 41 % (Cleanflight in Lab); \
    Cleanflight in Arch 32 % with the quadcopter and 37 % with the hexacopter; highest with the Y6. \
    The other numbers stand in the picture alone. Only Ardupilot flew the Y6.";
/// Figure 10.
pub const ROLL_AND_YAW: &str = "read from the text: very similar to pitch, sometimes better. Its \
    numbers stand in the picture alone.";
/// Figure 11.
pub const RATE: &str = "read from the text: in Arch the rate begins slightly below the 400 Hz of \
    time-triggered control and rises with the wind; in Lab it stays below 400 Hz, with bursts above.";
/// Figure 12.
pub const FLIGHT_TIME: &str = "read from the text: 11 % at worst to 24 % at best, more in the more \
    demanding environments, and more with the quadcopter than with the hexacopter; OpenPilot in \
    Arch flew 27 min in place of 22.";
/// Figure 13.
pub const WAYS: &str = "read from the text: without RP-Embedded, on Cleanflight, the improvements in \
    flight time are almost halved. Its numbers stand in the picture alone.";
/// Figure 14.
pub const SWEEPS: &str = "read from the text: some improvement for every value of P_run from 0.2 to \
    0.8, near the best from 0.4 to 0.7, the hexacopter's curve almost flat there; T_failsafe from \
    0.01 to 0.3 s hardly matters, but for a slight loss at 0.01 s.";
