//! BRDFs of cells of tilted facets: every incident direction traced, its light counted in bins.

use std::sync::OnceLock;

use glam::DVec3;
use goniochrome::colour::RgbSpace;
use goniochrome::lanes::{F32, F64, Lanes};
use goniochrome::mesh::MeshCell;
use goniochrome::table::ScatterLayout;

use crate::bumpy::Bumpy;
use crate::checkpoint::{Checkpoint, Identity};
use crate::error::Result;
use crate::estimate::Precision;
use crate::groups::{Group, Groups};
use crate::memory::filled;
use crate::parallel;
use crate::scatter::{BATCHES, Estimate, Request, Tally, Workspace, converged, trace_batch};
use crate::scatter_table::{Energy, ScatterTable, check_scatter_size};
use crate::scene::{Scene, Shape};

/// Starting rays of one incident direction beyond which `target_error` asks for no more.
pub const MOST_RAYS: u32 = 1 << 22;

/// What to compute besides a [`Request`], whose bins must be those of the layout.
#[derive(Clone, Copy, Debug)]
pub struct TableRequest<'r> {
    /// The grid of directions.
    pub layout: ScatterLayout,
    /// Rays, seed, coherence, precision, threads; `rays` of each incident direction.
    pub tracing: Request,
    /// Double the rays of an incident direction until the standard error of its albedo is no larger, or [`MOST_RAYS`].
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
        let Request { coherence, rays, seed, bins, precision, threads: _ } = tracing;
        let options = (layout, coherence, rays, seed, bins, precision, target_error);
        let identity = Identity::of_program();
        let identity = match &scene.shape {
            Shape::Stack { .. } => identity.and("scene", &(&scene.media, &scene.shape)),
            Shape::Cell { mesh, period_nm, interfaces } => identity
                .and("scene", &(&scene.media, period_nm, interfaces))
                .and("mesh", &(&mesh.vertices, &mesh.triangles)),
        };
        identity.and("options", &options).and("wavelengths and illuminant", &(wavelength_nm, weights))
    }
}

/// The table of a cell, without metadata. `progress` is told of each finished incident direction. Directions that the
/// checkpoint holds are taken from it, the others are added to it.
///
/// Every direction has its rays in 32 independently scrambled batches; the error is that over batches. With one incident
/// azimuth (an isotropic table) the batches come from as many azimuths around the normal, and the error holds the spread
/// between them.
///
/// # Errors
/// A table that is too large, a mesh that the core refuses, a medium without data at a wavelength, a checkpoint that cannot be
/// read or written.
pub fn estimate(
    bumpy: &Bumpy<'_>,
    wavelength_nm: &[f64],
    request: &TableRequest<'_>,
    checkpoint: Option<&Checkpoint>,
    progress: &(dyn Fn() + Sync),
) -> Result<ScatterTable> {
    check_scatter_size(&request.layout, wavelength_nm.len())?;
    let mut table = match request.tracing.precision {
        Precision::F32 => run::<F32>(bumpy, wavelength_nm, request, checkpoint, progress),
        Precision::F64 => run::<F64>(bumpy, wavelength_nm, request, checkpoint, progress),
    }?;
    if request.reciprocal {
        reciprocal(&mut table);
    }
    colour(&mut table, request);
    Ok(table)
}

