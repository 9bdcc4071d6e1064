//! The report of a run beside its score, as far as both tiers know it.
//!
//! Options, sensors and faults are reported in the same way for both tiers. What only an emulated
//! processor shows is null here; the emulated tier adds it.

use std::collections::BTreeMap;

use reflex::app::{Call, ChipAction, ChipSetting, Fault, Outcome};
use reflex::reactive::{Fit, Phase};
use reflex::sensors::{Cause, Input, Unit};
use reflex::settings::Settings;

use super::asking::Asking;
use super::options::ReplayOptions;
use super::setup::chip_options;
use super::timeline::Timeline;
use crate::record::{Look, samples_since};
use crate::scoring::{
    FlightPart, Gap, ModelState, Options, RunReport, Sensor, SetpointSource, Tier, latencies,
};
use chip_models::DIES;
use emulated_board::SensorLine;
use recorded_flights::{Flight, Setpoints, Taken, seconds};

/// What was observed of the chips, in ns of the board's time.
pub(crate) struct ChipEvidence<'r> {
    /// When what is scored begins.
    pub(crate) from_ns: u64,
    /// Rising edges of each line.
    pub(crate) edges: [&'r [u64]; SensorLine::ALL.len()],
    /// Looks at the chips; the last at the end.
    pub(crate) looks: &'r [Look],
}

/// Everything that the report is made from.
pub(crate) struct Evidence<'r, 'c> {
    pub(crate) options: &'r ReplayOptions,
    pub(crate) flight: &'r Flight,
    pub(crate) setpoints: &'r Setpoints,
    pub(crate) timeline: &'r Timeline<'c>,
    pub(crate) chips: ChipEvidence<'r>,
}

/// The end of the warm-up on the firmware's clock (us); the replay's end where it lasts.
pub(crate) fn scored_from_us(timeline: &Timeline<'_>) -> u64 {
    let flight = &timeline.flight;
    flight.warm_up_end_us().unwrap_or(flight.last_us())
}

/// The unit of an input's changes in a report, and how much of the firmware's it is.
pub(crate) fn unit_of(input: Input, settings: &Settings) -> (&'static str, f32) {
    // Commands are shares of full scale in the firmware.
    match input.declaration().unit {
        Unit::Named(name) => (name, 1.0),
        Unit::Quantum => ("quanta", settings.quantum),
        Unit::QuantumTime => ("quantum ms", settings.quantum * 1e-3),
    }
}

impl Evidence<'_, '_> {
    /// What both tiers know; what only a processor shows is null.
    pub(crate) fn report(&self, tier: Tier, digest: String) -> RunReport {
        let log = self.options.log.as_ref();
        RunReport {
            log: log.map_or_else(|| self.flight.name.clone(), |log| log.display().to_string()),
            tier,
            policy: self.options.settings.policy.word().into(),
            seed: u64::from(self.options.settings.seed),
            options: options_in_effect(
                self.options,
                format!("{} ({})", self.flight.rotation, self.flight.rotation_reason),
            ),
            part: self.part(),
            setpoint: self.setpoint(),
            gaps: self.gaps(),
            notes: self.notes(),
            disarmed_s: (self.timeline.disarmed_us).map(|at_us| at_us as f64 * 1e-6),
            firmware: None,
            sensors: Input::ALL.map(|input| self.sensor(input)).into(),
            latency_us: latencies(&self.timeline.flight, &[]),
            latency_parts_us: Vec::new(),
            cpu: None,
            board: None,
            counters: self.counters(),
            digest,
        }
    }

    fn part(&self) -> FlightPart {
        let Taken { span, reason } = self.flight.part;
        FlightPart {
            from_s: seconds(span.from_ns),
            to_s: seconds(span.to_ns),
            reason: reason.to_string(),
        }
    }

    fn notes(&self) -> Vec<String> {
        let skipped = self.flight.skipped.kinds().iter();
        let skipped = skipped.map(|skip| format!("skipped {skip}"));
        skipped.chain(self.flight.notes.iter().cloned()).collect()
    }

    fn setpoint(&self) -> SetpointSource {
        match self.setpoints.sources.attitude {
            recorded_flights::SetpointSource::Recorded => SetpointSource::Log,
            _ => SetpointSource::LowPassed,
        }
    }

    fn gaps(&self) -> Vec<Gap> {
        let gaps = self.flight.gaps.iter();
        gaps.map(|gap| Gap {
            start_s: gap.at_s,
            length_s: gap.length_s,
        })
        .collect()
    }

