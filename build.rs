//! Turns `config/` into constants, and gives the linker the chip's memory map.

use std::path::{Path, PathBuf};
use std::{env, fs};

fn main() {
    println!("cargo::rerun-if-changed=build.rs");
    if let Err(message) = run() {
        println!("cargo::error={message}");
    }
}

fn run() -> Result<(), String> {
    let output = PathBuf::from(env::var("OUT_DIR").map_err(|error| error.to_string())?);
    constants(&output)?;
    if env::var("CARGO_CFG_TARGET_OS").as_deref() == Ok("none") {
        memory_map(&output)?;
    }
    Ok(())
}

/// Writes what `src/config.rs` includes. Wrong configuration is one line with file and key.
fn constants(output: &Path) -> Result<(), String> {
    println!("cargo::rerun-if-changed=config");
    let variable = |name: &str| {
        println!("cargo::rerun-if-env-changed={name}");
        env::var(name).ok()
    };
    let configuration = reflex_config::load_chosen(Path::new("config"), variable)
        .map_err(|error| error.to_string())?;
    println!("cargo::rustc-check-cfg=cfg(logic, values(any()))");
    println!("cargo::rustc-cfg=logic={:?}", configuration.selection.logic);
    println!("cargo::rustc-check-cfg=cfg(board, values(any()))");
    println!("cargo::rustc-cfg=board={:?}", configuration.selection.board);
    write(
        &output.join("config.rs"),
        configuration.to_rust().as_bytes(),
    )
}

/// `link.x` of cortex-m-rt includes `memory.x` from the linker's search path.
fn memory_map(output: &Path) -> Result<(), String> {
    println!("cargo::rerun-if-changed=memory.x");
    let map = fs::read("memory.x").map_err(|error| format!("memory.x: {error}"))?;
    write(&output.join("memory.x"), &map)?;
    println!("cargo::rustc-link-search={}", output.display());
    Ok(())
}

fn write(file: &Path, content: &[u8]) -> Result<(), String> {
    fs::write(file, content).map_err(|error| format!("{}: {error}", file.display()))
}
