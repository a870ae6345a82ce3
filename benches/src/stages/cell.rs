use std::hint::black_box;

use glam::DVec3;
use goniochrome::geometry::side::Side;
use goniochrome::measure::bins::{DirectionBins, ExitBuffer, ExitRecord, Histogram};
use goniochrome::optics::medium::MediaLanes;
use goniochrome::simd::complex::ComplexLanes;
use goniochrome::simd::ray_lanes::RayLanes;
use goniochrome::trace::coherent_mesh::{CoherentMesh, IncidentWave, free_slot};
use goniochrome::trace::incoherent_mesh::{self, IncoherentMesh};
use goniochrome::trace::paths::{IncoherentFallback, follow_paths, trace_with_fallback};
use goniochrome::trace::random::Random;
use goniochrome::trace::sobol::sobol;
use goniochrome::trace::waves::Limits;
use goniochrome_cli::scene::load;
use goniochrome_cli::solve::mesh_scene::MeshScene;

use super::{Visit, Work};
use crate::group;

const RAYS: u32 = 64;
const WAVES: usize = 8;
const PATHS: usize = 28;
const PATH_LIMITS: Limits = Limits { in_flight: 0.1, generations: 10_000 };
const WAVE_LIMITS: Limits = Limits { in_flight: 1e-13, generations: 10_000 };

/// The power that leaves, in the first lane.
struct Total(f64);

impl Histogram for Total {
    fn add(&mut self, lane: usize, _: Side, _: usize, power: f64) {
        self.0 += if lane == 0 { power } else { 0.0 };
    }
}

/// Starting rays through the bumpy soap film at 30 degrees: their paths add as powers, or interfere.
///
/// # Panics
/// If a result is wrong.
pub fn cell<V: RayLanes>(visit: Visit<'_>) {
    let scene = load("bumpy-soap-film").expect("a preset");
    let mesh_scene = MeshScene::new(&scene).expect("a cell");
    let mut buffer = mesh_scene.buffer();
    let cell = mesh_scene.cell(&mut buffer).expect("a good cell");
    let media = mesh_scene.media();
    let mut eta = vec![ComplexLanes::zero(); media.len()];
    let media = MediaLanes::<V>::evaluate(&media, &group::<V>(), &mut eta).expect("media with data");
    let wi = DVec3::new(0.5, 0.0, 0.75_f64.sqrt());
    let bins = DirectionBins { cos: 8, phi: 16 };
    let (mut waves, mut paths) = (vec![free_slot(); WAVES], vec![incoherent_mesh::free_slot(); PATHS]);
    let mut memory = vec![ExitRecord::none(); 512];
    for (name, interference) in [("powers", false), ("waves", true)] {
        let mut run = || {
            let light = IncidentWave::new(wi, media.eta()[usize::from(cell.above())]);
            let (mut coherent, mut incoherent) =
                (CoherentMesh::new(cell, media, light), IncoherentMesh::new(cell, media, light));
            let mut exits = ExitBuffer::new(&mut memory, bins, &media);
            let (mut total, mut visits) = (Total(0.0), 0);
            for ray in 0..RAYS {
                let [u, v] = sobol(ray, 1);
                let (path, light) = incoherent.start(u, v).expect("no hole");
                exits.begin();
                let mut random = Random::new(ray, 1);
                let done = if interference {
                    let (state, field) = coherent.start_at(path.at());
                    let fallback = IncoherentFallback::new(&mut incoherent, &mut paths, PATH_LIMITS, &mut random);
                    trace_with_fallback(&mut coherent, state, field, &mut waves, WAVE_LIMITS, fallback, &mut exits)
                } else {
                    follow_paths(&mut incoherent, path, light, &mut paths, PATH_LIMITS, &mut random, &mut exits)
                };
                visits += done.visits;
                exits.flush(&mut total);
            }
            (total.0 / f64::from(RAYS), visits)
        };
        let (power, visits) = run();
        // Without loss the powers of every ray add to 1; those of waves do so on average only.
        assert!((power - 1.0).abs() < if interference { 0.2 } else { 1e-4 }, "{name}: {power}");
        let amount = visits as f64 * V::WIDTH as f64;
        visit(&Work { stage: "trace cell", name, unit: "wavelength·states", amount }, &mut || {
            black_box(run());
        });
    }
}
