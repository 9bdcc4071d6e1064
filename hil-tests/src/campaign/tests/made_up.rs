//! Flights that were never flown, for tests.

use crate::campaign::journal::{Landed, Stamp, flight_line};
use crate::campaign::role::Role;
use crate::campaign::sortie::{Job, Sortie, Tier};
use crate::closed_loop::BatteryReport;
use crate::closed_loop::report::{AxisErrors, Control, CrashReport, FlightReport};

/// A fingerprint of no sources.
pub(in crate::campaign) const SOURCES: &str = "0123456789ab";

pub(in crate::campaign) fn stamp() -> Stamp {
    Stamp::new("smoke", SOURCES.into())
}

/// A flight that was never flown.
pub(in crate::campaign) fn landed(role: Role, seed: u32, pitch: f64) -> Landed {
    let sortie = Sortie {
        tier: Tier::Native,
        airframe: reflex::config::AIRFRAME.into(),
        logic: "cascade".into(),
        environment: "lab".into(),
        duration_s: 30,
        role,
        seed,
    };
    let report = FlightReport {
        environment: sortie.environment.clone(),
        position: "motion_capture".into(),
        airframe: sortie.airframe.clone(),
        logic: sortie.logic.clone(),
        gains: None,
        bandwidth: 1.0,
        mission: "waypoints".into(),
        tier: Tier::Native,
        policy: "reactive".into(),
        rate_hz: None,
        clock_mhz: 168,
        seed,
        duration_s: 30.0,
        scored_from_s: Some(15.0),
        crashed: false,
        crash: None,
        attitude_error_deg: AxisErrors {
            roll: Some(1.0),
            pitch: Some(pitch),
            yaw: Some(1.0),
        },
        position_error_m: Some(0.2),
        turning_rad_s: Some(0.1),
        control: Control {
            rate_hz: Some(150.0),
            runs: 2250,
            per_second: vec![150; 30],
            ..Control::default()
        },
        cpu: None,
        energy_j: 4000.0,
        energy_per_minute_j: Some(8000.0),
        flight_time_s: Some(1300.0),
        wind_m_s: Some(0.3),
        battery: BatteryReport::default(),
        faults: None,
        digest: "00".into(),
    };
    let job = Job {
        sortie,
        period_us: None,
        bandwidth: crate::campaign::sortie::AS_CONFIGURED,
    };
    Landed { job, report }
}

/// The same, but down on the ground.
pub(in crate::campaign) fn crashed(role: Role, seed: u32) -> Landed {
    let mut landed = landed(role, seed, 1.0);
    let report = &mut landed.report;
    report.crashed = true;
    report.crash = Some(CrashReport {
        at_s: 3.0,
        what: "hit <the> ground & all".into(),
        position_m: [1.0, 2.0, 0.0],
        velocity_m_s: [0.0, 3.0, 4.0],
        attitude_deg: [10.0, -20.0, 30.0],
    });
    report.attitude_error_deg = AxisErrors::default();
    report.flight_time_s = None;
    report.control.rate_hz = None;
    landed
}

pub(in crate::campaign) fn line(landed: Landed) -> String {
    flight_line(&stamp(), landed).unwrap()
}
