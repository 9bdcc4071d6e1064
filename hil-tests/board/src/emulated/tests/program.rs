//! Programs of a few words, linked into an ELF by hand.

use crate::Elf;

/// Where the image is flashed; the vectors come first.
const FLASH: u32 = 0x0800_0000;
/// Bytes of the vectors: stack, reset, and the first sixteen exceptions.
const VECTORS: u32 = 0x40;
/// Where every fault goes: a branch to itself, in front of the program.
const HANDLER: u32 = FLASH + VECTORS;
/// Where every other exception goes: another one.
const UNHANDLED: u32 = HANDLER + 4;
/// First instruction of the program, at a word boundary.
pub(super) const CODE: u32 = UNHANDLED + 4;
/// Number of the first exception that is no fault.
const SVCALL: u32 = 11;
/// Top and bottom of the stack.
pub(super) const STACK: std::ops::Range<u32> = 0x2000_1000..0x2000_1400;
/// Where the call log and the settings lie.
pub(super) const CALLS: u32 = 0x2000_2000;
pub(super) const SETTINGS: u32 = 0x2000_3000;
const RTT: u32 = 0x2000_4000;

/// `b .`, and a `nop` behind it.
const SPIN: [u16; 2] = [0xE7FE, 0xBF00];

/// `wfi`, and back to it; or an undefined instruction.
pub(super) const SLEEP: [u16; 2] = [0xBF30, 0xE7FD];
pub(super) const CRASH: [u16; 2] = [0xDE00, 0xBF00];

/// A program that makes `writes` (address, value) in order, then sleeps.
pub(super) fn writing(writes: &[(u32, u32)]) -> Elf {
    writing_then(writes, SLEEP)
}

/// A program that makes `writes` (address, value) in order, then does `end`.
pub(super) fn writing_then(writes: &[(u32, u32)], end: [u16; 2]) -> Elf {
    // ldr r0, =table; loop: ldmia r0!, {r1, r2}; cbz r1, end; str r2, [r1];
    // b loop; end:
    let code = [
        0x4803, 0xC806, 0xB109, 0x600A, 0xE7FB, end[0], end[1], 0xBF00,
    ];
    let table = CODE + 2 * code.len() as u32 + 4;
    let mut words = vec![table];
    words.extend(writes.iter().flat_map(|&(address, value)| [address, value]));
    words.extend([0, 0]);
    assembled(&code, &words)
}

/// Writes that put `frame` into the log, as defmt over RTT would.
pub(super) fn logging(frame: u32) -> [(u32, u32); 4] {
    const BUFFER: u32 = RTT + 0x100;
    // Descriptor of channel 0: name, buffer, size, write and read offset.
    [
        (BUFFER, frame),
        (RTT + 28, BUFFER),
        (RTT + 32, 64),
        (RTT + 36, 3),
    ]
}

/// Log frames of three bytes: string number, control byte, end.
pub(super) const HELLO: u32 = 0x00_7E_01;
pub(super) const PANICKED: u32 = 0x00_7E_02;

/// A program of `code`, an even number of half-words, followed by `words`.
pub(super) fn assembled(code: &[u16], words: &[u32]) -> Elf {
    let mut image = Vec::new();
    image.extend(STACK.end.to_le_bytes());
    image.extend((CODE | 1).to_le_bytes());
    for exception in 2..VECTORS / 4 {
        let handler = if exception < SVCALL {
            HANDLER
        } else {
            UNHANDLED
        };
        image.extend((handler | 1).to_le_bytes());
    }
    image.extend(
        SPIN.iter()
            .chain(&SPIN)
            .chain(code)
            .flat_map(|half| half.to_le_bytes()),
    );
    image.extend(words.iter().flat_map(|word| word.to_le_bytes()));
    Elf::parse(linked(&image)).unwrap()
}

/// Section index of values that belong to no section, and of `.defmt`.
const ABSOLUTE: u16 = 0xFFF1;
const STRINGS: u16 = 2;

