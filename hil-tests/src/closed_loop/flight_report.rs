//! From a flight that has ended to its report.

use anyhow::Result;
use reflex::settings::{Policy, Settings};

use super::fault_watch::FaultWatch;
use super::report::{AxisErrors, Control, CrashReport, FlightReport};
use super::simulated_flight::{Scored, SimulatedFlight};
use super::station::TAKE_OFF_NS;
use super::{Flyer, Scene};
use crate::record::Counted;
use crate::scoring::Tier;

/// What is left in the battery where flight time ends (Bregu et al. 2016, section 7.1).
const RESERVE: f64 = 0.2;

/// The scored part of a flight that was flown to its end.
struct Whole {
    length_s: f64,
    energy_j: f64,
    charge: f64,
    wind_m_s: f64,
}

impl Whole {
    /// None where it has no length.
    fn of(scored: &Scored) -> Option<Self> {
        let Scored { from, to, .. } = scored;
        let length_s = (to.at_ns - from.at_ns) as f64 * 1e-9;
        (length_s > 0.0).then(|| Self {
            length_s,
            energy_j: to.energy_j - from.energy_j,
            charge: from.charge - to.charge,
            wind_m_s: scored.wind_sum / scored.looks as f64,
        })
    }
}

impl SimulatedFlight<'_> {
    /// Every number, and instructions where they were counted; where there is no scored part, or the flight ended before its time, none is
    /// made up.
    ///
    /// # Errors
    /// What only the end shows of the firmware.
    pub(super) fn report(
        self,
        scene: &Scene,
        flyer: Flyer<'_>,
    ) -> Result<(FlightReport, Option<Counted>)> {
        let (options, crash) = (self.options, self.crash());
        let whole = self.scored.as_ref().and_then(Whole::of);
        let whole = whole.filter(|_| crash.is_none());
        let is_whole = whole.is_some();
        let attitude_error_deg = self.errors(is_whole);
        let position_error_m = self.measures.position.value().filter(|_| is_whole);
        let turning_rad_s = self.measures.turning.value().filter(|_| is_whole);
        let control = self.control(whole.as_ref().map(|whole| whole.length_s));
        let faults = self.watch.as_ref().map(FaultWatch::report);
        let duration_s = self.since_take_off_s().max(0.0);
        let drone = self.world.drone();
        let energy_j = drone.state().energy_used;
        let battery = self.battery.report(drone, since_take_off_s);
        let from_ns = self.scored.as_ref().map(|scored| scored.from.at_ns);
        let ended = self.board.finish(from_ns.unwrap_or_default())?;
        let (tier, clock_mhz) = match flyer {
            Flyer::Native => (Tier::Native, 168),
            Flyer::Emulated(core) => (Tier::Emulated, core.mhz),
        };
        let Settings { policy, period, .. } = options.settings;
        let rate_hz = (policy == Policy::Periodic).then(|| 1e6 / period.ticks() as f64);
        let report = FlightReport {
            environment: scene.environment_name.clone(),
            position: scene.position_name.clone(),
            airframe: scene.airframe_name.clone(),
            logic: options.gains.logic().word().to_owned(),
            gains: options.gains.name().map(str::to_owned),
            bandwidth: options.gains.bandwidth(),
            mission: options.mission.name().to_owned(),
            tier,
            policy: policy.word().to_owned(),
            rate_hz,
            clock_mhz,
            seed: options.settings.seed,
            duration_s,
            scored_from_s: from_ns.map(since_take_off_s),
            crashed: crash.is_some(),
            crash,
            attitude_error_deg,
            position_error_m,
            turning_rad_s,
            control,
            cpu: ended.cpu,
            energy_j,
            energy_per_minute_j: (whole.as_ref())
                .map(|whole| 60.0 * whole.energy_j / whole.length_s),
            flight_time_s: (whole.as_ref())
                .map(|whole| (1.0 - RESERVE) * whole.length_s / whole.charge),
            wind_m_s: whole.as_ref().map(|whole| whole.wind_m_s),
            battery,
            faults,
            digest: ended.digest,
        };
        Ok((report, ended.counted))
    }

    fn errors(&self, is_whole: bool) -> AxisErrors {
        let [roll, pitch, yaw] = self.measures.attitude.map(|rms| {
            let error = rms.value().filter(|_| is_whole)?;
            Some(error.to_degrees())
        });
        AxisErrors { roll, pitch, yaw }
    }

    fn control(&self, length_s: Option<f64>) -> Control {
        let runs = self.measures.runs();
        let changed = self.measures.changed as f64 / runs as f64;
        Control {
            rate_hz: length_s.map(|length_s| runs as f64 / length_s),
            runs,
            unchanged_share: (runs > 0).then_some(1.0 - changed),
            by_reason: self.measures.by_reason,
            per_second: self.measures.per_second.clone(),
        }
    }

    fn crash(&self) -> Option<CrashReport> {
        let (at_ns, what) = self.end()?;
        let state = self.world.state();
        Some(CrashReport {
            at_s: since_take_off_s(at_ns),
            what,
            position_m: state.position.into(),
            velocity_m_s: state.velocity.into(),
            attitude_deg: self.world.angles().map(f64::to_degrees),
        })
    }
}

fn since_take_off_s(at_ns: u64) -> f64 {
    (at_ns as f64 - TAKE_OFF_NS as f64) * 1e-9
}
