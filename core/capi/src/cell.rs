//! Periodic cells of polygons: a mesh in the caller's memory, and the light that it scatters.

use crate::media::{GONIO_MAX_MEDIA, MAX_NM, Media, Medium};
use crate::memory::{Block, Results, Tagged, list, room_for, shared};
use crate::stack::GONIO_MIRROR;
use crate::status::{Status, status_of};
use glam::DVec3;
use goniochrome::geometry::bvh::{Bvh, Node};
use goniochrome::geometry::facet::Facet;
use goniochrome::geometry::mesh_cell::{MeshCell, snap_to_border};
use goniochrome::geometry::side::Side;
use goniochrome::measure::bins::{DirectionBins, ExitBuffer, ExitRecord, Histogram};
use goniochrome::optics::interface::{Below, Interface as CoreInterface};
use goniochrome::optics::medium::MediaLanes;
use goniochrome::simd::complex::{ComplexLanes, Polarised};
use goniochrome::simd::lanes::{F32, Lanes};
use goniochrome::trace::coherent_mesh::{CoherentMesh, IncidentWave, WaveField, WaveState, free_slot};
use goniochrome::trace::incoherent_mesh::{self, Coherency, IncoherentMesh, Path};
use goniochrome::trace::paths::{IncoherentFallback, follow_paths, trace_with_fallback};
use goniochrome::trace::random::Random;
use goniochrome::trace::sobol::sobol;
use goniochrome::trace::waves::{Limits, Slot};

/// Size of a gonio_cell in bytes.
pub const GONIO_CELL_SIZE: usize = 8 * 384;
/// Alignment of a gonio_cell in bytes.
pub const GONIO_CELL_ALIGN: usize = 8;

const _: () = assert!(size_of::<Cell>() == GONIO_CELL_SIZE && align_of::<Cell>() == GONIO_CELL_ALIGN);

/// Periodic cell of polygons; made by gonio_cell_make. It may be moved, and shared between threads.
#[repr(C)]
#[derive(Debug)]
pub struct Cell {
    opaque: [u64; 384],
}

/// Media on the two sides of a facet.
#[repr(C)]
#[derive(Clone, Copy, Debug)]
pub struct Interface {
    /// Index of the medium on the side from which the triangles run counter-clockwise.
    pub above: u16,
    /// Index of the medium on the other side, or GONIO_MIRROR.
    pub below: u16,
}

/// Mesh over one period, [0, period_x] × [0, period_y], z up, which repeats. It must be closed: light that falls
/// through a hole is lost and counts as truncated. Vertices that lie beside the border of the period by the rounding of
/// single precision are moved onto it.
#[repr(C)]
#[derive(Clone, Copy, Debug)]
pub struct Mesh {
    /// Three coordinates of each vertex, in nanometres, from -1e9 to 1e9.
    pub vertices_nm: *const f64,
    /// Number of vertices.
    pub vertex_count: usize,
    /// Indices of the three vertices of each triangle.
    pub triangles: *const u32,
    /// Index of the interface of each triangle.
    pub interface_of: *const u16,
    /// Number of triangles.
    pub triangle_count: usize,
    /// Interfaces.
    pub interfaces: *const Interface,
    /// Number of interfaces.
    pub interface_count: usize,
    /// Media.
    pub media: *const Medium,
    /// Number of media.
    pub media_count: usize,
    /// Periods in x and y, in nanometres.
    pub period_nm: [f64; 2],
    /// Index of the medium that light comes from.
    pub ambient: u16,
}

/// Incident light, and settings of the tracer.
#[repr(C)]
#[derive(Clone, Copy, Debug)]
pub struct Light {
    /// Unit vector towards the light, z > 0.
    pub wi: [f64; 3],
    /// Vacuum wavelengths in nanometres.
    pub wavelength_nm: *const f64,
    /// Number of wavelengths.
    pub count: usize,
    /// Number of starting rays over the period, at least 1.
    pub rays: u32,
    /// Seed of the sequence of starting points. Results of different seeds are independent.
    pub seed: u32,
    /// Number of bins of reflected light in cos theta, counted from the horizon; 1 to 1024.
    pub bins_cos: u32,
    /// Number of bins of reflected light in phi, counted from x; 1 to 1024.
    pub bins_phi: u32,
    /// Coherence. 1: paths of one starting ray that leave within 40 degrees interfere; 0: every path adds as power.
    pub interference: u32,
}

