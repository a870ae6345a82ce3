//! Fuzzing of the tracers with cells of one to three bumpy sheets: each is closed, and the ledger of its paths adds up
//! to 1. Where a cell is flat, merged rays agree with the closed form.

use arbitrary::{Arbitrary, Result, Unstructured};
use glam::DVec3;
use goniochrome::geometry::side::Side;
use goniochrome::measure::bins::{DirectionBins, ExitBuffer, ExitRecord, Histogram};
use goniochrome::optics::interface::Model;
use goniochrome::simd::lanes::{F64, Lanes};
use goniochrome::trace::coherent_mesh::{CoherentMesh, IncidentWave, free_slot};
use goniochrome::trace::incoherent_mesh::{self, IncoherentMesh};
use goniochrome::trace::paths::{IncoherentFallback, trace_with_fallback};
use goniochrome::trace::random::Random;
use goniochrome::trace::waves::Limits;
use goniochrome_cli::scene::Scene;
use goniochrome_cli::solve::planar_scene::PlanarScene;
use goniochrome_cli::solve::precision::Precision;
use goniochrome_cli::solve::spectra::{Method, SpectraRequest, spectra};
use num_complex::Complex64;

use super::height_field::{HeightField, Start, follow, with_cell};
use super::scalar::Problem;

/// Bound of rounding in the ledger. It also holds in absorbing media, since a path followed alone passes on all its
/// power. It is larger than in the laws of `tests/cells`, since these cells are stranger.
const ROUNDING: f64 = 1e-9;
/// Bound of dropped waves. Those below 1e-13 of the light are dropped: 2√1e-13 in reflectance for each of some that
/// ring.
const DROPPED: f64 = 2e-5;

#[derive(Debug)]
struct Cell {
    field: HeightField,
    wavelength_nm: f64,
    states: usize,
    start: Start,
}

/// A number in the range: a round one, which makes degenerate cells, or any.
fn number(u: &mut Unstructured<'_>, low: f64, high: f64) -> Result<f64> {
    let code: u8 = u.arbitrary()?;
    let steps = f64::from(code >> 1) / 100.0;
    let fraction = if code & 1 == 0 { steps } else { f64::from(u.arbitrary::<u32>()?) / f64::from(u32::MAX) };
    Ok(low + (high - low) * fraction.min(1.0))
}

impl<'a> Arbitrary<'a> for Cell {
    fn arbitrary(u: &mut Unstructured<'a>) -> Result<Self> {
        let period_nm = [number(u, 100.0, 1e4)?, number(u, 100.0, 1e4)?];
        let squares = [u.int_in_range(1..=3)?, u.int_in_range(1..=3)?];
        let height = if u.ratio(1, 4)? { 0.0 } else { number(u, 0.0, 5e3)? };
        let heights_nm = (0..squares[0] * squares[1]).map(|_| number(u, 0.0, height)).collect::<Result<_>>()?;
        let depths_nm: Vec<f64> = (0..u.int_in_range(0..=2)?).map(|_| number(u, 1.0, 5e3)).collect::<Result<_>>()?;
        let mut media = vec![[number(u, 1.0, 3.0)?, 0.0]];
        for _ in 0..depths_nm.len() + usize::from(u.ratio(3, 4)?) {
            let k = if u.ratio(1, 3)? { number(u, 0.0, 8.0)? } else { 0.0 };
            media.push([number(u, 0.05, 5.0)?, k]);
        }
        let (sin, phi) = (number(u, 0.0, 1.0)?.min(0.9999), number(u, 0.0, std::f64::consts::TAU)?);
        let wi = DVec3::new(sin * phi.cos(), sin * phi.sin(), (1.0 - sin * sin).sqrt());
        let start = Start { wi, u: number(u, 0.0, 0.9999)?, v: number(u, 0.0, 0.9999)?, seed: u.arbitrary()? };
        let states = u.int_in_range(1..=64)?;
        let field = HeightField { period_nm, squares, heights_nm, depths_nm, media };
        Ok(Self { field, wavelength_nm: number(u, 100.0, 3000.0)?, states, start })
    }
}

/// Checks any bytes from which a cell can be made.
pub fn check(bytes: &[u8]) {
    let Ok(cell) = Cell::arbitrary_take_rest(Unstructured::new(bytes)) else { return };
    let scene = cell.field.scene();
    ledger_closes(&cell, &scene);
    if cell.field.heights_nm.iter().all(|z| *z == cell.field.heights_nm[0]) {
        flat_is_closed_form(&cell, &scene);
    }
}

