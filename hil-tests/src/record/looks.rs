//! What is seen of the sensor chips, look by look, while a board runs.

use chip_models::{DIES, OwnClock};
use reflex::sensors::Input;

const _: () = assert!(
    DIES.len() == Input::OF_CHIPS.len(),
    "hil-tests/chips/src/lib.rs: DIES has one die for each input of a chip"
);

/// A value for each chip with a clock of its own, in the order of [`Input::OF_CHIPS`].
pub(crate) type OfChips<T> = [T; Input::OF_CHIPS.len()];

/// What is seen of a chip with a clock of its own.
#[derive(Clone, Copy, Debug)]
pub(crate) struct ChipState {
    /// Samples that its die has produced.
    pub(crate) samples: u64,
    /// The threshold code that its pin follows; `None` where it interrupts at every sample.
    pub(crate) threshold: Option<u32>,
}

impl From<&dyn OwnClock> for ChipState {
    fn from(chip: &dyn OwnClock) -> Self {
        Self {
            samples: chip.samples(),
            threshold: chip.pin_threshold(),
        }
    }
}

/// What was seen of the chips at an instant.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Look {
    /// The instant, in ns of the board's time.
    pub(crate) at_ns: u64,
    pub(crate) chips: OfChips<ChipState>,
}

/// Samples of a chip since an instant, counted between the two looks around it.
pub(crate) fn samples_since(looks: &[Look], from_ns: u64, chip: usize) -> u64 {
    let of = |look: &Look| look.chips[chip].samples;
    let Some(last) = looks.last() else {
        return 0;
    };
    let place = looks.partition_point(|look| look.at_ns <= from_ns);
    let (Some(after), before) = (looks.get(place), place.checked_sub(1).map(|i| &looks[i])) else {
        return 0;
    };
    let (before_ns, before) = before.map_or((0, 0), |look| (look.at_ns, of(look)));
    let share = (from_ns - before_ns) as f64 / (after.at_ns - before_ns) as f64;
    let at_start = before as f64 + share * (of(after) - before) as f64;
    (of(last) as f64 - at_start).round() as u64
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_dies_stand_in_the_order_of_the_inputs_that_they_deliver() {
        assert_eq!(DIES.map(|die| die.name), Input::OF_CHIPS.map(Input::name));
    }

    #[test]
    fn samples_are_counted_from_between_two_looks() {
        let look = |at_ns, samples| Look {
            at_ns,
            chips: [ChipState {
                samples,
                threshold: None,
            }; Input::OF_CHIPS.len()],
        };
        let looks = [look(100, 10), look(200, 20), look(300, 30)];
        assert_eq!(samples_since(&looks, 150, 0), 15);
        assert_eq!(samples_since(&looks, 50, 0), 25);
        assert_eq!(samples_since(&looks, 300, 0), 0);
    }
}
