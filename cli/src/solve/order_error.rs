//! The error bound of diffraction orders computed by rays, which is physical optics. Waves have an error bar instead.
//!
//! [`crate::solve::diffraction::orders`] lets every point of a facet reflect as an infinite plane would, once. A real
//! surface differs at the bends between facets, whose influence reaches about a wavelength, and by light that hits a
//! second facet, which is dropped here. For an efficiency, in s or p,
//!
//! |error| ≤ min(1, 0.005 + R (0.3 B (λ + D) + 2 M)).
//!
//! - R is the power that the lit facets reflect by Fresnel's formulas, each alone, in the polarisation that reflects
//!   more. It is 1 for facets that are coated or do not face the medium of the light.
//! - B is the bend per area, in 1/nm: the sum over all edges of length × turn, divided by the area of the period. The
//!   turn is the angle between the two facets over cos² θ_i, at most π/2. Refining a mesh does not change B.
//! - D is the depth from the highest to the lowest vertex: light that goes down and up between two walls is guided by
//!   them.
//! - M is the share of the light that hits a second facet after a mirror reflection or would be reflected below the
//!   horizon, weighted by ½ (1 + 1/cos θ) of the local angle: by this factor an oblique facet may count more in another
//!   order.
//!
//! For surfaces with overhangs the bound is 1. Coated and layered cells were not compared with rigorous solvers.
//!
//! The form follows from the criterion of physical optics (a radius of curvature must be many wavelengths); the factors
//! are fitted. The table lists the largest errors of 462 random gratings, in s and in p: lamellar, with walls of 75°,
//! blazed, triangular and sinusoidal; depths 0.02 to 1 λ; θ_i of 0, 30, 45, 60, 75°, three in four in a classical mount
//! or along the grooves, the others at any azimuth:
//!
//! | below | θ_i | period 0.8 to 2 λ | 2 to 5 λ | 5 to 10 λ | 10 to 20 λ |
//! |---|---|---|---|---|---|
//! | n = 1.2, 1.5 | ≤ 45° | 0.013, 0.012 | 0.015, 0.005 | 0.006, 0.007 | 0.001, 0.001 |
//! | | 60°, 75° | 0.233, 0.043 | 0.293, 0.103 | 0.013, 0.004 | 0.021, 0.005 |
//! | n = 2.4, silicon | ≤ 45° | 0.185, 0.099 | 0.082, 0.054 | 0.022, 0.011 | 0.012, 0.016 |
//! | | 60°, 75° | 0.311, 0.137 | 0.251, 0.072 | 0.081, 0.023 | 0.028, 0.005 |
//! | silver, aluminium, gold | ≤ 45° | 0.506, 0.539 | 0.211, 0.528 | 0.342, 0.070 | 0.079, 0.053 |
//! | | 60°, 75° | 0.522, 0.572 | 0.520, 0.408 | 0.278, 0.318 | 0.119, 0.205 |
//!
//! No error exceeds 0.85 of its bound; nor do the errors of 60 lamellar gratings of 1 to 8 λ depth. 40 of the gratings
//! were computed after the fit: the largest reaches 0.30 of its bound. `tests/data/orders.json` holds 34 and 12 of both
//! kinds.

use std::collections::HashMap;
use std::f64::consts::{FRAC_PI_2, PI};

use glam::DVec3;
use goniochrome::geometry::mesh_cell::{MeshCell, NextEvent};
use goniochrome::optics::interface::{Below, Interface};
use goniochrome::trace::sobol::sobol;
use num_complex::Complex64;

use crate::scene::Shape;
use crate::solve::mesh_scene::MeshScene;
use crate::support::error::Result;

/// The smallest bound: the last digits of the computed efficiencies and of the references.
const MIN_BOUND: f64 = 0.005;
/// The error per R B (λ + D). The largest ratio of 553 gratings is 0.21.
const PER_BEND: f64 = 0.3;
/// The error per M. An amplitude that is off by M puts an efficiency off by 2M.
const PER_LOST: f64 = 2.0;
/// The largest bound of which [`warning`] does not warn.
pub const MAX_SILENT: f64 = 0.01;

/// The quantities of a surface that decide the error bound for one direction of the light.
#[derive(Clone, Debug)]
struct Relief {
    /// B: the bend per area.
    bend_per_nm: f64,
    /// D: the depth.
    depth_nm: f64,
    /// M: the share of the light that is lost to second facets and the horizon.
    lost: f64,
    /// Whether no facet is tilted: then nothing bends or shadows.
    flat: bool,
    /// Whether some facet faces down.
    overhangs: bool,
    /// The triangles that the light falls on.
    lit: Vec<Lit>,
}

/// A triangle that the light falls on.
#[derive(Clone, Copy, Debug)]
struct Lit {
    cos_theta: f64,
    /// The triangle's share of the light, as if no other triangle shadowed it.
    share: f64,
    /// What lies beyond the triangle; none where its reflectance is not that of one plane.
    below: Option<Below>,
}

