//! A made-up table of diffraction orders in the folder of the first argument, as a texture with its shader functions:
//! lines along y or x, or a surface with two periods, as the second argument says (x, y, both). Then reads lines of
//! "a,b", which stand for directions towards a viewer, and prints the light that arrives there by the library's own
//! look-up: the truth for the shader functions. The fourth number bounds what rounding to half floats may change.

use std::error::Error;
use std::f32::consts::FRAC_1_SQRT_2;
use std::fs;
use std::io::stdin;
use std::path::Path;

use glam::Vec3;
use goniochrome::simd::complex::Polarised;
use goniochrome::table::{OrderLayout, Periodicity};
use goniochrome_cli::export::ShaderLanguage;
use goniochrome_cli::export::order_lut::{OrderLut, WAVELENGTHS};
use goniochrome_cli::table::metadata::Metadata;
use goniochrome_cli::table::orders::OrderTable;

/// A table with strengths that vary with everything, and a medium above that disperses.
fn table(periodicity: Periodicity) -> Result<OrderTable, Box<dyn Error>> {
    let layout = OrderLayout::new([13, 7], periodicity, [1600.0, 900.0])?;
    let orders: Vec<[i32; 2]> = match periodicity {
        Periodicity::X => (-3..=3).map(|m| [m, 0]).collect(),
        Periodicity::Y => (-1..=2).map(|n| [0, n]).collect(),
        Periodicity::Both => (-1..=1).flat_map(|m| (-1..=1).map(move |n| [m, n])).collect(),
    };
    let wavelength_nm: Vec<f64> = (0..10).map(|i| 380.0 + 40.0 * f64::from(i)).collect();
    let count = wavelength_nm.len() * layout.count() * orders.len();
    let strengths = |shift: usize| (0..count).map(|i| ((i * 7919 + shift) % 101) as f32 / 200.0).collect::<Vec<f32>>();
    Ok(OrderTable {
        layout,
        index_above: wavelength_nm.iter().map(|nm| 1.0 + 10.0 / nm).collect(),
        index_below: vec![0.0; wavelength_nm.len()],
        reflected: Polarised { s: strengths(0), p: strengths(17) },
        transmitted: Polarised { s: vec![0.0; count], p: vec![0.0; count] },
        error: vec![0.0; wavelength_nm.len() * layout.count()],
        orders,
        wavelength_nm,
        metadata: Metadata::default(),
    })
}

/// The environment of main.glsl, main.hlsl and main.wgsl for orders.
fn environment(d: Vec3, width: f32) -> Vec3 {
    Vec3::new(1.0 + d.x, 1.0 + d.y * d.z, 1.0 + 0.5 * d.z * d.z) / (1.0 + width)
}

/// The direction that a point of the list stands for, in the frame of the surface.
fn viewer(a: f32, b: f32) -> Vec3 {
    let (x, y) = (2.0 * a - 1.0, 2.0 * b - 1.0);
    let up_squared = 1.0 - x * x - y * y;
    if up_squared > 0.0 { Vec3::new(x, y, up_squared.sqrt()) } else { Vec3::new(x, y, -1.0).normalize() }
}

fn main() -> Result<(), Box<dyn Error>> {
    let arguments: Vec<String> = std::env::args().skip(1).collect();
    let [folder, periodicity] = arguments.as_slice() else {
        return Err("usage: order_samples FOLDER x|y|both".into());
    };
    let periodicity = match periodicity.as_str() {
        "x" => Periodicity::X,
        "y" => Periodicity::Y,
        _ => Periodicity::Both,
    };
    let lut = OrderLut::new(&table(periodicity)?, WAVELENGTHS)?;
    let folder = Path::new(folder);
    fs::write(folder.join("orders.exr"), lut.exr()?)?;
    for (language, name) in
        [(ShaderLanguage::Glsl, "glsl"), (ShaderLanguage::Hlsl, "hlsl"), (ShaderLanguage::Wgsl, "wgsl")]
    {
        fs::write(folder.join(format!("orders.{name}")), lut.shader(language))?;
    }
    let arrays = lut.arrays();
    let orders = arrays.table()?;
    // The frame of the shaders: turned by 45° around the binormal.
    let frame = [Vec3::new(FRAC_1_SQRT_2, 0.0, FRAC_1_SQRT_2), Vec3::Y, Vec3::new(-FRAC_1_SQRT_2, 0.0, FRAC_1_SQRT_2)];
    let world = |w: Vec3| w.x * frame[0] + w.y * frame[1] + w.z * frame[2];
    let in_medium = |w: usize| orders.wavelength_nm(w) / (1.0 + 10.0 / orders.wavelength_nm(w));
    let last = orders.wavelength_count() - 1;
    let step_nm = (in_medium(last) - in_medium(0)) / last as f32;
    let [period_x, period_y] = orders.layout().period_nm();
    for line in stdin().lines() {
        let line = line?;
        let (a, b) = line.split_once(',').ok_or("expected A,B")?;
        let (mut sum, mut size) = (Vec3::ZERO, Vec3::ZERO);
        if let Some(view) = orders.view(viewer(a.trim().parse()?, b.trim().parse()?)) {
            for order in 0..orders.order_count() {
                let [m, n] = orders.order(order).map(|m| m as f32);
                let grating = (m / period_x).hypot(n / period_y);
                for wavelength in 0..=last {
                    let Some(light) = view.light(wavelength, order) else { continue };
                    let radiance = environment(world(light.direction), step_nm * grating / light.direction.z);
                    let added = light.efficiency * Vec3::from(orders.rgb_weight(wavelength)) * radiance;
                    sum += added;
                    size += added.abs();
                }
            }
        }
        println!("{},{},{},{}", sum.x, sum.y, sum.z, size.max_element());
    }
    Ok(())
}
