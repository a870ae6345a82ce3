//! Files of mirror-like tables: one pixel per angle, and one line per thickness where a layer has several.
//!
//! | channel | holds |
//! |---|---|
//! | `R`, `G`, `B` | linear RGB; left out where no wavelength is visible |
//! | `T.550,000000nm` | unpolarised reflectance at a wavelength |
//! | `s.T.550,000000nm`, `p.T.550,000000nm` | its polarised parts |
//! | `transmitted.R`, `transmitted.s.T.550,000000nm`, … | the transmittance; left out where the medium behind absorbs |
//!
//! `goniochrome.theta_deg` holds the angles in degrees at full precision, `goniochrome.wavelength_nm` the wavelengths:
//! decimal numbers separated by spaces. `goniochrome.thickness_nm` holds the thicknesses of the lines, from the top,
//! and `goniochrome.varied_layer` says whose they are. `tests/python/read_table.py` reads them in NumPy. Lines are
//! ZIP-compressed one by one.

use std::collections::BTreeMap;

use exr::prelude::Compression;

use super::container::{Contents, KIND, Opened, PixelChannels, WAVELENGTH, channel_names, format_numbers};
use super::lazy_channel::LazyChannel;
use crate::colour::visible;
use crate::support::error::{Error, Result};
use crate::table::mirror::{MirrorTable, ThicknessAxis, check_size};

/// Value of the attribute `kind`.
pub(super) const MIRROR: &str = "mirror";
const THETA: &str = "theta_deg";
const THICKNESS: &str = "thickness_nm";
const LAYER: &str = "varied_layer";
/// Prefix of the channels of transmitted light.
const TRANSMITTED: &str = "transmitted.";

/// Encodes a table as an EXR file.
///
/// # Errors
/// A table that [`MirrorTable::check`] refuses, metadata whose keys are reserved or not printable, wavelengths too
/// close for names of channels.
pub fn encode(table: &MirrorTable) -> Result<Vec<u8>> {
    table.check()?;
    let names = channel_names(&table.wavelength_nm)?;
    let mut channels = power_channels("", &names, &table.rgb, &table.reflectance_s, &table.reflectance_p);
    if table.is_transparent() {
        let (s, p) = (&table.transmittance_s, &table.transmittance_p);
        channels.extend(power_channels(TRANSMITTED, &names, &table.rgb_transmitted, s, p));
    }
    let mut attributes: BTreeMap<String, String> = [
        (KIND, MIRROR.to_owned()),
        (THETA, format_numbers(&table.theta_deg)),
        (WAVELENGTH, format_numbers(&table.wavelength_nm)),
    ]
    .map(|(key, value)| (key.to_owned(), value))
    .into();
    if let Some(ThicknessAxis { layer, nm }) = &table.thickness {
        attributes.extend([(THICKNESS.to_owned(), format_numbers(nm)), (LAYER.to_owned(), layer.to_string())]);
    }
    let size = (table.theta_deg.len(), table.thicknesses());
    let mut contents = Contents { size, compression: Compression::ZIP1, channels, attributes };
    contents.add_metadata(&table.metadata)?;
    contents.encode(1)
}

/// Channels of the reflectance or the transmittance.
fn power_channels<'t>(
    prefix: &str,
    names: &[String],
    rgb: &'t [[f32; 3]],
    s: &'t [f32],
    p: &'t [f32],
) -> Vec<(String, LazyChannel<'t>)> {
    let count = names.len();
    let mut channels = Vec::with_capacity(3 * count + 3);
    for (c, name) in ["R", "G", "B"].into_iter().enumerate().filter(|_| !rgb.is_empty()) {
        channels.push((format!("{prefix}{name}"), LazyChannel::new(move |row| rgb[row][c])));
    }
    for (w, name) in names.iter().enumerate() {
        let mean = move |row| 0.5 * s[row * count + w] + 0.5 * p[row * count + w];
        channels.extend([
            (format!("{prefix}{name}"), LazyChannel::new(mean)),
            (format!("{prefix}s.{name}"), LazyChannel::new(move |row| s[row * count + w])),
            (format!("{prefix}p.{name}"), LazyChannel::new(move |row| p[row * count + w])),
        ]);
    }
    channels
}

