//! What a ULog says of its vehicle, and of when it was armed and on the ground.

use std::collections::HashMap;

use super::super::super::recording::Vehicle;
use super::super::super::track::Track;
use super::table::{Stamp, Table, finite};

/// What the vehicle is.
pub(super) fn of(texts: &HashMap<String, String>, status: Option<&Table>) -> Vehicle {
    let names = ["sys_name", "ver_hw", "ver_sw_release_str", "ver_sw"];
    let known = names.iter().filter_map(|name| texts.get(*name));
    // A commit's name is longer than anybody reads.
    let known = known.map(|text| text.chars().take(16).collect::<String>());
    let mut known: Vec<String> = known.filter(|text| !text.is_empty()).collect();
    known.dedup();
    Vehicle {
        description: known.join(" "),
        other: status.and_then(kind).map(str::to_owned),
    }
}

/// What a vehicle is that is no multirotor, by its status.
fn kind(status: &Table) -> Option<&'static str> {
    // As PX4's message counts them; older logs only say whether wings turn.
    const KINDS: [Option<&str>; 5] = [
        None,
        None,
        Some("a fixed wing"),
        Some("a rover"),
        Some("an airship"),
    ];
    let last = status.rows().last()?.1;
    let is = |name: &str| {
        status
            .column(name)
            .is_some_and(|column| last.get(column) != 0.0)
    };
    if is("is_vtol") {
        return Some("a VTOL");
    }
    match status.column("vehicle_type") {
        Some(column) => KINDS.get(last.get(column) as usize).copied().flatten(),
        None => {
            let wings = status.column("is_rotary_wing").is_some() && !is("is_rotary_wing");
            wings.then_some("a fixed wing")
        }
    }
}

/// 1 while motors were armed.
pub(super) fn armed(status: Option<&Table>, actuators: Option<&Table>) -> Option<Track<1>> {
    const ARMED: f64 = 2.0;
    let states = status.and_then(|table| {
        let column = table.column("arming_state")?;
        finite(table, Stamp::Message, |row| {
            Some([f64::from(u8::from(row.get(column) == ARMED))])
        })
    });
    states.or_else(|| {
        let table = actuators?;
        let column = table.column("armed")?;
        finite(table, Stamp::Message, |row| Some([row.get(column)]))
    })
}

/// 1 while the drone stood on the ground.
pub(super) fn landed(detector: Option<&Table>) -> Option<Track<1>> {
    let table = detector?;
    let column = table.column("landed")?;
    finite(table, Stamp::Message, |row| Some([row.get(column)]))
}
