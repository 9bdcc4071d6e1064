//! What is declared holds together, and the page of flight logs tells all of it.

use std::collections::HashSet;
use std::path::Path;

use reflex::reactive::Reason;
use reflex::sensors::Cause;

use super::topics::{Field, Kind, Topic};
use super::{FlightLog, attitude_row, protobuf};

#[test]
fn names_are_told_apart_and_rows_are_as_long_as_their_fields() {
    for name in [Topic::name, Topic::ulog] {
        let names: HashSet<&str> = Topic::ALL.into_iter().map(name).collect();
        assert_eq!(names.len(), Topic::ALL.len());
    }
    for topic in Topic::ALL {
        let fields = topic.fields();
        let names: HashSet<&str> = fields.iter().map(|field| &*field.name).collect();
        assert_eq!(names.len(), fields.len(), "{topic:?}");
        let names: HashSet<&str> = fields.iter().map(Field::ulog).collect();
        assert_eq!(names.len(), fields.len(), "{topic:?}");
    }
}

#[test]
fn a_choice_has_the_number_that_the_firmware_gives_it() {
    let field = |topic: Topic, name: &str| {
        let fields = topic.fields().into_iter();
        fields
            .filter(|field| field.name == name)
            .map(|field| field.kind)
            .next()
    };
    let Some(Kind::Choice(reasons)) = field(Topic::Decision, "reason") else {
        panic!("a reason is a choice");
    };
    assert_eq!(reasons[usize::from(Reason::Failsafe.number())], "Failsafe");
    let Some(Kind::Choice(causes)) = field(Topic::Magnetometer, "cause") else {
        panic!("a cause is a choice");
    };
    assert_eq!(causes[Cause::Rearm as usize], "Rearm");
}

/// As <https://protobuf.dev/programming-guides/encoding/> has it.
#[test]
fn a_row_is_encoded_by_the_book() {
    let kinds = [Kind::Number, Kind::Flag, Kind::Vector, Kind::Motors];
    let mut numbers = vec![1.5, 1.0, 0.0, 2.0, -2.0];
    numbers.extend([0.5; 2]);
    numbers.extend([f32::NAN; 10]);
    let mut expected = vec![0x0D, 0, 0, 0xC0, 0x3F, 0x10, 1];
    expected.extend([0x1A, 15, 0x0D, 0, 0, 0, 0, 0x15, 0, 0, 0, 0x40]);
    expected.extend([0x1D, 0, 0, 0, 0xC0]);
    expected.extend([0x22, 8, 0, 0, 0, 0x3F, 0, 0, 0, 0x3F]);
    assert_eq!(protobuf::row(&kinds, &numbers), expected);
    let long = "x".repeat(300);
    assert_eq!(protobuf::line(&long)[..3], [0x0A, 0xAC, 0x02]);
}

#[test]
fn a_quarter_turn_to_the_right_is_a_yaw_of_half_pi() {
    let half = std::f32::consts::FRAC_1_SQRT_2;
    let row = attitude_row([half, 0.0, 0.0, half]);
    assert_eq!(row[..4], [half, 0.0, 0.0, half]);
    assert!(
        (row[6] - std::f32::consts::FRAC_PI_2).abs() < 1e-6,
        "{row:?}"
    );
}

#[test]
fn another_extension_is_refused_with_those_that_are_known() {
    for name in ["flight", "flight.csv", "mcap", ".ulg", "a.mcap.gz"] {
        let refusal = FlightLog::check(Path::new(name)).expect_err(name);
        let expected = format!("--record {name}: must end in .mcap or .ulg");
        assert_eq!(refusal.to_string(), expected);
    }
}

#[test]
fn the_page_tells_every_topic_with_its_fields() {
    let page = concat!(env!("CARGO_MANIFEST_DIR"), "/../docs/records.md");
    let page = std::fs::read_to_string(page).expect("a page");
    for topic in Topic::ALL {
        let row = row(topic);
        assert!(
            page.contains(&row),
            "docs/records.md lacks this row:\n{row}"
        );
    }
}

/// A topic as a row of the page.
fn row(topic: Topic) -> String {
    let (name, ulog) = (topic.name(), topic.ulog());
    let fields: Vec<String> = topic.fields().iter().map(told).collect();
    // Inputs are many, and alike.
    let fields = match topic {
        Topic::Decision => format!("{}, and for each input {}", fields[..2].join(", "), {
            "`INPUT_asked`, `INPUT_change`, `INPUT_probability`, `INPUT_threshold`"
        }),
        _ => fields.join(", "),
    };
    format!("| `{name}` | `{ulog}` | {fields} | {} |", topic.meaning())
}

fn told(field: &Field) -> String {
    let name = match field.px4 {
        Some(px4) => format!("`{}` (`{px4}`)", field.name),
        None => format!("`{}`", field.name),
    };
    match field.unit {
        "" => name,
        unit => format!("{name} {unit}"),
    }
}
