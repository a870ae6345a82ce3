//! Reflection matrices of stacks of layers, from the substrate upwards.

use std::ops::Range;

use faer::Accum;
use num_complex::Complex64;

use super::medium::{Interface, Waves};
use crate::error::WaveError;
use crate::linear::{Matrix, Rows, multiply_into, product, scale_rows};

/// Amplitudes of the waves of a pattern for one incident polarisation.
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
    fn phases(&self, waves: Range<usize>) -> Vec<Complex64> {
        let turn = Complex64::new(0.0, self.thickness);
        self.waves.vertical[waves].iter().map(|kz| (turn * kz).exp()).collect()
    }
}

/// Waves at the lower side of a layer per light d that goes down below it: 2u = `up` d goes up, 2d' = `down` d down.
/// Its matrices serve one interface after another.
struct Meeting {
    up: Matrix,
    down: Matrix,
    /// Values of `up` and `down` on the other side of the interface.
    across: [Matrix; 2],
}

impl Meeting {
    fn new(waves: usize) -> Self {
        let empty = || Matrix::zeros(waves, waves);
        Self { up: empty(), down: empty(), across: [empty(), empty()] }
    }
}

/// Waves that leave the stack for the electric fields (x, y) that arrive in its first layer, in order `arriving`,
/// counted from 0.
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
    let light = Matrix::from_fn(2 * n, 2, |row, polarisation| match row {
        _ if row == arriving => light[polarisation][0],
        _ if row == n + arriving => light[polarisation][1],
        _ => Complex64::ZERO,
    });
    climb(stack, substrate, 0..2 * n, light, |layer, below, r, meeting| join(layer, below, ky, r, meeting))
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
    let [p, s] = [0, 1].map(|half| {
        let light = Matrix::from_fn(
            n,
            2,
            |row, polarisation| {
                if row == arriving { light[polarisation][half] } else { Complex64::ZERO }
            },
        );
        climb(stack, substrate, half * n..(half + 1) * n, light, |layer, below, r, meeting| {
            join_half(half, layer, below, r, meeting);
        })
    });
    let (p, s) = (p?, s?);
    let both = |p: [Column; 2], s: [Column; 2]| {
        let ([p0, p1], [s0, s1]) = (p, s);
        [[p0, s0].concat(), [p1, s1].concat()]
    };
    Ok(Leaving { up: both(p.up, s.up), down: both(p.down, s.down) })
}

