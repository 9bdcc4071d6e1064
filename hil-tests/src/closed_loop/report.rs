//! The report of a simulated flight, as JSON and as text.

use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

use super::battery_report::BatteryReport;
use super::fault_report::FaultReport;
use crate::scoring::{ByReason, Tier, or_dash};

/// The whole flight. The scored part begins when the drone is up and has learned.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
pub struct FlightReport {
    /// Name of the environment.
    pub environment: String,
    /// How the drone's place is known: a name.
    pub position: String,
    /// Name of the airframe.
    pub airframe: String,
    /// Name of the control logic.
    pub logic: String,
    /// Gains of the control logic, if not those of its own file: a name or a file; else null.
    pub gains: Option<String>,
    /// How many times as fast as configured attitude and rate loops are.
    pub bandwidth: f64,
    /// `hover` or `waypoints`.
    pub mission: String,
    /// Where the autopilot ran: `emulated` or `native`.
    pub tier: Tier,
    /// `reactive` or `periodic`.
    pub policy: String,
    /// Runs per second that were asked for; null for the reactive policy.
    pub rate_hz: Option<f64>,
    /// Speed of the core in MHz, a million instructions per second each.
    pub clock_mhz: u32,
    /// Seed of wind, noise, oscillators, waypoints and exploration.
    pub seed: u32,
    /// From take-off to the end, s.
    pub duration_s: f64,
    /// Where the scored part begins, s from take-off; null where the flight ended before.
    pub scored_from_s: Option<f64>,
    /// The drone hit the ground or turned over.
    pub crashed: bool,
    /// How it crashed.
    pub crash: Option<CrashReport>,
    /// Desired less actual angles in the scored part, RMS in degrees.
    pub attitude_error_deg: AxisErrors,
    /// Distance from where it should be in the scored part, RMS in m.
    pub position_error_m: Option<f64>,
    /// Body rates in the scored part, RMS in rad/s.
    pub turning_rad_s: Option<f64>,
    /// When control ran.
    pub control: Control,
    /// What the processor did in the scored part; null in the native tier, which has none.
    pub cpu: Option<Cpu>,
    /// Energy drawn from the battery from take-off to the end, J.
    pub energy_j: f64,
    /// Energy per minute in the scored part, J.
    pub energy_per_minute_j: Option<f64>,
    /// Flight time from a full battery to 20 % at the scored part's power, s.
    pub flight_time_s: Option<f64>,
    /// Mean speed of the wind that was met in the scored part, m/s.
    pub wind_m_s: Option<f64>,
    /// The battery at the end, and what the firmware made of it.
    pub battery: BatteryReport,
    /// What came of the faults of a script; null where nothing was to break.
    pub faults: Option<FaultReport>,
    /// SHA-256 of all motor commands with their instants.
    pub digest: String,
}

/// How a flight ended before its time.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
pub struct CrashReport {
    /// When, s from take-off.
    pub at_s: f64,
    /// What happened.
    pub what: String,
    /// North, east, down, m.
    pub position_m: [f64; 3],
    /// North, east, down, m/s.
    pub velocity_m_s: [f64; 3],
    /// Roll, pitch, yaw, degrees.
    pub attitude_deg: [f64; 3],
}

/// One error per axis; null where that axis was never asked for.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize, Deserialize, JsonSchema)]
pub struct AxisErrors {
    /// About the forward axis.
    pub roll: Option<f64>,
    /// About the right axis.
    pub pitch: Option<f64>,
    /// About the down axis.
    pub yaw: Option<f64>,
}

/// When control ran.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize, JsonSchema)]
pub struct Control {
    /// Mean runs per second in the scored part.
    pub rate_hz: Option<f64>,
    /// Runs in the scored part.
    pub runs: u64,
    /// Share of these whose command does not differ by a quantum from the one before.
    pub unchanged_share: Option<f64>,
    /// Runs in the scored part by reason.
    pub by_reason: ByReason<u64>,
    /// Runs of each second from take-off on.
    pub per_second: Vec<u32>,
}

/// What the processor did.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
pub struct Cpu {
    /// Share of the time that the core was awake, its exceptions for nothing.
    pub busy_fraction: f64,
    /// Exceptions entered a second.
    pub exceptions_per_second: f64,
    /// Share of the time with 22 cycles for each exception, as silicon takes them to enter and to leave.
    pub busy_with_exceptions: f64,
}

impl FlightReport {
    /// The crash in one line.
    #[must_use]
    pub fn crash_text(&self) -> Option<String> {
        let crash = self.crash.as_ref()?;
        let [north, east, down] = crash.position_m;
        let [roll, pitch, yaw] = crash.attitude_deg;
        Some(format!(
            "{} {:.3} s behind take-off, at north {north:.1} m, east {east:.1} m, height {:.1} m, \
             roll {roll:.0}, pitch {pitch:.0}, yaw {yaw:.0} degrees, {:.1} m/s",
            crash.what,
            crash.at_s,
            -down,
            crash
                .velocity_m_s
                .iter()
                .map(|axis| axis * axis)
                .sum::<f64>()
                .sqrt(),
        ))
    }
}

