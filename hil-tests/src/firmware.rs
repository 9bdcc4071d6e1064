//! The firmware's ELF: built as it is flashed, found, and measured.

use std::fs;
use std::path::PathBuf;
use std::process::Command;

use anyhow::{Context, Result, bail};
use cargo_metadata::Message;
use object::LittleEndian as LE;
use object::elf::{FileHeader32, PT_LOAD, SHF_ALLOC, SHT_NOTE};
use object::read::elf::{ElfFile32, FileHeader, ProgramHeader, SectionHeader};

use crate::logics::LogicName;
use crate::progress::Progress;
use crate::toolchain::{self, TARGET};

/// Name of the firmware's package and of its binary.
const NAME: &str = "reflex";
/// Package and binary of the program that runs parts of the firmware one by one.
const PARTS: (&str, &str) = ("reflex-bench", "parts");
/// Package and binary of the program that runs every control logic in every way.
const LOGICS: (&str, &str) = ("reflex-bench", "logics");
/// Package and binary of the program that compares two ways over whole flights.
const FLIGHTS: (&str, &str) = ("reflex-bench", "flights");
/// The feature, and the profile, of a build for a small board.
const REDUCED: &str = "reduced";
/// Bytes of its log's buffer.
const REDUCED_LOG: u32 = 256;
/// Where flash begins and ends on an STM32F427.
const FLASH: std::ops::Range<u32> = 0x0800_0000..0x0820_0000;

/// A linked firmware.
#[derive(Clone, Debug)]
pub struct Firmware {
    /// Where it lies.
    pub path: PathBuf,
    /// The ELF file.
    pub bytes: Vec<u8>,
    /// What it takes of the chip.
    pub sizes: Sizes,
}

/// Memory that is taken before the first instruction runs; the stack is not in it.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Sizes {
    /// Bytes in flash: vectors, code, constants, and the first values of variables.
    pub flash_bytes: u32,
    /// Bytes in RAM: `.data`, `.bss` and `.uninit`.
    pub ram_bytes: u32,
}

impl Firmware {
    /// Builds the firmware as `cargo embed --release` would flash it.
    ///
    /// Adds the cross target where it is missing.
    ///
    /// # Errors
    /// The target cannot be added (a refusal), the build fails, or it leaves no ELF file.
    pub fn build(logic: LogicName, progress: &mut dyn Progress) -> Result<Self> {
        progress.stage("Building the firmware");
        let mut build = released();
        choose(&mut build, logic);
        Self::linked(build, (NAME, NAME), progress)
    }

    /// Builds the firmware as it is for a small board: nothing records calls, fewer candidates are learned
    /// from, the log's buffer is short, and the compiler spares bytes.
    ///
    /// # Errors
    /// As those of [`Self::build`].
    pub fn build_reduced(logic: LogicName, progress: &mut dyn Progress) -> Result<Self> {
        progress.stage("Building the reduced firmware");
        let mut build = toolchain::cargo();
        choose(&mut build, logic);
        build.env("DEFMT_RTT_BUFFER_SIZE", REDUCED_LOG.to_string());
        build.env("DEFMT_LOG", "error");
        build.args(["build", "--profile", REDUCED, "--features", REDUCED]);
        Self::linked(build, (NAME, NAME), progress)
    }

    /// Builds the program that runs parts of the firmware one by one, for measurements.
    ///
    /// # Errors
    /// As those of [`Self::build`].
    pub fn build_parts(progress: &mut dyn Progress) -> Result<Self> {
        progress.stage("Building the parts");
        Self::linked(released(), PARTS, progress)
    }

    /// Builds the program that runs every control logic in every way, for measurements.
    ///
    /// # Errors
    /// As those of [`Self::build`].
    pub fn build_logics(progress: &mut dyn Progress) -> Result<Self> {
        progress.stage("Building the control logics");
        Self::linked(released(), LOGICS, progress)
    }

    /// Builds the program that compares a control logic by the clock with ours.
    ///
    /// # Errors
    /// As those of [`Self::build`].
    pub fn build_flights(progress: &mut dyn Progress) -> Result<Self> {
        progress.stage("Building the comparison of control logics");
        Self::linked(released(), FLIGHTS, progress)
    }

    fn linked(
        mut build: Command,
        (package, name): (&str, &'static str),
        progress: &mut dyn Progress,
    ) -> Result<Self> {
        toolchain::ensure_target(progress)?;
        build.args(["--ignore-rust-version", "--target", TARGET]);
        build.args(["--package", package, "--bin", name]);
        build.arg("--message-format=json-render-diagnostics");
        let messages = toolchain::run(&mut build, progress)?;
        let path = executable(&messages, name).context("cargo named no program that it built")?;
        Self::read(path)
    }

    /// Reads a firmware that was built before.
    ///
    /// # Errors
    /// The file cannot be read or is no ELF file for the processor.
    pub fn read(path: PathBuf) -> Result<Self> {
        let bytes =
            fs::read(&path).with_context(|| format!("{} cannot be read", path.display()))?;
        let sizes = Sizes::of(&bytes).with_context(|| path.display().to_string())?;
        Ok(Self { path, bytes, sizes })
    }
}

/// Cargo, to build as it is flashed.
fn released() -> Command {
    let mut build = toolchain::cargo();
    build.args(["build", "--release"]);
    build
}

/// Named only where it is another: the variable alone would build everything anew.
fn choose(build: &mut Command, logic: LogicName) {
    if logic != LogicName::configured() {
        build.env("REFLEX_LOGIC", logic.word());
    }
}

/// The path of a binary among cargo's messages.
pub(crate) fn executable(messages: &[u8], name: &str) -> Option<PathBuf> {
    Message::parse_stream(messages)
        .flatten()
        .filter_map(|message| match message {
            Message::CompilerArtifact(artifact) if artifact.target.name == name => {
                artifact.executable.map(PathBuf::from)
            }
            _ => None,
        })
        .last()
}

impl Sizes {
    /// Measures an ELF file.
    ///
    /// # Errors
    /// It is no 32-bit little-endian ELF file, or is cut short.
    pub fn of(bytes: &[u8]) -> Result<Self> {
        let file = ElfFile32::<LE>::parse(bytes).context("is no ELF file for the processor")?;
        let header: &FileHeader32<LE> = file.elf_header();
        if header.e_machine.get(LE) != object::elf::EM_ARM {
            bail!("is not built for Arm");
        }
        let mut sizes = Self::default();
        for segment in file.elf_program_headers() {
            let loaded = segment.p_type(LE) == PT_LOAD;
            // The physical address is where the bytes lie before start-up copies them.
            if loaded && FLASH.contains(&segment.p_paddr(LE)) {
                sizes.flash_bytes += segment.p_filesz(LE);
            }
        }
        for section in header.section_headers(LE, bytes).context("is cut short")? {
            let allocated = section.sh_flags(LE) & SHF_ALLOC != 0;
            if allocated && section.sh_type(LE) != SHT_NOTE && !FLASH.contains(&section.sh_addr(LE))
            {
                sizes.ram_bytes += section.sh_size(LE);
            }
        }
        Ok(sizes)
    }
}
