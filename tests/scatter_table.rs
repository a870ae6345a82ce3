//! Tests of the BRDF tables of scattering surfaces: look-up, albedo, density and drawn directions agree with one
//! another.

use core::f64::consts::{FRAC_PI_2, PI, TAU};

use glam::Vec3;
use goniochrome::measure::bins::DirectionBins;
use goniochrome::table::{ScatterLayout, ScatterSampler, ScatterTable, TableError};
use goniochrome::trace::random::Random;
use goniochrome::trace::sobol::sobol;

/// A table of f at the middles of bins; f takes θ_i, φ_i, cos θ_o, φ_o − φ_i and the channel.
fn tabulated(layout: ScatterLayout, channels: usize, f: impl Fn([f64; 4], usize) -> f64) -> Vec<f32> {
    let mut values = Vec::new();
    for incident in 0..layout.incident_count() {
        let [theta, phi] = layout.incident(incident);
        for bin in 0..layout.bins().count() {
            let [cos, relative] = layout.outgoing(bin);
            values.extend((0..channels).map(|channel| f([theta, phi, cos, relative], channel) as f32));
        }
    }
    values
}

fn direction(theta: f64, phi: f64) -> Vec3 {
    let ((sin, cos), (sin_phi, cos_phi)) = (theta.sin_cos(), phi.sin_cos());
    Vec3::new((sin * cos_phi) as f32, (sin * sin_phi) as f32, cos as f32)
}

fn layout() -> ScatterLayout {
    ScatterLayout::new(5, 4, DirectionBins { cos: 6, phi: 12 }).unwrap()
}

/// A lobe around the mirror direction, 0 elsewhere, whose strength varies with the azimuth. One channel is negative.
fn lobe([theta, phi, cos, relative]: [f64; 4], channel: usize) -> f64 {
    let around = (relative - PI).cos() * (1.0 - cos * cos).sqrt() * theta.sin() + cos * theta.cos();
    let strength = (1.0 + 0.5 * (2.0 * phi).cos()) * [1.0, 0.3, -0.05][channel];
    if around > 0.6 { strength * around.powi(12) } else { 0.0 }
}

const DIRECTIONS: [[f64; 2]; 6] = [[0.02, 0.3], [0.4, 1.0], [0.9, -2.0], [1.2, 3.1], [1.5, 0.0], [1.0, 6.2]];

/// The integral of g over a hemisphere, by midpoints in cos θ and φ that each stand for the same solid angle.
fn hemisphere(mut g: impl FnMut(Vec3) -> f64) -> f64 {
    const COS: u32 = 480;
    const PHI: u32 = 480;
    let mut sum = 0.0;
    for i in 0..COS {
        let theta = ((f64::from(i) + 0.5) / f64::from(COS)).acos();
        sum += (0..PHI).map(|j| g(direction(theta, TAU * (f64::from(j) + 0.5) / f64::from(PHI)))).sum::<f64>();
    }
    sum * TAU / f64::from(COS * PHI)
}

#[test]
fn a_lambert_surface_is_one_from_every_side() {
    let values = tabulated(layout(), 2, |_, channel| [1.0, 0.25][channel] / PI);
    let table = ScatterTable::new(&values, layout(), 2).unwrap();
    for [theta, phi] in DIRECTIONS {
        let mut albedo = [0.0; 2];
        table.albedo(direction(theta, phi), &mut albedo);
        assert!((albedo[0] - 1.0).abs() < 5e-6 && (albedo[1] - 0.25).abs() < 5e-6, "{albedo:?}");
        for [theta_o, phi_o] in DIRECTIONS {
            let [r, g, b] = table.rgb(direction(theta, phi), direction(theta_o, phi_o));
            assert!((f64::from(r) - 1.0 / PI).abs() < 1e-6 && (g - 0.25 * r).abs() < 1e-6 && b == g);
        }
        assert_eq!(table.rgb(direction(theta, phi), direction(2.0, phi)), [0.0; 3]);
        assert_eq!(table.rgb(direction(2.0, phi), direction(theta, phi)), [0.0; 3]);
    }
}

#[test]
fn the_albedo_is_the_integral_of_what_is_looked_up() {
    let values = tabulated(layout(), 3, lobe);
    let table = ScatterTable::new(&values, layout(), 3).unwrap();
    for [theta, phi] in DIRECTIONS {
        let wi = direction(theta, phi);
        let mut albedo = [0.0; 3];
        table.albedo(wi, &mut albedo);
        for (channel, albedo) in albedo.into_iter().enumerate() {
            let integral = hemisphere(|wo| f64::from(table.rgb(wi, wo)[channel] * wo.z));
            assert!((integral - f64::from(albedo)).abs() < 1e-5, "{theta}: {integral} for {albedo}");
        }
    }
}

