//! The one list of control logics.

/// Hands the list to a macro: `control_logics!(MACRO)` is `MACRO! { LIST }`.
///
/// An entry is `MODULE: NAME, TYPE;` with a line of documentation. `MODULE` names the page
/// `src/graph/MODULE.rs` and the gains `settings/src/gains/MODULE.rs`; `NAME` is what
/// `config/selection.toml` and the command line call it, and its file `config/logics/NAME.toml`.
#[macro_export]
macro_rules! control_logics {
    ($then:ident) => {
        $then! {
            /// Reflex's own.
            cascade: "cascade", Cascade;
            /// After ArduCopter.
            arducopter: "arducopter", ArduCopter;
            /// After Cleanflight.
            cleanflight: "cleanflight", Cleanflight;
            /// After OpenPilot.
            openpilot: "openpilot", OpenPilot;
            /// Reflex's own, with a disturbance observer.
            observer: "observer", Observer;
        }
    };
}
