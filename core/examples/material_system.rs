//! Table blob behind the material trait of a game engine: it is loaded once, and a frame allocates nothing.
//!
//! `cargo run --release -p goniochrome --example material_system [TABLE.gonio]` shades a frame's worth of points and
//! prints their mean colour; `goniochrome export --to blob` makes a table.

use std::error::Error;

use glam::{Vec2, Vec3};
use goniochrome::colour::RgbSpace;
use goniochrome::table::blob::{Blob, Contents, Precision};
use goniochrome::table::{MirrorTable, ScatterSampler, ScatterTable};
use goniochrome::trace::sobol::sobol;

/// Direction that the engine samples from a material. The engine finds the radiance from there itself.
struct Bounce {
    /// Direction in which the path continues.
    direction: Vec3,
    /// Weight of the path: BRDF times cosine divided by density.
    throughput: Vec3,
}

/// Interface of the engine's materials. Directions are in the surface's frame, whose z is the normal.
trait Material {
    /// BRDF times cosine, for lights of known direction.
    fn evaluate(&self, eye: Vec3, light: Vec3) -> Vec3;
    /// Samples a direction for a path, by two random numbers.
    fn bounce(&self, eye: Vec3, random: Vec2) -> Option<Bounce>;
}

/// Structural colour that borrows the asset's bytes, wherever the engine has mapped them.
struct StructuralColour<'asset> {
    table: Contents<'asset>,
}

impl<'asset> StructuralColour<'asset> {
    fn load(asset: &'asset [u8]) -> Result<Self, Box<dyn Error>> {
        Ok(Self { table: Blob::read(asset)?.contents })
    }
}

impl Material for StructuralColour<'_> {
    fn evaluate(&self, eye: Vec3, light: Vec3) -> Vec3 {
        match &self.table {
            // Mirrors, gratings and flat facets reflect no light of a point lamp. `bounce` serves reflection probes.
            Contents::Mirror(_) | Contents::Orders(_) => Vec3::ZERO,
            Contents::Film(table) => Vec3::from(table.eval(eye, light, table.range_nm()[0])) * light.z.max(0.0),
            Contents::Scatter(table, _) => Vec3::from(table.rgb(eye, light)) * light.z.max(0.0),
        }
    }

    fn bounce(&self, eye: Vec3, random: Vec2) -> Option<Bounce> {
        match &self.table {
            Contents::Mirror(table) => (eye.z > 0.0).then(|| Bounce {
                direction: Vec3::new(-eye.x, -eye.y, eye.z),
                throughput: Vec3::from(table.rgb(eye.z.min(1.0).acos())),
            }),
            Contents::Film(table) => {
                let drawn = table.sample(eye, random.to_array(), table.range_nm()[0])?;
                Some(Bounce { direction: drawn.wo, throughput: Vec3::from(drawn.weight) })
            }
            Contents::Scatter(table, sampler) => scattered(table, sampler, eye, random),
            Contents::Orders(table) => {
                // One of the wavelengths, then one of its orders.
                let count = table.wavelength_count();
                let wavelength = ((random.x * count as f32) as usize).min(count - 1);
                let drawn = table.view(eye)?.sample(wavelength, random.y)?;
                let value = Vec3::from(table.rgb_weight(wavelength)) * drawn.efficiency;
                Some(Bounce { direction: drawn.direction, throughput: value * count as f32 / drawn.probability })
            }
        }
    }
}

/// Bounce off a surface of facets: into the exact direction of a flat one, or into one drawn by the table's density,
/// each in proportion to what it reflects.
fn scattered(table: &ScatterTable<'_>, sampler: &ScatterSampler<'_>, eye: Vec3, random: Vec2) -> Option<Bounce> {
    let lobe = |lobe| {
        let mut rgb = [0.0; 3];
        let direction = table.reflected(eye, lobe, &mut rgb)?;
        Some((direction, Vec3::from(rgb), Vec3::from(rgb).abs().element_sum() / 3.0))
    };
    let lobes = || (0..table.layout().lobes()).filter_map(lobe);
    let boxes = sampler.reflected(eye);
    let whole = boxes + lobes().map(|(_, _, power)| power).sum::<f32>();
    let mut place = random.x * whole;
    for (direction, rgb, power) in lobes() {
        if place < power {
            return Some(Bounce { direction, throughput: rgb * whole / power });
        }
        place -= power;
    }
    let (direction, density) = sampler.sample(eye, [place / boxes, random.y])?;
    let value = Vec3::from(table.rgb(eye, direction)) * direction.z;
    Some(Bounce { direction, throughput: value / density * whole / boxes })
}

/// Asset that is used if none is named: a film whose red fades with the angle.
fn built_in() -> Result<Vec<u8>, Box<dyn Error>> {
    let ramp: Vec<f32> = (0..32).flat_map(|i| [1.0 - i as f32 / 32.0, 0.4, 0.2 + i as f32 / 64.0]).collect();
    let table = MirrorTable::new(&ramp, 3, core::f64::consts::FRAC_PI_2)?;
    let blob = Blob { space: Some(RgbSpace::Srgb), contents: Contents::Mirror(table) };
    let mut bytes = vec![0; blob.required_len(Precision::Half).ok_or("the table is too large")?];
    blob.write(Precision::Half, &mut bytes)?;
    Ok(bytes)
}

/// Mean colour of a frame: points of a hemisphere under a white sky and one lamp.
fn frame(material: &dyn Material, points: u32) -> Vec3 {
    let lamp = Vec3::new(0.6, 0.0, 0.8);
    let mut sum = Vec3::ZERO;
    for point in 0..points {
        let [x, y] = sobol(point, 1).map(|u| u as f32);
        let (cos, phi) = (1.0 - 0.95 * x, core::f32::consts::TAU * y);
        let sin = (1.0 - cos * cos).sqrt();
        let eye = Vec3::new(sin * phi.cos(), sin * phi.sin(), cos);
        let sky = |direction: Vec3| Vec3::splat(0.5 + 0.5 * direction.z);
        let bounce = material.bounce(eye, Vec2::new(y, x));
        sum += material.evaluate(eye, lamp) + bounce.map_or(Vec3::ZERO, |b| b.throughput * sky(b.direction));
    }
    sum / points as f32
}

fn main() -> Result<(), Box<dyn Error>> {
    let asset = match std::env::args().nth(1) {
        Some(path) => std::fs::read(path)?,
        None => built_in()?,
    };
    let material = StructuralColour::load(&asset)?;
    let mean = frame(&material, 100_000);
    println!("mean colour {:.3} {:.3} {:.3}", mean.x, mean.y, mean.z);
    Ok(())
}
