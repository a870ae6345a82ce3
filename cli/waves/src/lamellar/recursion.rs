//! Reflection matrices of stacks of layers, from the substrate upwards.

use std::ops::Range;

use faer::{Accum, MatMut};
use num_complex::Complex64;

use super::medium::{Interface, Magnetic, Waves};
use crate::error::WaveError;
use crate::linear::{Matrix, Rows, multiply_into, product, scale_rows};

/// Growth of waves, in a layer's evanescent ones or over several layers, up to which their reflection matrix is not yet
/// found. Amplitudes lose at most as many digits as it has.
const MAX_GROWTH: f64 = 1e3;

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
    pub floor: Option<Interface<'a>>,
}

impl Layer<'_> {
    /// exp(i k_z d) of some of the layer's waves.
    fn phases(&self, waves: Range<usize>) -> Vec<Complex64> {
        let turn = Complex64::new(0.0, self.thickness);
        self.waves.vertical[waves].iter().map(|kz| (turn * kz).exp()).collect()
    }
}

/// Waves at one height: `up` c goes up where `down` c goes down, for any c. So what lies below reflects `up` `down`⁻¹.
struct Meeting {
    up: Matrix,
    down: Matrix,
    /// Values of `up` and `down` on the other side of an interface.
    across: [Matrix; 2],
}

impl Meeting {
    /// Waves at the top of a substrate, of which none go up.
    fn new(waves: usize) -> Self {
        let empty = || Matrix::zeros(waves, waves);
        Self { up: empty(), down: Matrix::identity(waves, waves), across: [empty(), empty()] }
    }

    /// Largest element of `down` after [`Meeting::rise`]; 1 where `down` was found anew.
    fn growth(&self, phases: &[Complex64]) -> f64 {
        let factors: Vec<f64> = phases.iter().map(|phase| phase.norm_sqr().recip()).collect();
        let largest = |column: &[Complex64]| {
            column.iter().zip(&factors).fold(0.0, |most: f64, (down, factor)| most.max(down.norm_sqr() * factor))
        };
        let columns = (0..self.down.ncols()).map(|column| largest(self.down.col_as_slice(column)));
        0.5 * columns.fold(0.0, f64::max).sqrt()
    }

    /// From the bottom to the top of a layer by its `phases`, as halves.
    fn rise(&mut self, phases: &[Complex64]) {
        let (up, down): (Vec<_>, Vec<_>) = phases.iter().map(|phase| (phase * 0.5, phase.inv() * 0.5)).unzip();
        scale_rows(&mut self.up, &up);
        scale_rows(&mut self.down, &down);
    }

    /// From the bottom to the top of a layer by its `phases`, with a new c: what goes down at the top. Writes
    /// the transpose of `down` at the bottom to `factors`, in triangular factors.
    fn rise_anew(&mut self, phases: &[Complex64], mut factors: MatMut<'_, Complex64>) -> Result<Rows, WaveError> {
        factors.copy_from(self.down.transpose());
        let rows = Rows::factor(factors.as_mut());
        let [turned, _] = &mut self.across;
        turned.copy_from(self.up.transpose());
        rows.solve_in_place(factors.as_ref(), turned.as_mut());
        let mut sum = Complex64::ZERO;
        self.down.fill(Complex64::ZERO);
        for (j, right) in phases.iter().enumerate() {
            for (i, (element, left)) in self.up.col_as_slice_mut(j).iter_mut().zip(phases).enumerate() {
                *element = turned[(j, i)] * (left * right);
                sum += *element;
            }
            self.down[(j, j)] = Complex64::ONE;
        }
        if sum.is_finite() { Ok(rows) } else { Err(WaveError::Singular) }
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
    climb(stack, substrate, 0..2 * n, light, |layer, below, meeting| join(layer, below, ky, meeting))
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
        climb(stack, substrate, half * n..(half + 1) * n, light, |layer, below, meeting| {
            join_half(half, layer, below, meeting);
        })
    });
    let (p, s) = (p?, s?);
    let both = |p: [Column; 2], s: [Column; 2]| {
        let ([p0, p1], [s0, s1]) = (p, s);
        [[p0, s0].concat(), [p1, s1].concat()]
    };
    Ok(Leaving { up: both(p.up, s.up), down: both(p.down, s.down) })
}

