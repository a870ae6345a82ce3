//! EXR container of all kinds of table: 32-bit float channels, text attributes, equal bytes for equal contents.

use std::collections::BTreeMap;
use std::io::Cursor;

use exr::block::UncompressedBlock;
use exr::block::writer::ChunksWriter;
use exr::image::write::layers::{LayersWriter, WritableLayers};
use exr::math::Vec2;
use exr::meta::MetaData;
use exr::meta::attribute::{AttributeValue, Text};
use exr::meta::header::Header;
use exr::prelude::{
    AnyChannel, AnyChannels, Compression, Encoding, FlatSamples, Image, Layer, LayerAttributes, ReadChannels,
    ReadLayers, WritableImage,
};

use super::lazy_channel::LazyChannel;
use crate::support::error::{Error, Result};
use crate::support::parallel::for_each;
use crate::table::metadata::Metadata;

/// Prefix of the name of each attribute of this program.
pub(crate) const PREFIX: &str = "goniochrome.";
pub(super) const KIND: &str = "kind";
pub(super) const WAVELENGTH: &str = "wavelength_nm";

/// Maximum length of a key: OpenEXR's own limit, less the prefix.
const MAX_KEY_LENGTH: usize = 255 - PREFIX.len();

/// Maximum number of blocks in memory at once: sixteen lines of all channels can be megabytes.
const MAX_BLOCKS: usize = 4;

/// Image to write: its pixels, and text attributes.
pub(super) struct Contents<'t> {
    /// Width and height.
    pub size: (usize, usize),
    /// Compression of all channels.
    pub compression: Compression,
    /// Names and values of channels, row by row from the top.
    pub channels: Vec<(String, LazyChannel<'t>)>,
    /// Text attributes by their names without the prefix.
    pub attributes: BTreeMap<String, String>,
}

impl Contents<'_> {
    /// Adds the metadata of a table; refuses keys that are attributes already.
    pub fn add_metadata(&mut self, metadata: &Metadata) -> Result<()> {
        for (key, value) in metadata.iter() {
            if self.attributes.insert(key.to_owned(), value.to_owned()).is_some() {
                return Err(Error::failed(format_args!("the metadata key \"{key}\" is reserved")));
            }
        }
        Ok(())
    }

    /// Encodes the image as an EXR file.
    pub fn encode(self, threads: usize) -> Result<Vec<u8>> {
        let failed =
            |error: &dyn std::fmt::Display| Error::failed(format_args!("cannot encode the table as EXR: {error}"));
        let mut attributes = LayerAttributes::default();
        // OpenEXR only wants bytes here; UTF-8 survives, although the crate's own conversion knows Latin-1 alone.
        let text = |string: &str| Text::from_slice_unchecked(string.as_bytes());
        for (key, value) in &self.attributes {
            check_key(key)?;
            attributes.other.insert(text(&format!("{PREFIX}{key}")), AttributeValue::Text(text(value)));
        }
        attributes.other.insert(text("spectralLayoutVersion"), AttributeValue::Text(text("1.0")));
        let channels = self.channels.into_iter();
        let channels = channels.map(|(name, column)| AnyChannel::new(Text::new_or_panic(name), column)).collect();
        let encoding = Encoding { compression: self.compression, ..Encoding::UNCOMPRESSED };
        let mut image = Image::from_encoded_channels(self.size, encoding, AnyChannels::sort(channels));
        image.layer_data.attributes = attributes;
        let mut bytes = write(&image, threads).map_err(|error| failed(&error))?;
        sort_attributes(&mut bytes).ok_or_else(|| failed(&"malformed header"))?;
        Ok(bytes)
    }
}

/// Encodes the image. Threads gather and compress blocks, one each at a time; in the file the blocks are in order.
fn write(image: &Image<Layer<AnyChannels<LazyChannel<'_>>>>, threads: usize) -> exr::error::Result<Vec<u8>> {
    let headers = image.write().infer_meta_data();
    let layers = image.layer_data.create_writer(&headers);
    let mut bytes = Cursor::new(Vec::new());
    exr::block::write(&mut bytes, headers, true, |meta, file| {
        let blocks: Vec<_> = meta.enumerate_ordered_header_block_indices().collect();
        let at_once = threads.clamp(1, MAX_BLOCKS);
        for blocks in blocks.chunks(at_once) {
            let mut chunks: Vec<_> = blocks.iter().map(|(place, index)| (*place, *index, None)).collect();
            for_each(
                at_once,
                chunks.iter_mut(),
                || (),
                |(), (_, index, chunk)| {
                    let data = layers.extract_uncompressed_block(&meta.headers, *index);
                    *chunk = Some(UncompressedBlock { index: *index, data }.compress_to_chunk(&meta.headers));
                },
            );
            for (place, _, chunk) in chunks {
                file.write_chunk(place, chunk.expect("each was worked on")?)?;
            }
        }
        Ok(())
    })?;
    Ok(bytes.into_inner())
}

/// EXR file whose header alone has been read: it bounds the memory for the pixels.
pub(super) struct Opened<'b> {
    bytes: &'b [u8],
    /// Width and height.
    pub size: (usize, usize),
    /// Number of channels.
    pub channels: usize,
    /// Text attributes of this program by their names without the prefix.
    pub attributes: BTreeMap<String, String>,
}

