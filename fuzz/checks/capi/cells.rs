//! Calls that make and trace cells of polygons.

use super::media::Media;
use super::out::Out;
use super::program::Program;
use goniochrome::simd::lanes::{F32, Lanes};
use goniochrome_capi::cell::{
    Cell, Interface, Light, Mesh, Power, gonio_cell_make, gonio_cell_memory_size, gonio_cell_trace,
    gonio_trace_memory_size,
};
use goniochrome_capi::stack::GONIO_MIRROR;
use goniochrome_capi::status::Status;

/// A cell that was made, and everything that it points to.
pub struct Facets {
    object: Out<Cell>,
    _vertices: Vec<f64>,
    _triangles: Vec<u32>,
    _media: Media,
    _memory: Vec<u8>,
}

/// Vertices, triangles, and the interface of each triangle.
type Shape = (Vec<f64>, Vec<u32>, Vec<u16>);

/// One or two closed sheets over 2 × 2 squares.
fn sheets(program: &mut Program<'_>, period_nm: [f64; 2]) -> Shape {
    let (mut vertices, mut triangles, mut kinds) = (Vec::new(), Vec::new(), Vec::new());
    let heights: [f64; 4] = std::array::from_fn(|_| program.number(0.0, 1000.0));
    for sheet in 0..1 + program.below(2) {
        let depth = if sheet == 0 { 0.0 } else { program.number(1.0, 2000.0) };
        for (j, i) in (0..3).flat_map(|j| (0..3).map(move |i| (j, i))) {
            let height = heights[(j % 2) * 2 + i % 2] - depth;
            vertices.extend([period_nm[0] * i as f64 / 2.0, period_nm[1] * j as f64 / 2.0, height]);
        }
        for (j, i) in (0..2).flat_map(|j| (0..2).map(move |i| (j, i))) {
            let corner = |di: usize, dj: usize| (9 * sheet + (j + dj) * 3 + i + di) as u32;
            triangles.extend([corner(0, 0), corner(1, 0), corner(1, 1), corner(0, 0), corner(1, 1), corner(0, 1)]);
            kinds.extend([sheet as u16; 2]);
        }
    }
    (vertices, triangles, kinds)
}

/// Any triangles, with holes and crossings, and sometimes with a vertex or an interface that does not exist.
fn soup(program: &mut Program<'_>, period_nm: [f64; 2], interfaces: usize) -> Shape {
    let count = program.below(10);
    let vertex = |program: &mut Program<'_>| {
        [program.number(0.0, period_nm[0]), program.number(0.0, period_nm[1]), program.number(-1000.0, 1000.0)]
    };
    let vertices = (0..count).flat_map(|_| vertex(program)).collect();
    let index = |program: &mut Program<'_>, n: usize| (usize::from(program.byte()) % (16 * n + 1)) / 16;
    let count_of_triangles = program.below(10);
    let triangles = (0..3 * count_of_triangles).map(|_| index(program, count) as u32).collect();
    let kinds = (0..count_of_triangles).map(|_| index(program, interfaces) as u16).collect();
    (vertices, triangles, kinds)
}

pub fn make(program: &mut Program<'_>, cell: &mut Option<Facets>) {
    let mut faults = program.faults();
    let media = Media::new(program, &mut faults);
    let period_nm = [program.number(100.0, 5000.0), program.number(100.0, 5000.0)];
    let interface = |program: &mut Program<'_>| Interface {
        above: media.index(program),
        below: if program.byte() & 3 == 0 { GONIO_MIRROR } else { media.index(program) },
    };
    let interfaces: Vec<Interface> = (0..program.below(4)).map(|_| interface(program)).collect();
    let (vertices, triangles, kinds) = match program.byte() & 1 {
        0 => sheets(program, period_nm),
        _ => soup(program, period_nm, interfaces.len()),
    };
    let needed = gonio_cell_memory_size(kinds.len(), interfaces.len());
    let short = program.byte();
    let size = if short >= 0xf0 { needed / 2 } else { needed };
    // At any alignment.
    let shift = usize::from(short & 7);
    let mut memory = vec![0u8; needed + shift];
    let mesh = Mesh {
        vertices_nm: faults.list(&vertices),
        vertex_count: vertices.len() / 3,
        triangles: faults.list(&triangles),
        interface_of: faults.list(&kinds),
        triangle_count: kinds.len(),
        interfaces: faults.list(&interfaces),
        interface_count: interfaces.len(),
        media: faults.list(&media.list),
        media_count: media.list.len(),
        period_nm,
        ambient: media.index(program),
    };
    let mut object = Out::new(1);
    // SAFETY: pointers are NULL, misaligned, or to as much as the counts say. What the object points to is kept with
    // it.
    let status = unsafe {
        gonio_cell_make(
            faults.pass_mut(object.pointer()),
            faults.pass(&raw const mesh),
            faults.pass_mut(memory.as_mut_ptr().wrapping_add(shift)),
            size,
        )
    };
    assert!(!(faults.hit() && status == Status::Ok), "a bad pointer was taken");
    assert!(status != Status::Memory || size < needed, "the stated memory is too small");
    if object.succeeded(status) {
        let (_vertices, _triangles, _media, _memory) = (vertices, triangles, media, memory);
        *cell = Some(Facets { object, _vertices, _triangles, _media, _memory });
    }
}

