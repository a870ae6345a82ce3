//! Tests of the BRDF tables of scattering surfaces: look-up, albedo, density and drawn directions agree with one
//! another.

use core::f64::consts::{FRAC_PI_2, PI, TAU};

use glam::{DVec3, Vec3};
use goniochrome::measure::bins::DirectionBins;
use goniochrome::table::{
    FacetLobe, HalfVectorWarp, MIN_COS, ScatterLayout, ScatterSampler, ScatterTable, TableError, tent_solid_angles,
};
use goniochrome::trace::random::Random;
use goniochrome::trace::sobol::sobol;

/// Numbers of a table: s at the nodes, then ρ of the lobes, for each incident direction and channel.
struct Numbers {
    layout: ScatterLayout,
    channels: usize,
    warp: Vec<f32>,
    knots: usize,
    lobes: Vec<[f32; FacetLobe::LEN]>,
    values: Vec<f32>,
}

const ALONG_U: [f32; 4] = [1.0, 3.0, 0.5, 0.5];
const ALONG_V: [f32; 5] = [2.0, 0.5, 1.0, 0.5, 2.0];
/// Power of a lobe in all channels, from all directions.
const RHO: f64 = 0.25;

impl Numbers {
    /// s of θ_i, φ_i, the half vector in the frame in which its azimuth counts, and the channel.
    fn new(layout: ScatterLayout, channels: usize, s: impl Fn([f64; 2], DVec3, usize) -> f64) -> Self {
        let mut warp = vec![0.0; HalfVectorWarp::required_len([ALONG_U.len(), ALONG_V.len()])];
        let half_vectors = HalfVectorWarp::new([&ALONG_U, &ALONG_V], &mut warp).unwrap();
        let mut values = Vec::new();
        for incident in 0..layout.incident_count() {
            for node in 0..layout.node_count() {
                let (m, _) = half_vectors.half_vector(layout.node(node).map(|x| x as f32), 0.0);
                let s = |channel| s(layout.incident(incident), m.as_dvec3(), channel) as f32;
                values.extend((0..channels).map(s));
            }
            values.extend(std::iter::repeat_n(RHO as f32, layout.lobes() * channels));
        }
        let normals = [Vec3::new(0.28, 0.0, 0.96), Vec3::new(0.0, -0.6, 0.8)];
        let lobes = normals.iter().cycle().take(layout.lobes());
        let lobes = lobes.map(|normal| FacetLobe::reflection(*normal).to_numbers()).collect();
        Self { layout, channels, warp, knots: ALONG_U.len(), lobes, values }
    }

    fn warp(&self) -> HalfVectorWarp<'_> {
        let (u, v) = self.warp.split_at(2 * self.knots);
        HalfVectorWarp::from_pairs(u, v).unwrap()
    }

    fn table(&self) -> ScatterTable<'_> {
        ScatterTable::new(&self.values, self.layout, self.warp(), &self.lobes, self.channels).unwrap()
    }
}

fn direction(theta: f64, phi: f64) -> Vec3 {
    let ((sin, cos), (sin_phi, cos_phi)) = (theta.sin_cos(), phi.sin_cos());
    Vec3::new((sin * cos_phi) as f32, (sin * sin_phi) as f32, cos as f32)
}

fn anisotropic(lobes: u32) -> ScatterLayout {
    ScatterLayout::new([5, 4], [7, 12], lobes).unwrap()
}

fn isotropic(lobes: u32) -> ScatterLayout {
    ScatterLayout::new([5, 1], [7, 12], lobes).unwrap()
}

/// Facets around a tilted normal, whose strength varies with the light. One channel is negative.
fn facets([theta, phi]: [f64; 2], m: DVec3, channel: usize) -> f64 {
    let around = m.dot(DVec3::new(0.2, -0.1, 1.0).normalize());
    let strength = (1.0 + 0.5 * theta.sin() * phi.cos()) * [1.0, 0.3, -0.05][channel];
    if around > 0.6 { 0.2 * strength * around.powi(12) } else { 0.0 }
}

fn tables() -> [Numbers; 4] {
    [anisotropic(0), anisotropic(2), isotropic(0), isotropic(1)].map(|layout| Numbers::new(layout, 3, facets))
}

