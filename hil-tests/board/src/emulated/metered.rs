//! The emulated core with a meter of what it executes.

use rigless::emulator::{CoreBus, DataModel, Error, Exit, Processor, Queued};
use rigless::soc::{Endian, Width};
use rigless::time::VirtualNanos;

use super::meter::SharedMeter;

/// A core with a meter. No debugger is ever attached and no snapshot resumed, so what only they
/// ask for is left out.
#[derive(Debug)]
pub(super) struct MeteredCore {
    core: Box<dyn Processor>,
    meter: SharedMeter,
}

impl MeteredCore {
    pub(super) fn new(core: Box<dyn Processor>, meter: SharedMeter) -> Self {
        Self { core, meter }
    }
}

/// Methods that the core answers itself.
macro_rules! by_core {
    ($(fn $name:ident(&self $(, $argument:ident: $kind:ty)*) $(-> $answer:ty)?;)*) => {
        $(fn $name(&self $(, $argument: $kind)*) $(-> $answer)? {
            self.core.$name($($argument),*)
        })*
    };
    ($(fn $name:ident(&mut self $(, $argument:ident: $kind:ty)*) $(-> $answer:ty)?;)*) => {
        $(fn $name(&mut self $(, $argument: $kind)*) $(-> $answer)? {
            self.core.$name($($argument),*)
        })*
    };
}

impl Processor for MeteredCore {
    fn run(&mut self, budget: u32, bus: &mut dyn CoreBus) -> (Exit, u64) {
        match &mut *self.meter.meter() {
            Some(meter) => meter.run(&mut *self.core, budget, bus),
            None => self.core.run(budget, bus),
        }
    }

    by_core! {
        fn retired(&self) -> u64;
        fn maps(&self, start: u64, length: u64) -> bool;
        fn page_size(&self) -> u64;
        fn next_event(&self) -> Option<VirtualNanos>;
        fn waiting(&self) -> bool;
        fn pc(&self) -> u64;
        fn gdb_register(&self, number: usize) -> Option<Vec<u8>>;
        fn data_model(&self) -> DataModel;
        fn byte_order(&self, address: u64) -> Endian;
        fn own_ranges(&self) -> Vec<std::ops::Range<u64>>;
        fn save(&self) -> Vec<u8>;
    }

    by_core! {
        fn ask(&mut self, queued: Queued);
        fn boot(&mut self, table: u64, read: &dyn Fn(u64, Width) -> Option<u64>);
        fn reset(&mut self);
        fn take_reset_request(&mut self) -> bool;
        fn on_event(&mut self, now: VirtualNanos);
        fn add_breakpoint(&mut self, address: u64) -> bool;
        fn remove_breakpoint(&mut self, address: u64);
        fn pass_breakpoint(&mut self, address: u64);
        fn check_reads(&mut self, every: bool);
        fn check_words(&mut self, words: &[u64]);
        fn answer_host_call(&mut self, answer: Option<u64>);
        fn load(&mut self, bytes: &[u8]) -> Result<(), Error>;
    }

    #[expect(unsafe_code, reason = "the emulator maps memory by pointer")]
    unsafe fn map(&mut self, start: u64, length: u64, host: *mut u8, writable: bool) {
        // SAFETY: the caller's promise is the one that the core asks for, and goes on to it.
        unsafe { self.core.map(start, length, host, writable) };
    }
}
