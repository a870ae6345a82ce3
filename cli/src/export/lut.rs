//! Linear RGB reflectance over cos θ and, where a layer's thickness is varied, over that: a texture for shaders.
//!
//! Texel centres lie at the ends: column x of N is cos θ = x/(N − 1), from grazing to facing; row y of M, from the top of the
//! image, is parameter y/(M − 1). Values are kept as they are, negative ones (out of gamut) too, as half floats in OpenEXR;
//! [`super::png`] brings them into the gamut.

use std::io::Cursor;

use exr::prelude::{AnyChannel, AnyChannels, Encoding, FlatSamples, Image, WritableImage, f16};
use goniochrome::colour::{Illuminant, Quadrature, RgbSpace};
use goniochrome::interface::Model;

use crate::args::export::Vary;
use crate::colours::colours;
use crate::error::{Error, Result};
use crate::estimate::{Method, Precision, Request, spectra};
use crate::grid::Wavelengths;
use crate::parallel;
use crate::planar::Planar;
use crate::scene::{Scene, Shape};
use crate::table::MirrorTable;

/// Grazing light, as near as a stack's equations go.
const GRAZING_COS: f64 = 1e-6;

/// The texture.
#[derive(Debug, Clone, PartialEq)]
pub struct Lut {
    /// Texels over cos θ.
    pub width: usize,
    /// Row by row from parameter 0.
    pub texels: Vec<[f32; 3]>,
}

/// θ in degrees of each column.
fn angles(width: usize) -> impl Iterator<Item = f64> {
    (0..width).map(move |x| (x as f64 / (width - 1) as f64).max(GRAZING_COS).acos().to_degrees())
}

impl Lut {
    /// One row from a table, in the table's colour space; held beyond its last angle.
    #[must_use]
    pub fn of_table(table: &MirrorTable, width: usize) -> Self {
        Self { width, texels: angles(width).map(|theta| table.rgb_at(theta)).collect() }
    }

    /// From a planar scene, exact at every texel: closed form, D65, linear sRGB.
    ///
    /// # Errors
    /// A scene that is not planar, or has no such layer.
    pub fn of_scene(scene: &Scene, width: usize, vary: Option<Vary>) -> Result<Self> {
        let Some(Vary { layer, range_nm: [from, to], steps }) = vary else {
            return Ok(Self { width, texels: row(scene, width)? });
        };
        let mut scene = scene.clone();
        let mut texels = Vec::with_capacity(width * usize::from(steps));
        for step in 0..steps {
            let thickness_nm = from + (to - from) * f64::from(step) / f64::from(steps - 1);
            let Shape::Stack { layers, .. } = &mut scene.shape else {
                return Err(Error::usage(format_args!("--vary: {} has no [stack] of layers", scene.name)));
            };
            let count = layers.len();
            let Some(varied) = layers.get_mut(layer - 1) else {
                return Err(Error::usage(format_args!(
                    "--vary {layer}=…: {} has {count} layers; name one of them, 1 is the top",
                    scene.name
                )));
            };
            varied.thickness_nm = thickness_nm;
            texels.extend(row(&scene, width)?);
        }
        Ok(Self { width, texels })
    }

    /// The bytes of an OpenEXR file of half floats.
    ///
    /// # Errors
    /// If a value is beyond half floats.
    pub fn exr(&self) -> Result<Vec<u8>> {
        let channel = |name: &str, c: usize| {
            let values = self.texels.iter().map(|texel| f16::from_f32(texel[c])).collect();
            AnyChannel::new(name, FlatSamples::F16(values))
        };
        let channels = AnyChannels::sort([channel("R", 0), channel("G", 1), channel("B", 2)].into_iter().collect());
        let size = (self.width, self.texels.len() / self.width);
        let image = Image::from_encoded_channels(size, Encoding::UNCOMPRESSED, channels);
        let mut bytes = Cursor::new(Vec::new());
        image
            .write()
            .non_parallel()
            .to_buffered(&mut bytes)
            .map_err(|error| Error::failed(format_args!("cannot encode the table as EXR: {error}")))?;
        Ok(bytes.into_inner())
    }

    /// The look-up that the shaders make: bilinear, held at the edges.
    #[must_use]
    pub fn sample(&self, cos_theta: f32, parameter: f32) -> [f32; 3] {
        let height = self.texels.len() / self.width;
        let place = |at: f32, count: usize| {
            let at = at.clamp(0.0, 1.0) * (count - 1) as f32;
            let below = (at as usize).min(count.saturating_sub(2));
            (below, (below + 1).min(count - 1), at - below as f32)
        };
        let (x0, x1, u) = place(cos_theta, self.width);
        let (y0, y1, v) = place(parameter, height);
        let at = |x: usize, y: usize, c: usize| self.texels[y * self.width + x][c];
        std::array::from_fn(|c| {
            let along = |y: usize| at(x0, y, c) + u * (at(x1, y, c) - at(x0, y, c));
            along(y0) + v * (along(y1) - along(y0))
        })
    }
}

fn row(scene: &Scene, width: usize) -> Result<Vec<[f32; 3]>> {
    let planar = Planar::new(scene)?;
    let wavelengths = Wavelengths::every(5.0).resolve(&planar)?;
    let theta_deg: Vec<f64> = angles(width).collect();
    let colours = exact_rgb(&planar, &theta_deg, &wavelengths)?;
    Ok(colours.into_iter().map(|rgb| rgb.map(|c| c as f32)).collect())
}

/// Linear sRGB in D65 by the closed form, unclipped.
pub(super) fn exact_rgb(planar: &Planar<'_>, theta_deg: &[f64], wavelengths: &[f64]) -> Result<Vec<[f64; 3]>> {
    let request = Request {
        model: Model::Physical,
        method: Method::Stack,
        precision: Precision::F64,
        threads: parallel::available(),
    };
    let spectra = spectra(planar, theta_deg, wavelengths, &request, &|| ())?;
    let colours = colours(&spectra, Illuminant::D65, RgbSpace::Srgb, Quadrature::Interpolated)?;
    Ok(colours.into_iter().map(|colour| colour.rgb).collect())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn texels_come_back_at_their_places() {
        let lut = Lut { width: 3, texels: (0..6).map(|i| [i as f32, 0.5, -1.0]).collect() };
        assert_eq!(lut.sample(0.5, 1.0), [4.0, 0.5, -1.0]);
        assert_eq!(lut.sample(0.25, 0.5), [2.0, 0.5, -1.0]);
        assert_eq!(lut.sample(2.0, -1.0), [2.0, 0.5, -1.0]);
    }
}
