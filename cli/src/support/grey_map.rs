//! Maps of one number a pixel, from PNG, OpenEXR, TIFF and NumPy files.
//!
//! The first bytes of a file tell its format. PNG has 8 or 16 bits (or fewer) of grey, OpenEXR one channel, TIFF and
//! NPY integers or floating-point numbers; of a TIFF file of several pictures the first is read. The numbers are taken
//! as stored, whatever gamma a file names.

use std::io::Cursor;
use std::path::Path;

use exr::prelude::{FlatSamples, ReadChannels, ReadLayers};
use tiff::decoder::DecodingResult;
use tiff::{ColorType, TiffError};

use crate::support::error::{Error, Result};
use crate::support::input::read_bytes;

/// Maximum length of a file: a map of the largest size in double precision, with some room.
const MAX_BYTES: u64 = 160 << 20;

/// Maximum number of pixels along a side.
const MAX_SIDE: usize = 4096;

/// Map of one number a pixel.
#[derive(Clone, Debug, PartialEq)]
pub struct GreyMap {
    /// Number of pixels along x and y, each at least 1.
    pub size: [usize; 2],
    /// Values, row by row from the top; finite. Integers are divided by the largest that their type holds.
    pub values: Vec<f32>,
    /// Whether the file holds integers.
    pub integer: bool,
}

/// Fault of a file, without its name.
type Decoded = std::result::Result<GreyMap, String>;

/// Reads the map in a file.
///
/// # Errors
/// One line that names the file: one that cannot be read, has another format or several channels, is damaged or too
/// large, or holds a value that is not finite.
pub fn read(path: &Path) -> Result<GreyMap> {
    let label = path.display().to_string();
    let failed = |error| Error::failed(format_args!("{label}: cannot read: {error}"));
    decode(&label, &read_bytes(path, MAX_BYTES, "a map", failed)?)
}

/// Decodes the map in the bytes of a file that messages call `label`.
///
/// # Errors
/// As [`read`].
pub fn decode(label: &str, bytes: &[u8]) -> Result<GreyMap> {
    let decoded = match bytes {
        [0x89, b'P', b'N', b'G', ..] => png(bytes),
        [0x76, 0x2f, 0x31, 0x01, ..] => openexr(bytes),
        [b'I', b'I', 42 | 43, 0, ..] | [b'M', b'M', 0, 42 | 43, ..] => tiff(bytes),
        [0x93, b'N', b'U', b'M', b'P', b'Y', ..] => npy(bytes),
        _ => Err("neither PNG, OpenEXR, TIFF nor NPY; export the map as one of them".to_owned()),
    };
    let failed = |what: String| Error::failed(format_args!("{label}: {what}"));
    let map = decoded.map_err(failed)?;
    if map.values.len() != map.size[0] * map.size[1] {
        return Err(failed("the file is cut short; export it anew".to_owned()));
    }
    if let Some(at) = map.values.iter().position(|value| !value.is_finite()) {
        let holes = map.values.iter().filter(|value| !value.is_finite()).count();
        let [row, column] = [at / map.size[0] + 1, at % map.size[0] + 1];
        return Err(failed(format!(
            "{holes} of {} pixels are not finite, the first in row {row}, column {column}; fill the holes",
            map.values.len()
        )));
    }
    Ok(map)
}

/// Size of a map, if it is within the limits.
fn checked(width: usize, height: usize) -> std::result::Result<[usize; 2], String> {
    match (1..=MAX_SIDE).contains(&width) && (1..=MAX_SIDE).contains(&height) {
        true => Ok([width, height]),
        false if width == 0 || height == 0 => Err("the map is empty; export it anew".to_owned()),
        false => Err(format!("{width} × {height} pixels; at most {MAX_SIDE} a side; scale the map down")),
    }
}

fn damaged(format: &str, error: impl std::fmt::Display) -> String {
    format!("not a readable {format} file: {error}; export it anew")
}

