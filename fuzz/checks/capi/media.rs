//! Media in the form of the C interface, and their indices by the core.

use super::program::{Faults, Program};
use goniochrome::optics::medium::{Dispersion, Extrapolate, Medium};
use goniochrome_capi::media::{GONIO_MAX_MEDIA, Medium as CMedium};
use num_complex::Complex64;

/// Media of the C interface, and the arrays that they point to.
pub struct Media {
    columns: Vec<[Vec<f64>; 3]>,
    pub list: Vec<CMedium>,
}

impl Media {
    /// Up to four media, or sometimes `GONIO_MAX_MEDIA` + 1.
    pub fn new(program: &mut Program<'_>, faults: &mut Faults) -> Self {
        let count = match program.byte() {
            255 => GONIO_MAX_MEDIA + 1,
            code => usize::from(code) % 5,
        };
        let mut columns = Vec::new();
        for _ in 0..count {
            let kind = program.byte();
            let entries = usize::from(kind & 3);
            // Most have one entry.
            let entries = [1, 2, 3, 0][if kind & 0x40 != 0 { entries } else { 0 }];
            let mut column = |low: f64, high: f64| (0..entries).map(|_| program.number(low, high)).collect::<Vec<_>>();
            let wavelength_nm = if entries > 1 { column(200.0, 1500.0) } else { Vec::new() };
            let n = column(0.05, 4.0);
            let k = if kind & 4 != 0 { column(0.0, 6.0) } else { Vec::new() };
            columns.push([wavelength_nm, n, k]);
        }
        let point = |[wavelength_nm, n, k]: &[Vec<f64>; 3]| CMedium {
            wavelength_nm: if wavelength_nm.is_empty() { std::ptr::null() } else { faults.list(wavelength_nm) },
            n: faults.list(n),
            k: if k.is_empty() { std::ptr::null() } else { k.as_ptr() },
            count: n.len(),
        };
        let list = columns.iter().map(point).collect();
        Self { columns, list }
    }

    /// The index of a medium, or sometimes of one that does not exist.
    pub fn index(&self, program: &mut Program<'_>) -> u16 {
        (program.byte() as usize % (8 * self.list.len() + 1) / 8) as u16
    }

    /// n + ik of each medium that an object was made of.
    pub fn eta(&self, nm: f64) -> Vec<Complex64> {
        let eta = |[wavelength_nm, n, k]: &[Vec<f64>; 3]| {
            let dispersion = |column: &'_ [f64]| match *column {
                [] => Complex64::ZERO.re,
                [constant] => constant,
                _ => f64::NAN,
            };
            let table = |value| Dispersion::Table { wavelength_nm, value };
            let of = |column| match n.len() {
                1 => Dispersion::Constant(dispersion(column)),
                _ if column.is_empty() => Dispersion::Constant(0.0),
                _ => table(column),
            };
            Medium::new(of(n), of(k), Extrapolate::Refuse).expect("a medium of an object").eta(nm).expect("in range")
        };
        self.columns.iter().map(eta).collect()
    }
}
