//! Logs of text: what is read, and how bad ones are refused.

use super::samples::{csv, full_csv, named};
use recorded_flights::{Flight, Location, Rotate, Rotation, RotationReason};

/// The one line that a log is refused with.
fn refusal(text: &str) -> String {
    let folder = tempfile::tempdir().expect("a temporary folder");
    let path = folder.path().join("log.csv");
    std::fs::write(&path, text).expect("written");
    let line = Flight::read(&path, Rotate::Auto)
        .map(|flight| flight.duration_ns)
        .expect_err("a bad log")
        .to_string();
    assert!(!line.contains('\n'), "{line}");
    let (_, after_file) = line.split_once("log.csv: ").expect("the file is named");
    after_file.to_owned()
}

/// A good log with one line replaced.
fn with_line(number: usize, line: &str) -> String {
    let text = full_csv();
    let mut lines: Vec<&str> = text.lines().collect();
    lines[number - 1] = line;
    lines.join("\n") + "\n"
}

#[test]
fn every_column_arrives_where_it_belongs() {
    let flight = named(&full_csv(), Rotate::Auto).expect("a good log");
    let at = 1_000_000_000;
    assert_eq!(flight.gyro.at(at), Some([1.0_f64.sin(), 0.1, -0.2]));
    assert_eq!(flight.accel.at(at), Some([0.1, 1.0_f64.cos(), -9.8]));
    assert_eq!(
        flight.mag.and_then(|m| m.at(at)),
        Some([0.2 + 0.1, 0.0, 0.4])
    );
    let motors = flight.motors.expect("motors");
    assert_eq!(motors.count, 4);
    assert_eq!(
        motors.track.at(at).map(|m| m[..4].to_vec()),
        Some(vec![0.6, 0.4, 0.3, 0.2])
    );
    assert_eq!(flight.duration_ns, 2_000_000_000);
}

#[test]
fn held_magnetometer_samples_are_taken_where_they_change() {
    let flight = named(&full_csv(), Rotate::Auto).expect("a good log");
    let mag = flight.mag.expect("a magnetometer");
    assert!((9.9..10.1).contains(&mag.rate_hz()), "{}", mag.rate_hz());
    assert_eq!(flight.gaps, []);
}

#[test]
fn columns_may_come_in_any_order() {
    let text = csv("t_us,ax,ay,az,gz,gy,gx", 1.0, |_| {
        vec![0.0, 0.0, -9.8, 3.0, 2.0, 1.0]
    });
    let flight = named(&text, Rotate::Auto).expect("a good log");
    assert_eq!(flight.gyro.at(0), Some([1.0, 2.0, 3.0]));
}

#[test]
fn time_starts_at_the_first_sample_and_keeps_its_jitter() {
    let mut text = "t_us,gx,gy,gz,ax,ay,az\n".to_owned();
    for i in 0..600_u64 {
        text += &format!("{},0,0,0,0,0,-9.8\n", 77_000_000 + i * 2000 + i % 3);
    }
    let flight = named(&text, Rotate::Auto).expect("a good log");
    assert_eq!(flight.gyro.times_ns()[..3], [0, 2_001_000, 4_002_000]);
}

#[test]
fn a_log_whose_z_axis_points_up_is_turned_and_says_so() {
    let up = csv("t_us,gx,gy,gz,ax,ay,az", 1.0, |_| {
        vec![0.1, 0.2, 0.3, 1.0, 2.0, 9.0]
    });
    let flight = named(&up, Rotate::Auto).expect("a good log");
    assert_eq!(flight.rotation, Rotation::ROLL_180);
    assert_eq!(flight.rotation_reason, RotationReason::SpecificForce);
    assert_eq!(flight.gyro.at(0), Some([0.1, -0.2, -0.3]));
    assert_eq!(flight.accel.at(0), Some([1.0, -2.0, -9.0]));
}

