//! Columns of other writers, other units and other encodings.

use recorded_flights::{Fault, Flight, Reading, Rotate, Rotation};

/// Twenty seconds at 200 Hz of a drone that sways by a tenth of a radian, as rows of a time in s,
/// rates in rad/s and forces in m/s2 with z up.
fn rows(row: impl Fn(f64, [f64; 3], [f64; 3]) -> String) -> String {
    let rows = (0..4000).map(|sample| {
        let t = f64::from(sample) / 200.0;
        let rates = [0.6 * (6.0 * t).cos(), 0.3 * (4.0 * t).sin(), 0.1];
        row(
            t,
            rates,
            [0.9 * (6.0 * t).sin(), 0.4, 9.8 + 0.5 * (2.0 * t).sin()],
        )
    });
    rows.collect()
}

fn read(text: &[u8], reading: impl Into<Reading>) -> Result<Flight, Fault> {
    Flight::of_bytes("log".to_owned(), text, reading)
}

/// Checks that a log holds the flight of [`rows`].
fn is_the_flight(flight: &Flight) {
    assert_eq!(flight.rotation, Rotation::ROLL_180, "{:?}", flight.notes);
    assert!(
        (flight.gyro.rate_hz() - 200.0).abs() < 0.5,
        "{}",
        flight.gyro.rate_hz()
    );
    let [roll, _, yaw] = flight.gyro.at(0).unwrap_or_default();
    assert!(
        (roll - 0.6).abs() < 0.02 && (yaw + 0.1).abs() < 0.02,
        "{roll} {yaw}"
    );
    let [_, y, z] = flight.accel.at(0).unwrap_or_default();
    assert!((y + 0.4).abs() < 0.05 && (z + 9.8).abs() < 0.3, "{y} {z}");
}

#[test]
fn columns_of_each_writer_are_known() {
    let deg = |v: [f64; 3]| v.map(f64::to_degrees);
    let plain = |t: f64, unit: f64, w: [f64; 3], a: [f64; 3]| {
        format!(
            "{:.0},{},{},{},{},{},{}\n",
            t * unit,
            w[0],
            w[1],
            w[2],
            a[0],
            a[1],
            a[2]
        )
    };
    let g = |a: [f64; 3]| a.map(|a| a / 9.806_65);
    let blackbox = rows(|t, w, a| {
        let [w, a] = [deg(w), g(a).map(|a| (a * 2048.0).round())].map(|v| v.map(|v| v.round()));
        format!("{},{}", (t * 200.0) as u32, plain(t, 1e6, w, a))
    });
    let blackbox = "loopIteration, time (us), gyroADC[0], gyroADC[1], gyroADC[2], accSmooth[0], \
                    accSmooth[1], accSmooth[2]\n"
        .to_owned()
        + &blackbox;
    let quoted = blackbox.replace("loopIteration, time (us)", "\"loopIteration\",\"time\"");
    let explorer =
        format!("\"Product\",\"Blackbox flight data recorder\"\n\"looptime\",\"125\"\n{quoted}");
    let ulog2csv = "timestamp,gyro_rad[0],gyro_rad[1],gyro_rad[2],accelerometer_m_s2[0],\
                    accelerometer_m_s2[1],accelerometer_m_s2[2]\n"
        .to_owned()
        + &rows(|t, w, a| plain(t, 1e6, w, a));
    let euroc = "#timestamp [ns],w_RS_S_x [rad s^-1],w_RS_S_y [rad s^-1],w_RS_S_z [rad s^-1],\
                 a_RS_S_x [m s^-2],a_RS_S_y [m s^-2],a_RS_S_z [m s^-2]\n"
        .to_owned()
        + &rows(|t, w, a| plain(t + 1_403_636_579.0, 1e9, w, a));
    let crazyflie = "timestamp,gyro.x,gyro.y,gyro.z,acc.x,acc.y,acc.z\n".to_owned()
        + &rows(|t, w, a| plain(t, 1e3, deg(w), g(a)));
    let mavlogdump = "timestamp,TimeUS,I,GyrX,GyrY,GyrZ,AccX,AccY,AccZ\n".to_owned()
        + &rows(|t, w, a| format!("{t},{}", plain(t, 1e6, w, a).replacen(',', ",0,", 1)));
    let xsens = "time;Acc_X;Acc_Y;Acc_Z;Gyr_X;Gyr_Y;Gyr_Z\n".to_owned()
        + &rows(|t, w, a| {
            let w = deg(w);
            let row = format!(
                "{t};{};{};{};{};{};{}\n",
                a[0], a[1], a[2], w[0], w[1], w[2]
            );
            row.replace('.', ",")
        });
    for text in [
        blackbox, explorer, ulog2csv, euroc, crazyflie, mavlogdump, xsens,
    ] {
        let start = text.lines().next().unwrap_or_default().to_owned();
        let flight = read(text.as_bytes(), Rotate::Auto);
        is_the_flight(&flight.unwrap_or_else(|fault| panic!("{start}: {fault:?}")));
    }
}

