//! Whose columns are known: names, units and axes, a row for each writer.

use super::super::super::recording::Frame;
use super::super::super::units::{COUNTS, DEG_S, G, GAUSS, M_S2, MS, NS, RAD_S, US, Unit};

/// What a motor's column counts.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) enum Motor {
    /// 0 to 1 of full scale.
    Share,
    /// 65535 at full scale.
    Of65535,
    /// Pulses of 1000 to 2000 us, or up to 2047.
    Betaflight,
}

/// Names of three axes, and their unit where the header tells none.
pub(super) type Axes = ([&'static str; 3], Unit);

/// The columns of one writer; names are in small letters.
pub(super) struct Dialect {
    /// Who writes so.
    pub(super) name: &'static str,
    /// Names of the time; the unit, unless any is used.
    pub(super) time: (&'static [&'static str], Option<Unit>),
    pub(super) gyro: Axes,
    pub(super) accel: Axes,
    pub(super) mag: Option<Axes>,
    /// How motors are named, `#` being their number, the first number, and what they count.
    pub(super) motors: ((&'static str, usize), Motor),
    pub(super) frame: Frame,
}

const NO_MOTORS: ((&str, usize), Motor) = (("", 0), Motor::Share);

/// The first that fits is taken.
pub(super) static DIALECTS: [Dialect; 8] = [
    Dialect {
        name: "Reflex",
        time: (&["t_us"], Some(US)),
        gyro: (["gx", "gy", "gz"], RAD_S),
        accel: (["ax", "ay", "az"], M_S2),
        mag: Some((["mx", "my", "mz"], GAUSS)),
        motors: (("m#", 1), Motor::Share),
        frame: Frame::UpOrDown,
    },
    Dialect {
        name: "blackbox_decode",
        time: (&["time"], Some(US)),
        gyro: (["gyroadc[0]", "gyroadc[1]", "gyroadc[2]"], DEG_S),
        accel: (["accsmooth[0]", "accsmooth[1]", "accsmooth[2]"], COUNTS),
        mag: None,
        motors: (("motor[#]", 0), Motor::Betaflight),
        frame: Frame::UpOrDown,
    },
    Dialect {
        name: "ulog2csv",
        time: (&["timestamp"], Some(US)),
        gyro: (["gyro_rad[0]", "gyro_rad[1]", "gyro_rad[2]"], RAD_S),
        accel: (
            [
                "accelerometer_m_s2[0]",
                "accelerometer_m_s2[1]",
                "accelerometer_m_s2[2]",
            ],
            M_S2,
        ),
        mag: Some((
            [
                "magnetometer_ga[0]",
                "magnetometer_ga[1]",
                "magnetometer_ga[2]",
            ],
            GAUSS,
        )),
        motors: NO_MOTORS,
        frame: Frame::UpOrDown,
    },
    Dialect {
        name: "EuRoC",
        time: (&["#timestamp", "timestamp"], Some(NS)),
        gyro: (["w_rs_s_x", "w_rs_s_y", "w_rs_s_z"], RAD_S),
        accel: (["a_rs_s_x", "a_rs_s_y", "a_rs_s_z"], M_S2),
        mag: None,
        motors: NO_MOTORS,
        frame: Frame::ForwardMayBeZ,
    },
    Dialect {
        name: "a Crazyflie",
        time: (&["timestamp", "time", "tick"], Some(MS)),
        gyro: (["gyro.x", "gyro.y", "gyro.z"], DEG_S),
        accel: (["acc.x", "acc.y", "acc.z"], G),
        mag: Some((["mag.x", "mag.y", "mag.z"], GAUSS)),
        motors: (("motor.m#", 1), Motor::Of65535),
        frame: Frame::UpOrDown,
    },
    Dialect {
        name: "mavlogdump",
        time: (&["timeus", "imu.timeus", "timestamp"], None),
        gyro: (["gyrx", "gyry", "gyrz"], RAD_S),
        accel: (["accx", "accy", "accz"], M_S2),
        mag: None,
        motors: NO_MOTORS,
        frame: Frame::UpOrDown,
    },
    Dialect {
        name: "mavlogdump",
        time: (&["imu.timeus", "timestamp"], None),
        gyro: (["imu.gyrx", "imu.gyry", "imu.gyrz"], RAD_S),
        accel: (["imu.accx", "imu.accy", "imu.accz"], M_S2),
        mag: None,
        motors: NO_MOTORS,
        frame: Frame::UpOrDown,
    },
    Dialect {
        name: "Xsens",
        time: (&["time", "sampletimefine"], None),
        gyro: (["gyr_x", "gyr_y", "gyr_z"], DEG_S),
        accel: (["acc_x", "acc_y", "acc_z"], M_S2),
        mag: None,
        motors: NO_MOTORS,
        frame: Frame::UpOrDown,
    },
];
