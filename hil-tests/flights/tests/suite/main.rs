//! Tests of the flights as a whole; what they share is here too.

mod csv_logs;
mod recordings;
mod replay;
mod samples;
mod setpoints;
mod sightings;
mod ulog_bytes;
mod ulogs;
