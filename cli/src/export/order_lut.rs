//! Look-up textures of diffraction orders for shaders, with the shader function that shades a surface by them.
//!
//! The texture holds strengths (see [`OrderTable`]) at a few wavelengths, four of them in each texel. It consists of
//! tiles of the table's nodes, α along x and β along y: order k and wavelengths 4g to 4g + 3 have the tile in column k
//! and row g. A function, emitted with its constants, looks the environment up for each order and wavelength, in the
//! exact direction.

use std::collections::BTreeMap;
use std::fmt::{Display, Write};

use exr::prelude::{FlatSamples, f16};
use glam::DVec3;
use goniochrome::colour::{Quadrature, VISIBLE_NM};
use goniochrome::simd::complex::Polarised;
use goniochrome::table::Periodicity;

use super::lut::facts;
use super::shader::ShaderLanguage;
use super::texture;
use crate::colour::{space_name, visible, visible_weights, xyz_to_rgb};
use crate::support::error::{Error, Result};
use crate::support::text;
use crate::table::file::PREFIX;
use crate::table::mirror::neighbours;
use crate::table::orders::{LookupArrays, OrderTable};

/// Default number of wavelengths.
pub const WAVELENGTHS: u16 = 16;
/// Largest side of a texture that every engine takes.
const MAX_SIDE: usize = 16_384;
/// First and last wavelength, where the table has them: beyond lies less than 0.4 % of the luminance of white.
const RANGE_NM: [f64; 2] = [400.0, 700.0];

/// A look-up texture of diffraction orders.
#[derive(Debug, Clone, PartialEq)]
pub struct OrderLut {
    /// The table at the wavelengths of the texture.
    table: OrderTable,
    /// Linear RGB that a reflectance of 1 at each wavelength adds to a colour.
    weights: Vec<[f64; 3]>,
}

impl OrderLut {
    /// The texture of a table, with strengths at evenly spaced wavelengths from 400 to 700 nm or as far as the table
    /// goes. `wavelengths` is a multiple of 4.
    ///
    /// # Errors
    /// No visible wavelength, a table of one wavelength, a texture with more than 16384 texels along a side.
    pub fn new(table: &OrderTable, wavelengths: u16) -> Result<Self> {
        let known = &table.wavelength_nm;
        let [first, last] = [known.first(), known.last()].map(|nm| nm.copied().unwrap_or_default());
        let [from, to] = RANGE_NM.map(|nm| nm.clamp(first, last));
        if !visible(known) || from >= to {
            let [shortest, longest] = VISIBLE_NM;
            return Err(Error::failed(format_args!(
                "the table goes from {first} to {last} nm; shaders need several wavelengths within {shortest} to {longest} nm"
            )));
        }
        let step = (to - from) / f64::from(wavelengths - 1);
        let wavelength_nm: Vec<f64> = (0..wavelengths).map(|i| from + step * f64::from(i)).collect();
        let count = table.layout.count() * table.orders.len();
        let resampled = |strengths: &[f32]| -> Vec<f32> {
            let at = |nm: &f64| {
                let (below, above, t) = neighbours(known, *nm);
                let [low, high] = [below, above].map(|w| &strengths[w * count..(w + 1) * count]);
                low.iter().zip(high).map(move |(a, b)| a + t as f32 * (b - a))
            };
            wavelength_nm.iter().flat_map(at).collect()
        };
        let index = |values: &[f64]| {
            let at = |nm: &f64| {
                let (below, above, t) = neighbours(known, *nm);
                values[below] + t * (values[above] - values[below])
            };
            wavelength_nm.iter().map(at).collect()
        };
        let both = |of: &Polarised<Vec<f32>>| Polarised { s: resampled(&of.s), p: resampled(&of.p) };
        let matrix = xyz_to_rgb(table.metadata.space());
        let weights = visible_weights(&wavelength_nm, table.metadata.illuminant(), Quadrature::Interpolated)?;
        let lut = Self {
            weights: weights.into_iter().map(|xyz| (matrix * DVec3::from_array(xyz)).to_array()).collect(),
            table: OrderTable {
                index_above: index(&table.index_above),
                index_below: vec![0.0; wavelength_nm.len()],
                reflected: both(&table.reflected),
                transmitted: Polarised { s: Vec::new(), p: Vec::new() },
                error: Vec::new(),
                wavelength_nm,
                layout: table.layout,
                orders: table.orders.clone(),
                metadata: table.metadata.clone(),
            },
        };
        let [width, height] = lut.size();
        if width.max(height) > MAX_SIDE {
            return Err(Error::failed(format_args!(
                "a texture of {width} × {height} texels, for {} orders, is larger than the {MAX_SIDE} that engines take; \
                 make the table with fewer directions",
                lut.table.orders.len()
            )));
        }
        Ok(lut)
    }

