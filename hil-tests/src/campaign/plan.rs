//! Plans by name: which flights a campaign has.

use std::collections::BTreeSet;

use clap::ValueEnum;

use super::margins;
use super::role::{Pace, Role};
use super::rule::Contender;
use super::sortie::{AS_CONFIGURED, CellName, Sortie, Tier};
use crate::logics::LogicName;
use crate::refusal::Refusal;

/// Every plan's name.
pub const NAMES: [&str; 3] = ["paper", "trade", "smoke"];
/// Most seeds of a plan.
pub const MOST_SEEDS: u32 = 10_000;
/// Rates of time-triggered control that the load is worked out from, Hz.
pub const LOAD_RATES_HZ: [u32; 2] = [100, 400];
/// The rate of time-triggered control that the paper compares with, Hz.
pub const USUAL_HZ: u32 = 400;
/// Seeds that the error is shown over the rate with, at most.
const RATE_SEEDS: u32 = 10;
/// The logic that a disturbance observer is made for.
const CASCADE: &str = "cascade";

/// The flights of a campaign, in a few words.
#[derive(Clone, Debug, PartialEq)]
pub struct Plan {
    /// Its name.
    pub name: String,
    /// Environments, from calm to windy.
    pub environments: Vec<String>,
    /// Airframes that fly.
    pub airframes: Vec<String>,
    /// Control logics that fly.
    pub logics: Vec<String>,
    /// Seeds of the main comparison, 1 to this.
    pub seeds: u32,
    /// Seeds that `P_run` and `T_failsafe` are varied over, 1 to this.
    pub sweep_seeds: u32,
    /// Seeds that are flown with loops tuned to equal margins, 1 to this; 0 tunes nothing.
    pub tuned_seeds: u32,
    /// Seeds that are flown hovering, 1 to this.
    pub hover_seeds: u32,
    /// Rates of time-triggered control that its error is shown over, Hz, besides the usual one.
    pub rates_hz: Vec<u32>,
    /// What error is traded for runs with.
    pub trade: Trade,
    /// The logic that they are varied with.
    pub sweep_logic: String,
    /// Values of `P_run` in thousandths, besides that of `config/`.
    pub p_runs: Vec<u32>,
    /// Values of `T_failsafe` in ms, besides that of `config/`.
    pub failsafes: Vec<u32>,
    /// From take-off to the end of every flight but the long ones, s.
    pub duration_s: u32,
    /// Airframe and length in s of the flights whose rate is shown over time.
    pub long: (String, u32),
    /// Length of emulated flights, s; none where nothing is emulated.
    pub emulated_s: Option<u32>,
}

/// Loops of several bandwidths, each with several budgets and at several rates.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Trade {
    /// Bandwidths, in % of the configured one.
    pub bandwidths: Vec<u32>,
    /// Budgets of reactive control in us, the finest first.
    pub budgets_us: Vec<u32>,
    /// Rates of time-triggered control, Hz.
    pub rates_hz: Vec<u32>,
}

impl Trade {
    /// The roles of one bandwidth, reactive ones first.
    pub fn roles(&self, percent: u32) -> impl Iterator<Item = Role> {
        let budgets = self.budgets_us.iter().copied().map(Pace::Budget);
        let rates = self.rates_hz.iter().copied().map(Pace::Rate);
        let paces = budgets.chain(rates);
        paces.map(move |pace| Role::Traded(percent, pace))
    }

    /// The role with the most runs and loops as configured.
    #[must_use]
    pub fn finest(&self) -> Option<Role> {
        let finest = Pace::Budget(*self.budgets_us.first()?);
        Some(Role::Traded(AS_CONFIGURED, finest))
    }
}

/// Flights that are flown by the same part of a campaign.
#[derive(Clone, Debug, PartialEq)]
pub struct Unit(pub Vec<Sortie>);

impl Plan {
    /// The plan of a name, with other numbers of seeds where asked for.
    ///
    /// # Errors
    /// An unknown name, with those that are known; a number of seeds out of range.
    pub fn named(name: &str, seeds: Option<u32>) -> Result<Self, Refusal> {
        let mut plan = match name {
            "paper" => Self::paper(),
            "trade" => Self::trade(),
            "smoke" => Self::smoke(),
            _ => {
                let known = NAMES.join(", ");
                let line = format!("{name}: is no plan, must be one of {known}");
                return Err(Refusal::new(line));
            }
        };
        if let Some(seeds) = seeds {
            if !(1..=MOST_SEEDS).contains(&seeds) {
                let line = format!("--seeds {seeds}: must be 1 to {MOST_SEEDS}");
                return Err(Refusal::new(line));
            }
            plan.seeds = seeds;
            plan.sweep_seeds = plan.sweep_seeds.min(seeds);
            plan.tuned_seeds = plan.tuned_seeds.min(seeds);
            plan.hover_seeds = plan.hover_seeds.min(seeds);
        }
        Ok(plan)
    }

