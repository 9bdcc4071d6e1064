//! Why the rate alone decides little: a figure that the paper has not.

use anyhow::Result;

use super::Shown;
use super::bars::OTHERS;
use super::figures::{BARS, curve, svg, sweep};
use crate::campaign::findings::{Findings, Swept};
use crate::campaign::plan::Plan;
use crate::plot::{Panel, Scale};

/// The error of time-triggered control over its rate.
///
/// # Errors
/// None in practice: nothing is written but a string.
pub fn figure(plan: &Plan, findings: &Findings) -> Result<Shown> {
    let panels = plan.logics.iter().map(|logic| -> Panel {
        let of_logic = findings
            .rates
            .iter()
            .filter(|it| it.cell.name.logic == *logic);
        let own: Vec<&Swept> = of_logic.collect();
        let axis = ("runs per second", Scale::Logarithmic);
        let environments = (&*plan.environments, &OTHERS[..]);
        sweep(logic, axis, environments, &|name| {
            curve(&own, &|it| it.cell.name.environment == name)
        })
    });
    let title = "Time-triggered control at other rates, against its own 400 Hz";
    let airframe = plan.airframes.first().map_or("", String::as_str);
    Ok(Shown {
        file: "rates",
        number: "",
        title,
        svg: svg(plan, title, panels.collect())?,
        ours: format!(
            "{airframe}, with the gains as they are configured. Where the curve is flat, when control \
             runs cannot matter either: the loops are slower than the rate. {BARS}"
        ),
        paper: "it has no such figure.",
    })
}
