//! Tests of polygon cells through the C interface.

use goniochrome_capi::cell::{
    Cell, GONIO_CELL_SIZE, Interface, Light, Mesh, Power, gonio_cell_make, gonio_cell_memory_size, gonio_cell_trace,
    gonio_trace_memory_size,
};
use goniochrome_capi::media::Medium;
use goniochrome_capi::status::Status;

const PERIOD_NM: [f64; 2] = [10_000.0, 8_000.0];

/// Refractive indices of air, film and glass.
const INDICES: [f64; 3] = [1.0, 1.6, 1.5];

/// The powers of light from 20 degrees without interference. An interface of `kinds` is 0 for air over film, 1 for film
/// over glass.
fn trace(vertices: &[f64], triangles: &[u32], kinds: &[u16]) -> Power {
    let medium = |n: &f64| Medium { wavelength_nm: std::ptr::null(), n, k: std::ptr::null(), count: 1 };
    let media: Vec<Medium> = INDICES.iter().map(medium).collect();
    let interfaces = [Interface { above: 0, below: 1 }, Interface { above: 1, below: 2 }];
    let mesh = Mesh {
        vertices_nm: vertices.as_ptr(),
        vertex_count: vertices.len() / 3,
        triangles: triangles.as_ptr(),
        interface_of: kinds.as_ptr(),
        triangle_count: kinds.len(),
        interfaces: interfaces.as_ptr(),
        interface_count: interfaces.len(),
        media: media.as_ptr(),
        media_count: media.len(),
        period_nm: PERIOD_NM,
        ambient: 0,
    };
    let mut cell = vec![0u64; GONIO_CELL_SIZE / 8];
    let cell = cell.as_mut_ptr().cast::<Cell>();
    let mut memory = vec![0u8; gonio_cell_memory_size(kinds.len(), interfaces.len())];
    // SAFETY: every pointer is to as much as the counts say.
    let status = unsafe { gonio_cell_make(cell, &raw const mesh, memory.as_mut_ptr(), memory.len()) };
    assert_eq!(status, Status::Ok);
    let (sin, cos) = 20f64.to_radians().sin_cos();
    let wavelength_nm = 550.0;
    let light = Light {
        wi: [sin, 0.0, cos],
        wavelength_nm: &raw const wavelength_nm,
        count: 1,
        rays: 1024,
        seed: 0,
        bins_cos: 1,
        bins_phi: 1,
        interference: 0,
    };
    // SAFETY: the light exists.
    let mut workspace = vec![0u8; unsafe { gonio_trace_memory_size(&raw const light) }];
    let mut power = Power { reflected: 0.0, transmitted: 0.0, absorbed: 0.0, truncated: 0.0 };
    // SAFETY: the cell was made, and every pointer is to as much as the counts say.
    let status = unsafe {
        let (memory, size) = (workspace.as_mut_ptr(), workspace.len());
        gonio_cell_trace(cell, &raw const light, memory, size, &raw mut power, std::ptr::null_mut())
    };
    assert_eq!(status, Status::Ok);
    power
}

/// The corners of a rectangle from x = 0 to `x`, at height `z`.
fn sheet(x: f64, z: f64) -> [f64; 12] {
    let y = PERIOD_NM[1];
    [0.0, 0.0, z, x, 0.0, z, x, y, z, 0.0, y, z]
}

const TWO_SHEETS: [u32; 12] = [0, 1, 2, 0, 2, 3, 4, 5, 6, 4, 6, 7];

#[test]
fn light_that_leaves_a_film_through_a_hole_is_truncated_and_not_transmitted() {
    let of = |x: f64| {
        let vertices: Vec<f64> = sheet(PERIOD_NM[0], 0.0).into_iter().chain(sheet(x, -500.0)).collect();
        trace(&vertices, &TWO_SHEETS, &[0, 0, 1, 1])
    };
    let (whole, torn) = (of(PERIOD_NM[0]), of(0.75 * PERIOD_NM[0]));
    assert!(whole.truncated == 0.0 && whole.transmitted > 0.9, "{}", whole.transmitted);
    // A quarter of the light that enters the film finds the hole.
    let lost = 0.25 * whole.transmitted;
    assert!((torn.truncated - lost).abs() < 0.01, "{} for {lost}", torn.truncated);
    assert!((torn.transmitted - 3.0 * lost).abs() < 0.01, "{}", torn.transmitted);
}

#[test]
fn vertices_beside_the_border_count_as_on_it() {
    // A roof over the period, its ridge along y.
    let [x, y] = PERIOD_NM;
    let roof = [0.0, 0.0, 0.0, 0.0, y, 0.0, 0.5 * x, 0.0, 3000.0, 0.5 * x, y, 3000.0, x, 0.0, 0.0, x, y, 0.0];
    let triangles = [0, 2, 3, 0, 3, 1, 2, 4, 5, 2, 5, 3];
    let tidy = trace(&roof, &triangles, &[0; 4]);
    // Coordinates as a modelling program writes them.
    let beside =
        roof.map(|coordinate| if coordinate == x || coordinate == y { coordinate - 0.001 } else { coordinate });
    let found = trace(&beside, &triangles, &[0; 4]);
    assert_eq!(
        [found.reflected, found.transmitted, found.truncated],
        [tidy.reflected, tidy.transmitted, tidy.truncated]
    );
}
