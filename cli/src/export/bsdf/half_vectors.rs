//! Scatter tables: the file holds the table's own numbers.
//!
//! A table holds s = f cos θ_i cos θ_o on a warped square of half vectors, which is the format's own. With D = 1 and
//! σ = cos θ_i/4 the file's values are s, and readers interpolate them as the table does. The format wants a square of
//! equally many samples along both sides: their steps are the largest that hit every node of the table, so that linear
//! interpolation gives the table back. With lobes of flat facets of a width the steps are smaller.

use std::f64::consts::{FRAC_PI_2, PI, TAU};

use glam::DVec3;
use goniochrome::table::{GridNode, HalfVectorWarp, ScatterLayout, ScatterTable as Lookup, tent_solid_angles};

use super::contents::{Contents, OverSquare, raise};
use super::grid::MAX_VALUES;
use crate::export::Reflection;
use crate::export::gaussian::Gaussian;
use crate::export::reflection::Evaluator;
use crate::support::direction::direction;
use crate::support::error::{Error, Result};
use crate::support::memory::filled;
use crate::support::parallel;
use crate::table::scatter::ScatterLookup;

/// Largest number of samples along a side of the square, less 1: that of nodes of a table.
const MAX_STEPS: usize = 1023;
/// Samples for each standard deviation of a lobe over half vectors, along θ_m, and between directions of the light.
const PER_LOBE: [f64; 2] = [2.0, 1.0];

/// Points within each step of the square at which the density of samples is fitted, along each side.
const POINTS: usize = 4;
/// Number of steps of the fit: more lower the variance by less than 4 % each.
const FITS: usize = 3;

/// Steps of the file: between θ_i, between φ_i, and along each side of the square.
#[derive(Clone, Copy, Debug, PartialEq)]
struct Steps {
    theta: usize,
    phi: usize,
    square: usize,
}

impl Steps {
    /// The steps of a table, each divided as often as the lobes of flat facets need, if there is room.
    fn new(layout: &ScatterLayout, channels: usize, gaussian: Option<Gaussian>) -> Result<Self> {
        let ([rows, columns], [u, v]) =
            (layout.incident_sides().map(|n| n as usize), layout.square_sides().map(|n| n as usize));
        let least = Self { theta: rows - 1, phi: if columns > 1 { columns } else { 0 }, square: lcm(u - 1, v) };
        if least.square > MAX_STEPS || least.values(channels) > MAX_VALUES {
            return Err(Error::failed(format_args!(
                "{u} × {v} half vectors share no square of a .bsdf file within {} MiB; estimate with --half-vectors {}x{}, \
                 whose steps fit",
                MAX_VALUES >> 18,
                v / 2 + 1,
                v / 2 * 2
            )));
        }
        let Some(Gaussian { spread }) = gaussian else { return Ok(least) };
        // A lobe over half vectors is half as wide as over directions.
        let width = 0.5 * spread;
        let wanted = [FRAC_PI_2 * PER_LOBE[0] / width / least.square as f64, FRAC_PI_2 / width / least.theta as f64];
        let mut steps = least;
        loop {
            let mut finer = steps;
            // Divides first what is furthest from what is wanted.
            let lacks = [
                wanted[0] * least.square as f64 / steps.square as f64,
                PER_LOBE[1] * wanted[1] * least.theta as f64 / steps.theta as f64,
            ];
            if lacks[0] >= lacks[1] {
                finer.square += least.square;
            } else {
                finer.theta += least.theta;
                finer.phi += least.phi;
            }
            let enough = lacks[0].max(lacks[1]) <= 1.0;
            if enough || finer.square > MAX_STEPS || finer.values(channels) > MAX_VALUES {
                return Ok(steps);
            }
            steps = finer;
        }
    }

    /// Number of values: those of the channels, and the density of samples.
    fn values(self, channels: usize) -> usize {
        (self.theta + 1) * (self.phi + 1) * (self.square + 1).pow(2) * (channels + 1)
    }
}

/// Least common multiple.
fn lcm(a: usize, b: usize) -> usize {
    let (mut divisor, mut rest) = (a, b);
    while rest > 0 {
        (divisor, rest) = (rest, divisor % rest);
    }
    a / divisor * b
}

