//! How the report was made, and what its simulation leaves out.

use maud::{Markup, html};

use crate::campaign::findings::Findings;
use crate::campaign::plan::Plan;
use crate::campaign::sortie::SCORED_FROM_S;

/// The last section.
pub fn section(plan: &Plan, findings: &Findings) -> Markup {
    html! {
        h2 { "How this was made" }
        ul {
            li {
                "Plan " (plan.name) ": " (plan.environments.join(", ")) "; " (plan.airframes.join(", ")) "; "
                (plan.logics.join(", ")) "; seeds 1 to " (plan.seeds) ", P_run and T_failsafe varied over "
                "seeds 1 to " (plan.sweep_seeds) " with " (plan.sweep_logic) "."
            }
            li {
                "Flights of " (plan.duration_s) " s over 8 random waypoints at up to 3 m/s and 5 m height, "
                "scored from " (SCORED_FROM_S) " s on, whoever flies. One seed is one wind, one path, one set "
                "of sensor errors: flights are compared in pairs of one seed."
            }
            li {
                "Equal runs: the mean rate of reactive control in the scored part of that very trial. "
                "Equal processor time: see the table of processor time. Both within 11 to 1000 Hz."
            }
            li {
                "Planned flights " (findings.planned) ", not flown " (findings.missing)
                ", without a rate to be equal to " (findings.undecided) ", crashed " (findings.crashes.len()) "."
            }
            li { "Confidence intervals: Student's t at 95 % over seeds, by the crate statrs." }
            li {
                "Reflex " (env!("CARGO_PKG_VERSION")) ", sources " (findings.sources)
                ". Every flight with all its numbers: flights.parquet beside this page."
            }
        }
        h3 { "What is not modelled" }
        ul {
            li {
                "Of the air: ground effect, vortex rings and inflow, blade flapping, the wake of one rotor on "
                "another but for a constant factor."
            }
            li {
                "Of the drone: flexing of the frame, regenerative braking, temperature, sensors away from the "
                "centre of mass, wear."
            }
            li { "GPS and vision as such: reports of the true place with noise come over the link." }
            li {
                "Natively, the time that the processor takes: commands are written a fixed time behind their "
                "sample. The emulated core takes one cycle an instruction, so its load is a lower bound."
            }
        }
    }
}
