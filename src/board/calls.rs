//! The call log's place in memory: the symbol `REFLEX_CALLS`, which hosts read.
//!
//! A reduced build records no calls.

#[cfg(feature = "reduced")]
mod place {
    /// Records nothing.
    pub type Calls = ();

    /// What records nothing.
    pub fn take() -> Option<Calls> {
        Some(())
    }
}

#[cfg(not(feature = "reduced"))]
mod place {
    use core::cell::UnsafeCell;
    use core::sync::atomic::{AtomicBool, Ordering};

    use reflex::app::CallRing;

    /// The ring that calls go to.
    pub type Calls = &'static mut CallRing;

    /// Storage that is handed out once.
    #[repr(transparent)]
    struct Storage(UnsafeCell<CallRing>);

    // SAFETY: `take` hands out the only reference, once.
    unsafe impl Sync for Storage {}

    /// Nobody in the firmware reads it back: `used` keeps the stores.
    #[used]
    #[unsafe(export_name = "REFLEX_CALLS")]
    static CALLS: Storage = Storage(UnsafeCell::new(CallRing::new()));

    /// The ring, at the first call; `None` ever after.
    pub fn take() -> Option<Calls> {
        static TAKEN: AtomicBool = AtomicBool::new(false);
        if TAKEN.swap(true, Ordering::Relaxed) {
            return None;
        }
        // SAFETY: this line is reached once, so the reference is unique.
        Some(unsafe { &mut *CALLS.0.get() })
    }
}

pub use place::{Calls, take};