    /// Width and height in texels.
    #[must_use]
    pub fn size(&self) -> [usize; 2] {
        let [width, height] = self.table.layout.nodes().map(|n| n as usize);
        [width * self.table.orders.len(), height * self.table.wavelength_nm.len() / 4]
    }

    /// Wavelengths in nanometres.
    #[must_use]
    pub fn wavelength_nm(&self) -> &[f64] {
        &self.table.wavelength_nm
    }

    /// The library's table of the same strengths, the truth for the shader function.
    #[must_use]
    pub fn arrays(&self) -> LookupArrays {
        self.table.arrays(self.weights.iter().copied())
    }

    /// The bytes of an OpenEXR file of half floats.
    ///
    /// # Errors
    /// A strength beyond the range of half floats; what the OpenEXR encoder refuses.
    pub fn exr(&self) -> Result<Vec<u8>> {
        let [width, height] = self.size();
        let [columns, rows] = self.table.layout.nodes().map(|n| n as usize);
        let strengths = self.table.unpolarised();
        if let Some(large) = strengths.iter().find(|strength| **strength > f16::MAX.to_f32()) {
            return Err(Error::failed(format_args!("a strength of {large} is beyond half floats, 65504")));
        }
        let texel = |channel: usize, x: usize, y: usize| {
            let (order, node) = (x / columns, y % rows * columns + x % columns);
            f16::from_f32(strengths[self.table.first(4 * (y / rows) + channel, node) + order])
        };
        let channels = ["R", "G", "B", "A"].into_iter().enumerate().map(|(channel, name)| {
            let texels = (0..height).flat_map(|y| (0..width).map(move |x| texel(channel, x, y)));
            (name, FlatSamples::F16(texels.collect()))
        });
        texture::encode((width, height), channels, None, self.about())
    }

    /// Keys and values of the header.
    fn about(&self) -> BTreeMap<String, String> {
        let metadata = &self.table.metadata;
        let mut about = facts(metadata.scene_name(), metadata.illuminant());
        let listed = |values: &mut dyn Iterator<Item = String>| values.collect::<Vec<_>>().join(" ");
        let [columns, rows] = self.table.layout.nodes();
        about.insert("kind", "order-lut".into());
        about.insert("colour_space", space_name(metadata.space()).into());
        about.insert("tile", format!("{columns} {rows}"));
        about.insert("orders", listed(&mut self.table.orders.iter().flatten().map(ToString::to_string)));
        about.insert("period_nm", listed(&mut self.table.layout.period_nm().iter().map(ToString::to_string)));
        about.insert("wavelength_nm", listed(&mut self.table.wavelength_nm.iter().map(ToString::to_string)));
        about.insert("rgb_weights", listed(&mut self.weights.iter().flatten().map(ToString::to_string)));
        about.into_iter().map(|(key, value)| (format!("{PREFIX}{key}"), value)).collect()
    }

