//! Whether the firmware is alive and the part content with it.

use std::ops::Range;
use std::sync::Arc;

use rigless::device::{ResetCause, Told};
use rigless::emulator::Access;
use rigless::session::Session;

use super::batch::{Batch, Event};
use super::part::{Part, Rig};
use super::syscfg::UNCLOCKED;
use super::wiring;
use crate::{Elf, FaultKind, Options};

/// Where no memory and no register is: a bus error on silicon.
pub(super) const HOLES: [Range<u64>; 6] = [
    0x0820_0000..0x1000_0000,
    0x1001_0000..0x1FFE_C000,
    0x1FFF_C010..0x2000_0000,
    0x2003_0000..0x2200_0000,
    0x2400_0000..0x4000_0000,
    0x6000_0000..0xE000_0000,
];
/// How long after its first motor pulse the firmware may still configure pins.
const WIRING_GRACE_NS: u64 = 300_000_000;
/// Polls in a row that must find a wire wrong: while the firmware frees a hung bus, it takes the pins
/// from the peripheral for a moment.
const WIRING_LOOKS: u32 = 20;

/// What the last polls have shown.
pub(super) struct Health {
    elf: Arc<Elf>,
    boot_limit_ns: u64,
    silence_limit_ns: u64,
    flies: bool,
    /// Set by an arrival at a fatal handler.
    condemned: Option<FaultKind>,
    /// Address and program counter of the first access to a hole.
    bus_error: Option<(u64, u64)>,
    started_ns: Option<u64>,
    active_ns: u64,
    driven: u8,
    /// The motors with which the wiring was found right.
    right_with: Option<u8>,
    wrong_looks: u32,
}

impl Health {
    /// The health of a firmware that has not started yet.
    pub(super) fn new(elf: Arc<Elf>, options: &Options) -> Self {
        Self {
            elf,
            boot_limit_ns: options.boot_limit_ns,
            silence_limit_ns: options.silence_limit_ns,
            flies: options.flies,
            condemned: None,
            bus_error: None,
            started_ns: None,
            active_ns: 0,
            driven: 0,
            right_with: None,
            wrong_looks: 0,
        }
    }

    /// The core has arrived where it must not.
    pub(super) fn condemn(&mut self, fault: FaultKind) {
        let fault = match (fault, self.bus_error) {
            (FaultKind::HardFault { .. }, Some((address, pc))) => {
                let code = self.elf.place(pc);
                let detail = format!("no memory at {address:#010x}, accessed by {code}");
                FaultKind::HardFault {
                    detail: Some(detail),
                }
            }
            (fault, _) => fault,
        };
        self.condemned.get_or_insert(fault);
    }

    /// Remembers the first access to a hole, which the core takes as an error.
    pub(super) fn note_access(&mut self, access: Access) {
        let Some(pc) = access.program_counter else {
            return;
        };
        if HOLES.iter().any(|hole| hole.contains(&access.address)) {
            self.bus_error.get_or_insert((access.address, pc));
        }
    }

    /// The gravest thing wrong at this poll, if any.
    pub(super) fn check(&mut self, session: &Session<Rig>, batch: &Batch) -> Option<FaultKind> {
        let part = &session.board().part;
        self.note_activity(part, batch);
        self.condemned
            .take()
            .or_else(|| reset(session))
            .or_else(|| self.bad_access(session))
            .or_else(|| session.told().next().map(fault_of))
            .or_else(|| self.miswired(part, batch.at_ns))
            .or_else(|| self.lifeless(batch.at_ns))
    }

    /// The wiring, for runs that end before it was found right.
    pub(super) fn last_check(&mut self, part: &Part) -> Option<FaultKind> {
        self.wrong_looks = WIRING_LOOKS;
        self.miswired(part, u64::MAX)
    }

    fn note_activity(&mut self, part: &Part, batch: &Batch) {
        self.driven |= part.driven();
        let flies = |event: &Event| matches!(event, Event::Motors(_));
        if !batch.calls.is_empty() || batch.events.iter().any(flies) {
            self.active_ns = batch.at_ns;
        }
        if self.driven != 0 && self.started_ns.is_none() {
            self.started_ns = Some(batch.at_ns);
            self.active_ns = batch.at_ns;
        }
    }

    fn bad_access(&self, session: &Session<Rig>) -> Option<FaultKind> {
        if let Some(access) = session.unmapped().first() {
            return Some(FaultKind::UnmappedAccess {
                address: access.address,
                code: self.elf.place(access.program_counter),
            });
        }
        let (&address, reason) = session.refused().first_key_value()?;
        let reason = reason.to_string();
        Some(FaultKind::RefusedAccess { address, reason })
    }

    fn lifeless(&self, now_ns: u64) -> Option<FaultKind> {
        if !self.flies {
            return None;
        }
        if self.started_ns.is_none() {
            let limit_ns = self.boot_limit_ns;
            return (now_ns > limit_ns).then_some(FaultKind::NeverStarted { limit_ns });
        }
        let limit_ns = self.silence_limit_ns;
        (now_ns - self.active_ns > limit_ns).then_some(FaultKind::Silent { limit_ns })
    }

    fn miswired(&mut self, part: &Part, now_ns: u64) -> Option<FaultKind> {
        let due = self.started_ns? + WIRING_GRACE_NS;
        if self.right_with == Some(self.driven) || now_ns < due {
            return None;
        }
        let problems = wiring::problems(part, self.driven);
        if problems.is_empty() {
            self.right_with = Some(self.driven);
            self.wrong_looks = 0;
            return None;
        }
        self.wrong_looks += 1;
        (self.wrong_looks > WIRING_LOOKS).then_some(FaultKind::Wiring(problems))
    }
}

fn reset(session: &Session<Rig>) -> Option<FaultKind> {
    Some(match session.resets().first()?.cause {
        ResetCause::Model("IWDG") => FaultKind::WatchdogReset,
        ResetCause::Model(instance) => FaultKind::Reset(format!("asked for by {instance}")),
        ResetCause::Core => FaultKind::Reset("asked for by the firmware".into()),
        cause => FaultKind::Reset(format!("{cause:?}")),
    })
}

fn fault_of(told: &Told) -> FaultKind {
    let Told {
        instance,
        register,
        reason,
        ..
    } = told;
    let message = format!("{instance}.{register} {reason}");
    match *instance {
        "SYSCFG" if *reason == UNCLOCKED => FaultKind::Wiring(vec![message]),
        "TIM3" | "TIM4" => FaultKind::NotModelled(message),
        _ => FaultKind::Forbidden(message),
    }
}
