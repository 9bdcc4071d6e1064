//! The statistics of the firmware, checked against an independent library.
//!
//! The firmware fits a logistic model to labels that it counts in bins, in 408 bytes an input.
//! Here the same labels, one by one and unbinned, go to the crate `linfa-logistic` (without
//! regularisation, so maximum likelihood), and thresholds are compared by what matters: the
//! probability that the library's model gives to the firmware's `x*`. On made-up data whose
//! coefficients are known, and on all labels of the recorded flights.

mod comparison;
mod figures;
mod maximum_likelihood;
mod recorded;
mod synthetic;
mod tap;