    /// The same plan with as many seeds as make so many hours, at least.
    ///
    /// # Errors
    /// More hours than the most seeds make.
    pub fn for_hours(name: &str, hours: f64) -> Result<Self, Refusal> {
        let with = |seeds: u32| Self::named(name, Some(seeds));
        if !(hours > 0.0 && hours <= with(MOST_SEEDS)?.hours()) {
            let most = with(MOST_SEEDS)?.hours();
            let line = format!("--hours {hours}: must be above 0 and at most {most:.0}");
            return Err(Refusal::new(line));
        }
        let (mut few, mut enough) = (0, MOST_SEEDS);
        while enough - few > 1 {
            let between = few + (enough - few) / 2;
            if with(between)?.hours() >= hours {
                enough = between;
            } else {
                few = between;
            }
        }
        with(enough)
    }

    /// Simulated hours of all flights.
    #[must_use]
    pub fn hours(&self) -> f64 {
        let seconds = |plan: &Self| plan.units().iter().map(Unit::seconds).sum::<u64>();
        // From some seed on each adds as much as the one before.
        let settled = self.sweep_seeds.max(self.tuned_seeds).max(self.hover_seeds) + 1;
        let with = |seeds: u32| Self {
            seeds,
            ..self.clone()
        };
        let few = seconds(&with(self.seeds.min(settled)));
        let more = u64::from(self.seeds.saturating_sub(settled));
        let each = seconds(&with(settled + 1)) - seconds(&with(settled));
        (few + more * each) as f64 / 3600.0
    }

    /// The same without emulated flights, and so without equal processor time.
    #[must_use]
    pub fn native(self) -> Self {
        Self {
            emulated_s: None,
            ..self
        }
    }

    /// The same with gains of a name, for the control logics that have them; others do not fly.
    ///
    /// # Errors
    /// No logic of the plan has gains of this name.
    pub fn with_gains(self, name: &str) -> Result<Self, Refusal> {
        let varied = |logic: &String| {
            let logic = logic.split('/').next().unwrap_or(logic);
            let known = LogicName::from_str(logic, false).ok()?.variations();
            known
                .iter()
                .any(|it| it == name)
                .then(|| format!("{logic}/{name}"))
        };
        let mut logics: Vec<String> = self.logics.iter().filter_map(varied).collect();
        logics.dedup();
        if logics.is_empty() {
            let of = self.logics.join(", ");
            let line = format!("--gains {name}: no config/logics/LOGIC/{name}.toml of {of}");
            return Err(Refusal::new(line));
        }
        Ok(Self {
            sweep_logic: varied(&self.sweep_logic).unwrap_or(self.sweep_logic),
            logics,
            ..self
        })
    }

    /// Every flight, in the order of airframes.
    #[must_use]
    pub fn units(&self) -> Vec<Unit> {
        let mut units = Vec::new();
        for airframe in &self.airframes {
            for logic in &self.logics {
                units.extend(self.load_flights([airframe, logic]));
                for environment in &self.environments {
                    let seeds = 1..=self.seeds;
                    let cell = [airframe, logic, environment];
                    units.extend(seeds.map(|seed| self.trial(cell, seed)));
                    units.extend(self.tuning(cell));
                }
            }
            if *airframe == self.long.0 {
                units.push(self.long_flights());
            }
        }
        units
    }

