//! Expected bus traffic in one line per transaction, and buses that fail.
#![allow(dead_code, reason = "each test binary uses its part")]

use embedded_hal::spi::{ErrorKind, ErrorType, Operation, SpiDevice};
use embedded_hal_mock::eh1::spi::{Mock, Transaction};

/// One chip-select frame that writes `bytes`.
pub fn writes(bytes: &[u8]) -> Vec<Transaction<u8>> {
    vec![
        Transaction::transaction_start(),
        Transaction::write_vec(bytes.to_vec()),
        Transaction::transaction_end(),
    ]
}

/// One chip-select frame that sends `command` and reads `values`.
pub fn reads(command: u8, values: &[u8]) -> Vec<Transaction<u8>> {
    let mut sent = vec![command];
    sent.resize(values.len() + 1, 0);
    let mut received = vec![0];
    received.extend(values);
    vec![
        Transaction::transaction_start(),
        Transaction::transfer_in_place(sent, received),
        Transaction::transaction_end(),
    ]
}

/// A write to one register and its read-back of the same value.
pub fn checked(address: u8, value: u8) -> Vec<Transaction<u8>> {
    [writes(&[address, value]), reads(0x80 | address, &[value])].concat()
}

/// Runs `test` on a bus that expects exactly these frames.
pub fn on_bus(frames: &[Vec<Transaction<u8>>], test: impl FnOnce(Mock<u8>)) {
    let mut bus = Mock::new(&frames.concat());
    test(bus.clone());
    bus.done();
}

/// A bus that works `remaining` times, answers zeros, and then fails.
#[derive(Debug)]
pub struct FailingBus {
    pub remaining: usize,
}

impl ErrorType for FailingBus {
    type Error = ErrorKind;
}

impl SpiDevice for FailingBus {
    fn transaction(&mut self, operations: &mut [Operation<'_, u8>]) -> Result<(), ErrorKind> {
        self.remaining = self.remaining.checked_sub(1).ok_or(ErrorKind::Overrun)?;
        for operation in operations {
            if let Operation::TransferInPlace(bytes) = operation {
                bytes.fill(0);
            }
        }
        Ok(())
    }
}