/// Decodes the table in a file of this kind.
pub(super) fn decode(mut file: Opened<'_>) -> Result<MirrorTable> {
    let theta_deg: Vec<f64> = file.take_numbers(THETA)?;
    let wavelength_nm: Vec<f64> = file.take_numbers(WAVELENGTH)?;
    let thickness = match file.attributes.contains_key(THICKNESS) {
        true => Some(ThicknessAxis { nm: file.take_numbers(THICKNESS)?, layer: layer(&file.take(LAYER)?)? }),
        false => None,
    };
    let thicknesses = thickness.as_ref().map_or(1, |axis| axis.nm.len());
    check_size(thicknesses, theta_deg.len(), wavelength_nm.len())?;
    let names = channel_names(&wavelength_nm)?;
    file.expect((theta_deg.len(), thicknesses), 6 * names.len() + 6)?;

    let mut pixels = file.pixels()?;
    let is_visible = visible(&wavelength_nm);
    let (rgb, reflectance_s, reflectance_p) = take_power("", &names, is_visible, &mut pixels)?;
    let (rgb_transmitted, transmittance_s, transmittance_p) = match pixels.has(&format!("{TRANSMITTED}{}", names[0])) {
        true => take_power(TRANSMITTED, &names, is_visible, &mut pixels)?,
        false => Power::default(),
    };
    let table = MirrorTable {
        theta_deg,
        wavelength_nm,
        thickness,
        reflectance_s,
        reflectance_p,
        rgb,
        transmittance_s,
        transmittance_p,
        rgb_transmitted,
        metadata: file.attributes.into(),
    };
    table.check()?;
    Ok(table)
}

/// The number of a layer.
fn layer(text: &str) -> Result<usize> {
    text.parse().map_err(|_| Error::failed(format_args!("\"{text}\" in goniochrome.{LAYER} is no number of a layer")))
}

/// Colours, and the values of s and p, `[row][wavelength]`.
type Power = (Vec<[f32; 3]>, Vec<f32>, Vec<f32>);

/// Takes what [`power_channels`] makes.
fn take_power(prefix: &str, names: &[String], is_visible: bool, pixels: &mut PixelChannels) -> Result<Power> {
    let mut rgb = Vec::new();
    if is_visible {
        let [r, g, b] = ["R", "G", "B"].map(|name| pixels.take(&format!("{prefix}{name}")));
        rgb.extend(r?.into_iter().zip(g?).zip(b?).map(|((r, g), b)| [r, g, b]));
    }
    let mut polarised = [Vec::new(), Vec::new()];
    for (w, name) in names.iter().enumerate() {
        pixels.take(&format!("{prefix}{name}"))?;
        for (values, letter) in polarised.iter_mut().zip(["s", "p"]) {
            let channel = pixels.take(&format!("{prefix}{letter}.{name}"))?;
            values.resize(channel.len() * names.len(), 0.0);
            values.iter_mut().skip(w).step_by(names.len()).zip(channel).for_each(|(to, from)| *to = from);
        }
    }
    let [s, p] = polarised;
    Ok((rgb, s, p))
}

#[cfg(test)]
mod tests {
    use std::io::Cursor;
    use std::path::Path;

    use exr::math::Vec2;
    use exr::meta::MetaData;
    use exr::prelude::{AnyChannel, AnyChannels, FlatSamples, Image, WritableImage};

    use super::*;
    use crate::table::Table;
    use crate::table::file::{decode, read, write};
    use crate::table::mirror::tests::{family, sample};

