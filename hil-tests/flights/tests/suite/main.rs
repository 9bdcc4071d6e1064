//! Tests of the flights as a whole; what they share is here too.

mod csv_logs;
mod dialects;
mod peers;
mod recordings;
mod replay;
mod samples;
mod setpoints;
mod sightings;
mod spoilt;
mod ulog_bytes;
mod ulogs;
