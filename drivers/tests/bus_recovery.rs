//! Recovery of a hung I2C bus: pin sequences, and a chip hung at every bit.

mod hung_chip;

use embedded_hal_mock::{
    common::Generic,
    eh1::{
        MockError,
        delay::NoopDelay,
        digital::{Mock, State, Transaction},
    },
};
use hung_chip::{Chip, Counted, Line, Wires};
use reflex_drivers::bus_recovery::{Bus, LONGEST_US, MOST_CLOCKS, Recovery, recover};

fn get(state: State) -> Transaction {
    Transaction::get(state)
}

fn set(state: State) -> Transaction {
    Transaction::set(state)
}

/// Runs a recovery on two scripted pins.
fn scripted(scl: &[Transaction], sda: &[Transaction]) -> Result<Recovery, MockError> {
    let (mut scl, mut sda): (Mock, Mock) = (Generic::new(scl), Generic::new(sda));
    let result = recover(&mut scl, &mut sda, &mut NoopDelay::new());
    scl.done();
    sda.done();
    result
}

#[test]
fn a_bus_that_looks_free_gets_one_clock_with_stop() {
    use State::{High, Low};
    let scl = [set(High), get(High), set(Low), set(High), get(High)];
    let sda = [set(High), set(Low), set(High), get(High)];
    assert_eq!(
        scripted(&scl, &sda),
        Ok(Recovery {
            clocks: 1,
            bus: Bus::Free
        })
    );
}

#[test]
fn sda_that_is_never_released_gets_nine_clocks_and_is_reported() {
    use State::{High, Low};
    let mut scl = vec![set(High), get(High)];
    let mut sda = vec![set(High)];
    for _ in 0..9 {
        scl.extend([set(Low), set(High), get(High)]);
        sda.extend([set(Low), set(High), get(Low)]);
    }
    let expected = Recovery {
        clocks: 9,
        bus: Bus::DataHeldLow,
    };
    assert_eq!(scripted(&scl, &sda), Ok(expected));
    assert!(!expected.is_free());
}

#[test]
fn sda_released_after_each_number_of_clocks_ends_the_recovery_there() {
    use State::{High, Low};
    for released_after in 1..=9 {
        let mut scl = vec![set(High), get(High)];
        let mut sda = vec![set(High)];
        for clock in 1..=released_after {
            scl.extend([set(Low), set(High), get(High)]);
            let level = if clock == released_after { High } else { Low };
            sda.extend([set(Low), set(High), get(level)]);
        }
        let expected = Recovery {
            clocks: released_after,
            bus: Bus::Free,
        };
        assert_eq!(scripted(&scl, &sda), Ok(expected));
        assert!(expected.is_free());
    }
}

#[test]
fn scl_held_low_is_reported_at_once_and_during_the_clocks() {
    use State::{High, Low};
    let result = scripted(&[set(High), get(Low)], &[set(High)]);
    assert_eq!(
        result,
        Ok(Recovery {
            clocks: 0,
            bus: Bus::ClockHeldLow
        })
    );

    let scl = [set(High), get(High), set(Low), set(High), get(Low)];
    let result = scripted(&scl, &[set(High), set(Low), set(High)]);
    assert_eq!(
        result,
        Ok(Recovery {
            clocks: 1,
            bus: Bus::ClockHeldLow
        })
    );
}

#[test]
fn an_error_of_a_pin_ends_the_recovery() {
    let error = MockError::Io(std::io::ErrorKind::NotConnected);
    let scl = [set(State::High).with_error(error.clone())];
    assert_eq!(scripted(&scl, &[set(State::High)]), Err(error.clone()));
    let sda = [set(State::High).with_error(error.clone())];
    assert_eq!(scripted(&[], &sda), Err(error));
}

/// Recovers `chip` and returns what was done, with the wires as they were left.
fn recovered(chip: Chip) -> (Recovery, Wires) {
    let wires = Wires::new(chip);
    let mut delay = Counted::default();
    let result = recover(
        &mut wires.pin(Line::Clock),
        &mut wires.pin(Line::Data),
        &mut delay,
    );
    assert!(delay.microseconds() <= LONGEST_US);
    (result.unwrap(), wires)
}

#[test]
fn a_chip_cut_off_at_any_bit_of_any_byte_it_sends_is_freed_by_stop() {
    for byte in 0..=u8::MAX {
        for bits_sent in 0..8 {
            let (recovery, wires) = recovered(Chip::sending(byte, bits_sent));
            assert!(recovery.is_free() && recovery.clocks <= MOST_CLOCKS);
            assert!(
                wires.chip_is_idle(),
                "byte {byte:#04x} after {bits_sent} bits"
            );
            assert_eq!(wires.starts(), 0, "no START condition was made");
        }
    }
}

#[test]
fn a_chip_cut_off_while_it_receives_is_freed_and_takes_no_byte() {
    for bits_received in 0..8 {
        let (recovery, wires) = recovered(Chip::receiving(bits_received));
        assert!(recovery.is_free() && wires.chip_is_idle());
        assert_eq!(wires.bytes_taken(), 0, "cut off after {bits_received} bits");
    }
    let (recovery, wires) = recovered(Chip::acknowledging());
    assert!(recovery.is_free() && wires.chip_is_idle());
    assert_eq!((recovery.clocks, wires.bytes_taken()), (1, 0));
}

#[test]
fn a_short_circuit_of_sda_is_bounded_and_reported() {
    let (recovery, wires) = recovered(Chip::shorted());
    assert_eq!(
        recovery,
        Recovery {
            clocks: MOST_CLOCKS,
            bus: Bus::DataHeldLow
        }
    );
    assert!(wires.is_released(), "both lines are let go");
}
