//! Tables as spectral OpenEXR images (Fichet, Pacanowski and Wilkie, JCGT 2021): one pixel per angle.
//!
//! | channel | holds |
//! |---|---|
//! | `R`, `G`, `B` | linear RGB |
//! | `T.550,000000nm` | unpolarised reflectance at a wavelength |
//! | `s.T.550,000000nm`, `p.T.550,000000nm` | its polarised parts |
//!
//! All are 32-bit floats, ZIP-compressed. String attributes hold the axes at full precision
//! (`goniochrome.theta_deg`, `goniochrome.wavelength_nm`), the kind of table (`goniochrome.kind`) and every entry of
//! the metadata with the prefix `goniochrome.`. Equal tables give equal bytes.

use std::collections::BTreeMap;
use std::io::Cursor;
use std::path::Path;

use exr::math::Vec2;
use exr::meta::MetaData;
use exr::meta::attribute::{AttributeValue, Text};
use exr::meta::header::Header;
use exr::prelude::{
    AnyChannel, AnyChannels, Compression, Encoding, FlatSamples, Image, LayerAttributes, ReadChannels, ReadLayers,
    WritableImage,
};

use crate::error::{Error, Result};
use crate::table::{MirrorTable, check_size};

const PREFIX: &str = "goniochrome.";
const KIND: &str = "kind";
const MIRROR: &str = "mirror";
const THETA: &str = "theta_deg";
const WAVELENGTH: &str = "wavelength_nm";

/// OpenEXR's own limit, less the prefix.
const MAX_KEY_LENGTH: usize = 255 - PREFIX.len();

/// Writes the table to `path`, whole or not at all.
pub fn write(path: &Path, table: &MirrorTable) -> Result<()> {
    crate::output::write_file(path, &encode(table)?)
}

/// Reads a table that [`write()`] wrote.
pub fn read(path: &Path) -> Result<MirrorTable> {
    let name = path.display();
    let bytes = std::fs::read(path).map_err(|error| {
        Error::failed(format_args!("cannot read {name}: {error}; `goniochrome estimate` writes a table"))
    })?;
    decode(&bytes).map_err(|error| Error::failed(format_args!("{name}: {error}")))
}

/// The bytes of the EXR file.
pub fn encode(table: &MirrorTable) -> Result<Vec<u8>> {
    table.check()?;
    let names = channel_names(&table.wavelength_nm)?;
    let count = table.wavelength_nm.len();
    let column = |f: &dyn Fn(usize) -> f32| -> Vec<f32> { (0..table.theta_deg.len()).map(f).collect() };

    let mut channels: Vec<(String, Vec<f32>)> = Vec::with_capacity(3 * count + 3);
    for (i, name) in ["R", "G", "B"].into_iter().enumerate() {
        channels.push((name.to_owned(), column(&|x| table.rgb[x][i])));
    }
    for (w, name) in names.iter().enumerate() {
        let s = column(&|x| table.reflectance_s[x * count + w]);
        let p = column(&|x| table.reflectance_p[x * count + w]);
        let mean = s.iter().zip(&p).map(|(s, p)| 0.5 * s + 0.5 * p).collect();
        channels.extend([(name.clone(), mean), (format!("s.{name}"), s), (format!("p.{name}"), p)]);
    }
    let channels = channels
        .into_iter()
        .map(|(name, values)| AnyChannel::new(Text::new_or_panic(name), FlatSamples::F32(values)))
        .collect();

    let mut image = Image::from_encoded_channels(
        (table.theta_deg.len(), 1),
        Encoding { compression: Compression::ZIP1, ..Encoding::UNCOMPRESSED },
        AnyChannels::sort(channels),
    );
    image.layer_data.attributes = attributes(table)?;
    let mut bytes = Cursor::new(Vec::new());
    image
        .write()
        .non_parallel()
        .to_buffered(&mut bytes)
        .map_err(|error| Error::failed(format_args!("cannot encode the table as EXR: {error}")))?;
    let mut bytes = bytes.into_inner();
    sort_attributes(&mut bytes).ok_or_else(|| Error::failed("cannot encode the table as EXR: malformed header"))?;
    Ok(bytes)
}

