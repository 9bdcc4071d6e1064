//! Reactive dataflow: graphs that recompute only what a change reaches.
//!
//! Knows nothing of flight. [`graph!`] turns a declaration into a plain struct and straight-line
//! code: no heap, no pointers, no dynamic dispatch, dirty marks in one word. A value is recomputed
//! when one that it reads changed, and propagation stops where a value did not change. It is what
//! the paper's RP-Embedded does (Bregu et al., MobiSys 2016, section 6) with vectors of pointers.
//!
//! ```
//! use reflex::dataflow::graph;
//!
//! fn smoothed(level: &f32, sample: f32) -> f32 {
//!     level + 0.5 * (sample - level)
//! }
//!
//! graph! {
//!     /// A limit that follows a sensor.
//!     pub struct Limiter;
//!
//!     /// What is measured.
//!     input sample: f32, at 1000 Hz, gates, triggers;
//!     /// What is asked for.
//!     input wanted: f32, at 50 Hz, joins, starting 1.0;
//!     /// The sensor's level without its noise.
//!     state level: f32 = smoothed(&level, sample), clocked by sample;
//!     /// What is given; it moves in steps of a tenth.
//!     output given: f32 = wanted.min(level), quantum 0.1;
//! }
//!
//! let mut limiter = Limiter::new();
//! limiter.set_sample(0.5);
//! assert_eq!(limiter.foresee_given(), 0.25);
//! let changed = limiter.propagate();
//! assert!(changed.all(Limiter::LEVEL.or(Limiter::GIVEN)));
//! assert_eq!(*limiter.given(), 0.25);
//!
//! limiter.set_wanted(0.3);
//! assert!(!limiter.propagate().any(Limiter::GIVEN), "the lower one is the same");
//! ```
//!
//! # Lines
//! | line | is | clauses |
//! |---|---|---|
//! | `param NAME: TYPE` | given at the start, and set between runs: it asks for no run, and counts from the next one on | |
//! | `param NAME: TYPE = EXPRESSION` | made of other parameters, at the start and whenever one is set | |
//! | `input NAME: TYPE` | set from outside | `at NUMBER Hz` or `every PERIOD`, whose `ticks()` are us: the largest rate; `gates`, `gates if CONSTANT`: its period enters the hyperperiod; `triggers`: it may ask for a run; `joins`: neither |
//! | `state NAME: TYPE = EXPRESSION` | remembers; reads its own old value by its name | `clocked by INPUT`: advances exactly when that is set |
//! | `node NAME: TYPE = EXPRESSION` | computed from others | |
//! | `output NAME: TYPE = EXPRESSION` | a node that the world outside reads | |
//!
//! An expression is Rust: calls, methods, operators, literals of structs. A name that begins with a
//! small letter and is no name of its own is a value of the graph: `NAME` a copy, `&NAME` a
//! reference, and in a state also `last NAME` and `&last NAME` the value from before the run. It
//! must remember nothing. `quantum SIZE` lets a computed value tell others only of changes of that
//! size ([`Distance`]): what is stored is the value last told. `starting VALUE` is an input or a
//! state before anything came in, else `Default`. The order of lines does not matter.
//!
//! # What the compiler checks
//! Names, cycles, clocks, values that reach no output, and that the hyperperiod, the least common
//! multiple of the periods of all inputs that gate, is at most [`LONGEST_HYPERPERIOD`].
//!
//! # What is generated
//! `new`, which takes the parameters, `set_NAME` for parameters, inputs and states, `NAME` to read
//! any value, `propagate`, `foresee_NAME` for outputs, and the constants `NAME` (marks),
//! `HYPERPERIOD`, `STORED_BYTES`, `DESCRIPTION`. Where every input was set to something new,
//! `propagate` compares nothing.

mod description;
mod dirty;
mod distance;
mod rates;

pub use description::{Described, Description, Kind, Read, Source};
pub use dirty::Dirty;
pub use distance::Distance;
pub use rates::{LONGEST_HYPERPERIOD, joint_period, most_updates};
pub use reflex_dataflow_macros::graph;
