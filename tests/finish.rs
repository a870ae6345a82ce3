//! Finishes: the laws that hold for all microfacets by Smith's model, and sampling against evaluation.

use glam::{DVec3, Vec3};
use goniochrome::microfacet::{Distribution, FacetTable, Finish, FinishError, Masking};
use statrs::distribution::{ChiSquared, ContinuousCDF};
use std::f64::consts::{FRAC_PI_2, TAU};

use crate::random::Random;

const ROUGHNESSES: [[f32; 2]; 5] = [[0.05, 0.05], [0.3, 0.3], [1.0, 1.0], [0.1, 0.4], [0.7, 0.15]];

/// A finish, and the roughness along x and y to which quadratures fit.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Rough {
    pub finish: Finish<'static>,
    pub alpha: [f32; 2],
}

fn finishes() -> impl Iterator<Item = Rough> {
    let both = [Distribution::Ggx, Distribution::Beckmann];
    let analytic = both
        .into_iter()
        .flat_map(|distribution| ROUGHNESSES.map(|alpha| Rough { finish: analytic(distribution, alpha), alpha }));
    analytic.chain(tabulated_finishes())
}

pub(crate) fn analytic(distribution: Distribution, alpha: [f32; 2]) -> Finish<'static> {
    Finish::new(distribution, Masking::Correlated, alpha).unwrap()
}

/// Tables of both distributions, of two tilted lobes, and of a ring of slopes without any facet along z.
pub(crate) fn tabulated_finishes() -> impl Iterator<Item = Rough> {
    let of = |size, alpha, density: &dyn Fn(Vec3) -> f32| Rough { finish: tabulated(size, density), alpha };
    let lobes = |m: Vec3| {
        let (x, y) = (m.x / m.z, m.y / m.z);
        [-0.3f32, 0.3].map(|tilt| (-((x - tilt) / 0.1).powi(2) - (y / 0.2).powi(2)).exp()).iter().sum::<f32>()
    };
    let ring = |m: Vec3| (-(m.x.hypot(m.y) / m.z.max(1e-6) / 0.3 - 1.0).powi(2) / 0.02).exp();
    [
        of([256, 1], [0.3; 2], &|m| analytic(Distribution::Ggx, [0.3; 2]).density(m)),
        of([256, 1], [0.05; 2], &|m| analytic(Distribution::Beckmann, [0.05; 2]).density(m)),
        of([96, 72], [0.1, 0.4], &|m| analytic(Distribution::Ggx, [0.1, 0.4]).density(m)),
        of([96, 72], [0.3, 0.3], &lobes),
        of([128, 1], [0.3, 0.3], &ring),
    ]
    .into_iter()
}

/// Table of a density at its nodes. Its memory stays for the rest of the test.
fn tabulated(size: [usize; 2], density: &dyn Fn(Vec3) -> f32) -> Finish<'static> {
    let [rings, sectors] = size;
    let nodes: Vec<f32> = (0..=rings)
        .flat_map(|ring| {
            let t = FacetTable::sin_square(rings, ring);
            (0..sectors).map(move |j| direction(t.sqrt().asin(), TAU * j as f64 / sectors as f64))
        })
        .map(|m| density(m.with_z(m.z.max(1e-6))))
        .collect();
    let memory = vec![0.0; FacetTable::required_len(size)].leak();
    Finish::tabulated(FacetTable::new(size, &nodes, memory).unwrap(), Masking::Correlated)
}

pub(crate) fn direction(theta: f64, phi: f64) -> Vec3 {
    DVec3::new(theta.sin() * phi.cos(), theta.sin() * phi.sin(), theta.cos()).as_vec3()
}

