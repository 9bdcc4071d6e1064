//! Shapes of aerobatics: what a script may be made of.

use std::f64::consts::{PI, TAU};

use nalgebra::{UnitQuaternion, Vector3};
use recorded_flights::{Flight, Track};

use super::aerobatics::{Dice, Part, Turn, flight};

/// A manoeuvre, from level flight.
type Manoeuvre = fn(&mut Dice) -> Vec<Part>;

/// What the setpoint is during a flight.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Asked {
    /// The flight's own motion, smoothed: the pilot wants what happens.
    Own,
    /// Level: everything that happens is an error, up to half a turn.
    Level,
}

const SHAPES: [(&str, Manoeuvre); 11] = [
    ("flips", flip),
    ("rolls", roll),
    ("snap rolls", snap_roll),
    ("inverted hover", inverted_hover),
    ("tumbling", tumble),
    ("yaw spins", yaw_spin),
    ("split-S", split_s),
    ("through half a roll", |dice| {
        through_half_a_turn(Vector3::x(), dice)
    }),
    ("through half a flip", |dice| {
        through_half_a_turn(Vector3::y(), dice)
    }),
    ("through half a turn about a diagonal", |dice| {
        let axis = dice.normal(1.0);
        through_half_a_turn(axis / axis.norm(), dice)
    }),
    ("nose up and down", nose_up),
];

/// Every shape for some seconds behind the lead, and all of them mixed.
pub fn flights(seed: u64, length_s: f64, asked: Asked) -> Vec<Flight> {
    let single = SHAPES
        .iter()
        .map(|&(name, manoeuvre)| flight(name, seed, |dice| filled(length_s, dice, |_| manoeuvre)));
    let mixed = flight("all mixed", seed, |dice| {
        filled(length_s, dice, |dice| {
            SHAPES[dice.between(0.0, SHAPES.len() as f64) as usize].1
        })
    });
    single
        .chain([mixed])
        .map(|mut flight| {
            if asked == Asked::Level {
                flight.recorded.attitude_setpoint = Some(Track::constant([1.0, 0.0, 0.0, 0.0]));
                flight.recorded.rates_setpoint = Some(Track::constant([0.0; 3]));
            }
            flight
        })
        .collect()
}

/// Manoeuvres one after another, each from level, until they last so long.
fn filled(
    length_s: f64,
    dice: &mut Dice,
    mut next: impl FnMut(&mut Dice) -> Manoeuvre,
) -> Vec<Part> {
    let mut parts = Vec::new();
    let mut left = length_s;
    while left > 0.0 {
        let manoeuvre = next(dice);
        let mut flown = manoeuvre(dice);
        flown.push(part(Turn::To(heading(dice.between(-PI, PI))), 0.8, 1.0));
        flown.push(rest(dice.between(0.1, 0.8)));
        left -= flown.iter().map(|part| part.length_s).sum::<f64>();
        parts.extend(flown);
    }
    parts
}

fn part(turn: Turn, length_s: f64, lift: f64) -> Part {
    Part {
        turn,
        length_s,
        lift,
    }
}

fn by(axis: Vector3<f64>, angle: f64, length_s: f64, lift: f64) -> Part {
    part(Turn::By(axis * angle), length_s, lift)
}

fn rest(length_s: f64) -> Part {
    by(Vector3::x(), 0.0, length_s, 1.0)
}

fn heading(angle: f64) -> UnitQuaternion<f64> {
    UnitQuaternion::from_axis_angle(&Vector3::z_axis(), angle)
}

fn flip(dice: &mut Dice) -> Vec<Part> {
    vec![by(
        Vector3::y(),
        TAU * dice.sign(),
        dice.between(0.5, 1.5),
        dice.between(0.1, 1.5),
    )]
}

fn roll(dice: &mut Dice) -> Vec<Part> {
    vec![by(
        Vector3::x(),
        TAU * dice.sign(),
        dice.between(0.4, 1.2),
        dice.between(0.1, 1.5),
    )]
}

fn snap_roll(dice: &mut Dice) -> Vec<Part> {
    let turn = Vector3::new(
        TAU * dice.sign(),
        dice.between(-2.0, 2.0),
        dice.between(-4.0, 4.0),
    );
    vec![part(
        Turn::By(turn),
        dice.between(0.4, 0.8),
        dice.between(0.1, 1.5),
    )]
}

fn inverted_hover(dice: &mut Dice) -> Vec<Part> {
    let axis = if dice.sign() > 0.0 {
        Vector3::x()
    } else {
        Vector3::y()
    };
    vec![
        by(axis, PI * dice.sign(), dice.between(0.3, 0.8), 0.3),
        by(
            Vector3::z(),
            dice.between(-0.5, 0.5),
            dice.between(1.0, 3.0),
            -1.0,
        ),
    ]
}

fn tumble(dice: &mut Dice) -> Vec<Part> {
    (0..8)
        .map(|_| {
            part(
                Turn::By(dice.normal(1.5)),
                dice.between(0.2, 0.6),
                dice.between(0.0, 1.5),
            )
        })
        .collect()
}

fn yaw_spin(dice: &mut Dice) -> Vec<Part> {
    let lean = Vector3::new(dice.between(-0.5, 0.5), dice.between(-0.5, 0.5), 0.0);
    vec![
        part(Turn::By(lean), 0.4, 1.1),
        by(
            Vector3::z(),
            dice.sign() * dice.between(1.0, 4.0) * TAU,
            dice.between(2.0, 4.0),
            1.1,
        ),
    ]
}

fn split_s(dice: &mut Dice) -> Vec<Part> {
    vec![
        by(Vector3::x(), PI * dice.sign(), dice.between(0.3, 0.6), 0.3),
        by(Vector3::y(), PI, dice.between(0.5, 1.2), 2.0),
    ]
}

/// To half a turn, about it to and fro, and back.
fn through_half_a_turn(axis: Vector3<f64>, dice: &mut Dice) -> Vec<Part> {
    let swing = dice.between(0.1, 0.5);
    let mut parts = vec![by(axis, PI - 0.5 * swing, dice.between(0.4, 1.0), 0.3)];
    parts.extend((0..6).map(|turn| {
        let way = if turn % 2 == 0 { swing } else { -swing };
        by(axis, way, dice.between(0.15, 0.6), -1.0)
    }));
    parts
}

/// To the vertical and past it, where heading and roll have no meaning.
fn nose_up(dice: &mut Dice) -> Vec<Part> {
    let up = dice.sign() * dice.between(1.2, 1.9);
    vec![
        by(Vector3::y(), up, dice.between(0.3, 0.8), 1.2),
        by(
            Vector3::x(),
            dice.between(-2.0, 2.0),
            dice.between(0.5, 1.5),
            1.0,
        ),
        by(
            Vector3::z(),
            dice.between(-2.0, 2.0),
            dice.between(0.3, 0.8),
            0.5,
        ),
    ]
}
