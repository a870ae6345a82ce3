//! Lat-long images from the bytes of OpenEXR and Radiance HDR files.

use glam::Vec3;

use super::latlong::LatLong;
use super::picture::Decoded;
use super::primaries::{are_rec_709, to_rec_709};
use super::{openexr, radiance};
use crate::support::error::{Error, Result};
use crate::support::memory;

/// Radiance that replaces infinity: the largest half-precision number.
const MAX_RADIANCE: f32 = 65_504.0;

/// Repairs of an image before its use, and the interpretation of its channels.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct ImageRepairs {
    /// Number of negative components, which became 0.
    pub negative: usize,
    /// Number of components that were not a number, which became 0.
    pub not_a_number: usize,
    /// Number of components that were infinite or above 65504, the largest half-precision number, which they became.
    pub infinite: usize,
    /// Whether R, G, B had other primaries than Rec. 709 and were converted to those.
    pub converted: bool,
    /// Whether the file holds luminance alone, which is taken as grey.
    pub grey: bool,
}

impl ImageRepairs {
    /// Messages for the user, one line for each repair and each interpretation; empty if there are none.
    #[must_use]
    pub fn notes(&self) -> Vec<String> {
        let parts = [
            (self.negative, "negative, now 0"),
            (self.not_a_number, "not numbers, now 0"),
            (self.infinite, "infinite, now 65504"),
        ];
        let counted: Vec<String> =
            parts.iter().filter(|(count, _)| *count > 0).map(|(count, what)| format!("{count} {what}")).collect();
        let mut notes = Vec::new();
        if !counted.is_empty() {
            notes.push(format!("components of the environment: {}", counted.join("; ")));
        }
        if self.converted {
            notes.push("its colours are converted from its own primaries to those of Rec. 709 (sRGB)".to_owned());
        }
        if self.grey {
            notes.push("it holds luminance alone; the light is grey".to_owned());
        }
        notes
    }
}

/// Decodes a lat-long image from the bytes of an OpenEXR or Radiance HDR file, which its first bytes tell apart.
///
/// `label` names the file in messages. Returns the image in Rec. 709 primaries, finite and not negative, with what had
/// to be repaired in it.
///
/// # Errors
/// A file of another format, a damaged file, an image that is not twice as wide as high or has too many texels,
/// primaries that span no colours, a wholly black image, or too little memory. The message is one line that names the
/// file.
pub fn decode(label: &str, bytes: &[u8]) -> Result<(LatLong, ImageRepairs)> {
    let failed = |what: &str| Error::failed(format_args!("{label}: {what}"));
    let decoded = if bytes.starts_with(&[0x76, 0x2f, 0x31, 0x01]) {
        openexr::read(bytes)
    } else if bytes.starts_with(b"#?") {
        radiance::read(bytes)
    } else {
        Err("neither OpenEXR nor Radiance HDR; export the environment as one of them".to_owned())
    };
    let Decoded { size, mut texels, primaries, is_grey } = decoded.map_err(|what| failed(&what))?;
    let other = primaries.filter(|primaries| !is_grey && !are_rec_709(primaries));
    if let Some(primaries) = &other {
        let matrix =
            to_rec_709(primaries).ok_or_else(|| failed("its primaries span no colours; correct its header"))?;
        for texel in &mut texels {
            *texel = (matrix * Vec3::from(*texel).as_dvec3()).as_vec3().to_array();
        }
    }
    // The distribution by which the light is sampled takes as much again.
    memory::expect(size_of::<f64>() * texels.len(), "the environment").map_err(|error| failed(&error.to_string()))?;
    let repairs = ImageRepairs { converted: other.is_some(), grey: is_grey, ..repair(&mut texels) };
    if texels.iter().flatten().all(|&x| x == 0.0) {
        return Err(failed("every texel of the environment is black; the picture would be, too"));
    }
    let image = LatLong::new(size, texels).ok_or_else(|| failed("the image is cut short"))?;
    Ok((image, repairs))
}

