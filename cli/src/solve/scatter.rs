//! Scattering by polygon cells: starting rays over the period, histograms of where their light goes, standard errors.

use std::ops::Range;

use glam::DVec3;
use goniochrome::geometry::mesh_cell::MeshCell;
use goniochrome::geometry::side::Side;
use goniochrome::measure::bins::{DirectionBins, ExitBuffer, ExitRecord, Histogram};
use goniochrome::optics::medium::MediaLanes;
use goniochrome::simd::complex::Polarised;
use goniochrome::simd::lanes::{F32, F64, Lanes};
use goniochrome::trace::coherent_mesh::{CoherentMesh, IncidentWave, WaveField, WaveState, free_slot};
use goniochrome::trace::incoherent_mesh::{self, Coherency, IncoherentMesh, Path};
use goniochrome::trace::paths::{IncoherentFallback, follow_paths, trace_with_fallback};
use goniochrome::trace::random::Random;
use goniochrome::trace::sobol::sobol;
use goniochrome::trace::waves::{Limits, Slot};

use crate::solve::coherent::{BinLight, orders_in_bins};
use crate::solve::diffraction::groups;
use crate::solve::groups::{Group, Groups};
use crate::solve::mesh_scene::MeshScene;
use crate::solve::precision::Precision;
use crate::support::error::{Error, Result};
use crate::support::memory::expect_list;
use crate::support::parallel;
use crate::table::statistics::MeanWithError;

/// How exits add.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Coherence {
    /// Paths of one starting ray that leave in one bin interfere; starting rays add as powers.
    #[default]
    Ray,
    /// Every path adds as power: classic geometric optics.
    None,
    /// All exits in a bin interfere, whatever starting ray they come from: the paper's section 2.2, literally.
    Bin,
    /// The period is one coherent field, which leaves in diffraction orders; reflection alone.
    Cell,
}

/// What a [`Coherence`] adds up: the one place that tells them apart.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Adding {
    /// Starting rays as powers.
    Powers(Paths),
    /// Fields of all starting rays, in bins.
    Fields,
    /// Fields of all starting rays, in diffraction orders.
    Orders,
}

/// How the paths of one starting ray add.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Paths {
    /// As amplitudes, in bins.
    Interfering,
    /// As powers.
    Alone,
}

impl Coherence {
    /// The name on the command line and in files.
    #[must_use]
    pub fn name(self) -> &'static str {
        match self {
            Self::Ray => "ray",
            Self::None => "none",
            Self::Bin => "bin",
            Self::Cell => "cell",
        }
    }

    pub(crate) fn adding(self) -> Adding {
        match self {
            Self::Ray => Adding::Powers(Paths::Interfering),
            Self::None => Adding::Powers(Paths::Alone),
            Self::Bin => Adding::Fields,
            Self::Cell => Adding::Orders,
        }
    }
}

/// What to compute.
#[derive(Clone, Copy, Debug)]
pub struct ScatterRequest {
    /// How exits add.
    pub coherence: Coherence,
    /// Starting rays over the period.
    pub rays: u32,
    /// Of the scrambled sequence.
    pub seed: u32,
    /// Where exits are counted.
    pub bins: DirectionBins,
    /// Single or double.
    pub precision: Precision,
    /// Worker threads; the result does not depend on it.
    pub threads: usize,
}

/// Where the light of one direction goes, at one wavelength; fractions of the incident power, unpolarised.
#[derive(Clone, Debug, PartialEq)]
pub struct Scattered {
    /// Through the top.
    pub reflected: MeanWithError,
    /// Through the bottom, in all directions.
    pub transmitted: MeanWithError,
    /// By media, on the way.
    pub absorbed: MeanWithError,
    /// Of rays that were dropped or lost: the error bar.
    pub truncated: MeanWithError,
    /// 1 less all of these: rounding for coherence `none`; where paths interfere, power balances only on average.
    pub imbalance: MeanWithError,
    /// Share of starting rays whose interfering waves have no sum, and which were followed without interference: waves in
    /// absorbing bodies narrower than a wavelength may meet loops of gain above 1.
    pub without_interference: MeanWithError,
    /// Through the top, in each bin.
    pub bins: Vec<MeanWithError>,
}