/// The file's numbers of a table of scattered light.
///
/// # Errors
/// A table whose nodes fit no square of the format, or too little memory.
pub(super) fn contents(
    reflection: &Reflection,
    lookup: &ScatterLookup,
    gaussian: Option<Gaussian>,
) -> Result<Contents> {
    let table = lookup.table()?;
    let (layout, channels) = (lookup.layout(), lookup.channels());
    let steps = Steps::new(&layout, channels, gaussian)?;
    let side = steps.square + 1;
    let theta: Vec<f64> = (0..=steps.theta).map(|i| ScatterLayout::THETA_MAX * i as f64 / steps.theta as f64).collect();
    let phi: Vec<f64> = match steps.phi {
        0 => vec![0.0],
        turn => (0..=turn).map(|i| TAU * i as f64 / turn as f64 - PI).collect(),
    };
    let rows = theta.len();
    let (slices, area) = (theta.len() * phi.len(), side * side);
    let mut luminance = filled(0.0, slices * area, "the .bsdf file")?;
    let mut values = filled(0.0, slices * channels * area, "the .bsdf file")?;
    let square = ScatterLayout::new([2, 1], [side as u32, steps.square as u32], 0).map_err(Error::failed)?;
    let work = luminance.chunks_mut(area).zip(values.chunks_mut(channels * area)).enumerate();
    parallel::for_each(
        parallel::available(),
        work,
        || reflection.evaluator(),
        |evaluator, (i, (luminance, values))| {
            let incident = [theta[i % theta.len()], phi[i / theta.len()]];
            fill(evaluator, &table, lookup, &square, incident, luminance, values);
        },
    );
    let warp = table.warp();
    let [of_u, of_v] = [0, 1].map(|axis| (0..warp.knots()[axis]).map(|knot| warp.density(axis, knot)).collect());
    let least = ScatterLayout::THETA_MAX.cos();
    Ok(Contents {
        theta,
        phi,
        across: of_u,
        along: vec![of_v; slices / rows],
        side,
        luminance,
        values,
        density_of_facets: OverSquare::isotropic(|_| 1.0),
        visible_area: OverSquare::isotropic(|theta| 0.25 * theta.cos().max(least)),
    })
}

/// Computes the numbers of one incident direction on a square whose last row repeats the first.
fn fill(
    evaluator: &mut Evaluator<'_>,
    table: &Lookup<'_>,
    lookup: &ScatterLookup,
    square: &ScatterLayout,
    [theta, phi]: [f64; 2],
    luminance: &mut [f32],
    values: &mut [f32],
) {
    let (wi, warp) = (direction(theta, phi), table.warp());
    let (channels, area) = (table.channels(), luminance.len());
    let incident = lookup.layout().incident_nodes(wi.as_vec3());
    let side = square.square_sides()[0] as usize;
    let mut here = vec![0.0; channels];
    let mut strength = vec![0.0; area];
    for row in 0..side {
        for column in 0..side {
            let at = row * side + column;
            if row + 1 == side {
                strength[at] = strength[column];
                values.chunks_mut(area).for_each(|channel| channel[at] = channel[column]);
                continue;
            }
            let [x, y] = square.node(at);
            interpolate(lookup, &incident, [x, y], &mut here);
            facets(evaluator, &warp, wi, [x, y], &mut here);
            // Of all densities for all channels, the root of the sum of squares has the smallest sum of variances.
            strength[at] = here.iter().map(|s| s * s).sum::<f32>().sqrt();
            values.chunks_mut(area).zip(&here).for_each(|(channel, s)| channel[at] = *s);
        }
    }
    // Solid angle above the horizon that a node stands for, over the area of its tent, which is half at the ends of x.
    tent_solid_angles(square, &warp, wi.as_vec3(), phi as f32, |node, solid_angle| luminance[node] += solid_angle);
    for row in 0..side - 1 {
        luminance[row * side] *= 2.0;
        luminance[row * side + side - 1] *= 2.0;
    }
    luminance.copy_within(..side, area - side);
    luminance.iter_mut().zip(&strength).for_each(|(density, strength)| *density *= strength);
    let points = points(side, &strength, |[x, y], strength| {
        let (m, solid_angle) = warp.half_vector([x, y], phi as f32);
        let visible = wi.as_vec3().dot(m);
        if 2.0 * visible * m.z > wi.z as f32 { strength * solid_angle * visible } else { 0.0 }
    });
    fit(luminance, side, &points);
    raise(luminance);
}

