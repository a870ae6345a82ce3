//! The choice of the wavelengths that the colours of a scene need.
//!
//! Intervals are halved, the worst first, until the colour at every angle has converged. Two errors of the kept samples
//! must be small, both as ΔE2000 against the integral over the wavelength ([`crate::solve::integral`]): the error of
//! the colour that they sum to, and the error to expect if those of the intervals had independent signs. The second
//! guards against errors that cancel by chance.

use goniochrome::colour::{Illuminant, SpectrumCubic, xyz};

use crate::colour::difference::{delta_e, lab_of_xyz};
use crate::solve::integral::{Integral, Spectrum, Weights, even};
use crate::solve::planar_scene::PlanarScene;
use crate::solve::spectra::SpectraRequest;
use crate::support::error::Result;
use crate::table::mirror::{MAX_SAMPLES, MAX_WAVELENGTHS};

/// The largest ΔE2000 of a colour that has converged. Differences below 1 are hardly seen.
pub const MAX_DELTA_E: f64 = 0.05;
/// The part of the sum of squared errors whose intervals each round halves.
const WORST_PART: f64 = 0.75;
/// The largest number of passes over all angles; the first finds nearly everything.
const MAX_PASSES: usize = 4;
/// The L* of white, for errors of invisible reflectance.
const WHITE: f64 = 100.0;

/// Chosen wavelengths, and the colours that they approximate.
#[derive(Debug, Clone, PartialEq)]
pub struct Choice {
    /// Wavelengths, increasing, at most [`MAX_WAVELENGTHS`].
    pub wavelength_nm: Vec<f64>,
    /// XYZ of the integral at each angle.
    pub xyz: Vec<[f64; 3]>,
}

/// Chooses the wavelengths in a range that the colours of a scene need at all of the given angles.
///
/// # Errors
/// A medium without data in the range; an ambient medium that absorbs too much; an optical path of more than some
/// millimetres.
pub fn choose(
    planar: &PlanarScene<'_>,
    theta_deg: &[f64],
    range_nm: [f64; 2],
    illuminant: Illuminant,
    request: &SpectraRequest,
) -> Result<Choice> {
    let max = max_wavelengths(theta_deg.len());
    let integral = Integral::new(planar, range_nm, illuminant, request)?;
    let mut choice = Choice { wavelength_nm: even(range_nm), xyz: Vec::new() };
    // Wavelengths added for one angle change the cubics at the others.
    for _ in 0..MAX_PASSES {
        let before = choice.wavelength_nm.len();
        choice.xyz.clear();
        integral.each(
            theta_deg,
            &mut choice,
            |choice| &choice.wavelength_nm,
            |choice, spectrum, weights| {
                choice.xyz.push(xyz(&weights.xyz, spectrum.reflectance.iter().copied()));
                refine(&mut choice.wavelength_nm, spectrum, weights, max);
            },
        )?;
        if choice.wavelength_nm.len() == before || choice.wavelength_nm.len() == max || theta_deg.len() == 1 {
            break;
        }
    }
    Ok(choice)
}

/// The largest number of wavelengths that a table of so many angles holds.
#[must_use]
pub fn max_wavelengths(angles: usize) -> usize {
    MAX_WAVELENGTHS.min(MAX_SAMPLES / angles.max(1))
}

/// Adds wavelengths of a spectrum to the kept ones until its colour has converged, or there are `max` of them.
fn refine(kept: &mut Vec<f64>, spectrum: &Spectrum, weights: &Weights, max: usize) {
    while let Some(halves) = ChoiceErrors::new(kept, spectrum, weights).worst_halves() {
        let room = max.saturating_sub(kept.len());
        if room == 0 {
            return;
        }
        kept.extend(halves.into_iter().take(room));
        kept.sort_by(f64::total_cmp);
    }
}

/// An interval between two kept samples, and the error of its cubic.
struct Interval {
    /// Error in XYZ.
    colour: [f64; 3],
    /// Error in the mean of invisible reflectance.
    invisible: f64,
    /// The sample nearest to the middle, if any sample lies inside.
    half_nm: Option<f64>,
}

impl Interval {
    fn square(&self) -> f64 {
        self.colour.iter().map(|x| x * x).sum::<f64>() + self.invisible * self.invisible
    }
}

