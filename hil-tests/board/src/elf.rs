//! What the host needs from the firmware's ELF: symbols, stack, functions.

use std::collections::BTreeMap;
use std::ops::Range;

use anyhow::{Context, Result, bail};
use object::{Object, ObjectSection, ObjectSymbol, SectionKind, SymbolKind};

use super::Watched;

/// A firmware image with its symbols.
#[derive(Clone, Debug)]
pub struct Elf {
    bytes: Vec<u8>,
    symbols: BTreeMap<String, u32>,
    functions: BTreeMap<u32, (u32, String)>,
}

impl Elf {
    /// Reads the symbols of a linked firmware; an error when it is none.
    pub fn parse(bytes: Vec<u8>) -> Result<Self> {
        let file = object::File::parse(&*bytes).context("the firmware is not an ELF file")?;
        if file.architecture() != object::Architecture::Arm {
            bail!(
                "the firmware is built for {:?}, not for Arm",
                file.architecture()
            );
        }
        let mut symbols = BTreeMap::new();
        let mut functions = BTreeMap::new();
        for symbol in file.symbols() {
            let (Ok(name), Ok(address)) = (symbol.name(), u32::try_from(symbol.address())) else {
                continue;
            };
            if name.is_empty() || name.starts_with('$') {
                continue;
            }
            if symbol.kind() == SymbolKind::Text {
                let size = u32::try_from(symbol.size()).unwrap_or(u32::MAX);
                functions.insert(address & !1, (size, name.to_owned()));
            }
            symbols.insert(name.to_owned(), address);
        }
        Ok(Self {
            bytes,
            symbols,
            functions,
        })
    }

    /// The file itself.
    pub fn bytes(&self) -> &[u8] {
        &self.bytes
    }

    /// Value of a symbol; an error that names it when the firmware lacks it.
    pub fn symbol(&self, name: &str) -> Result<u32> {
        self.find(name)
            .with_context(|| format!("the firmware has no symbol {name}"))
    }

    /// Value of a symbol, if the firmware has it.
    pub fn find(&self, name: &str) -> Option<u32> {
        self.symbols.get(name).copied()
    }

    /// Address of a function's first instruction, without the Thumb bit.
    pub fn code(&self, name: &str) -> Result<u32> {
        Ok(self.symbol(name)? & !1)
    }

    /// The instruction that a watched place begins with.
    pub fn place_of(&self, place: &Watched) -> Result<u32> {
        match place {
            Watched::Symbol(name) => self.code(name),
            Watched::Address(address) => Ok(*address),
        }
    }

    /// Address of the one function whose path ends so: `["app", "idle"]` is `reflex::app::idle`.
    ///
    /// Both ways in which the compiler spells a path as a symbol put the length of each name
    /// before it.
    pub fn function(&self, path: &[&str]) -> Result<u32> {
        let spelled = spelled(path);
        let found: Vec<u32> = self
            .functions
            .iter()
            .filter(|(_, (_, name))| name.contains(&spelled))
            .map(|(address, _)| *address)
            .collect();
        match found[..] {
            [address] => Ok(address),
            _ => bail!("{} functions are {}, not one", found.len(), path.join("::")),
        }
    }

    /// Address of the one variable whose path ends so, as in [`Self::function`].
    pub fn variable(&self, path: &[&str]) -> Result<u32> {
        let spelled = spelled(path);
        let symbols = self.symbols.iter();
        let found: Vec<u32> = symbols
            .filter(|(name, _)| name.contains(&spelled))
            .map(|(_, address)| *address)
            .collect();
        match found[..] {
            [address] => Ok(address),
            _ => bail!("{} variables are {}, not one", found.len(), path.join("::")),
        }
    }

