//! The autopilot's words for the LSM303AGR, translated for the driver and back.
//!
//! The firmware's board does the same for its own bus; the driver knows nothing of the autopilot.

use reflex::app::{Autopilot, ChipOrder, Next, OrderError, Recorder};
use reflex::graph::ControlLogic;
use reflex::sensors::Cause;
use reflex::time::Instant;
use reflex_drivers::lsm303agr::halves::{self, Action, Half};

/// An order in the driver's words.
pub(super) fn words_of(order: ChipOrder) -> (Half, Action) {
    match order {
        ChipOrder::AccelDataReady => (Half::Accel, Action::DataReady),
        ChipOrder::AccelThreshold(code) => (Half::Accel, Action::Threshold(code.into())),
        ChipOrder::AccelRearm => (Half::Accel, Action::Rearm),
        ChipOrder::AccelHeartbeat => (Half::Accel, Action::Heartbeat),
        ChipOrder::MagDataReady => (Half::Mag, Action::DataReady),
        ChipOrder::MagThreshold(code) => (Half::Mag, Action::Threshold(code)),
        ChipOrder::MagRearm => (Half::Mag, Action::Rearm),
        ChipOrder::MagHeartbeat => (Half::Mag, Action::Heartbeat),
    }
}

/// Why an order failed, in the autopilot's words.
pub(super) fn failure(error: halves::OrderError) -> OrderError {
    match error {
        halves::OrderError::Bus => OrderError::Bus,
        halves::OrderError::Identity => OrderError::Identity,
        halves::OrderError::ReadBack {
            register,
            wrote,
            read,
        } => OrderError::ReadBack {
            register,
            wrote,
            read,
        },
    }
}

/// Hands a sample to the autopilot with its stamp.
pub(super) fn deliver<R: Recorder, L: ControlLogic>(
    sample: &halves::Sample,
    autopilot: &mut Autopilot<R, L>,
    at: Instant,
) -> Next {
    let cause = match sample.cause {
        halves::Cause::DataReady => Cause::DataReady,
        halves::Cause::Threshold => Cause::Threshold,
        halves::Cause::Heartbeat => Cause::Heartbeat,
        halves::Cause::Rearm => Cause::Rearm,
    };
    match sample.half {
        Half::Accel => autopilot.on_chip_accel(at, sample.counts, cause),
        Half::Mag => autopilot.on_chip_mag(at, sample.counts, cause),
    }
}
