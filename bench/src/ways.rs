//! Every control logic in four ways, from one declaration: what does each cost?
//!
//! | way | is |
//! |---|---|
//! | `straight_line` | time-triggered: one function that computes everything |
//! | the page's own | ours |
//! | `callbacks` | a callback for each value, depth first from each input |
//! | `pointer_vector` | the layout of RP-Embedded |

use reflex::airframe::MotorShares;

use crate::step::Step;

/// A control logic, run in some way.
pub trait Way {
    /// Sets the inputs of a step, runs, and says what the command is then.
    fn take(&mut self, step: &Step) -> MotorShares;
}

/// Declares a logic's module: its three other ways, and how each takes a step.
macro_rules! ways {
    (
        $(#[$doc:meta])*
        $module:ident::$graph:ident from $declaration:ident;
        uses { $($used:item)* }
        inputs { $($input:ident: $set:ident),* }
    ) => {
        $(#[$doc])*
        pub mod $module {
            /// One function that computes everything at every step.
            pub mod straight_line {
                $($used)*
                use reflex::graph::$module::*;
                reflex::$declaration!(reflex_dataflow_macros::straight_line);
            }

            /// A callback for each value.
            pub mod callbacks {
                $($used)*
                use reflex::graph::$module::*;
                reflex::$declaration!(reflex_dataflow_macros::callbacks);
            }

            /// RP-Embedded's vectors.
            pub mod pointer_vector {
                $($used)*
                use reflex::graph::$module::*;
                reflex::$declaration!(reflex_dataflow_macros::pointer_vector);
            }

            ways!(@take reflex::graph::$graph { $($input: $set),* });
            ways!(@take straight_line::$graph { $($input: $set),* });
            ways!(@take callbacks::$graph { $($input: $set),* });
            ways!(@take pointer_vector::$graph { $($input: $set),* });
        }
    };
    (@take $type:path { $($input:ident: $set:ident),* }) => {
        impl crate::ways::Way for $type {
            fn take(&mut self, step: &crate::step::Step) -> reflex::airframe::MotorShares {
                $(if let Some(value) = step.$input {
                    self.$set(value);
                })*
                let _ = self.propagate();
                self.command().shares
            }
        }
    };
}

ways! {
    /// Reflex's own cascade.
    cascade::Cascade from declaration_of_cascade;
    uses {
        use reflex::airframe::Mixed;
        use reflex::control::{RateState, Setpoint, Wanted};
        use reflex::estimate::{AttitudeFilter, Increment, Rotation};
        use reflex::math::Quaternion;
        use reflex::units::TorqueDemand;
    }
    inputs {
        motion: set_motion, rotation: set_rotation, heading: set_heading,
        setpoint: set_setpoint, blind: set_blind
    }
}

ways! {
    /// After ArduCopter.
    arducopter::ArduCopter from declaration_of_arducopter;
    uses {
        use reflex::airframe::Mixed;
        use reflex::control::arducopter::*;
        use reflex::control::{Goal, Setpoint};
        use reflex::estimate::arducopter::DriftFilter;
        use reflex::estimate::{Increment, Place, Rotation};
        use reflex::math::Quaternion;
        use reflex::units::{Thrust, TorqueDemand};
    }
    inputs {
        motion: set_motion, rotation: set_rotation, heading: set_heading,
        setpoint: set_setpoint, goal: set_goal, place: set_place, blind: set_blind
    }
}

ways! {
    /// After Cleanflight.
    cleanflight::Cleanflight from declaration_of_cleanflight;
    uses {
        use reflex::airframe::Mixed;
        use reflex::control::cleanflight::*;
        use reflex::control::{Goal, Setpoint, Wanted};
        use reflex::estimate::{Increment, MahonyFilter, Place, Rotation};
        use reflex::math::Quaternion;
        use reflex::units::TorqueDemand;
    }
    inputs {
        motion: set_motion, rotation: set_rotation, heading: set_heading,
        setpoint: set_setpoint, goal: set_goal, place: set_place, blind: set_blind
    }
}

ways! {
    /// After OpenPilot.
    openpilot::OpenPilot from declaration_of_openpilot;
    uses {
        use reflex::airframe::Mixed;
        use reflex::control::openpilot::*;
        use reflex::control::{Goal, Setpoint};
        use reflex::estimate::{Increment, OpenPilotFilter, Place, Rotation};
        use reflex::math::Quaternion;
        use reflex::units::{BodyRates, TorqueDemand};
    }
    inputs {
        motion: set_motion, rotation: set_rotation, heading: set_heading,
        setpoint: set_setpoint, goal: set_goal, place: set_place, blind: set_blind
    }
}

ways! {
    /// Reflex's own cascade with a disturbance observer.
    observer::Observer from declaration_of_observer;
    uses {
        use reflex::airframe::Mixed;
        use reflex::control::{ObserverState, Setpoint, Wanted};
        use reflex::estimate::{AttitudeFilter, Increment, Rotation};
        use reflex::math::Quaternion;
        use reflex::units::TorqueDemand;
    }
    inputs {
        motion: set_motion, rotation: set_rotation, heading: set_heading,
        setpoint: set_setpoint, blind: set_blind
    }
}
