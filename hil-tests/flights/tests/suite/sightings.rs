//! Where the drone was seen: only where the log says so.

use super::ulog_bytes::{Ulog, level_flight};
use recorded_flights::{Flight, Rotate, Setpoints, Sightings};

#[test]
fn a_drone_is_seen_only_where_the_log_has_a_valid_position() {
    let mut log = Ulog::new();
    level_flight(&mut log);
    log.topic(
        "vehicle_local_position",
        "uint64_t timestamp;float x;float y;float z;float vx;float vy;float vz;\
         bool xy_valid;bool z_valid;bool v_xy_valid;bool v_z_valid;",
    );
    for step in 0..20_u64 {
        let valid = u8::from(step < 10);
        log.data(
            "vehicle_local_position",
            1_000_000 + step * 100_000,
            |data| {
                for value in [1.0_f32, 2.0, -3.0, 0.1, 0.2, 0.3] {
                    data.extend(value.to_le_bytes());
                }
                data.extend([valid; 4]);
            },
        );
    }
    let flight = Flight::of_bytes("log".to_owned(), &log.bytes, Rotate::Auto).expect("a good log");
    let sightings = Sightings::of(&flight, &Setpoints::of(&flight)).expect("positions");
    let first = sightings.at(0).expect("valid from the start");
    assert_eq!(first.position, [1.0, 2.0, -3.0]);
    assert_eq!(first.velocity.map(|c| c as f32), [0.1, 0.2, 0.3]);
    assert!(sightings.at(1_100_000_000).is_some());
    assert!(sightings.at(1_200_000_000).is_none());
}