#[test]
fn a_named_rotation_wins_over_what_the_log_shows() {
    let up = csv("t_us,gx,gy,gz,ax,ay,az", 1.0, |_| {
        vec![0.1, 0.2, 0.3, 1.0, 2.0, 9.0]
    });
    let flight = named(&up, Rotate::Named(Rotation::NONE)).expect("a good log");
    assert_eq!(flight.accel.at(0), Some([1.0, 2.0, 9.0]));
    assert_eq!(flight.rotation_reason, RotationReason::Named);
}

#[test]
fn a_drone_that_lies_upside_down_after_a_crash_is_not_turned() {
    let text = csv("t_us,gx,gy,gz,ax,ay,az,m1", 10.0, |t| {
        let (z, motor) = if t < 2.0 { (-9.8, 0.5) } else { (9.8, 0.0) };
        vec![0.0, 0.0, 0.0, 0.0, 0.0, z, motor]
    });
    let flight = named(&text, Rotate::Auto).expect("a good log");
    assert_eq!(flight.rotation, Rotation::NONE);
}

#[test]
fn a_sideways_board_needs_a_named_rotation() {
    let text = csv("t_us,gx,gy,gz,ax,ay,az", 1.0, |_| {
        vec![0.0, 0.0, 0.0, 9.8, 0.0, 0.0]
    });
    let fault = named(&text, Rotate::Auto).expect_err("cannot be told");
    assert!(fault.reason.contains("--rotate"), "{fault:?}");
    let pitch90 = Rotate::Named("pitch90".parse().expect("a known name"));
    let flight = named(&text, pitch90).expect("a good log");
    assert_eq!(flight.accel.at(0), Some([0.0, 0.0, -9.8]));
}

#[test]
fn a_wrong_header_is_refused_by_name() {
    for (header, expected) in [
        (
            "a,b,c",
            "line 1: names no columns that are known (the first is 'a'): name them t_us,",
        ),
        ("t_us,gx,gy,gz,ax,ay,az,m2", "line 1: has no column m1"),
        (
            "t_us,gx,gy,gz,gx,ax,ay,az",
            "line 1: has the column 'gx' twice",
        ),
        (
            "t_us,gx,gy,gz",
            "line 1: has no accelerometer (columns ax,ay,az)",
        ),
        (
            "t_us,gx,gz,ax,ay,az",
            "line 1: has no gyroscope (columns gx,gy,gz)",
        ),
        ("gx,gy,gz,ax,ay,az", "line 1: has no column t_us"),
        (
            "t_us,gx,gy,gz,ax,ay,az,mx",
            "line 1: has only a part of the columns mx,my,mz",
        ),
    ] {
        let line = refusal(&with_line(1, header));
        assert!(line.starts_with(expected), "{line}");
    }
}

#[test]
fn further_columns_are_left_out_with_a_word() {
    let text = csv("t_us,gx,gy,gz,ax,ay,az,note,m9", 1.0, |_| {
        vec![0.1, 0.2, 0.3, 0.0, 0.0, -9.8, 7.0, 8.0]
    });
    let flight = named(&text, Rotate::Auto).expect("a good log");
    assert_eq!(flight.notes, ["2 columns are left out, such as 'note'"]);
    assert_eq!(flight.gyro.at(0), Some([0.1, 0.2, 0.3]));
}

/// What is skipped of a log with one line replaced.
fn skipped(line: &str) -> String {
    let flight = named(&with_line(11, line), Rotate::Auto).expect("one bad line of 400");
    assert_eq!(flight.gyro.len(), 400, "{line}");
    let kinds = flight.skipped.kinds().iter().map(ToString::to_string);
    kinds.collect::<Vec<_>>().join("; ")
}