    fn sensor(&self, input: Input) -> Sensor {
        let chips = &self.chips;
        let since =
            |edges: &[u64]| (edges.len() - edges.partition_point(|at| *at <= chips.from_ns)) as u64;
        let chip = Input::OF_CHIPS.into_iter().position(|chip| chip == input);
        let line = chip.map_or(SensorLine::ImuReady, |chip| SensorLine::OF_DIES[chip]);
        let specimens = chip_options(self.flight, self.options);
        let present = chip.is_none_or(|chip| (DIES[chip].is_present)(specimens.present));
        let interrupts = since(chips.edges[line as usize]);
        // Every sample of the inertial sensor pulses its line.
        let samples = chip.map_or(interrupts, |chip| {
            samples_since(chips.looks, chips.from_ns, chip)
        });
        let Timeline {
            calls, verdicts, ..
        } = self.timeline;
        let asking = Asking::of(input, calls, verdicts, scored_from_us(self.timeline));
        let fit = self.timeline.mirror.autopilot().fit(input);
        let (unit_name, unit) = unit_of(input, &self.options.settings);
        let model = match fit {
            Fit::Model(model) => Some(model),
            Fit::Unfit | Fit::Irrelevant => None,
        };
        Sensor {
            name: input.name().into(),
            present,
            samples,
            interrupts,
            spared: chip.map_or(0, |_| samples.saturating_sub(interrupts)),
            orders: asking.orders,
            triggers: asking.runs,
            first: asking.first,
            alone: asking.alone,
            rightly: asking.rightly,
            state: self.state(fit, present),
            threshold: model
                .map(|_| short(self.timeline.mirror.autopilot().threshold(input) / unit)),
            unit: unit_name.into(),
            chip_threshold: chip.and_then(|chip| chips.looks.last()?.chips[chip].threshold),
            chip_thresholds_set: self.count_calls(|call| match call {
                Call::OrderDone(order, Ok(ChipSetting::PastThreshold { .. })) => {
                    order.input == input && matches!(order.action, ChipAction::Threshold(_))
                }
                _ => false,
            }),
            chip_crossings: self.count_calls(|call| match call {
                Call::Chip(sample) => sample.input == input && sample.cause == Cause::Threshold,
                _ => false,
            }),
            b1: model.map(|model| short(model.b1)),
            b2: model.map(|model| short(model.b2 * unit)),
        }
    }

    fn count_calls(&self, of: impl Fn(&Call) -> bool) -> u64 {
        let calls = self.timeline.calls.iter();
        calls.filter(|stamped| of(&stamped.call)).count() as u64
    }

    fn state(&self, fit: Fit, present: bool) -> ModelState {
        let learning = self.timeline.mirror.autopilot().telemetry().phase != Phase::Reactive;
        match fit {
            _ if !present => ModelState::Absent,
            Fit::Model(_) => ModelState::Fit,
            Fit::Irrelevant => ModelState::Irrelevant,
            Fit::Unfit if learning => ModelState::Learning,
            Fit::Unfit => ModelState::Unfit,
        }
    }

    fn counters(&self) -> BTreeMap<String, u64> {
        let autopilot = self.timeline.mirror.autopilot();
        let mut counters: BTreeMap<String, u64> = (Fault::ALL.into_iter())
            .map(|fault| (counter_of(fault), autopilot.faults(fault).into()))
            .collect();
        counters.extend(Outcome::ALL.map(|outcome| {
            let name = snake_case(&format!("Runs{outcome:?}"));
            (name, autopilot.outcomes(outcome).into())
        }));
        counters.extend(
            self.timeline
                .fallbacks_by_reason
                .iter()
                .map(|(reason, count)| {
                    (
                        format!("fallback_{}", snake_case(&format!("{reason:?}"))),
                        *count,
                    )
                }),
        );
        counters.extend([
            ("fallbacks".into(), self.timeline.fallbacks),
            ("calls".into(), self.timeline.calls.len() as u64),
        ]);
        counters
    }
}

/// The name of a fault's counter; those of chips have the name of the input, as everywhere.
fn counter_of(fault: Fault) -> String {
    match fault {
        Fault::ChipSilent(input) => format!("{}_silent", input.name()),
        Fault::ChipStuck(input) => format!("{}_stuck", input.name()),
        fault => snake_case(&format!("{fault:?}")),
    }
}

/// The options of a replay as the report spells them; `rotate` says how the log was turned.
pub(crate) fn options_in_effect(options: &ReplayOptions, rotate: String) -> Options {
    Options {
        logic: options.gains.logic().word().into(),
        gains: options.gains.name().map(str::to_owned),
        settings: options.settings,
        rotate,
        noise: if options.noise { "datasheet" } else { "none" }.into(),
        duration_s: options.duration_s,
    }
}

/// A float as it was written, without the digits that its binary form adds.
fn short(value: f32) -> f64 {
    value.to_string().parse().unwrap_or(f64::from(value))
}

fn snake_case(name: &str) -> String {
    let mut snake = String::new();
    for (place, letter) in name.char_indices() {
        if letter.is_uppercase() && place > 0 {
            snake.push('_');
        }
        snake.extend(letter.to_lowercase());
    }
    snake
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn numbers_are_reported_as_they_were_given() {
        assert_eq!(short(0.6), 0.6);
    }
}