const DIRECTIONS: [[f64; 2]; 6] = [[0.02, 0.3], [0.4, 1.0], [0.9, -2.0], [1.2, 3.1], [1.5, 0.0], [1.0, 6.2]];

/// Calls `at` for half vectors in the middles of side × side even cells of the warped square whose light leaves above
/// the horizon, with the outgoing direction and the solid angle of the cell.
fn hemisphere(table: &ScatterTable<'_>, wi: Vec3, side: u32, mut at: impl FnMut(Vec3, f64)) {
    let origin = table.layout().origin(wi);
    let place = |i: u32| (i as f32 + 0.5) / side as f32;
    for (i, j) in (0..side).flat_map(|i| (0..side).map(move |j| (i, j))) {
        let (m, solid_angle) = table.warp().half_vector([place(i), place(j)], origin);
        let wo = 2.0 * wi.dot(m) * m - wi;
        if wi.dot(m) > 0.0 && wo.z > 0.0 {
            at(wo.normalize(), f64::from(solid_angle * wi.dot(m)) / f64::from(side * side));
        }
    }
}

/// Side with which [`hemisphere`] integrates.
const SIDE: u32 = 500;
/// Error of that for an integrand of the order of 1 per steradian, as a part of it: cells that the horizon cuts count
/// whole or not at all. For light near the normal they are all of one x, whose solid angle is 1/100 of the hemisphere.
const QUADRATURE: f64 = 5e-3;

#[test]
fn a_node_holds_its_value() {
    for numbers in tables() {
        let (table, layout) = (numbers.table(), numbers.layout);
        let mut compared = 0;
        for incident in 0..layout.incident_count() {
            let [theta, phi] = layout.incident(incident);
            let wi = direction(theta, phi);
            for node in 0..layout.node_count() {
                let (m, _) = table.warp().half_vector(layout.node(node).map(|x| x as f32), 0.0);
                let wo = 2.0 * wi.dot(m) * m - wi;
                // Along the normal and at the pole there is no azimuth; the rounding of a direction at the horizon is
                // large beside its cosine.
                if wo.z > 0.05 && theta > 0.0 && m.z < 0.999 {
                    let rgb = table.rgb(wi, wo).map(|f| f64::from(f * wi.z * wo.z));
                    for (channel, found) in rgb.into_iter().enumerate() {
                        let expected = facets([theta, phi], m.as_dvec3(), channel);
                        assert!((found - expected).abs() < 1e-5, "{incident} {node}: {found} for {expected}");
                    }
                    compared += 1;
                }
            }
        }
        assert!(compared > layout.incident_count() * 10, "{compared}");
    }
}

#[test]
fn coordinates_stay_when_the_directions_are_exchanged() {
    let numbers = Numbers::new(anisotropic(0), 1, |_, _, _| 1.0);
    let directions = DIRECTIONS.map(|[theta, phi]| direction(theta, phi));
    for (wi, wo) in directions.into_iter().flat_map(|wi| directions.map(|wo| (wi, wo))) {
        assert_eq!(numbers.warp().warped(wi, wo, 0.3), numbers.warp().warped(wo, wi, 0.3));
        // So what does not depend on the light is reciprocal, up to the largest angle of the grid.
        let (there, back) = (numbers.table().rgb(wi, wo)[0], numbers.table().rgb(wo, wi)[0]);
        assert!((there / back - 1.0).abs() < 1e-5, "{wi} {wo}: {there} {back}");
    }
}

#[test]
fn the_square_covers_the_hemisphere_once() {
    let numbers = Numbers::new(anisotropic(0), 1, |_, _, _| 1.0);
    for [theta, phi] in DIRECTIONS {
        let wi = direction(theta, phi);
        let mut solid_angle = 0.0;
        hemisphere(&numbers.table(), wi, SIDE, |_, part| solid_angle += part);
        assert!((solid_angle / TAU - 1.0).abs() < QUADRATURE, "{theta}: {solid_angle}");
        let (mut tents, mut negative) = (0.0, 0);
        tent_solid_angles(&numbers.layout, &numbers.warp(), wi, 0.0, |node, part| {
            assert!(node < numbers.layout.node_count());
            tents += f64::from(part);
            negative += u32::from(part < 0.0);
        });
        assert!((tents / TAU - 1.0).abs() < 5e-4 && negative == 0, "{theta}: {tents}");
    }
}