/// Distribution of the unpolarised incident power, as fractions of it.
#[repr(C)]
#[derive(Clone, Copy, Debug)]
pub struct Power {
    /// Power that leaves through the top.
    pub reflected: f64,
    /// Power that leaves through the bottom.
    pub transmitted: f64,
    /// Power that media absorb.
    pub absorbed: f64,
    /// Power of rays that were dropped or lost: the error bar.
    pub truncated: f64,
}

/// Contents of a gonio_cell.
struct CellObject {
    cell: MeshCell<'static>,
    media: Media,
}

/// Largest number of waves in flight, as on the command line.
const MAX_WAVES: usize = 26;
/// Largest number of paths that wait while one is followed.
const MAX_PATHS: usize = 10;
/// Largest number of exits of one starting ray. Further ones add their power to the nearest direction.
const MAX_EXITS: usize = 128;
/// Limits of waves that interfere.
const WAVE_LIMITS: Limits = Limits { in_flight: 1e-13, generations: 10_000 };
/// Limits of paths that add as powers.
const PATH_LIMITS: Limits = Limits { in_flight: 0.01, generations: 10_000 };
/// Largest number of bins in cos theta or in phi.
const MAX_SIDE: u32 = 1024;

type WaveSlot = Slot<WaveState<F32>, WaveField<F32>>;
type PathSlot = Slot<Path<F32>, Coherency<F32>>;

/// Computes the size in bytes of the memory, at any alignment, that a cell of so many triangles and interfaces needs; 0
/// if there are too many.
#[unsafe(no_mangle)]
pub extern "C" fn gonio_cell_memory_size(triangle_count: usize, interface_count: usize) -> usize {
    let corner_count = triangle_count.checked_mul(3);
    let sizes = [
        corner_count.and_then(room_for::<DVec3>),
        room_for::<[u32; 3]>(triangle_count),
        room_for::<Node>(Bvh::required_nodes(triangle_count)),
        room_for::<u32>(triangle_count),
        room_for::<f64>(Bvh::required_corners(triangle_count)),
        room_for::<u32>(triangle_count),
        room_for::<Facet>(triangle_count),
        room_for::<CoreInterface>(interface_count),
    ];
    sum(sizes)
}

/// Computes the size in bytes of the memory, at any alignment, that gonio_cell_trace needs for such light; 0 if there
/// are too many wavelengths or bins.
///
/// # Safety
/// A pointer that is neither NULL nor misaligned points to an object of its type.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn gonio_trace_memory_size(light: *const Light) -> usize {
    // SAFETY: the caller's promise.
    let Ok(light) = (unsafe { shared(light) }) else { return 0 };
    let bins = bin_count(light).unwrap_or(usize::MAX);
    let bins = light.count.checked_mul(bins).and_then(room_for::<f64>);
    sum([
        room_for::<WaveSlot>(MAX_WAVES),
        room_for::<PathSlot>(MAX_PATHS),
        room_for::<ExitRecord<F32>>(MAX_EXITS),
        bins,
        room_for::<Power>(light.count),
    ])
}

/// Sum of sizes; 0 if one is missing, or the sum exceeds memory.
fn sum<const N: usize>(sizes: [Option<usize>; N]) -> usize {
    sizes.iter().try_fold(0usize, |sum, size| sum.checked_add((*size)?)).unwrap_or(0)
}

/// Number of bins of one wavelength; `None` if a side is out of range.
fn bin_count(light: &Light) -> Option<usize> {
    let valid = |side: u32| (1..=MAX_SIDE).contains(&side);
    (valid(light.bins_cos) && valid(light.bins_phi)).then_some(light.bins_cos as usize * light.bins_phi as usize)
}