/// Calls `of` with places of the square and the nodes' values interpolated there: [`POINTS`] times as many along each
/// side as there are steps.
fn points(side: usize, nodes: &[f32], of: impl Fn([f32; 2], f32) -> f32) -> Vec<f32> {
    let last = side - 1;
    let count = POINTS * last;
    let place = |i: usize| (i as f32 + 0.5) / POINTS as f32;
    let all = (0..count).flat_map(|row| (0..count).map(move |column| [column, row]));
    all.map(|at| {
        let value: f32 = corners(at).map(|([u, v], weight)| weight * nodes[v * side + u]).iter().sum();
        of(at.map(|i| place(i) / last as f32), value)
    })
    .collect()
}

/// The four nodes around a point, as column and row, with their weights.
fn corners(point: [usize; 2]) -> [([usize; 2], f32); 4] {
    let [u, v] = point.map(|i| i / POINTS);
    let [x, y] = point.map(|i| ((i % POINTS) as f32 + 0.5) / POINTS as f32);
    [([u, v], (1.0 - x) * (1.0 - y)), ([u + 1, v], x * (1.0 - y)), ([u, v + 1], (1.0 - x) * y), ([u + 1, v + 1], x * y)]
}

/// Moves the density p of samples at the nodes towards the one with the smallest variance, ∫ g²/p for the light g at
/// the points: there ∫ t g²/p² over ∫ t is the same for the tent t of each node. Near the normal g grows as the third
/// power of u, which the light at the nodes alone does not tell.
fn fit(density: &mut [f32], side: usize, light: &[f32]) {
    let count = POINTS * (side - 1);
    for _ in 0..FITS {
        let mut sums = vec![[0.0f32; 2]; density.len()];
        for (at, light) in light.iter().enumerate() {
            let corners = corners([at % count, at / count]).map(|([u, v], weight)| (v * side + u, weight));
            let here: f32 = corners.iter().map(|(node, weight)| weight * density[*node]).sum();
            let ratio = if here > 0.0 { light / here } else { 0.0 };
            for (node, weight) in corners {
                sums[node][0] += weight * ratio * ratio;
                sums[node][1] += weight;
            }
        }
        // The last row repeats the first.
        for column in 0..side {
            let both = [0, 1].map(|part| sums[column][part] + sums[(side - 1) * side + column][part]);
            sums[column] = both;
            sums[(side - 1) * side + column] = both;
        }
        density.iter_mut().zip(sums).for_each(|(density, [ratio, weight])| *density *= (ratio / weight).sqrt());
    }
}

/// s in each channel at a place of the square, for light between these incident directions.
fn interpolate(lookup: &ScatterLookup, incident: &[GridNode; 4], [x, y]: [f64; 2], out: &mut [f32]) {
    let layout = lookup.layout();
    let channels = out.len();
    out.fill(0.0);
    for node in layout.square_nodes(x as f32, y as f32).iter().filter(|node| node.weight > 0.0) {
        for light in incident.iter().filter(|light| light.weight > 0.0) {
            let first = (light.index * layout.places() + node.index) * channels;
            let weight = light.weight * node.weight;
            out.iter_mut().zip(&lookup.values()[first..]).for_each(|(out, s)| *out += weight * s);
        }
    }
}