/// Replaces components that are not a radiance, and counts them.
fn repair(texels: &mut [[f32; 3]]) -> ImageRepairs {
    let mut repairs = ImageRepairs::default();
    for x in texels.iter_mut().flatten() {
        if x.is_nan() {
            repairs.not_a_number += 1;
            *x = 0.0;
        } else if *x < 0.0 {
            repairs.negative += 1;
            *x = 0.0;
        } else if *x > MAX_RADIANCE {
            repairs.infinite += 1;
            *x = MAX_RADIANCE;
        }
    }
    repairs
}

#[cfg(test)]
mod tests {
    use std::io::Cursor;

    use exr::prelude::{Encoding, Image, SpecificChannels, WritableImage};

    use super::*;

    fn exr(width: usize, height: usize, of: impl Fn(usize) -> f32 + Sync) -> Vec<u8> {
        let channels = SpecificChannels::rgb(|at: exr::math::Vec2<usize>| {
            let i = at.1 * width + at.0;
            (of(i), 0.5f32, 2.0f32)
        });
        let layer = exr::prelude::Layer::new(
            (width, height),
            exr::prelude::LayerAttributes::default(),
            Encoding::SMALL_LOSSLESS,
            channels,
        );
        let mut bytes = Cursor::new(Vec::new());
        Image::from_layer(layer).write().non_parallel().to_buffered(&mut bytes).unwrap();
        bytes.into_inner()
    }

    /// The bytes of a Radiance HDR file of 4 × 2 texels, uncompressed: mantissas and a common exponent.
    fn hdr() -> Vec<u8> {
        let mut bytes = b"#?RADIANCE\nFORMAT=32-bit_rle_rgbe\n\n-Y 2 +X 4\n".to_vec();
        (0..8).for_each(|i: u8| bytes.extend([128, 64, i, 129]));
        bytes
    }

    #[test]
    fn both_formats_are_read() {
        let (image, repairs) = decode("e.exr", &exr(4, 2, |i| i as f32)).unwrap();
        assert_eq!((image.size(), repairs), ([4, 2], ImageRepairs::default()));
        assert_eq!(image.texels()[5], [5.0, 0.5, 2.0]);
        let (image, _) = decode("e.hdr", &hdr()).unwrap();
        // 128 · 2^(129 − 136) = 1
        assert!((image.texels()[3][0] - 1.0).abs() < 0.01 && (image.texels()[3][2] - 3.0 / 128.0).abs() < 0.01);
    }

    #[test]
    fn what_is_no_radiance_is_repaired_and_reported() {
        let strange = [1.0, -1.0, f32::NAN, f32::INFINITY, f32::NEG_INFINITY, 0.0, 0.0, 0.0];
        let (image, repairs) = decode("e.exr", &exr(4, 2, |i| strange[i])).unwrap();
        assert_eq!(repairs, ImageRepairs { negative: 2, not_a_number: 1, infinite: 1, ..ImageRepairs::default() });
        assert_eq!(image.texels()[3][0], MAX_RADIANCE);
        assert_eq!(
            repairs.notes(),
            ["components of the environment: 2 negative, now 0; 1 not numbers, now 0; 1 infinite, now 65504"]
        );
        assert!(ImageRepairs::default().notes().is_empty());
    }

    #[test]
    fn faults_are_named() {
        let refusal = |bytes: &[u8]| decode("e", bytes).unwrap_err().to_string();
        assert!(refusal(b"\x89PNG").starts_with("e: neither OpenEXR nor Radiance HDR"));
        assert!(refusal(&exr(3, 2, |_| 1.0)).contains("3 × 2 texels are no lat-long image"));
        for good in [exr(4, 2, |_| 1.0), hdr()] {
            for length in 0..good.len() - 1 {
                assert!(!refusal(&good[..length]).contains('\n'));
            }
        }
    }
}