/// Integral over normals, by the slopes in units of the roughness: the substitution tan θ' = tan(x) makes it smooth.
fn over_normals(Rough { finish, alpha }: &Rough, of: impl Fn(Vec3) -> f64) -> f64 {
    const RINGS: u32 = 1500;
    const SECTORS: u32 = 512;
    let [ax, ay] = alpha.map(f64::from);
    let mut sum = 0.0;
    for ring in 0..RINGS {
        // Radius tan x of the stretched slope, with the weight that the horizon needs.
        let x = (f64::from(ring) + 0.5) / f64::from(RINGS) * FRAC_PI_2;
        let (radius, step) = (x.tan(), FRAC_PI_2 / f64::from(RINGS) / (x.cos() * x.cos()));
        for sector in 0..SECTORS {
            let phi = (f64::from(sector) + 0.5) / f64::from(SECTORS) * TAU;
            let normal = DVec3::new(ax * radius * phi.cos(), ay * radius * phi.sin(), 1.0);
            // dω = cos³θ d(slopes).
            let solid = ax * ay * radius * step * TAU / f64::from(SECTORS) / normal.length().powi(3);
            let m = normal.normalize().as_vec3();
            sum += solid * f64::from(finish.density(m)) * of(m);
        }
    }
    sum
}

#[test]
fn facets_fill_the_surface_and_what_a_direction_sees_of_it() {
    /// Asked of the weak white furnace, ∫ D G₁ (w·m)⁺ dω = cos θ. The quadrature's own error is below 2e-5, from the
    /// kink of (w·m)⁺.
    const FURNACE: f64 = 1e-4;
    for (rough, which) in finishes().zip(0..) {
        let area = over_normals(&rough, |m| f64::from(m.z));
        assert!((area - 1.0).abs() < FURNACE, "{which}: {area}");
        for (theta, phi) in [(0.0, 0.0), (0.5, 0.3), (1.0, 2.0), (1.3, 4.0), (1.5, 1.2), (1.56, 0.7)] {
            let w = direction(theta, phi);
            let visible = f64::from(rough.finish.visible_area(w));
            let seen = over_normals(&rough, |m| f64::from(w.dot(m).max(0.0)));
            assert!((seen / visible - 1.0).abs() < FURNACE, "{which} {theta}: {seen} {visible}");
        }
    }
}

#[test]
fn directions_may_be_exchanged() {
    /// Rounding of some ten operations in single precision, times the exponent of Beckmann's tails.
    const ROUNDING: f32 = 1e-5;
    for Rough { finish, .. } in finishes() {
        let mut random = Random(7);
        for _ in 0..1000 {
            let mut any = || direction(random.between(0.0, 1.0).acos(), random.between(0.0, TAU));
            let (wi, wo) = (any(), any());
            let (there, back) = (finish.lobe(wi, wo).unwrap(), finish.lobe(wo, wi).unwrap());
            assert!((there.value - back.value).abs() <= ROUNDING * there.value, "{finish:?} {there:?} {back:?}");
            assert!((f64::from(there.cos_d) - f64::from(wi.dot((wi + wo).normalize()))).abs() < 1e-6);
        }
    }
}

#[test]
fn nothing_is_reflected_below_the_horizon_or_at_it() {
    for Rough { finish, .. } in finishes() {
        let (up, down) = (direction(0.3, 0.1), direction(2.0, 0.1));
        assert!(finish.lobe(up, down).is_none() && finish.lobe(down, up).is_none());
        assert!(finish.lobe(Vec3::X, up).is_none() && finish.sample(Vec3::X, [0.5; 2]).is_none());
        assert!(finish.sample(down, [0.5; 2]).is_none() && finish.sample(Vec3::NAN, [0.5; 2]).is_none());
        assert!(finish.density(Vec3::X) == 0.0 && finish.density(Vec3::NAN) == 0.0);
    }
}

/// Cells over the square of cos θ_o and φ_o, finer where the lobe is.
struct Cells {
    rough: Rough,
    wi: Vec3,
}

/// Cells along the half vector's stretched radius and azimuth.
const CELLS: [usize; 2] = [12, 16];

