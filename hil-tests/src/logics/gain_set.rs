//! The gains that a control logic flies with: its own, varied, made faster.

use reflex_config::Logic;

use super::{AnyGains, LogicName};
use crate::refusal::Refusal;
use crate::toolchain;

/// What a variation's file ends with, and no name of one does.
const FILE_END: &str = ".toml";

/// Gains, and what they are called.
#[derive(Clone, Debug, PartialEq)]
pub struct GainSet {
    values: AnyGains,
    name: Option<String>,
    bandwidth: f64,
}

impl From<LogicName> for GainSet {
    /// Those of `config/`.
    fn from(logic: LogicName) -> Self {
        Self {
            values: logic.gains(),
            name: None,
            bandwidth: 1.0,
        }
    }
}

impl GainSet {
    /// The gains of a logic as a variation of a name, or a file, has them; with attitude and rate
    /// loops so many times as fast.
    ///
    /// # Errors
    /// An unknown name, with those that are known; something wrong in a file; a gain that leaves
    /// its range.
    pub fn load(logic: LogicName, name: Option<&str>, bandwidth: f64) -> Result<Self, Refusal> {
        let (config, declared) = (toolchain::root().join("config"), logic.declared());
        let refused = |line: String| Refusal::new(line);
        let mut read =
            Logic::load(&config, declared).map_err(|error| refused(error.to_string()))?;
        if let Some(name) = name {
            let file = match name.ends_with(FILE_END) {
                true => name.into(),
                false => Logic::variation(&config, declared, name)
                    .map_err(|line| refused(format!("--gains {name}: {line}")))?,
            };
            read.vary(&file)
                .map_err(|error| refused(error.to_string()))?;
        }
        read.quicken(bandwidth)
            .map_err(|line| refused(format!("--bandwidth {line}")))?;
        let mut numbers = read.numbers.iter();
        let mut bytes = || numbers.next().map(|number| (*number as f32).to_le_bytes());
        let values = logic.gains_of(&mut bytes);
        Ok(Self {
            // A file that was read has a number for each that is declared.
            values: values.unwrap_or(logic.gains()),
            name: name.map(str::to_owned),
            bandwidth,
        })
    }

    /// The numbers.
    #[must_use]
    pub fn values(&self) -> AnyGains {
        self.values
    }

    /// The control logic that they are of.
    #[must_use]
    pub fn logic(&self) -> LogicName {
        self.values.name()
    }

    /// The variation, as it was asked for; none of the logic's own.
    #[must_use]
    pub fn name(&self) -> Option<&str> {
        self.name.as_deref()
    }

    /// How many times as fast as these files say attitude and rate loops are.
    #[must_use]
    pub fn bandwidth(&self) -> f64 {
        self.bandwidth
    }
}

impl LogicName {
    /// The names of its gains in `config/` beside its own.
    #[must_use]
    pub fn variations(self) -> Vec<String> {
        Logic::variations(&toolchain::root().join("config"), self.declared())
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn angle_p(set: &GainSet) -> [f32; 3] {
        match set.values() {
            AnyGains::ArduCopter(gains) => gains.angle.p,
            other => panic!("{other:?}"),
        }
    }

    #[test]
    fn a_variation_says_only_what_differs_from_the_logics_own_gains() {
        let own = GainSet::from(LogicName::ArduCopter);
        let iris = GainSet::load(LogicName::ArduCopter, Some("iris_plus"), 1.0).unwrap();
        assert_eq!(
            (angle_p(&own), angle_p(&iris)),
            ([4.5; 3], [11.25, 11.25, 6.0])
        );
        let thrust = |set: &GainSet| match set.values() {
            AnyGains::ArduCopter(gains) => gains.thrust,
            other => panic!("{other:?}"),
        };
        assert_eq!(thrust(&own), thrust(&iris));
        let slower = GainSet::load(LogicName::ArduCopter, Some("iris_plus"), 0.5).unwrap();
        assert_eq!(angle_p(&slower), [5.625, 5.625, 3.0]);
    }

    #[test]
    fn every_variation_of_the_configuration_can_be_read() {
        let mut count = 0;
        for logic in <LogicName as clap::ValueEnum>::value_variants() {
            for name in logic.variations() {
                GainSet::load(*logic, Some(&name), 1.0).unwrap();
                count += 1;
            }
        }
        assert!(count > 0, "there is one at least");
    }

    #[test]
    fn loops_that_would_be_too_fast_are_refused_with_the_gain_and_its_range() {
        let file = tempfile::Builder::new()
            .suffix(FILE_END)
            .tempfile()
            .unwrap();
        std::fs::write(file.path(), "[angle]\np = [20, 20, 5]\n").unwrap();
        let name = file.path().to_str().unwrap();
        let refusal = GainSet::load(LogicName::ArduCopter, Some(name), 4.0).unwrap_err();
        let line =
            "--bandwidth 4: brings arducopter's angle.p to 80, must be above 0 and at most 60";
        assert_eq!(refusal.to_string(), line);
    }

    #[test]
    fn unknown_names_and_wrong_files_are_refused_in_one_line() {
        let folder = tempfile::tempdir().unwrap();
        let file = |name: &str, text: &str| {
            let path = folder.path().join(name);
            std::fs::write(&path, text).unwrap();
            path.display().to_string()
        };
        let key = file("key.toml", "[angle]\nq = 1\n");
        let range = file("range.toml", "[rate]\n\np = [0.1, 0.1, 7]\n");
        for (logic, name, line) in [
            (
                LogicName::ArduCopter,
                "kite",
                "--gains kite: logics/arducopter/kite.toml does not exist, must be one of: iris_plus".to_owned(),
            ),
            (
                LogicName::Cascade,
                "iris_plus",
                "--gains iris_plus: logics/cascade/ holds no gains, name a file".to_owned(),
            ),
            (
                LogicName::ArduCopter,
                "nowhere.toml",
                "nowhere.toml: cannot be read: No such file or directory (os error 2)".to_owned(),
            ),
            (
                LogicName::ArduCopter,
                &key,
                format!("{key}:2: angle.q: unknown field `q`, expected one of p, acceleration_rad_s2, yaw_error_limit_rad"),
            ),
            (
                LogicName::ArduCopter,
                &range,
                format!("{range}:3: rate.p: [0.1, 0.1, 7] is out of range, must be each 0 to 1 share of full authority per rad/s"),
            ),
        ] {
            let refusal = GainSet::load(logic, Some(name), 1.0).unwrap_err();
            assert_eq!(refusal.to_string(), line);
        }
    }
}
