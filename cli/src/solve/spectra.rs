//! Spectra of planar scenes over angles and wavelengths: owns allocation and threads, and is the only caller of the tracer.

use goniochrome::optics::incidence::Incidence;
use goniochrome::optics::interface::{Below, Model, Wave};
use goniochrome::optics::medium::{MediaLanes, MediumIndex};
use goniochrome::optics::stack::{PreparedStack, PreparedStackMemory, Stack};
use goniochrome::simd::complex::{ComplexLanes, Polarised};
use goniochrome::simd::double_double::DoubleDouble;
use goniochrome::simd::lanes::{F32, F64, Lanes};
use goniochrome::trace::ledger::Ledger;
use goniochrome::trace::planar::{PlanarSlot, Summation, Totals, TraceMemory, free_slot, rounding, trace_planar};
use goniochrome::trace::waves::Limits;

use crate::solve::groups::Groups;
use crate::solve::hits;
use crate::solve::planar_scene::PlanarScene;
use crate::solve::precision::Precision;
use crate::support::error::{Error, Result};
use crate::support::parallel;
use crate::table::mirror::MAX_SAMPLES;

/// How the reflectance is found.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Method {
    /// The closed form of the planar stack.
    Stack,
    /// Ray splitting, every loop summed exactly.
    #[default]
    Trace,
    /// Ray splitting hit by hit; samples whose sum diverges or takes too long fall back to closed loops, and are
    /// counted.
    Hits,
}

/// The share of [`Precision::tolerance`] beyond which an estimated error is not accepted: the estimate may be too small
/// by this.
const ACCEPTED: f64 = 0.5;

/// How to compute.
#[derive(Clone, Copy, Debug)]
pub struct SpectraRequest {
    /// Exact physics or the paper's words.
    pub model: Model,
    /// Closed form or rays.
    pub method: Method,
    /// Single or double.
    pub precision: Precision,
    /// Worker threads; the result does not depend on it.
    pub threads: usize,
}

/// Power at one angle and wavelength.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Sample {
    /// Reflectance.
    pub reflectance: Polarised<f64>,
    /// Transmittance into the substrate.
    pub transmittance: Polarised<f64>,
    /// The error bar of rays that were not followed: the largest difference of the four powers above from those of
    /// [`Method::Trace`]. 0 but for [`Method::Hits`].
    pub truncated: f64,
    /// What the tracer's ledger misses, the larger of s and p. 0 in closed form.
    pub imbalance: f64,
}

impl Sample {
    /// Unpolarised reflectance.
    #[must_use]
    pub fn mean_reflectance(&self) -> f64 {
        0.5 * (self.reflectance.s + self.reflectance.p)
    }
}

/// Samples over a grid, `samples[angle * wavelengths + wavelength]`.
#[derive(Clone, Debug, PartialEq)]
pub struct Spectra {
    /// Angles of incidence in the ambient medium.
    pub theta_deg: Vec<f64>,
    /// Vacuum wavelengths.
    pub wavelength_nm: Vec<f64>,
    /// One for each pair.
    pub samples: Vec<Sample>,
    /// How many of them [`Method::Hits`] could not sum, so that their loops were closed instead.
    pub fell_back: usize,
    /// Samples that were computed again with more digits than asked for: see [`Precision::tolerance`].
    pub recomputed: usize,
}

impl Spectra {
    /// The samples at one angle.
    #[must_use]
    pub fn row(&self, angle: usize) -> &[Sample] {
        let width = self.wavelength_nm.len();
        &self.samples[angle * width..(angle + 1) * width]
    }

    /// The largest of a quantity over all samples.
    #[must_use]
    pub fn worst(&self, of: impl Fn(&Sample) -> f64) -> f64 {
        self.samples.iter().map(of).fold(0.0, f64::max)
    }
}