#[test]
fn lobes_turn_with_the_light_without_a_seam() {
    let values = tabulated(layout(), 3, |at, channel| lobe([at[0], 0.0, at[2], at[3]], channel));
    let table = ScatterTable::new(&values, layout(), 3).unwrap();
    let facing = |phi: f64| table.rgb(direction(0.6, phi), direction(0.8, phi + 2.8))[0];
    for step in -20..20 {
        let phi = 0.33 * f64::from(step);
        assert!((facing(phi) - facing(0.1)).abs() < 2e-6, "{phi}");
    }
    // And azimuth does matter in this table.
    assert!(table.rgb(direction(0.6, 0.1), direction(0.8, 0.1))[0] < 0.1 * facing(0.1));
}

#[test]
fn the_density_integrates_to_one_and_covers_what_is_reflected() {
    let lambert = tabulated(layout(), 1, |_, _| 1.0);
    let black = vec![0.0; layout().count()];
    let lobes = tabulated(layout(), 3, lobe);
    for (values, channels) in [(&lambert, 1), (&black, 1), (&lobes, 3)] {
        let table = ScatterTable::new(values, layout(), channels).unwrap();
        let mut memory = vec![0.0; ScatterSampler::required_len(&layout())];
        let sampler = ScatterSampler::new(&table, &mut memory).unwrap();
        for [theta, phi] in DIRECTIONS {
            let wi = direction(theta, phi);
            let integral = hemisphere(|wo| {
                let density = sampler.pdf(wi, wo);
                assert!(density > 0.0 || table.rgb(wi, wo).iter().all(|f| f.abs() < 1e-7));
                f64::from(density)
            });
            assert!((integral - 1.0).abs() < 1e-5, "{theta}: {integral}");
            assert!(sampler.pdf(wi, direction(FRAC_PI_2 + 0.1, 0.0)).abs() < f32::MIN_POSITIVE);
        }
    }
}