/// Follows the waves up the stack, then `light` down. `join` takes waves from the top of those below through the lower
/// side of a layer, and doubles them; `waves` are those of each pattern that take part.
fn climb(
    stack: &[Layer<'_>],
    substrate: &Waves,
    waves: Range<usize>,
    light: Matrix,
    join: impl Fn(&Layer<'_>, &Waves, &mut Meeting),
) -> Result<Leaving, WaveError> {
    let (top, layers) = stack.split_first().ok_or(WaveError::Singular)?;
    let mut below = substrate;
    let n = waves.len();
    let mut meeting = Meeting::new(n);
    // Triangular factors side by side from the substrate upwards, in one allocation.
    let mut factors = Matrix::zeros(n, n * layers.len());
    let mut passed: Vec<(Rows, Vec<Complex64>)> = Vec::with_capacity(layers.len());
    for layer in layers.iter().rev() {
        join(layer, below, &mut meeting);
        let phases = layer.phases(waves.clone());
        if meeting.growth(&phases) <= MAX_GROWTH {
            meeting.rise(&phases);
        } else {
            let factors = factors.subcols_mut(passed.len() * n, n);
            passed.push((meeting.rise_anew(&phases, factors)?, phases));
        }
        below = layer.waves;
    }
    join(top, below, &mut meeting);
    // `meeting` is of twice the light.
    let twice = faer::Scale(Complex64::from(2.0));
    let mut down = light * twice;
    Rows::factor(meeting.down.as_mut()).solve_in_place(meeting.down.as_ref(), down.as_mut());
    let up = product(meeting.up.as_ref(), down.as_ref()) * faer::Scale(Complex64::from(0.5));
    for (i, (rows, phases)) in passed.iter().enumerate().rev() {
        scale_rows(&mut down, phases);
        rows.solve_left_in_place(factors.subcols(i * n, n), down.as_mut().transpose_mut());
        down *= twice;
    }
    let columns = |matrix: &Matrix| [0, 1].map(|column| matrix.col_as_slice(column).to_vec());
    Ok(Leaving { up: columns(&up), down: columns(&down) })
}

/// Takes waves at the top of `below` through the interface at the lower side of `layer`, and doubles them.
fn join(layer: &Layer<'_>, below: &Waves, ky: f64, meeting: &mut Meeting) {
    let n = below.electric.len();
    let Meeting { up: e, down: h, across } = meeting;
    // (e₁, e₂) from s = u + d, and (−h₁, −h₂) from −δ = d − u, below the interface.
    match &below.magnetic {
        Magnetic::Full(factors) => to_fields(below, e, h, |i, x, y| {
            let [[[xx, xy], [yx, yy]], _] = factors[i];
            [xx * x + xy * y, yx * x + yy * y]
        }),
        Magnetic::Crossed(factors) => to_fields(below, e, h, |i, x, y| [y, factors[i][0] * x]),
    }
    if let Some(interface) = layer.floor {
        let (one, ky) = (Complex64::ONE, Complex64::from(ky));
        let lift = |below: &Matrix, above: &mut Matrix, first, second, cross| {
            let (b1, b2) = below.as_ref().split_at_row(n);
            let (a1, mut a2) = above.as_mut().split_at_row_mut(n);
            multiply_into(a1, Accum::Replace, first, b1, one);
            multiply_into(a2.as_mut(), Accum::Replace, second, b2, one);
            multiply_into(a2, Accum::Add, cross, b1, ky);
        };
        let [e_above, h_above] = across;
        lift(e, e_above, interface.e1, interface.second, interface.e_cross);
        lift(h, h_above, interface.second, interface.h2, interface.h_cross);
        std::mem::swap(e, e_above);
        std::mem::swap(h, h_above);
    }
    // Back to s and −δ, then to 2u and 2d.
    match &layer.waves.magnetic {
        Magnetic::Full(factors) => to_waves(layer.waves, e, h, |i, x, y| {
            let [_, [[xx, xy], [yx, yy]]] = factors[i];
            [xx * x + xy * y, yx * x + yy * y]
        }),
        Magnetic::Crossed(factors) => to_waves(layer.waves, e, h, |i, x, y| [factors[i][1] * y, x]),
    }
}

/// Replaces the waves that go up and down by their fields (e₁, e₂) and (−h₁, −h₂). `magnetic` gives h from δ in a row.
fn to_fields(
    waves: &Waves,
    up: &mut Matrix,
    down: &mut Matrix,
    magnetic: impl Fn(usize, Complex64, Complex64) -> [Complex64; 2],
) {
    let n = waves.electric.len();
    for column in 0..2 * n {
        let (u1, u2) = up.col_as_slice_mut(column).split_at_mut(n);
        let (d1, d2) = down.col_as_slice_mut(column).split_at_mut(n);
        let first = u1.iter_mut().zip(d1);
        for (i, ((u1, d1), (u2, d2))) in first.zip(u2.iter_mut().zip(d2)).enumerate() {
            let [h1, h2] = magnetic(i, *d1 - *u1, *d2 - *u2);
            (*u1, *u2) = (*u1 + *d1, (*u2 + *d2) * waves.electric[i]);
            (*d1, *d2) = (h1, h2);
        }
    }
}

/// Replaces the fields (e₁, e₂) and (−h₁, −h₂) by twice the waves that go up and down. `magnetic` gives δ from h.
fn to_waves(
    waves: &Waves,
    e: &mut Matrix,
    h: &mut Matrix,
    magnetic: impl Fn(usize, Complex64, Complex64) -> [Complex64; 2],
) {
    let n = waves.electric.len();
    for column in 0..2 * n {
        let (e1, e2) = e.col_as_slice_mut(column).split_at_mut(n);
        let (h1, h2) = h.col_as_slice_mut(column).split_at_mut(n);
        let first = e1.iter_mut().zip(h1);
        for (i, ((e1, h1), (e2, h2))) in first.zip(e2.iter_mut().zip(h2)).enumerate() {
            let (s1, s2) = (*e1, *e2 * waves.from_electric[i]);
            let [delta1, delta2] = magnetic(i, *h1, *h2);
            (*e1, *e2) = (s1 - delta1, s2 - delta2);
            (*h1, *h2) = (s1 + delta1, s2 + delta2);
        }
    }
}

/// [`join`] at k_y = 0 for one half of the waves: e₁ and h₂ of the first half, e₂ and h₁ of the second.
fn join_half(half: usize, layer: &Layer<'_>, below: &Waves, meeting: &mut Meeting) {
    let Meeting { up: e, down: h, across } = meeting;
    let factors = |waves: &Waves, i: usize| match (half, &waves.magnetic) {
        (0, Magnetic::Full(factors)) => [Complex64::ONE, factors[i][0][1][0]],
        (0, Magnetic::Crossed(factors)) => [Complex64::ONE, factors[i][0]],
        (_, Magnetic::Full(factors)) => [waves.electric[i], factors[i][0][0][1]],
        (_, Magnetic::Crossed(_)) => [waves.electric[i], Complex64::ONE],
    };
    for i in 0..below.electric.len() {
        let [electric, magnetic] = factors(below, i);
        for (u, d) in e.row_mut(i).iter_mut().zip(h.row_mut(i).iter_mut()) {
            (*u, *d) = ((*d + *u) * electric, (*d - *u) * magnetic);
        }
    }
    if let Some(interface) = layer.floor {
        let (electric, magnetic) =
            if half == 0 { (interface.e1, interface.h2) } else { (interface.second, interface.second) };
        let [e_above, h_above] = across;
        multiply_into(e_above.as_mut(), Accum::Replace, electric, e.as_ref(), Complex64::ONE);
        multiply_into(h_above.as_mut(), Accum::Replace, magnetic, h.as_ref(), Complex64::ONE);
        std::mem::swap(e, e_above);
        std::mem::swap(h, h_above);
    }
    for i in 0..below.electric.len() {
        let [electric, magnetic] = factors(layer.waves, i).map(|factor| factor.inv());
        for (e, h) in e.row_mut(i).iter_mut().zip(h.row_mut(i).iter_mut()) {
            let (s, minus_delta) = (*e * electric, *h * magnetic);
            (*e, *h) = (s - minus_delta, s + minus_delta);
        }
    }
}
