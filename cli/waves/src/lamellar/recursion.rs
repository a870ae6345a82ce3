//! Reflection matrices of stacks of layers, from the substrate upwards.

use faer::Accum;
use faer::linalg::solvers::{PartialPivLu, Solve};
use num_complex::Complex64;

use super::medium::{Interface, Waves};
use crate::error::WaveError;
use crate::linear::{Matrix, multiply_into, scale_columns, scale_rows};

/// Amplitudes of the 2N waves of a pattern for one incident polarisation.
pub(super) type Column = Vec<Complex64>;

/// Waves that leave a stack, for light in s and in p.
#[derive(Debug)]
pub(super) struct Leaving {
    /// Waves that go up at the top of the stack.
    pub up: [Column; 2],
    /// Waves that go down at the top of the substrate.
    pub down: [Column; 2],
}

/// Layer of a stack, with the interface at its lower side.
#[derive(Clone, Copy, Debug)]
pub(super) struct Layer<'a> {
    pub waves: &'a Waves,
    /// Thickness in units of 1/k₀; 0 for the half-space above.
    pub thickness: f64,
    /// `None` between uniform media.
    pub floor: Option<&'a Interface>,
}

impl Layer<'_> {
    /// exp(i k_z d) of some of the layer's waves.
    fn phases(&self, waves: std::ops::Range<usize>) -> Vec<Complex64> {
        let turn = Complex64::new(0.0, self.thickness);
        self.waves.vertical[waves].iter().map(|kz| (turn * kz).exp()).collect()
    }
}

/// What light meets at the lower side of a layer: u = `up` t and d = `down` t with any t.
struct Seen {
    up: Matrix,
    down: PartialPivLu<Complex64>,
}

impl Seen {
    /// From s = u + d and −δ = d − u.
    fn new(s: &Matrix, minus_delta: &Matrix) -> Self {
        let half = faer::Scale(Complex64::from(0.5));
        Self { up: (s - minus_delta) * half, down: ((s + minus_delta) * half).partial_piv_lu() }
    }

    /// Reflection matrix at the upper side of the layer.
    fn reflection(&self, phases: &[Complex64]) -> Result<Matrix, WaveError> {
        let mut r = self.up.clone();
        self.down.rsolve_in_place(r.as_mut());
        if !r.is_all_finite() {
            return Err(WaveError::Singular);
        }
        scale_rows(&mut r, phases);
        scale_columns(&mut r, phases);
        Ok(r)
    }
}