/// The table in the bytes of an EXR file.
pub fn decode(bytes: &[u8]) -> Result<MirrorTable> {
    let broken = |error: exr::error::Error| {
        Error::failed(format_args!("not a readable EXR file: {error}; `goniochrome estimate` writes one"))
    };
    // The header alone first: it bounds the memory that the pixels may ask for.
    let meta = MetaData::read_from_buffered(bytes, true).map_err(broken)?;
    let [header] = meta.headers.as_slice() else {
        return Err(Error::failed("not a goniochrome table: the EXR file has several parts"));
    };
    let mut metadata = own_attributes(header)?;
    let mut take = |key: &str| {
        metadata.remove(key).ok_or_else(|| {
            Error::failed(format_args!(
                "not a goniochrome table: the attribute {PREFIX}{key} is missing; `goniochrome estimate` writes one"
            ))
        })
    };
    let kind = take(KIND)?;
    if kind != MIRROR {
        return Err(Error::failed(format_args!("{PREFIX}{KIND} is \"{kind}\"; this version reads \"{MIRROR}\"")));
    }
    let theta_deg = parse_axis(THETA, &take(THETA)?)?;
    let wavelength_nm = parse_axis(WAVELENGTH, &take(WAVELENGTH)?)?;
    check_size(theta_deg.len(), wavelength_nm.len())?;
    let Vec2(width, height) = header.layer_size;
    if (width, height) != (theta_deg.len(), 1) {
        let angles = theta_deg.len();
        return Err(Error::failed(format_args!("the image is {width} × {height} where {angles} × 1 belong")));
    }
    let names = channel_names(&wavelength_nm)?;
    if header.channels.list.len() > 3 * names.len() + 3 {
        return Err(Error::failed("the EXR file has channels that do not belong to the table"));
    }

    let image = exr::prelude::read()
        .no_deep_data()
        .largest_resolution_level()
        .all_channels()
        .first_valid_layer()
        .all_attributes()
        .non_parallel()
        .from_buffered(Cursor::new(bytes))
        .map_err(broken)?;
    let mut columns: BTreeMap<String, Vec<f32>> = BTreeMap::new();
    for channel in image.layer_data.channel_data.list {
        if let FlatSamples::F32(values) = channel.sample_data {
            columns.insert(channel.name.to_string(), values);
        }
    }
    let mut column = |name: &str| match columns.remove(name) {
        Some(values) if values.len() == theta_deg.len() => Ok(values),
        _ => Err(Error::failed(format_args!("the 32-bit float channel {name} is missing"))),
    };

    let [r, g, b] = [column("R")?, column("G")?, column("B")?];
    let rgb = r.into_iter().zip(g).zip(b).map(|((r, g), b)| [r, g, b]).collect();
    let mut reflectance_s = vec![0.0; theta_deg.len() * names.len()];
    let mut reflectance_p = reflectance_s.clone();
    for (w, name) in names.iter().enumerate() {
        column(name)?;
        let (s, p) = (column(&format!("s.{name}"))?, column(&format!("p.{name}"))?);
        for x in 0..theta_deg.len() {
            reflectance_s[x * names.len() + w] = s[x];
            reflectance_p[x * names.len() + w] = p[x];
        }
    }
    let table = MirrorTable { theta_deg, wavelength_nm, reflectance_s, reflectance_p, rgb, metadata };
    table.check()?;
    Ok(table)
}

/// `T.550,000000nm` for each wavelength.
fn channel_names(wavelength_nm: &[f64]) -> Result<Vec<String>> {
    let names: Vec<_> =
        wavelength_nm.iter().map(|nm| format!("T.{}nm", format!("{nm:.6}").replace('.', ","))).collect();
    match names.windows(2).position(|pair| pair[0] == pair[1]) {
        Some(i) => Err(Error::failed(format_args!(
            "wavelengths {} and {} nm share the channel name {}; keep them 0.000001 nm apart",
            wavelength_nm[i],
            wavelength_nm[i + 1],
            names[i]
        ))),
        None => Ok(names),
    }
}

fn attributes(table: &MirrorTable) -> Result<LayerAttributes> {
    let mut attributes = LayerAttributes::default();
    // OpenEXR only wants bytes here; UTF-8 survives, although the crate's own conversion knows Latin-1 alone.
    let text = |string: &str| Text::from_slice_unchecked(string.as_bytes());
    let mut put = |key: &str, value: &str| {
        attributes.other.insert(text(&format!("{PREFIX}{key}")), AttributeValue::Text(text(value)));
    };
    for (key, value) in &table.metadata {
        if [KIND, THETA, WAVELENGTH].contains(&key.as_str()) {
            return Err(Error::failed(format_args!("the metadata key \"{key}\" is reserved")));
        }
        check_key(key)?;
        put(key, value);
    }
    put(KIND, MIRROR);
    put(THETA, &format_axis(&table.theta_deg));
    put(WAVELENGTH, &format_axis(&table.wavelength_nm));
    attributes.other.insert(text("spectralLayoutVersion"), AttributeValue::Text(text("1.0")));
    Ok(attributes)
}

