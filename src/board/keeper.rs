//! The store of a board: read at the start, kept in idle.

use embedded_storage::nor_flash::NorFlash;
use reflex::app::{Autopilot, Recorder, StoreEvent};
use reflex::graph::{CONFIGURED, ControlLogic};
use reflex::store::{Content, Found, Store};
use reflex::tasks::link::{Link, Port};
use reflex::tasks::{Board, Lock, store};

use super::settings_block::{Given, choose, in_force};

/// The store, and what the start found in it.
pub struct Keeper<F> {
    store: Store<F>,
    found: Found,
}

impl<F: NorFlash> Keeper<F> {
    /// Reads it: with what the start is given, and what else was stored.
    #[inline(never)]
    pub fn start(flash: F) -> (Self, Given, Content) {
        let mut store = Store::new(flash);
        let (found, stored) = store.load();
        let (given, found) = choose(&stored.parameters, found);
        (Self { store, found }, given, stored)
    }

    /// What the start found, for the autopilot.
    pub fn found(&self) -> StoreEvent {
        StoreEvent::Found(self.found)
    }

    /// Stores what is to be stored.
    pub fn keep<P: Port, R: Recorder, L: ControlLogic>(
        &mut self,
        board: &mut impl Board,
        pilot: &mut impl Lock<Target = Autopilot<R, L>>,
        link: &mut impl Lock<Target = Link<P>>,
    ) {
        store::keep(board, pilot, link, &mut self.store, &CONFIGURED, in_force);
    }
}