/// Independent scramblings over which the standard error is taken.
pub const BATCHES: u32 = 32;
/// Exits that one starting ray may have.
const MAX_EXITS: usize = 512;
/// States in which the tracer lets waves wait by default, where none goes on by itself.
const STATES: usize = 36;

/// The same for a cell: the default, or as many as its waves need.
pub(crate) fn states(mesh_scene: &MeshScene<'_>) -> usize {
    STATES.max(waves(mesh_scene))
}

/// States in which waves wait for their equals: as many as a planar stack of the cell's interfaces has, and two pairs for
/// waves that a ray sends beyond an edge. Light that has more is scattered by curved facets and meets no equals: between 6
/// and 26 states the soap film reflects the same within a thousandth.
fn waves(mesh_scene: &MeshScene<'_>) -> usize {
    2 * mesh_scene.interface_count() + 4
}

/// Paths that may wait while another is followed: each is the stronger branch of a hit that split.
const WAITING: usize = 36;

/// A thread's memory for the tracer.
pub(crate) struct Workspace<V: Lanes> {
    waves: Vec<Slot<WaveState<V>, WaveField<V>>>,
    paths: Vec<Slot<Path<V>, Coherency<V>>>,
    exits: Vec<ExitRecord<V>>,
}

impl<V: Lanes> Workspace<V> {
    pub(crate) fn new(mesh_scene: &MeshScene<'_>) -> Self {
        Self {
            waves: vec![free_slot(); waves(mesh_scene)],
            paths: vec![incoherent_mesh::free_slot(); WAITING],
            exits: vec![ExitRecord::none(); MAX_EXITS],
        }
    }
}

const _: () = assert!(STATES * size_of::<Slot<WaveState<F32>, WaveField<F32>>>() <= 64 * 1024);
const _: () = assert!(STATES * size_of::<Slot<WaveState<F64>, WaveField<F64>>>() <= 64 * 1024);
const _: () = assert!(WAITING * size_of::<Slot<Path<F32>, Coherency<F32>>>() <= 32 * 1024);
const _: () = assert!(WAITING * size_of::<Slot<Path<F64>, Coherency<F64>>>() <= 32 * 1024);

/// Paths below this power are no longer split. Less would cost more than it saves in noise: at 80 degrees 0.01 takes the bumpy
/// soap film 1.7 times as long for the same standard error.
const PATHS: Limits = Limits { in_flight: 0.1, generations: 10_000 };
/// Waves in flight below this power are dropped: amplitudes of 3e-7, of which a loop of gain g would make 3e-7/|1 − g|.
pub(crate) const WAVES: Limits = Limits { in_flight: 1e-13, generations: 10_000 };

/// Light from the unit direction `wi`, at each wavelength, by the coherence asked for. `progress` is told of each of so
/// many [`steps`].
///
/// # Errors
/// A mesh that the core refuses, a medium without data at a wavelength, an ambient medium that absorbs too much, more
/// memory than there is, waves without a sum, more light left out than [`MAX_TRUNCATED`].
pub fn scatter(
    mesh_scene: &MeshScene<'_>,
    wi: DVec3,
    wavelength_nm: &[f64],
    request: &ScatterRequest,
    progress: &(dyn Fn() + Sync),
) -> Result<Vec<Scattered>> {
    let tallies = [BATCHES as usize, wavelength_nm.len(), request.bins.count()];
    expect_list::<f64>(&tallies, "all --bins at all --wavelengths")?;
    match request.precision {
        Precision::F32 => run::<F32>(mesh_scene, wi, wavelength_nm, request, progress),
        Precision::F64 => run::<F64>(mesh_scene, wi, wavelength_nm, request, progress),
    }
}