    /// The shader function and its constants.
    #[must_use]
    pub fn shader(&self, language: ShaderLanguage) -> String {
        let function = match language {
            ShaderLanguage::Glsl => include_str!("../../data/shaders/orders.glsl"),
            ShaderLanguage::Hlsl => include_str!("../../data/shaders/orders.hlsl"),
            ShaderLanguage::Wgsl => include_str!("../../data/shaders/orders.wgsl"),
        };
        let (head, body) = function.split_once("\n\n").unwrap_or(("", function));
        format!("{head}\n\n{}\n{body}", self.constants(language))
    }

    /// The constants that the function reads.
    fn constants(&self, language: ShaderLanguage) -> String {
        let table = &self.table;
        let layout = table.layout;
        let [columns, rows] = layout.nodes();
        let [x, y] = layout.period_nm();
        let periodicity = layout.periodicity();
        let in_medium: Vec<f64> = table.wavelength_nm.iter().zip(&table.index_above).map(|(nm, n)| nm / n).collect();
        let [first, last] = [in_medium[0], in_medium[in_medium.len() - 1]];
        let single = |value: f64| format!("{:?}", value as f32);
        let vector = |values: &[f64]| {
            let name = match (language, values.len()) {
                (ShaderLanguage::Glsl, n) => format!("vec{n}"),
                (ShaderLanguage::Hlsl, n) => format!("float{n}"),
                (ShaderLanguage::Wgsl, n) => format!("vec{n}<f32>"),
            };
            format!("{name}({})", values.iter().map(|x| single(*x)).collect::<Vec<_>>().join(", "))
        };
        let mut out = String::new();
        // Writing to a string does not fail.
        let _ = writeln!(
            out,
            "// Scene: {}. Light: {:?}. Colours: linear {}.",
            text::one_line(table.metadata.scene_name()),
            table.metadata.illuminant(),
            space_name(table.metadata.space())
        );
        let mut one = |about: &str, kind: &str, name: &str, value: &dyn Display| {
            let _ = writeln!(out, "// {about}");
            let _ = match language {
                ShaderLanguage::Glsl => writeln!(out, "const {kind} GONIOCHROME_{name} = {value};"),
                ShaderLanguage::Hlsl => writeln!(out, "static const {} GONIOCHROME_{name} = {value};", hlsl(kind)),
                ShaderLanguage::Wgsl => writeln!(out, "const GONIOCHROME_{name} = {value};"),
            };
        };
        one("Numbers of orders and of wavelengths.", "int", "ORDER_COUNT", &table.orders.len());
        one("", "int", "WAVELENGTH_COUNT", &in_medium.len());
        one("Nodes of a tile over α and β.", "vec2", "NODES", &vector(&[columns.into(), rows.into()]));
        one(
            "Whether the surface consists of lines, and whether these run along the tangent.",
            "bool",
            "LINES",
            &periodicity.has_lines(),
        );
        one("", "bool", "LINES_ALONG_TANGENT", &(periodicity == Periodicity::Y));
        one("Periods along tangent and binormal, in nm.", "vec2", "PERIOD_NM", &vector(&[x.into(), y.into()]));
        one(
            "Mean step of the wavelengths in the medium above, in nm.",
            "float",
            "STEP_NM",
            &single((last - first) / (in_medium.len() - 1) as f64),
        );
        let mut list = |about: &str, kind: &str, name: &str, values: Vec<String>| {
            let (count, values) = (values.len(), values.join(",\n    "));
            let _ = writeln!(out, "// {about}");
            let _ = match language {
                ShaderLanguage::Glsl => {
                    writeln!(out, "const {kind} GONIOCHROME_{name}[{count}] = {kind}[{count}](\n    {values});")
                }
                ShaderLanguage::Hlsl => {
                    let kind = hlsl(kind);
                    writeln!(out, "static const {kind} GONIOCHROME_{name}[{count}] = {{\n    {values}}};")
                }
                // An array that is indexed at run time must be a variable.
                ShaderLanguage::Wgsl => {
                    let kind = if kind == "float" { "f32".to_owned() } else { format!("{kind}<f32>") };
                    let array = format!("array<{kind}, {count}>");
                    writeln!(out, "var<private> GONIOCHROME_{name}: {array} = {array}(\n    {values});")
                }
            };
        };
        let numbers = table.orders.iter().map(|order| vector(&order.map(f64::from)));
        list("Numbers (m, n) of each order.", "vec2", "ORDERS", numbers.collect());
        list(
            "Wavelengths in the medium above, in nm.",
            "float",
            "WAVELENGTHS_NM",
            in_medium.iter().map(|nm| single(*nm)).collect(),
        );
        list(
            "Linear RGB that a reflectance of 1 at each wavelength adds; their sum is white.",
            "vec3",
            "WEIGHTS",
            self.weights.iter().map(|weight| vector(weight)).collect(),
        );
        out.replace("// \n", "")
    }
}