#[test]
fn look_ups_are_continuous_across_the_seam_at_the_pole_and_along_the_normal() {
    const STEP: f64 = 1e-4;
    for numbers in tables() {
        let table = numbers.table();
        let s = |wi: Vec3, m: Vec3| {
            let wo = 2.0 * wi.dot(m) * m - wi;
            f64::from(table.rgb(wi, wo)[0] * wi.z * wo.z)
        };
        // A step of 10⁻⁴ rad changes s, at most 0.3, by its slope, of the order of 1 per radian.
        let close = |a: f64, b: f64| assert!((a - b).abs() < 20.0 * STEP && a > 0.0, "{a} {b}");
        let origin = |wi| f64::from(numbers.layout.origin(wi));
        for [theta, phi] in [[0.3, 1.0], [0.7, -2.0]] {
            let wi = direction(theta, phi);
            let seam = |by: f64| s(wi, direction(0.3, origin(wi) + PI + by));
            close(seam(-STEP), seam(STEP));
            let pole = |around: f64| s(wi, direction(STEP * STEP, around));
            (0..8u8).for_each(|i| close(pole(f64::from(i)), s(wi, Vec3::Z)));
        }
        // The azimuth of the light passes from π to −π.
        let turned = |phi: f64| s(direction(0.5, phi), direction(0.2, phi + 0.4));
        close(turned(PI - STEP), turned(PI + STEP));
        if !numbers.layout.is_isotropic() {
            let level = |phi: f64| s(direction(STEP * STEP, phi), direction(0.2, 1.0));
            (0..8u8).for_each(|i| close(level(f64::from(i)), s(Vec3::Z, direction(0.2, 1.0))));
        }
    }
}

#[test]
fn an_isotropic_table_turns_with_the_light() {
    let numbers = Numbers::new(isotropic(0), 3, facets);
    let table = numbers.table();
    let facing = |phi: f64| table.rgb(direction(0.6, phi), direction(0.8, phi + 2.8))[0];
    for step in -20..20 {
        let phi = 0.33 * f64::from(step);
        assert!((facing(phi) / facing(0.1) - 1.0).abs() < 1e-5, "{phi}");
    }
    // And azimuth does matter in this table.
    assert!(table.rgb(direction(0.6, 0.1), direction(0.8, 0.1))[0] < 0.9 * facing(0.1));
}

#[test]
fn the_albedo_is_the_integral_of_what_is_looked_up_and_the_lobes() {
    for numbers in tables() {
        let table = numbers.table();
        for [theta, phi] in DIRECTIONS {
            let wi = direction(theta, phi);
            let mut albedo = [0.0; 3];
            table.albedo(wi, &mut albedo);
            let mut integral = [0.0; 3];
            hemisphere(&table, wi, SIDE, |wo, part| {
                let rgb = table.rgb(wi, wo);
                (0..3).for_each(|c| integral[c] += f64::from(rgb[c] * wo.z) * part);
            });
            for lobe in 0..numbers.layout.lobes() {
                let mut rho = [0.0; 3];
                if table.reflected(wi, lobe, &mut rho).is_some() {
                    (0..3).for_each(|c| integral[c] += f64::from(rho[c]));
                }
            }
            for (albedo, integral) in albedo.into_iter().zip(integral) {
                let scale = 0.3 * FRAC_PI_2 / theta.cos();
                assert!((integral - f64::from(albedo)).abs() < QUADRATURE * scale, "{theta}: {integral} for {albedo}");
            }
        }
        let mut below = [1.0; 3];
        table.albedo(direction(2.0, 0.0), &mut below);
        assert_eq!(below, [0.0; 3]);
    }
}