/// Makes a cell in `memory`, which has `memory_size` bytes, at least as many as gonio_cell_memory_size says. The cell
/// keeps pointers into `memory` and to the media's arrays: all must outlive the cell and must not change. Triangles of
/// one interface in one plane form one facet; they are found by comparing each with each, which suits cells of up to
/// some thousand triangles.
///
/// # Safety
/// Pointers that are neither NULL nor misaligned point to as many elements of their types as the counts say.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn gonio_cell_make(
    cell: *mut Cell,
    mesh: *const Mesh,
    memory: *mut u8,
    memory_size: usize,
) -> Status {
    let object = || {
        // SAFETY: the caller's promises.
        unsafe { build(shared(mesh)?, Block::new(memory, memory_size)?) }
    };
    // SAFETY: the caller's promises.
    status_of(|| unsafe { Tagged::write(cell, object) })
}

/// Builds the cell in a block of memory.
///
/// # Safety
/// The mesh's pointers that are neither NULL nor misaligned point to as many elements as its counts say, which outlive
/// the cell.
unsafe fn build(mesh: &Mesh, mut block: Block) -> Result<CellObject, Status> {
    // SAFETY: the caller's promises; glam's vectors are three numbers in a row.
    let (vertices, triangles, kinds, interfaces, media) = unsafe {
        (
            list(mesh.vertices_nm.cast::<DVec3>(), mesh.vertex_count)?,
            list(mesh.triangles.cast::<[u32; 3]>(), mesh.triangle_count)?,
            list(mesh.interface_of, mesh.triangle_count)?,
            list(mesh.interfaces, mesh.interface_count)?,
            Media::new(mesh.media, mesh.media_count)?,
        )
    };
    if !vertices.iter().all(|v| v.abs().max_element() <= MAX_NM) {
        return Err(Status::Mesh);
    }
    if !triangles.iter().flatten().all(|&vertex| (vertex as usize) < vertices.len()) {
        return Err(Status::Index);
    }
    let count = triangles.len();
    // Each triangle gets three vertices of its own: these move onto the border, and the caller's stay unchanged.
    let corner = |i: usize| triangles.as_flattened().get(i).and_then(|&v| vertices.get(v as usize));
    let vertices = block.take(3 * count, |i| corner(i).copied().unwrap_or(DVec3::ZERO))?;
    snap_to_border(vertices, mesh.period_nm);
    let (vertices, triangles) = (&*vertices, &*block.take(count, |i| [0, 1, 2].map(|corner| 3 * i as u32 + corner))?);
    let nodes = block.take(Bvh::required_nodes(count), |_| Node::EMPTY)?;
    let order = block.take(count, |_| 0)?;
    let corners = block.take(Bvh::required_corners(count), |_| 0.0)?;
    let facet_of = block.take(count, |_| 0)?;
    let facets = block.take(count, |_| Facet::horizontal(0.0, 0))?;
    for interface in interfaces {
        media.index(interface.above)?;
        if interface.below != GONIO_MIRROR {
            media.index(interface.below)?;
        }
    }
    let below = |medium| if medium == GONIO_MIRROR { Below::Mirror } else { Below::Medium(medium) };
    let core_interface = |i: &Interface| CoreInterface { above: i.above, below: below(i.below) };
    let none = CoreInterface { above: 0, below: Below::Mirror };
    let interfaces = block.take(interfaces.len(), |i| interfaces.get(i).map_or(none, core_interface))?;
    let ambient = media.index(mesh.ambient)?;

    let bvh = Bvh::build(vertices, triangles, nodes, order, corners)?;
    let facet_count = group_into_facets(vertices, triangles, kinds, facet_of, facets)?;
    let facets = facets.get(..facet_count).ok_or(Status::Memory)?;
    let cell = MeshCell::new(bvh, facet_of, facets, interfaces, mesh.period_nm, ambient)?;
    Ok(CellObject { cell, media })
}

