//! The reduced build fits the flash of a small board.

use hil_tests::firmware::Firmware;
use hil_tests::logics::LogicName;
use hil_tests::progress::Silent;

/// Flash of the paper's smallest board, in bytes.
const FLASH: u32 = 128 * 1024;
/// Most bytes of variables; its stack is in docs/performance.md.
const VARIABLES: u32 = 14 * 1024;

#[test]
fn a_reduced_build_fits_the_flash_of_a_small_board() {
    let firmware = Firmware::build_reduced(LogicName::configured(), &mut Silent).unwrap();
    let (flash, variables) = (firmware.sizes.flash_bytes, firmware.sizes.ram_bytes);
    println!("reduced: {flash} bytes of flash, {variables} of variables");
    assert!(flash <= FLASH, "{flash} bytes of flash");
    assert!(variables <= VARIABLES, "{variables} bytes of variables");
    let elf = emulated_board::Elf::parse(firmware.bytes).unwrap();
    assert!(
        elf.find(emulated_board::CALLS_SYMBOL).is_none(),
        "nothing records calls"
    );
}