/// Reflectance and transmittance of a planar scene at every angle and wavelength; `progress` is told of each finished angle.
///
/// # Errors
/// A medium without data at a wavelength, an ambient medium that absorbs too much, a grid larger than [`MAX_SAMPLES`].
pub fn spectra(
    planar: &PlanarScene<'_>,
    theta_deg: &[f64],
    wavelength_nm: &[f64],
    request: &SpectraRequest,
    progress: &(dyn Fn() + Sync),
) -> Result<Spectra> {
    let found = computed(planar, theta_deg, wavelength_nm, request, progress)?;
    if request.method != Method::Hits {
        return Ok(found);
    }
    let closed = SpectraRequest { method: Method::Trace, ..*request };
    let closed = computed(planar, theta_deg, wavelength_nm, &closed, &|| ())?;
    Ok(hits::settled(found, &closed, request.precision))
}

/// What the method itself gives, in lanes of as many digits as each sample needs.
fn computed(
    planar: &PlanarScene<'_>,
    theta_deg: &[f64],
    wavelength_nm: &[f64],
    request: &SpectraRequest,
    progress: &(dyn Fn() + Sync),
) -> Result<Spectra> {
    let count = theta_deg.len().saturating_mul(wavelength_nm.len());
    if count > MAX_SAMPLES {
        return Err(Error::failed(format_args!(
            "{count} samples are more than the {MAX_SAMPLES} that a table may hold"
        )));
    }
    let mut buffer = planar.buffer();
    let grid = Grid { planar, stack: planar.stack(&mut buffer)?, theta_deg, wavelength_nm, request };
    let mut entries = vec![Entry { sample: Sample::default(), open: true }; count];
    let open = |entries: &[Entry]| entries.iter().filter(|entry| entry.open).count();
    match request.precision {
        Precision::F32 => grid.pass::<F32>(&mut entries, Limits::SINGLE, progress)?,
        Precision::F64 => grid.pass::<F64>(&mut entries, Limits::DOUBLE, progress)?,
    }
    let recomputed = open(&entries);
    if recomputed > 0 && request.precision == Precision::F32 {
        grid.pass::<F64>(&mut entries, Limits::DOUBLE, &|| ())?;
    }
    if open(&entries) > 0 {
        grid.pass::<DoubleDouble>(&mut entries, Limits::DOUBLE, &|| ())?;
    }
    let samples = entries.into_iter().map(|entry| entry.sample).collect();
    Ok(Spectra {
        theta_deg: theta_deg.to_vec(),
        wavelength_nm: wavelength_nm.to_vec(),
        samples,
        fell_back: 0,
        recomputed,
    })
}

/// What is to be computed.
struct Grid<'g> {
    planar: &'g PlanarScene<'g>,
    stack: Stack<'g>,
    theta_deg: &'g [f64],
    wavelength_nm: &'g [f64],
    request: &'g SpectraRequest,
}

/// A sample, and whether it is still to be computed, or computed again.
#[derive(Clone, Copy)]
struct Entry {
    sample: Sample,
    open: bool,
}

impl Grid<'_> {
    /// Computes the open entries in lanes of `V`; those whose rounding is beyond what was asked for stay open.
    fn pass<V: Lanes>(&self, entries: &mut [Entry], limits: Limits, progress: &(dyn Fn() + Sync)) -> Result<()> {
        let Self { planar, stack, theta_deg, wavelength_nm, request } = *self;
        let media = planar.media();
        let mut groups = Groups::<V>::new(media.len(), wavelength_nm);
        let groups = groups
            .evaluate(&media, stack.ambient(), wavelength_nm)
            .map_err(|(index, error)| planar.scene().medium_error(index, &error))?;
        parallel::for_each(
            request.threads,
            entries.chunks_mut(wavelength_nm.len().max(1)).zip(theta_deg),
            || Worker::<V>::new(stack),
            |worker, (row, theta)| {
                let incidence = Incidence::from_degrees(*theta);
                for (out, (group, _)) in row.chunks_mut(V::WIDTH).zip(&groups) {
                    if *theta >= GRAZING_DEG {
                        fill_grazing(out, stack, group);
                    } else if out.iter().any(|entry| entry.open) {
                        worker.fill(out, stack, group, incidence, request, limits);
                    }
                }
                progress();
            },
        );
        Ok(())
    }
}