#[test]
fn directions_are_drawn_by_their_density() {
    const SAMPLES: u32 = 1 << 16;
    let values = tabulated(layout(), 3, lobe);
    let table = ScatterTable::new(&values, layout(), 3).unwrap();
    let mut memory = vec![0.0; ScatterSampler::required_len(&layout())];
    let sampler = ScatterSampler::new(&table, &mut memory).unwrap();
    // These are not the table's own bins, so that a shift by half a bin shows. Both numbers divide the quadrature's
    // 480.
    let grid = DirectionBins { cos: 10, phi: 15 };
    for (place, [theta, phi]) in DIRECTIONS.into_iter().enumerate() {
        let wi = direction(theta, phi);
        let mut counted = vec![0.0; grid.count()];
        let mut albedo = 0.0;
        // Independent numbers, as the statistic assumes: each the first point of a sequence of its own.
        for i in 0..SAMPLES {
            let u = sobol(0, i.wrapping_mul(6).wrapping_add(place as u32)).map(|u| u as f32);
            let (wo, pdf) = sampler.sample(wi, u).unwrap();
            assert!((wo.length() - 1.0).abs() < 1e-5 && wo.z > 0.0);
            assert!(pdf > 0.0, "{wo}");
            counted[grid.index(wo.as_dvec3())] += 1.0;
            albedo += f64::from(table.rgb(wi, wo)[0] * wo.z / pdf) / f64::from(SAMPLES);
        }
        let mut expected = vec![0.0; grid.count()];
        let cell = TAU / (480.0 * 480.0) * f64::from(SAMPLES);
        hemisphere(|wo| {
            expected[grid.index(wo.as_dvec3())] += cell * f64::from(sampler.pdf(wi, wo));
            0.0
        });
        // Pearson's χ², bins of few expected samples together.
        let (mut statistic, mut bins, mut rest) = (0.0, 0.0, [0.0, 0.0]);
        for (&seen, &mean) in counted.iter().zip(&expected) {
            if mean < 10.0 {
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
        println!("{theta}: χ² {statistic:.0} of {bins}");
        assert!(statistic < bins + 5.0 * (2.0_f64 * bins).sqrt(), "{theta}: {statistic} of {bins}");
        let mut exact = [0.0; 1];
        table.albedo(wi, &mut exact);
        assert!((albedo / f64::from(exact[0]) - 1.0).abs() < 0.02, "{theta}: {albedo} for {}", exact[0]);
    }
    assert_eq!(sampler.sample(-Vec3::Z, [0.5; 2]), None);
    for u in [0.0, 0.999_999_94, 1.0, f32::NAN] {
        let (wo, pdf) = sampler.sample(Vec3::Z, [u; 2]).unwrap();
        assert!(wo.z > 0.0 && pdf > 0.0 && wo.is_finite(), "{u}: {wo} {pdf}");
    }
}

/// A table in which half of the bins are 0, among them whole rows and incident directions, and the others reach from 1
/// down to 10⁻³⁰.
fn sparse(layout: ScatterLayout, seed: u32) -> Vec<f32> {
    let mut random = Random::new(0, seed);
    let bins = layout.bins();
    let mut values = Vec::new();
    for _ in 0..layout.incident_count() {
        let dark = random.next() < 0.2;
        for _ in 0..bins.cos {
            let dark = dark || random.next() < 0.3;
            for _ in 0..bins.phi {
                let value = if random.next() < 0.5 { 1.0 } else { 10.0_f64.powf(-30.0 * random.next()) };
                values.push(if dark || random.next() < 0.3 { 0.0 } else { value as f32 });
            }
        }
    }
    values
}

/// Numbers at which a sampler's choice changes: the cumulative sums and their neighbours, 0, and the largest below 1.
fn edges(sums: &[f32]) -> Vec<f32> {
    let around = |sum: &f32| [sum.next_down(), *sum, sum.next_up()];
    let inside = sums.iter().flat_map(around).filter(|u| (0.0..1.0).contains(u));
    inside.chain([0.0, f32::MIN_POSITIVE, 1.0f32.next_down()]).collect()
}

#[test]
fn no_number_draws_a_direction_without_density_or_where_nothing_is_reflected() {
    let mut drawn = 0;
    for (seed, (theta, phi, cos, around)) in
        [(3, 4, 5, 8), (2, 1, 1, 7), (1, 1, 4, 1), (2, 3, 16, 48), (1, 2, 3, 1024)].into_iter().enumerate()
    {
        let layout = ScatterLayout::new(theta, phi, DirectionBins { cos, phi: around }).unwrap();
        let values = sparse(layout, seed as u32);
        let table = ScatterTable::new(&values, layout, 1).unwrap();
        let mut sums = vec![0.0; ScatterSampler::required_len(&layout)];
        ScatterSampler::new(&table, &mut sums).unwrap();
        let mut memory = sums.clone();
        let sampler = ScatterSampler::new(&table, &mut memory).unwrap();
        let (rows, columns) = (cos as usize, around as usize);
        for (incident, sums) in sums.chunks_exact(sums.len() / layout.incident_count()).enumerate() {
            let [theta, phi] = layout.incident(incident);
            for nudge in [0.0, 1e-7, 0.1] {
                let wi = direction(theta + nudge, phi + nudge);
                let reflects = values.iter().any(|f| *f > 0.0)
                    && (0..layout.bins().count()).any(|bin| {
                        let [cos, relative] = layout.outgoing(bin);
                        table.rgb(wi, direction(cos.acos(), f64::from(wi.y.atan2(wi.x)) + relative))[0] > 0.0
                    });
                for u0 in edges(&sums[1..=rows]) {
                    for row in 0..rows {
                        for u1 in edges(&sums[1 + rows + row * columns..][..columns.min(40)]) {
                            let (wo, pdf) = sampler.sample(wi, [u0, u1]).unwrap();
                            assert!(pdf > 0.0 && pdf.is_finite(), "{seed} {incident} {u0:e} {u1:e}: {wo} {pdf}");
                            assert_eq!(pdf, sampler.pdf(wi, wo));
                            assert!(!reflects || table.rgb(wi, wo)[0] > 0.0, "{seed} {incident} {u0:e} {u1:e}: {wo}");
                            drawn += 1;
                        }
                    }
                }
            }
        }
    }
    assert!(drawn > 100_000, "{drawn}");
}

#[test]
fn every_bin_that_reflects_can_be_drawn_however_little_it_reflects() {
    let layout = ScatterLayout::new(1, 1, DirectionBins { cos: 8, phi: 64 }).unwrap();
    let values = sparse(layout, 7);
    let table = ScatterTable::new(&values, layout, 1).unwrap();
    let mut memory = vec![0.0; ScatterSampler::required_len(&layout)];
    let sampler = ScatterSampler::new(&table, &mut memory).unwrap();
    let wi = direction(0.7, 0.3);
    let mut faint = 0;
    for (bin, &f) in values.iter().enumerate().filter(|(_, f)| **f > 0.0) {
        let [cos, relative] = layout.outgoing(bin);
        assert!(sampler.pdf(wi, direction(cos.acos(), 0.3 + relative)) > 0.0, "{bin}: {f:e}");
        faint += u32::from(f < 1e-10);
    }
    assert!(faint > 10);
}

#[test]
fn tables_that_do_not_fit_are_refused() {
    let mut values = vec![0.5; layout().count()];
    let required = values.len();
    assert_eq!(ScatterTable::new(&values, layout(), 0), Err(TableError::Shape));
    assert_eq!(ScatterTable::new(&values[1..], layout(), 1), Err(TableError::Length { required }));
    let table = ScatterTable::new(&values, layout(), 1).unwrap();
    let required = ScatterSampler::required_len(&layout());
    assert_eq!(ScatterSampler::new(&table, &mut [0.0; 3]), Err(TableError::Length { required }));
    values[7] = f32::NAN;
    assert_eq!(ScatterTable::new(&values, layout(), 1), Err(TableError::NotFinite { index: 7 }));
}
