//! Lat-long images from the bytes of OpenEXR and Radiance HDR files.

use std::io::Cursor;

use exr::meta::MetaData;
use exr::prelude::{ReadChannels, ReadLayers};
use image::codecs::hdr::HdrDecoder;
use image::{DynamicImage, ImageDecoder};

use super::environment::LatLong;
use crate::error::{Error, Result};

/// Texels of an image; 8192 × 4096 and half as much again fit in 600 MB.
const MAX_TEXELS: usize = 50_000_000;

/// Radiance in place of infinity: the largest half.
const BRIGHTEST: f32 = 65_504.0;

/// What had to be mended in an image: components that were no radiance.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Mended {
    /// Negative components, now 0.
    pub negative: usize,
    /// Not numbers, now 0.
    pub not_a_number: usize,
    /// Infinite or beyond the largest half, now that.
    pub infinite: usize,
}

impl Mended {
    /// One line about what was mended, if anything was.
    #[must_use]
    pub fn says(&self) -> Option<String> {
        let parts = [
            (self.negative, "negative, now 0"),
            (self.not_a_number, "not numbers, now 0"),
            (self.infinite, "infinite, now 65504"),
        ];
        let said: Vec<String> =
            parts.iter().filter(|(count, _)| *count > 0).map(|(count, what)| format!("{count} {what}")).collect();
        (!said.is_empty()).then(|| format!("components of the environment: {}", said.join("; ")))
    }
}

/// The lat-long image in the bytes of a file that messages call `label`, EXR or Radiance HDR as its first bytes say, and what
/// had to be mended in it.
///
/// # Errors
/// One line that names the file.
pub fn decode(label: &str, bytes: &[u8]) -> Result<(LatLong, Mended)> {
    let failed = |what: &str| Error::failed(format_args!("{label}: {what}"));
    let (size, mut texels) = if bytes.starts_with(&[0x76, 0x2f, 0x31, 0x01]) {
        exr_texels(bytes)
    } else if bytes.starts_with(b"#?") {
        hdr_texels(bytes)
    } else {
        Err("neither OpenEXR nor Radiance HDR; export the environment as one of them".to_owned())
    }
    .map_err(|what| failed(&what))?;
    let mended = mend(&mut texels);
    if texels.iter().flatten().all(|&x| x == 0.0) {
        return Err(failed("every texel of the environment is black; the picture would be, too"));
    }
    let image = LatLong::new(size, texels).ok_or_else(|| failed("the image is cut short"))?;
    Ok((image, mended))
}

/// Width, height and texels, or what is wrong.
type Texels = std::result::Result<([usize; 2], Vec<[f32; 3]>), String>;

fn check_size(width: usize, height: usize) -> std::result::Result<(), String> {
    if width != 2 * height || height == 0 {
        return Err(format!("{width} × {height} texels are no lat-long image, which is twice as wide as high"));
    }
    if width * height > MAX_TEXELS {
        return Err(format!("{width} × {height} texels are too many; {MAX_TEXELS} is the limit, so scale it down"));
    }
    Ok(())
}

fn exr_texels(bytes: &[u8]) -> Texels {
    let broken = |error: exr::error::Error| format!("not a readable EXR file: {error}; export it anew");
    let meta = MetaData::read_from_buffered(bytes, true).map_err(broken)?;
    let header = meta.headers.first().ok_or("the EXR file is empty")?;
    let (width, height) = (header.layer_size.0, header.layer_size.1);
    let is_table = |name: &exr::meta::attribute::Text| name.to_string().starts_with("goniochrome.");
    if header.own_attributes.other.keys().any(is_table) {
        return Err("a BRDF table, where an environment is expected: swap the two".to_owned());
    }
    check_size(width, height)?;
    let image = exr::prelude::read()
        .no_deep_data()
        .largest_resolution_level()
        .rgb_channels(
            |size, _| vec![[0.0f32; 3]; size.0 * size.1],
            move |texels: &mut Vec<[f32; 3]>, at, (r, g, b): (f32, f32, f32)| texels[at.1 * width + at.0] = [r, g, b],
        )
        .first_valid_layer()
        .all_attributes()
        .non_parallel()
        .from_buffered(Cursor::new(bytes))
        .map_err(broken)?;
    Ok(([width, height], image.layer_data.channel_data.pixels))
}

fn hdr_texels(bytes: &[u8]) -> Texels {
    let broken = |error: image::ImageError| format!("not a readable Radiance HDR file: {error}; export it anew");
    let decoder = HdrDecoder::new(Cursor::new(bytes)).map_err(broken)?;
    let (width, height) = decoder.dimensions();
    let size = [width as usize, height as usize];
    check_size(size[0], size[1])?;
    let image = DynamicImage::from_decoder(decoder).map_err(broken)?;
    Ok((size, image.into_rgb32f().pixels().map(|pixel| pixel.0).collect()))
}

fn mend(texels: &mut [[f32; 3]]) -> Mended {
    let mut mended = Mended::default();
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
        assert_eq!((image.size(), mended), ([4, 2], Mended::default()));
        assert_eq!(image.texels()[5], [5.0, 0.5, 2.0]);
        let (image, _) = decode("e.hdr", &hdr()).unwrap();
        // 128 · 2^(129 − 136) = 1
        assert!((image.texels()[3][0] - 1.0).abs() < 0.01 && (image.texels()[3][2] - 3.0 / 128.0).abs() < 0.01);
    }

    #[test]
    fn what_is_no_radiance_is_mended_and_said() {
        let strange = [1.0, -1.0, f32::NAN, f32::INFINITY, f32::NEG_INFINITY, 0.0, 0.0, 0.0];
        let (image, mended) = decode("e.exr", &exr(4, 2, |i| strange[i])).unwrap();
        assert_eq!(mended, Mended { negative: 2, not_a_number: 1, infinite: 1 });
        assert_eq!(image.texels()[3][0], BRIGHTEST);
        let said = mended.says().unwrap();
        assert_eq!(
            said,
            "components of the environment: 2 negative, now 0; 1 not numbers, now 0; 1 infinite, now 65504"
        );
        assert_eq!(Mended::default().says(), None);
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