/// Follows the reflection matrix of all that lies below up the stack, then `light` down. `join` takes the matrix at the
/// top of the waves below through the lower side of a layer; `waves` are those of each pattern that take part.
fn climb(
    stack: &[Layer<'_>],
    substrate: &Waves,
    waves: Range<usize>,
    light: Matrix,
    join: impl Fn(&Layer<'_>, &Waves, &Matrix, &mut Meeting),
) -> Result<Leaving, WaveError> {
    let n = waves.len();
    let mut below = substrate;
    let mut r = Matrix::zeros(n, n);
    let mut meeting = Meeting::new(n);
    // Triangular factors of all `down`, side by side from the substrate upwards, in one allocation.
    let mut factors = Matrix::zeros(n, n * stack.len());
    let mut passed: Vec<(Rows, Vec<Complex64>)> = Vec::with_capacity(stack.len());
    for (i, layer) in stack.iter().rev().enumerate() {
        join(layer, below, &r, &mut meeting);
        let mut down = factors.subcols_mut(i * n, n);
        down.copy_from(&meeting.down);
        let rows = Rows::factor(down.as_mut());
        let phases = layer.phases(waves.clone());
        if i + 1 < stack.len() {
            std::mem::swap(&mut r, &mut meeting.up);
            rows.solve_left_in_place(down.as_ref(), r.as_mut());
            if !scale(&mut r, &phases).is_finite() {
                return Err(WaveError::Singular);
            }
        }
        passed.push((rows, phases));
        below = layer.waves;
    }
    let mut down = light;
    let mut up = None;
    for (i, (rows, phases)) in passed.iter().enumerate().rev() {
        scale_rows(&mut down, phases);
        rows.solve_in_place(factors.subcols(i * n, n), down.as_mut());
        up = up.or_else(|| Some(product(meeting.up.as_ref(), down.as_ref())));
        // `down` is twice the light.
        down *= faer::Scale(Complex64::from(2.0));
    }
    let columns = |matrix: &Matrix| [0, 1].map(|column| matrix.col_as_slice(column).to_vec());
    Ok(Leaving { up: columns(&up.ok_or(WaveError::Singular)?), down: columns(&down) })
}

/// Multiplies the element (i, j) by the factors i and j. Returns the sum of all elements.
fn scale(matrix: &mut Matrix, factors: &[Complex64]) -> Complex64 {
    let mut sum = Complex64::ZERO;
    for (column, right) in factors.iter().enumerate() {
        for (element, left) in matrix.col_as_slice_mut(column).iter_mut().zip(factors) {
            *element *= left * right;
            sum += *element;
        }
    }
    sum
}

/// Takes the reflection matrix `r` at the top of `below` through the interface at the lower side of `layer`.
fn join(layer: &Layer<'_>, below: &Waves, ky: f64, r: &Matrix, meeting: &mut Meeting) {
    let n = below.electric.len();
    let Meeting { up: e, down: h, across } = meeting;
    // (e₁, e₂) from s = I + R, and (−h₁, −h₂) from −δ = I − R, below the interface.
    for column in 0..2 * n {
        let (r1, r2) = r.col_as_slice(column).split_at(n);
        let (e1, e2) = e.col_as_slice_mut(column).split_at_mut(n);
        let (h1, h2) = h.col_as_slice_mut(column).split_at_mut(n);
        mix(&below.magnetic, [r1, r2], [h1, h2], -1.0);
        e1.copy_from_slice(r1);
        for ((to, from), factor) in e2.iter_mut().zip(r2).zip(&below.electric) {
            *to = from * factor;
        }
        let row = column % n;
        let [[xx, xy], [yx, yy]] = below.magnetic[row];
        if column < n {
            e1[row] += 1.0;
            h1[row] += xx;
            h2[row] += yx;
        } else {
            e2[row] += below.electric[row];
            h1[row] += xy;
            h2[row] += yy;
        }
    }
    if let Some(interface) = layer.floor {
        let (one, ky) = (Complex64::ONE, Complex64::from(ky));
        let lift = |below: &Matrix, above: &mut Matrix, first: &Matrix, second: &Matrix, cross: &Matrix| {
            let (b1, b2) = below.as_ref().split_at_row(n);
            let (a1, mut a2) = above.as_mut().split_at_row_mut(n);
            multiply_into(a1, Accum::Replace, first.as_ref(), b1, one);
            multiply_into(a2.as_mut(), Accum::Replace, second.as_ref(), b2, one);
            multiply_into(a2, Accum::Add, cross.as_ref(), b1, ky);
        };
        let [e_above, h_above] = across;
        lift(e, e_above, &interface.e1, &interface.second, &interface.e_cross);
        lift(h, h_above, &interface.second, &interface.h2, &interface.h_cross);
        std::mem::swap(e, e_above);
        std::mem::swap(h, h_above);
    }
    // Back to s and −δ, then to 2u and 2d.
    let mut delta = vec![Complex64::ZERO; 2 * n];
    for column in 0..2 * n {
        let (first, second) = delta.split_at_mut(n);
        let (h1, h2) = h.col_as_slice(column).split_at(n);
        mix(&layer.waves.from_magnetic, [h1, h2], [first, second], 1.0);
        for (element, factor) in e.col_as_slice_mut(column)[n..].iter_mut().zip(&layer.waves.from_electric) {
            *element *= factor;
        }
        combine(e.col_as_slice_mut(column), h.col_as_slice_mut(column), &delta);
    }
}

/// Writes s − (−δ) to `s` and s + (−δ) to `down`.
fn combine(s: &mut [Complex64], down: &mut [Complex64], minus_delta: &[Complex64]) {
    for ((s, down), delta) in s.iter_mut().zip(down).zip(minus_delta) {
        (*s, *down) = (*s - delta, *s + delta);
    }
}

/// Applies a 2 × 2 matrix times `sign` to each pair of elements.
fn mix(factors: &[[[Complex64; 2]; 2]], from: [&[Complex64]; 2], to: [&mut [Complex64]; 2], sign: f64) {
    let [to_x, to_y] = to;
    for (((to_x, to_y), (x, y)), [[xx, xy], [yx, yy]]) in
        to_x.iter_mut().zip(to_y).zip(from[0].iter().zip(from[1])).zip(factors)
    {
        *to_x = (xx * x + xy * y) * sign;
        *to_y = (yx * x + yy * y) * sign;
    }
}

/// [`join`] at k_y = 0 for one half of the waves: e₁ and h₂ of the first half, e₂ and h₁ of the second.
fn join_half(half: usize, layer: &Layer<'_>, below: &Waves, r: &Matrix, meeting: &mut Meeting) {
    let n = below.electric.len();
    let Meeting { up: e, down: h, across } = meeting;
    let factors = |waves: &Waves, i: usize| match half {
        0 => [Complex64::ONE, waves.magnetic[i][1][0]],
        _ => [waves.electric[i], waves.magnetic[i][0][1]],
    };
    for j in 0..n {
        for i in 0..n {
            let unit = if i == j { Complex64::ONE } else { Complex64::ZERO };
            let [electric, magnetic] = factors(below, i);
            e[(i, j)] = (unit + r[(i, j)]) * electric;
            h[(i, j)] = (unit - r[(i, j)]) * magnetic;
        }
    }
    if let Some(interface) = layer.floor {
        let (electric, magnetic) =
            if half == 0 { (&interface.e1, &interface.h2) } else { (&interface.second, &interface.second) };
        let [e_above, h_above] = across;
        multiply_into(e_above.as_mut(), Accum::Replace, electric.as_ref(), e.as_ref(), Complex64::ONE);
        multiply_into(h_above.as_mut(), Accum::Replace, magnetic.as_ref(), h.as_ref(), Complex64::ONE);
        std::mem::swap(e, e_above);
        std::mem::swap(h, h_above);
    }
    for i in 0..n {
        let [electric, magnetic] = factors(layer.waves, i).map(|factor| factor.inv());
        for j in 0..n {
            let (s, minus_delta) = (e[(i, j)] * electric, h[(i, j)] * magnetic);
            (e[(i, j)], h[(i, j)]) = (s - minus_delta, s + minus_delta);
        }
    }
}
