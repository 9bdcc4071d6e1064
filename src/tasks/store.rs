//! The store's keeper: writes what is to be stored, behind all other tasks.

use embedded_storage::nor_flash::NorFlash;

use super::link::{Link, Port};
use super::{Board, Lock};
use crate::app::{Autopilot, Recorder, StoreEvent, Wish};
use crate::config::LIMITS;
use crate::graph::ControlLogic;
use crate::link::SigningKey;
use crate::settings::{Parameter, Start, gains::Gains};
use crate::store::{Content, Found, NotSaved, Store};

/// What is configured with the parameters that are stored; and what that means for what was found.
///
/// Parameters of another build that mean nothing here are left out; one out of its range has all refused.
#[inline(never)]
pub fn restored<G: Gains>(
    configured: &Start<G>,
    parameters: &[Parameter],
    found: Found,
) -> (Start<G>, Found) {
    match configured.with(parameters, &LIMITS) {
        Ok((start, 0)) => (start, found),
        Ok((start, _)) => (start, Found::PartlyKnown),
        Err(_) => (*configured, Found::OtherVersion),
    }
}

/// Stores what is to be stored, if anything; `in_force` is what this start was given.
///
/// While flash is erased, up to half a second for each copy, what calls this gets no further.
pub fn keep<F: NorFlash, P: Port, R: Recorder, L: ControlLogic, G: Gains>(
    board: &mut impl Board,
    pilot: &mut impl Lock<Target = Autopilot<R, L>>,
    link: &mut impl Lock<Target = Link<P>>,
    store: &mut Store<F>,
    configured: &Start<G>,
    in_force: impl FnOnce(&[Parameter]) -> Start<G>,
) {
    let taken = pilot.lock(|pilot| {
        let wish = pilot.to_store()?;
        pilot.on_store(board.now(), StoreEvent::Begun);
        Some((wish, pilot.accel_trim()))
    });
    let Some((wish, trim)) = taken else {
        return;
    };
    let key = link.lock(|link| link.key_to_store(board.now()));
    let saved = save(store, &wish, (trim, key), configured, in_force);
    let event = saved.map_or_else(StoreEvent::NotSaved, |()| StoreEvent::Saved);
    pilot.lock(|pilot| pilot.on_store(board.now(), event));
}

#[inline(never)]
fn save<F: NorFlash, G: Gains>(
    store: &mut Store<F>,
    wish: &Wish,
    (trim, key): ([f32; 3], Option<SigningKey>),
    configured: &Start<G>,
    in_force: impl FnOnce(&[Parameter]) -> Start<G>,
) -> Result<(), NotSaved> {
    let (found, mut content) = store.load();
    let mut start = match (wish.defaults, wish.settings) {
        (true, _) => *configured,
        (_, true) => in_force(&content.parameters),
        _ => restored(configured, &content.parameters, found).0,
    };
    if wish.trim || wish.settings {
        start.settings.accel_trim = trim;
    }
    content = differences(&start, configured, key)?;
    store.save(&content)
}

/// What is to be stored of a start: what no build knows.
fn differences<G: Gains>(
    start: &Start<G>,
    configured: &Start<G>,
    key: Option<SigningKey>,
) -> Result<Content, NotSaved> {
    let mut content = Content {
        key,
        ..Content::default()
    };
    let mut held = Ok(());
    start.beyond(configured, &mut |parameter| {
        held = held.and(content.set(parameter))
    });
    held.map(|()| content)
}
