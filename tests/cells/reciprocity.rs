//! Tests of reciprocity: f(wi, wo) = f(wo, wi), averaged over pairs of bins.

use std::f64::consts::TAU;

use glam::DVec3;
use goniochrome::measure::bins::DirectionBins;
use goniochrome::trace::sobol::sobol;
use goniochrome_cli::scene::load;
use goniochrome_cli::solve::mesh_scene::MeshScene;
use goniochrome_cli::solve::precision::Precision;
use goniochrome_cli::solve::scatter::{Coherence, ScatterRequest, scatter};

const PRESETS: [&str; 9] = [
    "bumpy-glass",
    "bumpy-soap-film",
    "beetle-pits",
    "morpho-ridges",
    "compact-disc",
    "dvd",
    "silicon-pyramids",
    "brushed-metal",
    "pigment-paint",
];
const GRID: DirectionBins = DirectionBins { cos: 3, phi: 8 };
/// Number of incident directions in each bin.
const DIRECTIONS: u32 = 32;
/// Number of starting rays in each direction.
const RAYS: u32 = 32;
/// Standard errors beyond which none of some thousand pairs lies by chance, with errors from 32 directions each.
const SIGMAS: f64 = 5.0;
/// Share of pairs that may lie beyond three standard errors: 5 in 1000 would, but histograms of few rays have longer
/// tails.
const BEYOND_THREE: f64 = 0.02;

/// A direction in a bin, uniform in projected solid angle.
fn direction_in(bin: usize, [u, v]: [f64; 2]) -> DVec3 {
    let [from, to, phi_from, phi_to] = GRID.bounds(bin);
    let cos = (from * from + u * (to * to - from * from)).sqrt();
    let (sin_phi, cos_phi) = (phi_from + v * (phi_to - phi_from)).sin_cos();
    let sin = (1.0 - cos * cos).sqrt();
    DVec3::new(sin * cos_phi, sin * sin_phi, cos)
}

/// Mean, and variance of the mean, of the power that light from one bin sends into each bin.
fn sent(mesh_scene: &MeshScene<'_>, from: usize, coherence: Coherence) -> Vec<[f64; 2]> {
    let mut sums = vec![[0.0; 2]; GRID.count()];
    for i in 0..DIRECTIONS {
        let wi = direction_in(from, sobol(i, 7 + from as u32));
        let seed = i * GRID.count() as u32 + from as u32;
        let request = ScatterRequest { coherence, rays: RAYS, seed, bins: GRID, precision: Precision::F32, threads: 2 };
        let found = &scatter(mesh_scene, wi, &[550.0], &request, &|| ()).expect("a preset")[0];
        for (sum, bin) in sums.iter_mut().zip(&found.bins) {
            *sum = [sum[0] + bin.value, sum[1] + bin.value * bin.value];
        }
    }
    let count = f64::from(DIRECTIONS);
    sums.into_iter()
        .map(|[sum, squares]| [sum / count, (squares - sum * sum / count) / (count - 1.0) / count])
        .collect()
}

fn holds(coherence: Coherence) {
    for name in PRESETS {
        let scene = load(name).expect("a preset");
        let mesh_scene = MeshScene::new(&scene).expect("a good mesh");
        let sent: Vec<_> = (0..GRID.count()).map(|from| sent(&mesh_scene, from, coherence)).collect();
        let solid_angle = |bin| GRID.projected_solid_angle(bin) / TAU;
        let (mut pairs, mut beyond, mut worst) = (0u32, 0u32, 0.0_f64);
        for (a, from_a) in sent.iter().enumerate() {
            for (b, from_b) in sent.iter().enumerate().take(a) {
                let [there, there_variance] = from_a[b].map(|x| x * solid_angle(a));
                let [back, back_variance] = from_b[a].map(|x| x * solid_angle(b));
                let variance = there_variance * solid_angle(a) + back_variance * solid_angle(b);
                // A pair of bins that no ray has joined may hold the power of one ray.
                let one_ray = solid_angle(a).max(solid_angle(b)) / f64::from(DIRECTIONS * RAYS);
                let sigmas = (there - back).abs() / variance.sqrt().max(one_ray);
                worst = worst.max(sigmas);
                beyond += u32::from(sigmas > 3.0);
                pairs += 1;
            }
        }
        println!("{name} {coherence:?}: {pairs} pairs, {beyond} beyond three standard errors, worst {worst:.2}");
        assert!(pairs >= 100 && worst <= SIGMAS, "{name}: {worst}");
        assert!(f64::from(beyond) <= BEYOND_THREE * f64::from(pairs), "{name}: {beyond} of {pairs}");
    }
}

#[test]
fn powers_are_reciprocal() {
    holds(Coherence::None);
}

#[test]
fn interfering_paths_are_reciprocal() {
    holds(Coherence::Ray);
}
