//! Look-up textures ([`super::lut`]) as 16-bit RGB PNG.
//!
//! Samples are linear: 0 is black, 65535 is 1. PNG holds neither negative numbers nor any above 1, so colours are
//! brought into the gamut by the policy of pictures ([`crate::plot::in_gamut`]): those with a negative component are
//! mixed with the grey of their luminance until it is 0, those above 1 are scaled. OpenEXR keeps colours unchanged. The
//! chunks cICP (primaries of BT.709, linear transfer, full range), gAMA (1) and cHRM tell readers that samples are
//! linear; iTXt chunks hold [`Lut::about`].

use png::chunk::ChunkType;
use png::{BitDepth, ColorType, Encoder, ScaledFloat, SourceChromaticities};

use super::lut::Lut;
use crate::plot::in_gamut;
use crate::support::error::{Error, Result};

/// The chunk cICP by ITU-T H.273: primaries of BT.709 and sRGB, linear transfer, no matrix, full range.
const CICP: [u8; 4] = [1, 8, 0, 1];
const CICP_TYPE: ChunkType = ChunkType(*b"cICP");

/// Chromaticity of D65.
const WHITE: (f32, f32) = (0.3127, 0.329);
/// Chromaticities of sRGB's red, green and blue.
const PRIMARIES: [(f32, f32); 3] = [(0.64, 0.33), (0.3, 0.6), (0.15, 0.06)];

/// The bytes of the PNG file of a texture in linear sRGB.
///
/// # Errors
/// What the PNG encoder refuses.
pub fn encode(lut: &Lut) -> Result<Vec<u8>> {
    let samples: Vec<u8> = lut
        .texels
        .iter()
        .flat_map(|texel| in_gamut(*texel))
        .flat_map(|c| ((c * f64::from(u16::MAX)).round() as u16).to_be_bytes())
        .collect();
    let height = lut.texels.len() / lut.width;
    let mut bytes = Vec::new();
    // A table has at most 4096 texels a side.
    let mut encoder = Encoder::new(&mut bytes, lut.width as u32, height as u32);
    encoder.set_color(ColorType::Rgb);
    encoder.set_depth(BitDepth::Sixteen);
    encoder.set_source_gamma(ScaledFloat::new(1.0));
    let [red, green, blue] = PRIMARIES;
    encoder.set_source_chromaticities(SourceChromaticities::new(WHITE, red, green, blue));
    let failed = |error| Error::failed(format_args!("cannot encode the table as PNG: {error}"));
    for (key, value) in lut.about() {
        encoder.add_itxt_chunk(key, value).map_err(failed)?;
    }
    let mut writer = encoder.write_header().map_err(failed)?;
    writer.write_chunk(CICP_TYPE, &CICP).map_err(failed)?;
    writer.write_image_data(&samples).map_err(failed)?;
    writer.finish().map_err(failed)?;
    Ok(bytes)
}

#[cfg(test)]
mod tests {
    use std::io::Cursor;

    use super::*;

    #[test]
    fn a_reader_finds_the_colours_and_that_they_are_linear() {
        let texels = vec![[0.0, 0.25, 1.0], [0.5, 0.125, 0.75], [0.3, 0.3, -0.1], [2.0, 1.0, 0.5]];
        let file = encode(&Lut { width: 2, texels: texels.clone(), ..Lut::default() }).unwrap();
        let mut reader = png::Decoder::new(Cursor::new(file)).read_info().unwrap();
        let info = reader.info();
        assert_eq!((info.width, info.height), (2, 2));
        assert_eq!((info.color_type, info.bit_depth), (ColorType::Rgb, BitDepth::Sixteen));
        assert_eq!(info.gama_chunk, Some(ScaledFloat::new(1.0)));
        let [red, green, blue] = PRIMARIES;
        assert_eq!(info.chrm_chunk, Some(SourceChromaticities::new(WHITE, red, green, blue)));
        assert!(info.srgb.is_none());
        let said = info.utf8_text.iter().map(|chunk| (chunk.keyword.as_str(), chunk.get_text().unwrap()));
        assert!(said.into_iter().any(|(key, text)| key == "goniochrome.colour_space" && text == "srgb"));
        let cicp = info.coding_independent_code_points.unwrap();
        assert_eq!((cicp.color_primaries, cicp.transfer_function, cicp.matrix_coefficients), (1, 8, 0));
        let mut samples = vec![0; reader.output_buffer_size().unwrap()];
        reader.next_frame(&mut samples).unwrap();
        let read: Vec<f64> =
            samples.chunks_exact(2).map(|b| f64::from(u16::from_be_bytes([b[0], b[1]])) / 65535.0).collect();
        /// Rounding to 16 bits.
        const HALF_A_STEP: f64 = 0.5 / 65535.0 + 1e-9;
        for (texel, read) in texels.into_iter().zip(read.chunks_exact(3)) {
            for (want, got) in in_gamut(texel).into_iter().zip(read) {
                assert!((got - want).abs() <= HALF_A_STEP, "{texel:?}: {read:?}");
            }
        }
        // What was in the gamut is as it was, and what was not lies on its border.
        assert!((read[1] - 0.25).abs() <= HALF_A_STEP && (read[5] - 0.75).abs() <= HALF_A_STEP);
        assert!(read[8] == 0.0 && read[9] == 1.0 && (read[10] - 0.5).abs() <= HALF_A_STEP, "{read:?}");
    }
}
