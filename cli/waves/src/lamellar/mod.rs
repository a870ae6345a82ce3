//! Fourier modal method for profiles that do not depend on y, at any incidence.
//!
//! Layers are joined from the substrate upwards by the reflection matrix of all that lies below, so that no exponential
//! grows far: opaque and thick layers are safe.

mod medium;
mod recursion;

use std::f64::consts::TAU;

use num_complex::Complex64;

use crate::error::WaveError;
use crate::fields::{Tangential, admittance, incident, order, vertical};
use crate::linear::Matrix;
use crate::profile::{Profile, Slice};
use crate::response::{Order, Response};

use medium::{Interface, Modal, Pattern, Spectrum, Waves};
use recursion::{Column, Layer, propagate, propagate_apart};

/// |k_y| in units of k₀ up to which s and p are solved apart, as at k_y = 0. The fields of one in the other are
/// proportional to k_y, so that amplitudes lose at most some of these.
const MAX_APART: f64 = 1e-12;

/// Distance of edges, as a share of the period, that is rounding of their positions and widths. Efficiencies change by
/// no more than some of it.
const MAX_EDGE_DIFFERENCE: f64 = 1e-12;

/// Modes of all slices of a profile at one wavelength and one k_x. They serve every k_y.
#[derive(Debug)]
pub struct Modes {
    above: f64,
    below: Complex64,
    max_order: usize,
    /// Tangential wavevectors along x of orders −M…M, in units of k₀.
    kx: Vec<f64>,
    decompositions: usize,
    /// Spectra of patterns that differ by more than a shift along x; the first two are of the half-spaces.
    spectra: Vec<Spectrum>,
    /// Matrices of the interfaces between different pairs of patterns, side by side in one allocation.
    interfaces: Matrix,
    /// Layers from the top between the half-spaces: spectrum, and thickness in units of 1/k₀.
    layers: Vec<(usize, f64)>,
    /// Interface at the top of each layer and of the substrate, `None` between two uniform media.
    joints: Vec<Option<usize>>,
}

