//! Lat-long images from the bytes of OpenEXR and Radiance HDR files.

use glam::Vec3;

use super::environment::LatLong;
use super::primaries::{Primaries, are_rec_709, to_rec_709};
use super::{openexr, radiance};
use crate::support::error::{Error, Result};
use crate::support::memory;

/// Texels of an image; 8192 × 4096 and half as much again fit in 600 MB.
const MAX_TEXELS: usize = 50_000_000;

/// Radiance in place of infinity: the largest half.
const BRIGHTEST: f32 = 65_504.0;

/// A picture as a file holds it.
#[derive(Debug, PartialEq)]
pub(super) struct Decoded {
    pub size: [usize; 2],
    /// Row by row from the upper left.
    pub texels: Vec<[f32; 3]>,
    /// What the file says that R, G, B are.
    pub primaries: Option<Primaries>,
    /// It holds luminance alone.
    pub is_grey: bool,
}

/// What had to be mended in an image, and how it was understood.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct ImageRepairs {
    /// Negative components, now 0.
    pub negative: usize,
    /// Not numbers, now 0.
    pub not_a_number: usize,
    /// Infinite or beyond the largest half, now that.
    pub infinite: usize,
    /// Its R, G, B had other primaries than Rec. 709, to which they are now converted.
    pub converted: bool,
    /// It holds luminance alone, and is taken as grey.
    pub grey: bool,
}

impl ImageRepairs {
    /// One line about each thing that was mended or had to be understood.
    #[must_use]
    pub fn notes(&self) -> Vec<String> {
        let parts = [
            (self.negative, "negative, now 0"),
            (self.not_a_number, "not numbers, now 0"),
            (self.infinite, "infinite, now 65504"),
        ];
        let counted: Vec<String> =
            parts.iter().filter(|(count, _)| *count > 0).map(|(count, what)| format!("{count} {what}")).collect();
        let mut said = Vec::new();
        if !counted.is_empty() {
            said.push(format!("components of the environment: {}", counted.join("; ")));
        }
        if self.converted {
            said.push("its colours are converted from its own primaries to those of Rec. 709 (sRGB)".to_owned());
        }
        if self.grey {
            said.push("it holds luminance alone; the light is grey".to_owned());
        }
        said
    }
}

/// The lat-long image in the bytes of a file that messages call `label`, EXR or Radiance HDR as its first bytes say,
/// and what had to be mended in it.
///
/// # Errors
/// One line that names the file.
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
    // By which the light is sampled.
    memory::expect(size_of::<f64>() * texels.len(), "the environment").map_err(|error| failed(&error.to_string()))?;
    let mended = ImageRepairs { converted: other.is_some(), grey: is_grey, ..mend(&mut texels) };
    if texels.iter().flatten().all(|&x| x == 0.0) {
        return Err(failed("every texel of the environment is black; the picture would be, too"));
    }
    let image = LatLong::new(size, texels).ok_or_else(|| failed("the image is cut short"))?;
    Ok((image, mended))
}

/// Whether a picture of this size is one that can be read.
pub(super) fn check_size(width: usize, height: usize) -> std::result::Result<(), String> {
    if height == 0 || height.checked_mul(2) != Some(width) {
        return Err(format!(
            "{width} × {height} texels are no lat-long image, which is twice as wide as high; convert cube maps and mirror balls"
        ));
    }
    if width.checked_mul(height).is_none_or(|count| count > MAX_TEXELS) {
        return Err(format!("{width} × {height} texels are too many; {MAX_TEXELS} is the limit, so scale it down"));
    }
    Ok(())
}

fn mend(texels: &mut [[f32; 3]]) -> ImageRepairs {
    let mut mended = ImageRepairs::default();
    for x in texels.iter_mut().flatten() {
        if x.is_nan() {
            mended.not_a_number += 1;
            *x = 0.0;
        } else if *x < 0.0 {
            mended.negative += 1;
            *x = 0.0;
        } else if *x > BRIGHTEST {
            mended.infinite += 1;
            *x = BRIGHTEST;
        }
    }
    mended
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

    /// 4 × 2 texels, uncompressed: mantissas and a common exponent.
    fn hdr() -> Vec<u8> {
        let mut bytes = b"#?RADIANCE\nFORMAT=32-bit_rle_rgbe\n\n-Y 2 +X 4\n".to_vec();
        (0..8).for_each(|i: u8| bytes.extend([128, 64, i, 129]));
        bytes
    }

    #[test]
    fn both_formats_are_read() {
        let (image, mended) = decode("e.exr", &exr(4, 2, |i| i as f32)).unwrap();
        assert_eq!((image.size(), mended), ([4, 2], ImageRepairs::default()));
        assert_eq!(image.texels()[5], [5.0, 0.5, 2.0]);
        let (image, _) = decode("e.hdr", &hdr()).unwrap();
        // 128 · 2^(129 − 136) = 1
        assert!((image.texels()[3][0] - 1.0).abs() < 0.01 && (image.texels()[3][2] - 3.0 / 128.0).abs() < 0.01);
    }

    #[test]
    fn what_is_no_radiance_is_mended_and_said() {
        let strange = [1.0, -1.0, f32::NAN, f32::INFINITY, f32::NEG_INFINITY, 0.0, 0.0, 0.0];
        let (image, mended) = decode("e.exr", &exr(4, 2, |i| strange[i])).unwrap();
        assert_eq!(mended, ImageRepairs { negative: 2, not_a_number: 1, infinite: 1, ..ImageRepairs::default() });
        assert_eq!(image.texels()[3][0], BRIGHTEST);
        assert_eq!(
            mended.notes(),
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