pub fn trace(program: &mut Program<'_>, cell: Option<&Facets>) {
    let mut faults = program.faults();
    let nm: Vec<f64> = (0..program.below(4)).map(|_| program.number(200.0, 1500.0)).collect();
    let wi = [program.number(-0.9, 0.9), program.number(-0.4, 0.4)];
    let light = Light {
        wi: [wi[0], wi[1], (1.0 - wi[0] * wi[0] - wi[1] * wi[1]).sqrt()],
        wavelength_nm: faults.list(&nm),
        count: nm.len(),
        rays: program.below(4) as u32,
        seed: program.byte().into(),
        bins_cos: program.below(5) as u32,
        bins_phi: program.below(5) as u32,
        interference: program.below(3) as u32,
    };
    let with_bins = program.byte() & 1 == 0;
    // SAFETY: the light exists, and its pointers are not followed.
    let needed = unsafe { gonio_trace_memory_size(&raw const light) };
    let short = program.byte();
    let size = if short >= 0xf0 { needed / 2 } else { needed };
    let shift = usize::from(short & 7);
    let mut memory = vec![0u8; needed + shift];
    let count = (light.bins_cos * light.bins_phi) as usize;
    let (nothing, mut power, mut bins) = (Out::new(1), Out::<Power>::new(nm.len()), Out::<f64>::new(nm.len() * count));
    // SAFETY: pointers are NULL, misaligned, or to as much as the counts say.
    let status = unsafe {
        gonio_cell_trace(
            faults.pass(cell.map_or(&nothing, |cell| &cell.object).object()),
            faults.pass(&raw const light),
            faults.pass_mut(memory.as_mut_ptr().wrapping_add(shift)),
            size,
            faults.pass_mut(power.pointer()),
            if with_bins { bins.pointer() } else { std::ptr::null_mut() },
        )
    };
    assert!(!(faults.hit() && status == Status::Ok), "a bad pointer was taken");
    assert!(cell.is_some() || status != Status::Ok, "nothing was made, and answered");
    // Impossible bins are stated to need no memory.
    assert!(status != Status::Memory || size < needed || needed == 0, "the stated memory is too small");
    let done = power.succeeded(status);
    if with_bins {
        bins.succeeded(status);
    }
    if done {
        for (wavelength, power) in power.results().iter().enumerate() {
            let bins = with_bins.then(|| &bins.results()[wavelength * count..][..count]);
            holds(power, bins, light.interference == 0);
        }
        if light.interference == 0 {
            ledger_closes(power.results());
        }
    }
}

/// Checks that the ledger adds up to 1. Weak paths are drawn by their power in all lanes together, and lanes beyond the
/// last wavelength repeat it. So every draw keeps the mean over lanes, and each wavelength's own power only on average.
fn ledger_closes(power: &[Power]) {
    /// Bound of rounding: trapped light hits facets ten thousand times, and each time its power is rounded where it
    /// arrives, in both branches, and in their fields.
    const LEDGER: f64 = 1e4 * 4.0 * (f32::EPSILON as f64 / 2.0);
    let total = |p: &Power| p.reflected + p.transmitted + p.absorbed + p.truncated;
    let repeated = (F32::WIDTH - power.len()) as f64 * power.last().map_or(0.0, total);
    let mean = (power.iter().map(total).sum::<f64>() + repeated) / F32::WIDTH as f64;
    assert!((mean - 1.0).abs() <= LEDGER, "{mean}");
    assert!(power.iter().all(|p| p.absorbed >= -LEDGER), "power was gained");
}

/// Checks that powers are finite, and that the bins hold the reflected power. Single powers are never negative; where a
/// few starting rays interfere, several waves may take more from one than it carries.
fn holds(power: &Power, bins: Option<&[f64]>, single: bool) {
    /// Rounding of two sums of some hundred powers in double precision.
    const SUM: f64 = 1e-12;
    let &Power { reflected, transmitted, absorbed, truncated } = power;
    let parts = [reflected, transmitted, absorbed, truncated];
    assert!(parts.iter().all(|part| part.is_finite()) && truncated >= 0.0, "{parts:?}");
    assert!(reflected >= 0.0 || !single, "{parts:?}");
    if let Some(bins) = bins {
        let (sum, size) = (bins.iter().sum::<f64>(), bins.iter().map(|power| power.abs()).sum::<f64>());
        assert!((sum - reflected).abs() <= SUM * (1.0 + size), "{bins:?}");
        assert!(!single || bins.iter().all(|power| *power >= 0.0), "{bins:?}");
    }
}