impl Modes {
    /// Decomposes the slices of `profile` for light of tangential wavevector (`kx0`, any k_y) in units of k₀, in orders
    /// −`max_order`…`max_order`. Slices that are equal, or differ by a shift along x, share one decomposition.
    ///
    /// # Errors
    /// [`WaveError::Profile`] or [`WaveError::Light`] if an argument is out of its domain, [`WaveError::Singular`] if a
    /// decomposition fails.
    pub fn new(profile: &Profile, wavelength_nm: f64, kx0: f64, max_order: usize) -> Result<Self, WaveError> {
        profile.check()?;
        if !(wavelength_nm > 0.0 && wavelength_nm.is_finite() && kx0.is_finite()) {
            return Err(WaveError::Light);
        }
        let step = wavelength_nm / profile.period_nm;
        let kx: Vec<f64> = indices(max_order).map(|m| f64::from(m).mul_add(step, kx0)).collect();
        let mut patterns = vec![Pattern::Uniform(Complex64::from(profile.above)), Pattern::Uniform(profile.below)];
        let mut spectra: Vec<Spectrum> = patterns.iter().map(Spectrum::from).collect();
        let mut spectrum_of = vec![0, 1];
        let mut layers: Vec<(usize, f64)> = Vec::new();
        let mut shapes: Vec<Shape> = Vec::new();
        let mut decompositions = 0;
        for slice in &profile.slices {
            let shape = Shape::new(slice, profile.period_nm);
            let shifts = || shapes.iter().map(|known| shape.shift_from(known));
            let index = if let Some(found) = shifts().position(|shift| shift == Some(0.0)) {
                found + 2
            } else {
                let mut spectrum = spectra.len();
                patterns.push(if shape.media.len() == 1 {
                    Pattern::Uniform(shape.media[0].1)
                } else if let Some((found, shift)) = shifts().enumerate().find_map(|(i, shift)| Some((i, shift?)))
                    && let Pattern::Modal(known) = &patterns[found + 2]
                {
                    spectrum = spectrum_of[found + 2];
                    Pattern::Modal(Box::new(known.shifted(shift)))
                } else {
                    decompositions += 1;
                    let (edges, eta): (Vec<f64>, Vec<Complex64>) = shape.media.iter().copied().unzip();
                    Pattern::Modal(Box::new(Modal::new(&edges, &eta, &kx)?))
                });
                if spectrum == spectra.len() {
                    spectra.extend(patterns.last().map(Spectrum::from));
                }
                spectrum_of.push(spectrum);
                shapes.push(shape);
                patterns.len() - 1
            };
            let thickness = slice.thickness_nm * TAU / wavelength_nm;
            match layers.last_mut() {
                Some((last, total)) if *last == index => *total += thickness,
                _ => layers.push((index, thickness)),
            }
        }
        let mut pairs: Vec<[usize; 2]> = Vec::new();
        let mut joints = Vec::with_capacity(layers.len() + 1);
        let mut upper = 0;
        for lower in layers.iter().map(|(index, _)| *index).chain([1]) {
            let pair = [upper, lower];
            let uniform = pair.iter().all(|&index| matches!(patterns[index], Pattern::Uniform(_)));
            joints.push((!uniform).then(|| {
                pairs.iter().position(|known| *known == pair).unwrap_or_else(|| {
                    pairs.push(pair);
                    pairs.len() - 1
                })
            }));
            upper = lower;
        }
        let columns = Interface::MATRICES * kx.len();
        let mut interfaces = Matrix::zeros(kx.len(), columns * pairs.len());
        for (i, [upper, lower]) in pairs.into_iter().enumerate() {
            let all = interfaces.subcols_mut(i * columns, columns);
            Interface::write(&patterns[upper], &patterns[lower], &kx, all);
        }
        Ok(Self {
            above: profile.above,
            below: profile.below,
            max_order,
            kx,
            decompositions,
            spectra,
            interfaces,
            layers: layers.into_iter().map(|(pattern, thickness)| (spectrum_of[pattern], thickness)).collect(),
            joints,
        })
    }

    /// Number of decompositions: one for each slice of several media that differs from the others by more than a shift
    /// along x.
    #[must_use]
    pub fn decompositions(&self) -> usize {
        self.decompositions
    }

    /// Orders for light of tangential wavevector (k_x0, `ky`), in s and in p.
    ///
    /// # Errors
    /// [`WaveError::Light`] if the light does not travel in the half-space above, [`WaveError::Singular`] if the
    /// equations have no finite solution.
    pub fn response(&self, ky: f64) -> Result<Response, WaveError> {
        self.response_at(0, ky)
    }

    /// Orders for light of tangential wavevector (k_x0 + `shift` λ/Λ, `ky`), |`shift`| ≤ M, from the same
    /// decompositions. Orders are counted from that light: numbers −M − `shift`…M − `shift`.
    ///
    /// # Errors
    /// As [`Modes::response`]; [`WaveError::Light`] too if there is no such order.
    pub fn response_at(&self, shift: i32, ky: f64) -> Result<Response, WaveError> {
        let arriving = indices(self.max_order).position(|m| m == shift).ok_or(WaveError::Light)?;
        let q0 = [self.kx[arriving], ky];
        let incident_vertical = vertical(Complex64::from(self.above), q0).re;
        // Infinities and NaN fail too.
        if !(q0[0].hypot(q0[1]) < self.above && incident_vertical > 0.0) {
            return Err(WaveError::Light);
        }
        let waves: Vec<Waves> = self.spectra.iter().map(|spectrum| Waves::new(spectrum, &self.kx, ky)).collect();
        let columns = Interface::MATRICES * self.kx.len();
        let tops = [(0, 0.0)].into_iter().chain(self.layers.iter().copied());
        let stack: Vec<Layer<'_>> = tops
            .zip(&self.joints)
            .map(|((spectrum, thickness), &joint)| Layer {
                waves: &waves[spectrum],
                thickness,
                floor: joint.map(|joint| Interface::of(self.interfaces.subcols(joint * columns, columns))),
            })
            .collect();
        let light = incident(self.above, q0, incident_vertical).map(|wave| wave.electric);
        let columns = if ky.abs() <= MAX_APART {
            propagate_apart(&stack, &waves[1], arriving, light)?
        } else {
            propagate(&stack, &waves[1], ky, arriving, light)?
        };
        let [reflected, transmitted] = [
            self.orders(Complex64::from(self.above), [shift, 1], ky, &columns.up),
            self.orders(self.below, [shift, -1], ky, &columns.down),
        ];
        let sound =
            |orders: &[Order]| orders.iter().all(|order| order.jones.as_flattened().iter().all(|j| j.is_finite()));
        if !(sound(&reflected) && sound(&transmitted)) {
            return Err(WaveError::Singular);
        }
        let half_spaces = [Complex64::from(self.above), self.below];
        Ok(Response { incident_vertical, half_spaces, reflected, transmitted })
    }

