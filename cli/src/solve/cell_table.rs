//! BRDFs of cells of tilted facets: every incident direction traced, its light counted in bins.

use std::ops::Range;
use std::sync::OnceLock;

use glam::DVec3;
use goniochrome::colour::RgbSpace;
use goniochrome::geometry::mesh_cell::MeshCell;
use goniochrome::simd::lanes::{F32, F64, Lanes};
use goniochrome::table::ScatterLayout;

use crate::scene::Scene;
use crate::solve::checkpoint::{Checkpoint, Identity};
use crate::solve::coherent::BinLight;
use crate::solve::groups::{Group, Groups};
use crate::solve::mesh_scene::MeshScene;
use crate::solve::precision::Precision;
use crate::solve::scatter::{
    Adding, BATCHES, Coherence, Paths, ScatterRequest, Tally, Workspace, refuse_no_result, states, trace_batch,
};
use crate::support::error::{Error, Result};
use crate::support::memory::filled;
use crate::support::parallel;
use crate::table::metadata::Metadata;
use crate::table::scatter::{Energy, ScatterTable, check_scatter_size};
use crate::table::statistics::MeanWithError;

/// Starting rays of one incident direction beyond which `target_error` asks for no more.
pub const MAX_RAYS: u32 = 1 << 22;

/// What to compute besides a [`ScatterRequest`], whose bins must be those of the layout.
#[derive(Clone, Copy, Debug)]
pub struct TableRequest<'r> {
    /// The grid of directions.
    pub layout: ScatterLayout,
    /// Rays, seed, coherence, precision, threads; `rays` of each incident direction.
    pub tracing: ScatterRequest,
    /// Double the rays of an incident direction until the standard error of its albedo is no larger, or [`MAX_RAYS`].
    pub target_error: Option<f64>,
    /// Weights of XYZ for each wavelength.
    pub weights: &'r [[f64; 3]],
    /// The space of RGB.
    pub space: RgbSpace,
    /// Average f(wi, wo) and f(wo, wi): see [`reciprocal`].
    pub reciprocal: bool,
}

impl TableRequest<'_> {
    /// What decides the numbers that a checkpoint holds: everything but the number of threads and what is done to the finished
    /// table.
    #[must_use]
    pub fn identity(&self, scene: &Scene, wavelength_nm: &[f64]) -> Identity {
        let Self { layout, tracing, target_error, weights, .. } = self;
        let ScatterRequest { coherence, rays, seed, bins, precision, threads: _ } = tracing;
        let options = (layout, coherence, rays, seed, bins, precision, target_error);
        let identity = Identity::of_program();
        let identity = match scene.shape.polygons() {
            None => identity.and("scene", &(&scene.media, &scene.shape)),
            Some(cell) => {
                let mesh = cell.mesh();
                identity
                    .and("scene", &(&scene.media, cell.period_nm(), cell.interfaces()))
                    .and("mesh", &(&mesh.vertices, &mesh.triangles))
            }
        };
        identity.and("options", &options).and("wavelengths and illuminant", &(wavelength_nm, weights))
    }
}

/// The table of a cell, without metadata. `progress` is told of each finished incident direction. Directions that the
/// checkpoint holds are taken from it, the others are added to it.
///
/// Every direction has its rays in 32 independently scrambled batches; the error is that over batches. With one incident
/// azimuth (an isotropic table) the batches come from as many azimuths around the normal, and the error holds the spread
/// between them; where starting rays interfere, each azimuth has 32 batches of its own.
///
/// # Errors
/// Coherence `cell`, a table that is too large, more light left out than [`crate::solve::scatter::MAX_TRUNCATED`], a mesh that
/// the core refuses, a medium without data at a wavelength, a checkpoint that cannot be read or written.
pub fn estimate(
    mesh_scene: &MeshScene<'_>,
    wavelength_nm: &[f64],
    request: &TableRequest<'_>,
    checkpoint: Option<&Checkpoint>,
    progress: &(dyn Fn() + Sync),
) -> Result<ScatterTable> {
    check_scatter_size(&request.layout, wavelength_nm.len())?;
    let mut table = match request.tracing.precision {
        Precision::F32 => run::<F32>(mesh_scene, wavelength_nm, request, checkpoint, progress),
        Precision::F64 => run::<F64>(mesh_scene, wavelength_nm, request, checkpoint, progress),
    }?;
    if request.reciprocal {
        reciprocal(&mut table);
    }
    colour(&mut table, request);
    Ok(table)
}