    /// One airframe and logic under the same wind in every way.
    fn trial(&self, [airframe, logic, environment]: [&String; 3], seed: u32) -> Unit {
        let sortie = |role| Sortie {
            tier: Tier::Native,
            airframe: airframe.clone(),
            logic: logic.clone(),
            environment: environment.clone(),
            duration_s: self.duration_s,
            role,
            seed,
        };
        let mut roles = vec![
            Role::Reactive,
            Role::Unforeseen,
            Role::Periodic(USUAL_HZ),
            Role::EqualRuns,
        ];
        if self.emulated_s.is_some() {
            roles.push(Role::EqualTime);
        }
        if seed <= self.hover_seeds {
            roles.extend(Contender::ALL.map(Role::Hovering));
            if logic == CASCADE {
                roles.extend([Contender::Reactive, Contender::Usual].map(Role::Observing));
            }
        }
        let shows_rates = Some(airframe) == self.airframes.first();
        if shows_rates && seed <= RATE_SEEDS.min(self.sweep_seeds) {
            roles.extend(self.rates_hz.iter().copied().map(Role::Periodic));
        }
        let trade = &self.trade;
        roles.extend(trade.bandwidths.iter().flat_map(|it| trade.roles(*it)));
        if *logic == self.sweep_logic && seed <= self.sweep_seeds {
            roles.extend(self.p_runs.iter().copied().map(Role::PRun));
            roles.extend(self.failsafes.iter().copied().map(Role::Failsafe));
        }
        Unit(roles.into_iter().map(sortie).collect())
    }

    /// Any flight of each cell.
    #[must_use]
    pub fn cells(&self) -> Vec<Sortie> {
        let mut cells = Vec::new();
        for airframe in &self.airframes {
            for logic in &self.logics {
                let of = |environment| self.trial([airframe, logic, environment], 1).0;
                let first = self
                    .environments
                    .iter()
                    .filter_map(|it| of(it).into_iter().next());
                cells.extend(first);
            }
        }
        cells
    }

    /// A cell's flight with loops tuned to equal margins.
    #[must_use]
    pub fn tuned(&self, cell: &Sortie, role: Role, seed: u32) -> Sortie {
        Sortie {
            duration_s: self.duration_s,
            role,
            seed,
            ..cell.clone()
        }
    }

    /// The margins of a cell, and its flights with what they allow.
    fn tuning(&self, cell: [&String; 3]) -> Option<Unit> {
        let any = self.trial(cell, 1).0.into_iter().next()?;
        let tempos: BTreeSet<_> = margins::tuned_roles()
            .map(|(rule, of)| rule.tempo(of))
            .collect();
        let margins = tempos
            .into_iter()
            .flat_map(|tempo| margins::margins(&any, tempo));
        let tuned = margins::tuned_roles().flat_map(|(rule, of)| {
            let role = Role::Tuned(rule, of);
            let any = &any;
            (1..=self.tuned_seeds).map(move |seed| self.tuned(any, role, seed))
        });
        (self.tuned_seeds > 0).then(|| Unit(margins.chain(tuned).collect()))
    }

    /// Emulated flights of an airframe with a logic, for the processor's load.
    fn load_flights(&self, [airframe, logic]: [&str; 2]) -> Option<Unit> {
        let duration_s = self.emulated_s?;
        let sortie = |environment: &String, role| Sortie {
            tier: Tier::Emulated,
            airframe: airframe.to_owned(),
            logic: logic.to_owned(),
            environment: environment.clone(),
            duration_s,
            role,
            seed: 1,
        };
        let windiest = self.environments.last()?;
        let clock = LOAD_RATES_HZ.map(|hz| sortie(windiest, Role::Periodic(hz)));
        let reactive = self.environments.iter().flat_map(|environment| {
            let roles = [Some(Role::Reactive), self.trade.finest()];
            roles
                .into_iter()
                .flatten()
                .map(|role| sortie(environment, role))
        });
        Some(Unit(clock.into_iter().chain(reactive).collect()))
    }

    /// Flights whose rate of control is shown over time (the paper's figure 11).
    fn long_flights(&self) -> Unit {
        let (calm, windy) = (self.environments.first(), self.environments.last());
        let flights = [
            (windy, Role::Reactive),
            (calm, Role::Reactive),
            (windy, Role::Periodic(USUAL_HZ)),
        ];
        let sortie = |(environment, role): (Option<&String>, Role)| {
            Some(Sortie {
                tier: Tier::Native,
                airframe: self.long.0.clone(),
                logic: self.sweep_logic.clone(),
                environment: environment?.clone(),
                duration_s: self.long.1,
                role,
                seed: 1,
            })
        };
        Unit(flights.into_iter().filter_map(sortie).collect())
    }

    /// Where a cell stands in tables: by logic, environment, airframe as planned.
    #[must_use]
    pub fn place(&self, cell: &CellName) -> [Option<usize>; 3] {
        let within = |names: &[String], name: &str| names.iter().position(|it| it == name);
        [
            within(&self.logics, &cell.logic),
            within(&self.environments, &cell.environment),
            within(&self.airframes, &cell.airframe),
        ]
    }