/// Bounds on |computed − true| of every efficiency of reflected orders, in s and in p, for light from `wi`: one for
/// each wavelength.
///
/// # Errors
/// A mesh that the core refuses.
pub fn error_bounds(mesh_scene: &MeshScene<'_>, wi: DVec3, wavelength_nm: &[f64]) -> Result<Vec<f64>> {
    let relief = Relief::new(mesh_scene, wi)?;
    let bound = |&nm: &f64| (relief.error_bound(mesh_scene, nm) + absorbing_ambient_error(mesh_scene, wi, nm)).min(1.0);
    Ok(wavelength_nm.iter().map(bound).collect())
}

/// The error that an absorbing ambient medium adds near grazing incidence: ((k/n)/cos²θ)². There the q_n of the
/// incident wave is complex, which physical optics leaves out. The errors of a flat metal under n = 1.5 with k of 1e-6
/// to 1e-3 at 88° to 89.9° are at most half of this.
fn absorbing_ambient_error(mesh_scene: &MeshScene<'_>, wi: DVec3, wavelength_nm: f64) -> f64 {
    let eta =
        mesh_scene.media()[usize::from(mesh_scene.above())].eta(wavelength_nm).unwrap_or(Complex64::new(1.0, 0.0));
    (eta.im / eta.re / (wi.z * wi.z)).powi(2)
}

/// A warning for orders of light from `wi`; none where every efficiency is within [`MAX_SILENT`].
///
/// # Errors
/// A mesh that the core refuses.
pub fn warning(mesh_scene: &MeshScene<'_>, wi: DVec3, wavelength_nm: &[f64]) -> Result<Option<String>> {
    /// The angle from the normal, in radians, below which light has no plane of incidence to speak of.
    const MAX_NORMAL: f64 = 1e-3;
    let bounds = error_bounds(mesh_scene, wi, wavelength_nm)?;
    let worst = bounds.iter().zip(wavelength_nm).max_by(|a, b| a.0.total_cmp(b.0));
    let Some((&bound, nm)) = worst.filter(|(bound, _)| **bound > MAX_SILENT) else { return Ok(None) };
    let how_far = match bound {
        1.0 => "by any amount".to_owned(),
        // Rounded up.
        bound => format!("by up to {:.2}", (100.0 * bound).ceil() / 100.0),
    };
    let equal = if wi.x.hypot(wi.y) < MAX_NORMAL {
        "; at normal incidence level facets have R_s = R_p by construction"
    } else {
        ""
    };
    let because = if absorbing_ambient_error(mesh_scene, wi, *nm) > 0.5 * bound {
        "light near grazing incidence comes through a medium that absorbs"
    } else {
        "bends and shadows of the surface are too near to each other for physical optics"
    };
    Ok(Some(format!(
        "directions are exact, but efficiencies in s and p may be off {how_far} at {nm} nm: {because}{equal}"
    )))
}

impl Relief {
    fn new(mesh_scene: &MeshScene<'_>, wi: DVec3) -> Result<Self> {
        let area_nm2 = mesh_scene.period_nm()[0] * mesh_scene.period_nm()[1];
        let mut buffer = mesh_scene.buffer();
        let lost = lost(&mesh_scene.cell(&mut buffer)?, wi);
        let heights = || mesh_scene.triangles().flat_map(|(corners, ..)| corners.map(|corner| corner.z));
        let depth_nm = heights().fold(f64::NEG_INFINITY, f64::max) - heights().fold(f64::INFINITY, f64::min);
        let bend_per_nm = bend(mesh_scene, wi.z) / area_nm2;
        let flat = matches!(mesh_scene.scene().shape, Shape::Planes(_));
        let mut relief = Self { bend_per_nm, depth_nm, lost, flat, overhangs: false, lit: Vec::new() };
        for ([a, b, c], Interface { above, below }, coated) in mesh_scene.triangles() {
            let twice_area = (b - a).cross(c - a);
            let plane = (above == mesh_scene.above(), below == Below::Medium(mesh_scene.above()));
            // The side from which the light comes, and what is beyond.
            let (outward, beyond) = match plane {
                (true, _) => (twice_area, Some(below)),
                (false, true) => (-twice_area, Some(Below::Medium(above))),
                // An inner interface: such a facet is seen through another.
                (false, false) => (if twice_area.z < 0.0 { -twice_area } else { twice_area }, None),
            };
            relief.overhangs |= beyond.is_some() && outward.z < -MIN_OVERHANG * outward.length();
            let cos_theta = outward.normalize().dot(wi);
            if cos_theta > 0.0 {
                let share = 0.5 * outward.dot(wi) / (area_nm2 * wi.z);
                relief.lit.push(Lit { cos_theta, share, below: beyond.filter(|_| !coated) });
            }
        }
        Ok(relief)
    }

    fn error_bound(&self, mesh_scene: &MeshScene<'_>, wavelength_nm: f64) -> f64 {
        if self.flat {
            return MIN_BOUND;
        }
        if self.overhangs {
            return 1.0;
        }
        let per_reflected = PER_BEND * (wavelength_nm + self.depth_nm) * self.bend_per_nm + PER_LOST * self.lost;
        if per_reflected == 0.0 {
            return MIN_BOUND;
        }
        (MIN_BOUND + self.reflected(mesh_scene, wavelength_nm) * per_reflected).min(1.0)
    }