/// How exits add in a table.
#[derive(Clone, Copy)]
enum Tabulated {
    Powers(Paths),
    Fields,
}

fn tabulated(coherence: Coherence) -> Result<Tabulated> {
    match coherence.adding() {
        Adding::Powers(paths) => Ok(Tabulated::Powers(paths)),
        Adding::Fields => Ok(Tabulated::Fields),
        Adding::Orders => Err(Error::usage(format_args!(
            "--coherence {}: a table holds no diffraction orders; use orders, or scatter with this option, for one direction of \
             the light",
            coherence.name()
        ))),
    }
}

fn run<V: Lanes>(
    mesh_scene: &MeshScene<'_>,
    wavelength_nm: &[f64],
    request: &TableRequest<'_>,
    checkpoint: Option<&Checkpoint>,
    progress: &(dyn Fn() + Sync),
) -> Result<ScatterTable> {
    let tabulated = tabulated(request.tracing.coherence)?;
    if let Tabulated::Fields = tabulated {
        BinLight::expect_room::<V>(&request.tracing)?;
    }
    let mut buffer = mesh_scene.buffer();
    let cell = mesh_scene.cell(&mut buffer)?;
    let media = mesh_scene.media();
    let mut groups = Groups::<V>::new(media.len(), wavelength_nm);
    let groups = groups
        .evaluate(&media, cell.above(), wavelength_nm)
        .map_err(|(index, error)| mesh_scene.scene().medium_error(index, &error))?;
    let layout = request.layout;
    let (bins, pairs) = (layout.bins().count(), layout.count());
    let mut table = ScatterTable {
        layout,
        wavelength_nm: wavelength_nm.to_vec(),
        brdf: filled(0.0, pairs * wavelength_nm.len(), "the table")?,
        rgb: filled([0.0; 3], pairs, "the table")?,
        luminance_error: filled(0.0, pairs, "the table")?,
        energy: filled(Energy::default(), layout.incident_count(), "the table")?,
        metadata: Metadata::default(),
    };
    let brdfs = table.brdf.chunks_mut(bins * wavelength_nm.len());
    let rows = brdfs.zip(table.luminance_error.chunks_mut(bins)).zip(&mut table.energy);
    let mut rows: Vec<_> = rows.map(|((brdf, error), energy)| Some(Direction { brdf, error, energy })).collect();
    if let Some(checkpoint) = checkpoint {
        checkpoint.restore(
            Direction::bytes(bins, wavelength_nm.len()),
            layout.incident_count(),
            |incident, part| {
                if let Some(mut direction) = rows[incident].take() {
                    direction.read(part);
                    progress();
                }
            },
        )?;
    }
    let lost = OnceLock::new();
    parallel::for_each(
        request.tracing.threads,
        rows.into_iter().enumerate().filter_map(|(incident, row)| Some((incident, row?))),
        || Worker {
            cell,
            groups: &groups,
            request,
            tabulated,
            states: states(mesh_scene),
            memory: Workspace::<V>::new(mesh_scene),
        },
        |worker, (incident, row)| {
            if lost.get().is_some() {
                return; // what nobody can keep, or use, is not worth computing
            }
            let energy = worker.direction(incident, row.brdf, row.error);
            *row.energy = energy;
            let totals = [energy.reflected.value, energy.transmitted, energy.absorbed, energy.truncated];
            let kept = refuse_no_result(mesh_scene, request.tracing.coherence, totals)
                .and_then(|()| checkpoint.map_or(Ok(()), |checkpoint| checkpoint.keep(incident, &row.write())));
            if let Err(error) = kept {
                let _ = lost.set(error);
            }
            progress();
        },
    );
    lost.into_inner().map_or(Ok(table), Err)
}

/// Numbers of an [`Energy`] besides its rays.
const ENERGIES: usize = 8;

/// The part of a table that one incident direction has.
struct Direction<'t> {
    brdf: &'t mut [f32],
    error: &'t mut [f32],
    energy: &'t mut Energy,
}