    /// The emulated flights that equal processor time of a flight follows from.
    #[must_use]
    pub fn needs(&self, sortie: &Sortie) -> Vec<Sortie> {
        let unit = self.load_flights([&sortie.airframe, &sortie.logic]);
        let flights = unit.map(|unit| unit.0).unwrap_or_default();
        let is_needed = |flight: &Sortie| match flight.role {
            Role::Periodic(_) => true,
            _ => flight.environment == sortie.environment,
        };
        flights.into_iter().filter(is_needed).collect()
    }
}

impl Unit {
    /// Simulated seconds.
    fn seconds(&self) -> u64 {
        self.0
            .iter()
            .map(|sortie| u64::from(sortie.duration_s))
            .sum()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn hours(plan: &Plan, tier: Tier) -> f64 {
        let sorties = plan.part(None).into_iter();
        let of_tier = sorties.filter(|sortie| sortie.tier == tier);
        of_tier
            .map(|sortie| f64::from(sortie.duration_s))
            .sum::<f64>()
            / 3600.0
    }

    #[test]
    fn the_paper_takes_260_hours_and_half_an_hour_on_the_emulated_board() {
        let plan = Plan::named("paper", None).unwrap();
        assert!(
            hours(&plan, Tier::Native) > 265.0,
            "{}",
            hours(&plan, Tier::Native)
        );
        assert!(hours(&plan, Tier::Emulated) >= 0.55);
    }

    #[test]
    fn a_plan_of_an_unknown_name_lists_the_known_ones() {
        let error = Plan::named("papers", None).unwrap_err();
        let line = "papers: is no plan, must be one of paper, trade, smoke";
        assert_eq!(error.to_string(), line);
        for seeds in [0, MOST_SEEDS + 1] {
            let error = Plan::named("smoke", Some(seeds)).unwrap_err().to_string();
            assert_eq!(error, format!("--seeds {seeds}: must be 1 to 10000"));
        }
    }

    #[test]
    fn gains_of_a_name_are_flown_by_the_logics_that_have_them() {
        let paper = Plan::named("paper", None).unwrap();
        let varied = paper.with_gains("iris_plus").unwrap();
        assert_eq!(varied.logics, ["arducopter/iris_plus"]);
        let plan = Plan::named("smoke", None).unwrap();
        let varied = plan.clone().with_gains("iris_plus").unwrap();
        assert_eq!(varied.logics, ["arducopter/iris_plus"]);
        assert_eq!(varied.sweep_logic, "arducopter/iris_plus");
        let error = plan.with_gains("kite").unwrap_err().to_string();
        let line =
            "--gains kite: no config/logics/LOGIC/kite.toml of arducopter/iris_plus, cascade";
        assert_eq!(error, line);
    }

    #[test]
    fn a_flight_at_equal_processor_time_needs_the_load_of_its_logic_and_airframe() {
        let plan = Plan::named("paper", Some(1)).unwrap();
        let part = plan.part(None);
        let waits = part.iter().filter(|sortie| sortie.role == Role::EqualTime);
        for sortie in waits {
            let needs = plan.needs(sortie);
            assert_eq!(needs.len(), 3);
            assert!(needs.iter().all(|need| part.contains(need)));
        }
        let trade = Plan::named("trade", Some(1)).unwrap();
        let needs = trade.needs(&trade.cells()[0]);
        let finest = needs
            .iter()
            .filter(|need| Some(need.role) == trade.trade.finest());
        assert_eq!((needs.len(), finest.count()), (4, 1));
    }

    #[test]
    fn hours_are_those_of_all_flights_and_choose_the_seeds() {
        for (name, seeds) in [("paper", 1), ("paper", 40), ("trade", 2), ("smoke", 3)] {
            let plan = Plan::named(name, Some(seeds)).unwrap();
            let all = hours(&plan, Tier::Native) + hours(&plan, Tier::Emulated);
            assert!((plan.hours() - all).abs() < 1e-9, "{name} {seeds}");
            let enough = Plan::for_hours(name, plan.hours()).unwrap();
            assert_eq!(enough.seeds, seeds);
            let more = Plan::for_hours(name, plan.hours() + 0.001).unwrap();
            assert_eq!(more.seeds, seeds + 1);
        }
        for hours in [0.0, -1.0, f64::NAN, 1e9] {
            let error = Plan::for_hours("paper", hours).unwrap_err().to_string();
            assert!(
                error.starts_with(&format!("--hours {hours}: must be above 0")),
                "{error}"
            );
        }
    }
}