fn check_key(key: &str) -> Result<()> {
    if key.is_empty() || key.len() > MAX_KEY_LENGTH || !key.bytes().all(|b| b.is_ascii_graphic()) {
        return Err(Error::failed(format_args!(
            "the metadata key {key:?} is not 1 to {MAX_KEY_LENGTH} printable ASCII characters without spaces"
        )));
    }
    Ok(())
}

/// Attributes under our prefix, without it. Keys that could not be written again are refused.
fn own_attributes(header: &Header) -> Result<BTreeMap<String, String>> {
    let mut found = BTreeMap::new();
    for (name, value) in header.own_attributes.other.iter().chain(&header.shared_attributes.other) {
        let (Ok(name), AttributeValue::Text(value)) = (str::from_utf8(name.bytes()), value) else { continue };
        let Some(key) = name.strip_prefix(PREFIX) else { continue };
        check_key(key)?;
        let value = str::from_utf8(value.bytes())
            .map_err(|_| Error::failed(format_args!("the attribute {name} is not UTF-8 text")))?;
        found.insert(key.to_owned(), value.to_owned());
    }
    Ok(found)
}

/// Rust prints the shortest decimal that reads back as the same number.
fn format_axis(values: &[f64]) -> String {
    values.iter().map(f64::to_string).collect::<Vec<_>>().join(" ")
}

fn parse_axis(key: &str, text: &str) -> Result<Vec<f64>> {
    text.split_whitespace()
        .map(|word| {
            word.parse().map_err(|_| Error::failed(format_args!("\"{word}\" in {PREFIX}{key} is not a number")))
        })
        .collect()
}

/// Puts the header's attributes in the order of their names, as OpenEXR itself does: the crate keeps them in a hash map, whose
/// order differs from run to run. Only the order changes, so no offset does. `None` if the header is cut short.
fn sort_attributes(file: &mut [u8]) -> Option<()> {
    const MAGIC_AND_VERSION: usize = 8;
    let text_length = |bytes: &[u8]| bytes.iter().position(|&b| b == 0);
    let mut attributes: Vec<Vec<u8>> = Vec::new();
    let mut at = MAGIC_AND_VERSION;
    while *file.get(at)? != 0 {
        let name = text_length(&file[at..])? + 1;
        let kind = text_length(file.get(at + name..)?)? + 1;
        let size_at = at + name + kind;
        let size = i32::from_le_bytes(file.get(size_at..size_at + 4)?.try_into().ok()?);
        let end = size_at + 4 + usize::try_from(size).ok()?;
        attributes.push(file.get(at..end)?.to_vec());
        at = end;
    }
    attributes.sort();
    file[MAGIC_AND_VERSION..at].copy_from_slice(&attributes.concat());
    Some(())
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::table::tests::sample;

    #[test]
    fn a_table_round_trips_exactly() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("table.exr");
        write(&path, &sample()).unwrap();
        assert_eq!(read(&path).unwrap(), sample());
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
        assert_eq!(patched("mirror", "mirage"), "goniochrome.kind is \"mirage\"; this version reads \"mirror\"");
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
        assert!(refusal(|t| drop(t.metadata.insert("kind".into(), "x".into()))).contains("is reserved"));
        assert!(refusal(|t| drop(t.metadata.insert("a b".into(), "x".into()))).contains("printable ASCII"));
        assert!(refusal(|t| t.rgb[0][0] = f32::NAN).contains("is not finite"));
    }

    #[test]
    fn damaged_files_give_one_line_and_no_panic() {
        let good = encode(&sample()).unwrap();
        for length in 0..good.len() {
            let error = decode(&good[..length]).unwrap_err();
            assert!(!error.to_string().contains('\n'));
        }
        for at in 0..good.len() {
            for flip in [0x01, 0x80, 0xff] {
                let mut bytes = good.clone();
                bytes[at] ^= flip;
                // Some flips only change a value; what matters is that the result is checked.
                if let Ok(table) = decode(&bytes) {
                    table.check().unwrap();
                }
            }
        }
    }
}
