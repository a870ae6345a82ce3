//! Text and an exit code for the debugger: Arm's semihosting calls.

use core::arch::asm;
use core::fmt::{self, Write};

const WRITE0: usize = 0x04;
const EXIT: usize = 0x18;
const STOPPED_WELL: usize = 0x20026;
const STOPPED_BADLY: usize = 0x20023;

fn call(operation: usize, argument: usize) {
    // SAFETY: the debugger reads registers, and the text that WRITE0's argument points to.
    unsafe { asm!("bkpt 0xab", inout("r0") operation => _, in("r1") argument) };
}

/// Standard output of the emulator.
pub struct Console;

impl Write for Console {
    fn write_str(&mut self, text: &str) -> fmt::Result {
        for chunk in text.as_bytes().chunks(63) {
            let mut ended = [0u8; 64];
            ended[..chunk.len()].copy_from_slice(chunk);
            call(WRITE0, ended.as_ptr() as usize);
        }
        Ok(())
    }
}

/// Ends the emulator.
pub fn exit(well: bool) -> ! {
    call(EXIT, if well { STOPPED_WELL } else { STOPPED_BADLY });
    loop {}
}