/// Steps of which [`scatter`] tells.
#[must_use]
pub fn steps(wavelengths: usize, request: &ScatterRequest) -> usize {
    BATCHES as usize
        * match request.coherence.adding() {
            Adding::Powers(_) => 1,
            Adding::Fields | Adding::Orders => groups(wavelengths, request.precision),
        }
}

fn run<V: Lanes>(
    mesh_scene: &MeshScene<'_>,
    wi: DVec3,
    wavelength_nm: &[f64],
    request: &ScatterRequest,
    progress: &(dyn Fn() + Sync),
) -> Result<Vec<Scattered>> {
    match request.coherence.adding() {
        Adding::Powers(paths) => tallied::<V>(mesh_scene, wavelength_nm, request, |cell, groups| {
            Ok(powers(mesh_scene, cell, groups, wi, paths, request, progress))
        }),
        Adding::Fields => tallied::<V>(mesh_scene, wavelength_nm, request, |cell, groups| {
            BinLight::expect_room::<V>(request)?;
            let light = BinLight::new(mesh_scene, cell, wi, request);
            let mut batches: Vec<Vec<Tally>> = vec![Vec::new(); BATCHES as usize];
            for (media, wavelengths) in groups {
                let found = light.tallies(*media, wavelengths.len(), progress);
                batches.iter_mut().zip(found).for_each(|(batch, found)| batch.extend(found));
            }
            Ok(batches)
        }),
        Adding::Orders => orders_in_bins(mesh_scene, wi, wavelength_nm, request, progress),
    }
}

/// Means over the tallies that `work` makes of a cell: for each batch one for each wavelength.
fn tallied<V: Lanes>(
    mesh_scene: &MeshScene<'_>,
    wavelength_nm: &[f64],
    request: &ScatterRequest,
    work: impl FnOnce(MeshCell<'_>, &[Group<'_, V>]) -> Result<Vec<Vec<Tally>>>,
) -> Result<Vec<Scattered>> {
    let mut buffer = mesh_scene.buffer();
    let cell = mesh_scene.cell(&mut buffer)?;
    let media = mesh_scene.media();
    let mut groups = Groups::<V>::new(media.len(), wavelength_nm);
    let groups = groups
        .evaluate(&media, cell.above(), wavelength_nm)
        .map_err(|(index, error)| mesh_scene.scene().medium_error(index, &error))?;
    let batches = work(cell, &groups)?;
    let found: Vec<Scattered> =
        (0..wavelength_nm.len()).map(|i| summarise(batches.iter().map(|batch| &batch[i]))).collect();
    for Scattered { reflected, transmitted, absorbed, truncated, .. } in &found {
        let totals = [reflected, transmitted, absorbed, truncated].map(|total| total.value);
        refuse_no_result(mesh_scene, request.coherence, totals)?;
    }
    Ok(found)
}