/// Light along the surface.
const GRAZING_DEG: f64 = 90.0;

/// The limit of grazing incidence: all light returns, unless there is nothing but the ambient medium.
fn fill_grazing<V: Lanes>(out: &mut [Entry], stack: Stack<'_>, group: &MediaLanes<'_, V>) {
    let eta = |medium: MediumIndex, lane: usize| {
        let eta = group.eta()[usize::from(medium)];
        [eta.re.lane(lane), eta.im.lane(lane)]
    };
    for (lane, entry) in out.iter_mut().enumerate() {
        let ambient = eta(stack.ambient(), lane);
        let nothing = (0..stack.planes()).all(|j| match stack.interface(j).below {
            Below::Medium(below) => eta(below, lane) == ambient,
            Below::Mirror => false,
        });
        let (reflected, transmitted) = if nothing { (0.0, 1.0) } else { (1.0, 0.0) };
        let (reflectance, transmittance) = (Polarised::both(reflected), Polarised::both(transmitted));
        let sample = Sample { reflectance, transmittance, truncated: 0.0, imbalance: 0.0 };
        *entry = Entry { sample, open: false };
    }
}

/// A thread's memory.
struct Worker<V: Lanes> {
    waves: Vec<Wave<V>>,
    reflections: Vec<Polarised<ComplexLanes<V>>>,
    propagators: Vec<ComplexLanes<V>>,
    totals: Vec<Totals<V>>,
    slots: Vec<PlanarSlot<V>>,
}

impl<V: Lanes> Worker<V> {
    fn new(stack: Stack<'_>) -> Self {
        let planes = stack.planes();
        Self {
            waves: vec![Wave::none(); stack.media()],
            reflections: vec![Polarised::both(ComplexLanes::zero()); planes],
            propagators: vec![ComplexLanes::zero(); planes],
            totals: vec![Totals::none(); planes],
            slots: vec![free_slot(); 2 * planes],
        }
    }

    fn fill(
        &mut self,
        out: &mut [Entry],
        stack: Stack<'_>,
        group: &MediaLanes<'_, V>,
        incidence: Incidence<V::Precise>,
        request: &SpectraRequest,
        limits: Limits,
    ) {
        let Self { waves, reflections, propagators, totals, slots } = self;
        let optics = PreparedStack::new(
            stack,
            group,
            incidence,
            request.model,
            PreparedStackMemory { waves, reflections, propagators },
        );
        let mut traced = |summation| {
            trace_planar(&optics, summation, TraceMemory { totals: &mut *totals, slots })
                .expect("the worker's memory was made for this stack")
                .ledger
        };
        let (ledger, error) = match request.method {
            Method::Stack => {
                let (response, error) = optics.response_and_rounding();
                let (r, t) = (optics.reflectance(response.reflection), optics.transmittance(response.transmission));
                let none = Polarised::both(V::zero());
                let ledger =
                    Ledger { reflected: r, transmitted: t, absorbed: none, truncated: V::zero(), imbalance: none };
                (ledger, error)
            }
            Method::Trace => {
                let ledger = traced(Summation::ClosedLoops);
                (ledger, rounding(&optics, totals))
            }
            // Its error is its distance from closed loops.
            Method::Hits => (traced(Summation::Generations(hits::affordable(limits, stack.planes()))), V::zero()),
        };
        let accepted = ACCEPTED * request.precision.tolerance();
        for (lane, entry) in out.iter_mut().enumerate().filter(|(_, entry)| entry.open) {
            let Polarised { s, p } = ledger.imbalance.map(|x| x.lane(lane).abs());
            let sample = Sample {
                reflectance: ledger.reflected.map(|r| r.lane(lane)),
                transmittance: ledger.transmitted.map(|t| t.lane(lane)),
                truncated: ledger.truncated.lane(lane),
                imbalance: s.max(p),
            };
            // Never of NaN.
            let holds = error.lane(lane) <= accepted;
            *entry = Entry { sample, open: !holds };
        }
    }
}
