//! One value for every reason that a run may have.

use reflex::app::Reason;
use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

/// One value per reason, under the names of the report.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize, Deserialize, JsonSchema)]
pub struct ByReason<T> {
    /// Time-triggered, to learn the models.
    pub warm_up: T,
    /// A sensor's change called for it.
    pub trigger: T,
    /// The longest time between runs had passed.
    pub failsafe: T,
    /// A new setpoint forced it.
    pub setpoint: T,
    /// At random, to see what the thresholds hide.
    pub exploration: T,
    /// The clock's, under the periodic policy.
    pub periodic: T,
    /// Time-triggered, because reactive control was not trusted.
    pub fallback: T,
    /// Time-triggered, on the ground.
    pub ground: T,
}

impl<T> ByReason<T> {
    /// The value of one reason.
    pub fn get(&self, reason: Reason) -> &T {
        match reason {
            Reason::WarmUp => &self.warm_up,
            Reason::Trigger => &self.trigger,
            Reason::Failsafe => &self.failsafe,
            Reason::Setpoint => &self.setpoint,
            Reason::Exploration => &self.exploration,
            Reason::Periodic => &self.periodic,
            Reason::Fallback => &self.fallback,
            Reason::Ground => &self.ground,
        }
    }

    /// The value of one reason, to change it.
    pub fn get_mut(&mut self, reason: Reason) -> &mut T {
        match reason {
            Reason::WarmUp => &mut self.warm_up,
            Reason::Trigger => &mut self.trigger,
            Reason::Failsafe => &mut self.failsafe,
            Reason::Setpoint => &mut self.setpoint,
            Reason::Exploration => &mut self.exploration,
            Reason::Periodic => &mut self.periodic,
            Reason::Fallback => &mut self.fallback,
            Reason::Ground => &mut self.ground,
        }
    }

    /// Every value with its reason's name, in the order of the report.
    pub fn named(&self) -> [(&'static str, &T); 8] {
        [
            ("warm_up", &self.warm_up),
            ("trigger", &self.trigger),
            ("failsafe", &self.failsafe),
            ("setpoint", &self.setpoint),
            ("exploration", &self.exploration),
            ("periodic", &self.periodic),
            ("fallback", &self.fallback),
            ("ground", &self.ground),
        ]
    }

    /// The same reasons with every value passed through `to`.
    pub fn map<U>(self, mut to: impl FnMut(T) -> U) -> ByReason<U> {
        ByReason {
            warm_up: to(self.warm_up),
            trigger: to(self.trigger),
            failsafe: to(self.failsafe),
            setpoint: to(self.setpoint),
            exploration: to(self.exploration),
            periodic: to(self.periodic),
            fallback: to(self.fallback),
            ground: to(self.ground),
        }
    }
}

impl ByReason<u64> {
    /// The sum over all reasons.
    #[must_use]
    pub fn total(&self) -> u64 {
        self.named().iter().map(|(_, count)| **count).sum()
    }
}