/// Groups triangles of one interface in one plane into facets, whether they are connected or not. Returns the number of
/// facets.
fn group_into_facets(
    vertices: &[DVec3],
    triangles: &[[u32; 3]],
    kinds: &[u16],
    facet_of: &mut [u32],
    facets: &mut [Facet],
) -> Result<usize, Status> {
    /// Largest difference of normals, and largest distance from a plane relative to the largest coordinate: the
    /// rounding of single-precision files.
    const MAX_DEVIATION: f64 = 1e-6;
    let corner = |vertex: u32| vertices.get(vertex as usize).copied().ok_or(Status::Index);
    let extent = vertices.iter().map(|v| v.abs().max_element()).fold(0.0, f64::max);
    let mut count = 0;
    for ((&[a, b, c], &interface), facet_of) in triangles.iter().zip(kinds).zip(facet_of) {
        let (a, b, c) = (corner(a)?, corner(b)?, corner(c)?);
        let normal = (b - a).cross(c - a).try_normalize().ok_or(Status::Mesh)?;
        let same = |facet: &Facet| {
            facet.interface == interface
                && (facet.normal - normal).length_squared() < MAX_DEVIATION * MAX_DEVIATION
                && [a, b, c].iter().all(|v| facet.normal.dot(v - facet.anchor_nm).abs() < MAX_DEVIATION * extent)
        };
        let known = facets.iter().take(count).position(same);
        if known.is_none() {
            *facets.get_mut(count).ok_or(Status::Memory)? = Facet { normal, anchor_nm: a, interface };
            count += 1;
        }
        *facet_of = known.unwrap_or(count - 1) as u32;
    }
    Ok(count)
}

/// Traces light through a cell. `power` receives one element for each wavelength. Unless it is NULL, `bins` receives,
/// for each wavelength, the reflected power of each bin, row by row in cos theta. With interference, the power of a bin
/// that few rays reach may be below zero, by noise. `memory` has `memory_size` bytes, at least as many as
/// gonio_trace_memory_size says, and is used by this call alone. It uses 29 KiB of stack, 51 KiB with AVX-512.
///
/// # Safety
/// Pointers that are neither NULL nor misaligned point to as many elements of their types as the counts say.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn gonio_cell_trace(
    cell: *const Cell,
    light: *const Light,
    memory: *mut u8,
    memory_size: usize,
    power: *mut Power,
    bins: *mut f64,
) -> Status {
    status_of(|| {
        // SAFETY: the caller's promises.
        let (object, light, mut block) =
            unsafe { (Tagged::<CellObject>::get(cell)?, shared(light)?, Block::new(memory, memory_size)?) };
        let bin_count = bin_count(light).ok_or(Status::Argument)?;
        let all_bins = light.count.checked_mul(bin_count).ok_or(Status::TooMany)?;
        // SAFETY: the caller's promises.
        let (wavelengths, power, bins) = unsafe {
            let bins = if bins.is_null() { None } else { Some(Results::new(bins, all_bins)?) };
            (list(light.wavelength_nm, light.count)?, Results::new(power, light.count)?, bins)
        };
        let wi = DVec3::from_array(light.wi);
        /// Largest error of the squared length of a unit vector.
        const MAX_ERROR: f64 = 1e-6;
        if !(wi.z > 0.0 && (wi.length_squared() - 1.0).abs() < MAX_ERROR) {
            return Err(Status::Direction);
        }
        if light.rays == 0 || light.interference > 1 {
            return Err(Status::Argument);
        }
        object.media.check(wavelengths, object.cell.above())?;

        let mut tracer = Tracer {
            object,
            light,
            wi: wi.normalize_or_zero(),
            waves: block.take(MAX_WAVES, |_| free_slot::<F32>())?,
            paths: block.take(MAX_PATHS, |_| incoherent_mesh::free_slot::<F32>())?,
            exits: block.take(MAX_EXITS, |_| ExitRecord::<F32>::none())?,
        };
        let totals =
            block.take(light.count, |_| Power { reflected: 0.0, transmitted: 0.0, absorbed: 0.0, truncated: 0.0 })?;
        let sums = block.take(all_bins, |_| 0.0)?;
        for (group, wavelengths) in wavelengths.chunks(F32::WIDTH).enumerate() {
            let (from, to) = (group * F32::WIDTH, group * F32::WIDTH + wavelengths.len());
            let totals = totals.get_mut(from..to).ok_or(Status::Memory)?;
            let sums = sums.get_mut(from * bin_count..to * bin_count).ok_or(Status::Memory)?;
            tracer.trace_group(wavelengths, totals, sums, bin_count)?;
        }
        let finite = |p: &Power| [p.reflected, p.transmitted, p.absorbed, p.truncated].iter().all(|x| x.is_finite());
        if !totals.iter().all(|p| finite(p) && p.truncated <= 1.0) {
            return Err(Status::Diverged);
        }
        power.write(totals.iter().copied());
        if let Some(bins) = bins {
            bins.write(sums.iter().copied());
        }
        Ok(())
    })
}

