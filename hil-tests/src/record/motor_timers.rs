//! The motors' timers: how often they update, and their pulse for a command.

use reflex::airframe::{period_ticks, ticks};
use reflex::settings::MotorProtocol;

/// Timer clocks per microsecond (84 MHz).
const TIMER_MHZ: u64 = 84;

/// Time between two update events of the motors' timers, ns.
pub(crate) fn update_period_ns(protocol: MotorProtocol) -> u64 {
    let (clocks_per_tick, ticks) = period_ticks(protocol);
    u64::from(clocks_per_tick) * u64::from(ticks) * 1000 / TIMER_MHZ
}

/// The pulse that the timers make of a share of full scale, in whole ns.
pub(crate) fn pulse_ns(protocol: MotorProtocol, share: f32) -> u32 {
    let (clocks_per_tick, _) = period_ticks(protocol);
    let clocks = u64::from(ticks(protocol, share)) * u64::from(clocks_per_tick);
    (clocks * 1000 / TIMER_MHZ) as u32
}

/// The same pulse in ns, not rounded.
pub(super) fn exact_pulse_ns(protocol: MotorProtocol, share: f32) -> f64 {
    let (clocks_per_tick, _) = period_ticks(protocol);
    let ns_per_tick = f64::from(clocks_per_tick) * 1e3 / TIMER_MHZ as f64;
    f64::from(ticks(protocol, share)) * ns_per_tick
}

/// The throttle that a speed controller reads from a pulse, 0 to 1; none without a pulse.
pub(crate) fn throttle(protocol: MotorProtocol, pulse_ns: u32) -> Option<f64> {
    let shortest = match protocol {
        MotorProtocol::OneShot125 => 125_000.0,
        MotorProtocol::Pwm => 1_000_000.0,
    };
    (pulse_ns > 0).then(|| (f64::from(pulse_ns) / shortest - 1.0).clamp(0.0, 1.0))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_pulse_means_the_throttle_of_its_protocol() {
        for (protocol, pulse_ns, share) in [
            (MotorProtocol::OneShot125, 125_000, 0.0),
            (MotorProtocol::OneShot125, 187_500, 0.5),
            (MotorProtocol::Pwm, 2_000_000, 1.0),
            (MotorProtocol::Pwm, 900_000, 0.0),
        ] {
            assert_eq!(throttle(protocol, pulse_ns), Some(share));
        }
        assert_eq!(throttle(MotorProtocol::Pwm, 0), None);
    }

    #[test]
    fn timers_beat_at_2_khz_or_at_400_hz() {
        assert_eq!(update_period_ns(MotorProtocol::OneShot125), 500_000);
        assert_eq!(update_period_ns(MotorProtocol::Pwm), 2_500_000);
    }
}