    #[test]
    fn a_table_round_trips_exactly() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("table.exr");
        let mut opaque = sample();
        opaque.transmittance_s.clear();
        opaque.transmittance_p.clear();
        opaque.rgb_transmitted.clear();
        for table in [sample(), family(), opaque] {
            write(&path, &table.clone().into(), 1).unwrap();
            assert_eq!(read(&path).unwrap(), Table::Mirror(table));
        }
    }

    #[test]
    fn invisible_tables_have_no_colour() {
        let table = MirrorTable {
            wavelength_nm: vec![800.0, 1000.0],
            rgb: Vec::new(),
            rgb_transmitted: Vec::new(),
            ..sample()
        };
        let bytes = encode(&table).unwrap();
        assert_eq!(decode(&bytes).unwrap(), Table::Mirror(table.clone()));
        assert!(table.colours().unwrap_err().to_string().contains("no colour"));
        let mut coloured = table;
        coloured.rgb = sample().rgb;
        assert_eq!(encode(&coloured).unwrap_err().to_string(), "the table has 3 RGB colours where 0 belong");
    }

    #[test]
    fn equal_tables_give_equal_bytes() {
        let first = encode(&sample()).unwrap();
        // A hash map of seven attributes keeps its order by luck once in 7! times.
        for _ in 0..3 {
            assert_eq!(encode(&sample()).unwrap(), first);
        }
    }

    #[test]
    fn channels_follow_the_published_layout() {
        let bytes = encode(&sample()).unwrap();
        let meta = MetaData::read_from_buffered(bytes.as_slice(), true).unwrap();
        let header = &meta.headers[0];
        assert_eq!((header.layer_size, header.compression), (Vec2(3, 1), Compression::ZIP1));
        let names: Vec<_> = header.channels.list.iter().map(|c| c.name.to_string()).collect();
        let expected = ["B", "G", "R", "T.435,833333nm", "T.700,000000nm", "p.T.435,833333nm", "p.T.700,000000nm"];
        assert_eq!(names[..7], expected);
        let image = exr::prelude::read_first_flat_layer_from_file;
        let folder = tempfile::tempdir().unwrap();
        std::fs::write(folder.path().join("t.exr"), &bytes).unwrap();
        let image = image(folder.path().join("t.exr")).unwrap();
        let mean = image.layer_data.channel_data.list.iter().find(|c| c.name.eq("T.700,000000nm")).unwrap();
        let values: Vec<f32> = mean.sample_data.values_as_f32().collect();
        assert_eq!(values, [0.45, 0.4, 0.6625]);
    }

    #[test]
    fn a_foreign_image_is_refused_with_what_is_missing() {
        let channels = AnyChannels::sort([AnyChannel::new("R", FlatSamples::F32(vec![0.5; 4]))].into_iter().collect());
        let mut bytes = Cursor::new(Vec::new());
        Image::from_channels((2, 2), channels).write().non_parallel().to_buffered(&mut bytes).unwrap();
        let error = decode(bytes.get_ref()).unwrap_err();
        assert!(error.to_string().contains("the attribute goniochrome.kind is missing"), "{error}");
        assert!(decode(b"# not an image").unwrap_err().to_string().starts_with("not a readable EXR file"));
        let missing = read(Path::new("no/such.exr")).unwrap_err();
        assert!(missing.to_string().starts_with("cannot read no/such.exr: "), "{missing}");
    }

    /// Replaces text of equal length, so that the file stays well-formed.
    fn patched(from: &str, to: &str) -> String {
        assert_eq!(from.len(), to.len());
        let mut bytes = encode(&sample()).unwrap();
        let at = bytes.windows(from.len()).position(|w| w == from.as_bytes()).expect(from);
        bytes[at..at + to.len()].copy_from_slice(to.as_bytes());
        decode(&bytes).unwrap_err().to_string()
    }

    #[test]
    fn contradictions_are_named() {
        assert_eq!(
            patched("mirror", "mirage"),
            "goniochrome.kind is \"mirage\"; this version reads \"mirror\", \"scatter\" and \"orders\""
        );
        assert!(
            patched("chrome.scene", "chrome.sc\u{7f}ne").starts_with("the metadata key \"sc\\u{7f}ne\" is not 1 to")
        );
        assert_eq!(patched("0 0.33", "0 0 33"), "the image is 3 × 1 where 4 × 1 belong");
        assert_eq!(patched("89.9", "89x9"), "\"89x9\" in goniochrome.theta_deg is not a number");
        assert_eq!(patched("s.T.700,0", "s.T.700,1"), "the 32-bit float channel s.T.700,000000nm is missing");
        assert_eq!(patched(" 700", " 701"), "the 32-bit float channel T.701,000000nm is missing");
    }

    #[test]
    fn unusable_tables_are_not_written() {
        let refusal = |change: fn(&mut MirrorTable)| {
            let mut table = sample();
            change(&mut table);
            encode(&table).unwrap_err().to_string()
        };
        assert!(
            refusal(|t| t.wavelength_nm = vec![500.0, 500.000_000_1]).contains("share the channel name T.500,000000nm")
        );
        assert!(refusal(|t| t.metadata.insert("kind", "x")).contains("is reserved"));
        assert!(refusal(|t| t.metadata.insert("a b", "x")).contains("printable ASCII"));
        assert!(refusal(|t| t.rgb[0][0] = f32::NAN).contains("is not finite"));
    }

    #[test]
    fn damaged_files_give_one_line_and_no_panic() {
        crate::table::file::tests::damage(&encode(&sample()).unwrap());
    }
}