/// Memory and settings of a trace through a cell.
struct Tracer<'t> {
    object: &'t CellObject,
    light: &'t Light,
    wi: DVec3,
    waves: &'t mut [WaveSlot],
    paths: &'t mut [PathSlot],
    exits: &'t mut [ExitRecord<F32>],
}

/// Sums of power at one group of wavelengths. Lanes beyond the last wavelength repeat it and do not count.
struct Tally<'t> {
    totals: &'t mut [Power],
    sums: &'t mut [f64],
    bin_count: usize,
}

impl Histogram for Tally<'_> {
    fn add(&mut self, lane: usize, side: Side, bin: usize, power: f64) {
        let Some(total) = self.totals.get_mut(lane) else { return };
        match side {
            Side::Above => {
                total.reflected += power;
                if let Some(sum) = self.sums.get_mut(lane * self.bin_count + bin) {
                    *sum += power;
                }
            }
            Side::Below => total.transmitted += power,
        }
    }
}

impl Tracer<'_> {
    /// Traces all starting rays at one group of wavelengths.
    fn trace_group(
        &mut self,
        wavelengths_nm: &[f64],
        totals: &mut [Power],
        sums: &mut [f64],
        bin_count: usize,
    ) -> Result<(), Status> {
        let media = self.object.media.as_slice();
        let mut eta = [ComplexLanes::zero(); GONIO_MAX_MEDIA];
        let eta = eta.get_mut(..media.len()).ok_or(Status::TooMany)?;
        let lanes = MediaLanes::<F32>::evaluate(media, wavelengths_nm, eta).map_err(|(_, error)| error)?;
        let cell = self.object.cell;
        let ambient = lanes.eta().get(usize::from(cell.above())).copied().ok_or(Status::Index)?;
        let interference = self.light.interference == 1;
        let incident = IncidentWave::new(self.wi, ambient);
        let (mut coherent, mut incoherent) =
            (CoherentMesh::new(cell, lanes, incident), IncoherentMesh::new(cell, lanes, incident));
        let grid = DirectionBins { cos: self.light.bins_cos, phi: self.light.bins_phi };
        let mut exits = ExitBuffer::new(self.exits, grid, &lanes);
        let mut tally = Tally { totals, sums, bin_count };
        let (mut truncated, seed) = (F32::zero(), self.light.seed);
        for ray in 0..self.light.rays {
            let [u, v] = sobol(ray, seed);
            let Some((path, light)) = incoherent.start(u, v) else {
                truncated += F32::one();
                continue;
            };
            exits.begin();
            let mut random = Random::new(ray, seed);
            let trace = if interference {
                let (state, field) = coherent.start_at(path.at());
                let fallback = IncoherentFallback::new(&mut incoherent, self.paths, PATH_LIMITS, &mut random);
                trace_with_fallback(&mut coherent, state, field, self.waves, WAVE_LIMITS, fallback, &mut exits)
            } else {
                follow_paths(&mut incoherent, path, light, self.paths, PATH_LIMITS, &mut random, &mut exits)
            };
            truncated += trace.truncated + exits.flush(&mut tally);
        }
        truncated += coherent.lost() + incoherent.lost();
        let Polarised { s, p } = coherent.absorbed();
        let absorbed = (s + p) * F32::splat(0.5) + incoherent.absorbed();
        let per_ray = 1.0 / f64::from(self.light.rays);
        for (lane, total) in tally.totals.iter_mut().enumerate() {
            total.truncated = truncated.lane(lane) * per_ray;
            total.absorbed = absorbed.lane(lane) * per_ray;
            total.reflected *= per_ray;
            total.transmitted *= per_ray;
        }
        tally.sums.iter_mut().for_each(|sum| *sum *= per_ray);
        Ok(())
    }
}