#[test]
fn an_x_axis_that_points_up_is_that_of_euroc() {
    let text = "timestamp,w_RS_S_x,w_RS_S_y,w_RS_S_z,a_RS_S_x,a_RS_S_y,a_RS_S_z\n".to_owned()
        + &rows(|t, w, a| {
            format!(
                "{:.0},{},{},{},{},{},{}\n",
                t * 1e9,
                w[2],
                w[1],
                w[0],
                a[2],
                a[1],
                -a[0]
            )
        });
    let flight = read(text.as_bytes(), Rotate::Auto).expect("a good log");
    assert_eq!(flight.rotation.to_string(), "pitch90");
    let [_, _, z] = flight.accel.at(0).unwrap_or_default();
    assert!((z + 9.8).abs() < 0.3, "{z}");
}

/// Our columns, in other units.
fn in_units(time: f64, rates: f64, forces: f64) -> String {
    "t_us,gx,gy,gz,ax,ay,az\n".to_owned()
        + &rows(|t, w, a| {
            let ([x, y, z], [u, v, n]) = (w.map(|w| w * rates), a.map(|a| a * forces));
            format!("{},{x},{y},{z},{u},{v},{n}\n", t * time)
        })
}

#[test]
fn units_that_the_samples_contradict_are_named_with_the_option_that_helps() {
    let degrees = 1.0_f64.to_degrees();
    for (text, unit) in [
        (in_units(1e6, degrees, 1.0), "deg/s"),
        (in_units(1e6, 1.0, 1.0 / 9.806_65), "g"),
        (in_units(1e3, 1.0, 1.0), "ms"),
    ] {
        let fault = read(text.as_bytes(), Rotate::Auto).map(|flight| flight.duration_ns);
        let reason = fault.expect_err(unit).reason;
        assert!(
            reason.contains(&format!("looks like {unit}, not ")),
            "{reason}"
        );
        assert!(reason.ends_with(&format!("add --units {unit}")), "{reason}");
        let reading = Reading {
            units: unit.parse().expect("a known unit"),
            ..Reading::default()
        };
        let flight = read(text.as_bytes(), reading).expect("converted");
        is_the_flight(&flight);
        assert!(
            flight.notes.iter().any(|note| note.contains(unit)),
            "{:?}",
            flight.notes
        );
    }
    is_the_flight(&read(in_units(1e6, 1.0, 1.0).as_bytes(), Rotate::Auto).expect("as declared"));
}

#[test]
fn a_field_in_microtesla_is_named() {
    let text = "t_us,gx,gy,gz,ax,ay,az,mx,my,mz\n".to_owned()
        + &rows(|t, w, a| {
            let field = 20.0 + t.sin();
            let [x, y, z] = w;
            format!(
                "{:.0},{x},{y},{z},{},{},{},{field},0,40\n",
                t * 1e6,
                a[0],
                a[1],
                a[2]
            )
        });
    let fault = read(text.as_bytes(), Rotate::Auto).map(|flight| flight.duration_ns);
    assert!(
        fault
            .expect_err("too strong")
            .reason
            .ends_with("add --units ut")
    );
}

#[test]
fn other_encodings_are_read_with_a_word() {
    let text = in_units(1e6, 1.0, 1.0);
    let wide: Vec<u8> = text.encode_utf16().flat_map(u16::to_le_bytes).collect();
    let latin = [text.as_bytes(), &[0xb5]].concat();
    for bytes in [wide, latin] {
        let flight = read(&bytes, Rotate::Auto).expect("a good log");
        is_the_flight(&flight);
        assert!(
            flight.notes[0].starts_with("text in "),
            "{:?}",
            flight.notes
        );
    }
    let marked = [b"\xef\xbb\xbf", text.as_bytes()].concat();
    is_the_flight(&read(&marked, Rotate::Auto).expect("a good log"));
}

#[test]
fn unknown_units_are_refused_with_the_known_ones() {
    for (text, expected) in [
        (
            "furlongs",
            "unknown unit 'furlongs': use one of each kind of s, ms, us, ns, rad/s",
        ),
        ("g,m/s2", "g and m/s2 are of one kind"),
    ] {
        let error = text.parse::<recorded_flights::Units>().expect_err(text);
        assert!(error.to_string().starts_with(expected), "{error}");
    }
}

#[test]
fn a_motor_command_that_is_no_number_is_left_out_and_counted() {
    let text = rows(|t, w, a| {
        let motor = ["nan", "32768", "inf", "40000"][(t * 200.0).round() as usize % 4];
        let [w, a] = [w.map(f64::to_degrees), a.map(|a| a / 9.806_65)];
        let ([p, q, r], [x, y, z]) = (w, a);
        format!("{:.0},{p},{q},{r},{x},{y},{z},{motor}\n", t * 1e3)
    });
    let header = "timestamp,gyro.x,gyro.y,gyro.z,acc.x,acc.y,acc.z,motor.m1\n";
    let flight = read((header.to_owned() + &text).as_bytes(), Rotate::Auto).expect("a good log");
    let motors = flight.motors.expect("motors").track;
    let shares: Vec<f64> = motors.values().iter().map(|[first, ..]| *first).collect();
    assert!(
        shares.iter().all(|share| (0.4..=1.0).contains(share)),
        "{shares:?}"
    );
    assert_eq!(flight.skipped.count(), 2000);
}