    /// R: the power that the lit facets reflect.
    fn reflected(&self, mesh_scene: &MeshScene<'_>, wavelength_nm: f64) -> f64 {
        // A medium without data has been refused when the orders were computed.
        let eta: Vec<Option<Complex64>> =
            mesh_scene.media().iter().map(|medium| medium.eta(wavelength_nm).ok()).collect();
        let near = eta[usize::from(mesh_scene.above())];
        let part = |lit: &Lit| match (near, lit.below) {
            (Some(near), Some(Below::Medium(far))) => {
                eta[usize::from(far)].map_or(1.0, |far| fresnel(near, far, lit.cos_theta))
            }
            _ => 1.0,
        };
        self.lit.iter().map(|lit| lit.share * part(lit)).sum::<f64>().min(1.0)
    }
}

/// The rounding of single-precision files: a facet that leans over by less is not an overhang.
const MIN_OVERHANG: f64 = 1e-6;

/// The larger of R_s and R_p by Fresnel's formulas.
fn fresnel(near: Complex64, far: Complex64, cos_theta: f64) -> f64 {
    let tangential = near * near * (1.0 - cos_theta * cos_theta).max(0.0);
    let (q1, q2) = (near * cos_theta, (far * far - tangential).sqrt());
    let s = (q1 - q2) / (q1 + q2);
    let (p1, p2) = (far * far * q1, near * near * q2);
    let p = (p1 - p2) / (p1 + p2);
    s.norm_sqr().max(p.norm_sqr())
}

/// The bend over the whole period: B times its area.
fn bend(mesh_scene: &MeshScene<'_>, cos_theta: f64) -> f64 {
    /// The fraction of the period below which two vertices are one: files round to 6 or 7 digits.
    const SAME: f64 = 1e-5;
    /// The start of the raster at which regular meshes have no vertex between two of its cells.
    const OFFSET: f64 = 0.381_966;
    let period = mesh_scene.period_nm();
    let raster = SAME * period[0].max(period[1]);
    // A point modulo the period, and the period that it lies in.
    let corner = |place: DVec3| {
        let cells = period.map(|period| (period / raster).round() as i64);
        let [x, y, z] = place.to_array().map(|x| (x / raster + OFFSET).floor() as i64);
        ([x.rem_euclid(cells[0]), y.rem_euclid(cells[1]), z], [x.div_euclid(cells[0]), y.div_euclid(cells[1])])
    };
    // The length of each edge, and the directions in which its facets extend from it.
    let mut edges: HashMap<_, (f64, Vec<DVec3>)> = HashMap::new();
    for (corners, ..) in mesh_scene.triangles() {
        for i in 0..3 {
            let [from, to, third] = [0, 1, 2].map(|step| corners[(i + step) % 3]);
            let along = to - from;
            let ((a, tile_a), (b, tile_b)) = (corner(from), corner(to));
            let step = [tile_b[0] - tile_a[0], tile_b[1] - tile_a[1]];
            // The same key in both directions along the edge.
            let key = (a, b, step).min((b, a, step.map(|tiles| -tiles)));
            let edge = edges.entry(key).or_insert((along.length(), Vec::new()));
            edge.1.push((third - from).reject_from(along).normalize_or_zero());
        }
    }
    let turn = |facets: &[DVec3]| {
        let pairs =
            facets.iter().enumerate().flat_map(|(i, a)| facets[..i].iter().map(move |b| PI - a.angle_between(*b)));
        // An edge with one facet, in a mesh whose facets meet between vertices.
        pairs.reduce(f64::max).unwrap_or(FRAC_PI_2)
    };
    let weight = |turn: f64| if turn < MIN_TURN { 0.0 } else { (turn / (cos_theta * cos_theta)).min(FRAC_PI_2) };
    edges.values().map(|(length, facets)| length * weight(turn(facets))).sum()
}

/// The smallest angle between two facets, in radians, that counts as a bend: the rounding of single-precision files.
const MIN_TURN: f64 = 1e-5;

/// M: the weighted share of the light that hits a second facet or is reflected below the horizon.
fn lost(cell: &MeshCell<'_>, wi: DVec3) -> f64 {
    const RAYS: u32 = 2048;
    let weight = |ray: u32| {
        let [u, v] = sobol(ray, 0);
        let Some((hit, sides)) = cell.first_hit(u, v, -wi).and_then(|at| Some((at, cell.sides(&at)?))) else {
            return 1.0;
        };
        let cos_theta = sides.normal.dot(wi);
        let mirrored = 2.0 * cos_theta * sides.normal - wi;
        let leaves = mirrored.z > 0.0
            && matches!(cell.next_event(hit.point_nm, mirrored, sides.near, Some(hit.facet)), NextEvent::Above);
        if leaves { 0.0 } else { 0.5 * (1.0 + 1.0 / cos_theta.max(f64::EPSILON)) }
    };
    (0..RAYS).map(weight).sum::<f64>() / f64::from(RAYS)
}
