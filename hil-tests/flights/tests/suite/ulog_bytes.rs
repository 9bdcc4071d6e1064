//! Writes small ULog files for tests, by the published description.

use std::collections::HashMap;

/// A log under construction.
pub(super) struct Ulog {
    pub(super) bytes: Vec<u8>,
    ids: HashMap<String, u16>,
}

impl Ulog {
    /// A log with header and flag bits.
    pub(super) fn new() -> Self {
        let mut bytes = b"ULog\x01\x12\x35\x01".to_vec();
        bytes.extend(0_u64.to_le_bytes());
        let mut log = Self {
            bytes,
            ids: HashMap::new(),
        };
        log.message(b'B', &[0; 40]);
        log
    }

    /// Appends a message.
    pub(super) fn message(&mut self, kind: u8, payload: &[u8]) {
        self.bytes.extend((payload.len() as u16).to_le_bytes());
        self.bytes.push(kind);
        self.bytes.extend(payload);
    }

    /// Appends the format of a topic; all formats come before all data.
    pub(super) fn format(&mut self, name: &str, fields: &str) {
        self.message(b'F', format!("{name}:{fields}").as_bytes());
    }

    /// Subscribes to a topic whose format is given.
    pub(super) fn subscribe(&mut self, name: &str) {
        let id = self.ids.len() as u16;
        self.ids.insert(name.to_owned(), id);
        let mut payload = vec![0];
        payload.extend(id.to_le_bytes());
        payload.extend(name.as_bytes());
        self.message(b'A', &payload);
    }

    /// Inserts the format of a topic among the definitions, and subscribes.
    pub(super) fn topic(&mut self, name: &str, fields: &str) {
        let end_of_flags = 16 + 3 + 40;
        let data = self.bytes.split_off(end_of_flags);
        self.format(name, fields);
        self.bytes.extend(data);
        self.subscribe(name);
    }

    /// Appends a data message: the time stamp and what `fill` adds.
    pub(super) fn data(&mut self, name: &str, time_us: u64, fill: impl FnOnce(&mut Vec<u8>)) {
        let mut payload = self.ids[name].to_le_bytes().to_vec();
        payload.extend(time_us.to_le_bytes());
        fill(&mut payload);
        self.message(b'D', &payload);
    }

    /// Appends a data message of floats.
    pub(super) fn floats(&mut self, name: &str, time_us: u64, values: &[f32]) {
        self.data(name, time_us, |data| {
            for value in values {
                data.extend(value.to_le_bytes());
            }
        });
    }
}

pub(super) const COMBINED: &str = "uint64_t timestamp;float[3] gyro_rad;int32_t accelerometer_timestamp_relative;\
     float[3] accelerometer_m_s2;";

/// One `sensor_combined` message.
pub(super) fn combined(log: &mut Ulog, time_us: u64, gyro: [f32; 3], accel: [f32; 3]) {
    log.data("sensor_combined", time_us, |data| {
        for value in gyro {
            data.extend(value.to_le_bytes());
        }
        data.extend((-1000_i32).to_le_bytes());
        for value in accel {
            data.extend(value.to_le_bytes());
        }
    });
}

/// Two seconds of `sensor_combined` at 200 Hz from 1 s on.
pub(super) fn level_flight(log: &mut Ulog) {
    log.topic("sensor_combined", COMBINED);
    for sample in 0..=400_u64 {
        let time = sample as f32 / 200.0;
        combined(
            log,
            1_000_000 + sample * 5000,
            [time, 0.0, 0.1],
            [0.0, time, -9.8],
        );
    }
}
