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
        if line.trim_start().starts_with("pub const") {
            assert!(lines[place - 1].trim_start().starts_with("/// "), "{line}");
        }
    }
}

#[test]
fn values_arrive_as_rust_literals() {
    let source = source();
    for expected in [
        "pub const HYPERPERIOD: Duration = micros(1000);",
        "pub const GEOMETRY: Airframe = Airframe::new(0.05, &[Motor { angle_deg: 45.0, clockwise: false }, ",
        "pub const LONGEST_WARM_UP: Duration = micros(30000000);",
        "[\"cascade.rate.p\", \"[0.06, 0.06, 0.1]\", ",
        "quantum: 1.0 / 255.0",
    ] {
        assert!(source.contains(expected), "{expected} is not in\n{source}");
    }
}

#[test]
fn every_logic_is_a_module_and_listed_by_its_name() {
    let source = source();
    for expected in [
        "\npub mod cascade {\n",
        "pub const GAINS: Gains = Gains::from_words(&[0.4, 0.1, 6.0, 6.0, 3.0, ",
        "[\"cascade.attitude.p\", \"[6.0, 6.0, 3.0]\", \
         \"Body rate asked for per radian of error, in 1/s, 0 to 30; one for each axis.\"]",
        "[\"cascade.rate.d_cutoff_hz\", \"20.0\", ",
        "pub const LOGIC: &str = \"cascade\";",
    ] {
        assert!(source.contains(expected), "{expected} is not in\n{source}");
    }
}