    /// The half-words of the function at an address, each with its own address.
    pub fn half_words(&self, function: u32) -> Result<Vec<(u32, u16)>> {
        let (size, _) = self
            .functions
            .get(&function)
            .with_context(|| format!("no function begins at {function:#010x}"))?;
        let file = object::File::parse(&*self.bytes).context("the firmware is not an ELF file")?;
        let code = file.sections().find_map(|section| {
            let data = section.data_range(u64::from(function), u64::from(*size));
            data.ok().flatten()
        });
        let code = code.with_context(|| format!("no code at {function:#010x}"))?;
        let halves = code.chunks_exact(2).map(|half| [half[0], half[1]]);
        Ok((function..)
            .step_by(2)
            .zip(halves.map(u16::from_le_bytes))
            .collect())
    }

    /// The code of the program.
    pub fn executable(&self) -> Code {
        let sections = object::File::parse(&*self.bytes)
            .into_iter()
            .flat_map(|file| {
                let code = file
                    .sections()
                    .filter(|section| section.kind() == SectionKind::Text);
                let code = code.filter_map(|section| {
                    let start = u32::try_from(section.address()).ok()?;
                    Some((start, section.data().ok()?.to_vec()))
                });
                code.collect::<Vec<_>>()
            });
        Code(sections.collect())
    }

    /// Writes over a constant in the image, before it is loaded: at most what it has room for.
    ///
    /// `path` is the end of its path, as in [`Self::function`].
    ///
    /// # Errors
    /// There is no such constant, it is smaller, or it is not in the file.
    pub fn overwrite(&mut self, path: &[&str], content: &[u8]) -> Result<()> {
        let (name, spelled) = (path.join("::"), spelled(path));
        let file = object::File::parse(&*self.bytes).context("the firmware is not an ELF file")?;
        let symbol = file.symbols().find(|symbol| {
            symbol.kind() == SymbolKind::Data
                && symbol.name().is_ok_and(|name| name.contains(&spelled))
        });
        let symbol = symbol.with_context(|| format!("the firmware has no constant {name}"))?;
        if symbol.size() < content.len() as u64 {
            bail!(
                "{name} holds {} bytes, not {}",
                symbol.size(),
                content.len()
            );
        }
        let place = file.sections().find_map(|section| {
            let (start, size) = section.file_range()?;
            let offset = symbol.address().checked_sub(section.address())?;
            (offset < section.size() && offset < size).then_some(start + offset)
        });
        let place = place.with_context(|| format!("{name} is not in the file"))? as usize;
        let length = content.len();
        let target = self.bytes.get_mut(place..place + length);
        target
            .with_context(|| format!("{name} ends behind the file"))?
            .copy_from_slice(content);
        Ok(())
    }

    /// Has an exception, by its number, led to an address in place of its handler, which is returned.
    ///
    /// # Errors
    /// The firmware has no such vector.
    pub fn lead(&mut self, exception: u16, to: u32) -> Result<u32> {
        let file = object::File::parse(&*self.bytes).context("the firmware is not an ELF file")?;
        let vectors = file.section_by_name(".vector_table");
        let (start, size) = vectors
            .and_then(|section| section.file_range())
            .context("the firmware has no vectors")?;
        let offset = 4 * u64::from(exception);
        if offset + 4 > size {
            bail!("the firmware has no vector {exception}");
        }
        let place = (start + offset) as usize;
        let vector = self.bytes.get_mut(place..place + 4).context("cut off")?;
        let handler = u32::from_le_bytes(vector.try_into()?);
        vector.copy_from_slice(&(to | 1).to_le_bytes());
        Ok(handler)
    }

    /// The stack's region, by the linker's symbols: it grows from the end
    /// towards the start.
    pub fn stack(&self) -> Result<Range<u32>> {
        let (start, end) = (self.symbol("_stack_end")?, self.symbol("_stack_start")?);
        if start >= end {
            bail!(
                "the firmware's stack is empty: _stack_end {start:#010x}, _stack_start {end:#010x}"
            );
        }
        Ok(start.next_multiple_of(4)..end)
    }

    /// The function that holds `pc`, for a message: `name (pc 0x...)`.
    pub fn place(&self, pc: u64) -> String {
        let name = u32::try_from(pc).ok().and_then(|pc| self.function_at(pc));
        format!("{} (pc {pc:#010x})", name.unwrap_or("unknown code"))
    }

