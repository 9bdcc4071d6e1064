//! Control logics as dataflow graphs, a file each.

mod cascade;

pub use cascade::{Cascade, Node};
