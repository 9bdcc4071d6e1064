//! What motors feel of a deviation: it behind their lag.

use super::flight_steps::seconds;
use reflex::settings::MOST_MOTORS;

/// Time constant of a motor in s: between those with which the rotors of
/// `config/vehicles/quad_x.toml` speed up and slow down. One for every airframe, so that scores of
/// different airframes compare.
const MOTOR_LAG_S: f64 = 0.027;

/// One number for each motor; zero where there is no motor.
pub(super) type Motors = [f64; MOST_MOTORS];

/// A first-order lag for every motor, settled on the first number that it is given.
///
/// What is given at an instant is held until the next one.
#[derive(Clone, Debug, Default)]
pub(super) struct Lag {
    given: Option<(u64, Motors)>,
    felt: Motors,
}

impl Lag {
    /// What the motors feel at `at_us`, from when on they are given `next`.
    pub fn pass(&mut self, at_us: u64, next: Motors) -> Motors {
        match self.given.replace((at_us, next)) {
            None => self.felt = next,
            Some((from_us, given)) => {
                let part = -(-seconds(from_us, at_us) / MOTOR_LAG_S).exp_m1();
                for (felt, given) in self.felt.iter_mut().zip(given) {
                    *felt += part * (given - *felt);
                }
            }
        }
        self.felt
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    fn first(value: f64) -> Motors {
        let mut motors = Motors::default();
        motors[0] = value;
        motors
    }

    #[test]
    fn the_lag_lies_between_those_of_the_quadrotors_rotors() {
        let file = crate::toolchain::root().join("config/vehicles/quad_x.toml");
        let text = std::fs::read_to_string(file).expect("a vehicle");
        let vehicle: toml::Table = text.parse().expect("TOML");
        let lags = vehicle["rotors"]["lag_s"].as_array().expect("two lags");
        let [up, down] = [&lags[0], &lags[1]].map(|lag| lag.as_float().expect("a number"));
        assert!(up < MOTOR_LAG_S && MOTOR_LAG_S < down, "{up} {down}");
    }

    #[test]
    fn a_step_is_felt_by_two_thirds_after_the_lag_however_it_is_sampled() {
        for steps in [1, 3, 27] {
            let mut lag = Lag::default();
            lag.pass(0, first(0.0));
            lag.pass(1000, first(1.0));
            let felt = (1..=steps).map(|step| lag.pass(1000 + step * 27_000 / steps, first(1.0)));
            let felt = felt.last().expect("a step")[0];
            assert!((felt - (1.0 - (-1.0_f64).exp())).abs() < 1e-12, "{felt}");
        }
    }

    proptest! {
        #[test]
        fn a_vibration_far_above_the_corner_is_felt_by_the_ratio_of_a_first_order_lag(
            hertz in 60.0..150.0_f64
        ) {
            let mut lag = Lag::default();
            let turn = |at_us: u64| std::f64::consts::TAU * hertz * at_us as f64 * 1e-6;
            // The second half of two seconds at 10 kHz: what it settled on at first has died out.
            let felt = (0..20_000).map(|step| lag.pass(step * 100, first(turn(step * 100).sin()))[0]);
            let felt: Vec<f64> = felt.skip(10_000).collect();
            let square = felt.iter().map(|felt| felt * felt).sum::<f64>() / felt.len() as f64;
            let ratio = (2.0 * square).sqrt();
            let expected = 1.0 / (1.0 + (std::f64::consts::TAU * hertz * MOTOR_LAG_S).powi(2)).sqrt();
            prop_assert!((ratio / expected - 1.0).abs() < 0.01, "{} for {}", ratio, expected);
        }
    }
}