fn png(bytes: &[u8]) -> Decoded {
    let broken = |error| damaged("PNG", error);
    let mut decoder = ::png::Decoder::new(Cursor::new(bytes));
    decoder.set_transformations(::png::Transformations::EXPAND);
    let mut reader = decoder.read_info().map_err(broken)?;
    let size = checked(reader.info().width as usize, reader.info().height as usize)?;
    let (colour, depth) = reader.output_color_type();
    if colour != ::png::ColorType::Grayscale {
        return Err("its pixels have colour or alpha; a map has one channel: export it in grey".to_owned());
    }
    let mut samples = vec![0; reader.output_buffer_size().ok_or("too many pixels; scale the map down")?];
    reader.next_frame(&mut samples).map_err(broken)?;
    let values = match depth {
        ::png::BitDepth::Sixteen => {
            samples.chunks_exact(2).map(|b| f32::from(u16::from_be_bytes([b[0], b[1]])) / f32::from(u16::MAX)).collect()
        }
        _ => samples.iter().map(|&x| f32::from(x) / f32::from(u8::MAX)).collect(),
    };
    Ok(GreyMap { size, values, integer: true })
}

fn openexr(bytes: &[u8]) -> Decoded {
    let broken = |error| damaged("EXR", error);
    let meta = exr::meta::MetaData::read_from_buffered(bytes, false).map_err(broken)?;
    let channels: usize = meta.headers.iter().map(|header| header.channels.list.len()).sum();
    let [header] = meta.headers.as_slice() else { return Err("it has several parts; export one".to_owned()) };
    if channels != 1 || header.deep {
        return Err(format!("it has {channels} channels; a map has one, and is not deep"));
    }
    let size = checked(header.layer_size.0, header.layer_size.1)?;
    let reader = exr::prelude::read().no_deep_data().largest_resolution_level().all_channels();
    let image = reader.first_valid_layer().all_attributes().non_parallel();
    let image = image.from_buffered(Cursor::new(bytes)).map_err(broken)?;
    let channel = image.layer_data.channel_data.list.into_iter().next().ok_or("it has no channel")?;
    let (values, integer) = match channel.sample_data {
        FlatSamples::F16(values) => (values.into_iter().map(|x| x.to_f32()).collect(), false),
        FlatSamples::F32(values) => (values, false),
        FlatSamples::U32(values) => (values.into_iter().map(|x| part(x.into(), u32::MAX.into())).collect(), true),
    };
    Ok(GreyMap { size, values, integer })
}

/// Quotient of two integers, in single precision.
fn part(value: i128, max: i128) -> f32 {
    (value as f64 / max as f64) as f32
}

fn tiff(bytes: &[u8]) -> Decoded {
    let broken = |error| match error {
        TiffError::UnsupportedError(what) => format!("{what}; export it in grey, with LZW, deflate or no compression"),
        other => damaged("TIFF", other),
    };
    let mut decoder = ::tiff::decoder::Decoder::new(Cursor::new(bytes)).map_err(broken)?;
    let (width, height) = decoder.dimensions().map_err(broken)?;
    let size = checked(width as usize, height as usize)?;
    match decoder.colortype().map_err(broken)? {
        ColorType::Gray(8 | 16 | 32 | 64) => {}
        other => return Err(format!("its pixels are {other:?}; a map is grey of 8, 16, 32 or 64 bits")),
    }
    macro_rules! integers {
        ($values:expr, $type:ty) => {
            ($values.into_iter().map(|x| part(x.into(), <$type>::MAX.into())).collect(), true)
        };
    }
    let (values, integer) = match decoder.read_image().map_err(broken)? {
        DecodingResult::U8(values) => integers!(values, u8),
        DecodingResult::U16(values) => integers!(values, u16),
        DecodingResult::U32(values) => integers!(values, u32),
        DecodingResult::U64(values) => integers!(values, u64),
        DecodingResult::I8(values) => integers!(values, i8),
        DecodingResult::I16(values) => integers!(values, i16),
        DecodingResult::I32(values) => integers!(values, i32),
        DecodingResult::I64(values) => integers!(values, i64),
        DecodingResult::F16(values) => (values.into_iter().map(|x| x.to_f32()).collect(), false),
        DecodingResult::F32(values) => (values, false),
        DecodingResult::F64(values) => (values.into_iter().map(|x| x as f32).collect(), false),
    };
    Ok(GreyMap { size, values, integer })
}

