//! Flights made up for tests.

use recorded_flights::{Fault, Flight, Rotate, Rotation};

/// Samples per second of made-up flights.
pub const RATE_HZ: f64 = 200.0;

/// A CSV log: header, then rows of what `columns` says at each time (s).
pub fn csv(header: &str, length_s: f64, columns: impl Fn(f64) -> Vec<f64>) -> String {
    let mut text = format!("{header}\n");
    for sample in 0..=(length_s * RATE_HZ) as u64 {
        let time = sample as f64 / RATE_HZ;
        let values: Vec<String> = columns(time).iter().map(f64::to_string).collect();
        text += &format!("{},{}\n", sample * 5000, values.join(","));
    }
    text
}

/// A flight of gyroscope and accelerometer, not turned.
pub fn flight(length_s: f64, motion: impl Fn(f64) -> ([f64; 3], [f64; 3])) -> Flight {
    let text = csv("t_us,gx,gy,gz,ax,ay,az", length_s, |time| {
        let (gyro, accel) = motion(time);
        [gyro, accel].concat()
    });
    named(&text, Rotate::Named(Rotation::NONE)).expect("a good log")
}

/// Reads a log of text.
pub fn named(text: &str, rotate: Rotate) -> Result<Flight, Fault> {
    Flight::of_bytes("made-up".to_owned(), text.as_bytes(), rotate)
}

/// A drone that hovers with its z axis down.
pub fn hover() -> Flight {
    flight(3.0, |_| ([0.0; 3], [0.0, 0.0, -9.806_65]))
}

/// A good log of text with all columns.
pub fn full_csv() -> String {
    let header = "t_us,gx,gy,gz,ax,ay,az,mx,my,mz,m1,m2,m3,m4";
    csv(header, 2.0, |t| {
        let held = (t * 10.0).floor() / 100.0;
        let gyro = [t.sin(), 0.1, -0.2];
        let accel = [0.1, t.cos(), -9.8];
        [
            &gyro[..],
            &accel,
            &[0.2 + held, 0.0, 0.4],
            &[0.5 + held, 0.4, 0.3, 0.2],
        ]
        .concat()
    })
}