#[test]
fn a_bad_line_is_skipped_and_named_by_its_cell() {
    let good = "0.1,0,0,0,0,-9.8,0,0,0,0.1,0.1,0.1,0.1";
    let bad_gx = |text: &str| format!("45000,{text}{}", &good[3..]);
    for (row, expected) in [
        (
            bad_gx("abc"),
            "1 x cells that are no numbers (first at line 11, column gx)",
        ),
        (
            bad_gx(""),
            "1 x cells that are empty (first at line 11, column gx)",
        ),
        (
            bad_gx("nan"),
            "1 x gyroscope: rates that no sensor gives (first at line 11)",
        ),
        (
            bad_gx("1e300"),
            "1 x gyroscope: rates that no sensor gives (first at line 11)",
        ),
        (
            format!("45000,{good},1"),
            "1 x lines of another number of columns than the header's 14 (first at line 11)",
        ),
        (
            "45000,1".to_owned(),
            "1 x lines of another number of columns than the header's 14 (first at line 11)",
        ),
    ] {
        assert_eq!(skipped(&row), expected);
    }
    let back = skipped(&format!("5000,{good}"));
    assert!(
        back.starts_with("1 x gyroscope: a time that goes back (first at line 11)"),
        "{back}"
    );
    let ahead = skipped(&format!("9000000000,{good}"));
    assert!(
        ahead.starts_with("1 x gyroscope: a time that leaps ahead (first at line 11)"),
        "{ahead}"
    );
    assert_eq!(skipped(&format!("40000,{good}")), "");
}

#[test]
fn a_log_of_garbage_lines_names_the_first() {
    let mut text = "t_us,gx,gy,gz,ax,ay,az\n".to_owned();
    text += &"1,2,three,4,5,6,7\n".repeat(20);
    assert_eq!(
        refusal(&text),
        "line 2, column gy: most lines are no samples: cells that are no numbers"
    );
}

#[test]
fn a_log_that_is_cut_off_is_read_to_its_last_whole_line() {
    let text = full_csv();
    let without_line_end = named(text.trim_end(), Rotate::Auto).expect("all of it");
    assert_eq!(without_line_end.gyro.len(), 401);
    let in_a_line = &text[..text.len() - 20];
    let flight = named(in_a_line, Rotate::Auto).expect("but for the last line");
    assert_eq!((flight.gyro.len(), flight.skipped.count()), (400, 1));
}

#[test]
fn logs_without_a_flight_are_refused() {
    assert_eq!(refusal(""), "is empty");
    assert_eq!(refusal("\n\n"), "is empty");
    assert_eq!(
        refusal("t_us,gx,gy,gz,ax,ay,az\n"),
        "has no gyroscope samples"
    );
    let short = csv("t_us,gx,gy,gz,ax,ay,az", 0.5, |_| vec![0.0; 6]);
    assert!(refusal(&short).starts_with("is too short: 0.500 s"));
    let slow =
        "t_us,gx,gy,gz,ax,ay,az\n0,0,0,0,0,0,-9\n900000,0,0,0,0,0,-9\n1800000,0,0,0,0,0,-9\n";
    assert!(refusal(slow).starts_with("has its gyroscope at 1.1 Hz only"));
    let endless =
        "t_us,gx,gy,gz,ax,ay,az\n-9000000000000000,0,0,0,0,0,-9\n9000000000000000,0,0,0,0,0,-9\n";
    assert!(refusal(endless).starts_with("is too long"));
}

#[test]
fn files_that_are_no_logs_are_refused() {
    let read = |path: &str| {
        let error = Flight::read(path.as_ref(), Rotate::Auto).expect_err("no log");
        assert_eq!(error.location(), &Location::File);
        error.to_string()
    };
    assert!(read("/does/not/exist.csv").starts_with("/does/not/exist.csv: cannot be read: "));
    assert_eq!(read("/"), "/: is no file");
    assert_eq!(read("/dev/zero"), "/dev/zero: is no file");
    assert!(refusal("\u{0}\u{1}binary").starts_with("is no log that is known"));
    assert!(refusal("ULo").starts_with("line 1: "), "{}", refusal("ULo"));
    assert!(refusal("PK\u{3}\u{4}").starts_with("is a ZIP archive"));
}
