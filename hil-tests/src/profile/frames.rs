//! From an address of the firmware to functions and modules, the inlined ones too.

use std::collections::HashMap;
use std::path::Path;
use std::rc::Rc;

use addr2line::gimli::{Dwarf, EndianSlice, LittleEndian, SectionId};
use anyhow::{Context, Result};
use object::{Object, ObjectSection};

use crate::toolchain;
use emulated_board::Elf;

type Slice<'e> = EndianSlice<'e, LittleEndian>;

/// A function that an address is in, by itself or inlined.
#[derive(Clone, Debug, Default, PartialEq, Eq, PartialOrd, Ord)]
pub struct Frame {
    /// Its path.
    pub function: String,
    /// Module of the source: `reflex::graph::cascade`, `board::reflex_f427::spi`, `core::option`.
    pub module: String,
}

/// The functions of a firmware.
pub(super) struct Frames<'e> {
    context: addr2line::Context<Slice<'e>>,
    elf: Elf,
    known: HashMap<u32, Rc<[Rc<Frame>]>>,
}

impl<'e> Frames<'e> {
    /// Those of an ELF file with debug information.
    ///
    /// # Errors
    /// It has none that can be read.
    pub(super) fn of(elf: &'e [u8]) -> Result<Self> {
        let file = object::File::parse(elf).context("the firmware is not an ELF file")?;
        let section = |id: SectionId| -> Result<Slice<'e>> {
            let section = file.section_by_name(id.name());
            let data = section.map_or(Ok(&[][..]), |section| section.data())?;
            Ok(EndianSlice::new(data, LittleEndian))
        };
        let context = addr2line::Context::from_dwarf(Dwarf::load(section)?);
        Ok(Self {
            context: context.context("the firmware's debug information cannot be read")?,
            elf: Elf::parse(elf.to_vec())?,
            known: HashMap::new(),
        })
    }

    /// Name of an exception's handler.
    pub(super) fn handler(&self, exception: u16) -> Option<&str> {
        self.elf.handler(exception)
    }

    /// The functions that an address is in, the outermost first; never none.
    ///
    /// # Errors
    /// Debug information that cannot be read.
    pub(super) fn at(&mut self, address: u32) -> Result<Rc<[Rc<Frame>]>> {
        if let Some(known) = self.known.get(&address) {
            return Ok(Rc::clone(known));
        }
        let mut found = Vec::new();
        let mut frames = self
            .context
            .find_frames(u64::from(address))
            .skip_all_loads()?;
        while let Some(frame) = frames.next()? {
            let Some(function) = &frame.function else {
                continue;
            };
            let file = frame.location.and_then(|location| location.file);
            found.push(Frame {
                function: plain(&function.demangle()?),
                module: file.map(module).unwrap_or_default(),
            });
        }
        if found.is_empty() {
            found.push(Frame {
                function: self
                    .elf
                    .function_at(address)
                    .unwrap_or("unknown")
                    .to_owned(),
                module: String::new(),
            });
        }
        found.reverse();
        let found: Rc<[Rc<Frame>]> = found.into_iter().map(Rc::new).collect();
        self.known.insert(address, Rc::clone(&found));
        Ok(found)
    }
}

/// A function's path as stacks are written: closures are part of it, and `;` divides frames.
fn plain(name: &str) -> String {
    name.replace("::{{closure}}", "").replace(';', ",")
}

/// The module of a source file, by its path in `src/` and its crate.
fn module(file: &str) -> String {
    let inside = Path::new(file).strip_prefix(toolchain::root());
    let file = inside.ok().and_then(Path::to_str).unwrap_or(file);
    let (folder, path) = match (file.strip_prefix("src/"), file.rsplit_once("/src/")) {
        (Some(path), _) => ("reflex", path),
        (None, Some((folders, path))) => (folders.rsplit('/').next().unwrap_or(folders), path),
        (None, None) => ("", file),
    };
    let path = path.trim_end_matches(".rs").split('/');
    let names: Vec<&str> = path.filter(|name| !["lib", "mod"].contains(name)).collect();
    // The application has the library's name.
    let application = folder == "reflex"
        && names
            .first()
            .is_some_and(|name| ["main", "board"].contains(name));
    let prefix = (!application && !folder.is_empty()).then(|| unversioned(folder));
    let path: Vec<&str> = prefix.into_iter().chain(names).collect();
    path.join("::").replace('-', "_")
}

/// A crate's name from that of its folder: `defmt-rtt-1.0.0` is `defmt-rtt`.
fn unversioned(folder: &str) -> &str {
    match folder.rsplit_once('-') {
        Some((name, version)) if version.starts_with(|digit: char| digit.is_ascii_digit()) => name,
        _ => folder,
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_module_is_told_from_its_file() {
        let root = toolchain::root().display();
        for (file, expected) in [
            (
                format!("{root}/src/graph/cascade.rs"),
                "reflex::graph::cascade",
            ),
            (format!("{root}/src/lib.rs"), "reflex"),
            (format!("{root}/src/main.rs"), "main"),
            (
                format!("{root}/src/board/reflex_f427/spi.rs"),
                "board::reflex_f427::spi",
            ),
            (format!("{root}/drivers/src/mpu6050.rs"), "drivers::mpu6050"),
            (
                "/r/defmt-rtt-1.0.0/src/channel.rs".into(),
                "defmt_rtt::channel",
            ),
            ("/rustc/5/library/core/src/num/mod.rs".into(), "core::num"),
            ("/t/out/config.rs".into(), "::t::out::config"),
        ] {
            assert_eq!(module(&file), expected, "{file}");
        }
    }

    #[test]
    fn a_closure_belongs_to_its_function() {
        assert_eq!(plain("a::f::{{closure}}::{{closure}}"), "a::f");
        assert_eq!(plain("<[u8; 4] as A>::f"), "<[u8, 4] as A>::f");
    }
}
