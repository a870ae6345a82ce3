//! Functions for cells of polygons: hierarchy, mesh, coatings, both tracers, every sink, sampling, diffraction orders.

use core::slice;
use goniochrome::geometry::bvh::{Bvh, Hit, Node, Ray};
use goniochrome::geometry::facet::Facet;
use goniochrome::geometry::mesh_cell::MeshCell;
use goniochrome::geometry::side::Side;
use goniochrome::glam::DVec3;
use goniochrome::measure::bins::{BinFields, DirectionBins, ExitBuffer, ExitRecord, Histogram};
use goniochrome::measure::orders::{Order, Orders, max_order};
use goniochrome::optics::interface::Interface;
use goniochrome::optics::medium::{Dispersion, Extrapolate, Formula, MediaLanes, Medium};
use goniochrome::optics::stack::Film;
use goniochrome::simd::complex::{ComplexLanes, Polarised};
use goniochrome::simd::lanes::{F32, F64};
use goniochrome::simd::ray_lanes::RayLanes;
use goniochrome::simd::vector::VectorLanes;
use goniochrome::trace::coherent_mesh::{CoherentMesh, IncidentWave, free_slot};
use goniochrome::trace::incoherent_mesh::{self, IncoherentMesh};
use goniochrome::trace::paths::{IncoherentFallback, follow_paths, trace_with_fallback};
use goniochrome::trace::random::Random;
use goniochrome::trace::sobol::sobol;
use goniochrome::trace::waves::{Limits, trace};

/// The inputs, which only the caller knows.
pub struct Scene<'a> {
    vertices_nm: &'a [DVec3],
    triangles: &'a [[u32; 3]],
    facet_of: &'a [u32],
    facets: &'a [Facet],
    interfaces: &'a [Interface],
    films: &'a [Film],
    coefficients: &'a [f64],
    wavelengths_nm: &'a [f64],
    period_nm: [f64; 2],
    wi: DVec3,
    grid: DirectionBins,
    order: [i32; 2],
    rays: u32,
    seed: u32,
    straight: &'a [Ray],
    medium: u16,
    interference: bool,
}

/// The caller's memory for results.
pub struct Memory<'a> {
    nodes: &'a mut [Node],
    order: &'a mut [u32],
    corners: &'a mut [f64],
    bins: &'a mut [f64],
    hits: &'a mut [Option<Hit>],
}

struct Power<'a>(&'a mut [f64]);

impl Histogram for Power<'_> {
    fn add(&mut self, _: usize, side: Side, bin: usize, power: f64) {
        if let Some(sum) = self.0.get_mut(bin).filter(|_| side == Side::Above) {
            *sum += power;
        }
    }
}

/// The sum of the powers that a scene reflects, in single and in double precision; NaN if an input is refused.
#[unsafe(no_mangle)]
pub extern "C" fn cell_power(scene: &Scene<'_>, memory: &mut Memory<'_>) -> f64 {
    let single = power::<F32>(scene, memory).unwrap_or(f64::NAN);
    single + power::<F64>(scene, memory).unwrap_or(f64::NAN)
}

fn power<V: RayLanes<Light = V>>(scene: &Scene<'_>, memory: &mut Memory<'_>) -> Option<f64> {
    let bvh = Bvh::build(scene.vertices_nm, scene.triangles, memory.nodes, memory.order, memory.corners).ok()?;
    bvh.intersect_batch(scene.straight, memory.hits, |_, hit| hit.front);
    let cell =
        MeshCell::new(bvh, scene.facet_of, scene.facets, scene.interfaces, scene.period_nm, scene.medium).ok()?;
    let coatings = [scene.films];
    let cell = cell.with_coatings(&coatings).ok()?;
    let formula =
        Dispersion::Formula { formula: Formula::Sellmeier, coefficients: scene.coefficients, range_nm: [380.0, 780.0] };
    let table = Dispersion::Table { wavelength_nm: scene.wavelengths_nm, value: scene.coefficients };
    let media = [Medium::VACUUM, Medium::new(formula, table, Extrapolate::Clamp).ok()?];
    let mut eta = [ComplexLanes::zero(); 2];
    let media = MediaLanes::<V>::evaluate(&media, scene.wavelengths_nm, &mut eta).ok()?;
    let ambient = media.eta().first().copied()?;
    let incident = IncidentWave::new(scene.wi, ambient);
    let (mut coherent, mut incoherent) =
        (CoherentMesh::new(cell, media, incident), IncoherentMesh::new(cell, media, incident));
    let (mut slots, mut paths) = ([free_slot::<V>(); 26], [incoherent_mesh::free_slot::<V>(); 10]);
    let mut exit_memory = [ExitRecord::<V>::none(); 64];
    let mut exits = ExitBuffer::new(&mut exit_memory, scene.grid, &media);
    let mut fields = [Polarised::both(VectorLanes::zero()); 64];
    let mut bins = BinFields::new(&mut fields, scene.grid, &media, incident.wavevector());
    let max = max_order(scene.period_nm[0], 1.0, 380.0);
    let mut order = [Order::new(scene.order.map(|m| m.min(max)), scene.wi, scene.period_nm, ambient, &media)];
    let mut orders = Orders::new(&mut order, scene.wi, ambient, &media);
    let limits = Limits { in_flight: 1e-13, generations: 10_000 };
    let mut sum = V::zero();
    for ray in 0..scene.rays {
        let [u, v] = sobol(ray, scene.seed);
        let Some((state, field)) = coherent.start(u, v) else { continue };
        let mut random = Random::new(ray, scene.seed);
        exits.begin();
        if scene.interference {
            let few = Limits { in_flight: 0.01, ..limits };
            let fallback = IncoherentFallback::new(&mut incoherent, &mut paths, few, &mut random);
            sum += trace_with_fallback(&mut coherent, state, field, &mut slots, limits, fallback, &mut exits).truncated;
            bins.begin(state.point_nm());
            sum += trace(&mut coherent, state, field, &mut slots, limits, &mut bins).truncated;
            orders.begin(state.point_nm());
            sum += trace(&mut coherent, state, field, &mut slots, limits, &mut orders).truncated;
        } else if let Some((path, light)) = incoherent.start(u, v) {
            sum += follow_paths(&mut incoherent, path, light, &mut paths, limits, &mut random, &mut exits).truncated;
        }
        sum += exits.flush(&mut Power(memory.bins));
    }
    for order in slice::from_ref(&order[0]) {
        sum += order.efficiency(f64::from(scene.rays)).s;
    }
    sum += fields[0].map(VectorLanes::norm_sqr).p
        + coherent.lost()
        + coherent.absorbed().s
        + incoherent.lost()
        + incoherent.absorbed();
    let solid: f64 =
        (0..memory.bins.len().min(scene.grid.count())).map(|bin| scene.grid.projected_solid_angle(bin)).sum();
    Some(sum.lane(0) + solid)
}
