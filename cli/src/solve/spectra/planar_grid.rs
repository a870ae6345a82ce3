//! Every sample of a grid in lanes of as many digits as it needs: owns memory and threads, and calls the tracer.

use goniochrome::optics::incidence::Incidence;
use goniochrome::optics::interface::{Below, Wave};
use goniochrome::optics::medium::{MediaLanes, MediumIndex};
use goniochrome::optics::stack::{PreparedStack, PreparedStackMemory, Stack};
use goniochrome::simd::complex::{ComplexLanes, Polarised};
use goniochrome::simd::double_double::DoubleDouble;
use goniochrome::simd::lanes::{F32, F64, Lanes};
use goniochrome::trace::ledger::Ledger;
use goniochrome::trace::planar::{PlanarSlot, Summation, Totals, TraceMemory, free_slot, rounding, trace_planar};
use goniochrome::trace::waves::Limits;

use crate::solve::groups::Groups;
use crate::solve::planar_scene::PlanarScene;
use crate::solve::precision::Precision;
use crate::solve::spectra::hit_by_hit::affordable;
use crate::solve::spectra::request::{Method, SpectraRequest};
use crate::solve::spectra::samples::{Sample, Spectra};
use crate::support::error::{Error, Result};
use crate::support::parallel;
use crate::table::mirror::MAX_SAMPLES;

/// The largest estimated error that is accepted, as a share of [`Precision::tolerance`]: the estimate may be too small
/// by this factor.
const ACCEPTED: f64 = 0.5;

/// The spectra that the requested method gives, each sample in lanes of as many digits as it needs.
pub(super) fn compute(
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
    let grid = SpectraGrid { planar, stack: planar.stack(&mut buffer)?, theta_deg, wavelength_nm, request };
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

/// A planar scene and the grid of angles and wavelengths at which it is computed.
struct SpectraGrid<'g> {
    planar: &'g PlanarScene<'g>,
    stack: Stack<'g>,
    theta_deg: &'g [f64],
    wavelength_nm: &'g [f64],
    request: &'g SpectraRequest,
}

/// A sample, and whether it still has to be computed, or computed again with more digits.
#[derive(Clone, Copy)]
struct Entry {
    sample: Sample,
    open: bool,
}

impl SpectraGrid<'_> {
    /// Computes the open entries in lanes of `V`. Entries whose rounding error is too large stay open.
    fn pass<V: Lanes>(&self, entries: &mut [Entry], limits: Limits, progress: &(dyn Fn() + Sync)) -> Result<()> {
        let Self { planar, stack, theta_deg, wavelength_nm, request } = *self;
        let mut groups = Groups::<V>::new(planar.scene(), wavelength_nm);
        let groups = groups.evaluate(planar.scene(), stack.ambient(), wavelength_nm)?;
        parallel::for_each(
            request.threads,
            entries.chunks_mut(wavelength_nm.len().max(1)).zip(theta_deg),
            || StackWorker::<V>::new(stack),
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

/// The angle of light along the surface.
const GRAZING_DEG: f64 = 90.0;

/// Fills samples with the limit of grazing incidence: all light is reflected, unless there is nothing but the ambient
/// medium.
fn fill_grazing<V: Lanes>(out: &mut [Entry], stack: Stack<'_>, group: &MediaLanes<'_, V>) {
    let eta = |medium: MediumIndex, lane: usize| {
        let eta = group.eta()[usize::from(medium)];
        [eta.re.lane(lane), eta.im.lane(lane)]
    };
    for (lane, entry) in out.iter_mut().enumerate() {
        let ambient = eta(stack.ambient(), lane);
        let empty = (0..stack.planes()).all(|j| match stack.interface(j).below {
            Below::Medium(below) => eta(below, lane) == ambient,
            Below::Mirror => false,
        });
        let (reflected, transmitted) = if empty { (0.0, 1.0) } else { (1.0, 0.0) };
        let (reflectance, transmittance) = (Polarised::both(reflected), Polarised::both(transmitted));
        let sample = Sample { reflectance, transmittance, truncated: 0.0, imbalance: 0.0 };
        *entry = Entry { sample, open: false };
    }
}

/// Memory of one thread for the closed form and the tracer of a stack.
struct StackWorker<V: Lanes> {
    waves: Vec<Wave<V>>,
    reflections: Vec<Polarised<ComplexLanes<V>>>,
    propagators: Vec<ComplexLanes<V>>,
    totals: Vec<Totals<V>>,
    slots: Vec<PlanarSlot<V>>,
}

impl<V: Lanes> StackWorker<V> {
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

    /// Computes the open entries of one angle and one group of wavelengths.
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
        let prepared = PreparedStack::new(
            stack,
            group,
            incidence,
            request.model,
            PreparedStackMemory { waves, reflections, propagators },
        );
        let mut traced = |summation| {
            trace_planar(&prepared, summation, TraceMemory { totals: &mut *totals, slots })
                .expect("the worker's memory was made for this stack")
                .ledger
        };
        let (ledger, error) = match request.method {
            Method::Stack => {
                let (response, error) = prepared.response_and_rounding();
                let (r, t) = (prepared.reflectance(response.reflection), prepared.transmittance(response.transmission));
                let none = Polarised::both(V::zero());
                let ledger =
                    Ledger { reflected: r, transmitted: t, absorbed: none, truncated: V::zero(), imbalance: none };
                (ledger, error)
            }
            Method::Trace => {
                let ledger = traced(Summation::ClosedLoops);
                (ledger, rounding(&prepared, totals))
            }
            // Its error is its distance from closed loops, which is measured afterwards.
            Method::Hits => (traced(Summation::Generations(affordable(limits, stack.planes()))), V::zero()),
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
            // False for NaN.
            let holds = error.lane(lane) <= accepted;
            *entry = Entry { sample, open: !holds };
        }
    }
}