impl Cells {
    /// Cell of a direction by the slope of its half vector in units of the roughness, as an angle.
    fn of(&self, wo: Vec3) -> usize {
        let m = (self.wi + wo).normalize();
        let [ax, ay] = self.rough.alpha;
        let (x, y) = (m.x / ax / m.z, m.y / ay / m.z);
        let radius = x.hypot(y).atan() / std::f32::consts::FRAC_PI_2;
        let turn = (y.atan2(x) / std::f32::consts::TAU).rem_euclid(1.0);
        let cell = |x: f32, count: usize| ((x * count as f32) as usize).min(count - 1);
        cell(radius, CELLS[0]) * CELLS[1] + cell(turn, CELLS[1])
    }

    /// Probability of each cell and, last, of a sample below the horizon: the density integrated over half vectors.
    fn probabilities(&self) -> Vec<f64> {
        const FINE: [usize; 2] = [40, 40];
        let [ax, ay] = self.rough.alpha.map(f64::from);
        let mut cells = vec![0.0; CELLS[0] * CELLS[1] + 1];
        let steps = [CELLS[0] * FINE[0], CELLS[1] * FINE[1]];
        for i in 0..steps[0] {
            let angle = (i as f64 + 0.5) / steps[0] as f64 * FRAC_PI_2;
            let (radius, per_step) = (angle.tan(), FRAC_PI_2 / (angle.cos() * angle.cos()));
            for k in 0..steps[1] {
                let turn = (k as f64 + 0.5) / steps[1] as f64;
                let (sin, cos) = (TAU * turn).sin_cos();
                let normal = DVec3::new(ax * radius * cos, ay * radius * sin, 1.0);
                let m = normal.normalize();
                let wi = self.wi.as_dvec3();
                let wo = 2.0 * wi.dot(m) * m - wi;
                let cos_d = wi.dot(m);
                if wo.z <= 0.0 || cos_d <= 0.0 {
                    continue;
                }
                let Some(lobe) = self.rough.finish.lobe(self.wi, wo.as_vec3()) else { continue };
                let solid = ax * ay * radius * per_step / normal.length().powi(3);
                let whole = solid * TAU / (steps[0] * steps[1]) as f64;
                cells[i / FINE[0] * CELLS[1] + k / FINE[1]] += f64::from(lobe.pdf) * 4.0 * cos_d * whole;
            }
        }
        let sum: f64 = cells.iter().sum();
        *cells.last_mut().unwrap() = 1.0 - sum;
        cells
    }
}

#[test]
fn samples_are_as_dense_as_evaluation_says() {
    // Of 300 tests at 0.01, three are expected to fail by chance.
    check_samples(finishes());
}

/// Compares counts of samples with the integrated density, in 20 directions for each finish.
pub(crate) fn check_samples(finishes: impl Iterator<Item = Rough>) {
    /// Samples of each direction, and the fewest that are expected in a cell; smaller cells are counted together.
    const SAMPLES: u64 = 100_000;
    const FEWEST: f64 = 10.0;
    /// Smallest probability of a result as far off by chance, in 20 directions for each finish.
    const P_VALUE: f64 = 0.01;
    let mut failed = Vec::new();
    for (rough, which) in finishes.zip(0..) {
        for test in 0..20u64 {
            let mut random = Random(1000 * which + test);
            let wi = direction(random.between(0.001, 1.0).acos(), random.between(0.0, TAU));
            let cells = Cells { rough, wi };
            let expected = cells.probabilities();
            let mut counts = vec![0u64; expected.len()];
            for _ in 0..SAMPLES {
                let u = [(); 2].map(|()| random.between(0.0, 1.0) as f32);
                let cell = rough.finish.sample(wi, u).map_or(counts.len() - 1, |wo| cells.of(wo));
                counts[cell] += 1;
            }
            let (mut square, mut used, mut rest) = (0.0, 0, [0.0; 2]);
            let mut add = |count: f64, expected: f64| {
                square += (count - expected).powi(2) / expected;
                used += 1;
            };
            for (&count, &probability) in counts.iter().zip(&expected) {
                let expected = probability.max(0.0) * SAMPLES as f64;
                if expected >= FEWEST {
                    add(count as f64, expected);
                } else {
                    rest = [rest[0] + count as f64, rest[1] + expected];
                }
            }
            if rest[1] >= FEWEST {
                add(rest[0], rest[1]);
            }
            let p = 1.0 - ChiSquared::new(f64::from((used - 1).max(1))).unwrap().cdf(square);
            if p < P_VALUE {
                failed.push((which, rough.alpha, wi, p));
            }
        }
    }
    assert!(failed.is_empty(), "{failed:?}");
}