/// The flight for a person; a dash stands for what has no value.
#[must_use]
pub fn summary(report: &FlightReport) -> String {
    let when = match report.rate_hz {
        Some(rate) => format!("{} at {rate} Hz", report.policy),
        None => report.policy.clone(),
    };
    let errors = report.attitude_error_deg;
    let reasons: Vec<String> = (report.control.by_reason.named().iter())
        .filter(|named| *named.1 > 0)
        .map(|(name, count)| format!("{name} {count}"))
        .collect();
    let minutes = report.flight_time_s.map(|time| time / 60.0);
    let gains = report.gains.as_ref();
    let gains = gains.map_or(String::new(), |name| format!(" and gains {name}"));
    let mut lines = vec![
        format!(
            "{} in {} with {}{gains}, {}: {}, {} tier at {} MHz, seed {}",
            report.airframe,
            report.environment,
            report.logic,
            report.mission,
            when,
            report.tier,
            report.clock_mhz,
            report.seed
        ),
        format!(
            "{:.1} s from take-off, scored from {} s, mean wind {} m/s",
            report.duration_s,
            or_dash(report.scored_from_s, 1),
            or_dash(report.wind_m_s, 1)
        ),
        format!(
            "attitude error   roll {} pitch {} yaw {} degrees",
            or_dash(errors.roll, 3),
            or_dash(errors.pitch, 3),
            or_dash(errors.yaw, 3)
        ),
        format!("position error   {} m", or_dash(report.position_error_m, 3)),
        format!(
            "control          {} runs/s ({}), unchanged {} %",
            or_dash(report.control.rate_hz, 1),
            reasons.join(", "),
            or_dash(report.control.unchanged_share.map(|share| 100.0 * share), 1)
        ),
        format!("processor        {}", busy_text(report)),
        format!(
            "energy           {} J/min, {} min to 20 % of the battery",
            or_dash(report.energy_per_minute_j, 0),
            or_dash(minutes, 1)
        ),
    ];
    lines.push(format!("battery          {}", report.battery));
    if let Some(faults) = &report.faults {
        lines.push(format!("faults           {faults}"));
    }
    if let Some(crash) = report.crash_text() {
        lines.push(format!("CRASHED          {crash}"));
    }
    lines.push(format!("digest           {}", report.digest));
    lines.join("\n") + "\n"
}

/// How busy the processor was, without and with its exceptions.
fn busy_text(report: &FlightReport) -> String {
    report.cpu.map_or("busy - %".to_owned(), |cpu| {
        let [plain, charged] = [cpu.busy_fraction, cpu.busy_with_exceptions].map(|of| 100.0 * of);
        let entered = cpu.exceptions_per_second;
        format!("busy {plain:.2} %, {charged:.2} % with 22 cycles for each of {entered:.0} exceptions a second")
    })
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::json::to_json;

    fn crashed() -> FlightReport {
        FlightReport {
            environment: "arch".into(),
            position: "companion".into(),
            airframe: "quad_x".into(),
            logic: "cascade".into(),
            gains: None,
            bandwidth: 1.0,
            mission: "hover".into(),
            tier: Tier::Native,
            policy: "periodic".into(),
            rate_hz: Some(400.0),
            clock_mhz: 168,
            seed: 7,
            duration_s: 2.0,
            scored_from_s: None,
            crashed: true,
            crash: Some(CrashReport {
                at_s: 2.0,
                what: "hit the ground".into(),
                position_m: [1.0, 2.0, 0.0],
                velocity_m_s: [0.0, 3.0, 4.0],
                attitude_deg: [10.0, -20.0, 30.0],
            }),
            attitude_error_deg: AxisErrors::default(),
            position_error_m: None,
            turning_rad_s: None,
            control: Control::default(),
            cpu: None,
            energy_j: 100.0,
            energy_per_minute_j: None,
            flight_time_s: None,
            wind_m_s: None,
            battery: BatteryReport {
                charge: 0.0,
                volts: 3.2,
                state: "critical".into(),
                low_s: Some(-0.25),
                critical_s: Some(0.75),
                empty_s: Some(1.75),
                ended_s: None,
            },
            faults: None,
            digest: "00".into(),
        }
    }

    #[test]
    fn a_crash_is_told_with_time_and_state_and_no_error_is_made_up() {
        let text = summary(&crashed());
        assert!(
            text.contains(
                "CRASHED          hit the ground 2.000 s behind take-off, at north 1.0 m, \
                 east 2.0 m, height -0.0 m, roll 10, pitch -20, yaw 30 degrees, 5.0 m/s"
            ),
            "{text}"
        );
        assert!(text.contains("roll - pitch - yaw - degrees"), "{text}");
        let battery = "battery          0.0 % left, 3.2 V, critical; low from -0.2 s; nearly empty from 0.8 s; empty from 1.8 s\n";
        assert!(text.contains(battery), "{text}");
    }

    #[test]
    fn json_reads_back_to_the_same() {
        let json = to_json(&crashed()).unwrap();
        assert_eq!(
            serde_json::from_str::<FlightReport>(&json).unwrap(),
            crashed()
        );
    }
}
