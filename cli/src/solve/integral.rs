//! Reflectance of a planar scene, sampled so finely over the wavelength that its colour is that of the integral.
//!
//! Samples lie on a tree: intervals of [`BASE_STEP_NM`] are halved as often as the optical path requires, and further
//! where the spectrum has narrower features. Samples are computed in closed form and double precision, which takes less
//! than a microsecond each. [`crate::solve::refine`] chooses from them the samples that a table keeps.

use std::borrow::Cow;

use goniochrome::colour::{Illuminant, Quadrature, SpectrumCubic, VISIBLE_NM, xyz, xyz_weights};

use crate::solve::planar_scene::PlanarScene;
use crate::solve::precision::Precision;
use crate::solve::spectra::{Method, Sample, SpectraRequest, spectra};
use crate::support::error::{Error, Result};

/// The coarsest step between samples. Observer, illuminants and the dispersion of materials are smooth over it.
pub const BASE_STEP_NM: f64 = 5.0;

/// Samples in each fringe of the longest optical path. Some of them must lie in the fringe's line: a film of n = 3 on a
/// good metal has lines of a tenth of the fringe at 88°.
const SAMPLES_PER_FRINGE: f64 = 32.0;
/// Halvings of [`BASE_STEP_NM`] for a single film, whose lines are as wide as [`SAMPLES_PER_FRINGE`] assumes.
const MIN_LEVELS_FILM: u32 = 2;
/// Halvings for several films, which may reflect in lines of any width: steps of 0.16 nm. A line of 0.006 nm or more
/// still changes a sample enough to be found, and a narrower one is less than 10⁻⁴ of the visible range.
const MIN_LEVELS_FILMS: u32 = 5;
/// The largest number of halvings: steps of 0.15 pm, more than the six decimals that name a channel can tell apart.
const MAX_LEVELS: u32 = 15;
/// The largest number of samples at one angle: 32 in each fringe of an optical path of 12 mm.
const MAX_FINE: usize = 1 << 20;
/// The largest error of an interval's cubic, as a part of white; intervals are halved until then. A thousand such
/// errors make a ΔE2000 below 0.1 for a colour half as bright as white, even if all have one sign.
const MAX_INTERVAL_ERROR: f64 = 1e-6;
/// The ratio of two errors: of the cubic through the four neighbours of a sample, at the sample; and of the cubic
/// through the sample, half-way to its neighbour.
const LEFT_OUT_RATIO: f64 = 7.0;
/// The largest number of samples, of all angles together, that are in memory at once.
const MAX_HELD: usize = 1 << 20;

/// The spectrum of unpolarised reflectance at one angle.
#[derive(Debug, Clone, PartialEq)]
pub struct Spectrum {
    /// Wavelengths, increasing.
    pub wavelength_nm: Vec<f64>,
    /// Reflectance at each wavelength.
    pub reflectance: Vec<f64>,
}

/// The weights of samples at a list of wavelengths.
#[derive(Debug, Clone, PartialEq)]
pub struct Weights {
    /// Weights in X, Y and Z; all 0 where no wavelength is visible.
    pub xyz: Vec<[f64; 3]>,
    /// Weights in the mean reflectance at invisible wavelengths.
    pub invisible: Vec<f64>,
}

impl Weights {
    /// Weights of increasing wavelengths.
    #[must_use]
    pub fn new(wavelength_nm: &[f64], illuminant: Illuminant) -> Self {
        let mut colour = vec![[0.0; 3]; wavelength_nm.len()];
        if xyz_weights(wavelength_nm, illuminant, Quadrature::Interpolated, &mut colour).is_err() {
            colour.fill([0.0; 3]);
        }
        let [first, last] = VISIBLE_NM.map(f64::from);
        let mut invisible = vec![0.0; wavelength_nm.len()];
        let mut width = 0.0;
        for (i, pair) in wavelength_nm.windows(2).enumerate() {
            if pair[1] <= first || pair[0] >= last {
                let step = pair[1] - pair[0];
                width += step;
                invisible[i] += 0.5 * step;
                invisible[i + 1] += 0.5 * step;
            }
        }
        invisible.iter_mut().for_each(|weight| *weight /= f64::max(width, f64::MIN_POSITIVE));
        Self { xyz: colour, invisible }
    }