#[test]
fn lobes_have_their_direction_and_power() {
    let numbers = Numbers::new(anisotropic(2), 3, facets);
    let table = numbers.table();
    let mut rho = [7.0; 4];
    let normal = Vec3::new(0.28, 0.0, 0.96);
    let wo = table.reflected(Vec3::Z, 0, &mut rho).unwrap();
    assert!((wo - (2.0 * normal.z * normal - Vec3::Z)).length() < 1e-6, "{wo}");
    assert!(rho[..3].iter().all(|rho| (f64::from(*rho) - RHO).abs() < 1e-6) && rho[3] == 0.0, "{rho:?}");
    // The facet reflects this light below the horizon; there is no third lobe; light from below has none.
    for (wi, lobe) in [(direction(1.5, PI), 0), (Vec3::Z, 2), (-Vec3::Z, 0)] {
        rho = [7.0; 4];
        assert_eq!((table.reflected(wi, lobe, &mut rho), rho), (None, [0.0; 4]));
    }
}

#[test]
fn directions_are_drawn_by_their_density() {
    const SAMPLES: u32 = 1 << 16;
    let even = Numbers::new(isotropic(0), 1, |_, _, _| 1.0);
    let black = Numbers::new(anisotropic(0), 1, |_, _, _| 0.0);
    // These bins have nothing to do with the table's nodes, so that a shift by half a node shows.
    let grid = DirectionBins { cos: 10, phi: 15 };
    for numbers in tables().into_iter().chain([even, black]) {
        let table = numbers.table();
        let mut memory = vec![0.0; ScatterSampler::required_len(&numbers.layout)];
        let sampler = ScatterSampler::new(&table, &mut memory).unwrap();
        for (place, [theta, phi]) in DIRECTIONS.into_iter().enumerate() {
            let wi = direction(theta, phi);
            let mut counted = vec![0.0; grid.count() + 1];
            let mut albedo = 0.0;
            // Independent numbers, as the statistic assumes: each the first point of a sequence of its own.
            for i in 0..SAMPLES {
                let u = sobol(0, i.wrapping_mul(6).wrapping_add(place as u32)).map(|u| u as f32);
                if let Some((wo, pdf)) = sampler.sample(wi, u) {
                    assert!((wo.length() - 1.0).abs() < 1e-5 && wo.z > 0.0 && pdf > 0.0, "{wo} {pdf}");
                    counted[grid.index(wo.as_dvec3())] += 1.0;
                    albedo += f64::from(table.rgb(wi, wo)[0] * wo.z / pdf) / f64::from(SAMPLES);
                } else {
                    counted[grid.count()] += 1.0;
                }
            }
            let mut expected = vec![0.0; grid.count() + 1];
            // Where nodes are few, cells of the quadrature must still be small beside bins.
            hemisphere(&table, wi, 1000, |wo, part| {
                let drawn = f64::from(sampler.pdf(wi, wo)) * part * f64::from(SAMPLES);
                assert!(drawn > 0.0 || table.rgb(wi, wo).iter().all(|f| f.abs() < 1e-7));
                expected[grid.index(wo.as_dvec3())] += drawn;
            });
            // The density integrates to 1 less the share of draws below the horizon.
            let above: f64 = expected.iter().sum();
            expected[grid.count()] = (f64::from(SAMPLES) - above).max(0.0);
            // Pearson's χ², bins of few expected samples together.
            let (mut statistic, mut bins, mut rest) = (0.0, 0.0, [0.0, 0.0]);
            for (&seen, &mean) in counted.iter().zip(&expected) {
                if mean < 20.0 {
                    rest = [rest[0] + seen, rest[1] + mean];
                } else {
                    statistic += (seen - mean) * (seen - mean) / mean;
                    bins += 1.0;
                }
            }
            if rest[1] > 1.0 {
                statistic += (rest[0] - rest[1]) * (rest[0] - rest[1]) / rest[1];
            }
            // Mean `bins`, variance 2 `bins`; five deviations.
            println!("{theta}: χ² {statistic:.0} of {bins}, {:.3} above", above / f64::from(SAMPLES));
            assert!(statistic < bins + 5.0 * (2.0_f64 * bins).sqrt(), "{theta}: {statistic} of {bins}");
            let mut exact = [0.0; 1];
            table.albedo(wi, &mut exact);
            let lobes = (0..numbers.layout.lobes()).filter(|lobe| table.reflected(wi, *lobe, &mut []).is_some());
            let exact = f64::from(exact[0]) - RHO * lobes.count() as f64;
            assert!((albedo - exact).abs() <= 0.02 * exact, "{theta}: {albedo} for {exact}");
            let power: f64 = numbers.channels as f64 * f64::from(sampler.reflected(wi));
            assert!(power >= 0.98 * exact, "{theta}: {power} of {exact}");
        }
        assert_eq!(sampler.sample(-Vec3::Z, [0.5; 2]), None);
        assert_eq!((sampler.pdf(-Vec3::Z, Vec3::Z), sampler.pdf(Vec3::Z, -Vec3::Z)), (0.0, 0.0));
    }
}

