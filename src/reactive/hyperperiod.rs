//! Hyperperiods: locked to the samples of the gating inputs.
//!
//! An oscillator of its own drives every chip, so that nominal periods never fit each other. A
//! hyperperiod therefore ends with samples, not with time: when each gating input has delivered
//! as many as its nominal rate promises. One that stays away ends it at one and a half periods.

use crate::config::{HYPERPERIOD, of_input};
use crate::sensors::{Input, Inputs};
use crate::time::Instant;

/// Inputs whose periods enter the hyperperiod.
pub(super) const GATES: Inputs = {
    let (mut gates, mut sensors) = (Inputs::NONE, Input::SENSED.as_slice());
    while let Some((input, rest)) = sensors.split_first() {
        if of_input(*input).gates {
            gates = gates.with(*input);
        }
        sensors = rest;
    }
    gates
};

// The build refuses a hyperperiod past its bound with the rates that make it; this holds the bound
// for whoever writes constants by hand.
const _: () = assert!(
    HYPERPERIOD.ticks() > 0 && HYPERPERIOD.ticks() <= 20_000,
    "the gating inputs' rates make a hyperperiod that is longer than 20 ms"
);

/// Samples that each of [`Input::SENSED`] owes a hyperperiod; none where it does not gate.
const OWED: [u16; Input::SENSED.len()] = {
    let mut owed = [0; Input::SENSED.len()];
    let (mut places, mut sensors) = (owed.as_mut_slice(), Input::SENSED.as_slice());
    while let (Some((place, others)), Some((input, rest))) =
        (places.split_first_mut(), sensors.split_first())
    {
        if GATES.contains(*input) {
            *place = (HYPERPERIOD.ticks() / of_input(*input).period.ticks()) as u16;
        }
        (places, sensors) = (others, rest);
    }
    owed
};

/// The hyperperiod under way.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub(super) struct Hyperperiod {
    delivered: [u16; OWED.len()],
    began: Option<Instant>,
}

impl Hyperperiod {
    /// Takes note of samples; true where they end the hyperperiod, which begins the next.
    pub(super) fn deliver(&mut self, at: Instant, inputs: Inputs) -> bool {
        for (input, count) in Input::SENSED.iter().zip(&mut self.delivered) {
            if inputs.contains(*input) {
                *count = count.saturating_add(1);
            }
        }
        let complete = self
            .delivered
            .iter()
            .zip(OWED)
            .all(|(has, owed)| *has >= owed);
        let ends = complete || at >= self.timeout(at);
        if ends {
            self.end(at);
        }
        ends
    }

    /// When it ends though a gating sample is missing: one and a half periods after it began.
    pub(super) fn timeout(&self, now: Instant) -> Instant {
        self.began.unwrap_or(now) + HYPERPERIOD * 3 / 2
    }

    /// True where it should have ended by now.
    pub(super) fn is_over(&self, now: Instant) -> bool {
        self.began.is_some() && now >= self.timeout(now)
    }

    /// Ends it. A chip that is fast keeps what it is ahead, at most one hyperperiod's samples.
    pub(super) fn end(&mut self, at: Instant) {
        for (count, owed) in self.delivered.iter_mut().zip(OWED) {
            *count = count.saturating_sub(owed).min(owed);
        }
        self.began = Some(at);
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::time::{at_micros, micros, span};

    const BURST: Inputs = Inputs::NONE.with(Input::Gyro).with(Input::Accel);

    #[test]
    fn the_burst_of_the_only_gating_chip_ends_every_hyperperiod() {
        let mut hyperperiod = Hyperperiod::default();
        // Five per cent fast, then slow: what counts is the sample.
        for at in [950, 1_900, 2_950, 4_000] {
            assert!(hyperperiod.deliver(at_micros(at), BURST));
        }
        assert_eq!(
            span(at_micros(4_000), hyperperiod.timeout(at_micros(4_100))),
            HYPERPERIOD * 3 / 2
        );
    }

    #[test]
    fn half_a_burst_ends_nothing_but_in_its_place_comes_the_timeout() {
        let mut hyperperiod = Hyperperiod::default();
        assert!(hyperperiod.deliver(at_micros(0), BURST));
        let gyro = Inputs::NONE.with(Input::Gyro);
        assert!(!hyperperiod.deliver(at_micros(1_000), gyro));
        assert!(!hyperperiod.is_over(at_micros(1_499)));
        assert!(hyperperiod.is_over(at_micros(1_500)));
        assert!(hyperperiod.deliver(at_micros(2_000), gyro));
    }

    #[test]
    fn what_a_fast_chip_is_ahead_is_bounded() {
        let mut hyperperiod = Hyperperiod::default();
        for at in 0..1000 {
            hyperperiod.deliver(at_micros(at), Inputs::NONE.with(Input::Gyro));
        }
        assert!(
            hyperperiod
                .delivered
                .iter()
                .zip(OWED)
                .all(|(has, owed)| *has <= 1000 + owed)
        );
        hyperperiod.end(at_micros(1_000) + micros(0));
        assert!(
            hyperperiod
                .delivered
                .iter()
                .zip(OWED)
                .all(|(has, owed)| *has <= owed)
        );
    }
}