impl Direction<'_> {
    /// Of what [`Direction::write`] makes.
    fn bytes(bins: usize, wavelengths: usize) -> usize {
        bins * (wavelengths + 1) * size_of::<f32>() + ENERGIES * size_of::<f64>() + size_of::<u64>()
    }

    /// Its numbers for a checkpoint, little endian: energy, f, errors.
    fn write(&self) -> Vec<u8> {
        let Energy { reflected, transmitted, absorbed, truncated, imbalance, without_interference, rays } =
            *self.energy;
        let energy: [f64; ENERGIES] = [
            reflected.value,
            reflected.std_error,
            transmitted,
            absorbed,
            truncated,
            imbalance.value,
            imbalance.std_error,
            without_interference,
        ];
        let mut bytes = Vec::with_capacity(Self::bytes(self.error.len(), self.brdf.len() / self.error.len()));
        bytes.extend(energy.map(f64::to_le_bytes).as_flattened());
        bytes.extend(rays.to_le_bytes());
        bytes.extend(self.brdf.iter().chain(&*self.error).flat_map(|x| x.to_le_bytes()));
        bytes
    }

    /// Takes them back.
    fn read(&mut self, bytes: &[u8]) {
        let (energy, floats) = bytes.split_at((ENERGIES + 1) * size_of::<u64>());
        let (words, _) = energy.as_chunks();
        let number = |i: usize| f64::from_le_bytes(words[i]);
        *self.energy = Energy {
            reflected: MeanWithError { value: number(0), std_error: number(1) },
            transmitted: number(2),
            absorbed: number(3),
            truncated: number(4),
            imbalance: MeanWithError { value: number(5), std_error: number(6) },
            without_interference: number(7),
            rays: u64::from_le_bytes(words[ENERGIES]),
        };
        let (floats, _) = floats.as_chunks();
        let numbers = self.brdf.iter_mut().chain(&mut *self.error);
        numbers.zip(floats).for_each(|(number, bytes)| *number = f32::from_le_bytes(*bytes));
    }
}

/// A thread, with its memory for the tracer.
struct Worker<'w, V: Lanes> {
    cell: MeshCell<'w>,
    groups: &'w [Group<'w, V>],
    request: &'w TableRequest<'w>,
    tabulated: Tabulated,
    states: usize,
    memory: Workspace<V>,
}

/// What one batch has found so far, weighted by luminance.
#[derive(Clone, Default)]
struct Luminance {
    reflected: f64,
    transmitted: f64,
    absorbed: f64,
    truncated: f64,
    without_interference: f64,
    bins: Vec<f64>,
}

/// What one incident direction has found so far, in sums over starting rays.
struct Sums {
    /// `[wavelength][bin]`, in bins relative to the incident azimuth.
    power: Vec<f64>,
    batches: Vec<Luminance>,
}

/// A batch of starting rays of one incident direction.
#[derive(Clone, Copy)]
struct Batch {
    number: usize,
    /// The column of bins that holds the incident azimuth, which is relative column 0.
    first: usize,
    wi: DVec3,
    rays: f64,
}

impl Sums {
    fn new(wavelengths: usize, bins: usize) -> Self {
        let batch = Luminance { bins: vec![0.0; bins], ..Luminance::default() };
        Self { power: vec![0.0; wavelengths * bins], batches: vec![batch; BATCHES as usize] }
    }

    /// Adds the means over a batch's starting rays at one wavelength.
    fn add(&mut self, request: &TableRequest<'_>, batch: &Batch, wavelength: usize, tally: &Tally) {
        let bins = request.layout.bins();
        let (count, columns) = (bins.count(), bins.phi as usize);
        let weight = request.weights[wavelength][1] * batch.rays;
        let luminance = &mut self.batches[batch.number];
        luminance.reflected += weight * tally.reflected;
        luminance.transmitted += weight * tally.transmitted;
        luminance.absorbed += weight * tally.absorbed;
        luminance.truncated += weight * tally.truncated;
        luminance.without_interference += weight * tally.without_interference;
        let power = &mut self.power[wavelength * count..][..count];
        for (bin, &counted) in tally.bins.iter().enumerate().filter(|(_, counted)| **counted != 0.0) {
            let column = bin % columns;
            let relative = bin - column + (column + columns - batch.first) % columns;
            power[relative] += counted * batch.rays;
            luminance.bins[relative] += weight * counted;
        }
    }
}