fn broken(error: exr::error::Error) -> Error {
    Error::failed(format_args!("not a readable EXR file: {error}; `goniochrome estimate` writes one"))
}

impl<'b> Opened<'b> {
    /// Reads the header.
    pub fn new(bytes: &'b [u8]) -> Result<Self> {
        let meta = MetaData::read_from_buffered(bytes, true).map_err(broken)?;
        let [header] = meta.headers.as_slice() else {
            return Err(Error::failed("not a goniochrome table: the EXR file has several parts"));
        };
        let attributes = own_attributes(header)?;
        let Vec2(width, height) = header.layer_size;
        Ok(Self { bytes, size: (width, height), channels: header.channels.list.len(), attributes })
    }

    /// Removes and returns an attribute.
    pub fn take(&mut self, key: &str) -> Result<String> {
        self.attributes.remove(key).ok_or_else(|| {
            Error::failed(format_args!(
                "not a goniochrome table: the attribute {PREFIX}{key} is missing; `goniochrome estimate` writes one"
            ))
        })
    }

    /// Removes an attribute and returns its list of numbers.
    pub fn take_numbers<T: std::str::FromStr>(&mut self, key: &str) -> Result<Vec<T>> {
        let text = self.take(key)?;
        let number = |word: &str| {
            word.parse().map_err(|_| Error::failed(format_args!("\"{word}\" in {PREFIX}{key} is not a number")))
        };
        text.split_whitespace().map(number).collect()
    }

    /// Refuses an image whose size or number of channels contradicts the attributes.
    pub fn expect(&self, size: (usize, usize), max_channels: usize) -> Result<()> {
        if self.size != size {
            return Err(Error::failed(format_args!(
                "the image is {} × {} where {} × {} belong",
                self.size.0, self.size.1, size.0, size.1
            )));
        }
        if self.channels > max_channels {
            return Err(Error::failed("the EXR file has channels that do not belong to the table"));
        }
        Ok(())
    }

    /// Reads the pixels.
    pub fn pixels(&self) -> Result<PixelChannels> {
        let image = exr::prelude::read()
            .no_deep_data()
            .largest_resolution_level()
            .all_channels()
            .first_valid_layer()
            .all_attributes()
            .non_parallel()
            .from_buffered(Cursor::new(self.bytes))
            .map_err(broken)?;
        let mut channels = BTreeMap::new();
        for channel in image.layer_data.channel_data.list {
            if let FlatSamples::F32(values) = channel.sample_data {
                channels.insert(channel.name.to_string(), values);
            }
        }
        Ok(PixelChannels { channels, length: self.size.0 * self.size.1 })
    }
}

/// 32-bit float channels of an image.
pub(super) struct PixelChannels {
    channels: BTreeMap<String, Vec<f32>>,
    length: usize,
}

impl PixelChannels {
    /// Whether there is a channel.
    pub fn has(&self, name: &str) -> bool {
        self.channels.contains_key(name)
    }

    /// Removes and returns a channel.
    pub fn take(&mut self, name: &str) -> Result<Vec<f32>> {
        match self.channels.remove(name) {
            Some(values) if values.len() == self.length => Ok(values),
            _ => Err(Error::failed(format_args!("the 32-bit float channel {name} is missing"))),
        }
    }
}

/// Formats numbers separated by spaces. Each is the shortest decimal that reads back exactly.
pub(super) fn format_numbers<T: ToString>(values: impl IntoIterator<Item = T>) -> String {
    values.into_iter().map(|value| value.to_string()).collect::<Vec<_>>().join(" ")
}

/// Name of the channel of each wavelength, such as `T.550,000000nm`.
pub(super) fn channel_names(wavelength_nm: &[f64]) -> Result<Vec<String>> {
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

fn check_key(key: &str) -> Result<()> {
    if key.is_empty() || key.len() > MAX_KEY_LENGTH || !key.bytes().all(|b| b.is_ascii_graphic()) {
        return Err(Error::failed(format_args!(
            "the metadata key {key:?} is not 1 to {MAX_KEY_LENGTH} printable ASCII characters without spaces"
        )));
    }
    Ok(())
}

/// Text attributes of this program by their names without the prefix. Keys that could not be written again are refused.
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

/// Sorts the header's attributes by name, as OpenEXR itself does: the `exr` crate keeps them in a hash map, whose order
/// differs from run to run. Only the order changes, so no offset does. `None` if the header is cut short.
pub(crate) fn sort_attributes(file: &mut [u8]) -> Option<()> {
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

    #[test]
    fn any_number_of_threads_writes_the_same_blocks() {
        let encode = |threads| {
            let channels = vec![("Y".to_owned(), LazyChannel::new(|pixel| (pixel * pixel % 97) as f32))];
            // Seven blocks of 16 lines.
            let size = (9, 100);
            let contents = Contents { size, compression: Compression::ZIP16, channels, attributes: BTreeMap::new() };
            contents.encode(threads).unwrap()
        };
        let one = encode(1);
        assert_eq!(Opened::new(&one).unwrap().pixels().unwrap().take("Y").unwrap()[500], (500 * 500 % 97) as f32);
        assert!([2, 3, 64].iter().all(|&threads| encode(threads) == one));
    }
}
