//! What waits to be stored, and whether what was stored is in force.
//!
//! The store itself is a task's: it asks, and reports. Nothing is written while motors may turn, and
//! none may while something is written.

use crate::link::Notice;
use crate::link::Severity::{Error, Info, Warning};
use crate::store::{Found, NotSaved};

/// What is to be stored; more than one at once.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Wish {
    /// The accelerometer's trim.
    pub trim: bool,
    /// Every setting in force.
    pub settings: bool,
    /// That no setting differs from the configuration.
    pub defaults: bool,
    /// The signing key with its stamp.
    pub key: bool,
    /// What is stored already, again: one copy is not sound.
    pub mend: bool,
}

/// What the task of the store reports.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[cfg_attr(target_os = "none", derive(defmt::Format))]
pub enum StoreEvent {
    /// What the start found.
    Found(Found),
    /// The signing key or its stamp is newer than the one that is stored.
    KeyDue,
    /// What was to be stored is being written.
    Begun,
    /// It is written.
    Saved,
    /// It is not.
    NotSaved(NotSaved),
}

/// What the autopilot knows of the store.
#[derive(Clone, Copy, Debug, Default)]
pub(super) struct Storage {
    wish: Wish,
    busy: bool,
    lost: bool,
}

impl Storage {
    /// What the pilot is told of an event, if anything.
    pub(super) fn take(&mut self, event: StoreEvent) -> Option<Notice> {
        match event {
            StoreEvent::Found(found) => {
                self.lost = found.is_loss();
                self.wish.mend = found == Found::OneCopy;
                return found_notice(found);
            }
            StoreEvent::KeyDue => {
                self.wish.key = true;
                return None;
            }
            StoreEvent::Begun => {
                self.wish = Wish::default();
                self.busy = true;
                return None;
            }
            StoreEvent::Saved | StoreEvent::NotSaved(_) => self.busy = false,
        }
        let (severity, why) = match event {
            StoreEvent::NotSaved(NotSaved::NoRoom) => (Error, "not stored: too many differ"),
            StoreEvent::NotSaved(NotSaved::Flash) => (Error, "not stored: flash failed"),
            _ => (Info, "stored"),
        };
        Some(Notice::new(severity, "settings", why))
    }

    /// Something more is to be stored.
    pub(super) fn wish(&mut self) -> &mut Wish {
        &mut self.wish
    }

    /// What is to be stored, where something is.
    pub(super) fn due(&self) -> Option<Wish> {
        let due = !self.busy && self.wish != Wish::default();
        due.then_some(self.wish)
    }

    /// True while something is written.
    pub(super) fn is_busy(&self) -> bool {
        self.busy
    }

    /// True where something that was stored is not in force, and the pilot did not say that he knows.
    pub(super) fn is_lost(&self) -> bool {
        self.lost
    }

    /// The pilot knows what is not in force.
    pub(super) fn acknowledge(&mut self) {
        self.lost = false;
    }
}

fn found_notice(found: Found) -> Option<Notice> {
    let (severity, why) = match found {
        Found::Empty | Found::Sound => return None,
        Found::OneCopy => (Warning, "one copy damaged, the other used"),
        Found::OtherVersion => (Error, "of another version, defaults used"),
        Found::PartlyKnown => (Error, "some unknown, others used"),
        Found::Damaged => (Error, "store damaged, defaults used"),
    };
    Some(Notice::new(severity, "settings", why))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn what_is_told_fits_into_one_message() {
        for found in Found::ALL {
            let line = found_notice(found).map_or(0, |notice| notice.line().count());
            assert!(line <= Notice::LONGEST, "{found:?}");
        }
    }

    #[test]
    fn wishes_add_up_until_the_task_takes_them_and_wait_while_it_writes() {
        let mut storage = Storage::default();
        assert_eq!(storage.due(), None);
        storage.wish().trim = true;
        assert_eq!(storage.take(StoreEvent::KeyDue), None);
        let both = Wish {
            trim: true,
            key: true,
            ..Wish::default()
        };
        assert_eq!(storage.due(), Some(both));
        storage.take(StoreEvent::Begun);
        storage.wish().settings = true;
        assert!(storage.is_busy() && storage.due().is_none());
        assert!(storage.take(StoreEvent::Saved).is_some());
        assert_eq!(
            storage.due(),
            Some(Wish {
                settings: true,
                ..Wish::default()
            })
        );
    }
}