/// Waves that leave the stack for the electric fields (x, y) that arrive in its first layer, in
/// order `arriving`, counted from 0.
///
/// # Errors
/// [`WaveError::Singular`] if a reflection matrix is not finite.
pub(super) fn propagate(
    stack: &[Layer<'_>],
    substrate: &Waves,
    ky: f64,
    arriving: usize,
    light: [[Complex64; 2]; 2],
) -> Result<Leaving, WaveError> {
    let n = substrate.electric.len();
    let mut below = substrate;
    let mut r = Matrix::zeros(2 * n, 2 * n);
    let mut seen: Vec<(Seen, Vec<Complex64>)> = Vec::with_capacity(stack.len());
    for (i, layer) in stack.iter().enumerate().rev() {
        let found = join(layer, below, ky, &r);
        let phases = layer.phases(0..2 * n);
        if i > 0 {
            r = found.reflection(&phases)?;
        }
        seen.push((found, phases));
        below = layer.waves;
    }
    let light = light.map(|electric| single(&[(arriving, electric[0]), (n + arriving, electric[1])], 2 * n));
    Ok(leave(&seen, &light))
}

fn single(elements: &[(usize, Complex64)], length: usize) -> Column {
    let mut column = vec![Complex64::ZERO; length];
    for &(row, value) in elements {
        column[row] = value;
    }
    column
}

/// Follows waves down a stack whose layers were seen from the lowest upwards.
fn leave(seen: &[(Seen, Vec<Complex64>)], light: &[Column; 2]) -> Leaving {
    let rows = light[0].len();
    let mut down = Matrix::from_fn(rows, 2, |row, column| light[column][row]);
    let mut up = Matrix::zeros(rows, 2);
    for (i, (found, phases)) in seen.iter().rev().enumerate() {
        scale_rows(&mut down, phases);
        down = found.down.solve(&down);
        if i == 0 {
            multiply_into(up.as_mut(), Accum::Replace, found.up.as_ref(), down.as_ref(), Complex64::ONE);
        }
    }
    let columns = |matrix: &Matrix| [0, 1].map(|column| matrix.col_as_slice(column).to_vec());
    Leaving { up: columns(&up), down: columns(&down) }
}

/// Takes the reflection matrix `r` at the top of `below` through the interface at the lower side of `layer`.
fn join(layer: &Layer<'_>, below: &Waves, ky: f64, r: &Matrix) -> Seen {
    let n = below.electric.len();
    let unit = |row: usize, column: usize| if row == column { Complex64::ONE } else { Complex64::ZERO };
    let s = Matrix::from_fn(2 * n, 2 * n, |i, j| r[(i, j)] + unit(i, j));
    let minus_delta = Matrix::from_fn(2 * n, 2 * n, |i, j| unit(i, j) - r[(i, j)]);
    // (e₁, e₂) and (−h₁, −h₂) below the interface.
    let mut e = s;
    let mut h = minus_delta;
    for column in 0..2 * n {
        for (element, factor) in e.col_as_slice_mut(column)[n..].iter_mut().zip(&below.electric) {
            *element *= factor;
        }
    }
    mix(&mut h, &below.magnetic);
    if let Some(interface) = layer.floor {
        let ky = Complex64::from(ky);
        let one = Complex64::ONE;
        let mut e_above = Matrix::zeros(2 * n, 2 * n);
        let (e1, e2) = e.as_ref().split_at_row(n);
        let (out1, mut out2) = e_above.as_mut().split_at_row_mut(n);
        multiply_into(out1, Accum::Replace, interface.e1.as_ref(), e1, one);
        multiply_into(out2.as_mut(), Accum::Replace, interface.second.as_ref(), e2, one);
        multiply_into(out2, Accum::Add, interface.e_cross.as_ref(), e1, ky);
        let mut h_above = Matrix::zeros(2 * n, 2 * n);
        let (h1, h2) = h.as_ref().split_at_row(n);
        let (out1, mut out2) = h_above.as_mut().split_at_row_mut(n);
        multiply_into(out1, Accum::Replace, interface.second.as_ref(), h1, one);
        multiply_into(out2.as_mut(), Accum::Replace, interface.h2.as_ref(), h2, one);
        multiply_into(out2, Accum::Add, interface.h_cross.as_ref(), h1, ky);
        e = e_above;
        h = h_above;
    }
    for column in 0..2 * n {
        for (element, factor) in e.col_as_slice_mut(column)[n..].iter_mut().zip(&layer.waves.electric) {
            *element /= factor;
        }
    }
    mix(&mut h, &layer.waves.from_magnetic);
    Seen::new(&e, &h)
}

/// Applies a 2 × 2 matrix to each pair of rows i and N + i.
fn mix(matrix: &mut Matrix, factors: &[[[Complex64; 2]; 2]]) {
    let n = factors.len();
    for column in 0..matrix.ncols() {
        let (first, second) = matrix.col_as_slice_mut(column).split_at_mut(n);
        for ((x, y), [[xx, xy], [yx, yy]]) in first.iter_mut().zip(second).zip(factors) {
            (*x, *y) = (xx * *x + xy * *y, yx * *x + yy * *y);
        }
    }
}

/// Waves that leave the stack as in [`propagate`], at k_y = 0, where s and p do not mix.
///
/// # Errors
/// [`WaveError::Singular`] if a reflection matrix is not finite.
pub(super) fn propagate_apart(
    stack: &[Layer<'_>],
    substrate: &Waves,
    arriving: usize,
    light: [[Complex64; 2]; 2],
) -> Result<Leaving, WaveError> {
    let n = substrate.electric.len();
    let mut leaving = Leaving {
        up: [vec![Complex64::ZERO; 2 * n], vec![Complex64::ZERO; 2 * n]],
        down: [vec![Complex64::ZERO; 2 * n], vec![Complex64::ZERO; 2 * n]],
    };
    for half in 0..2 {
        // e₁ and h₂ in the first half, e₂ and h₁ in the second.
        let factors = |waves: &Waves| -> [Vec<Complex64>; 2] {
            if half == 0 {
                [vec![Complex64::ONE; n], waves.magnetic.iter().map(|rows| rows[1][0]).collect()]
            } else {
                [waves.electric.clone(), waves.magnetic.iter().map(|rows| rows[0][1]).collect()]
            }
        };
        let range = half * n..(half + 1) * n;
        let mut below = factors(substrate);
        let mut r = Matrix::zeros(n, n);
        let mut seen = Vec::with_capacity(stack.len());
        for (i, layer) in stack.iter().enumerate().rev() {
            let unit = |row: usize, column: usize| if row == column { Complex64::ONE } else { Complex64::ZERO };
            let mut e = Matrix::from_fn(n, n, |i, j| r[(i, j)] + unit(i, j));
            let mut h = Matrix::from_fn(n, n, |i, j| unit(i, j) - r[(i, j)]);
            scale_rows(&mut e, &below[0]);
            scale_rows(&mut h, &below[1]);
            if let Some(interface) = layer.floor {
                let (electric, magnetic) =
                    if half == 0 { (&interface.e1, &interface.h2) } else { (&interface.second, &interface.second) };
                e = electric * e;
                h = magnetic * h;
            }
            below = factors(layer.waves);
            let invert = |factors: &[Complex64]| factors.iter().map(|factor| factor.inv()).collect::<Vec<_>>();
            scale_rows(&mut e, &invert(&below[0]));
            scale_rows(&mut h, &invert(&below[1]));
            let found = Seen::new(&e, &h);
            let phases = layer.phases(range.clone());
            if i > 0 {
                r = found.reflection(&phases)?;
            }
            seen.push((found, phases));
        }
        let columns = leave(&seen, &light.map(|electric| single(&[(arriving, electric[half])], n)));
        for polarisation in 0..2 {
            leaving.up[polarisation][range.clone()].copy_from_slice(&columns.up[polarisation]);
            leaving.down[polarisation][range.clone()].copy_from_slice(&columns.down[polarisation]);
        }
    }
    Ok(leaving)
}
