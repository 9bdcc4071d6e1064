//! `docs/reports.md`: every field of every JSON object, from the reports' types.

use std::fmt::Write;

use schemars::JsonSchema;
use schemars::generate::SchemaSettings;
use serde_json::Value;

use super::cell;
use crate::campaign::Findings;
use crate::closed_loop::report::FlightReport;
use crate::commands::memory::MemoryReport;
use crate::costs::Costs;
use crate::picture::GraphData;
use crate::profile::Profile;
use crate::scenarios::Scenarios;
use crate::scoring::Report;
use crate::sweep::SweepReport;
use crate::tune::TuneReport;

const PREFACE: &str = "\
# Reports

What each command prints with `--json`. This page is written from the types of the reports, and a test keeps it
so. `a.b` is a field of a field, `a[].b` a field of each item of a list, `a.NAME` an entry of a map. A number
without a value is `null`.
";

const REPLAY: &str = "\
Everything is counted after the warm-up, except what concerns the whole replay: `counters`, `board`, `firmware`,
`digest` and the thresholds set in the chips. The same options on the same log give the same digest.";

const SWEEP: &str = "\
The sweep flies its grid on every core and prints a table for each log, and one with the medians over all scored
logs. The figure shows the same as trade curves. The table counts every deviation in quanta of one size, even
where the quantum is swept. The same sweep gives the same bytes.";

const TUNE: &str = "\
Every value is flown natively against the configuration on the same logs. A change in % is the mean of the pairs'
ratios by their logarithm. The same logs and options give the same bytes.";

const PROFILE: &str = "\
Of both, a replay and a simulated flight. Every instruction of the scored part is in one part, one function and one
task. The same options give the same bytes.";

pub(super) fn page() -> String {
    [
        PREFACE.to_owned(),
        section::<Report>("replay", REPLAY),
        section::<SweepReport>("replay --sweep", SWEEP),
        section::<TuneReport>("tune", TUNE),
        section::<FlightReport>(
            "fly",
            "The scored part begins when the drone is up and has learned.",
        ),
        section::<Findings>(
            "campaign",
            "Improvements are of pairs of flights under the same seed.",
        ),
        section::<Scenarios>("faults", "What came of every scenario."),
        section::<Costs>("bench", "Counts of the emulated core."),
        section::<MemoryReport>(
            "memory",
            "Code that is inlined counts for the part whose source it is of.",
        ),
        section::<Profile>("profile", PROFILE),
        section::<GraphData>("graph", "A control logic as a graph."),
    ]
    .join("\n")
}

fn section<T: JsonSchema>(command: &str, preface: &str) -> String {
    let settings = SchemaSettings::draft2020_12()
        .with(|settings| settings.inline_subschemas = true)
        .for_serialize();
    let schema = settings.into_generator().into_root_schema_for::<T>();
    let mut text = format!("## `cargo hil {command} --json`\n\n{preface}\n\n");
    text.push_str("| field | meaning |\n|---|---|\n");
    rows("", schema.as_value(), &mut text);
    text
}

/// The rows of an object's fields, and of what is in them.
fn rows(path: &str, schema: &Value, text: &mut String) {
    let fields = schema["properties"].as_object();
    for (name, field) in fields.into_iter().flatten() {
        let path = format!("{path}{name}");
        let meaning = field["description"].as_str().unwrap_or_default();
        let _ = writeln!(text, "| `{path}` | {} |", cell(meaning));
        below(&path, field, text);
    }
}

/// The rows below a field: of an object, of a list's items, of a map's entries.
fn below(path: &str, schema: &Value, text: &mut String) {
    rows(&format!("{path}."), schema, text);
    if schema["items"].is_object() {
        below(&format!("{path}[]"), &schema["items"], text);
    }
    if schema["additionalProperties"].is_object() {
        below(
            &format!("{path}.NAME"),
            &schema["additionalProperties"],
            text,
        );
    }
    // `anyOf` is an object or null, `oneOf` a choice of words.
    for choice in schema["anyOf"].as_array().into_iter().flatten() {
        below(path, choice, text);
    }
}