/// A table in which half of the nodes are 0, among them whole rows and incident directions, and the others reach from 1
/// down to 10⁻³⁰.
fn sparse(layout: ScatterLayout, seed: u32) -> Numbers {
    let mut random = Random::new(0, seed);
    let mut numbers = Numbers::new(layout, 1, |_, _, _| 0.0);
    let [columns, rows] = layout.square_sides();
    for incident in 0..layout.incident_count() {
        let dark = random.next() < 0.2;
        for row in 0..rows as usize {
            let dark = dark || random.next() < 0.3;
            for column in 0..columns as usize {
                let value = if random.next() < 0.5 { 1.0 } else { 10.0_f64.powf(-30.0 * random.next()) };
                if !(dark || random.next() < 0.3) {
                    numbers.values[incident * layout.places() + row * columns as usize + column] = value as f32;
                }
            }
        }
    }
    numbers
}

/// Numbers at which a sampler's choice changes: the cumulative sums and their neighbours, 0, and the largest below 1;
/// and some that are not in [0, 1).
fn edges(sums: &[f32]) -> Vec<f32> {
    let around = |sum: &f32| [sum.next_down(), *sum, sum.next_up()];
    let inside = sums.iter().flat_map(around).filter(|u| (0.0..1.0).contains(u));
    inside.chain([0.0, f32::MIN_POSITIVE, 1.0f32.next_down(), 1.0, -1.0, 2.0, f32::NAN]).collect()
}

#[test]
fn no_number_draws_a_direction_without_density_or_where_nothing_is_reflected() {
    let (mut drawn, mut lost, mut dark) = (0, 0, 0);
    for (seed, (incident, square)) in
        [([3, 4], [5, 8]), ([2, 1], [2, 7]), ([2, 1], [4, 1]), ([2, 3], [16, 48]), ([2, 2], [3, 1024])]
            .into_iter()
            .enumerate()
    {
        let layout = ScatterLayout::new(incident, square, 0).unwrap();
        let numbers = sparse(layout, seed as u32);
        let table = numbers.table();
        let mut sums = vec![0.0; ScatterSampler::required_len(&layout)];
        ScatterSampler::new(&table, &mut sums).unwrap();
        let mut memory = sums.clone();
        let sampler = ScatterSampler::new(&table, &mut memory).unwrap();
        let [columns, rows] = square.map(|side| side as usize);
        for (incident, sums) in sums.chunks_exact(sums.len() / layout.incident_count()).enumerate() {
            let [theta, phi] = layout.incident(incident);
            for nudge in [0.0, 1e-7, 0.1] {
                let wi = direction(theta + nudge * 0.1, phi + nudge);
                let reflects = sampler.reflected(wi) > 0.0;
                for u0 in edges(&sums[1..=rows.min(60)]) {
                    for row in 0..rows.min(10) {
                        for u1 in edges(&sums[1 + rows + row * columns..][..columns]) {
                            let Some((wo, pdf)) = sampler.sample(wi, [u0, u1]) else {
                                lost += 1;
                                continue;
                            };
                            assert!(pdf > 0.0 && pdf.is_finite(), "{seed} {incident} {u0:e} {u1:e}: {wo} {pdf}");
                            assert!(wo.z > 0.0 && (wo.length() - 1.0).abs() < 1e-5, "{wo}");
                            // At the pole the density is not finite. At the very edge of a tent, rounding may carry a
                            // direction to where nothing is.
                            let (here, f) = (sampler.pdf(wi, wo), table.rgb(wi, wo)[0]);
                            let pole = (wi + wo).truncate().length() < 1e-5;
                            let dark_here = reflects && f == 0.0;
                            assert!(
                                here.is_finite() && (here > 0.0 || pole || dark_here),
                                "{seed} {u0:e} {u1:e}: {wo}"
                            );
                            dark += u32::from(dark_here);
                            drawn += 1;
                        }
                    }
                }
            }
        }
    }
    // All of these numbers are edges.
    assert!(drawn > 50_000 && lost < drawn && dark < drawn / 20, "{drawn} {lost} {dark}");
}

