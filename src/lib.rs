//! Reflex: autopilot firmware that runs control when the sensors call for it.
//!
//! This library is everything portable: no hardware, no clock, no allocation, no `unsafe`. From
//! the outside in:
//!
//! - [`tasks`]: what a board does around the autopilot, with the drivers of its chips
//! - [`app`]: the autopilot, the one door that firmware and hosts use
//! - [`reactive`]: triggers, models, learning, the supervisor (Bregu et al., MobiSys 2016)
//! - [`graph`] on [`dataflow`]: control logics as graphs that run only what a change reaches
//! - [`estimate`], [`control`], [`airframe`]: from samples to motor commands
//! - [`safety`]: arming and the motor gate
//! - [`link`], [`settings`], [`config`]: the world outside
//! - [`store`]: what a restart must not forget
//! - [`battery`]: how full it is; [`reset`]: what a start knows of the one before
//! - [`sensors`], [`units`], [`time`], [`math`]: the words all of them are written in
#![cfg_attr(not(test), no_std)]
#![forbid(unsafe_code)]
#![cfg_attr(
    not(test),
    deny(
        clippy::unwrap_used,
        clippy::expect_used,
        clippy::indexing_slicing,
        clippy::panic
    )
)]

// What `dataflow::graph!` generates names this library from outside.
extern crate self as reflex;

pub mod airframe;
pub mod app;
pub mod battery;
pub mod config;
pub mod control;
pub mod dataflow;
pub mod estimate;
pub mod graph;
pub mod link;
pub mod math;
mod numbered;
pub mod reactive;
pub mod reset;
pub mod safety;
pub mod sensors;
pub mod settings;
pub mod store;
pub mod tasks;
pub mod time;
pub mod units;