    /// Name of the function that holds an address.
    pub fn function_at(&self, address: u32) -> Option<&str> {
        let (start, (size, name)) = self.functions.range(..=address).next_back()?;
        (address - start < (*size).max(2)).then_some(name.as_str())
    }

    /// Name of the function that handles an exception, by its number.
    pub fn handler(&self, exception: u16) -> Option<&str> {
        let address = self.vectors()?.get(usize::from(exception)).copied()?;
        self.function_at(address & !1)
    }

    /// Address of every function that handles an exception, some more than once.
    pub fn handlers(&self) -> impl Iterator<Item = u32> {
        // Stack and reset come first; a vector that is none is 0.
        let vectors = self.vectors().unwrap_or_default();
        let handlers = vectors.into_iter().skip(2);
        handlers
            .filter(|address| *address != 0)
            .map(|address| address & !1)
    }

    fn vectors(&self) -> Option<Vec<u32>> {
        let file = object::File::parse(&*self.bytes).ok()?;
        let vectors = file.section_by_name(".vector_table")?.data().ok()?;
        let words = vectors.as_chunks().0.iter();
        Some(words.map(|word| u32::from_le_bytes(*word)).collect())
    }
}

/// The bytes of a program's code, by the address of their first.
#[derive(Clone, Debug, Default)]
pub struct Code(Vec<(u32, Vec<u8>)>);

impl<const N: usize> From<[(u32, Vec<u8>); N]> for Code {
    fn from(sections: [(u32, Vec<u8>); N]) -> Self {
        Self(sections.into())
    }
}

impl Code {
    /// The half-word at an address, where there is code.
    #[must_use]
    pub fn half_word(&self, address: u32) -> Option<u16> {
        self.0.iter().find_map(|(start, bytes)| {
            let at = address.checked_sub(*start)? as usize;
            let half = bytes.get(at..at + 2)?;
            Some(u16::from_le_bytes([half[0], half[1]]))
        })
    }
}

/// A path as part of a symbol: the length of each name before it.
fn spelled(path: &[&str]) -> String {
    let names = path.iter().map(|name| format!("{}{name}", name.len()));
    names.collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    fn with(symbols: &[(&str, u32)]) -> Elf {
        Elf {
            bytes: Vec::new(),
            symbols: symbols
                .iter()
                .map(|&(name, at)| (name.into(), at))
                .collect(),
            functions: [(0x0800_0400, (0x40, "main".to_owned()))].into(),
        }
    }

    #[test]
    fn the_stack_lies_between_the_linkers_symbols() {
        let elf = with(&[("_stack_start", 0x1001_0000), ("_stack_end", 0x1000_0000)]);
        assert_eq!(elf.stack().unwrap(), 0x1000_0000..0x1001_0000);
    }

    #[test]
    fn an_empty_stack_is_refused() {
        let elf = with(&[("_stack_start", 0x2000_0000), ("_stack_end", 0x2000_0000)]);
        assert!(
            elf.stack()
                .unwrap_err()
                .to_string()
                .contains("stack is empty")
        );
    }

    #[test]
    fn a_missing_symbol_is_named() {
        let error = with(&[]).symbol("REFLEX_CALLS").unwrap_err();
        assert_eq!(error.to_string(), "the firmware has no symbol REFLEX_CALLS");
    }

    #[test]
    fn a_program_counter_is_told_with_its_function() {
        let elf = with(&[]);
        assert_eq!(elf.place(0x0800_0410), "main (pc 0x08000410)");
        assert_eq!(elf.place(0x0800_0500), "unknown code (pc 0x08000500)");
    }

    #[test]
    fn what_is_no_elf_file_is_refused() {
        let error = Elf::parse(b"not an image".to_vec()).unwrap_err();
        assert_eq!(error.to_string(), "the firmware is not an ELF file");
    }
}