impl<V: Lanes> Worker<'_, V> {
    /// Traces one incident direction into its rows of the table.
    fn direction(&mut self, incident: usize, brdf: &mut [f32], error: &mut [f32]) -> Energy {
        let request = self.request;
        let (bins, wavelengths) = (error.len(), brdf.len() / error.len());
        let mut sums = Sums::new(wavelengths, bins);
        // Independent scramblings for each direction: errors of neighbours must not agree by construction.
        let seed = request.tracing.seed.wrapping_mul(0x9e37_79b9).wrapping_add(incident as u32);
        let tracing = ScatterRequest { seed, threads: 1, ..request.tracing };
        let (mut from, mut to) = (0, (request.tracing.rays / BATCHES).max(1));
        loop {
            match self.tabulated {
                Tabulated::Powers(paths) => {
                    for number in 0..BATCHES as usize {
                        self.powers(&tracing, paths, incident, number, from..to, &mut sums);
                    }
                }
                Tabulated::Fields => {
                    sums = Sums::new(wavelengths, bins);
                    to = self.fields(&tracing, incident, to, &mut sums);
                }
            }
            let reflected = MeanWithError::over(sums.batches.iter().map(|batch| batch.reflected / f64::from(to)));
            let good = request.target_error.is_none_or(|target| reflected.std_error <= target);
            if good || to > MAX_RAYS / BATCHES / 2 {
                break;
            }
            (from, to) = (to, 2 * to);
        }
        self.flush(&sums, to, brdf, error)
    }

    /// Divides the sums over `to` starting rays of each batch.
    fn flush(&self, Sums { power, batches }: &Sums, to: u32, brdf: &mut [f32], error: &mut [f32]) -> Energy {
        let (request, bins) = (self.request, error.len());
        let per_ray = 1.0 / f64::from(to);
        let solid_angle: Vec<f64> = (0..bins).map(|bin| request.layout.bins().projected_solid_angle(bin)).collect();
        for (brdf, power) in brdf.chunks_mut(bins).zip(power.chunks(bins)) {
            for ((f, power), solid_angle) in brdf.iter_mut().zip(power).zip(&solid_angle) {
                // Where starting rays interfere, a bin without light holds noise of either sign.
                *f = (power * per_ray / f64::from(BATCHES) / solid_angle).max(0.0) as f32;
            }
        }
        for (bin, error) in error.iter_mut().enumerate() {
            let spread = MeanWithError::over(batches.iter().map(|batch| batch.bins[bin] * per_ray));
            *error = (spread.std_error / solid_angle[bin]) as f32;
        }
        let mean =
            |of: &dyn Fn(&Luminance) -> f64| MeanWithError::over(batches.iter().map(|batch| of(batch) * per_ray));
        let whole: f64 = request.weights.iter().map(|weight| weight[1]).sum::<f64>() * f64::from(to);
        Energy {
            reflected: mean(&|batch| batch.reflected),
            transmitted: mean(&|batch| batch.transmitted).value,
            absorbed: mean(&|batch| batch.absorbed).value,
            truncated: mean(&|batch| batch.truncated).value,
            imbalance: mean(&|b| whole - b.reflected - b.transmitted - b.absorbed - b.truncated),
            without_interference: mean(&|batch| batch.without_interference).value,
            rays: u64::from(to) * u64::from(BATCHES),
        }
    }

    /// A batch of so many starting rays. In an isotropic table each comes from an azimuth of its own.
    fn of(&self, incident: usize, number: usize, rays: u32) -> Batch {
        let layout = self.request.layout;
        let columns = layout.bins().phi as usize;
        let first = match layout.phi() {
            1 => number * columns / BATCHES as usize,
            _ => layout.first_bin(incident % layout.phi() as usize),
        };
        let theta = layout.incident(incident)[0];
        let phi = std::f64::consts::TAU * (first as f64 + 0.5) / columns as f64;
        let wi = DVec3::new(theta.sin() * phi.cos(), theta.sin() * phi.sin(), theta.cos());
        Batch { number, first, wi, rays: f64::from(rays) }
    }

    /// Adds the starting rays `rays` of one batch, which add as powers.
    fn powers(
        &mut self,
        tracing: &ScatterRequest,
        paths: Paths,
        incident: usize,
        number: usize,
        rays: Range<u32>,
        sums: &mut Sums,
    ) {
        let batch = self.of(incident, number, rays.end - rays.start);
        let bins = tracing.bins.count();
        let mut wavelength = 0;
        for (media, wavelengths) in self.groups {
            let mut tallies = vec![Tally::new(bins); wavelengths.len()];
            let (rays, memory) = (rays.clone(), &mut self.memory);
            trace_batch(self.cell, *media, batch.wi, number as u32, rays, paths, tracing, memory, &mut tallies);
            for tally in tallies {
                sums.add(self.request, &batch, wavelength, &tally);
                wavelength += 1;
            }
        }
    }

    /// Adds `rays` starting rays of each batch, which interfere. Returns how many they were: each azimuth of an
    /// isotropic table needs one in each of its own batches.
    fn fields(&self, tracing: &ScatterRequest, incident: usize, rays: u32, sums: &mut Sums) -> u32 {
        let Self { cell, states, .. } = *self;
        let isotropic = self.request.layout.phi() == 1;
        let rays = if isotropic { rays.div_ceil(BATCHES) * BATCHES } else { rays };
        let batches: Vec<Batch> = (0..BATCHES as usize).map(|number| self.of(incident, number, rays)).collect();
        let mut place = 0;
        for (media, wavelengths) in self.groups {
            if isotropic {
                for batch in &batches {
                    let seed = tracing.seed.wrapping_mul(BATCHES).wrapping_add(batch.number as u32);
                    let request = ScatterRequest { seed, ..*tracing };
                    let light = BinLight { cell, states, wi: batch.wi, rays: rays / BATCHES, request: &request };
                    let found = light.tallies(*media, wavelengths.len(), &|| ());
                    for w in 0..wavelengths.len() {
                        sums.add(self.request, batch, place + w, &Tally::mean(found.iter().map(|own| &own[w])));
                    }
                }
            } else {
                let light = BinLight { cell, states, wi: batches[0].wi, rays, request: tracing };
                let found = light.tallies(*media, wavelengths.len(), &|| ());
                for (batch, own) in batches.iter().zip(&found) {
                    own.iter().enumerate().for_each(|(w, tally)| sums.add(self.request, batch, place + w, tally));
                }
            }
            place += wavelengths.len();
        }
        rays
    }
}

