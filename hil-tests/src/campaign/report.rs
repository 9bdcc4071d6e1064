//! `report.html`: one page that works offline, its figures within it and beside it.
//!
//! Everything follows from the journals; only one line, the date, does not. The template escapes
//! all text.

mod bars;
mod figures;
mod headline;
mod method;
mod paper;
mod rate_sweep;
mod tables;
mod trade;

pub use tables::percent;

use anyhow::Result;
use maud::{Markup, PreEscaped, html};

use super::findings::Findings;
use super::journal::Records;
use super::plan::Plan;
use crate::page::page;

/// What a campaign has to show.
pub struct Report {
    /// The page.
    pub page: String,
    /// Its figures.
    pub figures: Vec<Shown>,
}

/// A figure with its number in the paper, and what is said below it.
pub struct Shown {
    /// Name of its file, without `.svg`.
    pub file: &'static str,
    /// As in the paper; empty for one that it has not.
    number: &'static str,
    title: &'static str,
    /// As an SVG document.
    pub svg: String,
    /// What is ours.
    ours: String,
    /// What the paper says of its own.
    paper: &'static str,
}

/// The page and its figures.
///
/// # Errors
/// None in practice: nothing is written but a string.
pub fn report(plan: &Plan, records: &Records, findings: &Findings, date: &str) -> Result<Report> {
    let mut figures = figures::all(plan, records, findings)?;
    figures.extend(trade::figures(plan, findings)?);
    figures.push(rate_sweep::figure(plan, findings)?);
    let title = format!("Reactive against periodic control: campaign {}", plan.name);
    let body = html! {
        h1 { "Reactive against periodic control" }
        (headline::section(findings))
        h2 { "Figures" }
        @for shown in &figures { (figure(shown)) }
        (tables::section(plan, findings))
        (method::section(plan, findings))
        // On a line of its own, so that two reports of the same flights differ in that alone.
        (PreEscaped("\n")) p { "Written on " (date) "." } (PreEscaped("\n"))
    };
    Ok(Report {
        page: page(&title, &body),
        figures,
    })
}

fn figure(shown: &Shown) -> Markup {
    html! {
        figure {
            h3 {
                (shown.title)
                @if !shown.number.is_empty() { " (figure " (shown.number) " of the paper)" }
            }
            // Drawn by this program, whose figures escape what they are given.
            (PreEscaped(&shown.svg))
            figcaption {
                p { (shown.ours) }
                p class="paper" { "The paper: " (shown.paper) }
            }
        }
    }
}