fn ledger_closes(cell: &Cell, scene: &Scene) {
    let bound = ROUNDING;
    for outcome in follow(scene, cell.wavelength_nm, cell.states, &[cell.start]) {
        let (total, reflected) = (outcome.total(), outcome.reflected());
        assert!((total - 1.0).abs() <= bound, "total {total}: {outcome:?}");
        for part in [reflected, outcome.transmitted, outcome.absorbed, outcome.truncated] {
            assert!((-bound..=1.0 + bound).contains(&part), "{outcome:?}");
        }
        assert!(outcome.up.iter().all(|(direction, power)| direction.z > 0.0 && *power >= 0.0), "{outcome:?}");
    }
}

fn flat_is_closed_form(cell: &Cell, scene: &Scene) {
    // Absorbing and evanescent waves may gain in a loop, and then their sum hit by hit diverges.
    let q_t = cell.field.media[0][0] * cell.start.wi.z.acos().sin();
    if cell.field.media.iter().any(|[n, k]| *k > 0.0 || *n <= 1.05 * q_t) {
        return;
    }
    let Start { wi, .. } = cell.start;
    let Some([reflected, truncated]) = merged(cell, scene) else { return };
    let planar = PlanarScene::new(scene).expect("horizontal planes");
    let request =
        SpectraRequest { model: Model::Physical, method: Method::Stack, precision: Precision::F64, threads: 1 };
    let theta_deg = wi.z.acos().to_degrees();
    let closed =
        spectra(&planar, &[theta_deg], &[cell.wavelength_nm], &request, &|| ()).expect("a good stack").samples[0];
    let error = (reflected - closed.mean_reflectance()).abs();
    let bound = DROPPED + truncation_bound(cell, truncated);
    assert!(error <= bound, "off by {error:e}, not {bound:e}; {truncated:e} truncated");
}

/// Bound of the change of a flat cell's reflectance by rays of the power `truncated`, the mean of both polarisations.
fn truncation_bound(cell: &Cell, truncated: f64) -> f64 {
    let eta: Vec<_> = cell.field.media.iter().map(|&[n, k]| Complex64::new(n, k)).collect();
    let sin_theta = cell.start.wi.x.hypot(cell.start.wi.y);
    let (thickness_nm, wavelength_nm) = (&cell.field.depths_nm, cell.wavelength_nm);
    let twins = Problem { eta: &eta, thickness_nm, sin_theta, wavelength_nm }.solve();
    twins.iter().map(|twin| 0.5 * twin.truncation(2.0 * truncated, 1.0)[0]).sum()
}

/// The power that one starting ray reflects, with waves merged, and the power truncated. Nothing if the waves' sum
/// diverges or nearly all power is truncated.
fn merged(cell: &Cell, scene: &Scene) -> Option<[f64; 2]> {
    /// Limits of waves: those that ring for more generations are truncated.
    const WAVES: Limits = Limits { in_flight: 1e-13, generations: 1000 };
    const PATHS: Limits = Limits { in_flight: 0.1, generations: 1000 };
    /// Number of paths that the incoherent fall-back holds.
    const FALLBACK_PATHS: usize = 10;
    let Start { wi, u, v, seed } = cell.start;
    with_cell(scene, cell.wavelength_nm, |mesh, media| {
        let eta = media.eta()[usize::from(mesh.above())];
        let incident = IncidentWave::new(wi, eta);
        let (mut coherent, mut incoherent) =
            (CoherentMesh::new(mesh, media, incident), IncoherentMesh::new(mesh, media, incident));
        let (state, field) = coherent.start(u, v).expect("no hole");
        // As many as the command line has: one for each side of each sheet, and two pairs.
        let mut waves = vec![free_slot(); 2 * cell.field.sheets() + 4];
        let mut paths = vec![incoherent_mesh::free_slot(); FALLBACK_PATHS];
        let mut memory = [ExitRecord::<F64>::none(); 128];
        let mut exits = ExitBuffer::new(&mut memory, DirectionBins { cos: 1, phi: 1 }, &media);
        exits.begin();
        let mut random = Random::new(seed, 0);
        let fallback = IncoherentFallback::new(&mut incoherent, &mut paths, PATHS, &mut random);
        let done = trace_with_fallback(&mut coherent, state, field, &mut waves, WAVES, fallback, &mut exits);
        let mut reflected = Reflected(0.0);
        let truncated = (done.truncated + exits.flush(&mut reflected) + coherent.lost() + incoherent.lost()).lane(0);
        (truncated <= 1.0).then_some([reflected.0, truncated])
    })
}

/// The power that leaves through the top at the first wavelength.
struct Reflected(f64);

impl Histogram for Reflected {
    fn add(&mut self, lane: usize, side: Side, _: usize, power: f64) {
        if lane == 0 && side == Side::Above {
            self.0 += power;
        }
    }
}