const SYMBOLS: [(&str, u32, u16); 11] = [
    ("_stack_start", STACK.end, ABSOLUTE),
    ("_stack_end", STACK.start, ABSOLUTE),
    ("REFLEX_CALLS", CALLS, ABSOLUTE),
    ("REFLEX_SETTINGS", SETTINGS, ABSOLUTE),
    ("_SEGGER_RTT", RTT, ABSOLUTE),
    ("HardFault", HANDLER | 1, ABSOLUTE),
    ("DefaultHandler", UNHANDLED | 1, ABSOLUTE),
    ("_defmt_version_ = 4", 0, ABSOLUTE),
    ("_defmt_encoding_ = rzcobs", 0, ABSOLUTE),
    (
        r#"{"package":"t","tag":"defmt_info","data":"hello","disambiguator":"1","crate_name":"t"}"#,
        1,
        STRINGS,
    ),
    (
        r#"{"package":"t","tag":"defmt_error","data":"panicked at x.rs:1:\nsorry","disambiguator":"2","crate_name":"t"}"#,
        2,
        STRINGS,
    ),
];

/// Section types, flags and ELF constants used below.
const PROGBITS: u32 = 1;
const SYMTAB: u32 = 2;
const STRTAB: u32 = 3;
const CODE_IN_MEMORY: u32 = 6;
const HEADER: usize = 52;
const SEGMENT: usize = 32;

/// Little-endian bytes of words.
fn words(values: &[u32]) -> Vec<u8> {
    values
        .iter()
        .flat_map(|value| value.to_le_bytes())
        .collect()
}

/// The symbol table of [`SYMBOLS`], and the strings it names.
fn symbol_table() -> (Vec<u8>, Vec<u8>) {
    let mut strings = vec![0_u8];
    let mut symbols = vec![0_u8; 16];
    for (name, value, section) in SYMBOLS {
        symbols.extend(words(&[strings.len() as u32, value, 0]));
        // Global, no type; default visibility.
        symbols.extend([0x10, 0]);
        symbols.extend(section.to_le_bytes());
        strings.extend(name.bytes().chain([0]));
    }
    (symbols, strings)
}

/// The ELF header of an Arm executable with one segment and six sections.
fn header(sections_at: usize) -> Vec<u8> {
    let mut file: Vec<u8> = b"\x7fELF\x01\x01\x01\0\0\0\0\0\0\0\0\0\x02\0\x28\0".to_vec();
    let places = [1, CODE | 1, HEADER as u32, sections_at as u32, 0x0500_0000];
    file.extend(words(&places));
    for half in [HEADER, SEGMENT, 1, 40, 6, 5] {
        file.extend((half as u16).to_le_bytes());
    }
    file
}

/// A 32-bit Arm ELF with `image` at the start of flash and [`SYMBOLS`].
fn linked(image: &[u8]) -> Vec<u8> {
    let (symbols, strings) = symbol_table();
    let names = b"\0.text\0.defmt\0.symtab\0.strtab\0";
    let image_at = HEADER + SEGMENT;
    let symbols_at = image_at + image.len();
    let strings_at = symbols_at + symbols.len();
    let names_at = strings_at + strings.len();
    let sections_at = (names_at + names.len()).next_multiple_of(4);
    let [image_w, symbols_w, strings_w, names_w] =
        [image_at, symbols_at, strings_at, names_at].map(|at| at as u32);
    let [image_n, symbols_n, strings_n, names_n] =
        [image.len(), symbols.len(), strings.len(), names.len()].map(|length| length as u32);
    // name, type, flags, address, offset, size, link, info, alignment, entry
    let sections: [[u32; 10]; 6] = [
        [0; 10],
        [
            1,
            PROGBITS,
            CODE_IN_MEMORY,
            FLASH,
            image_w,
            image_n,
            0,
            0,
            4,
            0,
        ],
        [7, PROGBITS, 0, 0, image_w, 0, 0, 0, 1, 0],
        [14, SYMTAB, 0, 0, symbols_w, symbols_n, 4, 1, 4, 16],
        [22, STRTAB, 0, 0, strings_w, strings_n, 0, 0, 1, 0],
        [22, STRTAB, 0, 0, names_w, names_n, 0, 0, 1, 0],
    ];
    let mut file = header(sections_at);
    file.extend(words(&[1, image_w, FLASH, FLASH, image_n, image_n, 5, 4]));
    file.extend_from_slice(image);
    file.extend(symbols);
    file.extend(strings);
    file.extend_from_slice(names);
    file.resize(sections_at, 0);
    file.extend(sections.iter().flat_map(|section| words(section)));
    file
}
