//! Functions for planar films: closed form, both sums of rays, colour.

use goniochrome::colour::{Illuminant, Quadrature, RgbSpace, xyz, xyz_weights};
use goniochrome::optics::interface::{Below, Model};
use goniochrome::optics::medium::{MediaLanes, Medium};
use goniochrome::optics::stack::{Film, PreparedStack, PreparedStackArrays, Stack, StackArrays};
use goniochrome::simd::complex::ComplexLanes;
use goniochrome::simd::lanes::{F32, Lanes};
use goniochrome::trace::planar::{Summation, Workspace, trace_planar};
use goniochrome::trace::waves::Limits;

/// The luminance of a film of index `n` in air, summed over the closed form and both sums of rays; NaN if an input is
/// refused.
#[unsafe(no_mangle)]
pub extern "C" fn film_luminance(n: f64, thickness_nm: f64, sin_theta: f64) -> f64 {
    luminance(n, thickness_nm, sin_theta).unwrap_or(f64::NAN)
}

fn luminance(n: f64, thickness_nm: f64, sin_theta: f64) -> Option<f64> {
    let media = [Medium::constant(1.0.into()).ok()?, Medium::constant(n.into()).ok()?];
    let wavelengths: [f64; F32::WIDTH] = core::array::from_fn(|i| 400.0 + 15.0 * i as f64);
    let mut eta = [ComplexLanes::zero(); 2];
    let lanes = MediaLanes::<F32>::evaluate(&media, &wavelengths, &mut eta).ok()?;
    let mut arrays = StackArrays::<2>::new();
    let stack = Stack::new(0, [Film { medium: 1, thickness_nm }], Below::Medium(0), arrays.memory()).ok()?;
    let mut memory = PreparedStackArrays::<F32, 2>::new();
    let prepared = PreparedStack::prepare(stack, &lanes, sin_theta, Model::Physical, memory.memory()).ok()?;
    let mut workspace = Workspace::<F32>::new();
    let mut sum = prepared.reflectance(prepared.reflection()).s;
    for summation in [Summation::ClosedLoops, Summation::Generations(Limits::SINGLE)] {
        sum += trace_planar(&prepared, summation, workspace.memory()).ok()?.ledger.reflected.p;
    }
    let mut weights = [[0.0; 3]; F32::WIDTH];
    xyz_weights(&wavelengths, Illuminant::D65, Quadrature::Interpolated, &mut weights).ok()?;
    Some(RgbSpace::Srgb.from_xyz(xyz(&weights, (0..F32::WIDTH).map(|i| sum.lane(i)))).into_iter().sum())
}