fn run<V: Lanes>(
    bumpy: &Bumpy<'_>,
    wavelength_nm: &[f64],
    request: &TableRequest<'_>,
    checkpoint: Option<&Checkpoint>,
    progress: &(dyn Fn() + Sync),
) -> Result<ScatterTable> {
    let mut buffer = bumpy.buffer();
    let cell = bumpy.cell(&mut buffer)?;
    let media = bumpy.media();
    let mut groups = Groups::<V>::new(media.len(), wavelength_nm);
    let groups = groups
        .evaluate(&media, cell.above(), wavelength_nm)
        .map_err(|(index, error)| bumpy.medium_error(index, &error))?;
    let layout = request.layout;
    let (bins, pairs) = (layout.bins().count(), layout.count());
    let mut table = ScatterTable {
        layout,
        wavelength_nm: wavelength_nm.to_vec(),
        brdf: filled(0.0, pairs * wavelength_nm.len(), "the table")?,
        rgb: filled([0.0; 3], pairs, "the table")?,
        luminance_error: filled(0.0, pairs, "the table")?,
        energy: filled(Energy::default(), layout.incident_count(), "the table")?,
        metadata: std::collections::BTreeMap::default(),
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
        || Worker(Workspace::<V>::new(bumpy)),
        |worker, (incident, row)| {
            if lost.get().is_some() {
                return; // what nobody can keep, or use, is not worth computing
            }
            let energy = worker.direction(cell, &groups, request, incident, row.brdf, row.error);
            *row.energy = energy;
            let kept =
                converged(bumpy, [energy.reflected.value, energy.transmitted, energy.absorbed, energy.truncated])
                    .and_then(|()| checkpoint.map_or(Ok(()), |checkpoint| checkpoint.keep(incident, &row.write())));
            if let Err(error) = kept {
                let _ = lost.set(error);
            }
            progress();
        },
    );
    lost.into_inner().map_or(Ok(table), Err)
}

/// The part of a table that one incident direction has.
struct Direction<'t> {
    brdf: &'t mut [f32],
    error: &'t mut [f32],
    energy: &'t mut Energy,
}

impl Direction<'_> {
    /// Of what [`Direction::write`] makes.
    fn bytes(bins: usize, wavelengths: usize) -> usize {
        bins * (wavelengths + 1) * size_of::<f32>() + 5 * size_of::<f64>() + size_of::<u64>()
    }

    /// Its numbers for a checkpoint, little endian: energy, f, errors.
    fn write(&self) -> Vec<u8> {
        let Energy { reflected: Estimate { value, std_error }, transmitted, absorbed, truncated, rays } = *self.energy;
        let energy = [value, std_error, transmitted, absorbed, truncated].map(f64::to_le_bytes);
        let mut bytes = Vec::with_capacity(Self::bytes(self.error.len(), self.brdf.len() / self.error.len()));
        bytes.extend(energy.as_flattened());
        bytes.extend(rays.to_le_bytes());
        bytes.extend(self.brdf.iter().chain(&*self.error).flat_map(|x| x.to_le_bytes()));
        bytes
    }

    /// Takes them back.
    fn read(&mut self, bytes: &[u8]) {
        let (energy, floats) = bytes.split_at(6 * size_of::<u64>());
        let (words, _) = energy.as_chunks();
        let number = |i: usize| f64::from_le_bytes(words[i]);
        *self.energy = Energy {
            reflected: Estimate { value: number(0), std_error: number(1) },
            transmitted: number(2),
            absorbed: number(3),
            truncated: number(4),
            rays: u64::from_le_bytes(words[5]),
        };
        let (floats, _) = floats.as_chunks();
        let numbers = self.brdf.iter_mut().chain(&mut *self.error);
        numbers.zip(floats).for_each(|(number, bytes)| *number = f32::from_le_bytes(*bytes));
    }
}

/// A thread, with its memory for the tracer.
struct Worker<V: Lanes>(Workspace<V>);

/// What one batch has found so far, weighted by luminance.
#[derive(Clone, Default)]
struct Luminance {
    reflected: f64,
    transmitted: f64,
    absorbed: f64,
    truncated: f64,
    bins: Vec<f64>,
}