#[test]
fn every_node_that_reflects_can_be_drawn_however_little_it_reflects() {
    let layout = ScatterLayout::new([2, 1], [8, 64], 0).unwrap();
    let numbers = sparse(layout, 7);
    let table = numbers.table();
    let mut memory = vec![0.0; ScatterSampler::required_len(&layout)];
    let sampler = ScatterSampler::new(&table, &mut memory).unwrap();
    let wi = direction(0.7, 0.3);
    let mut faint = 0;
    for node in 0..layout.node_count() {
        let (m, _) = table.warp().half_vector(layout.node(node).map(|x| x as f32), layout.origin(wi));
        let wo = 2.0 * wi.dot(m) * m - wi;
        let f = table.rgb(wi, wo)[0];
        if f > 0.0 && m.z < 0.9999 {
            assert!(sampler.pdf(wi, wo) > 0.0, "{node}: {f:e}");
            faint += u32::from(f < 1e-10);
        }
    }
    assert!(faint > 10, "{faint}");
}

#[test]
fn numbers_stay_finite_at_the_horizon() {
    let largest = Numbers::new(anisotropic(1), 3, |_, _, channel| [1e30, -1e30, 1e-40][channel]);
    let table = largest.table();
    let mut memory = vec![0.0; ScatterSampler::required_len(&largest.layout)];
    let sampler = ScatterSampler::new(&table, &mut memory).unwrap();
    let low = |z: f32, phi: f64| direction(FRAC_PI_2, phi).with_z(z);
    for z in [f32::from_bits(1), f32::MIN_POSITIVE, 1e-20, 1e-7, MIN_COS, 1e-3] {
        for phi in [0.0, 1.0, PI] {
            for (wi, wo) in [(low(z, 0.0), low(z, phi)), (Vec3::Z, low(z, phi)), (low(z, phi), Vec3::Z)] {
                let rgb = table.rgb(wi, wo);
                assert!(rgb.iter().all(|f| f.is_finite()) && rgb[0] > 0.0, "{wi} {wo}: {rgb:?}");
                assert!(sampler.pdf(wi, wo) >= 0.0 && sampler.pdf(wi, wo).is_finite(), "{wi} {wo}");
                let mut albedo = [0.0; 3];
                table.albedo(wi, &mut albedo);
                assert!(albedo.iter().all(|a| a.is_finite()), "{wi}: {albedo:?}");
                let drawn = sampler.sample(wi, [0.3, 0.7]);
                assert!(drawn.is_none_or(|(wo, pdf)| wo.is_finite() && pdf.is_finite() && pdf > 0.0));
            }
        }
    }
}

#[test]
fn tables_that_do_not_fit_are_refused() {
    let mut numbers = Numbers::new(anisotropic(1), 1, |_, _, _| 0.5);
    let (layout, required) = (numbers.layout, numbers.values.len());
    let made = |values, lobes, channels| ScatterTable::new(values, layout, numbers.warp(), lobes, channels).map(drop);
    assert_eq!(made(&numbers.values, &numbers.lobes, 0), Err(TableError::Shape));
    assert_eq!(made(&numbers.values[1..], &numbers.lobes, 1), Err(TableError::Length { required }));
    assert_eq!(made(&numbers.values, &[], 1), Err(TableError::Lobe));
    assert_eq!(made(&numbers.values, &[[1.0; FacetLobe::LEN]], 1), Err(TableError::Lobe));
    let required = ScatterSampler::required_len(&layout);
    let refused = ScatterSampler::new(&numbers.table(), &mut [0.0; 3]).map(drop);
    assert_eq!(refused, Err(TableError::Length { required }));
    numbers.values[7] = f32::NAN;
    let refused = ScatterTable::new(&numbers.values, layout, numbers.warp(), &numbers.lobes, 1).map(drop);
    assert_eq!(refused, Err(TableError::NotFinite { index: 7 }));
}