/// The tallies of each batch, where starting rays add as powers.
fn powers<V: Lanes>(
    mesh_scene: &MeshScene<'_>,
    cell: MeshCell<'_>,
    groups: &[Group<'_, V>],
    wi: DVec3,
    paths: Paths,
    request: &ScatterRequest,
    progress: &(dyn Fn() + Sync),
) -> Vec<Vec<Tally>> {
    let mut batches: Vec<Vec<Tally>> = vec![Vec::new(); BATCHES as usize];
    parallel::for_each(
        request.threads,
        batches.iter_mut().zip(0u32..),
        || Workspace::<V>::new(mesh_scene),
        |workspace, (out, batch)| {
            for (group, wavelengths) in groups {
                let mut tallies = vec![Tally::new(request.bins.count()); wavelengths.len()];
                let rays = 0..(request.rays / BATCHES).max(1);
                trace_batch(cell, *group, wi, batch, rays, paths, request, workspace, &mut tallies);
                out.extend(tallies);
            }
            progress();
        },
    );
    batches
}

/// Means over starting rays of one batch, one wavelength.
#[derive(Clone, Debug, Default)]
pub(crate) struct Tally {
    pub reflected: f64,
    pub transmitted: f64,
    pub absorbed: f64,
    pub truncated: f64,
    pub without_interference: f64,
    pub bins: Vec<f64>,
}

impl Tally {
    pub(crate) fn new(bins: usize) -> Self {
        Self { bins: vec![0.0; bins], ..Self::default() }
    }

    /// The mean of some of equally many bins.
    pub(crate) fn mean<'t>(tallies: impl ExactSizeIterator<Item = &'t Self>) -> Self {
        let share = 1.0 / tallies.len() as f64;
        tallies.fold(Self::default(), |mut mean, tally| {
            mean.bins.resize(tally.bins.len(), 0.0);
            let mut tally = tally.clone();
            mean.numbers().zip(tally.numbers()).for_each(|(sum, part)| *sum += share * *part);
            mean
        })
    }

    fn numbers(&mut self) -> impl Iterator<Item = &mut f64> {
        let Self { reflected, transmitted, absorbed, truncated, without_interference, bins } = self;
        [reflected, transmitted, absorbed, truncated, without_interference].into_iter().chain(bins)
    }
}

/// One for each lane that holds a wavelength of its own; lanes beyond the last wavelength repeat it.
struct Tallies<'t>(&'t mut [Tally]);

impl Histogram for Tallies<'_> {
    fn add(&mut self, lane: usize, side: Side, bin: usize, power: f64) {
        let Some(tally) = self.0.get_mut(lane) else { return };
        match side {
            Side::Above => {
                tally.reflected += power;
                tally.bins[bin] += power;
            }
            Side::Below => tally.transmitted += power,
        }
    }
}

/// Traces the starting rays `rays` of a batch; writes the means into `tallies`, which must be new.
#[allow(clippy::too_many_arguments)]
pub(crate) fn trace_batch<V: Lanes>(
    cell: MeshCell<'_>,
    media: MediaLanes<'_, V>,
    wi: DVec3,
    batch: u32,
    rays: Range<u32>,
    adding: Paths,
    request: &ScatterRequest,
    Workspace { waves, paths, exits }: &mut Workspace<V>,
    tallies: &mut [Tally],
) {
    let eta = media.eta()[usize::from(cell.above())];
    let incident = IncidentWave::new(wi, eta);
    let (mut polygons, mut geometric) =
        (CoherentMesh::new(cell, media, incident), IncoherentMesh::new(cell, media, incident));
    let mut exits = ExitBuffer::new(exits, request.bins, &media);
    let per_ray = 1.0 / rays.len() as f64;
    let sequence = request.seed.wrapping_mul(BATCHES).wrapping_add(batch);
    let mut truncated = V::zero();
    let mut without_interference = 0;
    for ray in rays {
        let [u, v] = sobol(ray, sequence);
        let Some((path, light)) = geometric.start(u, v) else {
            truncated += V::one(); // a hole from top to bottom
            continue;
        };
        exits.begin(path.at().point_nm);
        let mut random = Random::new(ray, sequence);
        let mut interfering = None;
        if adding == Paths::Interfering {
            let before = (polygons, geometric);
            let (state, field) = polygons.start_at(path.at());
            let spill = IncoherentFallback::new(&mut geometric, paths, PATHS, &mut random);
            let done = trace_with_fallback(&mut polygons, state, field, waves, WAVES, spill, &mut exits);
            if done.truncated.any_above(MAX_TRUNCATED) {
                // The waves of this starting ray have no sum, or too little of one: it is followed again without
                // interference.
                (polygons, geometric) = before;
                exits.begin(path.at().point_nm);
                without_interference += 1;
            } else {
                interfering = Some(done);
            }
        }
        let done = interfering
            .unwrap_or_else(|| follow_paths(&mut geometric, path, light, paths, PATHS, &mut random, &mut exits));
        truncated += done.truncated + exits.flush(&mut Tallies(tallies));
    }
    truncated += polygons.lost() + geometric.lost();
    let Polarised { s, p } = polygons.absorbed();
    let absorbed = (s + p) * V::splat(0.5) + geometric.absorbed();
    for (lane, tally) in tallies.iter_mut().enumerate() {
        tally.truncated = truncated.lane(lane);
        tally.without_interference = f64::from(without_interference) * per_ray;
        tally.absorbed = absorbed.lane(lane);
        for sum in [&mut tally.reflected, &mut tally.transmitted, &mut tally.absorbed, &mut tally.truncated]
            .into_iter()
            .chain(&mut tally.bins)
        {
            *sum *= per_ray;
        }
    }
}

