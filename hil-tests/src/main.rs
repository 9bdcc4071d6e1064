//! The program behind `cargo hil`.

use std::process::ExitCode;

fn main() -> ExitCode {
    hil_tests::commands::run(std::env::args_os())
}
