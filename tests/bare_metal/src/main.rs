//! The core alone on a microcontroller: traces the stack of the paper's figure 4 (three films, n = 2.4, 180 nm films
//! and gaps) and prints θ, λ, R_s and R_p as `goniochrome spectrum` does, then how much stack that took.
#![no_std]
#![no_main]

mod semihosting;

use core::fmt::Write;
use core::ptr::addr_of;
use cortex_m_rt::entry;
use goniochrome::optics::interface::{Below, Model};
use goniochrome::optics::medium::{MediaLanes, Medium};
use goniochrome::optics::stack::{Film, PreparedStack, PreparedStackArrays, Stack, StackArrays};
use goniochrome::simd::complex::ComplexLanes;
use goniochrome::simd::lanes::{F32, Lanes};
use goniochrome::trace::planar::{Summation, Workspace, trace_planar};
use semihosting::{Console, exit};

/// Number of planes: one more than the five layers.
const PLANES: usize = 6;

#[entry]
fn main() -> ! {
    let traced = [0.0, 45.0, 75.0].into_iter().try_for_each(spectrum).is_some();
    let _ = writeln!(Console, "# stack {} bytes", stack_used());
    exit(traced)
}

/// Traces and prints 81 wavelengths at one angle.
fn spectrum(theta_deg: f64) -> Option<()> {
    let media = [Medium::VACUUM, Medium::constant(2.4.into()).ok()?];
    let layers = [1, 0, 1, 0, 1].map(|medium| Film { medium, thickness_nm: 180.0 });
    let mut arrays = StackArrays::<PLANES>::new();
    let stack = Stack::new(0, layers, Below::Medium(0), arrays.memory()).ok()?;
    // The sines of three angles, so that no sine function is needed.
    let sin_theta = match theta_deg {
        45.0 => core::f64::consts::FRAC_1_SQRT_2,
        75.0 => 0.965_925_826_289_068_3,
        _ => 0.0,
    };
    let mut first_nm = 380.0;
    while first_nm <= 780.0 {
        let nm: [f64; F32::WIDTH] = core::array::from_fn(|lane| first_nm + 5.0 * lane as f64);
        let mut eta = [ComplexLanes::zero(); 2];
        let lanes = MediaLanes::<F32>::evaluate(&media, &nm, &mut eta).ok()?;
        let mut memory = PreparedStackArrays::<F32, PLANES>::new();
        let prepared = PreparedStack::prepare(stack, &lanes, sin_theta, Model::Physical, memory.memory()).ok()?;
        let mut workspace = Workspace::<F32, PLANES>::new();
        let reflected = trace_planar(&prepared, Summation::ClosedLoops, workspace.memory()).ok()?.ledger.reflected;
        for (lane, nm) in nm.iter().enumerate().filter(|(_, nm)| **nm <= 780.0) {
            let (s, p) = (reflected.s.lane(lane) as f32, reflected.p.lane(lane) as f32);
            writeln!(Console, "{theta_deg},{nm},{s},{p}").ok()?;
        }
        first_nm += 5.0 * F32::WIDTH as f64;
    }
    Some(())
}

/// Number of bytes of stack that were used: those above the words that still have the paint of `cortex-m-rt`.
fn stack_used() -> usize {
    unsafe extern "C" {
        static _stack_start: u32;
        static _stack_end: u32;
    }
    const PAINT: u32 = 0xcccc_cccc;
    // SAFETY: the addresses of the linker's symbols, and painted words between them.
    unsafe {
        let (bottom, top) = (addr_of!(_stack_end), addr_of!(_stack_start));
        let mut word = bottom;
        while word < top && word.read_volatile() == PAINT {
            word = word.add(1);
        }
        top as usize - word as usize
    }
}

#[panic_handler]
fn panic(info: &core::panic::PanicInfo<'_>) -> ! {
    let _ = writeln!(Console, "{info}");
    exit(false)
}
