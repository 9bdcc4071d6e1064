//! The generated source says what the files say.

use std::path::Path;

fn source() -> String {
    let configuration = reflex_config::load(Path::new(env!("CARGO_MANIFEST_DIR"))).unwrap();
    configuration.to_rust()
}

#[test]
fn every_constant_is_documented() {
    let source = source();
    let lines: Vec<&str> = source.lines().collect();
    for (place, line) in lines.iter().enumerate() {
        if line.starts_with("pub const") {
            assert!(lines[place - 1].starts_with("/// "), "{line}");
        }
    }
}

#[test]
fn values_arrive_as_rust_literals() {
    let source = source();
    for expected in [
        "pub const HYPERPERIOD: Duration = micros(1000);",
        "pub const MOTORS: usize = 4;",
        "pub const LONGEST_WARM_UP: Duration = micros(30000000);",
        "pub const RATE_P: [f32; 3] = [0.06, 0.06, 0.1];",
        "quantum: 1.0 / 255.0",
    ] {
        assert!(source.contains(expected), "{expected} is not in\n{source}");
    }
}
