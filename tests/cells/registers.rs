//! Rays of many wavelengths at once, against the rays of each register alone.

use goniochrome::geometry::side::Side;
use goniochrome::measure::bins::{DirectionBins, ExitBuffer, ExitRecord, Histogram};
use goniochrome::optics::medium::MediaLanes;
use goniochrome::simd::complex::ComplexLanes;
use goniochrome::simd::lanes::{F32, F64, Lanes};
use goniochrome::simd::ray_lanes::RayLanes;
use goniochrome::simd::registers::{Alike, Registers};
use goniochrome::trace::coherent_mesh::{self, CoherentMesh, IncidentWave};
use goniochrome::trace::incoherent_mesh::{self, IncoherentMesh};
use goniochrome::trace::paths::follow_paths;
use goniochrome::trace::random::Random as Roulette;
use goniochrome::trace::sobol::sobol;
use goniochrome::trace::waves::{Limits, trace};
use goniochrome_cli::scene::Scene;
use goniochrome_cli::solve::mesh_scene::MeshScene;

use crate::height_field::HeightField;
use crate::scene::towards;

const RAYS: u32 = 64;
const BINS: DirectionBins = DirectionBins { cos: 4, phi: 6 };
const WAVELENGTHS_NM: [f64; 20] = {
    let mut nm = [0.0; 20];
    let mut i = 0;
    while i < 20 {
        nm[i] = 400.0 + 17.0 * i as f64;
        i += 1;
    }
    nm
};

/// A rough film: a curved top face, absorbing or clear, over a clear one.
fn film(k: f64) -> HeightField {
    let heights_nm = (0..36).map(|i| 300.0 + 250.0 * (1.7 * f64::from(i)).sin()).collect();
    let media = vec![[1.0, 0.0], [1.6, k], [1.3, 0.0]];
    HeightField { period_nm: [3000.0, 2500.0], squares: [6, 6], heights_nm, depths_nm: vec![900.0], media }
}

/// Powers by wavelength and bin, above and below.
struct Powers {
    first: usize,
    sums: Vec<[[f64; 24]; 2]>,
}

impl Histogram for Powers {
    fn add(&mut self, lane: usize, side: Side, bin: usize, power: f64) {
        if let Some(sums) = self.sums.get_mut(self.first + lane) {
            sums[usize::from(side == Side::Below)][bin] += power;
        }
    }
}

/// What a cell sends into bins, what it absorbs, and the most hits of a starting ray, with and without interference.
fn traced<V: RayLanes>(scene: &Scene, interfere: bool) -> (Vec<[[f64; 24]; 2]>, Vec<f64>, u64) {
    let mesh_scene = MeshScene::new(scene).unwrap();
    let mut buffer = mesh_scene.buffer();
    let cell = mesh_scene.cell(&mut buffer).unwrap();
    let mut powers = Powers { first: 0, sums: vec![[[0.0; 24]; 2]; WAVELENGTHS_NM.len()] };
    let (mut absorbed, mut hits) = (Vec::new(), 0);
    for wavelengths in WAVELENGTHS_NM.chunks(V::WIDTH) {
        let mut eta = vec![ComplexLanes::zero(); 3];
        let media = MediaLanes::<V>::evaluate(&mesh_scene.media(), wavelengths, &mut eta).unwrap();
        let light = IncidentWave::new(towards(35.0, 20.0), media.eta_of(cell.above()));
        let (mut waves, mut paths) = (CoherentMesh::new(cell, media, light), IncoherentMesh::new(cell, media, light));
        let mut memory = vec![ExitRecord::none(); 4096];
        let mut exits = ExitBuffer::new(&mut memory, BINS, &media);
        let (mut wave_slots, mut path_slots) =
            (vec![coherent_mesh::free_slot(); 4096], vec![incoherent_mesh::free_slot(); 64]);
        for ray in 0..RAYS {
            let [u, v] = sobol(ray, 7);
            exits.begin();
            // So many hits are allowed that no path is chosen by chance, which would depend on the lanes.
            if interfere {
                let limits = Limits { in_flight: 0.0, generations: 6 };
                let (state, field) = waves.start(u, v).unwrap();
                trace(&mut waves, state, field, &mut wave_slots, limits, &mut exits);
            } else {
                let limits = Limits { in_flight: 0.0, generations: 100_000 };
                let (path, light) = paths.start(u, v).unwrap();
                let mut chance = Roulette::new(ray, 1);
                let done = follow_paths(&mut paths, path, light, &mut path_slots, limits, &mut chance, &mut exits);
                assert!(done.visits < u64::from(limits.generations));
                hits = hits.max(done.visits);
            }
            exits.flush(&mut powers);
        }
        let of_waves = waves.absorbed();
        let sum = if interfere { (of_waves.s + of_waves.p) * V::Light::splat(0.5) } else { paths.absorbed() };
        absorbed.extend((0..wavelengths.len()).map(|lane| sum.lane(lane)));
        powers.first += wavelengths.len();
    }
    (powers.sums, absorbed, hits)
}

/// Compares the lanes of `Many`, which are those of `V` in three registers, with `V` alone.
fn agree<V: RayLanes, Many: RayLanes>(k: f64, interfere: bool) {
    let scene = film(k).scene();
    let (one, absorbed, hits) = traced::<V>(&scene, interfere);
    let (many, absorbed_by_many, _) = traced::<Many>(&scene, interfere);
    // Some hundred roundings of a few numbers near 1 in each of the rays, whose powers add up.
    let rounding = 400.0 * V::UNIT_ROUNDOFF * f64::from(RAYS);
    // Paths below 1e-9 in all lanes are dropped, at most one at each hit.
    let dropped = 1e-9 * hits as f64 * f64::from(RAYS);
    // Light beside the edge of a bin may fall to either side of it, in single precision at least.
    let sides =
        |all: &[[[f64; 24]; 2]]| -> Vec<f64> { all.as_flattened().iter().map(|bins| bins.iter().sum()).collect() };
    let bins = |all: &[[[f64; 24]; 2]]| {
        // Where all wavelengths have one amplitude, waves of one direction share what they add to a third each by
        // itself.
        let is_shared_alike = V::UNIT_ROUNDOFF < 1e-10 && !(Many::IS_ALIKE && interfere);
        if is_shared_alike { all.as_flattened().as_flattened().to_vec() } else { sides(all) }
    };
    let (one, many) = (bins(&one), bins(&many));
    let mut light = 0.0;
    for (place, (a, b)) in one.iter().chain(&absorbed).zip(many.iter().chain(&absorbed_by_many)).enumerate() {
        let lanes = std::any::type_name::<V>();
        assert!((a - b).abs() <= rounding + dropped, "{lanes}, k = {k}, interfere {interfere}, place {place}: {a} {b}");
        light += a;
    }
    assert!(light > 0.5 * f64::from(RAYS) * WAVELENGTHS_NM.len() as f64, "{light}");
}

#[test]
fn many_wavelengths_at_once_are_what_each_is_alone() {
    for k in [0.0, 0.01] {
        for interfere in [false, true] {
            agree::<F64, Registers<F64, 3>>(k, interfere);
            agree::<F32, Registers<F32, 3>>(k, interfere);
        }
    }
}

#[test]
fn wavelengths_that_differ_in_phase_alone_are_what_each_is_alone() {
    for interfere in [false, true] {
        agree::<F64, Alike<F64, 3>>(0.0, interfere);
        agree::<F32, Alike<F32, 3>>(0.0, interfere);
    }
}