#[test]
fn a_smooth_finish_is_a_mirror() {
    let finish = Finish::new(Distribution::Ggx, Masking::Correlated, [0.001; 2]).unwrap();
    let mut random = Random(3);
    for _ in 0..100 {
        let wi = direction(random.between(0.0, 1.4), random.between(0.0, TAU));
        let u = [random.between(0.0, 1.0), random.between(0.0, 0.9)].map(|u| u as f32);
        let wo = finish.sample(wi, u).unwrap();
        // Normals of the inner nine tenths lie within 3 α; the reflected direction turns twice as far.
        assert!(wo.distance(Vec3::new(-wi.x, -wi.y, wi.z)) < 2.0 * 3.0 * 0.001 + 1e-5, "{wi} {wo}");
    }
}

#[test]
fn a_table_of_ggx_facets_is_ggx() {
    // Distance of the chord of a function of t from it: h² |D″|/8, with D″/D = 6 (1 − α²)²/(t (1 − α²) + α²)², and
    // steps h = 4 t^¾/256 to first order. With t/α² = x, D″ h²/8D is largest at x = 3: 6/8 (4/256)² 3^1.5/(4² α).
    let bound = |alpha: f64| 0.75 * (4.0f64 / 256.0).powi(2) * 3f64.powf(1.5) / (16.0 * alpha);
    for alpha in [0.1f32, 0.3, 0.7] {
        let exact = analytic(Distribution::Ggx, [alpha; 2]);
        let table = tabulated([256, 1], &|m| exact.density(m));
        let (mut worst, mut area) = (0.0f64, 0.0f64);
        for i in 1..3000 {
            let m = direction(f64::from(i) / 3000.0 * FRAC_PI_2, 0.3);
            let error = |found: f32, want: f32| (f64::from(found) / f64::from(want) - 1.0).abs();
            worst = worst.max(error(table.density(m), exact.density(m)));
            area = area.max(error(table.visible_area(m), exact.visible_area(m)));
        }
        assert!(worst <= bound(alpha.into()), "{alpha}: {worst:e}");
        assert!(area <= bound(alpha.into()), "{alpha}: {area:e}");
    }
}

#[test]
fn tables_of_facets_that_cannot_be_are_refused() {
    let refused = |size: [usize; 2], density: &[f32]| {
        let mut memory = vec![0.0; FacetTable::required_len(size)];
        FacetTable::new(size, density, &mut memory).unwrap_err()
    };
    for size in [[0, 1], [2000, 1], [4, 2], [4, 129]] {
        assert_eq!(refused(size, &vec![1.0; (size[0] + 1) * size[1]]), FinishError::Size, "{size:?}");
    }
    assert_eq!(refused([4, 1], &[1.0; 4]), FinishError::Size);
    for bad in [[0.0; 3], [1.0, -1.0, 1.0], [f32::NAN, 1.0, 1.0], [f32::INFINITY, 1.0, 1.0]] {
        assert_eq!(refused([2, 1], &bad), FinishError::Density, "{bad:?}");
    }
    let tilted: Vec<f32> = (0..5 * 8).map(|i| if i % 8 == 0 { 1.0 } else { 0.0 }).collect();
    assert_eq!(refused([4, 8], &tilted), FinishError::Tilt);
}