/// A type of GLSL in HLSL.
fn hlsl(kind: &str) -> String {
    kind.replace("vec", "float")
}

#[cfg(test)]
mod tests {
    use exr::prelude::read_first_flat_layer_from_file;

    use super::*;
    use crate::table::orders::tests::sample;

    #[test]
    fn texels_lie_in_tiles_of_orders_and_wavelengths() {
        let lut = OrderLut::new(&sample(), 8).unwrap();
        assert_eq!((lut.size(), lut.wavelength_nm()[0], lut.wavelength_nm()[7]), ([9, 4], 450.0, 600.0));
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("orders.exr");
        std::fs::write(&path, lut.exr().unwrap()).unwrap();
        let image = read_first_flat_layer_from_file(&path).unwrap();
        let green = image.layer_data.channel_data.list.iter().find(|channel| channel.name.eq_case_insensitive("G"));
        let green: Vec<f32> = green.unwrap().sample_data.values_as_f32().collect();
        // Order 1, wavelengths 4 to 7, node (2, 1).
        let expected = lut.table.unpolarised()[lut.table.first(5, 5) + 1];
        assert!((green[(2 + 1) * 9 + 3 + 2] / expected - 1.0).abs() < 1.0 / 2048.0);
        let about = lut.about();
        assert_eq!((&*about["goniochrome.kind"], &*about["goniochrome.tile"]), ("order-lut", "3 2"));
    }

    #[test]
    fn shader_functions_hold_their_constants() {
        let mut table = sample();
        table.metadata.insert("scene", "lines\n#error");
        let lut = OrderLut::new(&table, 4).unwrap();
        let shader = |language| lut.shader(language);
        assert!(shader(ShaderLanguage::Glsl).contains("const int GONIOCHROME_ORDER_COUNT = 3;\n"));
        assert!(
            shader(ShaderLanguage::Hlsl)
                .contains("static const float2 GONIOCHROME_ORDERS[3] = {\n    float2(-1.0, 0.0)")
        );
        let wgsl = shader(ShaderLanguage::Wgsl);
        assert!(wgsl.contains("var<private> GONIOCHROME_WAVELENGTHS_NM: array<f32, 4> = array<f32, 4>(\n    450.0,"));
        assert!(wgsl.lines().all(|line| line.chars().count() <= 120 && line != "#error"), "{wgsl}");
    }

    #[test]
    fn what_shaders_cannot_hold_is_refused() {
        let refusal = |table: &OrderTable| OrderLut::new(table, WAVELENGTHS).unwrap_err().to_string();
        let infrared = OrderTable { wavelength_nm: vec![900.0, 1000.0], ..sample() };
        assert!(refusal(&infrared).contains("from 900 to 1000 nm"));
        let mut strong = sample();
        strong.reflected.s.fill(2e5);
        let lut = OrderLut::new(&strong, WAVELENGTHS).unwrap();
        assert!(lut.exr().unwrap_err().to_string().contains("beyond half floats"));
    }
}