/// The errors of a choice of samples against a finely sampled spectrum.
struct ChoiceErrors {
    intervals: Vec<Interval>,
    /// ΔE2000 of the sum of errors, or of its expectation if that is larger.
    delta_e: f64,
}

impl ChoiceErrors {
    /// Measures the errors of the samples at `kept`, which are wavelengths of the spectrum.
    fn new(kept: &[f64], spectrum: &Spectrum, weights: &Weights) -> Self {
        let (nm, rho) = (&spectrum.wavelength_nm, &spectrum.reflectance);
        let at = |wanted: f64| nm.partition_point(|&x| x < wanted);
        let values: Vec<f64> = kept.iter().map(|&wanted| rho[at(wanted)]).collect();
        let mut intervals = Vec::with_capacity(kept.len());
        for (i, pair) in kept.windows(2).enumerate() {
            let Some(cubic) = SpectrumCubic::new(kept, i) else { continue };
            let corners = cubic.index().map(|j| values[j]);
            let (from, to) = (at(pair[0]) + 1, at(pair[1]));
            let mut interval = Interval { colour: [0.0; 3], invisible: 0.0, half_nm: None };
            for j in from..to {
                let predicted: f64 =
                    cubic.shares(nm[j]).iter().zip(corners).map(|(share, corner)| share * corner).sum();
                let missed = rho[j] - predicted;
                for (sum, weight) in interval.colour.iter_mut().zip(weights.xyz[j]) {
                    *sum += weight * missed;
                }
                interval.invisible += weights.invisible[j] * missed;
            }
            let middle = 0.5 * (pair[0] + pair[1]);
            interval.half_nm =
                nm[from..to].iter().copied().min_by(|a, b| (a - middle).abs().total_cmp(&(b - middle).abs()));
            intervals.push(interval);
        }
        let colour = xyz(&weights.xyz, rho.iter().copied());
        let white = xyz(&weights.xyz, rho.iter().map(|_| 1.0));
        let delta_e = difference(&intervals, colour, white);
        Self { intervals, delta_e }
    }

    /// The wavelengths to sample next; none if the colour has converged or nothing finer is known.
    fn worst_halves(&self) -> Option<Vec<f64>> {
        if self.delta_e <= MAX_DELTA_E {
            return None;
        }
        let mut worst: Vec<(f64, f64)> = self
            .intervals
            .iter()
            .filter_map(|interval| Some((interval.square(), interval.half_nm?)))
            .filter(|(square, _)| *square > 0.0)
            .collect();
        worst.sort_by(|a, b| b.0.total_cmp(&a.0));
        let enough = WORST_PART * worst.iter().map(|(square, _)| square).sum::<f64>();
        let mut sum = 0.0;
        let halves: Vec<f64> = worst
            .into_iter()
            .take_while(|(square, _)| {
                let before = sum;
                sum += square;
                before < enough
            })
            .map(|(_, half)| half)
            .collect();
        (!halves.is_empty()).then_some(halves)
    }
}

/// The ΔE2000 of all errors together or of their root sum of squares, whichever is larger; in the root, X and Z may
/// have any signs beside Y.
fn difference(intervals: &[Interval], colour: [f64; 3], white: [f64; 3]) -> f64 {
    let mut sum = [0.0; 3];
    let mut squares = [0.0; 3];
    let mut invisible = 0.0;
    for interval in intervals {
        for c in 0..3 {
            sum[c] += interval.colour[c];
            squares[c] += interval.colour[c] * interval.colour[c];
        }
        invisible += interval.invisible * interval.invisible;
    }
    let invisible = WHITE * f64::sqrt(invisible);
    if white[1] <= 0.0 {
        return invisible;
    }
    let [x, y, z] = squares.map(f64::sqrt);
    let exact = lab_of_xyz(colour, white);
    let moved = [sum, [x, y, z], [x, y, -z], [-x, y, z], [-x, y, -z]];
    let moved = moved.map(|by| delta_e(exact, lab_of_xyz(std::array::from_fn(|c| colour[c] - by[c]), white)));
    moved.into_iter().fold(invisible, f64::max)
}

#[cfg(test)]
#[path = "refine_tests.rs"]
mod tests;
