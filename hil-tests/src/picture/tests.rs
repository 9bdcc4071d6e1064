//! Pictures hold what the graph says, of a small one to the letter.
//!
//! `REFLEX_BLESS=1 cargo test -p hil-tests --profile hil --ignore-rust-version picture` rewrites
//! `picture/small.dot` and `docs/figures/graph_*.svg`.

use crate::json::to_json;
use std::path::Path;

use clap::ValueEnum;
use quick_xml::Reader;
use quick_xml::events::Event;
use reflex::dataflow::{Description, graph};
use reflex::graph::ControlLogic;

use super::*;
use crate::logics::LogicName;

#[expect(dead_code, reason = "the graph is drawn, never run")]
fn smoothed(level: f32, sample: f32, given: f32) -> f32 {
    level + 0.5 * (sample - level).min(given)
}

fn lowest(wanted: Option<f32>, level: f32) -> f32 {
    wanted.map_or(level, |wanted| wanted.min(level))
}

graph! {
    /// A "limit" that follows a sensor.
    struct Small;

    /// What is measured.
    input sample: f32, at 1000 Hz, gates, triggers;
    /// What is asked for.
    input wanted: Option<f32>, at 0.5 Hz, joins;
    /// The level without noise & steps.
    state level: f32 = smoothed(level, sample, last given), clocked by sample;
    /// What is given.
    output given: f32 = lowest(wanted, level), quantum 0.1;
}

fn every_logic() -> impl Iterator<Item = (&'static str, Description)> {
    let names = LogicName::value_variants().iter();
    names.map(|name| (name.word(), name.logic().description()))
}

/// Compares a file of the repository with what it should hold, or rewrites it.
fn agree(file: &str, now: &str) {
    let file = Path::new(env!("CARGO_MANIFEST_DIR")).join(file);
    if std::env::var_os("REFLEX_BLESS").is_some_and(|flag| flag == "1") {
        std::fs::write(&file, now).expect("the folder is writable");
        return;
    }
    let was = std::fs::read_to_string(&file).unwrap_or_default();
    let name = file.display();
    assert!(
        was == now,
        "{name} differs: look at it, then REFLEX_BLESS=1"
    );
}

/// Every text and the count of every element of well-formed XML.
fn read(svg: &str) -> (Vec<String>, impl Fn(&str) -> usize + use<>) {
    let mut reader = Reader::from_str(svg);
    let (mut texts, mut elements) = (Vec::new(), Vec::new());
    let mut text = String::new();
    loop {
        match reader.read_event().expect("well-formed") {
            Event::Start(start) | Event::Empty(start) => {
                assert!(start.attributes().all(|attribute| attribute.is_ok()));
                elements.push(String::from_utf8_lossy(start.name().as_ref()).into_owned());
                text.clear();
            }
            Event::Text(part) => text += &part.decode().expect("UTF-8"),
            Event::GeneralRef(name) => text += &format!("&{};", name.decode().expect("UTF-8")),
            Event::End(_) => texts.push(std::mem::take(&mut text)),
            Event::Eof => break,
            _ => {}
        }
    }
    let count = move |name: &str| elements.iter().filter(|element| *element == name).count();
    (texts, count)
}

#[test]
fn the_dot_of_a_small_graph_is_the_recorded_one() {
    agree("src/picture/small.dot", &dot(&Small::DESCRIPTION));
}

#[test]
fn the_figures_of_the_logics_are_the_recorded_ones() {
    for (name, graph) in every_logic() {
        agree(&format!("../docs/figures/graph_{name}.svg"), &svg(&graph));
    }
}

#[test]
fn every_logic_is_drawn_with_all_its_values_and_reads() {
    for (name, graph) in every_logic() {
        let data = GraphData::of(&graph);
        let (texts, count) = read(&svg(&graph));
        for value in &data.values {
            assert!(
                texts.iter().any(|text| text == value.name),
                "{name}: {}",
                value.name
            );
        }
        // The background is a box, the arrows' head a path.
        assert_eq!(count("rect"), data.values.len() + 1, "{name}");
        let reads: usize = data.values.iter().map(|value| value.reads.len()).sum();
        let clocks = data
            .values
            .iter()
            .filter(|value| value.clock.is_some())
            .count();
        assert_eq!(count("path"), reads + clocks + 1, "{name}");
    }
}

#[test]
fn the_same_graph_is_drawn_by_the_same_bytes() {
    for (_, graph) in every_logic() {
        assert_eq!(svg(&graph), svg(&graph));
        assert_eq!(dot(&graph), dot(&graph));
    }
}

#[test]
fn signs_of_markup_are_escaped() {
    let (texts, _) = read(&svg(&Small::DESCRIPTION));
    assert!(texts.iter().any(|text| text == "Option&lt;f32&gt;"));
    assert!(
        texts
            .iter()
            .any(|text| text == "The level without noise &amp; steps.")
    );
}

#[test]
fn data_says_what_each_value_is() {
    let json = to_json(&GraphData::of(&Small::DESCRIPTION)).expect("numbers");
    let json: serde_json::Value = serde_json::from_str(&json).expect("JSON");
    assert_eq!(json["hyperperiod_us"], 1000);
    let expected = serde_json::json!({
        "name": "level", "doc": "The level without noise & steps.", "type": "f32",
        "kind": "state", "function": "smoothed", "clock": "sample", "quantum": null,
        "reads": [
            {"name": "level", "last": true},
            {"name": "sample", "last": false},
            {"name": "given", "last": true}
        ],
        "most_updates_hz": 1000.0, "gates": null, "triggers": null
    });
    assert_eq!(json["values"][2], expected);
    assert_eq!(json["values"][1]["triggers"], false);
    assert_eq!(json["values"][3]["kind"], "output");
}