    /// The largest weight of a sample: the part of white that an error of 1 in it makes.
    fn max_weight(&self, i: usize) -> f64 {
        self.xyz[i].iter().fold(self.invisible[i], |max, x| max.max(x.abs()))
    }
}

/// The integral over the wavelength for the colours of a planar scene in the light of an illuminant.
#[derive(Debug)]
pub struct Integral<'p, 's> {
    planar: &'p PlanarScene<'s>,
    request: SpectraRequest,
    illuminant: Illuminant,
    base: Vec<f64>,
    /// Weights of the base.
    weights: Weights,
}

impl<'p, 's> Integral<'p, 's> {
    /// Places the samples that the optical path requires.
    ///
    /// # Errors
    /// A medium without data in the range; an optical path of more than some millimetres.
    pub fn new(
        planar: &'p PlanarScene<'s>,
        range_nm: [f64; 2],
        illuminant: Illuminant,
        request: &SpectraRequest,
    ) -> Result<Self> {
        // Light crosses the stack twice.
        let path_nm = 2.0 * planar.longest_optical_path_nm(range_nm)?;
        let min_levels = if planar.layers() > 1 { MIN_LEVELS_FILMS } else { MIN_LEVELS_FILM };
        let mut base = Vec::new();
        for pair in even(range_nm).windows(2) {
            let width = pair[1] - pair[0];
            let fringe = pair[0] * pair[0] / path_nm.max(f64::MIN_POSITIVE);
            let levels = (width * SAMPLES_PER_FRINGE / fringe).log2().ceil().max(f64::from(min_levels));
            let parts = levels.exp2();
            if base.len() as f64 + parts > MAX_FINE as f64 {
                return Err(Error::failed(format_args!(
                    "{}: an optical path of {:.0} nm has more fringes than can be summed; make the layer the substrate, or give \
                     the wavelengths by start:end:step",
                    planar.scene().name,
                    path_nm / 2.0
                )));
            }
            base.extend((0..parts as u32).map(|i| pair[0] + width * f64::from(i) / parts));
        }
        base.push(range_nm[1]);
        let weights = Weights::new(&base, illuminant);
        let request = SpectraRequest { method: Method::Stack, precision: Precision::F64, ..*request };
        Ok(Self { planar, request, illuminant, base, weights })
    }

    /// Calls `take` with the spectrum at each angle, in order, and the weights of its samples. `also` names wavelengths
    /// that the next spectrum must contain: nodes of the same tree.
    ///
    /// # Errors
    /// A medium without data at a wavelength; an ambient medium that absorbs too much.
    pub fn each<S>(
        &self,
        theta_deg: &[f64],
        state: &mut S,
        also: impl Fn(&S) -> &[f64],
        mut take: impl FnMut(&mut S, &Spectrum, &Weights),
    ) -> Result<()> {
        for chunk in theta_deg.chunks((MAX_HELD / self.base.len()).max(1)) {
            let shared = spectra(self.planar, chunk, &self.base, &self.request, &|| ())?;
            for (angle, &theta) in chunk.iter().enumerate() {
                let reflectance = shared.row(angle).iter().map(Sample::mean_reflectance).collect();
                let mut spectrum = Spectrum { wavelength_nm: self.base.clone(), reflectance };
                let missing: Vec<f64> = also(state)
                    .iter()
                    .copied()
                    .filter(|nm| spectrum.wavelength_nm.binary_search_by(|x| x.total_cmp(nm)).is_err())
                    .collect();
                self.insert(&mut spectrum, theta, &missing)?;
                let weights = self.resolve(&mut spectrum, theta)?;
                take(state, &spectrum, &weights);
            }
        }
        Ok(())
    }

    /// XYZ of the integral at each angle.
    ///
    /// # Errors
    /// A medium without data at a wavelength; an ambient medium that absorbs too much.
    pub fn colours(&self, theta_deg: &[f64]) -> Result<Vec<[f64; 3]>> {
        let mut colours = Vec::with_capacity(theta_deg.len());
        self.each(
            theta_deg,
            &mut colours,
            |_| &[],
            |colours, spectrum, weights| {
                colours.push(xyz(&weights.xyz, spectrum.reflectance.iter().copied()));
            },
        )?;
        Ok(colours)
    }

