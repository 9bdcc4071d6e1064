//! Motor commands as timer ticks, at the full resolution of an 84 MHz timer.
//!
//! OneShot125: 125 to 250 us every 500 us, unscaled ticks. PWM: 1000 to 2000 us every 2500 us,
//! ticks of 4 timer clocks so that the period fits 16 bits.

use crate::settings::MotorProtocol;

/// Ticks of the shortest pulse, which is also how far a full command lengthens it.
const fn shortest(protocol: MotorProtocol) -> u16 {
    match protocol {
        MotorProtocol::OneShot125 => 10_500,
        MotorProtocol::Pwm => 21_000,
    }
}

/// Timer clocks per tick and ticks per period.
#[must_use]
pub const fn period_ticks(protocol: MotorProtocol) -> (u16, u16) {
    match protocol {
        MotorProtocol::OneShot125 => (1, 42_000),
        MotorProtocol::Pwm => (4, 52_500),
    }
}

/// Ticks of the pulse for a share of full scale; outside 0 to 1 or not a number, the nearest.
#[must_use]
pub fn ticks(protocol: MotorProtocol, share: f32) -> u16 {
    let shortest = shortest(protocol);
    // The conversion takes what is below zero, or not a number, for zero.
    shortest + ((share * f32::from(shortest) + 0.5) as u16).min(shortest)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_pulse_spans_one_to_two_shortest_pulses() {
        for protocol in [MotorProtocol::OneShot125, MotorProtocol::Pwm] {
            assert_eq!(ticks(protocol, 0.0), shortest(protocol));
            assert_eq!(ticks(protocol, 1.0), 2 * shortest(protocol));
            assert_eq!(ticks(protocol, -1.0), shortest(protocol));
            assert_eq!(ticks(protocol, f32::NAN), shortest(protocol));
            assert_eq!(ticks(protocol, 1.1), 2 * shortest(protocol));
            assert_eq!(ticks(protocol, f32::INFINITY), 2 * shortest(protocol));
            assert!(period_ticks(protocol).1 > ticks(protocol, 1.0));
        }
    }
}