/// The largest share of the light that a result may leave out.
///
/// Where paths add as powers it bounds the error of a reflectance Y. CIELAB's L* changes by at most 903 for each unit
/// of Y, near black: by 0.9 here, less than the smallest difference that is seen. Where waves interfere, a power p that
/// is left out may move a reflectance R by 2√(R p) and more; such waves are given up at a power of 1e-13, far below
/// this share.
pub const MAX_TRUNCATED: f64 = 1e-3;

/// Refuses what was reflected, transmitted, absorbed and truncated if it is no result. Waves in absorbing bodies
/// narrower than a wavelength may meet loops of gain above 1, whose sum by hits has no end.
pub(crate) fn refuse_no_result(mesh_scene: &MeshScene<'_>, coherence: Coherence, totals: [f64; 4]) -> Result<()> {
    let truncated = if totals.iter().all(|total| total.is_finite()) { totals[3] } else { f64::INFINITY };
    refuse_divergence(mesh_scene, truncated)?;
    let remedy = match coherence.adding() {
        Adding::Powers(Paths::Alone) => "its surfaces may cut through one another: correct the mesh",
        Adding::Powers(Paths::Interfering) | Adding::Fields | Adding::Orders => "use --coherence none",
    };
    refuse_truncation(mesh_scene, truncated, remedy)
}

/// Refuses waves of which more is left in flight than came.
pub(crate) fn refuse_divergence(mesh_scene: &MeshScene<'_>, truncated: f64) -> Result<()> {
    /// Of a sum over wavelengths whose weights add up to 1.
    const ROUNDING: f64 = 1e-9;
    if truncated <= 1.0 + ROUNDING {
        return Ok(());
    }
    Err(Error::failed(format_args!(
        "{}: interfering waves do not converge in this cell; scatter and estimate add powers with --coherence none",
        mesh_scene.scene().name
    )))
}

/// Refuses a result that leaves out more light than [`MAX_TRUNCATED`].
pub(crate) fn refuse_truncation(mesh_scene: &MeshScene<'_>, truncated: f64, remedy: &str) -> Result<()> {
    if truncated <= MAX_TRUNCATED {
        return Ok(());
    }
    Err(Error::failed(format_args!(
        "{}: {truncated:.1e} of the light was lost or given up on its way, more than the {MAX_TRUNCATED:.0e} that a result may \
         leave out; {remedy}",
        mesh_scene.scene().name
    )))
}

/// Mean and standard error over batches.
fn summarise<'t>(batches: impl Iterator<Item = &'t Tally> + Clone) -> Scattered {
    let over = |of: &dyn Fn(&Tally) -> f64| MeanWithError::over(batches.clone().map(of));
    let bins = batches.clone().next().map_or(0, |tally| tally.bins.len());
    Scattered {
        reflected: over(&|tally| tally.reflected),
        transmitted: over(&|tally| tally.transmitted),
        absorbed: over(&|tally| tally.absorbed),
        truncated: over(&|tally| tally.truncated),
        without_interference: over(&|tally| tally.without_interference),
        imbalance: over(&|t| 1.0 - t.reflected - t.transmitted - t.absorbed - t.truncated),
        bins: (0..bins).map(|bin| over(&|tally| tally.bins[bin])).collect(),
    }
}