    /// Adds samples to a spectrum. Both lists of wavelengths increase and have none in common.
    fn insert(&self, spectrum: &mut Spectrum, theta: f64, nm: &[f64]) -> Result<()> {
        if nm.is_empty() {
            return Ok(());
        }
        let found = spectra(self.planar, &[theta], nm, &SpectraRequest { threads: 1, ..self.request }, &|| ())?;
        let count = spectrum.wavelength_nm.len() + nm.len();
        let mut all = Spectrum { wavelength_nm: Vec::with_capacity(count), reflectance: Vec::with_capacity(count) };
        let mut push = |(nm, rho): (f64, f64)| {
            all.wavelength_nm.push(nm);
            all.reflectance.push(rho);
        };
        let new = nm.iter().copied().zip(found.samples.iter().map(Sample::mean_reflectance));
        let mut old = spectrum.wavelength_nm.iter().copied().zip(spectrum.reflectance.iter().copied()).peekable();
        for sample in new {
            while let Some(before) = old.next_if(|before| before.0 < sample.0) {
                push(before);
            }
            push(sample);
        }
        old.for_each(&mut push);
        *spectrum = all;
        Ok(())
    }

    /// Halves intervals until cubics hold between all samples. Returns the weights of the samples.
    fn resolve(&self, spectrum: &mut Spectrum, theta: f64) -> Result<Weights> {
        let weigh = |spectrum: &Spectrum| match spectrum.wavelength_nm.len() == self.base.len() {
            true => Cow::Borrowed(&self.weights),
            false => Cow::Owned(Weights::new(&spectrum.wavelength_nm, self.illuminant)),
        };
        for _ in 0..MAX_LEVELS {
            let weights = weigh(spectrum);
            let halves = unresolved(spectrum, &weights);
            if halves.is_empty() || spectrum.wavelength_nm.len() + halves.len() > MAX_FINE {
                return Ok(weights.into_owned());
            }
            self.insert(spectrum, theta, &halves)?;
        }
        Ok(weigh(spectrum).into_owned())
    }
}

/// The ends of the fewest even intervals of at most [`BASE_STEP_NM`].
#[must_use]
pub fn even([first, last]: [f64; 2]) -> Vec<f64> {
    // Rounding of the division must not add an interval.
    let intervals = ((last - first) / BASE_STEP_NM * (1.0 - 4.0 * f64::EPSILON)).ceil();
    let inner = (0..intervals as u32).map(|i| first + (last - first) * f64::from(i) / intervals);
    inner.chain([last]).collect()
}

/// The wavelengths where samples are missing: the middles of the intervals beside each sample that its neighbours do
/// not predict.
fn unresolved(spectrum: &Spectrum, weights: &Weights) -> Vec<f64> {
    const MIN_STEP_NM: f64 = BASE_STEP_NM / (1_u32 << MAX_LEVELS) as f64;
    let (nm, rho) = (&spectrum.wavelength_nm, &spectrum.reflectance);
    let mut halves: Vec<f64> = Vec::new();
    for i in 2..nm.len().saturating_sub(2) {
        let around = [i - 2, i - 1, i + 1, i + 2];
        let Some(cubic) = SpectrumCubic::new(&around.map(|j| nm[j]), 1) else { continue };
        let predicted: f64 =
            cubic.index().iter().zip(cubic.shares(nm[i])).map(|(&j, share)| share * rho[around[j]]).sum();
        if (predicted - rho[i]).abs() / LEFT_OUT_RATIO * weights.max_weight(i) > MAX_INTERVAL_ERROR {
            for j in [i - 1, i] {
                let middle = 0.5 * (nm[j] + nm[j + 1]);
                if nm[j + 1] - nm[j] >= 2.0 * MIN_STEP_NM && halves.last().is_none_or(|&last| last < middle) {
                    halves.push(middle);
                }
            }
        }
    }
    halves
}