impl<V: Lanes> Worker<V> {
    /// Traces one incident direction into its rows of the table.
    fn direction(
        &mut self,
        cell: MeshCell<'_>,
        groups: &[Group<'_, V>],
        request: &TableRequest<'_>,
        incident: usize,
        brdf: &mut [f32],
        error: &mut [f32],
    ) -> Energy {
        let bins = error.len();
        let mut power = vec![0.0; brdf.len()];
        let mut batches = vec![Luminance { bins: vec![0.0; bins], ..Luminance::default() }; BATCHES as usize];
        // Independent scramblings for each direction: errors of neighbours must not agree by construction.
        let seed = request.tracing.seed.wrapping_mul(0x9e37_79b9).wrapping_add(incident as u32);
        let tracing = Request { seed, ..request.tracing };
        let (mut from, mut to) = (0, (request.tracing.rays / BATCHES).max(1));
        loop {
            for (batch, luminance) in batches.iter_mut().enumerate() {
                self.batch(cell, groups, request, &tracing, incident, batch, from..to, &mut power, luminance);
            }
            let reflected = over_batches(batches.iter().map(|batch| batch.reflected / f64::from(to)));
            let good = request.target_error.is_none_or(|target| reflected.std_error <= target);
            if good || to > MOST_RAYS / BATCHES / 2 {
                break;
            }
            (from, to) = (to, 2 * to);
        }
        let per_ray = 1.0 / f64::from(to);
        let solid_angle: Vec<f64> = (0..bins).map(|bin| request.layout.bins().projected_solid_angle(bin)).collect();
        for (brdf, power) in brdf.chunks_mut(bins).zip(power.chunks(bins)) {
            for ((f, power), solid_angle) in brdf.iter_mut().zip(power).zip(&solid_angle) {
                *f = (power * per_ray / f64::from(BATCHES) / solid_angle) as f32;
            }
        }
        for (bin, error) in error.iter_mut().enumerate() {
            let spread = over_batches(batches.iter().map(|batch| batch.bins[bin] * per_ray));
            *error = (spread.std_error / solid_angle[bin]) as f32;
        }
        let mean = |of: fn(&Luminance) -> f64| over_batches(batches.iter().map(|batch| of(batch) * per_ray));
        Energy {
            reflected: mean(|batch| batch.reflected),
            transmitted: mean(|batch| batch.transmitted).value,
            absorbed: mean(|batch| batch.absorbed).value,
            truncated: mean(|batch| batch.truncated).value,
            rays: u64::from(to) * u64::from(BATCHES),
        }
    }

    /// Adds the starting rays `rays` of one batch, in relative bins.
    #[allow(clippy::too_many_arguments)]
    fn batch(
        &mut self,
        cell: MeshCell<'_>,
        groups: &[Group<'_, V>],
        request: &TableRequest<'_>,
        tracing: &Request,
        incident: usize,
        batch: usize,
        rays: std::ops::Range<u32>,
        power: &mut [f64],
        luminance: &mut Luminance,
    ) {
        let layout = request.layout;
        let (bins, columns) = (layout.bins().count(), layout.bins().phi as usize);
        let first = match layout.phi() {
            1 => batch * columns / BATCHES as usize,
            _ => layout.first_bin(incident % layout.phi() as usize),
        };
        let theta = layout.incident(incident)[0];
        let phi = std::f64::consts::TAU * (first as f64 + 0.5) / columns as f64;
        let wi = DVec3::new(theta.sin() * phi.cos(), theta.sin() * phi.sin(), theta.cos());
        let count = f64::from(rays.end - rays.start);
        let mut wavelength = 0;
        for (group, wavelengths) in groups {
            let mut tallies = vec![Tally::new(bins); wavelengths.len()];
            trace_batch(cell, *group, wi, batch as u32, rays.clone(), tracing, &mut self.0, &mut tallies);
            for tally in tallies {
                let weight = request.weights[wavelength][1] * count;
                luminance.reflected += weight * tally.reflected;
                luminance.transmitted += weight * tally.transmitted;
                luminance.absorbed += weight * tally.absorbed;
                luminance.truncated += weight * tally.truncated;
                let power = &mut power[wavelength * bins..][..bins];
                for (bin, counted) in tally.bins.into_iter().enumerate().filter(|(_, counted)| *counted > 0.0) {
                    let column = bin % columns;
                    let relative = bin - column + (column + columns - first) % columns;
                    power[relative] += counted * count;
                    luminance.bins[relative] += weight * counted;
                }
                wavelength += 1;
            }
        }
    }
}

/// Mean over batches and its standard error.
fn over_batches(values: impl Iterator<Item = f64> + Clone) -> Estimate {
    let count = f64::from(BATCHES);
    let value = values.clone().sum::<f64>() / count;
    let variance = values.map(|x| (x - value) * (x - value)).sum::<f64>() / (count - 1.0);
    Estimate { value, std_error: (variance / count).sqrt() }
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
