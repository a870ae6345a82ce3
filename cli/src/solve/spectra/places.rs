//! Means over the places of a surface whose layers vary in thickness.
//!
//! The mean over a Gaussian is taken by the trapezoidal rule, which converges exponentially: a fringe exp(iκx) of x,
//! the thickness in standard deviations, comes out as it should but for terms exp(−(2πj/h − κ)²/2), j ≥ 1, for a step
//! h. A step that is too long for a fringe therefore gives a wrong mean, and another step another one, unless they
//! divide each other. So steps shrink by the golden ratio until two means agree.

use goniochrome::simd::complex::Polarised;

use super::one_place::spectra;
use super::request::SpectraRequest;
use super::samples::{Sample, Spectra};
use crate::solve::planar_scene::{PlanarScene, SPREAD_SIGMAS};
use crate::support::error::{Error, Result};
use crate::support::parallel;

/// First step in standard deviations, and the factor from step to step.
const STEPS: [f64; 2] = [0.5, 0.618_033_988_749_895];
/// Largest difference between two rules at which the finer one is taken; its own error is far smaller, and a tenth of
/// the promised 1e-4 leaves room for chance.
const AGREED: f64 = 1e-5;
/// Largest number of places at which a row of samples is computed.
const MAX_PLACES: usize = 40_000;

/// Spectra averaged over the places of a surface.
///
/// # Errors
/// As of [`super::spectra`].
pub(super) fn mean(
    planar: &PlanarScene<'_>,
    theta_deg: &[f64],
    wavelength_nm: &[f64],
    request: &SpectraRequest,
    progress: &(dyn Fn() + Sync),
) -> Result<Spectra> {
    let one = SpectraRequest { threads: 1, ..*request };
    let mut rows: Vec<Option<Result<Spectra>>> = theta_deg.iter().map(|_| None).collect();
    let work = rows.iter_mut().zip(theta_deg);
    parallel::for_each(
        request.threads,
        work,
        || (),
        |(), (out, theta)| {
            *out = Some(row(planar, *theta, wavelength_nm, &one));
            progress();
        },
    );
    let mut mean = Spectra {
        theta_deg: theta_deg.to_vec(),
        wavelength_nm: wavelength_nm.to_vec(),
        samples: Vec::with_capacity(theta_deg.len() * wavelength_nm.len()),
        fell_back: 0,
        recomputed: 0,
    };
    for row in rows.into_iter().flatten() {
        let row = row?;
        mean.samples.extend(row.samples);
        mean.fell_back += row.fell_back;
        mean.recomputed += row.recomputed;
    }
    Ok(mean)
}

/// The mean at one angle.
fn row(planar: &PlanarScene<'_>, theta: f64, wavelength_nm: &[f64], request: &SpectraRequest) -> Result<Spectra> {
    let mut step = STEPS[0];
    let mut coarser: Option<Spectra> = None;
    loop {
        let finer = by_rule(planar, theta, wavelength_nm, request, step)?;
        if coarser.as_ref().is_some_and(|coarser| agree(coarser, &finer)) {
            return Ok(finer);
        }
        coarser = Some(finer);
        step *= STEPS[1];
    }
}

/// The mean by the rule of a step.
fn by_rule(
    planar: &PlanarScene<'_>,
    theta: f64,
    wavelength_nm: &[f64],
    request: &SpectraRequest,
    step: f64,
) -> Result<Spectra> {
    let spreads = planar.spreads().len();
    let side = 2 * (SPREAD_SIGMAS / step) as usize + 1;
    let count = u32::try_from(spreads).ok().and_then(|spreads| side.checked_pow(spreads));
    let Some(count) = count.filter(|count| *count <= MAX_PLACES) else {
        return Err(Error::failed(format_args!(
            "{}: the mean over thicknesses at {theta}° needs more than {MAX_PLACES} of them; name spread_nm of fewer layers, a \
             smaller one, or angles farther from 90°",
            planar.scene().name
        )));
    };
    let middle = (side / 2) as f64;
    let samples = vec![Sample::default(); wavelength_nm.len()];
    let (theta_deg, wavelength) = (vec![theta], wavelength_nm.to_vec());
    let mut mean = Spectra { theta_deg, wavelength_nm: wavelength, samples, fell_back: 0, recomputed: 0 };
    let (mut whole, mut deviations) = (0.0, vec![0.0; spreads]);
    for place in 0..count {
        let mut rest = place;
        for deviation in &mut deviations {
            *deviation = step * ((rest % side) as f64 - middle);
            rest /= side;
        }
        let weight = (-0.5 * deviations.iter().map(|x| x * x).sum::<f64>()).exp();
        let here = spectra(&planar.at_place(&deviations), &[theta], wavelength_nm, request, &|| ())?;
        whole += weight;
        for (sum, sample) in mean.samples.iter_mut().zip(&here.samples) {
            *sum = added(sum, &scaled(sample, weight));
        }
        mean.fell_back = mean.fell_back.max(here.fell_back);
        mean.recomputed = mean.recomputed.max(here.recomputed);
    }
    mean.samples.iter_mut().for_each(|sample| *sample = scaled(sample, 1.0 / whole));
    Ok(mean)
}

fn scaled(sample: &Sample, by: f64) -> Sample {
    let all = |power: Polarised<f64>| power.map(|x| by * x);
    Sample {
        reflectance: all(sample.reflectance),
        transmittance: all(sample.transmittance),
        truncated: by * sample.truncated,
        imbalance: by * sample.imbalance,
    }
}

fn added(a: &Sample, b: &Sample) -> Sample {
    let both = |a: Polarised<f64>, b: Polarised<f64>| a.zip(b, |a, b| a + b);
    Sample {
        reflectance: both(a.reflectance, b.reflectance),
        transmittance: both(a.transmittance, b.transmittance),
        truncated: a.truncated + b.truncated,
        imbalance: a.imbalance + b.imbalance,
    }
}

/// Whether two means differ by rounding alone.
fn agree(a: &Spectra, b: &Spectra) -> bool {
    let near = |a: Polarised<f64>, b: Polarised<f64>| (a.s - b.s).abs() <= AGREED && (a.p - b.p).abs() <= AGREED;
    let mut pairs = a.samples.iter().zip(&b.samples);
    pairs.all(|(a, b)| near(a.reflectance, b.reflectance) && near(a.transmittance, b.transmittance))
}