/// Adds s of the lobes of flat facets.
fn facets(evaluator: &mut Evaluator<'_>, warp: &HalfVectorWarp<'_>, wi: DVec3, [x, y]: [f64; 2], s: &mut [f32]) {
    let (m, _) = warp.half_vector([x as f32, y as f32], 0.0);
    let m = m.as_dvec3().normalize();
    let wo = 2.0 * wi.dot(m) * m - wi;
    let mut lobes = vec![0.0; s.len()];
    evaluator.add_facets(wi, wo, wi.z, &mut lobes);
    s.iter_mut().zip(lobes).for_each(|(s, lobe)| *s += lobe as f32);
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::export::reflection::{LobeWidth, ReflectionKind};
    use crate::table::Table;
    use crate::table::mirror::neighbours;
    use crate::table::scatter::ScatterTable;
    use crate::table::scatter::tests::sample;

    /// Some twenty roundings of single precision, in the place in the square and in the values.
    const SINGLE: f64 = 20.0 * f32::EPSILON as f64;

    /// The sample table, with one number along the normal, where there is no azimuth.
    fn table() -> ScatterTable {
        let mut table = sample();
        let size = table.wavelength_nm.len() * table.layout.places();
        table.values.copy_within(..size, size);
        table
    }

    /// f cos θ_o in each channel as readers of a file interpolate it.
    fn read(contents: &Contents, channels: usize, wi: DVec3, wo: DVec3) -> Vec<f64> {
        let densities = [&contents.across[..], &contents.along[0]];
        let mut memory = vec![0.0; HalfVectorWarp::required_len(densities.map(<[f32]>::len))];
        let warp = HalfVectorWarp::new(densities, &mut memory).unwrap();
        let [x, y] = warp.warped(wi.as_vec3(), wo.as_vec3(), 0.0).place.map(f64::from);
        let nodes: Vec<f64> = (0..contents.side).map(|i| i as f64 / (contents.side - 1) as f64).collect();
        let (theta, phi) = (wi.z.acos(), wi.y.atan2(wi.x));
        let axes = [
            neighbours(&contents.phi, phi),
            neighbours(&contents.theta, theta),
            neighbours(&nodes, y),
            neighbours(&nodes, x),
        ];
        let mut total = vec![0.0; channels];
        for corner in 0..16 {
            let ends = [0, 1, 2, 3].map(|axis| {
                let (below, above, weight) = axes[axis];
                if corner >> axis & 1 == 0 { (below, 1.0 - weight) } else { (above, weight) }
            });
            let [phi, theta, v, u] = ends.map(|(place, _)| place);
            let weight: f64 = ends.iter().map(|(_, weight)| weight).product();
            for (channel, total) in total.iter_mut().enumerate() {
                let plane = (phi * contents.theta.len() + theta) * channels + channel;
                let value = contents.values[(plane * contents.side + v) * contents.side + u];
                *total += weight * f64::from(value) / wi.z.max(ScatterLayout::THETA_MAX.cos());
            }
        }
        total
    }

    #[test]
    fn readers_of_a_file_get_the_table() {
        let reflection = Reflection::scatter(&table(), None, false).unwrap();
        let ReflectionKind::Scatter(lookup, None) = reflection.kind() else { panic!("a scatter table") };
        let contents = contents(&reflection, lookup, None).unwrap();
        assert_eq!((contents.side, contents.theta.len(), contents.phi.len()), (3, 2, 3));
        let mut evaluator = reflection.evaluator();
        let mut f = [0.0; 2];
        for i in 0..500 {
            let turn = |step: f64| f64::from(i) * step % 1.0;
            let wi = direction(1.57 * turn(0.618), TAU * turn(0.755) - PI);
            let wo = direction(1.57 * turn(0.569), TAU * turn(0.414) - PI);
            evaluator.eval(wi, wo, &mut f);
            for (found, f) in read(&contents, 2, wi, wo).into_iter().zip(f) {
                assert!((found / (f * wo.z) - 1.0).abs() < SINGLE, "{wi} {wo}: {found} for {}", f * wo.z);
            }
        }
    }

    #[test]
    fn lobes_of_flat_facets_have_the_width_that_is_asked_for() {
        let table = Table::from(table());
        let width = LobeWidth { spread_deg: Some(12.0), ..LobeWidth::default() };
        let reflection = Reflection::new(&table, width, false).unwrap();
        let ReflectionKind::Scatter(lookup, gaussian) = reflection.kind() else { panic!("a scatter table") };
        let contents = contents(&reflection, lookup, *gaussian).unwrap();
        let mut evaluator = reflection.evaluator();
        let mut f = [0.0; 2];
        for (theta, off) in [(0.3, 0.0), (0.3, 0.2), (0.8, 0.1), (1.0, -0.2)] {
            let (wi, wo) = (direction(theta, 0.4), direction(theta + off, 0.4 + PI));
            evaluator.eval(wi, wo, &mut f);
            let found = read(&contents, 2, wi, wo);
            // A step of half a standard deviation errs by 1/32 of the peak in each of two directions.
            assert!((found[0] / (f[0] * wo.z) - 1.0).abs() < 0.1, "{theta} {off}: {} for {}", found[0], f[0] * wo.z);
        }
    }

    #[test]
    fn a_table_whose_nodes_share_no_square_is_refused_with_one_that_does() {
        let steps = |square| Steps::new(&ScatterLayout::new([10, 12], square, 0).unwrap(), 3, None);
        assert_eq!(steps([17, 32]), Ok(Steps { theta: 9, phi: 12, square: 32 }));
        let refusal = steps([32, 64]).unwrap_err().to_string();
        assert!(refusal.contains("--half-vectors 33x64"), "{refusal}");
        assert_eq!(steps([33, 64]).unwrap().square, 64);
    }
}