    /// Orders of a half-space from the electric fields of its waves, which go up for `sign` 1 and down for −1, counted
    /// from order `shift`.
    fn orders(&self, eta: Complex64, [shift, sign]: [i32; 2], ky: f64, columns: &[Column; 2]) -> Vec<Order> {
        let n = self.kx.len();
        let of_order = |(i, m): (usize, i32)| {
            let q = [self.kx[i], ky];
            let [[xx, xy], [yx, yy]] =
                admittance(q, vertical(eta, q)).map(|row| row.map(|element| element * f64::from(sign)));
            let fields = columns.each_ref().map(|column| {
                let electric @ [x, y] = [column[i], column[n + i]];
                Tangential { electric, magnetic: [xx * x + xy * y, yx * x + yy * y] }
            });
            order([m - shift, 0], eta, q, fields)
        };
        indices(self.max_order).enumerate().map(of_order).collect()
    }
}

/// Media of a slice along x, in shares of the period.
#[derive(Debug)]
struct Shape {
    /// Where each medium begins, and its index; neighbours differ.
    media: Vec<(f64, Complex64)>,
}

impl Shape {
    fn new(slice: &Slice, period: f64) -> Self {
        let n = slice.eta.len();
        let mut media: Vec<(f64, Complex64)> = (0..slice.edges_nm.len())
            .filter(|&i| slice.eta[i] != slice.eta[(i + n - 1) % n])
            .map(|i| (slice.edges_nm[i] / period, slice.eta[i]))
            .collect();
        if media.is_empty() {
            media.push((0.0, slice.eta[0]));
        }
        Self { media }
    }

    /// Shift along x from `other` to this shape, in shares of the period, 0 where they are equal. `None` if they differ
    /// otherwise.
    fn shift_from(&self, other: &Self) -> Option<f64> {
        let n = self.media.len();
        if n != other.media.len() {
            return None;
        }
        if n == 1 {
            return (self.media[0].1 == other.media[0].1).then_some(0.0);
        }
        let turned = |turn: usize| {
            let shift = self.media[turn].0 - other.media[0].0;
            let same = (0..n).all(|i| {
                let ((x, eta), (y, other_eta)) = (self.media[(i + turn) % n], other.media[i]);
                let away = x - y - shift;
                eta == other_eta && (away - away.round()).abs() <= MAX_EDGE_DIFFERENCE
            });
            same.then_some(if shift.abs() <= MAX_EDGE_DIFFERENCE { 0.0 } else { shift })
        };
        (0..n).find_map(turned)
    }
}

/// Numbers −M…M of orders.
fn indices(max_order: usize) -> std::ops::RangeInclusive<i32> {
    let last = i32::try_from(max_order).unwrap_or(i32::MAX);
    -last..=last
}
