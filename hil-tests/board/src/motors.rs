//! Motor pulses as written to the timers, gathered into whole vectors.

/// Motor outputs of the board: TIM3 channels 1..4, then TIM4 channels 1..4.
pub const MOTORS: usize = 8;

/// Writes closer than this belong to one vector, unless they repeat a motor.
const VECTOR_GAP_NS: u64 = 20_000;

/// One motor vector, complete: what every output was told to do.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct MotorWrite {
    /// When the last compare register of the vector was written, in ns.
    pub at_ns: u64,
    /// When its first compare register was written, in ns.
    pub first_ns: u64,
    /// When the last of the written timers' update events applies it, in ns.
    pub applied_ns: u64,
    /// Programmed pulse of every motor, in ns; 0 before the first write.
    pub pulse_ns: [u32; MOTORS],
    /// Bit `n` is set when motor `n`'s output was driven at `at_ns`.
    pub driven: u8,
}

/// One write of a timer's compare register.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct CompareWrite {
    /// When, in ns.
    pub at_ns: u64,
    /// The update event that applies it, in ns.
    pub applied_ns: u64,
    /// Index of the motor.
    pub motor: usize,
    /// Programmed pulse, in ns.
    pub pulse_ns: u32,
    /// Whether the output was driven.
    pub driven: bool,
}

/// Gathers single compare writes into motor vectors.
///
/// A vector ends when a motor is written again, or after 20 us of silence.
#[derive(Debug, Default)]
pub struct VectorGatherer {
    open: Option<Open>,
    pulse_ns: [u32; MOTORS],
    driven: u8,
}

#[derive(Debug)]
struct Open {
    first_ns: u64,
    last_ns: u64,
    applied_ns: u64,
    written: u8,
}

impl VectorGatherer {
    /// Takes the next write; returns the vector that it shows to be complete.
    pub fn push(&mut self, write: CompareWrite) -> Option<MotorWrite> {
        let bit = 1 << write.motor;
        let ends = self.open.as_ref().is_some_and(|open| {
            open.written & bit != 0 || write.at_ns > open.last_ns + VECTOR_GAP_NS
        });
        let complete = if ends { self.close() } else { None };
        let open = self.open.get_or_insert(Open {
            first_ns: write.at_ns,
            last_ns: write.at_ns,
            applied_ns: write.applied_ns,
            written: 0,
        });
        open.last_ns = write.at_ns;
        open.applied_ns = open.applied_ns.max(write.applied_ns);
        open.written |= bit;
        self.pulse_ns[write.motor] = write.pulse_ns;
        self.driven = (self.driven & !bit) | if write.driven { bit } else { 0 };
        complete
    }

    /// The vector that silence until `now_ns` shows to be complete, if any.
    pub fn flush(&mut self, now_ns: u64) -> Option<MotorWrite> {
        let open = self.open.as_ref()?;
        if now_ns > open.last_ns + VECTOR_GAP_NS {
            self.close()
        } else {
            None
        }
    }

    fn close(&mut self) -> Option<MotorWrite> {
        let open = self.open.take()?;
        Some(MotorWrite {
            at_ns: open.last_ns,
            first_ns: open.first_ns,
            applied_ns: open.applied_ns,
            pulse_ns: self.pulse_ns,
            driven: self.driven,
        })
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn write(at_ns: u64, motor: usize, pulse_ns: u32) -> CompareWrite {
        CompareWrite {
            at_ns,
            applied_ns: at_ns.next_multiple_of(500_000),
            motor,
            pulse_ns,
            driven: true,
        }
    }

    #[test]
    fn writes_back_to_back_are_one_vector() {
        let mut gatherer = VectorGatherer::default();
        for motor in 0..4 {
            let at_ns = 1_000 + 10 * motor as u64;
            assert_eq!(gatherer.push(write(at_ns, motor, 125_000)), None);
        }
        let vector = gatherer.flush(1_000_000).unwrap();
        assert_eq!((vector.first_ns, vector.at_ns), (1_000, 1_030));
        assert_eq!(vector.applied_ns, 500_000);
        assert_eq!(vector.driven, 0b1111);
        assert_eq!(
            vector.pulse_ns[..5],
            [125_000, 125_000, 125_000, 125_000, 0]
        );
    }

    #[test]
    fn a_repeated_motor_starts_the_next_vector() {
        let mut gatherer = VectorGatherer::default();
        gatherer.push(write(0, 0, 1));
        gatherer.push(write(10, 1, 2));
        let first = gatherer.push(write(20, 0, 3)).unwrap();
        assert_eq!(first.pulse_ns[..2], [1, 2]);
        assert_eq!(gatherer.flush(100_000).unwrap().pulse_ns[..2], [3, 2]);
    }

    #[test]
    fn a_vector_stays_open_until_silence_ends_it() {
        let mut gatherer = VectorGatherer::default();
        gatherer.push(write(0, 0, 1));
        assert_eq!(gatherer.flush(20_000), None);
        assert!(gatherer.flush(20_001).is_some());
        assert_eq!(gatherer.flush(1_000_000), None);
    }
}