/// Replaces f(wi, wo) by ½ [f(wi, wo) + f(wo, wi)], two estimates of one number: less noise, and a table that path tracers
/// may use from either end.
///
/// f(wo, wi) is looked up in the same table, linear between its incident directions and bins, for each middle of a bin that
/// lies inside the grid: θ_o between the first and the last θ_i, and θ_i between the middles of the first and the last row of
/// bins. Elsewhere, close to the horizon and to the normal, f(wi, wo) stays. The energies stay as traced.
pub fn reciprocal(table: &mut ScatterTable) {
    let layout = table.layout;
    let wavelengths = table.wavelength_nm.len();
    let bins = layout.bins().count();
    let ends = |first: f64, last: f64| first..=last;
    let thetas = ends(layout.incident(0)[0], layout.incident(layout.incident_count() - 1)[0]);
    let cosines = ends(layout.outgoing(0)[0], layout.outgoing(bins - 1)[0]);
    let (traced, traced_error) = (table.brdf.clone(), table.luminance_error.clone());
    for incident in 0..layout.incident_count() {
        let [theta_i, phi_i] = layout.incident(incident);
        for bin in 0..bins {
            let [cos_o, relative] = layout.outgoing(bin);
            let theta_o = cos_o.acos();
            if !(thetas.contains(&theta_o) && cosines.contains(&theta_i.cos())) {
                continue;
            }
            let from = layout.incident_nodes(theta_o as f32, (phi_i + relative) as f32);
            let to = layout.outgoing_nodes(theta_i.cos() as f32, -relative as f32);
            let nodes = from.map(|i| to.map(|o| (i.index, o.index, i.weight * o.weight)));
            let nodes = nodes.as_flattened().iter().filter(|node| node.2 > 0.0);
            for w in 0..wavelengths {
                let at = |incident: usize, bin: usize| traced[(incident * wavelengths + w) * bins + bin];
                let back: f32 = nodes.clone().map(|&(i, o, weight)| weight * at(i, o)).sum();
                table.brdf[(incident * wavelengths + w) * bins + bin] = 0.5 * (at(incident, bin) + back);
            }
            let variance = |weight: f32, error: f32| f64::from(weight * error).powi(2);
            let back: f64 = nodes.map(|&(i, o, weight)| variance(weight, traced_error[i * bins + o])).sum();
            let own = variance(1.0, traced_error[incident * bins + bin]);
            table.luminance_error[incident * bins + bin] = (0.5 * (own + back).sqrt()) as f32;
        }
    }
}

/// RGB of f from its spectra.
fn colour(table: &mut ScatterTable, request: &TableRequest<'_>) {
    let bins = table.layout.bins().count();
    let wavelengths = table.wavelength_nm.len();
    for (rgb, brdf) in table.rgb.chunks_mut(bins).zip(table.brdf.chunks(bins * wavelengths)) {
        for (bin, rgb) in rgb.iter_mut().enumerate() {
            let spectrum = (0..wavelengths).map(|w| f64::from(brdf[w * bins + bin]));
            *rgb = request.space.from_xyz(goniochrome::colour::xyz(request.weights, spectrum)).map(|c| c as f32);
        }
    }
}