fn npy(bytes: &[u8]) -> Decoded {
    let short = || "not a readable NPY file: its header is damaged; save it anew".to_owned();
    let byte = |at: usize| bytes.get(at).map(|&b| usize::from(b)).ok_or_else(short);
    let (start, length) = match byte(6)? {
        1 => (10, byte(8)? | byte(9)? << 8),
        2 | 3 => (12, byte(8)? | byte(9)? << 8 | byte(10)? << 16),
        other => return Err(format!("NPY of version {other}; save it with numpy.save")),
    };
    let header = bytes.get(start..start + length).and_then(|b| std::str::from_utf8(b).ok()).ok_or_else(short)?;
    let entry = |key: &str| {
        header.split_once(key).and_then(|(_, rest)| rest.split_once(':')).map(|(_, rest)| rest.trim()).ok_or_else(short)
    };
    let kind = entry("'descr'")?.strip_prefix('\'').and_then(|rest| rest.split('\'').next());
    let kind = kind.ok_or("its array holds records; save one of their fields")?;
    let columns_first = entry("'fortran_order'")?.starts_with("True");
    let shape = entry("'shape'")?.strip_prefix('(').and_then(|rest| rest.split(')').next()).ok_or_else(short)?;
    let sides: Vec<usize> = shape
        .split(',')
        .map(str::trim)
        .filter(|s| !s.is_empty())
        .map(|s| s.parse().map_err(|_| short()))
        .collect::<std::result::Result<_, _>>()?;
    let &[height, width] = sides.as_slice() else {
        return Err(format!("its array has the shape ({shape}); a map has two dimensions"));
    };
    let size = checked(width, height)?;
    let unknown = || format!("its numbers are of type {kind:?}; save them as float32");
    let big = kind.starts_with('>');
    let kind = kind.strip_prefix(['<', '>', '|', '=']).unwrap_or(kind);
    let (letter, bytes_each) = kind.split_at_checked(1).ok_or_else(unknown)?;
    let bytes_each: usize = bytes_each.parse().map_err(|_| unknown())?;
    let number = |raw: &[u8]| -> f32 {
        let bits = raw
            .iter()
            .enumerate()
            .fold(0u64, |bits, (i, &b)| bits | u64::from(b) << (8 * if big { raw.len() - 1 - i } else { i }));
        let unused = 64 - 8 * raw.len() as u32;
        match (letter, raw.len()) {
            ("f", 2) => exr::prelude::f16::from_bits(bits as u16).to_f32(),
            ("f", 4) => f32::from_bits(bits as u32),
            ("f", _) => f64::from_bits(bits) as f32,
            ("u", _) => part(bits.into(), (u64::MAX >> unused).into()),
            _ => part(((bits << unused) as i64 >> unused).into(), (i64::MAX >> unused).into()),
        }
    };
    match (letter, bytes_each) {
        ("f", 2 | 4 | 8) | ("u" | "i", 1 | 2 | 4 | 8) => {}
        _ => return Err(unknown()),
    }
    let stored: Vec<f32> = bytes[start + length..].chunks_exact(bytes_each).take(width * height).map(number).collect();
    let values = match columns_first && stored.len() == width * height {
        true => (0..width * height).map(|k| stored[k % width * height + k / width]).collect(),
        false => stored,
    };
    Ok(GreyMap { size, values, integer: letter != "f" })
}

#[cfg(test)]
#[path = "grey_map_tests.rs"]
mod tests;
