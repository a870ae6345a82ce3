//! Files of mirror-like tables: one pixel per angle.
//!
//! | channel | holds |
//! |---|---|
//! | `R`, `G`, `B` | linear RGB; left out where no wavelength is visible |
//! | `T.550,000000nm` | unpolarised reflectance at a wavelength |
//! | `s.T.550,000000nm`, `p.T.550,000000nm` | its polarised parts |
//!
//! `goniochrome.theta_deg` holds the angles in degrees at full precision, `goniochrome.wavelength_nm` the wavelengths:
//! decimal numbers separated by spaces. `tests/python/read_table.py` reads them in NumPy. Lines are ZIP-compressed one
//! by one.

use exr::prelude::Compression;

use super::container::{Contents, KIND, Opened, WAVELENGTH, channel_names, format_numbers};
use super::lazy_channel::LazyChannel;
use crate::colour::visible;
use crate::support::error::Result;
use crate::table::mirror::{MirrorTable, check_size};

/// Value of the attribute `kind`.
pub(super) const MIRROR: &str = "mirror";
const THETA: &str = "theta_deg";

/// Encodes a table as an EXR file.
///
/// # Errors
/// A table that [`MirrorTable::check`] refuses, metadata whose keys are reserved or not printable, wavelengths too
/// close for names of channels.
pub fn encode(table: &MirrorTable) -> Result<Vec<u8>> {
    table.check()?;
    let names = channel_names(&table.wavelength_nm)?;
    let count = table.wavelength_nm.len();
    let column = |f: &dyn Fn(usize) -> f32| -> Vec<f32> { (0..table.theta_deg.len()).map(f).collect() };

    let mut channels: Vec<(String, Vec<f32>)> = Vec::with_capacity(3 * count + 3);
    for (i, name) in ["R", "G", "B"].into_iter().enumerate().filter(|_| !table.rgb.is_empty()) {
        channels.push((name.to_owned(), column(&|x| table.rgb[x][i])));
    }
    for (w, name) in names.iter().enumerate() {
        let s = column(&|x| table.reflectance_s[x * count + w]);
        let p = column(&|x| table.reflectance_p[x * count + w]);
        let mean = s.iter().zip(&p).map(|(s, p)| 0.5 * s + 0.5 * p).collect();
        channels.extend([(name.clone(), mean), (format!("s.{name}"), s), (format!("p.{name}"), p)]);
    }
    let attributes = [
        (KIND, MIRROR.to_owned()),
        (THETA, format_numbers(&table.theta_deg)),
        (WAVELENGTH, format_numbers(&table.wavelength_nm)),
    ];
    let attributes = attributes.map(|(key, value)| (key.to_owned(), value)).into();
    let size = (table.theta_deg.len(), 1);
    let channels = channels.into_iter().map(|(name, values)| (name, LazyChannel::new(move |x| values[x]))).collect();
    let mut contents = Contents { size, compression: Compression::ZIP1, channels, attributes };
    contents.add_metadata(&table.metadata)?;
    contents.encode(1)
}

/// Decodes the table in a file of this kind.
pub(super) fn decode(mut file: Opened<'_>) -> Result<MirrorTable> {
    let theta_deg: Vec<f64> = file.take_numbers(THETA)?;
    let wavelength_nm: Vec<f64> = file.take_numbers(WAVELENGTH)?;
    check_size(theta_deg.len(), wavelength_nm.len())?;
    let names = channel_names(&wavelength_nm)?;
    file.expect((theta_deg.len(), 1), 3 * names.len() + 3)?;

    let mut pixels = file.pixels()?;
    let mut rgb = Vec::new();
    if visible(&wavelength_nm) {
        let [r, g, b] = [pixels.take("R")?, pixels.take("G")?, pixels.take("B")?];
        rgb.extend(r.into_iter().zip(g).zip(b).map(|((r, g), b)| [r, g, b]));
    }
    let mut reflectance_s = vec![0.0; theta_deg.len() * names.len()];
    let mut reflectance_p = reflectance_s.clone();
    for (w, name) in names.iter().enumerate() {
        pixels.take(name)?;
        let (s, p) = (pixels.take(&format!("s.{name}"))?, pixels.take(&format!("p.{name}"))?);
        for x in 0..theta_deg.len() {
            reflectance_s[x * names.len() + w] = s[x];
            reflectance_p[x * names.len() + w] = p[x];
        }
    }
    let metadata = file.attributes.into();
    let table = MirrorTable { theta_deg, wavelength_nm, reflectance_s, reflectance_p, rgb, metadata };
    table.check()?;
    Ok(table)
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
    use crate::table::mirror::tests::sample;

    #[test]
    fn a_table_round_trips_exactly() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("table.exr");
        write(&path, &sample().into(), 1).unwrap();
        assert_eq!(read(&path).unwrap(), Table::Mirror(sample()));
    }

    #[test]
    fn invisible_tables_have_no_colour() {
        let table = MirrorTable { wavelength_nm: vec![800.0, 1000.0], rgb: Vec::new(), ..sample() };
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
